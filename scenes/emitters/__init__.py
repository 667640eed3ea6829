"""Emitters: where light starts, where it goes, how much of it, and of what colour."""

from typing import Annotated

from pydantic import Field

from scenes.emitters.beam import Beam, Profile, RoundProfile, SlitProfile
from scenes.emitters.distant import DistantEmitter, Environment, Sun
from scenes.emitters.emitter import Emitter, Glowing, LocalEmitter
from scenes.emitters.lamps import Point, RectangleLamp, SphereLamp, Spot
from scenes.emitters.mask import Mask

__all__ = [
    "AnyEmitter",
    "AnyLocalEmitter",
    "Beam",
    "DistantEmitter",
    "Emitter",
    "Environment",
    "Glowing",
    "LocalEmitter",
    "Mask",
    "Point",
    "Profile",
    "RectangleLamp",
    "RoundProfile",
    "SlitProfile",
    "SphereLamp",
    "Spot",
    "Sun",
    "has_mask",
]

AnyLocalEmitter = Beam | Point | Spot | SphereLamp | RectangleLamp
"""Any emitter that is somewhere in the scene."""

AnyEmitter = Annotated[AnyLocalEmitter | Sun | Environment, Field(discriminator="type")]
"""Any emitter."""


def has_mask(emitter: Emitter) -> bool:
    """Whether light comes through a mask."""
    if isinstance(emitter, Beam):
        return isinstance(emitter.profile, SlitProfile) and emitter.profile.mask is not None
    return isinstance(emitter, RectangleLamp) and emitter.mask is not None
