"""The registry of features: what each is, when a scene needs it, what leaving it out costs.

A feature registers itself in one place, with one `Feature`. From there it takes part in
everything: in what kernels are compiled for, in the sum of what is left out, in the picture's
file, and in ``nephroid explain``. Only what kernels ask about it, its flag, is a field of
`sim.features.flags.Features` besides.

Bounds. What an omission can do wrong is told in one unit, so that bounds can be added: *relative,
of a photon's flux or of the place that it arrives at, against the scene's diameter, whichever is
more; for each photon, or in the mean over the emitted flux*. 0 says that nothing changes, not a
bit of it; 1 that everything may.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import scenes
from sim.features.flags import Features
from sim.scene_media import varies_with_wavelength
from sim.scene_neighbours import near_pairs
from spectra import Medium

__all__ = [
    "BOUND_UNIT", "RECORDED_ON", "Build", "Cost", "Feature", "Subject", "Verdict", "needed",
    "null", "register", "registered",
]  # fmt: skip

RECORDED_ON = "gallery scenes, float64, one core of an x86-64 server, ± 0.05"
"""Where the recorded costs come from: each the median of three measurements."""

BOUND_UNIT = "of a photon's flux, or of its place against the scene's diameter"


@dataclass(frozen=True)
class Subject:
    """What features are judged by: a scene, its resolved media, and how it is to be rendered.

    Attributes:
        scene: the scene.
        media: its media, the ambient one first.
        air_powers: of each medium, the power of the index of air that its index is multiplied by.
        direct_light: the setting of this name; None: not known.
        precision: the setting of this name; None: not known.
        bounces: the setting of this name; None: not known.
        polarisation: the setting of this name.
    """

    scene: scenes.Scene
    media: tuple[Medium, ...]
    air_powers: tuple[int, ...]
    direct_light: str | None = None
    precision: str | None = None
    bounces: int | None = None
    polarisation: str = "auto"

    @cached_property
    def has_boundaries(self) -> bool:
        """Whether any object is made of a medium."""
        return any(isinstance(item.material, scenes.Dielectric) for item in self.scene.objects)

    @cached_property
    def near_pairs(self) -> list[tuple[int, int]]:
        """Pairs of objects, one of them made of a medium, that may touch, nest or overlap."""
        return near_pairs(self.scene)

    @cached_property
    def varying_media(self) -> tuple[bool, ...]:
        """Of each medium, whether its index depends on the wavelength, or what it absorbs."""
        return tuple(map(varies_with_wavelength, self.media, self.air_powers))

    @cached_property
    def finishes(self) -> tuple[scenes.Mirror | scenes.Metal, ...]:
        """The mirrors and metals, one an object that has such a surface."""
        return tuple(
            item.material
            for item in self.scene.objects
            if isinstance(item.material, scenes.Mirror | scenes.Metal)
        )

    @cached_property
    def polarisers(self) -> tuple[scenes.Polariser, ...]:
        """The polarisers, one an object that is one."""
        return tuple(
            item.material
            for item in self.scene.objects
            if isinstance(item.material, scenes.Polariser)
        )


@dataclass(frozen=True)
class Verdict:
    """What a scene makes of a feature.

    Attributes:
        reason: why it is needed, or can be left out; or what the bound comes from.
        bound: on the error that leaving it out causes; in the unit of this module. At 0 it is
            left out, from 1 on it never is, and between the tolerance decides.
        chosen: it is off at the user's word, whatever its bound.
    """

    reason: str
    bound: float
    chosen: bool = False


def needed(reason: str) -> Verdict:
    """Without it the picture would be another one."""
    return Verdict(reason, 1.0)


def null(reason: str) -> Verdict:
    """It cannot change anything, not even a last digit."""
    return Verdict(reason, 0.0)


@dataclass(frozen=True)
class Cost:
    """A recorded cost: kernel time with the feature ÷ without it.

    It was measured as ``nephroid explain SCENE --measure`` measures it again, on any scene and
    machine (`sim.feature_costs`): one thread, CPU time, median of interleaved repeats.

    Attributes:
        ratio: of the times.
        scene: gallery scene that it was measured on: one that does not require the feature, so
            that the ratio is what idle code costs, unless the feature is separable.
    """

    ratio: float
    scene: str


Build = tuple[str, Features]
"""What a kernel is compiled for: precision and features."""


@dataclass(frozen=True, kw_only=True)
class Feature:
    """One thing that the simulator can do, and that a scene may not require.

    Attributes:
        name: as ``nephroid explain`` prints it.
        what: it does, in half a line.
        judge: what a scene makes of it; None: not known, which means on.
        flag: the field of `Features` that compiles it in; None: it has no code of its own.
        cost: of its code; None: not measured.
        kernel: whose time the cost is of: "photons" (tracing a pass) or "camera" (exposing the
            film to one).
        separable: light goes on without it, another way, so that a scene that requires it can
            still be timed without it.
        switch: what turns it off in a build that has it, and on in one that has it not, to time
            the two; None: its flag does.
    """

    name: str
    what: str
    judge: Callable[[Subject], Verdict | None]
    flag: str | None = None
    cost: Cost | None = None
    kernel: Literal["photons", "camera"] = "photons"
    separable: bool = False
    switch: Callable[[Build], Build] | None = None


_registered: dict[str, Feature] = {}


def register(feature: Feature) -> Feature:
    """Add a feature; from now on every scene is judged by it.

    Raises:
        ValueError: its name or its flag is taken.
    """
    for other in _registered.values():
        if other.name == feature.name:
            raise ValueError(f"a feature named {feature.name!r} is registered already")
        if feature.flag is not None and other.flag == feature.flag:
            raise ValueError(f"{feature.name!r}: {other.name!r} has the flag {feature.flag!r}")
    _registered[feature.name] = feature
    return feature


def registered() -> tuple[Feature, ...]:
    """All features, in the order of their registration."""
    return tuple(_registered.values())
