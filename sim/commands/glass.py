"""Tell what is known of a medium: its index and dispersion, where from, and for which range."""

from __future__ import annotations

import argparse

from sim.commands.arguments import figure_file

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "index, Abbe number, range and source of a medium"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("name", help="a medium, as its source writes it: N-BK7, fused silica, …")
    parser.add_argument("-o", "--output", type=figure_file, metavar="PLOT.png|.svg",
                        help="also plot the index over the visible range")


def run(arguments: argparse.Namespace) -> None:
    """Print the medium's data, and plot it if asked to."""
    from sim.atomic_file import check_writable
    from spectra import glass
    from spectra.units import FRAUNHOFER_C_NM, FRAUNHOFER_D_NM, FRAUNHOFER_F_NM

    if arguments.output is not None:
        check_writable(arguments.output)
    medium = glass(arguments.name)
    lowest_nm, highest_nm = medium.wavelength_range_nm
    print(medium.name)
    print(f"  n_d          {medium.n_d:.6f}")
    print(f"  Abbe number  {medium.abbe_number:.2f}")
    lines = ("F", FRAUNHOFER_F_NM), ("d", FRAUNHOFER_D_NM), ("C", FRAUNHOFER_C_NM)
    for line, wavelength_nm in lines:
        print(f"  n at {line}       {medium.eta(wavelength_nm):.6f}  ({wavelength_nm} nm)")
    print(f"  range        {lowest_nm:g} to {highest_nm:g} nm")
    print(f"  relative to  {medium.relative_to}")
    print(f"  source       {medium.source}")
    if arguments.output is not None:
        from sim.figure_file import save_figure
        from sim.glass_plot import plot_glass

        save_figure(plot_glass(medium), arguments.output)
