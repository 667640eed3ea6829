"""Photons: from the lamps, through the scene, into the map."""

__all__: list[str] = []
