import numpy as np
import pytest

from scenes import Disk, Plane, Rectangle, SceneError, Sphere
from scenes.shapes import Box, Lens, Polyhedron, Prism


def test_a_floor_is_the_default_rectangle() -> None:
    floor = Rectangle(position=(0.0, 0.0, 0.0), size=(3.0, 4.0))
    np.testing.assert_array_equal(floor.frame(), [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    _, radius = floor.bounding_sphere()
    assert radius == 2.5


def test_up_turns_a_rectangle_in_its_plane() -> None:
    tilted = Rectangle(
        position=(0.0, 0.0, 0.0), size=(1.0, 1.0), normal=(0, 0, 1), up=(1.0, 0.0, 5.0)
    )
    u, v, n = tilted.frame()
    np.testing.assert_allclose(v, [1.0, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(u, [0.0, -1.0, 0.0], atol=1e-15)
    np.testing.assert_array_equal(n, [0.0, 0.0, 1.0])


def test_up_along_the_normal() -> None:
    with pytest.raises(SceneError, match="up: must be a direction not parallel to the normal"):
        Rectangle(position=(0, 0, 0), size=(1.0, 1.0), normal=(0, 0, 1), up=(0, 0, 1))


def test_which_shapes_can_be_filled() -> None:
    assert not (Plane.is_closed or Rectangle.is_closed or Disk.is_closed)
    assert all(shape.is_closed for shape in (Sphere, Box, Prism, Polyhedron, Lens))


def test_round_shapes_are_their_own_bounds() -> None:
    for shape in (
        Sphere(position=(1.0, 2.0, 3.0), radius=0.5),
        Disk(position=(1.0, 2.0, 3.0), radius=0.5, normal=(0, 1, 0)),
    ):
        centre, radius = shape.bounding_sphere()
        np.testing.assert_array_equal(centre, [1.0, 2.0, 3.0])
        assert radius == 0.5
