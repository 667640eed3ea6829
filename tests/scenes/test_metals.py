import numpy as np
import pytest

import scenes
from scenes import Metal, MetalTable, SceneError
from spectra import conductor

TABLE = MetalTable(wavelength_nm=(400.0, 700.0), n=(0.5, 1.0), k=(3.0, 6.0))


def test_a_named_metal_is_the_tables() -> None:
    assert Metal(metal="gold").resolved() is conductor("gold")


def test_an_inline_metal_is_linear_between_its_entries() -> None:
    metal = Metal(metal=TABLE).resolved()
    assert metal.eta(550.0) == 0.75
    np.testing.assert_array_equal(metal.k(np.array([400.0, 550.0, 700.0])), [3.0, 4.5, 6.0])
    assert metal.source == "described in the scene"


def test_an_unknown_metal_is_told_with_the_nearest() -> None:
    with pytest.raises(SceneError, match="metal: unknown metal 'aluminum'; nearest: aluminium"):
        Metal(metal="aluminum")


@pytest.mark.parametrize(
    ("n", "k", "message"),
    [
        ((0.5, 0.5, 0.0), (3.0, 3.0, 3.0), r"n\[2\]: must be greater than 0"),
        ((0.5, 0.5, 0.5), (3.0, 3.0, -1.0), r"k\[2\]: must be at least 0"),
        ((0.5, 0.5, 0.5), (3.0, 3.0), r"k: must have as many numbers as wavelength_nm has \(3\)"),
        ((0.5, 0.5), (3.0, 3.0, 3.0), r"n: must have as many numbers as wavelength_nm has \(3\)"),
        ((0.5, 0.5, 1e4), (3.0, 3.0, 3.0), r"n\[2\]: must be at most 1000"),
    ],
)
def test_tables_that_are_no_metal(n: tuple[float, ...], k: tuple[float, ...], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        MetalTable(wavelength_nm=(400.0, 550.0, 700.0), n=n, k=k)


SCENE = """
[[objects]]
shape = { type = "disk", position = [0, 0, 0], normal = [0, 1, 0], radius = 1 }
material = { type = "conductor", metal = METAL }
"""


def test_a_table_must_cover_the_wavelengths_used() -> None:
    wide = '{ wavelength_nm = [395, 705], n = [0.5, 1], k = [3, 6], source = "measured" }'
    scene = scenes.loads(SCENE.replace("METAL", wide))
    assert scenes.loads(scene.to_toml()).model_dump() == scene.model_dump()
    with pytest.raises(SceneError) as caught:
        scenes.loads(SCENE.replace("METAL", wide.replace("395", "400")))
    (problem,) = caught.value.problems
    assert problem.path == "objects[0].material.metal"
    assert "known between 400 and 705 nm" in problem.message
    with pytest.raises(SceneError, match=r"silver is known between 187\.9 and 1937 nm"):
        scenes.loads(
            "film = { first_nm = 1900, last_nm = 2000 }" + SCENE.replace("METAL", '"silver"')
        )
