"""Feature: the digits that tracing is done with."""

import numpy as np

from sim.features.boundary_error import path_error
from sim.features.registry import Build, Cost, Feature, Subject, Verdict, needed, register

__all__: list[str] = []

_ROUNDINGS = 8
"""Units in the last place by which a boundary's relative index and cosines may be off."""


def _judge_double(subject: Subject) -> Verdict:
    """A user's choice: rounding acts as a change of the relative index by some last places."""
    if subject.precision != "float32":
        return needed("tracing is done in float64")
    variation = _ROUNDINGS * float(np.finfo(np.float32).eps)
    reason = 'asked for by precision = "float32"'
    return Verdict(reason, min(1.0, path_error(1.5, variation)), chosen=True)


def _switch(build: Build) -> Build:
    precision, features = build
    return "float32" if precision == "float64" else "float64", features


register(Feature(
    name="double precision",
    what="tracing in float64, not in float32",
    judge=_judge_double,
    cost=Cost(1.08, "ball"),
    separable=True,
    switch=_switch,
))  # fmt: skip
