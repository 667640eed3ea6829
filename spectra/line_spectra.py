"""Published emission lines of the elements, as spectral lamps and lasers show them.

Wavelengths are in standard air. Intensities are the relative ones of the same tables, which are
estimates for one kind of lamp each: right for "which line is bright", not for radiometry.

References:
    Sansonetti, J. E. and Martin, W. C. (2005), "Handbook of Basic Atomic Spectroscopic Data",
    Journal of Physical and Chemical Reference Data 34, 1559-2259 (sodium, mercury).
    Reader, J. and Corliss, C. H., "Line Spectra of the Elements", in CRC Handbook of Chemistry and
    Physics (hydrogen, helium, cadmium).
    Quinn, T. J. (2003), "Practical realization of the definition of the metre", Metrologia 40,
    103-133: helium-neon, 632.991213 nm in vacuum, divided by the index of standard air.
"""

from collections.abc import Mapping
from types import MappingProxyType

__all__ = ["LINES"]

LINES: Mapping[str, Mapping[float, float]] = MappingProxyType(
    {
        "sodium": {588.9950: 80000.0, 589.5924: 40000.0},
        "mercury": {
            365.0153: 600.0,
            404.6563: 400.0,
            435.8328: 1000.0,
            546.0735: 500.0,
            576.9598: 50.0,
            579.0663: 60.0,
        },
        "helium-neon": {632.8162: 1.0},
        "hydrogen": {
            397.0072: 8.0,
            410.1740: 15.0,
            434.0470: 30.0,
            486.1330: 80.0,
            656.2720: 120.0,
            656.2852: 180.0,
        },
        "helium": {
            388.8650: 500.0,
            396.4729: 20.0,
            402.6191: 50.0,
            412.0820: 12.0,
            438.7929: 10.0,
            447.1479: 200.0,
            471.3146: 30.0,
            492.1931: 20.0,
            501.5678: 100.0,
            504.7740: 10.0,
            587.5620: 500.0,
            667.8150: 100.0,
            706.5190: 200.0,
            728.1350: 50.0,
        },
        "cadmium": {467.8149: 200.0, 479.9912: 300.0, 508.5822: 1000.0, 643.8470: 2000.0},
    }
)
"""Wavelength [nm] and relative intensity of each line, ascending, by lamp."""
