"""Files that a scene names: found beside the scene's own file, and nowhere else.

A scene file from somebody else must not read what lies elsewhere on the disk, so what it names is
relative to its own folder and stays inside it, unless who loads it allows more. A model built in
Python is the program's own word: there a path may be any, relative to the current folder.
"""

from pathlib import Path

from pydantic import ValidationInfo
from pydantic_core import PydanticCustomError

from scenes.errors import Problem, reason_of, refusal, shown
from scenes.fields import folder_of, may_look_outside

__all__ = ["nearby_file"]


def nearby_file(name: str, info: ValidationInfo, *, field: str = "file") -> Path:
    """The file that a field names.

    Args:
        name: as written.
        info: of the validation, which knows the scene file's folder.
        field: path of the field, for the problem.

    Raises:
        PydanticCustomError: there is no such file, or it is not in the scene's folder.
    """
    folder = folder_of(info)
    try:
        if folder is None:
            path = Path(name)
        elif may_look_outside(info):
            path = folder / name
        else:
            path = _inside(folder, name, field)
        if path.is_file():
            return path.resolve()
    except PydanticCustomError:  # is a ValueError too
        raise
    # No path can look like this; a link to itself is a RuntimeError before Python 3.13.
    except (OSError, ValueError, RuntimeError) as error:
        message = f"{shown(name)} cannot be a path: {reason_of(error)}"
        raise refusal(Problem(field, message, name)) from None
    where = f"in {folder}" if folder is not None else "there"
    message = f"there is no file {shown(name)} {where}"
    raise refusal(Problem(field, message, name, "the path of a file"))


def _inside(folder: Path, name: str, field: str) -> Path:
    """`name` below `folder`, links and dots resolved."""
    root = folder.resolve()
    path = (root / name).resolve()
    if Path(name).is_absolute() or not path.is_relative_to(root):
        allowed = "a path relative to the scene's folder, and inside it, unless --allow-outside"
        message = f"must be {allowed}; is {shown(name)}"
        raise refusal(Problem(field, message, name, allowed))
    return path
