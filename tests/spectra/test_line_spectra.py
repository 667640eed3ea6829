import pytest

from spectra import VISIBLE_RANGE_NM, air_index
from spectra.line_spectra import LINES


@pytest.mark.parametrize("name", LINES)
def test_lines_are_visible_ascending_and_bright(name: str) -> None:
    wavelengths = list(LINES[name])
    low, high = VISIBLE_RANGE_NM
    assert wavelengths == sorted(wavelengths)
    assert low <= wavelengths[0]
    assert wavelengths[-1] <= high
    assert min(LINES[name].values()) > 0.0


def test_hydrogen_is_the_balmer_series() -> None:
    # 1/λ = R_H (1/4 - 1/n²), R_H = 10967758.34 m⁻¹ (CODATA 2018 R∞ with the reduced mass), in
    # vacuum. Fine structure, of relative size α² / 4 = 1.3e-5, moves lines by 0.01 nm, and the
    # weaker component of H-alpha by as much again.
    rydberg_hydrogen = 10_967_758.34
    lines = list(LINES["hydrogen"])
    balmer = {n: 1e9 / (rydberg_hydrogen * (0.25 - 1.0 / n**2)) for n in (3, 4, 5, 6, 7)}
    for n, line in zip((7, 6, 5, 4, 3, 3), lines, strict=True):
        assert line == pytest.approx(balmer[n] / air_index(balmer[n]), abs=0.02)


def test_helium_neon_is_the_iodine_stabilised_laser_in_air() -> None:
    # Quinn (2003): 632.99121258 nm in vacuum.
    vacuum_nm = 632.99121258
    assert list(LINES["helium-neon"]) == [round(vacuum_nm / air_index(vacuum_nm), 4)]
