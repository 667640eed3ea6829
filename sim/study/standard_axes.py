"""The axes of the engine as it is; importing this module registers them."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping

import scenes
from sim.study.axes import Axis, register_axis
from sim.study.media_variants import (
    with_cauchy_media,
    with_tabulated_media,
    without_absorption,
)
from sim.study.setup import RESULTS, Setup

__all__ = ["PLAIN", "at_photons", "ladder"]

PLAIN = {"sampler": "random", "aiming": "unaimed", "branching": "roulette"}
"""The method without any of the engine's three savings."""


def ladder(quick: bool) -> tuple[float, ...]:
    """Multiples of the centre's photons that slopes are fitted over."""
    return (1 / 16, 1 / 4, 1, 4) if quick else (1 / 64, 1 / 16, 1 / 4, 1, 4, 8)


def at_photons(setup: Setup, factor: float) -> Setup:
    """The setup with a multiple of its photons in each pass."""
    assert setup.settings.photons is not None
    return setup.with_settings(photons=max(16, round(setup.settings.photons * factor)))


def at_passes(setup: Setup, factor: float) -> Setup:
    """The setup with a multiple of its passes."""
    assert setup.settings.passes is not None
    return setup.with_settings(passes=max(1, round(setup.settings.passes * factor)))


def _photons(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    return {_times(factor): at_photons(centre, factor) for factor in ladder(quick)}


def _passes(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    factors = (1 / 4, 1 / 2, 2) if quick else (1 / 8, 1 / 4, 1 / 2, 2, 4)
    return {_times(factor): at_passes(centre, factor) for factor in factors}


def _grid(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    photons = (1 / 4, 4) if quick else (1 / 16, 1 / 4, 4)
    passes = (1 / 4, 1 / 2) if quick else (1 / 4, 1 / 2, 2)
    return {
        f"{_times(n)} photons, {_times(p)} passes": at_passes(at_photons(centre, n), p)
        for n in photons
        for p in passes
    }


def _radius(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    factors = (0.5, 2.0) if quick else (0.25, 0.5, 0.7, 1.4, 2.0, 4.0)
    return {_times(factor): centre.with_radius(factor) for factor in factors}


def _alpha(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    values = (0.5, 1.0) if quick else (0.4, 0.5, 0.8, 0.9, 1.0)
    return {f"{value:g}": centre.with_settings(alpha=value) for value in values}


def _bands(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    film = centre.scene.film
    factors = (0.25, 2.0) if quick else (0.125, 0.25, 0.5, 2.0)
    counts = {max(2, round(film.bands * factor)) for factor in factors}
    first, last = (float(edge) for edge in film.edges_nm[[0, -1]])

    def divided(count: int) -> scenes.Scene:
        """The same range in `count` bands."""
        half = 0.5 * (last - first) / count
        divided_film = scenes.Film.model_validate(
            {
                **film.model_dump(), "bands": count, "first_nm": first + half,
                "last_nm": last - half, "band_width_nm": None,
            }
        )
        return centre.scene.model_copy(update={"film": divided_film})

    return {
        f"{count}": centre.with_scene(divided(count)) for count in sorted(counts - {film.bands})
    }


def _precision(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    other = "float32" if centre.settings.precision == "float64" else "float64"
    return {other: centre.with_settings(precision=other)}


def _direct_light(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    other = "photons" if centre.settings.direct_light == "lamps" else "lamps"
    return {other: centre.with_settings(direct_light=other)}


def _sampler(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    return {name: centre.with_method(sampler=name) for name in ("r2", "random")}


def _branching(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    return {"roulette": centre.with_method(branching="roulette")}


def _aiming(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    return {"unaimed": centre.with_method(aiming="unaimed")}


def _plain(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    factors = (1 / 4, 1, 4) if quick else (1 / 4, 1, 4, 16)
    plain = centre.with_method(**PLAIN)
    return {f"plain, {_times(factor)} photons": at_photons(plain, factor) for factor in factors}


def _fresnel(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    return {name: centre.with_method(fresnel=name) for name in ("schlick", "none")}


def _polarisation(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    slantwise = any(
        isinstance(item.material, scenes.Polariser) for item in centre.scene.objects
    ) or any(one.polarisation is not None for one in centre.scene.emitters)
    names = ("averaged",) if slantwise else ("averaged", "s-p")
    return {name: centre.with_settings(polarisation=name) for name in names}


def _dispersion(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    return {
        "two-term Cauchy": centre.with_scene(with_cauchy_media(centre.scene)),
        "table": centre.with_scene(with_tabulated_media(centre.scene)),
    }


def _bounces(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    """Only where the scene asks for any: without, there is nothing that could be left out."""
    if not centre.settings.bounces:
        return {}
    values = (0, 1) if quick else (0, 1, 2, 4)
    return {
        f"{value}": centre.with_settings(bounces=value)
        for value in values
        if value < centre.settings.bounces
    }


def _interactions(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    """Two surfaces take light through a lens; what is reflected inside needs more."""
    values = (3, 5) if quick else (3, 5, 9, 17)
    return {f"{value}": centre.with_settings(max_interactions=value) for value in values}


def _absorption(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    clear = without_absorption(centre.scene)
    return {} if clear == centre.scene else {"none": centre.with_scene(clear)}


def _estimator(centre: Setup, quick: bool) -> Mapping[str, Setup]:
    found = {"gather": dataclasses.replace(centre, estimator="gather")}
    for cells in (16,) if quick else (16, 32):
        found[f"mesh {cells}²"] = dataclasses.replace(centre, estimator="mesh", mesh_cells=cells)
    return found


def _times(factor: float) -> str:
    """A multiple: "×4", "×1/4"."""
    if factor >= 1.0 or (1.0 / factor) % 1.0:
        return f"×{factor:g}"
    return f"×1/{1.0 / factor:g}"


for _axis in (
    Axis("photons", "settings", RESULTS, "photons in a pass", "×1", _photons),
    Axis("passes", "settings", RESULTS, "passes", "×1", _passes),
    Axis("photons × passes", "settings", RESULTS, "photons and passes together", "×1", _grid),
    Axis("radius", "settings", ("picture",), "the first pass's gather radius", "×1", _radius),
    Axis("alpha", "settings", ("picture",), "how slowly the radius shrinks", "2/3", _alpha),
    Axis("bands", "scene", ("picture",), "the film's bands", "the scene's", _bands),
    Axis("precision", "settings", RESULTS, "arithmetic of tracing", "float64", _precision),
    Axis("direct light", "settings", ("picture",), "what shows direct light", "lamps",
         _direct_light),
    Axis("sampler", "method", RESULTS, "what photons are drawn from", "sobol", _sampler),
    Axis("branching", "method", RESULTS, "what follows at a boundary", "weights", _branching),
    Axis("aiming", "method", RESULTS, "where photons are sent", "aimed", _aiming),
    Axis("all three", "method", RESULTS, "sampler, branching and aiming together",
         "sobol, weights, aimed", _plain),
    Axis("Fresnel", "method", RESULTS, "reflectance at boundaries", "exact", _fresnel),
    Axis("polarisation", "settings", RESULTS, "what is known of how light vibrates", "auto",
         _polarisation),
    Axis("dispersion", "scene", RESULTS, "the formula of the index", "the scene's", _dispersion),
    Axis("bounces", "settings", ("picture",), "bounces off diffuse surfaces", "the scene's",
         _bounces),
    Axis("internal reflections", "settings", RESULTS, "surfaces that a path may meet", "256",
         _interactions),
    Axis("absorption", "scene", RESULTS, "whether media absorb", "the scene's", _absorption),
    Axis("estimator", "estimator", ("bins",), "how irradiance is found", "bins", _estimator),
):
    register_axis(_axis)
