"""Features: what solids are to one another, what media absorb, and surfaces that light ends at."""

import math

from sim.features.boundary_error import BOUNDARIES
from sim.features.registry import Cost, Feature, Subject, Verdict, needed, null, register
from sim.scene_neighbours import scene_size

__all__: list[str] = []


def _judge_interfaces(subject: Subject) -> Verdict:
    names = [item.name for item in subject.scene.objects]
    pairs = [f"{names[i]} and {names[j]}" for i, j in subject.near_pairs]
    if not pairs:
        return null("no solid is near another object")
    more = f", and {len(pairs) - 1} pairs more" if len(pairs) > 1 else ""
    return needed(f"may touch, nest or overlap: {pairs[0]}{more}")


register(Feature(
    name="interfaces",
    what="solids touch, nest and overlap: each surface finds the media on both sides",
    judge=_judge_interfaces,
    flag="interfaces",
    cost=Cost(0.99, "ball"),
))  # fmt: skip


def _judge_absorption(subject: Subject) -> Verdict:
    """What is lost on a way as long as light can be inside: α L, L = `BOUNDARIES` diameters.

    In the ambient medium ways know no bounds.
    """
    ambient = subject.media[0]
    if ambient.absorption is not None and not ambient.absorption.is_transparent:
        return needed(f"{ambient.name}, all around, absorbs")
    strongest, name = 0.0, ""
    for medium in subject.media:
        if medium.absorption is not None:
            alpha = max(medium.absorption.napierian_per_m)  # linear between: a knot has the most
            if alpha > strongest:
                strongest, name = alpha, medium.name
    if strongest == 0.0:
        return null("no medium absorbs")
    bound = -math.expm1(-strongest * BOUNDARIES * scene_size(subject.scene))
    return Verdict(f"{name} absorbs up to {strongest:.3g} per metre", bound)


register(Feature(
    name="absorption",
    what="Beer–Lambert along every way through a medium",
    judge=_judge_absorption,
    flag="absorption",
    cost=Cost(1.04, "ball"),
))  # fmt: skip


def _judge_finishes(subject: Subject) -> Verdict:
    count = len(subject.finishes)
    if count == 0:
        return null("no mirror and no metal")
    return needed(f"{count} mirrors or metals")


register(Feature(
    name="mirrors and metals",
    what="surfaces that reflect by a table, or by a complex index",
    judge=_judge_finishes,
    flag="finishes",
    cost=Cost(0.94, "ball"),
))  # fmt: skip


def _judge_polarisers(subject: Subject) -> Verdict:
    count = len(subject.polarisers)
    return needed(f"{count} polarisers") if count else null("no polariser")


register(Feature(
    name="polarisers",
    what="sheets that let one way of vibrating through",
    judge=_judge_polarisers,
    flag="polarisers",
    cost=Cost(1.01, "ball"),
))  # fmt: skip
