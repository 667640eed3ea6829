import pickle

import pytest

from spectra import SpectraError, UnknownGlass, UnknownName, WavelengthOutOfRange


def test_an_unknown_name_is_a_plain_sentence_with_the_nearest_names() -> None:
    error = UnknownGlass("BK9", ["N-BK7", "SF11", "BK10"])
    assert str(error) == "unknown glass 'BK9'; nearest: BK10, N-BK7"
    assert error.nearest == ("BK10", "N-BK7")


def test_with_nothing_alike_all_names_are_listed() -> None:
    assert str(UnknownName("zzz", ["one", "two"])) == "unknown name 'zzz'; known: one, two"


def test_nearest_names_ignore_case() -> None:
    assert UnknownGlass("caf2", ["water", "CaF2"]).nearest == ("CaF2",)


def test_unknown_names_are_caught_as_what_they_are() -> None:
    for kind in (SpectraError, ValueError, KeyError):
        assert issubclass(UnknownGlass, kind)
    assert issubclass(WavelengthOutOfRange, SpectraError)


@pytest.mark.parametrize(
    ("wavelength", "hint"),
    [
        (250.0, ""),
        (0.5876, " (0.5876 looks like micrometres: wavelengths are nanometres, 587.6)"),
        (5.876e-7, " (5.876e-07 looks like metres: wavelengths are nanometres, 587.6)"),
        (float("nan"), ""),
        (float("inf"), ""),
    ],
)
def test_a_wavelength_in_another_unit_is_noticed(wavelength: float, hint: str) -> None:
    error = WavelengthOutOfRange("glass", wavelength, (300.0, 2500.0))
    expected = f"glass has no refractive index at {wavelength:g} nm; allowed: 300 to 2500 nm{hint}"
    assert str(error) == expected


@pytest.mark.parametrize(
    "error", [UnknownGlass("x", ["y"]), WavelengthOutOfRange("glass", 1.0, (2.0, 3.0))]
)
def test_errors_survive_the_way_between_processes(error: SpectraError) -> None:
    copy = pickle.loads(pickle.dumps(error))
    assert type(copy) is type(error)
    assert str(copy) == str(error)
    assert vars(copy) == vars(error)
