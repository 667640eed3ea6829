"""What emitters have in common: a name and a spectrum, a flux, a surface that can be seen."""

from abc import abstractmethod
from typing import Self

from pydantic import Field, StrictBool, model_validator

from scenes.emission import SpectrumSpec, resolve_spectrum
from scenes.errors import Problem, refusal
from scenes.fields import Light
from scenes.model import SceneModel
from scenes.polarisation import Polarisation
from spectra import EmissionSpectrum

__all__ = ["Emitter", "Glowing", "LocalEmitter"]


class Emitter(SceneModel):
    """A source of light."""

    name: str = Field(
        default="",
        max_length=200,
        description='name in messages, unique; "emitters[i]" if not given',
    )
    spectrum: SpectrumSpec = Field(description="name of a spectrum, or a table that describes one")

    polarisation: Polarisation | None = Field(
        default=None, description="how the light vibrates; natural light if absent"
    )

    def emission(self) -> EmissionSpectrum:
        """How the flux is spread over wavelengths, on a scale of its own."""
        return resolve_spectrum(self.spectrum)

    @property
    def axis(self) -> tuple[float, float, float] | None:
        """Unit vector along which the lamp shines, all in all; None if it favours none."""
        axis: tuple[float, float, float] | None = getattr(
            self, "direction", getattr(self, "normal", None)
        )
        return axis

    @model_validator(mode="after")
    def _angles_are_counted_from_somewhere(self) -> Self:
        light, axis = self.polarisation, self.axis
        if light is not None and axis is not None and light.reference(axis) is None:
            allowed = "a direction not parallel to the light's"
            raise refusal(Problem("polarisation.up", f"must be {allowed}", light.up, allowed))
        return self


class LocalEmitter(Emitter):
    """A source of light that is somewhere in the scene."""

    flux: Light = Field(description="radiant flux over the whole spectrum [W]")


class Glowing(SceneModel):
    """Something that shines, and can be looked at."""

    visible: StrictBool = Field(
        default=True,
        description="whether the camera sees the lamp itself, directly, through glass and in"
        " mirrors; it shines all the same",
    )

    @property
    @abstractmethod
    def full_radiance(self) -> float:
        """Radiance of its surface over the whole spectrum [W m⁻² sr⁻¹]."""
