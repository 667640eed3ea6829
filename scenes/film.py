"""The film: pixels, wavelength bands, and how bands become a colour."""

from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, Strict, model_validator

from scenes.errors import Problem, refusal
from scenes.fields import WAVELENGTH_RANGE_NM, Number, Positive, Wavelength
from scenes.model import SceneModel
from scenes.pixel_filter import BoxFilter, PixelFilter
from spectra.srgb import Gamut

__all__ = ["Film"]

_MAX_PIXELS = 16384
_MAX_BANDS = 1024
_MAX_SAMPLES = 1 << 28
_SINGLE_BAND_WIDTH_NM = 10.0
_SPACING_TOLERANCE = 1e-9

_Pixels = Annotated[int, Strict(), Field(ge=1, le=_MAX_PIXELS)]


class Film(SceneModel):
    """A rectangle of pixels, each with the same evenly spaced, touching bands of wavelength."""

    width: _Pixels = Field(
        default=768,
        description="pixels in a row, 1 to 16384; width × height × bands is at most 2^28",
    )
    height: _Pixels = Field(default=512, description="rows of pixels, 1 to 16384")
    first_nm: Wavelength = Field(default=400.0, description="centre of the first band [nm]")
    last_nm: Wavelength = Field(default=700.0, description="centre of the last band [nm]")
    bands: Annotated[int, Strict()] = Field(
        default=31, ge=1, le=_MAX_BANDS, description="number of bands, 1 to 1024"
    )
    band_width_nm: Positive | None = Field(
        default=None,
        description="width of a single band [nm], 10 if not given; several bands touch each other,"
        " so that theirs is the spacing of the centres",
    )
    filter: PixelFilter = Field(
        default=BoxFilter(), description="how the light around a pixel's middle is weighed"
    )
    observer: Literal["CIE 1931 2 degree", "CIE 2015 2 degree"] = Field(
        default="CIE 1931 2 degree", description="colour matching functions of the picture"
    )
    gamut: Gamut = Field(
        default="desaturate",
        description="how a colour outside sRGB enters it: toward white at constant luminance,"
        " by clipping each channel, or, to keep the hue of what is too bright as well, by dimming",
    )
    exposure_stops: Number | None = Field(
        default=None,
        description="exposure of the picture in stops (factors of two); automatic if not given",
    )

    @property
    def spacing_nm(self) -> float:
        """Width of a band, which is the distance between two centres [nm]."""
        if self.bands > 1:
            return (self.last_nm - self.first_nm) / (self.bands - 1)
        return _SINGLE_BAND_WIDTH_NM if self.band_width_nm is None else self.band_width_nm

    @property
    def centres_nm(self) -> NDArray[np.float64]:
        """Centres of the bands, shape (bands,) [nm]; a single one lies midway first to last."""
        if self.bands == 1:
            return np.array([0.5 * (self.first_nm + self.last_nm)])
        return np.linspace(self.first_nm, self.last_nm, self.bands)

    @property
    def edges_nm(self) -> NDArray[np.float64]:
        """Edges of the bands, shape (bands + 1,), ascending [nm]."""
        half = 0.5 * self.spacing_nm
        centres = self.centres_nm
        return np.linspace(centres[0] - half, centres[-1] + half, self.bands + 1)

    @model_validator(mode="after")
    def _fits_into_memory(self) -> Self:
        samples = self.width * self.height * self.bands
        if samples > _MAX_SAMPLES:
            allowed = f"at most {_MAX_SAMPLES} samples, width × height × bands"
            message = f"{self.width} × {self.height} pixels × {self.bands} bands make {samples}"
            message += f" samples; allowed: {allowed}"
            raise refusal(Problem("", message, None, allowed))
        return self

    @model_validator(mode="after")
    def _bands_make_sense(self) -> Self:
        if self.last_nm < self.first_nm or (self.bands > 1 and self.last_nm == self.first_nm):
            allowed = f"greater than first_nm = {self.first_nm:g}"
            raise refusal(
                Problem("last_nm", f"must be {allowed}, is {self.last_nm:g}", self.last_nm, allowed)
            )
        if self.bands > 1 and self.band_width_nm is not None:
            mismatch = abs(self.band_width_nm - self.spacing_nm)
            if mismatch > _SPACING_TOLERANCE * self.spacing_nm:
                allowed = f"the spacing of the {self.bands} bands, {self.spacing_nm:g}, or left out"
                message = f"must be {allowed}, is {self.band_width_nm:g}"
                raise refusal(Problem("band_width_nm", message, self.band_width_nm, allowed))
        lowest, highest = WAVELENGTH_RANGE_NM
        if self.edges_nm[0] < lowest or self.edges_nm[-1] > highest:
            allowed = f"bands between {lowest:g} and {highest:g} nm"
            message = f"must have {allowed}; the edges are {self.edges_nm[0]:g} and"
            message += f" {self.edges_nm[-1]:g} nm"
            raise refusal(Problem("", message, None, allowed))
        return self
