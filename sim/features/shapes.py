"""Features: the shapes that a ray can meet."""

from collections.abc import Callable

import scenes
from sim.features.registry import Cost, Feature, Subject, Verdict, needed, null, register

__all__: list[str] = []


def _some(one: str, many: str, *kinds: type) -> Callable[[Subject], Verdict]:
    """Needed where any object has a shape of one of `kinds`."""

    def judge(subject: Subject) -> Verdict:
        count = sum(isinstance(item.shape, kinds) for item in subject.scene.objects)
        return needed(f"{count} {one if count == 1 else many}") if count else null(f"no {one}")

    return judge


register(Feature(
    name="spheres",
    what="rays meet spheres",
    judge=_some("sphere", "spheres", scenes.Sphere),
    flag="spheres",
    cost=Cost(1.06, "prism"),
))  # fmt: skip

register(Feature(
    name="flats",
    what="rays meet rectangles, disks and planes",
    judge=_some("flat", "flats", scenes.Rectangle, scenes.Disk, scenes.Plane),
    flag="flats",
))  # fmt: skip

register(Feature(
    name="polyhedra",
    what="rays meet boxes, prisms and other convex solids",
    judge=_some("polyhedron", "polyhedra", scenes.Box, scenes.Prism, scenes.Polyhedron),
    flag="polyhedra",
    cost=Cost(1.02, "ball"),
))  # fmt: skip

register(Feature(
    name="lenses",
    what="rays meet lenses, exactly: conic caps and a rim",
    judge=_some("lens", "lenses", scenes.Lens),
    flag="lenses",
    cost=Cost(1.06, "ball"),
))  # fmt: skip

register(Feature(
    name="meshes",
    what="rays meet triangles of meshes and height fields, by a tree of boxes",
    judge=_some("mesh", "meshes", scenes.Triangulated),
    flag="meshes",
    cost=Cost(1.09, "ball"),
))  # fmt: skip
