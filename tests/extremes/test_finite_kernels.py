"""No NaN and no infinity leaves a kernel: gallery scenes by Warp's floating-point verification.

`wp.config.verify_fp` compiles every kernel anew, with a test of each number that is read from an
array or written to one, and prints what is not finite. It also reads places before they are written
for the first time, so that arrays must not begin with whatever memory held. Infinite by intention
are the limits of flat things without an edge, and these are only read.
"""

import re
import subprocess
import sys

import pytest

PROGRAM = """
import warp as wp

wp.config.verify_fp = True
wp.empty = wp.zeros
import scenes
import sim

for name, precision in (("prism", "float64"), ("ball", "float32")):
    scene = scenes.load(name)
    film = scene.film.model_copy(update={"width": 12, "height": 8})
    settings = sim.RenderSettings(photons=1000, passes=1, threads=1, precision=precision)
    picture = sim.render(scene.model_copy(update={"film": film}), settings)
    print(f"rendered {name}: {picture.spectral_radiance.mean():.6g}", flush=True)


@wp.kernel(enable_backward=False)
def make_nan(x: wp.array(dtype=wp.float64), out: wp.array(dtype=wp.float64)):
    out[0] = wp.sqrt(x[0])


out = wp.zeros(1, dtype=wp.float64, device="cpu")
inputs = [wp.array([-1.0], dtype=wp.float64, device="cpu"), out]
print("now a NaN", flush=True)
wp.launch(make_nan, dim=1, inputs=inputs, device="cpu")
"""

REPORT = re.compile(r"array\.h:\d+ - (\w+)\(")


@pytest.fixture(scope="module")
def printed(tmp_path_factory):
    """Lines that the program has printed."""
    script = tmp_path_factory.mktemp("verified") / "program.py"
    script.write_text(PROGRAM)
    done = subprocess.run(
        [sys.executable, str(script)], capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()


def test_the_verification_sees_a_nan(printed):
    found = [line for line in printed[printed.index("now a NaN") :] if REPORT.search(line)]
    assert len(found) == 1
    assert "store" in found[0]
    assert "nan" in found[0]


def test_gallery_scenes_are_finite_from_end_to_end(printed):
    lines = printed[: printed.index("now a NaN")]
    assert sum(line.startswith("rendered") for line in lines) == 2
    found = [line for line in lines if REPORT.search(line)]
    assert [line for line in found if not line.endswith("load(addrinf")] == []
