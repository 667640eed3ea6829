"""Readings as files: what was measured comes back, with all that it takes to measure it again."""

import io
import json

import numpy as np
import pytest

import scenes
import sim

FILM = scenes.Film(first_nm=500.0, last_nm=600.0, bands=3)


def make_scene():
    disk = scenes.Disk(position=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0), radius=0.5)
    square = scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 1.0))
    return scenes.Scene(
        sensors=(
            scenes.IrradianceSensor(name="disk", shape=disk, pixels=(5, 4), bands=2),
            scenes.RaySensor(name="rays", shape=square, max_rays=2000),
        ),
        emitters=(scenes.Point(position=(0.0, 1.0, 0.0), flux=1.0, spectrum="E"),),
        film=FILM,
    )


@pytest.fixture(scope="module")
def measurement():
    return sim.measure(make_scene(), sim.RenderSettings(photons=2000, passes=3, seed=5))


def test_an_exr_holds_irradiance_and_its_error(measurement, tmp_path):
    reading = measurement.sensors["disk"]
    reading.save_exr(tmp_path / "disk.exr")
    image = sim.read_exr(tmp_path / "disk.exr")
    np.testing.assert_array_equal(
        image.spectral_radiance, reading.spectral_irradiance.astype(np.float32)
    )
    np.testing.assert_allclose(image.standard_error, reading.standard_error, rtol=1 / 256)
    np.testing.assert_allclose(image.wavelengths_nm, reading.wavelengths_nm)
    assert image.attributes["emissiveUnits"] == "W.m^-2.nm^-1"
    assert "irradiance" in image.attribute("bands")
    assert image.attribute("media") == "reference"
    assert image.attribute("sensor") == "disk"
    np.testing.assert_allclose(image.linear_rgb, reading.linear_rgb, rtol=1e-6, atol=1e-12)


def test_the_file_measures_itself_again(measurement, tmp_path):
    measurement.sensors["disk"].save_exr(tmp_path / "disk.exr")
    image = sim.read_exr(tmp_path / "disk.exr")
    scene = scenes.loads(image.attribute("scene"))
    settings = sim.RenderSettings(**json.loads(image.attribute("settings")))
    again = sim.measure(scene, settings).sensors["disk"]
    np.testing.assert_array_equal(
        again.spectral_irradiance, measurement.sensors["disk"].spectral_irradiance
    )


def test_archives_hold_every_array(measurement, tmp_path):
    for name, reading in measurement.sensors.items():
        reading.save_npz(tmp_path / f"{name}.npz")
        with np.load(tmp_path / f"{name}.npz", allow_pickle=False) as held:
            arrays = {key: held[key] for key in held.files}
        assert arrays["sensor"] == name
        assert json.loads(str(arrays["energy"]))["emitted"] == measurement.energy.emitted
        assert json.loads(str(arrays["sensor_table"]))["type"] == reading.sensor.type
        for key, values in arrays.items():
            if values.dtype.kind not in "US":
                np.testing.assert_array_equal(values, getattr(reading, key))
    assert {"position", "direction", "wavelength_nm", "flux", "refractions"} <= arrays.keys()


def test_readings_say_what_they_are(measurement):
    disk, rays = measurement.sensors["disk"], measurement.sensors["rays"]
    assert disk.summary.startswith("5 × 4 cells, 2 bands; ")
    assert disk.summary.endswith(" W in reference")
    assert f" ± {disk.flux_error:.2g} W" in disk.summary
    assert rays.summary.startswith(f"{len(rays)} rays of {rays.crossings}; ")
    # Illuminance is 683 ∫ ȳ E dλ: at 555 nm a watt is nearly 683 lm, and less elsewhere.
    assert np.all(disk.illuminance < 683.0 * disk.irradiance + 1e-12)
    assert np.all(disk.illuminance[disk.areas > 0.0] > 300.0 * disk.irradiance[disk.areas > 0.0])


def test_one_pass_knows_no_error():
    reading = sim.measure(make_scene(), sim.RenderSettings(photons=500, passes=1)).sensors["disk"]
    assert np.isnan(reading.standard_error).all()
    assert np.isnan(reading.flux_error)
    assert "±" not in reading.summary
    stream = io.BytesIO()
    from sim.sensors.sensor_files import irradiance_exr

    stream.write(irradiance_exr(reading))
    assert b"standardError" not in stream.getvalue()
