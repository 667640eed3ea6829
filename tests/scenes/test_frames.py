import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenes.frames import frame_about, rotation_matrix

angles = st.floats(-720.0, 720.0)
components = st.floats(-1.0, 1.0)


def test_quarter_turns_are_exact() -> None:
    # x -> y -> z -> x, right-handed: a turn about z takes x to y.
    assert rotation_matrix((0.0, 0.0, 90.0)).tolist() == [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    assert rotation_matrix((90.0, 0.0, 0.0)).tolist() == [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
    assert rotation_matrix((0.0, 90.0, 0.0)).tolist() == [[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
    assert rotation_matrix((0.0, -450.0, 180.0)).tolist() == [[0, 0, 1], [0, -1, 0], [1, 0, 0]]


def test_the_x_turn_comes_first_and_the_axes_stay_fixed() -> None:
    about_x, about_y, about_z = (
        rotation_matrix((10.0, 0.0, 0.0)),
        rotation_matrix((0.0, 20.0, 0.0)),
        rotation_matrix((0.0, 0.0, 30.0)),
    )
    combined = rotation_matrix((10.0, 20.0, 30.0))
    np.testing.assert_allclose(combined, about_z @ about_y @ about_x, atol=1e-15)


@given(st.tuples(angles, angles, angles))
@settings(deadline=None)
def test_a_rotation_keeps_lengths_and_handedness(rotation: tuple[float, float, float]) -> None:
    matrix = rotation_matrix(rotation)
    # Products of three matrices of entries rounded to 1.1e-16: errors of some 1e-16.
    np.testing.assert_allclose(matrix @ matrix.T, np.eye(3), atol=2e-15)
    assert np.linalg.det(matrix) == pytest.approx(1.0, abs=2e-15)


@given(st.tuples(components, components, components).filter(lambda v: np.linalg.norm(v) > 1e-3))
@settings(deadline=None)
def test_a_frame_is_orthonormal_and_right_handed(vector: tuple[float, float, float]) -> None:
    normal = np.array(vector) / np.linalg.norm(vector)
    frame = frame_about((normal[0], normal[1], normal[2]))
    assert frame is not None
    u, v, n = frame
    # The cross product loses up to 1/sin(2.6°) = 22 of the rounding errors of its factors.
    np.testing.assert_allclose(np.array(frame) @ np.array(frame).T, np.eye(3), atol=2e-14)
    np.testing.assert_allclose(np.cross(u, v), n, atol=2e-14)


def test_default_frames_of_walls_and_floors() -> None:
    wall = frame_about((0.0, 0.0, 1.0))
    floor = frame_about((0.0, 1.0, 0.0))
    assert wall is not None
    assert floor is not None
    np.testing.assert_array_equal(wall, np.eye(3))
    np.testing.assert_array_equal(floor, [[1, 0, 0], [0, 0, -1], [0, 1, 0]])


def test_an_up_parallel_to_the_normal_has_no_frame() -> None:
    assert frame_about((0.0, 1.0, 0.0), (0.0, 1.0, 0.0)) is None
    assert frame_about((0.0, 1.0, 0.0), (0.0, -1.0, 0.0)) is None
