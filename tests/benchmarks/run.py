"""All benchmarks with one command: ``python tests/benchmarks/run.py``.

    rates     the photon tracer against a scalar C program, and two threads over one
    kernels   full kernels over those that are compiled for what a scene requires
    savings   what Sobol points, aiming and branch weights are worth, and how fast errors fall
    scaling   how cost grows with photons, pixels and bands
    presets   each preset against other photons and passes at equal time: half an hour, when named
    picture   1920 × 1080 of the lens at the preset `standard`: some minutes, only when named

Prints ratios, each with its least and greatest or its 95 % interval, and what is asked of it.
``--record`` adds them to `history.csv` beside this file, to compare against later.
"""

import argparse
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import kernels
import presets
import savings
import scaling
import standard_picture
import tracer_rates
from history import Measure, record

ALWAYS = ("rates", "kernels", "savings", "scaling")
BENCHMARKS = (*ALWAYS, "presets", "picture")
SCENES = ("ball", "prism", "lens")


def works(options: argparse.Namespace) -> Iterator[Callable[[], list[Measure]]]:
    """Everything that is asked for, in turn."""
    for name in options.scenes:
        if "rates" in options.benchmarks:
            yield lambda name=name: tracer_rates.compare(
                name, options.photons, options.repetitions
            )
        if "kernels" in options.benchmarks:
            yield lambda name=name: kernels.compare(name, max(1, options.repetitions // 3))
        if "savings" in options.benchmarks:
            yield lambda name=name: savings.study(name)
        if "presets" in options.benchmarks:
            yield lambda name=name: presets.measures(name)
    if "scaling" in options.benchmarks:
        yield lambda: scaling.measures(options.plot)
    if "picture" in options.benchmarks:
        yield standard_picture.render


def main() -> None:
    """Run the benchmarks from the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "benchmarks", nargs="*", metavar="BENCHMARK", default=list(ALWAYS),
        help="rates, kernels, savings, scaling (all four if none is named), presets, picture",
    )
    parser.add_argument("--scenes", nargs="+", default=SCENES, metavar="SCENE")
    parser.add_argument("--photons", type=int, default=500_000, help="of the rates")
    parser.add_argument("--repetitions", type=int, default=9, help="of rates, a third of kernels")
    parser.add_argument("--plot", type=Path, metavar="PLOT.svg", help="where to plot the scaling")
    parser.add_argument("--record", action="store_true", help="add what is found to history.csv")
    options = parser.parse_args()
    unknown = set(options.benchmarks) - set(BENCHMARKS)
    if unknown:
        parser.error(f"no such benchmark: {', '.join(sorted(unknown))}; {', '.join(BENCHMARKS)}")
    for work in works(options):
        measures = work()
        print(*measures, sep="\n", flush=True)
        if options.record:
            record(measures)


if __name__ == "__main__":
    main()
