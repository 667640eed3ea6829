"""colour-science, imported without what else its import does."""

import importlib
import warnings
from types import ModuleType

import numpy as np

__all__ = ["import_colour_science"]


def import_colour_science() -> ModuleType:
    """Import colour-science, which takes more than a second, and leave NumPy as it was."""
    # colour-science puts mock modules in the place of SciPy and Matplotlib when it finds none,
    # and a mock's savefig() "succeeds"; these imports fail in plain words instead.
    for real in ("scipy", "matplotlib"):
        importlib.import_module(real)
    print_options = np.get_printoptions()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message='".*" related API features are not available')
        import colour
    np.set_printoptions(**print_options)  # Importing it changes them.
    return colour
