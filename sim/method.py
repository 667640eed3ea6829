"""How light is followed: the choices whose worth a study measures.

The defaults are what a rendering uses. The others answer the same question, with more noise, so
that the gain of each choice can be shown; but for Fresnel's formulas, where they leave physics
out. Kernels are compiled for one method: a choice that is not made costs nothing.
"""

from dataclasses import dataclass, fields
from typing import Literal, get_args

from sim.errors import SettingsError

__all__ = ["DEFAULT_METHOD", "Method"]

Sampler = Literal["sobol", "r2", "random"]
Branching = Literal["weights", "roulette"]
Aiming = Literal["aimed", "unaimed"]
Fresnel = Literal["exact", "schlick", "none"]

_ALLOWED = {
    "sampler": get_args(Sampler),
    "branching": get_args(Branching),
    "aiming": get_args(Aiming),
    "fresnel": get_args(Fresnel),
}


@dataclass(frozen=True)
class Method:
    """How light is followed; hashable, since kernels are cached by it.

    Attributes:
        sampler: what photons are drawn from: Owen-scrambled Sobol points, the Kronecker sequence
            R5 with a random shift, or independent random numbers.
        branching: of photons, at a boundary between media: "weights" follows both branches, each
            with its part of the flux; "roulette" follows one of them with all of it, chosen with
            the probability of its part.
        aiming: "aimed" sends photons where they are worth most, with weights that make up for
            it; "unaimed" sends them as the lamps radiate.
        fresnel: reflectance at boundaries: Fresnel's formulas, Schlick's approximation, or none,
            which lets through whatever is not reflected totally.

    Raises:
        SettingsError: a choice that does not exist.
    """

    sampler: Sampler = "sobol"
    branching: Branching = "weights"
    aiming: Aiming = "aimed"
    fresnel: Fresnel = "exact"

    def __post_init__(self) -> None:
        for field in fields(self):
            value, allowed = getattr(self, field.name), _ALLOWED[field.name]
            if value not in allowed:
                raise SettingsError(f"method.{field.name}", value, " | ".join(allowed))


DEFAULT_METHOD = Method()
"""What a rendering uses."""
