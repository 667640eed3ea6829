"""Render a scene to a spectral EXR and a PNG, and write what its sensors measure beside them.

The EXR holds spectral radiance band by band, its standard error, linear RGB, and everything that
reproduces it. Of a scene without a camera only the sensors are written: irradiance as an EXR and as
arrays (.npz), rays as arrays. Settings that are left out come from the scene's own [render] table,
then from the program's defaults.

While it runs, a checkpoint beside the EXR keeps what is done: after a crash, a kill or Ctrl-C the
same command with --resume goes on from there, to the same files byte by byte.
"""

from __future__ import annotations

import argparse
import dataclasses
import functools
import math
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from sim.commands.arguments import (
    add_scene_arguments,
    count,
    duration,
    exr_file,
    fraction,
    load_scene,
    png_file,
)
from sim.commands.energy import print_books
from sim.commands.kept_work import kept_work
from sim.commands.sensor_output import check_sensor_files, write_readings

if TYPE_CHECKING:
    from scenes import Scene
    from sim.image.picture import Picture
    from sim.measure import Measurement
    from sim.photons.energy import EnergyBooks
    from sim.resumption.checkpoint import Checkpoint
    from sim.settings import RenderSettings

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "render a scene to a spectral EXR and a PNG"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    add_scene_arguments(parser)
    parser.add_argument("-o", "--output", type=exr_file, metavar="OUT.exr",
                        help="spectral EXR (default: the scene's name, in this folder)")
    parser.add_argument("--png", type=png_file, metavar="OUT.png",
                        help="developed picture (default: beside the EXR)")
    parser.add_argument("--photons", type=count, metavar="N", help="photons in each pass")
    parser.add_argument("--passes", type=count, metavar="N",
                        help="independent passes, averaged; two or more give a standard error")
    parser.add_argument("--preset", choices=("draft", "standard", "reference"),
                        help="photons and passes by name: draft for a look, reference to compare "
                             "with (default: standard)")
    parser.add_argument("--target-error", type=fraction, metavar="P%",
                        help="stop once the picture is as good: root mean square over the pixels "
                             "of the luminance's estimated error, noise and bias, each relative "
                             "to the pixel's luminance plus the picture's mean; --passes is then "
                             "a limit")
    parser.add_argument("--time-budget", type=duration, metavar="60s",
                        help="begin no passes that would end later than this after the start; "
                             "writing the files comes on top")
    parser.add_argument("--resume", action=argparse.BooleanOptionalAction, default=None,
                        help="go on from the checkpoint of a run that was cut short, OUT.exr."
                             "checkpoint, to the file that it would have written; --no-resume: "
                             "start anew, and replace the checkpoint by the first of the new run "
                             "(default: so too, but not if that threw away a minute's work or "
                             "more)")
    parser.add_argument("--error-map", type=png_file, metavar="OUT.png",
                        help="also draw each pixel's relative error")
    parser.add_argument("--photon-map", action="store_true",
                        help="draw the photons that the first pass stores, coloured by wavelength, "
                             "and nothing else (default file: SCENE.photons.png, or --png)")
    parser.add_argument("--radius", type=float, metavar="M",
                        help="gather radius of the first pass [m], the same everywhere (default: "
                             "the scene's, if it has one)")
    parser.add_argument("--radius-pixels", type=float, metavar="W",
                        help="gather radius of the first pass in widths of each pixel on what it "
                             "sees, instead of one in metres (default: 2, unless the scene has a "
                             "radius)")
    parser.add_argument("--alpha", type=float, default=2 / 3, metavar="A",
                        help="how slowly the radius shrinks from pass to pass; 1: not at all "
                             "(default: 2/3)")
    parser.add_argument("--bounces", type=int, metavar="N",
                        help="diffuse surfaces that light may be reflected by on its way to the "
                             "one that is seen (default: the scene's, else 0)")
    parser.add_argument("--polarisation", choices=("auto", "averaged", "s-p", "stokes"),
                        default="auto",
                        help="how polarised light is followed: not at all, by its shares of s and "
                             "p, or by Stokes vectors (default: auto, as the scene requires)")
    parser.add_argument("--precision", choices=("float32", "float64"),
                        help="arithmetic of tracing (default: float64 on cpu, else float32)")
    parser.add_argument("--seed", type=count, default=0, metavar="N",
                        help="equal seeds give equal pictures (default: 0)")
    parser.add_argument("--threads", type=count, metavar="N",
                        help="CPU threads (default: all cores)")
    parser.add_argument("--device", default="cpu", help="cpu (default), cuda:0, …")
    parser.add_argument("--exposure", type=_stops, metavar="STOPS",
                        help="exposure of the PNG (default: the scene's, else automatic)")
    parser.add_argument("--verbose", action="store_true",
                        help="print where the energy and the time went")


def _stops(text: str) -> float:
    stops = float(text)
    if not math.isfinite(stops):
        raise ValueError
    return stops


_stops.__name__ = "number of stops"


def run(arguments: argparse.Namespace) -> None:
    """Render, then write the files; outputs, settings and scene are checked before."""
    from sim.atomic_file import check_writable
    from sim.errors import SettingsError
    from sim.settings import RenderSettings

    start = time.perf_counter()
    names = {field.name for field in dataclasses.fields(RenderSettings)}
    given = {name: value for name, value in vars(arguments).items() if name in names}
    settings = RenderSettings(**given)
    scene = load_scene(arguments)
    if arguments.photon_map:
        if arguments.resume:
            raise SettingsError("resume", True, "no --resume: a photon map is of one pass")
        _draw_photons(scene, settings, arguments.png or Path(f"{scene.source_name}.photons.png"))
        return
    exr_path = arguments.output or Path(f"{scene.source_name}.exr")
    check_sensor_files(scene, exr_path)
    pictured = arguments.png is not None or arguments.error_map is not None
    measures = scene.sensors and scene.camera is None and not pictured
    if not measures:
        for path in (exr_path, arguments.png or exr_path.with_suffix(".png"), arguments.error_map):
            if path is not None:
                check_writable(path)
    with kept_work(exr_path, arguments.words, resume=arguments.resume) as checkpoint:
        work = _measure_to_files if measures else _render_to_files
        energy, timings = work(scene, settings, arguments, exr_path, checkpoint)
    if arguments.verbose:
        print_books(energy, scene.film.centres_nm.tolist())
        _print_timings(timings, time.perf_counter() - start)


_Account = tuple["EnergyBooks", dict[str, float]]
"""Where the energy and the time went."""


def _measure_to_files(
    scene: Scene,
    settings: RenderSettings,
    _arguments: argparse.Namespace,
    output: Path,
    checkpoint: Checkpoint,
) -> _Account:
    """Measure, and write what the sensors have measured."""
    measurement = _measured(scene, settings, checkpoint)
    write_readings(scene, measurement.sensors, output)
    return measurement.energy, measurement.timings


def _render_to_files(
    scene: Scene,
    settings: RenderSettings,
    arguments: argparse.Namespace,
    exr_path: Path,
    checkpoint: Checkpoint,
) -> _Account:
    """Render, and write the picture and what the sensors have measured."""
    from sim.atomic_file import write_whole

    start = time.perf_counter()
    png_path = arguments.png or exr_path.with_suffix(".png")
    picture, exr, png = _rendered(scene, settings, arguments.exposure, checkpoint)
    write_whole(exr_path, exr)
    write_whole(png_path, png)
    if arguments.error_map is not None:
        _draw_error_map(picture, arguments.error_map)
    seconds = time.perf_counter() - start
    height, width, bands = picture.spectral_radiance.shape
    print(f"{exr_path} and {png_path}: {width} × {height}, {bands} bands, {seconds:.1f} s")
    print(_accuracy_text(picture))
    write_readings(scene, picture.sensors, exr_path)
    return picture.energy, picture.timings


def _draw_photons(scene: Scene, settings: RenderSettings, path: Path) -> None:
    """Draw the first pass's photons instead of a picture."""
    from sim.atomic_file import check_writable, write_whole
    from sim.image.png import encode_png
    from sim.interruption import run_interruptibly

    def work() -> memoryview:
        from sim.photon_picture import picture_photons

        return encode_png(picture_photons(scene, settings))

    check_writable(path)
    write_whole(path, run_interruptibly(work))
    print(f"{path}: the photons that the first pass stores")


def _rendered(
    scene: Scene,
    settings: RenderSettings,
    exposure_stops: float | None,
    checkpoint: Checkpoint,
) -> tuple[Picture, memoryview, memoryview]:
    """The picture and the content of its two files, EXR and PNG."""
    from sim.image.exr import encode_exr
    from sim.image.png import encode_png
    from sim.interruption import run_interruptibly
    from sim.progress import ProgressCallback
    from sim.progress_display import progress_display

    def work(progress: ProgressCallback) -> tuple[Picture, memoryview, memoryview]:
        from sim.render import render

        picture = render(scene, settings, progress=progress, checkpoint=checkpoint)
        exr = encode_exr(picture, exposure_stops=exposure_stops)
        return picture, exr, encode_png(picture.develop(exposure_stops=exposure_stops))

    with progress_display(sys.stderr) as progress:
        return run_interruptibly(functools.partial(work, progress))


def _measured(
    scene: Scene, settings: RenderSettings, checkpoint: Checkpoint
) -> Measurement:
    """What the sensors measure, without a picture."""
    from sim.interruption import run_interruptibly
    from sim.progress import ProgressCallback
    from sim.progress_display import progress_display

    def work(progress: ProgressCallback) -> Measurement:
        from sim.measure import measure

        return measure(scene, settings, progress=progress, checkpoint=checkpoint)

    with progress_display(sys.stderr) as progress:
        return run_interruptibly(functools.partial(work, progress))


def _draw_error_map(picture: Picture, path: Path) -> None:
    from sim.error_map import plot_error_map
    from sim.figure_file import save_figure

    save_figure(plot_error_map(picture.accuracy), path)


def _accuracy_text(picture: Picture) -> str:
    """The achieved error in words, and why there were no more passes."""
    accuracy, passes = picture.accuracy, picture.settings.passes
    if math.isnan(accuracy.relative_error):
        return f"error: not known from {passes} pass{'es' if passes > 1 else ''}"
    return (
        f"error: {accuracy.relative_error:.2%} (noise {accuracy.relative_noise:.2%}, "
        f"bias {accuracy.relative_bias:.2%}) after {passes} passes: {picture.stopping}"
    )


def _print_timings(timings: dict[str, float], seconds: float) -> None:
    """Where the time went. The stages overlap: the next pass is traced while one is gathered."""
    print("time, of stages that overlap")
    for stage, spent in timings.items():
        print(f"  {stage:<18}{spent:10.2f} s")
    print(f"  {'in all':<18}{seconds:10.2f} s")
