"""A point's replicates against the reference: errors, colours, centroids, energy, time."""

from __future__ import annotations

from dataclasses import astuple, replace

import numpy as np
import numpy.typing as npt

import scenes
from sim.image.exposure import automatic_stops, scene_stops
from sim.study.glass_chain import GlassChain
from sim.study.metrics import centroid_error, ciede2000, energy_residual, tempered_error
from sim.study.outcome import Row
from sim.study.plan import Point
from sim.study.references import MESH, Reference
from sim.study.sample import Sample
from sim.study.setup import ResultKind
from sim.study.statistics import (
    Interval,
    certain_errors,
    gram_matrix,
    mean_interval,
    separate_errors,
)
from spectra.srgb import xyz_to_linear_srgb
from spectra.units import LUMINOUS_EFFICACY_LM_W

__all__ = ["compare_point", "compared"]

FloatArray = npt.NDArray[np.float64]


def compared(sample: Sample, result: ResultKind) -> FloatArray:
    """What relative L2 errors are taken of: irradiance, or luminance."""
    if result == "bins":
        assert sample.irradiance is not None
        return sample.irradiance
    assert sample.xyz is not None
    luminance: FloatArray = sample.xyz[..., 1]
    return luminance


def compare_point(
    point: Point,
    samples: list[Sample],
    result: ResultKind,
    reference: Reference,
    chain: GlassChain | None,
    scene: scenes.Scene,
) -> Row:
    """A point's replicates against the reference."""
    expected = reference.values if result == "bins" else reference.values[..., 1]
    gram = gram_matrix([compared(one, result) for one in samples], expected)
    errors = separate_errors(gram, reference_variance=reference.variance)
    own_judge = samples[0].stated_error is not None and reference.kind == MESH
    if samples[0].stated_error is not None and own_judge:
        # One mesh is no judge of another: what it states of itself counts.
        errors = certain_errors(samples[0].stated_error)
    settings = point.setup.settings
    cpu_s = np.array([one.costs.of(result) for one in samples])
    costs = [one.costs for one in samples]
    residuals = [energy_residual(one.books) for one in samples if one.books is not None]
    row = Row(
        axis=point.axis, value=point.value, result=result,
        photons=int(settings.photons or 0), passes=int(settings.passes or 0),
        errors=errors,
        cpu_s=_certain(cpu_s), cpu_of_replicate=cpu_s,
        parts_s=tuple(float(part) for part in np.mean([astuple(one) for one in costs], axis=0)),
        energy_residual=max(residuals, default=float("nan")),
    )
    if result == "picture":
        return _with_colours(row, samples, reference, scene)
    if chain is None or own_judge:
        return row
    return replace(row, centroid_arcsec=_centroids(samples, reference, chain, scene))


def _with_colours(
    row: Row, samples: list[Sample], reference: Reference, scene: scenes.Scene
) -> Row:
    """The row with a picture's other measures; colours as the scene, or reference, exposes them."""
    expected = xyz_to_linear_srgb(reference.values / LUMINOUS_EFFICACY_LM_W)
    stops = scene_stops(scene)
    stops = automatic_stops(expected) if stops is None else stops
    found = [
        ciede2000(
            xyz_to_linear_srgb(one.xyz / LUMINOUS_EFFICACY_LM_W), expected,
            exposure_stops=stops, gamut=scene.film.gamut,
        )
        for one in samples
        if one.xyz is not None
    ]
    tempered = [
        tempered_error(one.xyz[..., 1], reference.values[..., 1])
        for one in samples
        if one.xyz is not None
    ]
    return replace(
        row, tempered=_certain(np.array(tempered)),
        ciede_mean=_certain(np.array([one.mean for one in found])),
        ciede_p95=_certain(np.array([one.p95 for one in found])),
    )


def _centroids(
    samples: list[Sample], reference: Reference, chain: GlassChain, scene: scenes.Scene
) -> Interval:
    """Root mean square over bands of the centroids' error, seen from the middle of the glass."""
    glass = [
        item.shape.bounding_sphere()[0]
        for item in scene.objects
        if isinstance(item.material, scenes.Dielectric) and not isinstance(item.shape, scenes.Plane)
    ]
    centres, seen_from = chain.bins.bin_centres(), np.mean(glass, axis=0)
    errors = []
    for one in samples:
        assert one.irradiance is not None
        angles = centroid_error(one.irradiance, reference.values, centres, seen_from)
        errors.append(float(np.sqrt(np.nanmean(angles**2))) if np.isfinite(angles).any() else 0.0)
    return _certain(np.array(errors))


def _certain(values: FloatArray) -> Interval:
    """Mean with its interval; a single value, which chance has no part in, is its own."""
    return mean_interval(values) if len(values) > 1 else Interval(*(float(values[0]),) * 3)
