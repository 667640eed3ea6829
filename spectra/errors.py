"""What can go wrong when spectra are asked for.

SpectraError(ValueError)          a quantity that is not a spectrum, an index, a colour
├── UnknownName(KeyError)         a name that is not in the tables; lists the nearest ones
│   ├── UnknownAbsorption
│   ├── UnknownConductor
│   ├── UnknownGlass
│   ├── UnknownObserver
│   └── UnknownSpectrum
└── WavelengthOutOfRange          a wavelength where a medium has no data
"""

import difflib
import math
from collections.abc import Iterable
from typing import ClassVar

from spectra.units import M_PER_NM, NM_PER_UM

__all__ = [
    "SpectraError",
    "UnknownAbsorption",
    "UnknownConductor",
    "UnknownGlass",
    "UnknownName",
    "UnknownObserver",
    "UnknownSpectrum",
    "WavelengthOutOfRange",
]

_NEAREST_COUNT = 4
_NEAREST_CUTOFF = 0.4
_LONGEST = 80


class SpectraError(ValueError):
    """Base of every error this package raises on purpose."""


class UnknownName(SpectraError, KeyError):
    """A name that is not in one of the tables.

    Args:
        name: What was asked for.
        known: Every name there is.

    Attributes:
        name: What was asked for.
        known: Every name there is, in the table's order.
        nearest: The names most like it, best first; empty when nothing is alike.
    """

    kind: ClassVar[str] = "name"

    def __init__(self, name: str, known: Iterable[str]) -> None:
        known = tuple(known)
        # args hold the constructor's arguments, so the error survives pickling between processes.
        super().__init__(name, known)
        self.name = name
        self.known = known

    @property
    def nearest(self) -> tuple[str, ...]:
        """The known names most like the one asked for, best first."""
        if len(str(self.name)) > _LONGEST:
            return ()
        by_lower = {known.lower(): known for known in self.known}
        close = difflib.get_close_matches(
            str(self.name).lower(), by_lower, n=_NEAREST_COUNT, cutoff=_NEAREST_CUTOFF
        )
        return tuple(by_lower[match] for match in close)

    def __str__(self) -> str:
        """One plain sentence; KeyError alone would quote it."""
        offered = f"nearest: {', '.join(self.nearest)}" if self.nearest else self._all_known()
        return f"unknown {self.kind} {self._shown}; {offered}"

    @property
    def _shown(self) -> str:
        """The name, quoted, and no longer than a line."""
        text = str(self.name)
        return repr(text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…")

    def _all_known(self) -> str:
        return f"known: {', '.join(self.known)}"


class UnknownAbsorption(UnknownName):
    """A medium of whose absorption there is no table."""

    kind = "absorption of"

    def __str__(self) -> str:
        """One plain sentence; a similar name would be another medium."""
        return f"no absorption of {self._shown} is published here; {self._all_known()}"


class UnknownConductor(UnknownName):
    """A metal that is not in the tables."""

    kind = "metal"


class UnknownGlass(UnknownName):
    """A medium that is not in the glass table."""

    kind = "glass"


class UnknownSpectrum(UnknownName):
    """A light source that is not in the tables."""

    kind = "spectrum"


class UnknownObserver(UnknownName):
    """A set of colour matching functions that is not in the tables."""

    kind = "observer"


class WavelengthOutOfRange(SpectraError):
    """A wavelength at which a medium has no data.

    Args:
        medium: Name of the medium.
        wavelength_nm: The offending wavelength [nm]; the first one, if there are several.
        range_nm: Lowest and highest valid wavelength [nm].
        quantity: What there is none of.

    Attributes:
        medium: Name of the medium.
        wavelength_nm: The offending wavelength [nm].
        range_nm: Lowest and highest valid wavelength [nm].
        quantity: What there is none of.
    """

    def __init__(
        self,
        medium: str,
        wavelength_nm: float,
        range_nm: tuple[float, float],
        quantity: str = "refractive index",
    ) -> None:
        super().__init__(medium, wavelength_nm, range_nm, quantity)
        self.medium = medium
        self.wavelength_nm = wavelength_nm
        self.range_nm = range_nm
        self.quantity = quantity

    def __str__(self) -> str:
        """The sentence, with a hint when another unit of length would have been in range."""
        low, high = self.range_nm
        return (
            f"{self.medium} has no {self.quantity} at {self.wavelength_nm:.10g} nm; "
            f"allowed: {low:g} to {high:g} nm{self._unit_hint()}"
        )

    def _unit_hint(self) -> str:
        low, high = self.range_nm
        for unit, nm_per_unit in (("micrometres", NM_PER_UM), ("metres", 1.0 / M_PER_NM)):
            as_nm = self.wavelength_nm * nm_per_unit
            if math.isfinite(as_nm) and low <= as_nm <= high:
                return (
                    f" ({self.wavelength_nm:g} looks like {unit}: "
                    f"wavelengths are nanometres, {as_nm:g})"
                )
        return ""
