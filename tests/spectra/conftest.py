"""What the tests of spectra share: the published reference values, with their sources."""

import json
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="session")
def references() -> dict[str, Any]:
    path = Path(__file__).parents[1] / "references.json"
    loaded: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return loaded
