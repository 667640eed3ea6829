"""Where the emitted energy went, in words: in all, and band by band."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.photons.energy import EnergyBooks

__all__ = ["band_lines", "print_books"]


def print_books(energy: "EnergyBooks", centres_nm: Sequence[float]) -> None:
    """Print where the emitted flux went, in watts and as a share, and in each band.

    Args:
        energy: the books.
        centres_nm: of their bands [nm].
    """
    from sim.photons.energy import BOOK_COLUMNS

    print("energy")
    for name, flux in zip(BOOK_COLUMNS, energy.totals, strict=True):
        share = flux / energy.emitted if energy.emitted else math.nan
        print(f"  {name:<14}{flux:14.9g} W {share:9.3%}")
    print(f"  {'residual':<14}{energy.residual:14.3g} of the emitted")
    for line in band_lines(energy.by_band, centres_nm):
        print(line)


def band_lines(
    by_band: Sequence[Sequence[float]], centres_nm: Sequence[float] | None
) -> list[str]:
    """A table of the books of each band: a heading, and a line a band; nothing without any.

    Args:
        by_band: the five columns of the books of each band [W].
        centres_nm: of the bands [nm]; None: they are not known, and bands are numbered.
    """
    from sim.photons.energy import BOOK_COLUMNS

    if not by_band:
        return []
    heading = "".join(f"{name:>13}" for name in BOOK_COLUMNS)
    lines = [f"  {'energy [W]':<12}{heading}"]
    if centres_nm is None:
        bands = [f"band {number + 1}" for number in range(len(by_band))]
    else:
        bands = [f"{centre_nm:g} nm" for centre_nm in centres_nm]
    for band, row in zip(bands, by_band, strict=True):
        lines.append(f"  {band:<12}{''.join(f'{flux:13.6g}' for flux in row)}")
    return lines
