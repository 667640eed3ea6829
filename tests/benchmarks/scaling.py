"""How the cost of a picture grows with photons, pixels and bands.

Renders the gallery's lens, one thing varied at a time: the CPU seconds of one pass (the difference
of two runs, so that compiling and starting cancel out), and the exponent of each law with its 95 %
interval. Asked for: at most linear in photons and in pixels, less than linear in bands.
"""

import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from history import Measure
from scipy import stats

import scenes
import sim

SCENE = "lens"
PHOTONS, WIDTH, BANDS = 60_000, 320, 31
REPETITIONS = 3


@dataclass(frozen=True)
class Law:
    """Cost against one size."""

    name: str
    sizes: tuple[int, ...]
    seconds: tuple[float, ...]

    def exponent(self) -> tuple[float, float]:
        """Slope of log cost over log size, and half its 95 % interval."""
        fit = stats.linregress(np.log(self.sizes), np.log(self.seconds))
        return fit.slope, float(stats.t.ppf(0.975, len(self.sizes) - 2) * fit.stderr)


def make_scene(width: int, bands: int) -> scenes.Scene:
    """The gallery's scene at another size: 400 to 700 nm in `bands` bands."""
    scene = scenes.load(SCENE)
    step = 300.0 / bands
    film = scene.film.model_copy(
        update={
            "width": width, "height": round(width * scene.film.height / scene.film.width),
            "first_nm": 400.0 + 0.5 * step, "last_nm": 700.0 - 0.5 * step, "bands": bands,
        }
    )
    return scene.model_copy(update={"film": film})


def pass_seconds(*, photons: int = PHOTONS, width: int = WIDTH, bands: int = BANDS) -> float:
    """CPU seconds of one pass: six less two, over four; the least of some repetitions."""
    scene = make_scene(width, bands)
    found = []
    for _ in range(REPETITIONS):
        spent = []
        for passes in (2, 6):
            start = time.process_time()
            sim.render(scene, sim.RenderSettings(photons=photons, passes=passes))
            spent.append(time.process_time() - start)
        found.append((spent[1] - spent[0]) / 4.0)
    return min(found)


def measure() -> list[Law]:
    """Every law."""
    photons = tuple(PHOTONS * 2**k for k in range(5))
    widths = (160, 240, 320, 480, 640)
    bands = (8, 16, 31, 62, 124)
    pixels = tuple(width * make_scene(width, BANDS).film.height for width in widths)
    return [
        Law("photons", photons, tuple(pass_seconds(photons=one) for one in photons)),
        Law("pixels", pixels, tuple(pass_seconds(width=one) for one in widths)),
        Law("bands", bands, tuple(pass_seconds(bands=one) for one in bands)),
    ]


def plot(laws: list[Law], path: Path) -> None:
    """One curve a law, both relative to their first point."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.0, 4.5), layout="constrained")
    axes = figure.add_subplot()
    for law in laws:
        slope, half = law.exponent()
        relative = np.divide(law.sizes, law.sizes[0]), np.divide(law.seconds, law.seconds[0])
        axes.loglog(*relative, "o-", label=f"{law.name}: exponent {slope:.2f} ± {half:.2f}")
    axes.loglog([1, 16], [1, 16], "k:", label="linear")
    axes.set_xlabel("size, relative to the smallest")
    axes.set_ylabel("CPU time of a pass, relative")
    axes.set_title(f"Cost of a pass of {SCENE}")
    axes.legend()
    figure.savefig(path)


def measures(path: Path | None = None) -> list[Measure]:
    """The laws' exponents, plotted if there is a path for it."""
    laws = measure()
    if path is not None:
        plot(laws, path)
    asked = {"photons": "<= 1", "pixels": "<= 1", "bands": "< 1"}
    found = []
    for law in laws:
        slope, half = law.exponent()
        seconds = ", ".join(f"{one:.3g}" for one in law.seconds)
        note = f"{law.sizes[0]} to {law.sizes[-1]}: {seconds} CPU-s a pass"
        name = f"cost of a pass as {law.name} to the power"
        found.append(
            Measure(name, SCENE, slope, slope - half, slope + half, asked[law.name], note)
        )
    return found
