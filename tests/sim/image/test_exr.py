"""Spectral EXR files, written and read: by OpenEXR itself, by `read_exr`, and damaged."""

import dataclasses
import json
import re

import numpy as np
import OpenEXR
import pytest

import scenes
import sim
from sim.errors import FileFormatError
from sim.image.exr_layout import (
    error_channel,
    error_wavelength_nm,
    radiance_channel,
    radiance_wavelength_nm,
)
from sim.image.exr_reading import read_exr
from sim.photons.energy import EnergyBooks

# The pattern of the reference reader of Fichet, Pacanowski and Wilkie (2021).
REFERENCE_PATTERN = re.compile(
    r"^((S([0-3]))|T)\.(\d*,?\d*([Ee][+-]?\d+)?)(Y|Z|E|P|T|G|M|k|h|da|d|c|m|u|n|p)?(m|Hz)$"
)
# float32 has 24 significant bits; the error bars keep 8 of theirs.
FLOAT32_ROUNDING = 2.0**-24
ERROR_BAR_ROUNDING = 2.0**-8


@pytest.fixture
def exr(synthetic_picture, tmp_path):
    path = tmp_path / "out.exr"
    synthetic_picture.save_exr(path)
    return path


def raw_channels(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        pixels = {name: channel.pixels for name, channel in file.channels().items()}
        return pixels, dict(file.header())


def write(path, planes):
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, planes) as file:
        file.write(str(path))


def constant(value):
    return np.full((2, 3), value, np.float32)


def test_channel_names():
    assert radiance_channel(550.0) == "S0.550,000000nm"
    assert error_channel(400.25) == "standardError.400,250000nm"


@pytest.mark.parametrize(
    ("channel", "wavelength_nm"),
    [
        ("S0.550,000000nm", 550.0),
        ("S0.550nm", 550.0),
        ("S0.0,55um", 550.0),
        ("S0.5,5E-7m", 550.0),
        ("S0.5500,0E-1nm", 550.0),
        ("S0.5,45077196363636e14Hz", 550.0),  # c / 550 nm
        ("S0.545,077196363636THz", 550.0),
        *[(name, None) for name in ("S1.550,0nm", "T.550,0nm", "S0.550.0nm", "S0.nm", "R", "S0.")],
        ("S0.0Hz", None),
        ("standardError.550,000000nm", None),
        ("550,0nm", None),
    ],
)
def test_wavelengths_are_read_in_every_unit_of_the_layout(channel, wavelength_nm):
    found = radiance_wavelength_nm(channel)
    assert found == (None if wavelength_nm is None else pytest.approx(wavelength_nm, rel=1e-12))
    assert error_wavelength_nm("standardError.550,000000nm") == 550.0
    assert error_wavelength_nm("S0.550,000000nm") is None


def test_openexr_itself_finds_every_band(exr, synthetic_picture):
    pixels, _ = raw_channels(exr)
    wavelengths_nm = synthetic_picture.wavelengths_nm
    assert pixels.keys() == {
        *"RGB", *map(radiance_channel, wavelengths_nm), *map(error_channel, wavelengths_nm),
        "luminance.noise", "luminance.bias",
    }  # fmt: skip
    for band, wavelength_nm in enumerate(wavelengths_nm):
        stored = pixels[radiance_channel(wavelength_nm)]
        assert stored.dtype == np.float32
        expected = synthetic_picture.spectral_radiance[..., band]
        np.testing.assert_allclose(stored, expected, rtol=FLOAT32_ROUNDING)
        stored = pixels[error_channel(wavelength_nm)]
        expected = synthetic_picture.standard_error[..., band]
        np.testing.assert_allclose(stored, expected, rtol=ERROR_BAR_ROUNDING)


def test_linear_rgb_keeps_its_negative_values(exr, synthetic_picture):
    pixels, header = raw_channels(exr)
    stored = np.stack([pixels[name] for name in "RGB"], axis=-1)
    np.testing.assert_allclose(stored, synthetic_picture.linear_rgb, rtol=1e-6, atol=1e-12)
    assert stored.min() < 0.0
    assert header["whiteLuminance"] == 683.0
    # IEC 61966-2-1: red (0.64, 0.33), green (0.30, 0.60), blue (0.15, 0.06), D65.
    expected = [0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290]
    np.testing.assert_allclose(header["chromaticities"], expected, rtol=1e-6)


def test_the_reference_reader_sees_the_bands_and_nothing_else(exr, synthetic_picture):
    pixels, header = raw_channels(exr)
    matches = [match for match in map(REFERENCE_PATTERN.match, pixels) if match]
    found_nm = sorted(float(match[4].replace(",", ".")) for match in matches)
    np.testing.assert_allclose(found_nm, synthetic_picture.wavelengths_nm, atol=1e-6)
    assert {(match[1], match[6], match[7]) for match in matches} == {("S0", "n", "m")}
    assert header["spectralLayoutVersion"] == "1.0"
    assert header["emissiveUnits"] == "W.m^-2.sr^-1"
    assert header["EV"] == pytest.approx(synthetic_picture.exposure_stops, rel=1e-6)


def test_the_file_says_how_to_render_it_again(exr, synthetic_picture):
    image = read_exr(exr)
    assert scenes.loads(image.attribute("scene"), name="small") == synthetic_picture.scene
    settings = sim.RenderSettings(**json.loads(image.attribute("settings")))
    assert settings.reproducing() == synthetic_picture.settings.reproducing()
    assert image.attribute("seed") == "5"
    energy = EnergyBooks(**json.loads(image.attribute("energy")))
    assert energy == synthetic_picture.energy
    assert json.loads(image.attribute("band_edges_nm")) == synthetic_picture.edges_nm.tolist()
    assert image.attribute("bands") == "band means, W m^-2 sr^-1 nm^-1"
    assert image.attribute("scene_name") == "small"
    assert image.attribute("version") == "0.1.0"
    assert image.attribute("no such thing") is None


def test_a_large_seed_survives(synthetic_picture, tmp_path):
    settings = dataclasses.replace(synthetic_picture.settings, seed=2**62 + 1)
    dataclasses.replace(synthetic_picture, settings=settings).save_exr(tmp_path / "out.exr")
    assert read_exr(tmp_path / "out.exr").attribute("seed") == str(2**62 + 1)


def test_read_exr_gives_the_picture_back(exr, synthetic_picture):
    image = read_exr(str(exr))
    np.testing.assert_array_equal(image.wavelengths_nm, synthetic_picture.wavelengths_nm)
    expected = synthetic_picture.spectral_radiance
    np.testing.assert_allclose(image.spectral_radiance, expected, rtol=FLOAT32_ROUNDING)
    expected = synthetic_picture.standard_error
    np.testing.assert_allclose(image.standard_error, expected, rtol=ERROR_BAR_ROUNDING)
    assert image.linear_rgb.shape == (8, 12, 3)
    accuracy = synthetic_picture.accuracy
    np.testing.assert_allclose(image.luminance_noise, accuracy.noise, rtol=ERROR_BAR_ROUNDING)
    np.testing.assert_allclose(image.luminance_bias, accuracy.bias, rtol=ERROR_BAR_ROUNDING)
    assert json.loads(image.attribute("accuracy")) == accuracy.summary()
    assert image.attribute("stopping") == "all passes"
    assert image.other_channels == ()


def test_without_an_error_estimate_there_are_no_error_channels(synthetic_picture, tmp_path):
    unknown = np.full_like(synthetic_picture.standard_error, np.nan)
    path = tmp_path / "out.exr"
    dataclasses.replace(synthetic_picture, standard_error=unknown).save_exr(path)
    assert read_exr(path).standard_error is None


def test_arrays_in_any_memory_order_are_written_right(synthetic_picture, exr, tmp_path):
    shuffled = np.asfortranarray(synthetic_picture.spectral_radiance)
    path = tmp_path / "fortran.exr"
    dataclasses.replace(synthetic_picture, spectral_radiance=shuffled).save_exr(path)
    np.testing.assert_array_equal(read_exr(path).spectral_radiance, read_exr(exr).spectral_radiance)


def test_equal_pictures_give_equal_files(synthetic_picture, exr, tmp_path):
    other_threads = dataclasses.replace(synthetic_picture.settings, threads=7)
    again = dataclasses.replace(synthetic_picture, settings=other_threads, timings={})
    again.save_exr(tmp_path / "again.exr")
    assert (tmp_path / "again.exr").read_bytes() == exr.read_bytes()


def test_bands_are_sorted_by_wavelength_not_by_name(tmp_path):
    # By name "S0.1000nm" comes before "S0.999nm".
    values = {"S0.1000nm": 2.0, "S0.999nm": 1.0, "S0.0,5um": 0.0, "depth": 9.0}
    write(tmp_path / "out.exr", {name: constant(value) for name, value in values.items()})
    image = read_exr(tmp_path / "out.exr")
    np.testing.assert_allclose(image.wavelengths_nm, [500.0, 999.0, 1000.0])
    np.testing.assert_array_equal(image.spectral_radiance[0, 0], [0.0, 1.0, 2.0])
    assert image.other_channels == ("depth",)
    assert image.linear_rgb is None


def test_a_picture_without_spectrum_is_told(tmp_path):
    write(tmp_path / "rgb.exr", {name: constant(0.5) for name in "RGB"})
    with pytest.raises(FileFormatError, match="no spectral radiance; its channels: B, G, R"):
        read_exr(tmp_path / "rgb.exr")


@pytest.mark.parametrize("content", [b"", b"PNG", b"not an exr at all" * 100])
def test_other_files_are_told(tmp_path, content):
    (tmp_path / "in.exr").write_bytes(content)
    with pytest.raises(FileFormatError, match="not an OpenEXR file"):
        read_exr(tmp_path / "in.exr")


@pytest.mark.parametrize("kept", [4, 8, 100, 1000, 0.3, 0.5, 0.9, 0.99, -1])
def test_files_cut_off_anywhere_are_told_once(exr, kept, capfd):
    content = exr.read_bytes()
    end = int(kept * len(content)) if isinstance(kept, float) else kept
    exr.write_bytes(content[:end])
    with pytest.raises(FileFormatError, match="damaged or cut off"):
        read_exr(exr)
    assert capfd.readouterr() == ("", "")


def test_garbage_inside_is_told_once(tmp_path, capfd):
    path = tmp_path / "in.exr"
    write(path, {"S0.550nm": np.random.default_rng(3).random((64, 64), np.float32)})
    content = bytearray(path.read_bytes())
    middle = len(content) // 2
    content[middle : middle + 300] = b"\xff" * 300
    path.write_bytes(content)
    with pytest.raises(FileFormatError, match="damaged or cut off"):
        read_exr(path)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(("name", "error"), [("no.exr", FileNotFoundError), ("", OSError)])
def test_files_that_cannot_be_opened(tmp_path, name, error):
    with pytest.raises(error):
        read_exr(tmp_path / name)
