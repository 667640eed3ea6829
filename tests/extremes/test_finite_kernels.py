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
import sys
import warp as wp

wp.config.verify_fp = True
wp.empty = wp.zeros
import scenes
import sim

name, precision = sys.argv[1:]
scene = scenes.load(name)
film = scene.film.model_copy(update={"width": 12, "height": 8})
settings = sim.RenderSettings(photons=1000, passes=1, threads=1, precision=precision)
picture = sim.render(scene.model_copy(update={"film": film}), settings)
print(f"rendered {picture.spectral_radiance.mean():.6g}", flush=True)

"""

SENTINEL = """
import warp as wp

wp.config.verify_fp = True


@wp.kernel(enable_backward=False)
def make_nan(x: wp.array(dtype=wp.float64), out: wp.array(dtype=wp.float64)):
    out[0] = wp.sqrt(x[0])


out = wp.zeros(1, dtype=wp.float64, device="cpu")
wp.launch(make_nan, dim=1, inputs=[wp.array([-1.0], dtype=wp.float64, device="cpu"), out],
          device="cpu")
"""

REPORT = re.compile(r"array\.h:\d+ - (\w+)\(")


def reports(path, program, *arguments):
    """What the verification has said of a program's arrays, and all that the program printed."""
    script = path / "program.py"
    script.write_text(program)
    done = subprocess.run(
        [sys.executable, str(script), *arguments], capture_output=True, text=True, check=True
    )
    lines = done.stdout.splitlines()
    return [line for line in lines if REPORT.search(line)], lines


def test_the_verification_sees_a_nan(tmp_path):
    found, _ = reports(tmp_path, SENTINEL)
    assert any("store" in line and "nan" in line for line in found)


@pytest.mark.parametrize(("name", "precision"), [("prism", "float64"), ("ball", "float32")])
def test_gallery_scenes_are_finite_from_end_to_end(tmp_path, name, precision):
    found, lines = reports(tmp_path, PROGRAM, name, precision)
    assert any(line.startswith("rendered") for line in lines)
    assert [line for line in found if not line.endswith("load(addrinf")] == []
