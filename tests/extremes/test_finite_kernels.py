"""No NaN and no infinity leaves a kernel: gallery scenes by Warp's floating-point verification.

See `verified_rendering.py`, which does the whole gallery if it is not told otherwise. Infinite by
intention are the limits of flat things without an edge, and these are only read.
"""

import re
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).parent / "verified_rendering.py"
SCENES = ("prism:float64", "ball:float32")

REPORT = re.compile(r"array\.h:\d+ - (\w+)\(")


@pytest.fixture(scope="module")
def printed():
    """Lines that the program has printed."""
    done = subprocess.run(
        [sys.executable, str(PROGRAM), *SCENES], capture_output=True, text=True, check=True
    )
    return done.stdout.splitlines()


def test_the_verification_sees_a_nan(printed):
    found = [line for line in printed[printed.index("now a NaN") :] if REPORT.search(line)]
    assert len(found) == 1
    assert "store" in found[0]
    assert "nan" in found[0]


def test_gallery_scenes_are_finite_from_end_to_end(printed):
    lines = printed[: printed.index("now a NaN")]
    assert sum(line.startswith("rendered") for line in lines) == len(SCENES)
    found = [line for line in lines if REPORT.search(line)]
    assert [line for line in found if not line.endswith("load(addrinf")] == []
