"""Features: the lamps that there are, and that shadow rays can lead to."""

from collections.abc import Callable

import scenes
from scenes.emitters import DistantEmitter, has_mask
from sim.features.registry import Cost, Feature, Subject, Verdict, needed, null, register

__all__: list[str] = []


def _some(one: str, many: str, kind: type) -> Callable[[Subject], Verdict]:
    """Needed where any emitter is of this kind, and shadow rays look for it."""

    def judge(subject: Subject) -> Verdict:
        if subject.direct_light == "photons":
            return null("no shadow rays")
        count = sum(isinstance(emitter, kind) for emitter in subject.scene.emitters)
        return needed(f"{count} {one if count == 1 else many}") if count else null(f"no {one}")

    return judge


register(Feature(
    name="beams",
    what="shadow rays against beams: the narrower of profile and cone",
    judge=_some("beam", "beams", scenes.Beam),
    flag="beams",
    cost=Cost(1.04, "ball"),
    kernel="camera",
))  # fmt: skip

register(Feature(
    name="sphere lamps",
    what="shadow rays to spherical lamps",
    judge=_some("sphere lamp", "sphere lamps", scenes.SphereLamp),
    flag="sphere_lamps",
    cost=Cost(1.03, "prism"),
    kernel="camera",
))  # fmt: skip

register(Feature(
    name="rectangle lamps",
    what="shadow rays to rectangular lamps",
    judge=_some("rectangle lamp", "rectangle lamps", scenes.RectangleLamp),
    flag="rectangle_lamps",
    cost=Cost(0.99, "ball"),
    kernel="camera",
))  # fmt: skip


def _judge_distant(subject: Subject) -> Verdict:
    count = sum(isinstance(one, DistantEmitter) for one in subject.scene.emitters)
    if count == 0:
        return null("no light from afar")
    return needed(f"{count} of the emitters {'is' if count == 1 else 'are'} infinitely far away")


register(Feature(
    name="distant lamps",
    what="photons along lines through the scene, shadow rays to the sun and the sky",
    judge=_judge_distant,
    flag="distant_lamps",
    cost=Cost(1.02, "ball"),
))  # fmt: skip


def _judge_masks(subject: Subject) -> Verdict:
    count = sum(has_mask(one) for one in subject.scene.emitters)
    return needed(f"masks: {count}") if count else null("no mask")


register(Feature(
    name="masks",
    what="lamps and beams that shine through a mask, cell by cell",
    judge=_judge_masks,
    flag="masks",
    cost=Cost(1.04, "ball"),
))  # fmt: skip
