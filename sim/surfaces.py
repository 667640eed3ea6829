"""What a smooth surface does to the light that meets it: directions, and how much goes where.

A surface is told by (mean, half, cosine, sine) of its reflection, see `sim.optics.polarisation`,
and by √(T_s T_p) of what it lets through. Where light is not followed polarised, the mean is all
that there is, and the rest is 0.
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.features import Features
from sim.optics.conductor import conductor_reflectance
from sim.optics.dielectric import (
    cos2_theta_t,
    fresnel_reflectance,
    reflect,
    refract,
    schlick_reflectance,
)
from sim.optics.polarisation import (
    conductor_matrix,
    fresnel_amplitudes,
    total_reflection_phase,
)
from sim.scene_structs import make_scene_structs

__all__ = ["make_surfaces"]


@functools.cache
def make_surfaces(precision: str, features: Features) -> SimpleNamespace:
    """Device functions of boundaries, mirrors and metals.

    Returns:
        A namespace with `cross(direction, normal, eta)`, which returns total or not, the matrix
        (mean, half, cosine, sine), √(T_s T_p), and the directions reflected and refracted; and
        `finish(cos_theta_i, value, k)`, the matrix of a mirror of reflectance `value` where k is
        negative, else of a metal of index `value` + i k, relative to the medium before it.
    """
    structs = make_scene_structs(precision)
    real, vec3, vec4 = structs.real, structs.vec3, structs.vec4

    @wp.func
    def averaged(mean: real):
        return vec4(mean, real(0.0), real(0.0), real(0.0))

    @wp.func
    def share_reflected(cos_theta_i: real, cos_theta_t: real, eta: real):
        reflectance = real(0.0)
        if wp.static(features.method.fresnel == "exact"):
            r_s, r_p = fresnel_reflectance(cos_theta_i, cos_theta_t, eta)
            reflectance = real(0.5) * (r_s + r_p)
        if wp.static(features.method.fresnel == "schlick"):
            reflectance = schlick_reflectance(cos_theta_i, cos_theta_t, eta)
        return averaged(reflectance), real(0.0)

    @wp.func
    def s_and_p_reflected(cos_theta_i: real, cos_theta_t: real, eta: real):
        r_s, r_p, together = fresnel_amplitudes(cos_theta_i, cos_theta_t, eta)
        of_s = real(0.5) * r_s * r_s
        of_p = real(0.5) * r_p * r_p
        return vec4(of_s + of_p, of_s - of_p, r_s * r_p, real(0.0)), together

    @wp.func
    def all_reflected(cos_theta_i: real, cos2_t: real, eta: real):
        return averaged(real(1.0))

    @wp.func
    def all_retarded(cos_theta_i: real, cos2_t: real, eta: real):
        cosine, sine = total_reflection_phase(cos_theta_i, cos2_t, eta)
        return vec4(real(1.0), real(0.0), cosine, sine)

    partly = s_and_p_reflected if features.polarises else share_reflected
    totally = all_retarded if features.polarises else all_reflected

    @wp.func
    def cross(direction: vec3, normal: vec3, eta: real):
        cos_theta_i = wp.min(-wp.dot(direction, normal), real(1.0))
        reflected = reflect(direction, normal, cos_theta_i)
        if wp.static(not features.reflected_branches):
            return 0, averaged(real(0.0)), real(1.0), reflected, direction
        if eta == real(1.0):
            # Exactly, at any angle.
            return 0, averaged(real(0.0)), real(1.0), reflected, direction
        cos2_t = cos2_theta_t(cos_theta_i, eta)
        if cos2_t <= real(0.0):
            return 1, totally(cos_theta_i, cos2_t, eta), real(0.0), reflected, reflected
        cos_theta_t = wp.sqrt(cos2_t)
        matrix, together = partly(cos_theta_i, cos_theta_t, eta)
        refracted = refract(direction, normal, cos_theta_i, cos_theta_t, eta)
        return 0, matrix, together, reflected, refracted

    @wp.func
    def finish_averaged(cos_theta_i: real, value: real, k: real):
        if k < real(0.0):
            return averaged(value)
        r_s, r_p = conductor_reflectance(cos_theta_i, value, k)
        return averaged(real(0.5) * (r_s + r_p))

    @wp.func
    def finish_polarised(cos_theta_i: real, value: real, k: real):
        if k < real(0.0):
            # As a perfect conductor, r_s = −1 and r_p = 1, times the root of its reflectance.
            return vec4(value, real(0.0), -value, real(0.0))
        mean, half, cosine, sine = conductor_matrix(cos_theta_i, value, k)
        return vec4(mean, half, cosine, sine)

    return SimpleNamespace(
        cross=cross, finish=finish_polarised if features.polarises else finish_averaged
    )
