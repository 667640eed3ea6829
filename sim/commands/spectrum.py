"""Tell what light a lamp gives: its lines or its range, its colour, its colour temperature.

NAME is a CIE illuminant or a spectral lamp (nephroid spectrum lists them), a blackbody by its
temperature, 3000K, or a laser by its wavelength, 532nm.
"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from sim.commands.arguments import figure_file

if TYPE_CHECKING:
    from spectra import EmissionSpectrum

__all__ = ["SUMMARY", "add_arguments", "run"]

SUMMARY = "colour, colour temperature and lines of a lamp, a blackbody or a laser"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("name", nargs="?", metavar="NAME",
                        help="D65, A, sodium, …, 3000K, 532nm; without it, all are listed")
    parser.add_argument("-o", "--output", type=figure_file, metavar="PLOT.png|.svg",
                        help="also plot the spectrum, and its colour by each gamut mapping")


def run(arguments: argparse.Namespace) -> None:
    """Print what is known of a light, and plot it if asked to; or list those with a name."""
    from sim.atomic_file import check_writable
    from spectra import spectrum_names

    if arguments.output is not None:
        check_writable(arguments.output)
    if arguments.name is None:
        print(", ".join(spectrum_names()))
        return
    source = _source(arguments.name)
    _tell(source)
    if arguments.output is not None:
        from sim.charts.spectrum import plot_spectrum
        from sim.figure_file import save_figure

        save_figure(plot_spectrum(source), arguments.output)


def _source(name: str) -> EmissionSpectrum:
    """The light that a name, a temperature or a wavelength stands for."""
    from spectra import UnknownSpectrum, blackbody, laser, spectrum

    for unit, make in (("nm", laser), ("K", blackbody)):
        if name.endswith(unit):
            try:
                number = float(name.removesuffix(unit))
            except ValueError:
                break
            return make(number)
    try:
        return spectrum(name)
    except UnknownSpectrum as error:
        raise UnknownSpectrum(name, (*error.known, "3000K", "532nm")) from None


def _tell(source: EmissionSpectrum) -> None:
    from sim.charts.swatches import hex_code, shown_colours, to_full_brightness
    from spectra import chromaticity, colour_temperature, luminous_efficacy, tristimulus
    from spectra.srgb import xyz_to_linear_srgb

    lowest_nm, highest_nm = source.support_nm
    print(source.name)
    if len(source.wavelength_nm):
        print(f"  range        {lowest_nm:g} to {highest_nm:g} nm")
    for line_nm, flux in zip(source.line_wavelength_nm, source.line_flux, strict=True):
        print(f"  line         {line_nm:.4f} nm, {flux / source.line_flux.max():.3g}")
    xyz = tristimulus(source)
    if not xyz.sum() > 0.0:
        print("  colour       none: the eye does not see it")
        return
    x, y = chromaticity(xyz)
    print(f"  CIE 1931     x = {x:.4f}, y = {y:.4f}")
    nearest = colour_temperature(xyz)
    if nearest is None:
        print("  temperature  no blackbody is of about this colour")
    else:
        duv = round(nearest.duv, 4) + 0.0  # never "-0.0000"
        print(f"  temperature  {nearest.kelvin:.0f} K, Duv {duv:+.4f} (correlated colour"
              " temperature)")
    print(f"  efficacy     {luminous_efficacy(source):.1f} lm/W, of the light alone")
    for method, codes in shown_colours(to_full_brightness(xyz_to_linear_srgb(xyz))).items():
        print(f"  sRGB         {hex_code(codes)} ({method}, at full brightness)")
