"""Developed pictures as PNG files."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray

from sim.version import VERSION

__all__ = ["encode_png"]

_PERCEPTUAL = b"\x00"  # Rendering intent of the sRGB chunk (PNG specification, 11.3.2.5).


def encode_png(srgb: NDArray[np.uint8]) -> memoryview:
    """Encode an 8-bit sRGB picture.

    Args:
        srgb: Encoded sRGB, shape (height, width, 3), row 0 on top.

    Returns:
        The content of a PNG file.
    """
    from PIL import Image, PngImagePlugin

    chunks = PngImagePlugin.PngInfo()
    chunks.add(b"sRGB", _PERCEPTUAL)
    chunks.add_text("Software", f"Nephroid {VERSION}")
    buffer = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(srgb)).save(buffer, "PNG", pnginfo=chunks)
    return buffer.getbuffer()
