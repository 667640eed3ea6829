"""Where an error is: from pydantic's locations to places in a scene file and in the models.

Pydantic locates an error by field names and list indices, and by the tag of the union member it
chose (`objects, 0, shape, sphere, radius`), which no file contains. So the location is walked down
the models: what is a field or an index is kept, what only chooses a model is not.
"""

import re
import types
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel

from scenes.errors import shown

__all__ = ["Place", "key_path"]


def key_path(parent: str, key: str | int) -> str:
    """The path of a key of the table, or of an index of the array, at `parent`."""
    if isinstance(key, int):
        return f"{parent}[{key}]"
    written = key if re.fullmatch(r"[A-Za-z0-9_-]{1,80}", key) else shown(key)
    return f"{parent}.{written}" if parent else written


@dataclass
class Place:
    """A place in a scene file, and what the models say about it.

    Attributes:
        path: As written in the file, "" at the root.
        key: The last key or index of the path.
        tables: The models that could stand here; several where a `type` has not chosen yet.
        description: What the field is, in words; "" if there is no such field.
        parent: The place that this one is a key or an index of.
    """

    path: str = ""
    key: str | int = ""
    tables: list[type[BaseModel]] = field(default_factory=list)
    description: str = ""
    parent: "Place | None" = None
    annotation: Any = None

    @classmethod
    def at(cls, location: Iterable[str | int], model: type[BaseModel]) -> "Place":
        """The place of an error.

        Args:
            location: The error's `loc`.
            model: The model that the location starts from.
        """
        place = cls(tables=[model], annotation=model)
        for element in location:
            if isinstance(element, str) and place._is_tag(element):
                place._choose(element)
            else:
                place = place._enter(element)
        return place

    @property
    def keys(self) -> list[str]:
        """The keys that a table here may have, sorted."""
        return sorted({key for table in self.tables for key in table.model_fields})

    @property
    def types(self) -> list[str]:
        """The values of `type` that a table here may have, sorted; none if it has no `type`."""
        return sorted({tag for table in self.tables for tag in _tags(table)})

    @property
    def length(self) -> int | None:
        """How many elements an array here must have; None if their number is free."""
        arguments = _tuple_arguments(self.annotation)
        return len(arguments) if arguments and arguments[-1] is not ... else None

    def _is_tag(self, element: str) -> bool:
        return element.startswith("<") or (len(self.tables) > 1 and element in self.types)

    def _choose(self, tag: str) -> None:
        self.tables = [table for table in self.tables if tag in _tags(table)] or self.tables

    def _enter(self, element: str | int) -> "Place":
        path = key_path(self.path, element)
        if isinstance(element, str):
            info = self.tables[0].model_fields.get(element) if self.tables else None
            annotation, description = (
                (info.annotation, info.description or "") if info else (None, "")
            )
        else:
            arguments = _tuple_arguments(self.annotation)
            is_listed = 0 <= element < len(arguments) and arguments[-1] is not ...
            index = element if is_listed else 0
            annotation, description = (arguments[index] if arguments else None), self.description
        return Place(path, element, list(_tables_in(annotation)), description, self, annotation)


def _tuple_arguments(annotation: Any) -> tuple[Any, ...]:
    """What a tuple type is made of, also if it is annotated or optional; () for another type."""
    if get_origin(annotation) is tuple:
        return get_args(annotation)
    if get_origin(annotation) is Annotated:
        return _tuple_arguments(get_args(annotation)[0])
    if get_origin(annotation) in (Union, types.UnionType):
        return next(filter(None, map(_tuple_arguments, get_args(annotation))), ())
    return ()


def _tables_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """The models that an annotation mentions."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    elif get_origin(annotation) in (Annotated, Union, types.UnionType, tuple):
        for argument in get_args(annotation):
            yield from _tables_in(argument)


def _tags(table: type[BaseModel]) -> tuple[str, ...]:
    """The values of `type` that choose a model."""
    info = table.model_fields.get("type")
    return get_args(info.annotation) if info and get_origin(info.annotation) is Literal else ()
