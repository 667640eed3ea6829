"""A bench with a ball, a prism or plate, and a floor: one set of features, so one kernel."""

import numpy as np
import pytest

import scenes

ETA = 1.5
FILM = scenes.Film(width=4, height=4, first_nm=450, last_nm=650, bands=2)
"""Two bands, 350 to 550 and 550 to 750 nm."""


@pytest.fixture(scope="session")
def make_bench():
    """Make a scene: the lamp, and what of the ball, the slab and the floor is put somewhere."""
    return _make_bench


@pytest.fixture(scope="session")
def compile_bench():
    """Compile a scene in float64 on the CPU."""
    return _compile


@pytest.fixture(scope="session")
def rectangle_solid_angle():
    """Solid angles of the bins between edges u and v of a plane, seen from a height above (0, 0).

    Of the rectangle from (0, 0) to (x, y), arctan(x y / (h √(x² + y² + h²))) (Khadjavi 1968, J.
    Opt. Soc. Am. 58, 1417); differences give the others.
    """

    def solid_angle(u, v, height):
        x, y = np.meshgrid(u, v)
        corner = np.arctan(x * y / (height * np.sqrt(x**2 + y**2 + height**2)))
        return np.diff(np.diff(corner, axis=0), axis=1)

    return solid_angle


def _make_bench(lamp, *, ball=None, slab=None, floor=None, medium="N-BK7", film=FILM):
    shapes = {
        "ball": ball or scenes.Sphere(position=(0.0, -50.0, 0.0), radius=0.1),
        "slab": slab or scenes.Box(position=(1.0, -50.0, 0.0), size=(0.1, 0.1, 0.1)),
        "floor": floor or scenes.Rectangle(position=(0.0, 0.0, 0.0), size=(1.0, 1.0)),
    }
    materials = {
        "ball": scenes.Dielectric(medium=scenes.ConstantMedium(eta=ETA)),
        "slab": scenes.Dielectric(medium=medium),
        "floor": scenes.Lambertian(reflectance=0.5),
    }
    objects = tuple(
        scenes.SceneObject(name=name, shape=shape, material=materials[name])
        for name, shape in shapes.items()
    )
    return scenes.Scene(objects=objects, emitters=(lamp,), film=film)


def _compile(scene):
    from sim.device import start_device
    from sim.scene_data import compile_scene

    return compile_scene(scene, device=start_device("cpu"))
