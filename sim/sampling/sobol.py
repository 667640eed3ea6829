"""Owen-scrambled Sobol points, by byte tables.

Point number i of dimension d is the exclusive-or of the direction numbers that the bits of i
select; four table look-ups, one a byte of i, do what 32 steps would. The tables hold bit-reversed
numbers, since the scramble wants its bits that way round.

The scramble is a hash that lets each bit depend on higher bits only, which is Owen's nested
uniform scrambling: every power-of-two prefix stays a (t, m, s)-net, while each point alone is
uniform. Bits beyond the 32nd are random, as they are in Owen's construction.

References:
    Joe & Kuo (2008), SIAM J. Sci. Comput. 30, 2635: direction numbers "new-joe-kuo-6".
    Owen (1998), J. Complexity 14, 466: nested uniform scrambling.
    Laine & Karras (2011), Comput. Graph. Forum 30, 1337; Burley (2020), JCGT 9(4), 1: scrambling
    by a hash; Vegdahl (2021), "Building a better LK hash": the multipliers used here.
"""

import functools
from typing import Any

import numpy as np
import numpy.typing as npt
import warp as wp

__all__ = ["DIMENSIONS", "MAX_POINTS", "make_sobol_uniform", "reversed_point", "sobol_tables"]

DIMENSIONS = 5
"""Dimensions of a photon: two of direction, one of wavelength, two of position."""

MAX_POINTS = 2**32
"""Points of one sequence: the index has 32 bits."""

# Joe & Kuo (2008), dimensions 2 to 5: degree s, coefficient a, initial numbers m.
_JOE_KUO = (
    (1, 0, (1,)),
    (2, 1, (1, 3)),
    (3, 1, (1, 3, 1)),
    (3, 2, (1, 1, 1)),
)


def _direction_numbers(dimension: int) -> list[int]:
    """The 32 direction numbers of a dimension, most significant bit first (Joe & Kuo eq. 2–4)."""
    if dimension == 0:
        return [1 << (31 - k) for k in range(32)]
    s, a, initial = _JOE_KUO[dimension - 1]
    m = list(initial)
    for k in range(s, 32):
        new = m[k - s] ^ (m[k - s] << s)
        for j in range(1, s):
            if (a >> (s - 1 - j)) & 1:
                new ^= m[k - j] << j
        m.append(new)
    return [m[k] << (31 - k) for k in range(32)]


@functools.cache
def sobol_tables() -> npt.NDArray[np.uint32]:
    """(DIMENSIONS · 4 · 256,) bit-reversed exclusive-ors, by dimension, byte and byte's value."""
    table = np.zeros((DIMENSIONS, 4, 256), dtype=np.uint32)
    for dimension in range(DIMENSIONS):
        numbers = [int(f"{v:032b}"[::-1], 2) for v in _direction_numbers(dimension)]
        for byte in range(4):
            for value in range(1, 256):
                low = value & -value
                table[dimension, byte, value] = (
                    int(table[dimension, byte, value ^ low])
                    ^ numbers[8 * byte + low.bit_length() - 1]
                )
    return table.ravel()


@wp.func
def swap_bits(x: wp.uint32, mask: wp.uint32, shift: wp.uint32):
    """Bits under `mask` and those `shift` above them, exchanged."""
    return ((x >> shift) & mask) | ((x & mask) << shift)


@wp.func
def reverse_bits(x: wp.uint32):
    """The 32 bits of x in reverse order."""
    y = swap_bits(x, wp.uint32(0x55555555), wp.uint32(1))
    y = swap_bits(y, wp.uint32(0x33333333), wp.uint32(2))
    y = swap_bits(y, wp.uint32(0x0F0F0F0F), wp.uint32(4))
    y = swap_bits(y, wp.uint32(0x00FF00FF), wp.uint32(8))
    return (y >> wp.uint32(16)) | (y << wp.uint32(16))


@wp.func
def scramble_reversed(x: wp.uint32, seed: wp.uint32):
    """Owen's nested scramble of a bit-reversed number (Vegdahl 2021)."""
    y = x ^ (x * wp.uint32(0x3D20ADEA))
    y += seed
    y *= (seed >> wp.uint32(16)) | wp.uint32(1)
    y ^= y * wp.uint32(0x05526C56)
    y ^= y * wp.uint32(0x53A22864)
    return y


@wp.func
def reversed_point(tables: wp.array(dtype=wp.uint32), index: wp.uint32, dimension: int):
    """The Sobol point's 32 bits, least significant digit first."""
    row = dimension * 1024
    byte = wp.uint32(255)
    x = tables[row + int(index & byte)]
    x ^= tables[row + 256 + int((index >> wp.uint32(8)) & byte)]
    x ^= tables[row + 512 + int((index >> wp.uint32(16)) & byte)]
    x ^= tables[row + 768 + int(index >> wp.uint32(24))]
    return x


@functools.cache
def make_sobol_uniform(precision: str) -> Any:
    """Device function `sobol_uniform(tables, index, dimension, seed, low_bits)` in [0, 1).

    In float64 the number has 53 bits, the lowest 21 of them from `low_bits`; in float32 it has
    the top 24 bits of the scrambled point.
    """
    double = precision == "float64"

    @wp.func
    def sobol_uniform(
        tables: wp.array(dtype=wp.uint32),
        index: wp.uint32,
        dimension: int,
        seed: wp.uint32,
        low_bits: wp.uint32,
    ):
        x = reverse_bits(scramble_reversed(reversed_point(tables, index, dimension), seed))
        if wp.static(double):
            low = wp.float64(low_bits & wp.uint32(0x1FFFFF)) * wp.float64(4.76837158203125e-07)
            return (wp.float64(x) + low) * wp.float64(2.3283064365386963e-10)
        else:
            return wp.float32(x >> wp.uint32(8)) * wp.float32(5.9604644775390625e-08)

    return sobol_uniform
