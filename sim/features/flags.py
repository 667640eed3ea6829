"""The flags that shape compiled code: one for each feature that kernels can do without."""

from dataclasses import dataclass
from typing import Literal

from sim.method import DEFAULT_METHOD, Method

__all__ = ["Features", "LightMode"]

LightMode = Literal["averaged", "s-p", "stokes"]
"""How kernels follow the polarisation of light, see `sim.polarised_light`."""


@dataclass(frozen=True, kw_only=True)
class Features:
    """What kernels are compiled to handle; hashable, since they are cached by it.

    Every flag is the handle of one registered feature, and is on unless something is known that
    allows to leave it out: `Features()` is the full kernel's.

    Attributes:
        spheres, flats, polyhedra, lenses, meshes: which shapes a ray can meet.
        sellmeier, cauchy, tabulated: which dispersion formulas the media use.
        air_conversion: some index is converted between "relative to air" and "to vacuum".
        boundaries: light can meet a boundary between two media.
        interfaces: solids can touch, nest or overlap.
        absorption: some medium absorbs.
        finishes: light can meet a mirror or a metal.
        polarisers: light can meet a polariser.
        polarisation: light carries how much more of it is s than p, from surface to surface.
        stokes: photons carry Stokes vectors, as their planes of incidence differ.
        camera_stokes: camera paths do.
        interreflection: diffuse surfaces light one another.
        reflected_branches: boundaries can reflect.
        dispersion: boundaries can part light by its wavelength.
        undispersed_photons: photons that no dispersion has touched can be in the map.
        direct_light: shadow rays find what comes straight from the lamps.
        beams, sphere_lamps, rectangle_lamps: which extended lamps shadow rays can lead to.
        sensors: there are sensors that light can cross.
        distant_lamps: some light comes from infinitely far away.
        masks: some lamp or beam has a mask.
        thin_lens: the camera has an aperture.
        pixel_filter: pixels are more than their squares.
        visible_lamps: camera paths can meet a lamp.
        media_count: how many media there are, the ambient one among them. A size, no feature.
        method: how light is followed. A choice of the caller's, no feature.
    """

    spheres: bool = True
    flats: bool = True
    polyhedra: bool = True
    lenses: bool = True
    meshes: bool = True
    sellmeier: bool = True
    cauchy: bool = True
    tabulated: bool = True
    air_conversion: bool = True
    boundaries: bool = True
    interfaces: bool = True
    absorption: bool = True
    finishes: bool = True
    polarisers: bool = True
    polarisation: bool = True
    stokes: bool = True
    camera_stokes: bool = True
    interreflection: bool = True
    reflected_branches: bool = True
    dispersion: bool = True
    undispersed_photons: bool = True
    direct_light: bool = True
    beams: bool = True
    sphere_lamps: bool = True
    rectangle_lamps: bool = True
    sensors: bool = True
    distant_lamps: bool = True
    masks: bool = True
    thin_lens: bool = True
    pixel_filter: bool = True
    visible_lamps: bool = True
    media_count: int = 1
    method: Method = DEFAULT_METHOD

    @property
    def polarises(self) -> bool:
        """Whether light carries any polarisation at all: Fresnel's formulas alone know of it."""
        return self.polarisation and self.method.fresnel == "exact"

    def light_of(self, kernel: Literal["photons", "camera"]) -> LightMode:
        """How photons (and single rays) or camera paths are followed."""
        if not self.polarises:
            return "averaged"
        return "stokes" if (self.stokes if kernel == "photons" else self.camera_stokes) else "s-p"
