"""Emitters: where light starts, where it goes, how much of it, and of what colour."""

from typing import Annotated

from pydantic import Field

from scenes.emitters.beam import Beam, Profile, RoundProfile, SlitProfile
from scenes.emitters.emitter import Emitter, Glowing
from scenes.emitters.lamps import Point, RectangleLamp, SphereLamp, Spot

__all__ = [
    "AnyEmitter",
    "Beam",
    "Emitter",
    "Glowing",
    "Point",
    "Profile",
    "RectangleLamp",
    "RoundProfile",
    "SlitProfile",
    "SphereLamp",
    "Spot",
]

AnyEmitter = Annotated[
    Beam | Point | Spot | SphereLamp | RectangleLamp, Field(discriminator="type")
]
"""Any emitter."""
