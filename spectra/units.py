"""Units and physical constants.

Wavelengths are nanometres everywhere but inside dispersion formulas, which are published in
micrometres; every other quantity is SI.

References:
    BIPM (2019), The International System of Units, 9th edition: h, c, k are exact by definition.
    CIE 018:2019, The Basis of Physical Photometry: maximum luminous efficacy, which the table of
    the photopic observer rounds from 683.002 to 683 lm/W.
    Hecht (2017), Optics, 5th edition, table 6.1: Fraunhofer lines.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

__all__ = [
    "BOLTZMANN_J_K",
    "FRAUNHOFER_C_NM",
    "FRAUNHOFER_D_NM",
    "FRAUNHOFER_F_NM",
    "FRAUNHOFER_LINES_NM",
    "LUMINOUS_EFFICACY_LM_W",
    "M_PER_NM",
    "NM_PER_UM",
    "PLANCK_J_S",
    "SPEED_OF_LIGHT_M_S",
    "VISIBLE_RANGE_NM",
]

PLANCK_J_S: Final = 6.62607015e-34
SPEED_OF_LIGHT_M_S: Final = 299_792_458.0
BOLTZMANN_J_K: Final = 1.380649e-23

LUMINOUS_EFFICACY_LM_W: Final = 683.0

FRAUNHOFER_F_NM: Final = 486.1327
FRAUNHOFER_D_NM: Final = 587.5618
FRAUNHOFER_C_NM: Final = 656.2725

FRAUNHOFER_LINES_NM: Final[Mapping[str, float]] = MappingProxyType(
    {"F": FRAUNHOFER_F_NM, "d": FRAUNHOFER_D_NM, "C": FRAUNHOFER_C_NM}
)
"""The lines by which glasses are compared."""

NM_PER_UM: Final = 1000.0
M_PER_NM: Final = 1e-9

VISIBLE_RANGE_NM: Final = (360.0, 830.0)
"""Range of the CIE 1931 colour matching functions; broad light sources are defined over it."""
