"""How a picture is rendered: everything that is not the scene itself.

A setting left at ``None`` takes the scene's own default (its ``[render]`` table), then the value
in `DEFAULTS`. `RenderSettings.resolved` does so, and what it returns has no ``None`` left but one
of the two gather radii, in metres and in pixels: the other stands in its place.
"""

from __future__ import annotations

import dataclasses
import math
import operator
import os
import re
from typing import TYPE_CHECKING, Any, Final, Literal, SupportsFloat, SupportsIndex, TypeAlias

from sim.errors import SettingsError

if TYPE_CHECKING:
    from scenes import Scene

__all__ = [
    "DEFAULTS",
    "PRESETS",
    "DirectLight",
    "FeatureChoice",
    "Polarisation",
    "Precision",
    "Preset",
    "RenderSettings",
    "ResolvedSettings",
]

Precision: TypeAlias = Literal["float32", "float64"]
DirectLight: TypeAlias = Literal["lamps", "photons"]
FeatureChoice: TypeAlias = Literal["required", "all"]
Polarisation: TypeAlias = Literal["auto", "averaged", "s-p", "stokes"]
Preset: TypeAlias = Literal["draft", "standard", "reference"]

PRESETS: Final[dict[str, dict[str, float]]] = {
    "draft": {"passes": 0.25},
    "standard": {},
    "reference": {"passes": 16.0},
}
"""Photons and passes of each preset, in terms of the scene's own or the program's defaults.

Placed by `tests/benchmarks/presets.py`, which gives the time of each to a quarter and to four times
its photons: in `ball` and `prism` neither is better by more than 1.15 in error, but by 1.4 in one
of two rounds for the standard of `ball`. Pixels at lamps' edges and foci, which passes alone sample
anew, have most of the error, so presets differ in passes: the draft leaves 1.3 to 1.5 times the
error of the standard in a quarter of its time, the reference 0.3 to 0.5 of it in 16 times.
"""

DEFAULTS: Final = {
    "photons": 500_000, "passes": 8, "max_interactions": 256, "bounces": 0, "radius_pixels": 2.0
}  # fmt: skip

OPEN_PASSES: Final = 4096
"""Passes at most where the error or the time is to decide, and no number is given."""

# The smallest and largest value of each whole-number setting. Totals (photons times passes) stay
# within int64; a pass's deposits are counted in int32, with room for several a photon.
_WHOLE_NUMBERS: Final = {
    "photons": (1, 2**28),
    "passes": (1, 2**20),
    "max_interactions": (1, 2**16),
    "bounces": (0, 1000),
    "seed": (0, 2**63 - 1),
    "threads": (1, 1024),
}
_POSITIVE_NUMBERS: Final = {
    "radius": math.inf, "radius_pixels": 1000.0, "target_error": 1.0, "time_budget": math.inf
}
_PRECISIONS: Final = ("float32", "float64")
_DIRECT_LIGHTS: Final = ("lamps", "photons")
_POLARISATIONS: Final = ("auto", "averaged", "s-p", "stokes")
_FEATURE_CHOICES: Final = ("required", "all")
_LARGEST_TOLERANCE: Final = 0.5
_DEVICE: Final = re.compile(r"cpu|cuda:\d+")


@dataclasses.dataclass(frozen=True, kw_only=True)
class RenderSettings:
    """Settings of one rendering.

    Attributes:
        photons: Photons emitted in each pass.
        passes: Independent passes that are averaged; two or more give a standard error. With a
            target or a time budget, passes at most.
        preset: "draft", "standard" or "reference": how many photons and passes, in terms of the
            scene's own or the program's defaults; what is given by number wins.
        target_error: Relative error at which to stop, 0.01 for 1 %: the root mean square over the
            pixels of the luminance's error, noise and bias as `Accuracy` estimates them, each
            relative to the pixel's luminance plus the mean luminance.
        time_budget: Time for the rendering [s]; no round of passes is begun that would exceed it,
            but for the first two.
        radius: Gather radius of the first pass [m], the same everywhere; None: as `radius_pixels`
            says, or without it the scene.
        radius_pixels: Gather radius of the first pass in widths of the pixel, which differ with
            what it sees and how far away that is; not beside `radius`. None: 2, unless the scene
            has a radius.
        alpha: How slowly the gather radius shrinks, r²ᵢ₊₁ = r²ᵢ (i + α)/(i + 1) (Knaus and
            Zwicker 2011); 1 keeps it.
        direct_light: What shows light that comes straight from a lamp: "lamps", by shadow rays,
            or "photons", from the photon map like all other light.
        polarisation: How polarised light is followed: "auto" as the scene requires; "averaged" as
            natural light at every surface; "s-p" by the shares of s and p, right where planes of
            incidence do not differ along a path; "stokes" by Stokes vectors, always right.
        max_interactions: Surfaces that one path may meet before it is culled.
        bounces: Diffuse surfaces that light may be reflected by on its way to the one that is
            seen; 0 shows what lamps, glass and mirrors send there.
        seed: Key of every random sequence; equal seeds give equal pictures.
        threads: CPU threads; None: all cores. It does not change the picture.
        device: "cpu", or "cuda:0" and so on.
        precision: Floating-point type of tracing; None: float64 on the CPU, float32 on CUDA.
        features: What kernels are compiled for: "required" by the scene, or "all" there is.
        omission_tolerance: What the bounds on the error of all that is left out may add up to,
            relative, in the unit of `sim.features.registry`; 0 leaves out only what cannot
            change a bit.

    Raises:
        SettingsError: A value is outside what is allowed.
    """

    photons: int | None = None
    passes: int | None = None
    preset: Preset | None = None
    target_error: float | None = None
    time_budget: float | None = None
    radius: float | None = None
    radius_pixels: float | None = None
    alpha: float = 2 / 3
    direct_light: DirectLight = "lamps"
    polarisation: Polarisation = "auto"
    max_interactions: int | None = None
    bounces: int | None = None
    seed: int = 0
    threads: int | None = None
    device: str = "cpu"
    precision: Precision | None = None
    features: FeatureChoice = "required"
    omission_tolerance: float = 1e-6

    def __post_init__(self) -> None:
        for field, (lowest, highest) in _WHOLE_NUMBERS.items():
            value = getattr(self, field)
            if value is not None or field == "seed":
                self._replace(field, _whole_number(field, value, lowest, highest))
        for field, highest_number in _POSITIVE_NUMBERS.items():
            value = getattr(self, field)
            if value is not None:
                self._replace(field, _positive_number(field, value, highest_number))
        if self.radius is not None and self.radius_pixels is not None:
            allowed = "none beside a radius in metres"
            raise SettingsError("radius_pixels", self.radius_pixels, allowed)
        if self.preset is not None and self.preset not in PRESETS:
            names = ", ".join(repr(name) for name in PRESETS)
            raise SettingsError("preset", self.preset, names)
        self._replace("alpha", _positive_number("alpha", self.alpha, 1.0))
        if not _DEVICE.fullmatch(str(self.device)):
            raise SettingsError("device", self.device, "'cpu', 'cuda:0', 'cuda:1', …")
        if self.precision is not None and self.precision not in _PRECISIONS:
            raise SettingsError("precision", self.precision, "'float32' or 'float64'")
        if self.direct_light not in _DIRECT_LIGHTS:
            raise SettingsError("direct_light", self.direct_light, "'lamps' or 'photons'")
        if self.polarisation not in _POLARISATIONS:
            names = ", ".join(repr(name) for name in _POLARISATIONS)
            raise SettingsError("polarisation", self.polarisation, names)
        if self.features not in _FEATURE_CHOICES:
            raise SettingsError("features", self.features, "'required' or 'all'")
        tolerance = _finite_number(self.omission_tolerance)
        if not 0.0 <= tolerance <= _LARGEST_TOLERANCE:
            allowed = f"a number from 0 to {_LARGEST_TOLERANCE:g}"
            raise SettingsError("omission_tolerance", self.omission_tolerance, allowed)
        self._replace("omission_tolerance", tolerance)

    def _replace(self, field: str, value: object) -> None:
        """Store a validated value as a plain Python number, although the class is frozen."""
        object.__setattr__(self, field, value)

    def resolved(self, scene: Scene) -> ResolvedSettings:
        """Fill in what was left open: from the scene's ``[render]`` table, then from `DEFAULTS`.

        Args:
            scene: The scene that is to be rendered.

        Returns:
            The same settings with nothing left open but one of the two radii.
        """
        values = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        if self.radius_pixels is None:
            if self.radius is None:
                values["radius"] = scene.render.radius
            if values["radius"] is None:
                values["radius_pixels"] = DEFAULTS["radius_pixels"]
        for field in ("photons", "passes", "max_interactions", "bounces"):
            if values[field] is None:
                values[field] = getattr(scene.render, field)
            if values[field] is None:
                values[field] = DEFAULTS.get(field)
        for field, factor in PRESETS.get(self.preset or "standard", {}).items():
            if getattr(self, field) is None:
                values[field] = max(1, round(factor * values[field]))
        if self.is_open:
            # Whole rounds of two, so that the passes there were render the same picture again.
            passes = OPEN_PASSES if self.passes is None else self.passes
            values["passes"] = max(4, passes + passes % 2)
        if values["threads"] is None:
            values["threads"] = _available_cores()
        if values["precision"] is None:
            values["precision"] = "float64" if self.device == "cpu" else "float32"
        return ResolvedSettings(**values)

    @property
    def is_open(self) -> bool:
        """Whether the error or the time decides how many passes there are."""
        return self.target_error is not None or self.time_budget is not None

    def reproducing(self) -> dict[str, Any]:
        """The settings that decide the picture, ready for JSON: all but the number of threads."""
        values = dataclasses.asdict(self)
        del values["threads"]
        return values


@dataclasses.dataclass(frozen=True, kw_only=True)
class ResolvedSettings(RenderSettings):
    """Render settings with nothing left open, except that one of the two radii is None."""

    photons: int
    passes: int
    max_interactions: int
    bounces: int
    threads: int
    precision: Precision

    def closed(self, passes: int) -> ResolvedSettings:
        """The settings that render the same picture again: `passes` in all, and no other end."""
        return dataclasses.replace(
            self, passes=passes, preset=None, target_error=None, time_budget=None
        )


def _whole_number(field: str, value: SupportsIndex, lowest: int, highest: int) -> int:
    """`value` as an int within [lowest, highest]; a bool is refused: it is a slip."""
    allowed = f"a whole number from {lowest} to {highest}"
    try:
        number = operator.index(value)
    except TypeError:
        raise SettingsError(field, value, allowed) from None
    if isinstance(value, bool) or not lowest <= number <= highest:
        raise SettingsError(field, value, allowed)
    return number


def _positive_number(field: str, value: SupportsFloat, highest: float) -> float:
    """`value` as a finite float within (0, highest]."""
    allowed = "a finite number above 0" + (f", at most {highest:g}" if highest < math.inf else "")
    number = _finite_number(value)
    if not 0.0 < number <= highest:
        raise SettingsError(field, value, allowed)
    return number


def _finite_number(value: SupportsFloat) -> float:
    """`value` as a float; NaN, which is within no limits, if it is no finite number."""
    try:
        number = math.nan if isinstance(value, bool | str) else float(value)
    except (TypeError, ValueError, OverflowError):
        return math.nan
    return number if math.isfinite(number) else math.nan


def _available_cores() -> int:
    """Cores that this process may use, which in a container can be fewer than there are."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
