"""Absorption inside a medium: Beer and Lambert's law, and the ways its constant is published.

Light that goes a way d through a medium keeps exp(-α d) of its flux. α is the Napierian absorption
coefficient [1/m]; everything else that tables print is converted to it once, here:

- a decadic coefficient a, for 10^(-a d), as spectrophotometers give it: α = a ln 10;
- an extinction coefficient k, the imaginary part of the index: α = 4 π k / λ
  (Born & Wolf 1999, §14.1, eq. 21);
- an internal transmittance τ of a thickness d, as glass makers print it: α = -ln τ / d.

References:
    Bouguer, P. (1729), "Essai d'optique sur la gradation de la lumière".
    Beer, A. (1852), "Bestimmung der Absorption des rothen Lichts in farbigen Flüssigkeiten",
    Annalen der Physik 162, 78-88.
    Born, M. and Wolf, E. (1999), Principles of Optics, 7th edition, Cambridge University Press.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Final, Self

import numpy as np

from spectra.arrays import FloatArray, FloatOrArray, float_tuple, like, read_only
from spectra.dispersion import require_in_range
from spectra.errors import SpectraError
from spectra.units import M_PER_NM

__all__ = ["MAX_ALPHA_PER_M", "Absorption"]

MAX_ALPHA_PER_M: Final = 1e30
"""Larger coefficients are cut to this: opaque at any thickness, and finite in single precision."""

_EXTINCTION_STEP: Final = 1.0 / 250.0
"""Largest relative step between the knots made from a table of k. Where k = a + bλ, the part a/λ of
α bends, and the straight line over a step h errs by (h/λ)²/4 of that part at most: 4e-6."""


@dataclass(frozen=True)
class Absorption:
    """The Napierian absorption coefficient α of a medium as a function of wavelength.

    α is linear between the knots; without knots it is constant, and known everywhere.

    Attributes:
        napierian_per_m: α at each knot [1/m]; one number if there are no knots.
        wavelength_nm: The knots [nm], 2 or more, strictly increasing; () for a constant.
        source: Where the numbers come from.
    """

    napierian_per_m: tuple[float, ...]
    wavelength_nm: tuple[float, ...] = ()
    source: str = ""

    def __post_init__(self) -> None:
        """Check the numbers, and cut those that are too large."""
        knots = float_tuple(self.wavelength_nm, "absorption: wavelengths")
        count = len(knots) or 1
        if len(self.napierian_per_m) != count or len(knots) == 1:
            raise SpectraError(
                f"absorption: {len(self.napierian_per_m)} coefficients at {len(knots)} wavelengths;"
                " allowed: 2 or more wavelengths and as many coefficients, or one constant"
            )
        if knots and (knots[0] <= 0.0 or not np.all(np.diff(knots) > 0.0)):
            raise SpectraError(
                f"absorption: wavelengths {knots} nm; allowed: above 0, strictly increasing"
            )
        for alpha in self.napierian_per_m:
            if not alpha >= 0.0:
                raise SpectraError(
                    f"absorption coefficient {alpha:g} per metre; allowed: 0 or more"
                )
        capped = tuple(min(float(alpha), MAX_ALPHA_PER_M) for alpha in self.napierian_per_m)
        object.__setattr__(self, "napierian_per_m", capped)
        object.__setattr__(self, "wavelength_nm", knots)

    @classmethod
    def from_decadic(
        cls, per_m: Sequence[float], wavelength_nm: Sequence[float] = (), *, source: str = ""
    ) -> Self:
        """From decadic coefficients a [1/m], for a transmittance 10^(-a d): α = a ln 10."""
        alpha = tuple(a * math.log(10.0) for a in per_m)
        return cls(alpha, tuple(wavelength_nm), source)

    @classmethod
    def from_internal_transmittance(
        cls,
        transmittance: Sequence[float],
        wavelength_nm: Sequence[float] = (),
        *,
        thickness_m: float,
        source: str = "",
    ) -> Self:
        """From the share τ of light that a thickness d lets pass inside: α = -ln τ / d.

        Between the entries α is linear, so it is the logarithm of τ that is.

        Raises:
            SpectraError: If a transmittance is not within 0 < τ <= 1. A printed 0 is a bound, for
                less than half of the last digit; it fixes no coefficient.
        """
        if not 0.0 < thickness_m < math.inf:
            raise SpectraError(f"thickness {thickness_m:g} m; allowed: above 0, finite")
        for tau in transmittance:
            if not 0.0 < tau <= 1.0:
                raise SpectraError(f"internal transmittance {tau:g}; allowed: above 0, at most 1")
        # log(1) is 0; the sum turns -0 into 0.
        alpha = tuple(0.0 - math.log(tau) / thickness_m for tau in transmittance)
        return cls(alpha, tuple(wavelength_nm), source)

    @classmethod
    def from_extinction(
        cls, k: Sequence[float], wavelength_nm: Sequence[float], *, source: str = ""
    ) -> Self:
        """From extinction coefficients k, linear between wavelengths [nm]: α = 4 π k / λ.

        Knots are added where α would bend too much between the given ones.

        Raises:
            SpectraError: If there are less than 2 wavelengths: α depends on them even if k does
                not.
        """
        values = np.asarray(k, dtype=np.float64)
        entries = np.asarray(float_tuple(wavelength_nm, "absorption: wavelengths"))
        if len(entries) < 2 or entries[0] <= 0.0 or not np.all(np.diff(entries) > 0.0):
            raise SpectraError(
                f"extinction coefficient at wavelengths {tuple(wavelength_nm)} nm;"
                " allowed: 2 or more, above 0, strictly increasing"
            )
        if len(values) != len(entries):
            raise SpectraError(
                f"{len(values)} extinction coefficients at {len(entries)} wavelengths;"
                " allowed: as many"
            )
        if not np.all(values >= 0.0):
            raise SpectraError(f"extinction coefficient {values.min():g}; allowed: 0 or more")
        knots = _refined(entries)
        with np.errstate(over="ignore"):  # What overflows is cut to the largest coefficient.
            alpha = 4.0 * math.pi * np.interp(knots, entries, values) / (knots * M_PER_NM)
        return cls(tuple(alpha.tolist()), tuple(knots.tolist()), source)

    @property
    def is_constant(self) -> bool:
        """Whether α is the same at every wavelength where it is known."""
        return len(set(self.napierian_per_m)) == 1

    @property
    def is_transparent(self) -> bool:
        """Whether nothing is absorbed at all."""
        return not any(self.napierian_per_m)

    @property
    def wavelength_range_nm(self) -> tuple[float, float]:
        """Lowest and highest wavelength where α is known [nm]; (0, inf) for a constant."""
        if not self.wavelength_nm:
            return 0.0, math.inf
        return self.wavelength_nm[0], self.wavelength_nm[-1]

    @cached_property
    def knots_nm(self) -> FloatArray:
        """The knots [nm], shape (n,), read-only; for a constant a single 0."""
        return read_only(self.wavelength_nm or (0.0,))

    @cached_property
    def alpha_per_m(self) -> FloatArray:
        """α at each of the knots [1/m], shape (n,), read-only."""
        return read_only(self.napierian_per_m)

    def coefficient(self, wavelength_nm: FloatOrArray) -> FloatOrArray:
        """The Napierian absorption coefficient α [1/m].

        Args:
            wavelength_nm: Wavelength [nm], a number or an array of any shape.

        Returns:
            α, a float or a float64 array of the same shape.

        Raises:
            WavelengthOutOfRange: Outside the table, and for NaN.
        """
        wavelengths = np.asarray(wavelength_nm, dtype=np.float64)
        require_in_range(
            wavelengths, "the table", self.wavelength_range_nm, quantity="absorption coefficient"
        )
        alpha = np.asarray(np.interp(wavelengths, self.knots_nm, self.alpha_per_m))
        return like(alpha, wavelength_nm)

    def transmittance(self, wavelength_nm: FloatOrArray, length_m: float) -> FloatOrArray:
        """What a way inside leaves of the light, exp(-α d): the internal transmittance.

        Args:
            wavelength_nm: Wavelength [nm], a number or an array of any shape.
            length_m: Length d of the way [m], 0 or more.

        Returns:
            Share that passes, a float or a float64 array of the same shape.

        Raises:
            WavelengthOutOfRange: Outside the table, and for NaN.
            SpectraError: If the length is negative or not finite.
        """
        if not 0.0 <= length_m < math.inf:
            raise SpectraError(f"way of {length_m:g} m; allowed: 0 or more, finite")
        passed = np.exp(-np.asarray(self.coefficient(wavelength_nm)) * length_m)
        return like(passed, wavelength_nm)


def _refined(entries: FloatArray) -> FloatArray:
    """The entries and what stands between them, no two further apart than the relative step."""
    log_ratio = math.log1p(_EXTINCTION_STEP)
    pieces = []
    for low, high in pairwise(entries):
        parts = max(1, math.ceil(math.log(high / low) / log_ratio))
        pieces.append(np.geomspace(low, high, parts, endpoint=False))
    return np.concatenate([*pieces, entries[-1:]])
