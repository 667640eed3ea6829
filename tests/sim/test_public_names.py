"""What `import sim` promises: names, and that it is light."""

import json
import os
import subprocess
import sys

import pytest

import sim

HEAVY = {"numpy", "warp", "pydantic", "scipy", "matplotlib", "colour", "OpenEXR", "rich", "PIL"}


def loaded_after(statements: str) -> set[str]:
    """Top-level modules that a fresh interpreter has loaded after some statements."""
    program = f"{statements}\nimport sys, json; print(json.dumps(list(sys.modules)))"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=True
    )
    return {name.partition(".")[0] for name in json.loads(done.stdout.splitlines()[-1])}


@pytest.mark.parametrize(
    "statements",
    [
        "import sim",
        "import sim.errors, sim.settings; sim.RenderSettings(photons=5)",
        "import sim.cli; sim.cli.main(['--help'])",
        "import sim.cli; sim.cli.main(['render', '--help'])",
        "import sim.cli; sim.cli.main(['render', 'prism', '--photons', 'many'])",
    ],
)
def test_light_things_load_nothing_heavy(statements):
    assert loaded_after(statements) & HEAVY == set()


def test_names_are_sorted_and_all_there():
    assert sim.__all__ == sorted(sim.__all__)
    for name in sim.__all__:
        assert getattr(sim, name) is not None
        assert name in dir(sim)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'sim' has no attribute 'no_such_name'"):
        _ = sim.no_such_name


def test_the_module_render_does_not_hide_the_function():
    import sim.render

    assert callable(sim.render)
    assert sys.modules["sim.render"] is not sim.render
