"""What a diffuse surface sends to a sensor that looks at it, against a closed form."""

import numpy as np

import scenes
import sim

RHO = 0.7
HEIGHT = 0.5
RADIUS = 0.3


def test_a_lit_spot_lights_a_sensor():
    # A thin beam's spot of radiant flux ρ Φ on a Lambertian floor, and a coaxial disk of radius a
    # at the height h that looks down at it: it gets ρ Φ sin² θ with tan θ = a/h, the part of a
    # Lambertian point's flux inside the cone (∫ cos θ dΩ/π).
    floor = scenes.SceneObject(
        name="floor",
        shape=scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(4.0, 4.0)),
        material=scenes.Lambertian(reflectance=RHO),
    )
    lamp = scenes.Beam(
        position=(0.0, 1.0, 0.0), direction=(0.0, -1.0, 0.0), flux=1.0,
        profile=scenes.RoundProfile(radius=1e-4),
        spectrum=scenes.SpectrumTable(wavelength_nm=(400.0, 700.0), values=(1.0, 1.0)),
    )
    disk = scenes.Disk(position=(0.0, HEIGHT, 0.0), normal=(0.0, -1.0, 0.0), radius=RADIUS)
    sensor = scenes.IrradianceSensor(name="sensor", shape=disk, pixels=(4, 4))
    scene = scenes.Scene(
        objects=(floor,), emitters=(lamp,), sensors=(sensor,),
        film=scenes.Film(first_nm=450.0, last_nm=650.0, bands=3),
    )
    settings = sim.RenderSettings(photons=40_000, passes=16, bounces=1)
    reading = sim.measure(scene, settings).sensors["sensor"]
    expected = RHO * RADIUS**2 / (RADIUS**2 + HEIGHT**2)
    # Student's t of 16 replicates is beyond 6 once in 4·10⁴.
    assert abs(reading.flux - expected) < 6.0 * reading.flux_error
    assert reading.flux_error < 0.01 * expected
    assert np.all(reading.irradiance > 0.0)
