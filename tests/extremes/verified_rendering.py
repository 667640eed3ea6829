"""Render gallery scenes with Warp's floating-point verification, and say what is not finite.

    python tests/extremes/verified_rendering.py prism:float64 ball:float32    # or no name: them all

`wp.config.verify_fp` compiles every kernel anew, with a test of each number that is read from an
array or written to one, and prints what is not finite. It also reads places before they are written
for the first time, so that arrays must not begin with whatever memory held. In the end a NaN is
made on purpose, which must be seen.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import warp as wp

import scenes
import sim

wp.config.verify_fp = True
wp.empty = wp.zeros


def render(name: str, precision: str) -> None:
    """Render a few pixels of a scene."""
    scene = scenes.load(name)
    film = scene.film.model_copy(update={"width": 12, "height": 8})
    settings = sim.RenderSettings(photons=1000, passes=1, threads=1, precision=precision)
    picture = sim.render(scene.model_copy(update={"film": film}), settings)
    print(f"rendered {name}: {picture.spectral_radiance.mean():.6g}", flush=True)


@wp.kernel(enable_backward=False)
def make_nan(x: wp.array(dtype=wp.float64), out: wp.array(dtype=wp.float64)):
    """The root of a negative number."""
    out[0] = wp.sqrt(x[0])


def main() -> None:
    """Render what is named, then make a NaN."""
    named = sys.argv[1:] or [f"{name}:float64" for name in scenes.gallery()]
    for one in named:
        name, _, precision = one.partition(":")
        render(name, precision)
    out = wp.zeros(1, dtype=wp.float64, device="cpu")
    inputs = [wp.array([-1.0], dtype=wp.float64, device="cpu"), out]
    print("now a NaN", flush=True)
    wp.launch(make_nan, dim=1, inputs=inputs, device="cpu")


if __name__ == "__main__":
    main()
