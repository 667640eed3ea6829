"""Features: how the polarisation of light is followed from surface to surface."""

from scenes import Dielectric, Metal, Polariser
from sim.errors import SettingsError
from sim.features.planarity import planarity
from sim.features.registry import Cost, Feature, Subject, Verdict, needed, null, register

__all__ = ["require_polarisation"]

_ROUNDING = 1e-12
"""What Stokes vectors and shares of s and p can differ by where both are right, in float64."""

_ASKED_FOR = 'asked for by polarisation = "{}"'


def require_polarisation(subject: Subject) -> None:
    """Refuse to follow by shares of s and p what is polarised across them.

    Raises:
        SettingsError: it is asked for, and there are polarisers or polarised lamps.
    """
    names = [
        one.name
        for one in (*subject.scene.objects, *subject.scene.emitters)
        if isinstance(getattr(one, "material", None), Polariser)
        or getattr(one, "polarisation", None) is not None
    ]
    if subject.polarisation == "s-p" and names:
        allowed = f"'auto', 'averaged' or 'stokes': {names[0]} polarises in a plane of its own"
        raise SettingsError("polarisation", subject.polarisation, allowed)


def _judge_polarisation(subject: Subject) -> Verdict:
    """Light that meets one surface only, or none that tells s from p, needs none of it."""
    unequal = any(isinstance(one.material, Dielectric | Metal) for one in subject.scene.objects)
    if not unequal and not subject.polarisers:
        return null("no surface tells one polarisation from the other")
    if subject.polarisation == "averaged":
        return Verdict(_ASKED_FOR.format("averaged"), 1.0, chosen=True)
    return needed("surfaces reflect s and p unequally, and light may meet several")


register(Feature(
    name="polarisation",
    what="light carries how much more of it is s than p",
    judge=_judge_polarisation,
    flag="polarisation",
    cost=Cost(1.37, "prism"),
    separable=True,
))  # fmt: skip


def _judge_frames(subject: Subject, *, from_anywhere: bool) -> Verdict:
    """Whether s and p can mix: planes of incidence differ, or light starts or passes slantwise."""
    if _judge_polarisation(subject).bound == 0.0:
        return null("light is nowhere polarised")
    if subject.polarisation in ("averaged", "s-p"):
        return Verdict(_ASKED_FOR.format(subject.polarisation), 1.0, chosen=True)
    reason = planarity(subject.scene, from_anywhere=from_anywhere)
    lamps = sum(one.polarisation is not None for one in subject.scene.emitters)
    for why, holds in (
        (_ASKED_FOR.format("stokes"), subject.polarisation == "stokes"),
        ("polarisers have planes of their own", bool(subject.polarisers)),
        (f"{lamps} polarised lamps", lamps > 0),
        ("planes of incidence may differ along a path", reason is None),
    ):
        if holds:
            return needed(why)
    return Verdict(f"{reason}: the share of s over p says it all", _ROUNDING)


def _judge_photons(subject: Subject) -> Verdict:
    return _judge_frames(subject, from_anywhere=subject.bounces != 0)


def _judge_camera(subject: Subject) -> Verdict:
    return _judge_frames(subject, from_anywhere=True)




register(Feature(
    name="Stokes photons",
    what="photons carry Stokes vectors, turned into each plane of incidence",
    judge=_judge_photons,
    flag="stokes",
    cost=Cost(1.05, "prism"),
    separable=True,
))  # fmt: skip

register(Feature(
    name="Stokes camera paths",
    what="camera paths carry what the eye would see of each Stokes vector",
    judge=_judge_camera,
    flag="camera_stokes",
    cost=Cost(1.01, "prism"),
    kernel="camera",
    separable=True,
))  # fmt: skip
