"""Emitters: where light starts, where it goes, how much of it, and of what colour."""

from typing import Annotated

from pydantic import Field

from scenes.emitters.beam import Beam, Profile, RoundProfile, SlitProfile
from scenes.emitters.distant import DistantEmitter, Environment, Sun
from scenes.emitters.emitter import Emitter, Glowing, LocalEmitter
from scenes.emitters.lamps import Point, RectangleLamp, SphereLamp, Spot

__all__ = [
    "AnyEmitter",
    "AnyLocalEmitter",
    "Beam",
    "DistantEmitter",
    "Emitter",
    "Environment",
    "Glowing",
    "LocalEmitter",
    "Point",
    "Profile",
    "RectangleLamp",
    "RoundProfile",
    "SlitProfile",
    "SphereLamp",
    "Spot",
    "Sun",
]

AnyLocalEmitter = Beam | Point | Spot | SphereLamp | RectangleLamp
"""Any emitter that is somewhere in the scene."""

AnyEmitter = Annotated[AnyLocalEmitter | Sun | Environment, Field(discriminator="type")]
"""Any emitter."""
