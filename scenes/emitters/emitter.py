"""What all emitters have in common: a name, a total flux and a spectrum."""

from pydantic import Field, StrictBool

from scenes.emission import SpectrumSpec, resolve_spectrum
from scenes.fields import Positive
from scenes.model import SceneModel
from spectra import EmissionSpectrum

__all__ = ["Emitter", "Glowing"]


class Emitter(SceneModel):
    """A source of light."""

    name: str = Field(
        default="", description='name in messages, unique; "emitters[i]" if not given'
    )
    flux: Positive = Field(description="radiant flux over the whole spectrum [W]")
    spectrum: SpectrumSpec = Field(description="name of a spectrum, or a table that describes one")

    def emission(self) -> EmissionSpectrum:
        """How the flux is spread over wavelengths, on a scale of its own."""
        return resolve_spectrum(self.spectrum)


class Glowing(Emitter):
    """A source of light with a surface, which can be looked at."""

    visible: StrictBool = Field(
        default=True,
        description="whether the camera sees the lamp itself, directly, through glass and in"
        " mirrors; it shines all the same",
    )
