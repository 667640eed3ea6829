"""Features: the formulas by which indices are evaluated for each wavelength."""

from collections.abc import Callable

from sim.features.registry import Cost, Feature, Subject, Verdict, needed, null, register
from spectra import Cauchy, Sellmeier, Tabulated

__all__: list[str] = []


def _some(kind: type) -> Callable[[Subject], Verdict]:
    """Needed where any medium, the ambient one included, has a formula of this kind."""

    def judge(subject: Subject) -> Verdict:
        names = [medium.name for medium in subject.media if isinstance(medium.dispersion, kind)]
        return needed("of " + ", ".join(names)) if names else null("of no medium")

    return judge


register(Feature(
    name="Sellmeier",
    what="Sellmeier's formula of the index",
    judge=_some(Sellmeier),
    flag="sellmeier",
))  # fmt: skip

register(Feature(
    name="Cauchy",
    what="Cauchy's formula of the index, and constant ones",
    judge=_some(Cauchy),
    flag="cauchy",
))  # fmt: skip

register(Feature(
    name="tables",
    what="indices from tables, by cubics",
    judge=_some(Tabulated),
    flag="tabulated",
    cost=Cost(1.01, "ball"),
))  # fmt: skip


def _judge_air(subject: Subject) -> Verdict:
    count = sum(power != 0 for power in subject.air_powers)
    if count == 0:
        return null("all indices are relative to the same reference")
    return needed(f"{count} of the indices have another reference than the ambient medium")


register(Feature(
    name="air",
    what="indices converted between relative to air and to vacuum",
    judge=_judge_air,
    flag="air_conversion",
    cost=Cost(1.00, "ball"),
))  # fmt: skip
