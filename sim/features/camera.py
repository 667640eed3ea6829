"""Features: what the camera does to light before it is a picture."""

from scenes.emitters import Glowing
from sim.features.registry import Cost, Feature, Subject, Verdict, needed, null, register

__all__: list[str] = []


def _judge_lens(subject: Subject) -> Verdict:
    """A pinhole sends every ray through one point: the lens' code would do the same."""
    camera = subject.scene.camera
    if camera is None:
        return null("there is no camera")
    if camera.lens_radius == 0.0:
        return null("the camera is a pinhole")
    return needed(f"the aperture's radius is {camera.lens_radius:.3g} m")


register(Feature(
    name="thin lens",
    what="camera rays through all of an aperture: depth of field",
    judge=_judge_lens,
    flag="thin_lens",
    cost=Cost(1.00, "ball"),
    kernel="camera",
))  # fmt: skip


def _judge_filter(subject: Subject) -> Verdict:
    kind = subject.scene.film.filter.type
    if kind == "box":
        return null("pixels are their squares")
    return needed(f"the film has a {kind} filter")


register(Feature(
    name="pixel filter",
    what="camera rays as densely as a tent or a Gaussian weighs them",
    judge=_judge_filter,
    flag="pixel_filter",
    cost=Cost(1.04, "ball"),
    kernel="camera",
))  # fmt: skip


def _judge_visible(subject: Subject) -> Verdict:
    emitters = subject.scene.emitters
    count = sum(isinstance(one, Glowing) and one.visible for one in emitters)
    return needed(f"{count} lamps can be looked at") if count else null("no lamp can be looked at")


register(Feature(
    name="visible lamps",
    what="camera paths see the lamps that they meet",
    judge=_judge_visible,
    flag="visible_lamps",
    cost=Cost(1.05, "ball"),
    kernel="camera",
    separable=True,
))  # fmt: skip
