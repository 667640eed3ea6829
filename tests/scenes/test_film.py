import numpy as np
import pytest

from scenes import Film, SceneError


def test_the_default_bands_are_31_of_10_nm() -> None:
    film = Film()
    np.testing.assert_allclose(film.centres_nm, np.arange(400.0, 701.0, 10.0), atol=1e-10)
    np.testing.assert_allclose(film.edges_nm, np.arange(395.0, 706.0, 10.0), atol=1e-10)
    assert film.edges_nm[0] == 395.0
    assert film.edges_nm[-1] == 705.0
    assert film.spacing_nm == 10.0


def test_a_single_band_lies_midway_and_has_a_width_of_its_own() -> None:
    np.testing.assert_array_equal(Film(bands=1, first_nm=500, last_nm=600).edges_nm, [545, 555])
    film = Film(bands=1, first_nm=589, last_nm=589, band_width_nm=2.0)
    np.testing.assert_array_equal(film.edges_nm, [588, 590])
    np.testing.assert_array_equal(film.centres_nm, [589])


def test_a_band_width_that_is_the_spacing_is_accepted() -> None:
    assert Film(bands=4, first_nm=400, last_nm=700, band_width_nm=100.0).spacing_nm == 100.0


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"first_nm": 700.0, "last_nm": 400.0}, "last_nm: must be greater than first_nm = 700"),
        ({"first_nm": 500.0, "last_nm": 500.0}, "last_nm: must be greater than first_nm = 500"),
        ({"bands": 4, "band_width_nm": 10.0}, "band_width_nm: must be the spacing of the 4 bands"),
        ({"bands": 1, "band_width_nm": 1200.0}, "must have bands between 10 and 1e.06 nm"),
        ({"bands": 0}, "bands: must be at least 1, is 0"),
        ({"gamut": "cut"}, "gamut: must be 'desaturate', 'clip' or 'preserve', is 'cut'"),
        ({"observer": "CIE 1931"}, "observer: must be 'CIE 1931 2 degree' or 'CIE 2015 2 degree'"),
    ],
)
def test_bands_that_make_no_sense(fields: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        Film(**fields)
