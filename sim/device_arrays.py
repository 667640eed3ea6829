"""Arrays of structs on a device."""

from typing import Any

import numpy as np
import warp as wp

__all__ = ["struct_array"]


def struct_array(struct: Any, rows: list[tuple[Any, ...]], device: str) -> Any:
    """A device array of `struct` from tuples in the order of its fields; never of length zero.

    Warp's empty arrays have a null pointer; one zero element that no count mentions is simpler
    than a guard at each use.
    """
    dtype = struct.numpy_dtype()
    host = np.zeros(max(1, len(rows)), dtype=dtype)
    for i, row in enumerate(rows):
        host[i] = row
    return wp.array(host, dtype=struct, device=device)
