"""Whether the presets lie on the front of what error costs: with other photons, at equal time?

Each preset's passes trade against photons: with a quarter of its photons in a pass it has time for
more passes, with four times as many for fewer. Its error, over the least of the three, is 1 where
the preset lies on the measured front.

Error is what `nephroid render` prints: the root mean square over the pixels of the luminance's
error, relative to the pixel's luminance plus the mean, here against a long run at half the gather
radius.
"""

import numpy as np
from history import Measure

import scenes
from sim.settings import PRESETS, RenderSettings
from sim.study.picture_reference import picture_reference
from sim.study.setup import SeedSource, Setup
from sim.study.workshop import Workshop

ROWS = 32
"""Of the picture that are exposed: some ten thousand pixels, so that one run tells its error."""

REFERENCE_S = 60.0
"""CPU-seconds of the reference."""

FACTORS = (1 / 4, 1, 4)
"""Photons in a pass, in those of the preset."""

REPLICATES = 5
"""Runs of a point, but one of the preset `reference`: few pixels, at lamps' edges and foci, have
most of the error, and a single short run may meet more or fewer of them."""


def measures(name: str) -> list[Measure]:
    """Each preset's place on the front of one gallery scene."""
    scene, seeds = scenes.load(name), SeedSource(1)
    workshop = Workshop(threads=2, rows=ROWS)
    setups = {
        preset: Setup(scene, RenderSettings(preset=preset, threads=2).resolved(scene))
        for preset in PRESETS
    }
    workshop.load(setups.values())
    standard = setups["standard"]
    truth = picture_reference(workshop, standard, seeds, goal=1e-4, cpu_s=REFERENCE_S).values
    seconds: dict[int, float] = {}

    def error_of(setup: Setup, replicates: int = 1) -> tuple[float, float]:
        """Relative error of the luminance, root mean square over replicates, and CPU-seconds."""
        squares, spent = [], 0.0
        for _ in range(replicates):
            sample = workshop.run(setup, seeds.take(), ("picture",))
            assert sample.xyz is not None
            luminance = truth[..., 1]
            off = (sample.xyz[..., 1] - luminance) / (luminance + luminance.mean())
            squares.append(np.mean(off**2))
            spent += sample.costs.of("picture") / replicates
        return float(np.sqrt(np.mean(squares))), spent

    def pass_seconds(photons: int) -> float:
        if photons not in seconds:
            short = standard.with_settings(photons=photons, passes=4)
            seconds[photons] = error_of(short)[1] / 4.0
        return seconds[photons]

    found = []
    for preset, setup in setups.items():
        photons, passes = setup.settings.photons, setup.settings.passes
        budget = passes * pass_seconds(photons)
        points = {}
        replicates = 1 if preset == "reference" else REPLICATES
        for factor in FACTORS:
            many = max(1, round(factor * photons))
            affordable = 2 * max(1, round(0.5 * budget / pass_seconds(many)))
            other = passes if factor == 1 else affordable
            point = setup.with_settings(photons=many, passes=other)
            points[many, other] = error_of(point, replicates)
        errors = {key: error for key, (error, _) in points.items()}
        own, least = errors[photons, passes], min(errors.values())
        note = "; ".join(
            f"{many} × {other}: {error:.2%} in {cost:.3g} CPU-s"
            for (many, other), (error, cost) in points.items()
        )
        found.append(
            Measure(
                f"preset {preset}: error over the least at equal time", name, own / least,
                own / least, own / least, "<= 1.15", note,
            )
        )
    return found
