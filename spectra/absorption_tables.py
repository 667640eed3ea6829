"""Published absorption of the named media: glass makers' catalogues, and water.

References:
    Schott optical glass catalogue, 2017-01-20: internal transmittance of 25 mm, printed to 0.001
    (through refractiveindex.info, CC0, which holds the same numbers as k).
    Hale, G. M. and Querry, M. R. (1973), "Optical constants of water in the 200-nm to 200-µm
    wavelength region", Applied Optics 12, 555-563, table I: extinction coefficient at 25 °C
    (through refractiveindex.info, CC0).
"""

from collections.abc import Mapping
from types import MappingProxyType

from spectra.absorption import Absorption
from spectra.errors import UnknownAbsorption

__all__ = ["absorbing_media", "published_absorption"]

_SCHOTT_THICKNESS_M = 0.025
_SCHOTT = (
    "Schott optical glass catalogue 2017-01-20, internal transmittance of 25 mm,"
    " through refractiveindex.info (CC0)"
)
_HALE_QUERRY = (
    "Hale, G. M. and Querry, M. R. (1973), Optical constants of water in the 200-nm to 200-µm"
    " wavelength region, Applied Optics 12, 555-563; 25 °C, through refractiveindex.info (CC0)"
)

# Wavelength [nm]: internal transmittance of 25 mm.
_N_BK7 = {
    300.0: 0.050, 310.0: 0.250, 320.0: 0.520, 334.0: 0.780, 350.0: 0.920, 365.0: 0.971,
    370.0: 0.977, 380.0: 0.983, 390.0: 0.989, 400.0: 0.992, 405.0: 0.993, 420.0: 0.993,
    436.0: 0.992, 460.0: 0.993, 500.0: 0.994, 546.0: 0.996, 580.0: 0.995, 620.0: 0.994,
    660.0: 0.994, 700.0: 0.996, 1060.0: 0.997, 1530.0: 0.980, 1970.0: 0.840, 2325.0: 0.560,
    2500.0: 0.360,
}  # fmt: skip
_SF11 = {
    390.0: 0.010, 400.0: 0.200, 405.0: 0.340, 420.0: 0.700, 436.0: 0.860, 460.0: 0.940,
    500.0: 0.976, 546.0: 0.989, 580.0: 0.991, 620.0: 0.991, 660.0: 0.991, 700.0: 0.993,
    1060.0: 0.997, 1530.0: 0.982, 1970.0: 0.930, 2325.0: 0.700, 2500.0: 0.610,
}  # fmt: skip
_N_SF11 = {
    370.0: 0.002, 380.0: 0.120, 390.0: 0.390, 400.0: 0.600, 405.0: 0.670, 420.0: 0.810,
    436.0: 0.870, 460.0: 0.920, 500.0: 0.953, 546.0: 0.978, 580.0: 0.984, 620.0: 0.981,
    660.0: 0.981, 700.0: 0.985, 1060.0: 0.998, 1530.0: 0.985, 1970.0: 0.915, 2325.0: 0.700,
    2500.0: 0.620,
}  # fmt: skip
_F2 = {
    334.0: 0.211, 350.0: 0.780, 365.0: 0.921, 370.0: 0.940, 380.0: 0.963, 390.0: 0.977,
    400.0: 0.985, 405.0: 0.987, 420.0: 0.991, 436.0: 0.993, 460.0: 0.994, 500.0: 0.997,
    546.0: 0.998, 580.0: 0.998, 620.0: 0.998, 660.0: 0.997, 700.0: 0.998, 1060.0: 0.998,
    1530.0: 0.989, 1970.0: 0.876, 2325.0: 0.685, 2500.0: 0.589,
}  # fmt: skip

# Wavelength [nm]: extinction coefficient k.
_WATER_K = {
    200.0: 1.10e-7, 225.0: 4.90e-8, 250.0: 3.35e-8, 275.0: 2.35e-8, 300.0: 1.60e-8,
    325.0: 1.08e-8, 350.0: 6.50e-9, 375.0: 3.50e-9, 400.0: 1.86e-9, 425.0: 1.30e-9,
    450.0: 1.02e-9, 475.0: 9.35e-10, 500.0: 1.00e-9, 525.0: 1.32e-9, 550.0: 1.96e-9,
    575.0: 3.60e-9, 600.0: 1.09e-8, 625.0: 1.39e-8, 650.0: 1.64e-8, 675.0: 2.23e-8,
    700.0: 3.35e-8, 725.0: 9.15e-8, 750.0: 1.56e-7, 775.0: 1.48e-7, 800.0: 1.25e-7,
    825.0: 1.82e-7, 850.0: 2.93e-7, 875.0: 3.91e-7, 900.0: 4.86e-7, 925.0: 1.06e-6,
    950.0: 2.93e-6, 975.0: 3.48e-6, 1000.0: 2.89e-6, 1200.0: 9.89e-6,
}  # fmt: skip


def _of_schott(table: Mapping[float, float]) -> Absorption:
    return Absorption.from_internal_transmittance(
        tuple(table.values()), tuple(table), thickness_m=_SCHOTT_THICKNESS_M, source=_SCHOTT
    )


_BY_NAME: Mapping[str, Absorption] = MappingProxyType(
    {
        "N-BK7": _of_schott(_N_BK7),
        "SF11": _of_schott(_SF11),
        "N-SF11": _of_schott(_N_SF11),
        "F2": _of_schott(_F2),
        "water": Absorption.from_extinction(
            tuple(_WATER_K.values()), tuple(_WATER_K), source=_HALE_QUERRY
        ),
    }
)


def published_absorption(name: str) -> Absorption:
    """What is published of the absorption of the medium of exactly this name.

    Media by name come without: what a scene's glass absorbs is for the scene to say.

    Raises:
        UnknownAbsorption: If there is no table of it; the error lists of which media there are.
    """
    try:
        return _BY_NAME[name]
    except (KeyError, TypeError):
        raise UnknownAbsorption(name, _BY_NAME) from None


def absorbing_media() -> tuple[str, ...]:
    """Names of the media whose absorption is published here."""
    return tuple(_BY_NAME)
