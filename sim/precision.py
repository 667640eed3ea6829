"""The floating-point types that a run computes with.

Tracing runs in float64 on the CPU, where it costs about 14% over float32, and float32 remains a
setting. Device functions are generic in precision; the structs and kernels that need concrete
types come from factories keyed on one of the two names below.
"""

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
import warp as wp

__all__ = ["Precision", "precision_types"]


@dataclass(frozen=True)
class Precision:
    """Warp's scalar, vector and matrix types of one precision, and NumPy's scalar beside them.

    Attributes:
        name: "float32" or "float64".
        real: Warp scalar type.
        vec3: Warp vector type of three reals.
        vec4: Warp vector type of four reals.
        mat33: Warp matrix type of three by three reals.
        dtype: the NumPy scalar type that arrays of `real` copy from.
    """

    name: str
    real: Any
    vec3: Any
    vec4: Any
    mat33: Any
    dtype: type[np.floating[Any]]


@functools.cache
def precision_types(name: str) -> Precision:
    """Return the types of the precision called `name` ("float32" or "float64")."""
    if name == "float64":
        return Precision(name, wp.float64, wp.vec3d, wp.vec4d, wp.mat33d, np.float64)
    if name == "float32":
        return Precision(name, wp.float32, wp.vec3f, wp.vec4f, wp.mat33f, np.float32)
    raise ValueError(f"unknown precision {name!r}; allowed: 'float32', 'float64'")
