"""The scene: everything a scene file holds."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import (
    Field,
    PrivateAttr,
    Strict,
    ValidationInfo,
    field_validator,
    model_validator,
)

from scenes.camera import Camera
from scenes.checks import MOST_OBJECTS, cross_problems
from scenes.emitters import AnyEmitter, Glowing
from scenes.errors import Problem, SceneError, refusal
from scenes.fields import Count, Size, is_file
from scenes.film import Film
from scenes.materials import Lambertian
from scenes.media import AMBIENT_NAMES, AmbientSpec, resolve_medium
from scenes.model import SceneModel
from scenes.objects import SceneObject
from scenes.sensors import AnySensor
from spectra import Medium

__all__ = ["RenderDefaults", "Scene"]


class RenderDefaults(SceneModel):
    """How this scene is best rendered, unless one asks for something else."""

    photons: Count | None = Field(default=None, description="photons emitted in a pass")
    passes: Count | None = Field(default=None, description="number of passes")
    radius: Size | None = Field(
        default=None, description="radius of the first pass's photon gathering (length)"
    )
    max_interactions: Count | None = Field(
        default=None, description="surfaces a path may meet before it is given up"
    )
    bounces: Annotated[int, Strict(), Field(ge=0, le=1000)] | None = Field(
        default=None,
        description="diffuse surfaces that light may be reflected by on its way to the one that is"
        " seen, 0 to 1000",
    )


class Scene(SceneModel):
    """A scene; all lengths in metres, whatever its file uses."""

    title: str = Field(default="", description="what the scene shows, in a few words")
    description: str = Field(default="", description="what there is to know about it")
    length_unit: Literal["m", "mm"] = Field(
        default="m", description="unit of every length in the file"
    )
    ambient: AmbientSpec = Field(
        default="reference",
        description='what surrounds the objects: "reference" takes every index as its source'
        ' states it, "air" and "vacuum" convert to that, and a medium immerses the scene in it',
    )
    film: Film = Field(default=Film(), description="pixels and wavelength bands")
    camera: Camera | None = Field(default=None, description="where the picture is taken from")
    render: RenderDefaults = Field(
        default=RenderDefaults(), description="settings this scene is best rendered with"
    )
    objects: tuple[SceneObject, ...] = Field(
        default=(), max_length=MOST_OBJECTS, description="what light meets"
    )
    emitters: tuple[AnyEmitter, ...] = Field(
        default=(), max_length=1000, description="where light comes from"
    )
    sensors: tuple[AnySensor, ...] = Field(
        default=(), max_length=1000, description="where light is measured"
    )

    _source_name: str = PrivateAttr(default="scene")
    _source_text: str | None = PrivateAttr(default=None)

    @property
    def source_name(self) -> str:
        """Name of the gallery scene or stem of the file it was read from, else "scene"."""
        return self._source_name

    @property
    def source_text(self) -> str:
        """The TOML text that gives this scene: as it was read, else as `to_toml` writes it."""
        return self.to_toml() if self._source_text is None else self._source_text

    def resolved_ambient(self) -> Medium | Literal["reference", "air", "vacuum"]:
        """What surrounds the objects: a medium, or one of the words for none."""
        if self.ambient in AMBIENT_NAMES:
            return self.ambient  # type: ignore[return-value]
        return resolve_medium(self.ambient)

    def to_toml(self) -> str:
        """The scene as the text of a scene file, in metres; loading it gives the same scene."""
        import tomli_w

        return tomli_w.dumps(self.model_dump(exclude_none=True))

    def require_renderable(self) -> None:
        """Make sure that a picture can be taken.

        Raises:
            SceneError: if camera, emitters, light of recorded wavelengths or what shows it are
                missing.
        """
        problems = []
        if self.camera is None:
            problems.append(_lacking("camera", "a table [camera] with position and look_at"))
        problems += self._dark("a picture")
        receives = any(isinstance(one.material, Lambertian) for one in self.objects)
        shows = any(isinstance(one, Glowing) and one.visible for one in self.emitters)
        if not receives and not shows:
            allowed = "at least one [[objects]] with a lambertian material, to receive light,"
            allowed += " or a lamp that can be seen"
            problems.append(_lacking("objects", allowed))
        if problems:
            raise SceneError(self.source_name, problems)

    def require_measurable(self) -> None:
        """Make sure that light can be measured.

        Raises:
            SceneError: if sensors, emitters or light of recorded wavelengths are missing.
        """
        problems = self._dark("a measurement")
        if not self.sensors:
            allowed = 'at least one [[sensors]], of type "irradiance" or "rays"'
            problems.append(_lacking("sensors", allowed, "a measurement"))
        if problems:
            raise SceneError(self.source_name, problems)

    def _dark(self, purpose: str) -> list[Problem]:
        """What is wrong if nothing shines."""
        if not self.emitters:
            return [_lacking("emitters", "at least one [[emitters]]", purpose)]
        if any(one.emission().band_flux(self.film.edges_nm).any() for one in self.emitters):
            return []
        low, high = self.film.edges_nm[[0, -1]]
        allowed = f"an emitter that shines between {low:g} and {high:g} nm"
        message = f"none gives light that the film records; it needs {allowed}"
        return [Problem("emitters", message, None, allowed)]

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """A copy; if changed, it no longer claims to be what its file's text says."""
        copy = super().model_copy(update=update, deep=deep)
        if update:
            copy._source_text = None
        return copy

    @field_validator("length_unit", mode="after")
    @classmethod
    def _lengths_are_in_metres_now(cls, unit: str, info: ValidationInfo) -> str:
        if unit != "m" and not is_file(info):
            allowed = "'m': only files are converted, models built in Python are in metres"
            raise refusal(Problem("", f"must be {allowed}", unit, allowed))
        return "m"

    @field_validator("objects", "emitters", "sensors", mode="after")
    @classmethod
    def _everything_has_a_name(cls, entries: tuple[Any, ...], info: ValidationInfo) -> Any:
        return tuple(
            one if one.name else one.model_copy(update={"name": f"{info.field_name}[{index}]"})
            for index, one in enumerate(entries)
        )

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        problems = cross_problems(
            film=self.film,
            ambient=self.ambient,
            objects=dict(enumerate(self.objects)),
            emitters=dict(enumerate(self.emitters)),
            sensors=dict(enumerate(self.sensors)),
        )
        stops = self.film.exposure_stops
        if stops is not None and self.camera is not None and self.camera.exposure is not None:
            allowed = "left out where the camera has an exposure"
            problems.append(
                Problem("film.exposure_stops", f"must be {allowed}", stops, allowed)
            )
        if problems:
            raise refusal(*problems)
        return self


def _lacking(field: str, allowed: str, purpose: str = "a picture") -> Problem:
    return Problem(field, f"missing; {purpose} needs {allowed}", None, allowed)
