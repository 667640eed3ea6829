"""The version of Nephroid: here alone; the distribution takes it from this file."""

__all__ = ["VERSION"]

VERSION = "0.1.0"
