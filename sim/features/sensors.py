"""Features: sensors that light crosses."""

from sim.features.registry import Cost, Feature, Subject, Verdict, needed, null, register

__all__: list[str] = []


def _judge_sensors(subject: Subject) -> Verdict:
    count = len(subject.scene.sensors)
    if count == 0:
        return null("no sensor")
    return needed(f"{count} sensor{'' if count == 1 else 's'}")


register(Feature(
    name="sensors",
    what="light is counted, or its rays are kept, where it crosses a sensor",
    judge=_judge_sensors,
    flag="sensors",
    cost=Cost(1.01, "prism"),
))  # fmt: skip
