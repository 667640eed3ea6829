"""What the tests of scenes share: the problems of a text that must not load."""

from collections.abc import Callable

import pytest

import scenes


@pytest.fixture
def problems() -> Callable[[str], dict[str, scenes.Problem]]:
    """Loads a text that is wrong, and returns its problems by path."""

    def load(text: str) -> dict[str, scenes.Problem]:
        with pytest.raises(scenes.SceneError) as caught:
            scenes.loads(text)
        return {problem.path: problem for problem in caught.value.problems}

    return load
