"""Sensors: flat places that measure the light that crosses them, and take none of it away."""

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import Field, Strict

from scenes.errors import Problem
from scenes.fields import Count
from scenes.film import Film
from scenes.model import SceneModel
from scenes.shapes import Disk, Rectangle

__all__ = ["MAX_BINS", "AnySensor", "IrradianceSensor", "RaySensor", "Sensor", "bin_problems"]

MAX_BINS = 1 << 25
"""Bins of all of a scene's sensors together: three numbers of 8 bytes are kept of each."""

_MAX_RAYS = 1 << 24

_Pixels = Annotated[int, Strict(), Field(ge=1, le=16384)]


class Sensor(SceneModel):
    """A flat place where light is measured."""

    name: str = Field(
        default="",
        max_length=200,
        description='name in messages, unique; "sensors[i]" if not given',
    )
    shape: Annotated[Rectangle | Disk, Field(discriminator="type")] = Field(
        description="where it is; its front is the side that the normal points to"
    )
    sides: Literal["front", "both"] = Field(
        default="front",
        description="light of which sides counts: what arrives at the front, or at either side",
    )


class IrradianceSensor(Sensor):
    """Flux per area and wavelength, in exact bins."""

    type: Literal["irradiance"] = Field(
        default="irradiance", description="flux per area and wavelength, in bins"
    )
    pixels: tuple[_Pixels, _Pixels] = Field(
        default=(64, 64),
        description="bins [along the width, along the height], 1 to 16384 each; those of a disk"
        " share out the square around it",
    )
    bands: Count | None = Field(
        default=None,
        description="bands of equal width between the film's first and last edge; the film's own"
        " if not given",
    )

    def bands_of(self, film: Film) -> int:
        """How many bands there are."""
        return film.bands if self.bands is None else self.bands

    def bins_of(self, film: Film) -> int:
        """How many bins there are."""
        return self.pixels[0] * self.pixels[1] * self.bands_of(film)


class RaySensor(Sensor):
    """The rays that cross: where, in which direction, of which wavelength and flux."""

    type: Literal["rays"] = Field(default="rays", description="the rays that cross")
    max_rays: Annotated[Count, Field(le=_MAX_RAYS)] = Field(
        default=1_000_000,
        description="rays kept at most; of more that cross, an even sample is kept whose rays"
        " carry the flux of all",
    )


AnySensor = Annotated[IrradianceSensor | RaySensor, Field(discriminator="type")]
"""Any sensor, told apart by its `type`."""


def bin_problems(film: Film, sensors: Mapping[int, Sensor]) -> list[Problem]:
    """More bins than there is memory for.

    Args:
        film: The film, whose bands sensors have.
        sensors: Sensors by their index in the file.
    """
    bins = {i: one.bins_of(film) for i, one in sensors.items() if isinstance(one, IrradianceSensor)}
    total = sum(bins.values())
    if total <= MAX_BINS:
        return []
    largest = max(bins, key=lambda index: bins[index])
    one = sensors[largest]
    assert isinstance(one, IrradianceSensor)
    allowed = f"at most {MAX_BINS} bins in all of the scene's sensors"
    columns, rows = one.pixels
    others = f", and {total} with the other sensors" if len(bins) > 1 else ""
    message = (
        f"{columns} × {rows} pixels × {one.bands_of(film)} bands make {bins[largest]} bins"
        f"{others}; there may be {allowed}"
    )
    return [Problem(f"sensors[{largest}].pixels", message, one.pixels, allowed)]
