"""Published complex refractive indices of metals, n + ik, as printed.

References:
    Johnson, P. B. and Christy, R. W. (1972), "Optical Constants of the Noble Metals", Physical
    Review B 6, 4370-4379, table I (copper, silver, gold; evaporated films, room temperature).
    Rakić, A. D. (1995), "Algorithm for the determination of intrinsic optical constants of metal
    films: application to aluminum", Applied Optics 34, 4755-4767 (aluminium; from 0.7 to 6 eV).
    Both through refractiveindex.info (CC0).
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

__all__ = ["METALS", "MetalTable"]


class MetalTable(NamedTuple):
    """A table as printed.

    Attributes:
        wavelength_nm: Wavelengths [nm], ascending.
        eta: Real part n of the index.
        k: Imaginary part k of the index, the extinction coefficient.
        source: The publication.
    """

    wavelength_nm: tuple[float, ...]
    eta: tuple[float, ...]
    k: tuple[float, ...]
    source: str


# fmt: off
_JOHNSON_CHRISTY_NM = (
    187.9, 191.6, 195.3, 199.3, 203.3, 207.3, 211.9, 216.4, 221.4, 226.2, 231.3, 237.1, 242.6,
    249.0, 255.1, 261.6, 268.9, 276.1, 284.4, 292.4, 300.9, 310.7, 320.4, 331.5, 342.5, 354.2,
    367.9, 381.5, 397.4, 413.3, 430.5, 450.9, 471.4, 495.9, 520.9, 548.6, 582.1, 616.8, 659.5,
    704.5, 756.0, 821.1, 892.0, 984.0, 1088.0, 1216.0, 1393.0, 1610.0, 1937.0,
)

_COPPER_ETA = (
    0.94, 0.95, 0.97, 0.98, 0.99, 1.01, 1.04, 1.08, 1.13, 1.18, 1.23, 1.28, 1.34, 1.37, 1.41,
    1.41, 1.45, 1.46, 1.45, 1.42, 1.4, 1.38, 1.38, 1.34, 1.36, 1.37, 1.36, 1.33, 1.32, 1.28,
    1.25, 1.24, 1.25, 1.22, 1.18, 1.02, 0.7, 0.3, 0.22, 0.21, 0.24, 0.26, 0.3, 0.32, 0.36, 0.48,
    0.6, 0.76, 1.09,
)
_COPPER_K = (
    1.337, 1.388, 1.44, 1.493, 1.55, 1.599, 1.651, 1.699, 1.737, 1.768, 1.792, 1.802, 1.799,
    1.783, 1.741, 1.691, 1.668, 1.646, 1.633, 1.633, 1.679, 1.729, 1.783, 1.821, 1.864, 1.916,
    1.975, 2.045, 2.116, 2.207, 2.305, 2.397, 2.483, 2.564, 2.608, 2.577, 2.704, 3.205, 3.747,
    4.205, 4.665, 5.18, 5.768, 6.421, 7.217, 8.245, 9.439, 11.12, 13.43,
)

_SILVER_ETA = (
    1.07, 1.1, 1.12, 1.14, 1.15, 1.18, 1.2, 1.22, 1.25, 1.26, 1.28, 1.28, 1.3, 1.31, 1.33, 1.35,
    1.38, 1.41, 1.41, 1.39, 1.34, 1.13, 0.81, 0.17, 0.14, 0.1, 0.07, 0.05, 0.05, 0.05, 0.04,
    0.04, 0.05, 0.05, 0.05, 0.06, 0.05, 0.06, 0.05, 0.04, 0.03, 0.04, 0.04, 0.04, 0.04, 0.09,
    0.13, 0.15, 0.24,
)
_SILVER_K = (
    1.212, 1.232, 1.255, 1.277, 1.296, 1.312, 1.325, 1.336, 1.342, 1.344, 1.357, 1.367, 1.378,
    1.389, 1.393, 1.387, 1.372, 1.331, 1.264, 1.161, 0.964, 0.616, 0.392, 0.829, 1.142, 1.419,
    1.657, 1.864, 2.07, 2.275, 2.462, 2.657, 2.869, 3.093, 3.324, 3.586, 3.858, 4.152, 4.483,
    4.838, 5.242, 5.727, 6.312, 6.992, 7.795, 8.828, 10.1, 11.85, 14.08,
)

_GOLD_ETA = (
    1.28, 1.32, 1.34, 1.33, 1.33, 1.3, 1.3, 1.3, 1.3, 1.31, 1.3, 1.32, 1.32, 1.33, 1.33, 1.35,
    1.38, 1.43, 1.47, 1.49, 1.53, 1.53, 1.54, 1.48, 1.48, 1.5, 1.48, 1.46, 1.47, 1.46, 1.45,
    1.38, 1.31, 1.04, 0.62, 0.43, 0.29, 0.21, 0.14, 0.13, 0.14, 0.16, 0.17, 0.22, 0.27, 0.35,
    0.43, 0.56, 0.92,
)
_GOLD_K = (
    1.188, 1.203, 1.226, 1.251, 1.277, 1.304, 1.35, 1.387, 1.427, 1.46, 1.497, 1.536, 1.577,
    1.631, 1.688, 1.749, 1.803, 1.847, 1.869, 1.878, 1.889, 1.893, 1.898, 1.883, 1.871, 1.866,
    1.895, 1.933, 1.952, 1.958, 1.948, 1.914, 1.849, 1.833, 2.081, 2.455, 2.863, 3.272, 3.697,
    4.103, 4.542, 5.083, 5.663, 6.35, 7.15, 8.145, 9.519, 11.21, 13.78,
)

_RAKIC_NM = (
    206.64, 247.97, 309.96, 326.28, 364.66, 413.28, 442.8, 476.87, 516.6, 563.57, 619.93,
    652.25, 688.81, 729.32, 774.91, 794.78, 815.69, 837.74, 885.61, 911.66, 939.28, 968.63,
    999.88, 1033.2, 1127.1, 1239.9, 1377.6, 1549.8, 1771.2,
)
_ALUMINIUM_ETA = (
    0.12677, 0.18137, 0.28003, 0.31474, 0.39877, 0.52135, 0.6079, 0.7278, 0.8734, 1.0728, 1.366,
    1.5724, 1.8301, 2.1606, 2.6154, 2.7675, 2.7668, 2.6945, 2.2802, 1.9739, 1.6784, 1.4867,
    1.4359, 1.3998, 1.3281, 1.3157, 1.3899, 1.5782, 1.9205,
)
_ALUMINIUM_K = (
    2.3563, 2.9029, 3.7081, 3.9165, 4.3957, 5.0008, 5.3676, 5.7781, 6.2418, 6.7839, 7.4052,
    7.7354, 8.0601, 8.3565, 8.4914, 8.3866, 8.2573, 8.1878, 8.1134, 8.3058, 8.597, 9.0655,
    9.4939, 9.8914, 10.969, 12.245, 13.784, 15.656, 17.991,
)
# fmt: on

_JOHNSON_CHRISTY = (
    "Johnson, P. B. and Christy, R. W. (1972), Optical Constants of the Noble Metals, Physical "
    "Review B 6, 4370-4379, through refractiveindex.info (CC0)"
)
_RAKIC = (
    "Rakić, A. D. (1995), Algorithm for the determination of intrinsic optical constants of metal "
    "films: application to aluminum, Applied Optics 34, 4755-4767, through refractiveindex.info "
    "(CC0)"
)

METALS: Mapping[str, MetalTable] = MappingProxyType(
    {
        "gold": MetalTable(_JOHNSON_CHRISTY_NM, _GOLD_ETA, _GOLD_K, _JOHNSON_CHRISTY),
        "silver": MetalTable(_JOHNSON_CHRISTY_NM, _SILVER_ETA, _SILVER_K, _JOHNSON_CHRISTY),
        "aluminium": MetalTable(_RAKIC_NM, _ALUMINIUM_ETA, _ALUMINIUM_K, _RAKIC),
        "copper": MetalTable(_JOHNSON_CHRISTY_NM, _COPPER_ETA, _COPPER_K, _JOHNSON_CHRISTY),
    }
)
"""The tables by the metal's name."""
