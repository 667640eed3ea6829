"""The base of every model of a scene: frozen, without unknown keys, and with one exception."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from scenes.errors import SceneError
from scenes.translation import problems_of

__all__ = ["SceneModel", "plain_or_table"]


class SceneModel(BaseModel):
    """A frozen table of a scene file, or the same thing built in Python (lengths in metres)."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    if not TYPE_CHECKING:  # the type checker should see the fields as arguments, not these

        def __init__(self, **fields: Any) -> None:
            """Check the fields.

            Raises:
                SceneError: if any is wrong, with every problem.
            """
            try:
                super().__init__(**fields)
            except ValidationError as error:
                name = type(self).__name__
                raise SceneError(name, problems_of(error, type(self))) from None

        # Without this mark pydantic would build nested tables through __init__ as well, and
        # each would end in an exception of its own instead of in one list of problems.
        __init__.__pydantic_base_init__ = True


def plain_or_table(value: Any) -> Literal["<plain>", "<table>"]:
    """The tag of a field that takes a plain value (a name, a number) or a table in its place.

    The angle brackets tell `scenes.translation` that the tag is no part of the field's path.
    """
    return "<table>" if isinstance(value, Mapping | BaseModel) else "<plain>"
