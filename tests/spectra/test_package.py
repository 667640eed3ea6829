import subprocess
import sys
from pathlib import Path

import spectra

HEAVY = ("colour", "matplotlib", "scipy", "warp")


def test_importing_spectra_is_light() -> None:
    program = f"import sys, spectra; print([name for name in {HEAVY} if name in sys.modules])"
    finished = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=Path(spectra.__file__).parents[1],
        capture_output=True,
        text=True,
        check=True,
    )
    assert finished.stdout.strip() == "[]"


def test_public_names_are_there_and_unique() -> None:
    assert len(set(spectra.__all__)) == len(spectra.__all__)
    for name in spectra.__all__:
        assert getattr(spectra, name) is not None
