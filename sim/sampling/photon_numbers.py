"""The five numbers that a photon is made of, by each of the ways to draw them.

Two numbers stand for its direction, one for its wavelength, two for its place on the lamp. They
are drawn jointly, so that well-spread points fill the whole space of paths evenly.

No photon is emitted twice. A stream, one lamp's photons at one target in one pass, has at most 2²⁸
(the limit of `RenderSettings.photons`), and an index of 32 bits:

- Sobol points are linear over the bits of the index. Each number's first 32 digits have rank 32,
  and Owen's scramble is one to one on them: in float64 not even one number comes back in 2³²
  photons. In float32 numbers of 24 digits do, but the digits of any two together have rank 32.
- The R sequence turns by odd steps modulo 2⁶⁴, so that no number returns before 2⁶⁴ photons. Cut to
  53 bits none does before 2³²: k α is never so near a whole number. Cut to the 24 bits of float32
  each does, but a point lamp's three never at once.
- Random numbers are a bijection of their counters, 5 i + k. Cut to b bits, n photons of d numbers
  hold n²/2^(b d + 1) alike pairs: of 10⁹ photons of d = 3 in float64 10⁻³⁰, in float32 10⁻⁴.

Streams and passes have scrambles and shifts of their own. Those are hashes, so that two photons of
different streams agree in d numbers of b bits by chance alone, with probability 2^(−b d).

References:
    Roberts (2018), "The unreasonable effectiveness of quasirandom sequences": in d dimensions the
    steps are g⁻¹ … g⁻ᵈ, with g the positive root of g^(d+1) = g + 1. With d = 5 two pairs of
    dimensions fill in stripes up to some 10⁶ photons: 6 g⁻³ − 4 g⁻² and g⁻³ + 10 g⁻⁵ are nearly
    whole.
    Owen (1998), J. Complexity 14, 466.
"""

import functools
from typing import Any

import warp as wp

from sim.precision import precision_types
from sim.sampling.counter import hash64, to_unit
from sim.sampling.draws import EMISSION
from sim.sampling.sobol import make_sobol_uniform

__all__ = ["R5_STEPS", "make_photon_numbers"]

R5_STEPS = (
    0xE19B01AA9D42C633,
    0xC6D1D6C8ED0C9631,
    0xAF36D01EF7518DBB,
    0x9A69443F36F710E7,
    0x881403B9339BD42D,
)
"""g⁻¹ … g⁻⁵ in units of 2⁻⁶⁴, g⁶ = g + 1; all odd, so that no point returns."""

STEP_0 = wp.constant(wp.uint64(R5_STEPS[0]))
STEP_1 = wp.constant(wp.uint64(R5_STEPS[1]))
STEP_2 = wp.constant(wp.uint64(R5_STEPS[2]))
STEP_3 = wp.constant(wp.uint64(R5_STEPS[3]))
STEP_4 = wp.constant(wp.uint64(R5_STEPS[4]))


@functools.cache
def make_photon_numbers(precision: str, sampler: str) -> Any:
    """Device function `photon_numbers(sobol, seeds, seed_row, index, key)`.

    Args:
        precision: of the numbers.
        sampler: "sobol", "r2" or "random", see `sim.method`.

    Returns:
        The function, which returns the five numbers of photon `index` of the stream that `key`
        and the scramble seeds from `seed_row` on belong to.
    """
    sobol_uniform, real = make_sobol_uniform(precision), precision_types(precision).real

    @wp.func
    def sobol_numbers(
        sobol: wp.array(dtype=wp.uint32), seeds: wp.array(dtype=wp.uint32), seed_row: int,
        index: wp.uint32, key: wp.uint64,
    ):
        low = hash64(key + EMISSION, wp.uint64(index) * wp.uint64(2))
        low2 = hash64(key + EMISSION, wp.uint64(index) * wp.uint64(2) + wp.uint64(1))
        bits0 = wp.uint32(low)
        bits1 = wp.uint32(low >> wp.uint64(21))
        bits2 = wp.uint32(low >> wp.uint64(42))
        bits3 = wp.uint32(low2)
        bits4 = wp.uint32(low2 >> wp.uint64(21))
        u0 = sobol_uniform(sobol, index, 0, seeds[seed_row], bits0)
        u1 = sobol_uniform(sobol, index, 1, seeds[seed_row + 1], bits1)
        u2 = sobol_uniform(sobol, index, 2, seeds[seed_row + 2], bits2)
        u3 = sobol_uniform(sobol, index, 3, seeds[seed_row + 3], bits3)
        u4 = sobol_uniform(sobol, index, 4, seeds[seed_row + 4], bits4)
        return u0, u1, u2, u3, u4

    @wp.func
    def r5_numbers(
        sobol: wp.array(dtype=wp.uint32), seeds: wp.array(dtype=wp.uint32), seed_row: int,
        index: wp.uint32, key: wp.uint64,
    ):
        i = wp.uint64(index)
        like = real(0.0)
        u0 = to_unit(hash64(key + EMISSION, wp.uint64(0)) + STEP_0 * i, like)
        u1 = to_unit(hash64(key + EMISSION, wp.uint64(1)) + STEP_1 * i, like)
        u2 = to_unit(hash64(key + EMISSION, wp.uint64(2)) + STEP_2 * i, like)
        u3 = to_unit(hash64(key + EMISSION, wp.uint64(3)) + STEP_3 * i, like)
        u4 = to_unit(hash64(key + EMISSION, wp.uint64(4)) + STEP_4 * i, like)
        return u0, u1, u2, u3, u4

    @wp.func
    def random_numbers(
        sobol: wp.array(dtype=wp.uint32), seeds: wp.array(dtype=wp.uint32), seed_row: int,
        index: wp.uint32, key: wp.uint64,
    ):
        first = wp.uint64(index) * wp.uint64(5)
        like = real(0.0)
        u0 = to_unit(hash64(key + EMISSION, first), like)
        u1 = to_unit(hash64(key + EMISSION, first + wp.uint64(1)), like)
        u2 = to_unit(hash64(key + EMISSION, first + wp.uint64(2)), like)
        u3 = to_unit(hash64(key + EMISSION, first + wp.uint64(3)), like)
        u4 = to_unit(hash64(key + EMISSION, first + wp.uint64(4)), like)
        return u0, u1, u2, u3, u4

    return {"sobol": sobol_numbers, "r2": r5_numbers, "random": random_numbers}[sampler]
