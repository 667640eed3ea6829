"""The device-side layout of a scene: what each kernel is handed.

Every array is of structs, one element an object, so that a kernel's scene argument is a dozen
arrays rather than fifty numbers. Positions are in the scene's local frame [m].
"""

import functools
from types import SimpleNamespace

import warp as wp

from sim.mesh_structs import make_mesh_structs
from sim.precision import precision_types

__all__ = [
    "ABSORBER",
    "CAUCHY",
    "DIELECTRIC",
    "LAMBERTIAN",
    "METAL",
    "MIRROR",
    "POLARISER",
    "SELLMEIER",
    "SHAPE_FLAT",
    "SHAPE_LENS",
    "SHAPE_MESH",
    "SHAPE_POLYHEDRON",
    "SHAPE_SPHERE",
    "TABULATED",
    "make_scene_structs",
]

DIELECTRIC = wp.constant(0)
LAMBERTIAN = wp.constant(1)
ABSORBER = wp.constant(2)
MIRROR = wp.constant(3)
METAL = wp.constant(4)
POLARISER = wp.constant(5)

SELLMEIER = wp.constant(0)
CAUCHY = wp.constant(1)
TABULATED = wp.constant(2)

SHAPE_SPHERE = wp.constant(0)
SHAPE_FLAT = wp.constant(1)
SHAPE_POLYHEDRON = wp.constant(2)
SHAPE_LENS = wp.constant(3)
SHAPE_MESH = wp.constant(4)


@functools.cache
def make_shape_structs(precision: str) -> SimpleNamespace:
    """Structs of the shapes: Sphere, Flat, Polyhedron, Plane, Lens."""
    types = precision_types(precision)
    real, vec3, mat33 = types.real, types.vec3, types.mat33

    @wp.struct
    class Sphere:
        centre: vec3
        radius: real
        prim: int

    @wp.struct
    class Flat:
        """A rectangle, a disk or a plane: its limits are infinite where it has none."""

        centre: vec3
        frame: mat33  # rows: u, v, normal
        half_u: real
        half_v: real
        radius2: real
        prim: int

    @wp.struct
    class Plane:
        normal: vec3
        offset: real

    @wp.struct
    class Polyhedron:
        centre: vec3
        first: int
        count: int
        prim: int

    @wp.struct
    class Lens:
        centre: vec3
        frame: mat33  # rows: u, v, axis
        half_thickness: real
        curvature_front: real
        one_plus_conic_front: real
        curvature_back: real
        one_plus_conic_back: real
        radius: real
        rho2_limit: real
        rim_low: real
        rim_high: real
        prim: int

    return SimpleNamespace(
        Sphere=Sphere, Flat=Flat, Plane=Plane, Polyhedron=Polyhedron, Lens=Lens
    )


@functools.cache
def make_ray_structs(precision: str) -> SimpleNamespace:
    """Structs of a ray and of what it meets: Ray, Hit, Interaction."""
    types = precision_types(precision)
    real, vec3, vec4 = types.real, types.vec3, types.vec4

    @wp.struct
    class Ray:
        """A ray that has just left face `face` of object `prim` (−1: nothing).

        `prim2` and `face2` are a second one in the same place.
        """

        origin: vec3
        direction: vec3
        prim: int
        face: int
        prim2: int
        face2: int

    @wp.struct
    class Hit:
        """The nearest surface: distance, object, face, and its outward (or front) unit normal."""

        t: real
        normal: vec3
        prim: int
        face: int

    @wp.struct
    class Interaction:
        """What the surface does. `normal` faces the incoming ray; `side` 1 is the inside or back.

        `part` is the part of the object's surface that this point is of: the face, of a mesh the
        patch that sharp edges bound.

        `prim2` and `face2` are a second surface in the same place, −1 for none. `medium` is the
        one on the ray's side, `alpha` its absorption coefficient [1/m]. `absorbed` is the part of
        the flux that is lost on the way here and, at a mirror or a metal, to the surface.

        At a boundary: `eta` is η_i/η_t, `reflectance` the mean of R_s and R_p, `total` 1 where
        the reflection is total (then `refracted` is unset). A mirror or a metal is `opaque`, and
        reflects what it does not absorb totally.

        Where light is followed polarised, `matrix` is (mean, half, cosine, sine) of the reflection
        and `together` √(T_s T_p), see `sim.polarised_light`, which finds `reflectance` and the
        surface's part of `absorbed`. A polariser `filters`: what its matrix would reflect, along
        the absorbing axis, it absorbs.
        """

        event: int
        t: real
        point: vec3
        normal: vec3
        prim: int
        face: int
        part: int
        prim2: int
        face2: int
        side: int
        medium: int
        dispersive: int
        total: int
        opaque: int
        filters: int
        absorbed: real
        alpha: real
        eta: real
        reflectance: real
        matrix: vec4
        together: real
        reflected: vec3
        refracted: vec3

    return SimpleNamespace(Ray=Ray, Hit=Hit, Interaction=Interaction)


@functools.cache
def make_scene_structs(precision: str) -> SimpleNamespace:
    """All structs of one precision, and the scalar types they are made of.

    Returns:
        A namespace with `real`, `vec3`, `mat33`, the shape structs, the ray structs, and Body
        (one a scene object), Medium, Finish and Scene.
    """
    types = precision_types(precision)
    real, vec3 = types.real, types.vec3
    shapes, rays = make_shape_structs(precision), make_ray_structs(precision)
    sphere, flat, plane = shapes.Sphere, shapes.Flat, shapes.Plane
    polyhedron, lens = shapes.Polyhedron, shapes.Lens
    meshes_type = make_mesh_structs(precision).Meshes

    @wp.struct
    class Body:
        """An object: its shape (kind, and row in that kind's array), and what it is made of.

        `medium_inside` of any but a dielectric is the ambient medium, 0. `neighbours` are objects
        that may touch or hold points of its surface: `neighbour_count` of the scene's list, from
        `neighbour_first` on.
        """

        shape: int
        row: int
        material: int
        medium_inside: int
        rank: int  # of two media in one place the higher rank's fills it
        finish: int  # row of its mirror or metal
        dispersive: int
        neighbour_first: int
        neighbour_count: int

    @wp.struct
    class Medium:
        formula: int
        knot_first: int
        knot_count: int
        air_power: int  # +1: multiply by the index of air, −1: divide by it
        loss_first: int  # knots of its absorption coefficient [1/m]
        loss_count: int
        varies: int  # 1 if index or absorption depend on the wavelength
        tints: int  # 1 if absorption does

    @wp.struct
    class Finish:
        """Reflectance of a mirror or a diffuse surface, or a metal's n and k, as rows of knots."""

        first: int
        count: int
        k_first: int
        k_count: int
        varies: int  # 1 if it depends on the wavelength

    @wp.struct
    class Scene:
        spheres: wp.array(dtype=sphere)
        flats: wp.array(dtype=flat)
        polyhedra: wp.array(dtype=polyhedron)
        planes: wp.array(dtype=plane)
        lenses: wp.array(dtype=lens)
        meshes: meshes_type
        bodies: wp.array(dtype=Body)
        neighbours: wp.array(dtype=int)
        media: wp.array(dtype=Medium)
        finishes: wp.array(dtype=Finish)
        absorbing_axes: wp.array(dtype=vec3)  # one an object, 0 where it is no polariser
        coefficients: wp.array2d(dtype=real)
        knots_nm: wp.array(dtype=real)
        cubics: wp.array2d(dtype=real)
        sphere_count: int
        flat_count: int
        polyhedron_count: int
        lens_count: int
        touch: real  # surfaces nearer than this are in one place [m]

    return SimpleNamespace(
        real=real,
        vec3=types.vec3,
        vec4=types.vec4,
        mat33=types.mat33,
        Body=Body,
        Medium=Medium,
        Finish=Finish,
        Scene=Scene,
        **vars(shapes),
        **vars(rays),
    )
