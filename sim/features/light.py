"""Features: what happens to light at boundaries, and how receivers learn of it."""

import numpy as np

from scenes import Dielectric, Disk, Lambertian, Plane, Rectangle, is_specular
from sim.features.boundary_error import path_error, relative_variations
from sim.features.registry import Cost, Feature, Subject, Verdict, needed, null, register

__all__: list[str] = []

_SAMPLES = 257


def _judge_boundaries(subject: Subject) -> Verdict:
    if subject.has_boundaries:
        return needed("objects are made of media")
    return null("no object is made of a medium")


register(Feature(
    name="boundaries",
    what="light crosses from one medium into another: Snell, Fresnel",
    judge=_judge_boundaries,
    flag="boundaries",
))  # fmt: skip


def _judge_reflection(subject: Subject) -> Verdict:
    """Nothing is reflected where η is 1 exactly. Else, at grazing incidence, everything is.

    Media of the same formula and conversion have the same index to the last bit, and x/x = 1.
    """
    if not subject.has_boundaries:
        return null("there is no boundary")
    kinds = {
        (medium.dispersion, power)
        for medium, power in zip(subject.media, subject.air_powers, strict=True)
    }
    if len(kinds) == 1:
        return null("all media have the index of the ambient one, exactly")
    return needed("indices differ, and grazing light is reflected whole")


register(Feature(
    name="reflected branches",
    what="boundaries reflect what Fresnel says, and all past the critical angle",
    judge=_judge_reflection,
    flag="reflected_branches",
    cost=Cost(2.00, "ball"),
    separable=True,
))  # fmt: skip


def _what_colours(subject: Subject) -> str:
    """What parts light by its wavelength, apart from refraction; "" if nothing does."""
    coloured = sum(one.is_coloured for one in subject.finishes)
    if coloured:
        return f"{coloured} mirrors or metals reflect some wavelengths more than others"
    if subject.bounces != 0 and any(
        isinstance(one.material, Lambertian) and one.material.is_coloured
        for one in subject.scene.objects
    ):
        return "diffuse surfaces reflect some wavelengths more than others"
    tinted = [medium.name for medium in subject.media if medium.is_tinted]
    return "absorption depends on the wavelength: " + ", ".join(tinted) if tinted else ""


def _judge_dispersion(subject: Subject) -> Verdict | None:
    """Left out where no index varies; where it hardly does, as far as the bound allows.

    The bound is that of treating every wavelength as any other one of the film's.
    """
    colours = _what_colours(subject)
    if colours:
        return needed(colours)
    if not subject.has_boundaries:
        return null("there is no boundary")
    if not any(subject.varying_media):
        return null("no index depends on the wavelength")
    variations = relative_variations(subject)
    if variations is None:
        return None
    bound = sum(path_error(eta, variation) for eta, variation in variations)
    largest = max(variation for _, variation in variations)
    return Verdict(f"indices vary by {largest:.2g} over the film's range", min(bound, 1.0))


register(Feature(
    name="dispersion",
    what="four colours a photon that meets glass, a camera path a band behind it",
    judge=_judge_dispersion,
    flag="dispersion",
    cost=Cost(2.05, "ball"),
    separable=True,
))  # fmt: skip


def _judge_undispersed(subject: Subject) -> Verdict:
    """The map is empty of them where it leaves direct light out and all glass disperses."""
    if subject.direct_light != "lamps":
        return needed("the map holds direct light, or may do so")
    if subject.bounces != 0:
        return needed("light may come from diffuse surfaces, its colours together")
    varies = dict(zip(subject.media, subject.varying_media, strict=True))
    ambient = subject.varying_media[0]
    for item in subject.scene.objects:
        if isinstance(item.material, Dielectric):
            medium = item.material.resolved()
            if medium == subject.media[0] or not (ambient or varies.get(medium, False)):
                return needed(f"light keeps its colours together in {item.name}")
        elif is_specular(item.material) and not getattr(item.material, "is_coloured", False):
            return needed(f"light keeps its colours together on {item.name}")
    for i, j in subject.near_pairs:
        pair = subject.scene.objects[i], subject.scene.objects[j]
        if all(isinstance(one.material, Dielectric) for one in pair):
            return needed(f"{pair[0].name} and {pair[1].name} may hide faces of each other")
    return null("what is in the map has met glass, and all glass is dispersive")


register(Feature(
    name="undispersed photons",
    what="photons that no dispersion has touched shine in every band",
    judge=_judge_undispersed,
    flag="undispersed_photons",
    cost=Cost(1.01, "prism"),
    kernel="camera",
    separable=True,
))  # fmt: skip


def _judge_interreflection(subject: Subject) -> Verdict:
    """Each bounce keeps at most the largest reflectance ρ: left out are ρ + ρ² + … of the light."""
    edges_nm = subject.scene.film.edges_nm
    wavelength_nm = np.linspace(edges_nm[0], edges_nm[-1], _SAMPLES)
    materials = [one.material for one in subject.scene.objects]
    diffuse = [one for one in materials if isinstance(one, Lambertian)]
    largest = max(
        (float(np.max(one.reflectance_at(wavelength_nm))) for one in diffuse), default=0.0
    )
    shapes = [one.shape for one in subject.scene.objects]
    alone = len(shapes) == 1 and isinstance(shapes[0], Rectangle | Disk | Plane)
    if largest == 0.0 or (alone and not subject.scene.sensors):
        return null("no diffuse surface can light another, itself, or a sensor")
    if subject.bounces == 0:
        return Verdict("bounces = 0: diffuse surfaces do not light one another", 1.0, chosen=True)
    return needed(f"{len(diffuse)} diffuse surfaces, reflectance up to {largest:.2g}")


register(Feature(
    name="interreflection",
    what="photons are reflected by diffuse surfaces, and light others",
    judge=_judge_interreflection,
    flag="interreflection",
    cost=Cost(0.99, "ball"),
    separable=True,
))  # fmt: skip


def _judge_direct_light(subject: Subject) -> Verdict:
    if subject.direct_light == "photons":
        return null('direct light is in the map: direct_light = "photons"')
    return needed("receivers may see lamps")


register(Feature(
    name="direct light",
    what="shadow rays from receivers to the lamps",
    judge=_judge_direct_light,
    flag="direct_light",
    cost=Cost(1.18, "prism"),
    kernel="camera",
    separable=True,
))  # fmt: skip
