"""What emitters have in common: a name and a spectrum, a flux, a surface that can be seen."""

from abc import abstractmethod

from pydantic import Field, StrictBool

from scenes.emission import SpectrumSpec, resolve_spectrum
from scenes.fields import Positive
from scenes.model import SceneModel
from spectra import EmissionSpectrum

__all__ = ["Emitter", "Glowing", "LocalEmitter"]


class Emitter(SceneModel):
    """A source of light."""

    name: str = Field(
        default="", description='name in messages, unique; "emitters[i]" if not given'
    )
    spectrum: SpectrumSpec = Field(description="name of a spectrum, or a table that describes one")

    def emission(self) -> EmissionSpectrum:
        """How the flux is spread over wavelengths, on a scale of its own."""
        return resolve_spectrum(self.spectrum)


class LocalEmitter(Emitter):
    """A source of light that is somewhere in the scene."""

    flux: Positive = Field(description="radiant flux over the whole spectrum [W]")


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
