"""Media, mirrors and metals as kernels read them: what scenes say at every wavelength."""

import functools

import numpy as np
import pytest
import warp as wp

import scenes
from sim.device import start_device
from sim.features import Features
from sim.optics.dispersion import tabulated_index
from sim.path_media import make_media_functions
from sim.scene_data import compile_scene
from sim.scene_media import collect_media
from sim.scene_structs import make_scene_structs
from spectra import Absorption, conductor

NM = np.linspace(420.0, 680.0, 131)
FILM = scenes.Film(first_nm=450.0, last_nm=650.0, bands=5)
TABLE = scenes.CoefficientTable(wavelength_nm=(400.0, 500.0, 700.0), values=(3.0, 0.0, 40.0))
SPECS = (
    None,
    scenes.NapierianAbsorption(coefficient=2.5),
    scenes.NapierianAbsorption(coefficient=TABLE),
    scenes.DecadicAbsorption(coefficient=1.5),
    scenes.ExtinctionAbsorption(k=1e-6),
    scenes.InternalTransmittance(thickness=0.01, transmittance=0.9),
)
TINT = scenes.ReflectanceTable(wavelength_nm=(500.0, 600.0), values=(0.2, 0.9))
FINISHES = (
    scenes.Mirror(), scenes.Mirror(reflectance=0.25), scenes.Mirror(reflectance=TINT),
    scenes.Metal(metal="gold"), scenes.Metal(metal="aluminium"), scenes.Metal(metal="gold"),
)  # fmt: skip


def make_scene():
    """Far apart, one solid of each absorption and one ball of each finish."""
    objects = [
        scenes.SceneObject(
            name=f"solid {k}", shape=scenes.Sphere(position=(4.0 * k, 0, 0), radius=1.0),
            material=scenes.Dielectric(medium="N-BK7", absorption=spec),
        )
        for k, spec in enumerate(SPECS)
    ]
    objects += [
        scenes.SceneObject(
            name=f"finish {k}", shape=scenes.Sphere(position=(4.0 * k, 9.0, 0), radius=1.0),
            material=material,
        )
        for k, material in enumerate(FINISHES)
    ]  # fmt: skip
    return scenes.Scene(film=FILM, objects=objects)


@functools.cache
def make_probe(precision, count):
    structs = make_scene_structs(precision)
    real, scene_type = structs.real, structs.Scene
    media = make_media_functions(precision, Features(media_count=count))
    media_indices, absorption_of = media.media_indices, media.absorption_of
    wavelength_of = media.wavelength_of

    @wp.kernel(module=f"tests_scene_optics_{precision}", enable_backward=False)
    def probe(
        scene: scene_type, nm: wp.array(dtype=real), finishes: int,
        out_eta: wp.array2d(dtype=real), out_alpha: wp.array2d(dtype=real),
        out_first: wp.array2d(dtype=real), out_k: wp.array2d(dtype=real),
        out_nm: wp.array(dtype=real),
    ):  # fmt: skip
        i = wp.tid()
        indices = media_indices(scene, nm[i])
        out_nm[i] = wavelength_of(indices)
        for medium in range(out_eta.shape[1]):
            out_eta[i, medium] = indices[medium]
            out_alpha[i, medium] = absorption_of(indices, medium)
        for k in range(finishes):
            row = scene.finishes[k]
            out_first[i, k] = tabulated_index(
                scene.knots_nm, scene.cubics, row.first, row.count, nm[i]
            )
            if row.k_count > 0:
                out_k[i, k] = tabulated_index(
                    scene.knots_nm, scene.cubics, row.k_first, row.k_count, nm[i]
                )

    return probe


@pytest.fixture(scope="module", params=["float64", "float32"])
def read(request):
    device = start_device("cpu")
    scene = make_scene()
    made_of = collect_media(scene)
    compiled = compile_scene(scene, precision=request.param)
    structs = make_scene_structs(request.param)
    count = len(made_of.media)
    shapes = [(len(NM), count)] * 2 + [(len(NM), len(made_of.finishes))] * 2 + [len(NM)]
    outs = [wp.zeros(shape, dtype=structs.real, device=device) for shape in shapes]
    inputs = [compiled.data, wp.array(NM, dtype=structs.real, device=device),
              len(made_of.finishes)]  # fmt: skip
    wp.launch(make_probe(request.param, count), dim=len(NM), inputs=inputs, outputs=outs,
              device=device)  # fmt: skip
    values = [one.numpy().astype(np.float64) for one in outs]
    return made_of, compiled, float(np.finfo(request.param).eps), values


def test_media_absorb_what_the_scene_says(read):
    made_of, _, eps, (eta, alpha, _, _, nm) = read
    np.testing.assert_allclose(nm, NM, rtol=eps)
    for k, medium in enumerate(made_of.media):
        absorption = medium.absorption or Absorption((0.0,))
        expected = absorption.coefficient(NM)
        # A table's slope, 0.2 per nm, times the wavelength's own rounding, 700 nm ε/2.
        np.testing.assert_allclose(alpha[:, k], expected, rtol=8 * eps, atol=200 * eps)
        np.testing.assert_allclose(eta[:, k], medium.dispersion.eta(NM), rtol=8 * eps)


def test_finishes_are_kept_once_each_and_read_right(read):
    made_of, compiled, eps, (_, _, first, k, _) = read
    assert made_of.finishes == FINISHES[:5]
    assert made_of.finish_of[-1] == made_of.finish_of[-3]
    np.testing.assert_array_equal(first[:, 0], 1.0)
    np.testing.assert_array_equal(first[:, 1], 0.25)
    np.testing.assert_allclose(first[:, 2], np.interp(NM, (500, 600), (0.2, 0.9)), atol=8 * eps)
    for row, name in ((3, "gold"), (4, "aluminium")):
        metal = conductor(name)
        # Between entries 15 nm apart n changes by up to 0.5: 0.03 per nm, times 700 nm ε/2.
        np.testing.assert_allclose(first[:, row], metal.eta(NM), rtol=8 * eps, atol=40 * eps)
        np.testing.assert_allclose(k[:, row], metal.k(NM), rtol=8 * eps, atol=40 * eps)
    rows = compiled.data.finishes.numpy()
    assert (rows["k_count"] > 0).tolist() == [False, False, False, True, True]
    assert rows["varies"].tolist() == [0, 0, 1, 1, 1]


def test_what_depends_on_the_wavelength_is_marked():
    scene = make_scene()
    made_of = collect_media(scene)
    rows = compile_scene(scene).data.media.numpy()
    tinted = [
        one.absorption is not None and not one.absorption.is_constant for one in made_of.media
    ]
    assert rows["tints"].astype(bool).tolist() == tinted
    assert sum(tinted) == 2  # the table's, and a constant k's, whose α goes with 1/λ
    assert rows["varies"].tolist() == [0] + [1] * (len(made_of.media) - 1)


def test_a_clear_scene_has_no_such_tables():
    scene = scenes.load("ball")
    compiled = compile_scene(scene)
    features = compiled.features
    assert not (features.absorption or features.finishes or features.interfaces)
    assert not compiled.data.media.numpy()["loss_count"].any()
    media = make_media_functions("float64", features)
    assert media.Indices._length_ == features.media_count
