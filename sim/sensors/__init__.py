"""Sensors: what crosses them is counted or kept, and nothing is taken away."""
