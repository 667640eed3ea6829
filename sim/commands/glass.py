"""Tell what is known of a medium or a metal: index, absorption, colour, and where it is from."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from sim.commands.arguments import figure_file, length

if TYPE_CHECKING:
    from pathlib import Path

    from spectra import Absorption, Conductor, Medium
    from spectra.arrays import FloatArray

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "index, absorption, colour and source of a medium or a metal"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("name", nargs="?", help="a medium or a metal, as its source writes it:"
                        " N-BK7, fused silica, gold, …; without it, all are listed")
    parser.add_argument("--thickness", type=length, default=0.01, metavar="LENGTH",
                        help="what the internal transmittance is told of: 10mm, 0.01 (metres), …"
                        " (default 10mm)")
    parser.add_argument("-o", "--output", type=figure_file, metavar="PLOT.png|.svg",
                        help="also plot index, reflectance, transmittance and colours")


def run(arguments: argparse.Namespace) -> None:
    """Print the data of a medium or a metal, and plot it if asked to; or list them all."""
    from sim.atomic_file import check_writable
    from spectra import UnknownGlass, conductor, conductors, glass, glasses

    if arguments.output is not None:
        check_writable(arguments.output)
    if arguments.name is None:
        print(f"media   {', '.join(glasses())}\nmetals  {', '.join(conductors())}")
    elif arguments.name in conductors():
        _tell_metal(conductor(arguments.name), arguments.output)
    elif arguments.name in glasses():
        _tell_medium(glass(arguments.name), arguments.thickness, arguments.output)
    else:
        raise UnknownGlass(arguments.name, (*glasses(), *conductors()))


def _tell_medium(medium: Medium, thickness_m: float, output: Path | None) -> None:
    from sim.charts.glass import plot_glass
    from sim.figure_file import save_figure
    from spectra import absorbing_media, published_absorption
    from spectra.units import FRAUNHOFER_LINES_NM

    lowest_nm, highest_nm = medium.wavelength_range_nm
    print(medium.name)
    print(f"  n_d          {medium.n_d:.6f}")
    print(f"  Abbe number  {medium.abbe_number:.2f}")
    for line, wavelength_nm in FRAUNHOFER_LINES_NM.items():
        print(f"  n at {line}       {medium.eta(wavelength_nm):.6f}  ({wavelength_nm} nm)")
    print(f"  range        {lowest_nm:g} to {highest_nm:g} nm")
    print(f"  relative to  {medium.relative_to}")
    print(f"  source       {medium.source}")
    is_published = medium.name in absorbing_media()
    absorption = published_absorption(medium.name) if is_published else None
    if absorption is None:
        print("  absorption   not published here")
    else:
        _tell_absorption(absorption, thickness_m)
    if output is not None:
        save_figure(plot_glass(medium, absorption, thickness_m=thickness_m), output)


def _tell_absorption(absorption: Absorption, thickness_m: float) -> None:
    from sim.charts.glass import colour_through
    from spectra.units import FRAUNHOFER_LINES_NM

    lowest_nm, highest_nm = absorption.wavelength_range_nm
    print(f"  through {thickness_m * 1000.0:g} mm, without reflections at the faces")
    for line, wavelength_nm in FRAUNHOFER_LINES_NM.items():
        passed = absorption.transmittance(wavelength_nm, thickness_m)
        print(f"    at {line}       {passed:.4f}")
    print(f"    of D65     {_colours(colour_through(absorption, thickness_m))}")
    print(f"    range      {lowest_nm:g} to {highest_nm:g} nm")
    print(f"    source     {absorption.source}")


def _tell_metal(metal: Conductor, output: Path | None) -> None:
    import numpy as np

    from sim.charts.metal import normal_reflectance, plot_metal, reflected_colour
    from sim.figure_file import save_figure
    from spectra.units import FRAUNHOFER_LINES_NM

    lowest_nm, highest_nm = metal.wavelength_range_nm
    print(metal.name)
    for line, wavelength_nm in FRAUNHOFER_LINES_NM.items():
        reflectance = normal_reflectance(metal, np.array([wavelength_nm]))[0]
        print(
            f"  n + ik at {line}  {metal.eta(wavelength_nm):.4f} + {metal.k(wavelength_nm):.4f}i,"
            f" reflects {reflectance:.4f}  ({wavelength_nm} nm)"
        )
    print(f"  reflects D65 {_colours(reflected_colour(metal))}")
    print(f"  range        {lowest_nm:g} to {highest_nm:g} nm")
    print(f"  source       {metal.source}")
    if output is not None:
        save_figure(plot_metal(metal), output)


def _colours(linear: FloatArray) -> str:
    """What a screen shows, "#fefff9", or by each gamut mapping if that makes a difference."""
    from sim.charts.swatches import hex_code, shown_colours

    codes = {method: hex_code(colour) for method, colour in shown_colours(linear).items()}
    if len(set(codes.values())) == 1:
        return f"sRGB {next(iter(codes.values()))}"
    return "sRGB " + ", ".join(f"{code} ({method})" for method, code in codes.items())
