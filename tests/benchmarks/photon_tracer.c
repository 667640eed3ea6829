/* The photon tracer of `sim.photons`, as a scalar C program for one thread: what Nephroid's
 * kernel is measured against. It does the same work on the same numbers and must arrive at the
 * same deposits and energy books to rounding; `run.py` writes its input and holds it to that.
 *
 *     cc -O3 -march=native photon_tracer.c -lm && ./a.out INPUT RUNS
 *
 * It handles what the benchmark's scenes need: spheres, rectangles and convex polyhedra of glass
 * (Sellmeier, Cauchy), diffuse and absorbing surfaces; beams, rectangular and spherical lamps.
 * The formulas and their sources stand in `sim`; only what C does differently is explained here.
 */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { DIMENSIONS = 5, SOBOL_ROW = 1024, STACK_SIZE = 8, MAX_MEDIA = 16, AIM_CELLS = 32 };
enum { DIELECTRIC, LAMBERTIAN, ABSORBER };
enum { SELLMEIER, CAUCHY };
enum { BEAM, POINT, SPOT, SPHERE_LAMP, RECTANGLE_LAMP };
enum { AIM_BASE, AIM_CONE, AIM_AREA };

static const double PI = 3.14159265358979323846;

/* fmax and fmin are calls, these are instructions. */
static inline double larger(double a, double b) { return a > b ? a : b; }
static inline double smaller(double a, double b) { return a < b ? a : b; }

/* ---------------------------------------------------------------- vectors */

typedef struct { double x, y, z; } Vec;

static inline Vec vec(double x, double y, double z) { return (Vec){x, y, z}; }
static inline Vec add(Vec a, Vec b) { return vec(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline Vec sub(Vec a, Vec b) { return vec(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline Vec scale(Vec a, double s) { return vec(a.x * s, a.y * s, a.z * s); }
static inline Vec along(Vec a, Vec d, double t) { return add(a, scale(d, t)); }
static inline double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vec normalize(Vec a) { return scale(a, 1.0 / sqrt(dot(a, a))); }
static inline Vec renormalize(Vec a) { return scale(a, 1.5 - 0.5 * dot(a, a)); }

/* ---------------------------------------------------------------- the scene */

typedef struct { Vec centre; double radius; int prim; } Sphere;
typedef struct { Vec centre, u, v, normal; double half_u, half_v, radius2; int prim; } Flat;
typedef struct { Vec normal; double offset; } Plane;
typedef struct { Vec centre; int first, count, prim; } Polyhedron;
/* Outside of all bodies is medium 0, the ambient one: none of the benchmark's touch. */
typedef struct { int material, inside, dispersive; } Body;
typedef struct { int formula; double c[8]; } Medium;
typedef struct {
    Vec centre, u, v, axis;
    double half_u, half_v, radius, sin2_half, flux;
    const double *cdf;
    int kind, round, first_target, target_count, first_segment, segment_count;
} Emitter;
typedef struct {
    Vec centre, u, v, normal;
    double half_u, half_v, radius, pivot, photons;
    const double *cdf; /* NULL: even */
    int kind;
} Target;
typedef struct { double wavelength_nm, width_nm, density_low, density_high; } Segment;
typedef struct { int emitter, target; uint32_t photons, seeds[DIMENSIONS]; uint64_t key; } Stream;

typedef struct {
    Sphere *spheres; Flat *flats; Plane *planes; Polyhedron *polyhedra;
    Body *bodies; Medium *media; Emitter *emitters; Target *targets; Segment *segments;
    Stream *streams;
    double *cdf;
    int sphere_count, flat_count, plane_count, polyhedron_count;
    int body_count, media_count, emitter_count, target_count, segment_count, stream_count, cdf_count;
    uint32_t sobol[DIMENSIONS * SOBOL_ROW];
    int max_interactions, slots_per_photon, colours, store_direct;
    double branch_threshold;
} Scene;

/* Deposits, an array each: what `sim.photons.photon_structs.Photons` holds. */
typedef struct {
    Vec *position; float (*direction)[3]; float *wavelength_nm; double *flux;
    int32_t *surface, *history, *emitter;
    size_t count, room;
} Photons;

typedef struct { double emitted, deposited, absorbed, escaped, culled; } Books;

typedef struct { Vec origin, direction; int prim, face; } Ray;
typedef struct { double t; Vec normal; int prim, face; } Hit;

/* ---------------------------------------------------------------- random numbers */

static inline uint64_t hash64(uint64_t key, uint64_t counter) {
    uint64_t z = key + 0x9E3779B97F4A7C15u * (counter + 1);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

static inline uint32_t reverse_bits(uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0F0F0F0Fu) | ((x & 0x0F0F0F0Fu) << 4);
    return __builtin_bswap32(x);
}

/* Owen-scrambled Sobol number in [0, 1) with 53 bits, the last 21 of them from `low_bits`. */
static inline double sobol_uniform(const uint32_t *row, uint32_t i, uint32_t seed, uint64_t low_bits) {
    uint32_t x = row[i & 255] ^ row[256 + ((i >> 8) & 255)] ^ row[512 + ((i >> 16) & 255)]
               ^ row[768 + (i >> 24)];
    x ^= x * 0x3D20ADEAu;
    x += seed;
    x *= (seed >> 16) | 1;
    x ^= x * 0x05526C56u;
    x ^= x * 0x53A22864u;
    uint64_t bits = (uint64_t)reverse_bits(x) << 21 | (low_bits & 0x1FFFFF);
    return (double)(int64_t)bits * 0x1p-53;
}

/* ---------------------------------------------------------------- emission */

static inline void sample_disk(double u0, double u1, double *x, double *y) {
    double a = 2.0 * u0 - 1.0, b = 2.0 * u1 - 1.0;
    if (a == 0.0 && b == 0.0) { *x = *y = 0.0; return; }
    if (fabs(a) > fabs(b)) {
        double angle = 0.25 * PI * (b / a);
        *x = a * cos(angle);
        *y = a * sin(angle);
    } else {
        double angle = 0.25 * PI * (a / b);
        *x = b * sin(angle);
        *y = b * cos(angle);
    }
}

/* The numbers that sample_disk turns into (x, y). */
static inline void disk_square(double x, double y, double *u0, double *u1) {
    double r = sqrt(x * x + y * y), a = 0.0, b = 0.0;
    if (r > 0.0 && fabs(x) > fabs(y)) {
        a = copysign(r, x);
        b = a * (4.0 / PI) * atan(y / x);
    } else if (r > 0.0) {
        b = copysign(r, y);
        a = b * (4.0 / PI) * atan(x / y);
    }
    *u0 = 0.5 + 0.5 * a;
    *u1 = 0.5 + 0.5 * b;
}

static inline Vec sample_cone(double u0, double u1, double sin2_half) {
    double x, y;
    sample_disk(u0, u1, &x, &y);
    double s = 2.0 * (x * x + y * y) * sin2_half;
    double k = sqrt(2.0 * sin2_half * larger(2.0 - s, 0.0));
    return vec(x * k, y * k, 1.0 - s);
}

static inline Vec sample_sphere(double u0, double u1) {
    double z = 1.0 - 2.0 * u0, rho = sqrt(larger((1.0 - z) * (1.0 + z), 0.0)), phi = 2.0 * PI * u1;
    return vec(rho * cos(phi), rho * sin(phi), z);
}

static inline Vec sample_hemisphere(double u0, double u1) {
    double x, y;
    sample_disk(u0, u1, &x, &y);
    return vec(x, y, sqrt(larger(1.0 - x * x - y * y, 0.0)));
}

static inline void frame_of(Vec axis, Vec *u, Vec *v) {
    double sign = copysign(1.0, axis.z), a = -1.0 / (sign + axis.z), b = axis.x * axis.y * a;
    *u = vec(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x);
    *v = vec(b, sign + axis.y * axis.y * a, -axis.y);
}

static inline Vec to_world(Vec local, Vec axis) {
    Vec u, v;
    frame_of(axis, &u, &v);
    return renormalize(along(along(scale(u, local.x), v, local.y), axis, local.z));
}

/* Which of `count` cells the distribution function reaches u in, and how far into it. */
static inline int locate(const double *cdf, int count, double u, double *inside) {
    /* Without a branch that depends on u: it would be mispredicted every other time. */
    int cell = 0;
    for (int half; (half = count / 2) > 0; count -= half)
        cell = cdf[cell + half] <= u ? cell + half : cell;
    *inside = (u - cdf[cell]) / (cdf[cell + 1] - cdf[cell]);
    return cell;
}

static inline double sample_wavelength(const Scene *scene, const Emitter *emitter, double u) {
    double v;
    int cell = locate(emitter->cdf, emitter->segment_count, u, &v);
    const Segment *segment = scene->segments + emitter->first_segment + cell;
    if (segment->width_nm == 0.0) return segment->wavelength_nm;
    v = smaller(larger(v, 0.0), 1.0);
    double d0 = segment->density_low, d1 = segment->density_high;
    double root = sqrt(larger(d0 * d0 + v * (d1 - d0) * (d1 + d0), 0.0));
    return segment->wavelength_nm + segment->width_nm * v * (d0 + d1) / (d0 + root);
}

static inline double cone_of(const Target *target, Vec to_target) {
    double sin2 = target->radius * target->radius / dot(to_target, to_target);
    return sin2 >= 1.0 ? 1.0 : sin2 / (2.0 * (1.0 + sqrt(1.0 - sin2)));
}

/* Cell, and coordinate in [0, 1) of the side, where a rectangle's distribution reaches u. */
static inline int invert_cells(const double *cdf, double u, double *s) {
    double inside;
    int cell = locate(cdf, AIM_CELLS, u, &inside);
    *s = (cell + inside) * (1.0 / AIM_CELLS);
    return cell;
}

static inline int cell_of(double s) {
    int cell = (int)(s * AIM_CELLS);
    return cell < 0 ? 0 : cell > AIM_CELLS - 1 ? AIM_CELLS - 1 : cell;
}

/* Density of the rectangle's points at (s, t) of the unit square, relative to a uniform one. */
static inline double cell_density(const double *cdf, double s, double t) {
    int i = cell_of(s), j = cell_of(t);
    const double *row = cdf + (i + 1) * (AIM_CELLS + 1);
    return (cdf[i + 1] - cdf[i]) * (row[j + 1] - row[j]) * (AIM_CELLS * AIM_CELLS);
}

/* The point of the unit square where a distribution over its cells reaches (u0, u1). */
static inline void invert_square(const double *cdf, double *u0, double *u1) {
    int row = invert_cells(cdf, *u0, u0);
    invert_cells(cdf + (row + 1) * (AIM_CELLS + 1), *u1, u1);
}

static inline double area_density(
    const Emitter *emitter, const Target *target, Vec origin, Vec direction, int drawn
) {
    double approach = dot(direction, target->normal);
    if (approach == 0.0) return 0.0;
    Vec offset = sub(target->centre, origin);
    double t = dot(offset, target->normal) / approach;
    if (t <= 0.0) return 0.0;
    Vec local = sub(scale(direction, t), offset);
    double x = dot(local, target->u), y = dot(local, target->v);
    if (!drawn && (fabs(x) > target->half_u || fabs(y) > target->half_v)) return 0.0;
    double density = t * t / (4.0 * target->half_u * target->half_v * fabs(approach));
    density *= cell_density(target->cdf, 0.5 + 0.5 * x / target->half_u,
                            0.5 + 0.5 * y / target->half_v);
    if (emitter->kind == SPHERE_LAMP) {
        Vec outward = sub(origin, emitter->centre);
        Vec way = along(outward, direction, t);
        density *= larger(dot(outward, way), 0.0) / (dot(outward, direction) * sqrt(dot(way, way)));
    }
    return density;
}

static inline double own_density(const Emitter *emitter, Vec direction) {
    if (emitter->kind == RECTANGLE_LAMP) return larger(dot(direction, emitter->axis), 0.0) / PI;
    return 0.25 / PI;
}

static inline double target_density(
    const Emitter *emitter, const Target *target, Vec origin, Vec direction, int drawn
) {
    if (target->kind == AIM_AREA) return area_density(emitter, target, origin, direction, drawn);
    if (target->kind == AIM_BASE) return own_density(emitter, direction);
    Vec way = sub(target->centre, emitter->kind == SPHERE_LAMP ? emitter->centre : origin);
    double factor = 1.0;
    if (target->pivot > 0.0) {
        Vec offset = sub(origin, emitter->centre), line = direction;
        double b = dot(offset, line), c = target->pivot * target->pivot - dot(offset, offset);
        double sine = emitter->radius / target->pivot;
        direction = scale(along(offset, line, sqrt(b * b + c) - b), 1.0 / target->pivot);
        factor = (1.0 + sqrt(1.0 - sine * sine)) / (2.0 * dot(direction, line));
    }
    double sin2_half = cone_of(target, way), density = factor / (4.0 * PI * sin2_half), s, t;
    Vec axis = sin2_half < 1.0 ? normalize(way) : vec(0.0, 0.0, 1.0), u, v;
    if (sin2_half < 1.0 && !drawn) {
        Vec chord = sub(direction, axis);
        if (dot(chord, chord) > 4.0 * sin2_half) return 0.0;
    }
    if (!target->cdf) return density;
    frame_of(axis, &u, &v);
    double k = 1.0 / sqrt(larger(2.0 * sin2_half * (1.0 + dot(direction, axis)), 1e-30));
    disk_square(dot(direction, u) * k, dot(direction, v) * k, &s, &t);
    return density * cell_density(target->cdf, s, t);
}

static inline Vec sample_direction(
    const Emitter *emitter, const Target *target, Vec origin, double u0, double u1
) {
    if (target->kind == AIM_CONE) {
        Vec way = sub(target->centre, origin);
        double sin2_half = cone_of(target, way);
        Vec local = sample_cone(u0, u1, sin2_half);
        return sin2_half >= 1.0 ? local : to_world(local, normalize(way));
    }
    if (emitter->kind == RECTANGLE_LAMP) return to_world(sample_hemisphere(u0, u1), emitter->axis);
    return sample_sphere(u0, u1);
}

static inline Vec on_rectangle(Vec centre, Vec u, Vec v, double half_u, double half_v,
                               double u0, double u1) {
    return along(along(centre, u, (2.0 * u0 - 1.0) * half_u), v, (2.0 * u1 - 1.0) * half_v);
}

static inline Vec on_sphere(const Emitter *emitter, Vec way, double u0, double u1) {
    return along(emitter->centre, to_world(sample_hemisphere(u0, u1), way), emitter->radius);
}

static inline void sample_line(
    const Emitter *emitter, const Target *target, const double u[DIMENSIONS], Ray *ray
) {
    int sphere = emitter->kind == SPHERE_LAMP;
    Vec origin = emitter->centre;
    if (!sphere)
        origin = on_rectangle(origin, emitter->u, emitter->v, emitter->half_u, emitter->half_v,
                              u[3], u[4]);
    if (target->kind == AIM_AREA) {
        Vec point = on_rectangle(target->centre, target->u, target->v, target->half_u,
                                 target->half_v, u[0], u[1]);
        if (sphere)
            origin = on_sphere(emitter, normalize(sub(point, emitter->centre)), u[3], u[4]);
        ray->direction = normalize(sub(point, origin));
    } else {
        ray->direction = sample_direction(emitter, target, origin, u[0], u[1]);
        if (target->pivot > 0.0) {
            Vec way = ray->direction;
            double sine = emitter->radius / target->pivot, sin2 = sine * sine;
            Vec local = sample_cone(u[3], u[4], sin2 / (2.0 * (1.0 + sqrt(1.0 - sin2))));
            double depth = sqrt(larger(sin2 - local.x * local.x - local.y * local.y, 0.0));
            ray->direction = to_world(local, way);
            origin = along(emitter->centre, along(way, ray->direction, depth - local.z),
                           target->pivot);
        } else if (sphere) origin = on_sphere(emitter, ray->direction, u[3], u[4]);
    }
    ray->origin = origin;
}

/* Photon `i` of a stream: its ray, and the number that stands for its wavelength; returns its flux. */
static inline double emit(const Scene *scene, const Stream *stream, uint32_t i, Ray *ray, double *u_wavelength) {
    const Emitter *emitter = scene->emitters + stream->emitter;
    const Target *target = scene->targets + stream->target;
    uint64_t low = hash64(stream->key, 2 * (uint64_t)i), low2 = hash64(stream->key, 2 * (uint64_t)i + 1);
    const uint64_t low_bits[DIMENSIONS] = {low, low >> 21, low >> 42, low2, low2 >> 21};
    double u[DIMENSIONS];
    for (int d = 0; d < DIMENSIONS; d++)
        u[d] = sobol_uniform(scene->sobol + d * SOBOL_ROW, i, stream->seeds[d], low_bits[d]);

    if (target->cdf) invert_square(target->cdf, &u[0], &u[1]);
    ray->prim = ray->face = -1;
    *u_wavelength = u[2];
    if (emitter->kind == BEAM) {
        double x = 2.0 * u[0] - 1.0, y = 2.0 * u[1] - 1.0;
        if (emitter->round) sample_disk(u[0], u[1], &x, &y);
        ray->origin = along(along(emitter->centre, emitter->u, x * emitter->half_u), emitter->v,
                            y * emitter->half_v);
        ray->direction = to_world(sample_cone(u[3], u[4], emitter->sin2_half), emitter->axis);
        return emitter->flux / target->photons
             / (target->cdf ? cell_density(target->cdf, u[0], u[1]) : 1.0);
    }
    sample_line(emitter, target, u, ray);
    if (emitter->kind == SPHERE_LAMP && dot(sub(ray->origin, emitter->centre), ray->direction) <= 0.0)
        return 0.0;
    double own = own_density(emitter, ray->direction);
    if (own <= 0.0) return 0.0;
    double density = 0.0;
    for (int k = emitter->first_target; k < emitter->first_target + emitter->target_count; k++) {
        const Target *other = scene->targets + k;
        density += other->photons
                 * target_density(emitter, other, ray->origin, ray->direction, k == stream->target);
    }
    return emitter->flux * own / density;
}

/* ---------------------------------------------------------------- geometry */

static inline double intersect_sphere(Vec origin, Vec direction, double radius, int leaving) {
    double b = -dot(origin, direction);
    if (leaving) return b > 0.0 ? 2.0 * b : -1.0;
    Vec closest = along(origin, direction, b);
    double discriminant = radius * radius - dot(closest, closest);
    if (discriminant < 0.0) return -1.0;
    double half_chord = sqrt(discriminant);
    double t = b - half_chord;
    return t >= 0.0 ? t : b + half_chord;
}

static inline double intersect_polyhedron(
    const Plane *planes, int first, int count, Vec origin, Vec direction, int leaving_face, int *face
) {
    double t_enter = -INFINITY, t_exit = INFINITY;
    int enter = -1, leave = -1, leaves = leaving_face >= first && leaving_face < first + count;
    for (int k = first; k < first + count; k++) {
        double approach = dot(planes[k].normal, direction);
        if (k == leaving_face) {
            if (approach >= 0.0) return -1.0;
            continue;
        }
        double distance = planes[k].offset - dot(planes[k].normal, origin);
        if (approach < 0.0) {
            double t = distance / approach;
            if (t > t_enter) { t_enter = t; enter = k; }
        } else if (approach > 0.0) {
            double t = distance / approach;
            if (t < t_exit) { t_exit = t; leave = k; }
        } else if (distance < 0.0 && !leaves) {
            return -1.0;
        }
    }
    if (leaves) {
        *face = leave;
        return leave < 0 ? -1.0 : larger(t_exit, 0.0);
    }
    if (t_enter > t_exit || t_exit < 0.0) return -1.0;
    *face = t_enter >= 0.0 ? enter : leave;
    return t_enter >= 0.0 ? t_enter : t_exit;
}

static inline int intersect(const Scene *scene, const Ray *ray, Hit *hit) {
    const Sphere *sphere_hit = NULL;
    hit->t = INFINITY;
    hit->prim = -1;
    hit->face = 0;
    for (int i = 0; i < scene->sphere_count; i++) {
        const Sphere *sphere = scene->spheres + i;
        double t = intersect_sphere(sub(ray->origin, sphere->centre), ray->direction,
                                    sphere->radius, ray->prim == sphere->prim);
        if (t >= 0.0 && t < hit->t) {
            hit->t = t;
            hit->prim = sphere->prim;
            sphere_hit = sphere;
        }
    }
    for (int i = 0; i < scene->flat_count; i++) {
        const Flat *flat = scene->flats + i;
        if (ray->prim == flat->prim) continue;
        double approach = dot(ray->direction, flat->normal);
        if (approach == 0.0) continue;
        Vec local = sub(ray->origin, flat->centre);
        double t = -dot(local, flat->normal) / approach;
        if (!(t >= 0.0 && t < hit->t)) continue;
        local = along(local, ray->direction, t);
        double u = dot(local, flat->u), v = dot(local, flat->v);
        if (fabs(u) <= flat->half_u && fabs(v) <= flat->half_v && u * u + v * v <= flat->radius2) {
            hit->t = t;
            hit->prim = flat->prim;
            hit->normal = flat->normal;
            sphere_hit = NULL;
        }
    }
    for (int i = 0; i < scene->polyhedron_count; i++) {
        const Polyhedron *body = scene->polyhedra + i;
        int face = -1, leaving_face = ray->prim == body->prim ? ray->face : -1;
        double t = intersect_polyhedron(scene->planes, body->first, body->count,
                                        sub(ray->origin, body->centre), ray->direction,
                                        leaving_face, &face);
        if (t >= 0.0 && t < hit->t) {
            hit->t = t;
            hit->prim = body->prim;
            hit->face = face;
            hit->normal = scene->planes[face].normal;
            sphere_hit = NULL;
        }
    }
    if (sphere_hit) {
        Vec local = along(sub(ray->origin, sphere_hit->centre), ray->direction, hit->t);
        hit->normal = renormalize(scale(local, 1.0 / sphere_hit->radius));
    }
    return hit->prim >= 0;
}

/* ---------------------------------------------------------------- optics */

static inline void media_indices(const Scene *scene, double wavelength_nm, double *n) {
    double lambda2 = wavelength_nm * wavelength_nm * 1e-6;
    for (int m = 0; m < scene->media_count; m++) {
        const double *c = scene->media[m].c;
        if (scene->media[m].formula == SELLMEIER) {
            double n2 = 1.0;
            for (int k = 0; k < 8 && c[k] != 0.0; k += 2) n2 += c[k] * lambda2 / (lambda2 - c[k + 1]);
            n[m] = sqrt(n2);
        } else {
            double x = 1.0 / lambda2;
            n[m] = c[0] + x * (c[1] + x * (c[2] + x * c[3]));
        }
    }
}

/* Reflectance, mean of s and p; 1 where the reflection is total, and then no refracted ray. */
static inline double cross_boundary(Vec d, Vec normal, double eta, Vec *reflected, Vec *refracted) {
    double cos_i = smaller(-dot(d, normal), 1.0);
    *reflected = renormalize(along(d, normal, 2.0 * cos_i));
    if (eta == 1.0) {
        *refracted = d;
        return 0.0;
    }
    double sin2_t = eta * eta * (1.0 - cos_i) * (1.0 + cos_i);
    if (sin2_t >= 1.0) {
        *refracted = *reflected;
        return 1.0;
    }
    double cos_t = sqrt(1.0 - sin2_t);
    *refracted = renormalize(along(scale(d, eta), normal, eta * cos_i - cos_t));
    if (cos_i <= 0.0) return 1.0;
    double s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    double p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    return 0.5 * (s * s + p * p);
}

/* ---------------------------------------------------------------- tracing */

static inline int32_t add_refraction(int32_t history) {
    return (history & 1023) == 1023 ? history : history + 1;
}
static inline int32_t add_reflection(int32_t history) {
    return ((history >> 10) & 1023) == 1023 ? history : history + 1024;
}

static inline void store(Photons *photons, Vec point, Vec direction, double wavelength_nm,
                         double flux, int32_t surface, int32_t history, int32_t emitter) {
    size_t slot = photons->count++;
    if (slot >= photons->room) return; /* counted: the caller sees that there was no room */
    photons->position[slot] = point;
    photons->direction[slot][0] = (float)direction.x;
    photons->direction[slot][1] = (float)direction.y;
    photons->direction[slot][2] = (float)direction.z;
    photons->wavelength_nm[slot] = (float)wavelength_nm;
    photons->flux[slot] = flux;
    photons->surface[slot] = surface;
    photons->history[slot] = history;
    photons->emitter[slot] = emitter;
}

/* The number in [0, 1) that decides at interaction `step` of a photon; `purpose` 1: side branch. */
static inline double roulette(const Stream *stream, int purpose, uint64_t draws, int step) {
    uint64_t bits = hash64(stream->key + (uint64_t)purpose, draws + (uint64_t)step);
    return (double)(bits >> 11) * 0x1p-53;
}

/* A photon of one wavelength, about to meet `hit`, and all its branches. */
static void follow(const Scene *scene, const Stream *stream, Ray ray, Hit hit, double wavelength_nm,
                   double flux, uint64_t draws, Photons *photons, Books *books) {
    struct { Ray ray; double flux; int32_t history; } stack[STACK_SIZE];
    double indices[MAX_MEDIA];
    media_indices(scene, wavelength_nm, indices);
    const double threshold = flux * scene->branch_threshold;
    int32_t history = 0;
    int depth = 0;
    for (int step = 0; step < scene->max_interactions; step++) {
        int material = ABSORBER;
        if (step > 0) intersect(scene, &ray, &hit);
        if (hit.prim < 0) {
            books->escaped += flux;
        } else {
            const Body *body = scene->bodies + hit.prim;
            material = body->material;
            int side = dot(ray.direction, hit.normal) > 0.0;
            Vec point = along(ray.origin, ray.direction, hit.t);
            if (material == LAMBERTIAN) {
                books->deposited += flux;
                if (scene->store_direct || (history & 0xFFFFF) > 0)
                    store(photons, point, ray.direction, wavelength_nm, flux,
                          hit.prim << 14 | hit.face << 1 | side, history, stream->emitter);
            } else if (material == ABSORBER) {
                books->absorbed += flux;
            } else {
                Vec normal = side ? scale(hit.normal, -1.0) : hit.normal, reflected, refracted;
                double eta = side ? indices[body->inside] / indices[0]
                                  : indices[0] / indices[body->inside];
                double r = cross_boundary(ray.direction, normal, eta, &reflected, &refracted);
                double side_flux = flux * r;
                history |= body->dispersive << 30;
                int32_t side_history = add_reflection(history);
                Vec side_direction = reflected;
                flux -= side_flux;
                ray.direction = refracted;
                history = add_refraction(history);
                if (flux < side_flux) {
                    double f = flux; flux = side_flux; side_flux = f;
                    int32_t h = history; history = side_history; side_history = h;
                    side_direction = refracted;
                    ray.direction = reflected;
                }
                ray.origin = point;
                ray.prim = hit.prim;
                ray.face = hit.face;
                if (depth == STACK_SIZE) {
                    if (roulette(stream, 1, draws, step) * (flux + side_flux) < side_flux) {
                        ray.direction = side_direction;
                        history = side_history;
                    }
                    flux += side_flux;
                } else if (side_flux > 0.0) {
                    double kept = side_flux;
                    if (side_flux < threshold)
                        kept = roulette(stream, 1, draws, step) * threshold < side_flux ? threshold : 0.0;
                    books->culled += side_flux - kept;
                    if (kept > 0.0) {
                        stack[depth].ray = (Ray){point, side_direction, hit.prim, hit.face};
                        stack[depth].flux = kept;
                        stack[depth].history = side_history;
                        depth++;
                    }
                }
                if (flux >= threshold) continue;
                books->culled += flux;
                if (roulette(stream, 2, draws, step) * threshold < flux) {
                    flux = threshold;
                    books->culled -= threshold;
                    continue;
                }
            }
        }
        if (depth == 0) return;
        depth--;
        ray = stack[depth].ray;
        flux = stack[depth].flux;
        history = stack[depth].history;
    }
    books->culled += flux;
    while (depth > 0) books->culled += stack[--depth].flux;
}

/* Photon `i` of a stream, in several colours if what it meets first is dispersive. */
static void trace_photon(const Scene *scene, const Stream *stream, uint32_t i, Photons *photons, Books *books) {
    Ray ray;
    double u;
    double flux = emit(scene, stream, i, &ray, &u);
    books->emitted += flux;
    if (!(flux > 0.0)) return;
    Hit first = {0};
    int colours = intersect(scene, &ray, &first) && scene->bodies[first.prim].dispersive ? scene->colours : 1;
    flux /= colours;
    for (int colour = 0; colour < colours; colour++) {
        double v = u + (double)colour / colours;
        double wavelength_nm = sample_wavelength(scene, scene->emitters + stream->emitter, v - floor(v));
        follow(scene, stream, ray, first, wavelength_nm, flux,
               ((uint64_t)i << 24) + ((uint64_t)colour << 17), photons, books);
    }
}

/* ---------------------------------------------------------------- input and timing */

static void *allocate(size_t count, size_t size) {
    void *memory = malloc(count * size + 1);
    if (!memory) { fprintf(stderr, "photon_tracer: out of memory\n"); exit(1); }
    return memory;
}

/* Input: sections of two int64 (rows, columns) and rows × columns float64, in a fixed order. */
static double *read_section(FILE *file, int columns, int *rows) {
    int64_t shape[2];
    if (fread(shape, sizeof shape, 1, file) != 1 || shape[1] != columns) goto bad;
    double *values = allocate((size_t)(shape[0] * columns), sizeof *values);
    if (fread(values, sizeof *values * (size_t)columns, (size_t)shape[0], file) != (size_t)shape[0]) goto bad;
    *rows = (int)shape[0];
    return values;
bad:
    fprintf(stderr, "photon_tracer: input: a section of %d columns expected\n", columns);
    exit(1);
}

static Vec take_vec(const double **p) { Vec v = vec((*p)[0], (*p)[1], (*p)[2]); *p += 3; return v; }
static double take(const double **p) { return *(*p)++; }
static int take_int(const double **p) { return (int)take(p); }

#define READ(ARRAY, COUNT, COLUMNS, ...)                                    \
    do {                                                                    \
        double *values = read_section(file, COLUMNS, &scene->COUNT);        \
        const double *p = values;                                           \
        scene->ARRAY = allocate((size_t)scene->COUNT, sizeof *scene->ARRAY);\
        for (int i = 0; i < scene->COUNT; i++) {                            \
            __typeof__(scene->ARRAY) a = scene->ARRAY + i;                  \
            __VA_ARGS__                                                     \
        }                                                                   \
        free(values);                                                       \
    } while (0)

static void read_scene(const char *path, Scene *scene) {
    FILE *file = fopen(path, "rb");
    if (!file) { perror(path); exit(1); }
    READ(spheres, sphere_count, 5,
         a->centre = take_vec(&p); a->radius = take(&p); a->prim = take_int(&p););
    READ(flats, flat_count, 16,
         a->centre = take_vec(&p); a->u = take_vec(&p); a->v = take_vec(&p); a->normal = take_vec(&p);
         a->half_u = take(&p); a->half_v = take(&p); a->radius2 = take(&p); a->prim = take_int(&p););
    READ(planes, plane_count, 4, a->normal = take_vec(&p); a->offset = take(&p););
    READ(polyhedra, polyhedron_count, 6,
         a->centre = take_vec(&p); a->first = take_int(&p); a->count = take_int(&p);
         a->prim = take_int(&p););
    READ(bodies, body_count, 3,
         a->material = take_int(&p); a->inside = take_int(&p);
         a->dispersive = take_int(&p););
    READ(media, media_count, 9,
         a->formula = take_int(&p); for (int k = 0; k < 8; k++) a->c[k] = take(&p););
    READ(cdf, cdf_count, 1, *a = take(&p););
    READ(emitters, emitter_count, 24,
         a->kind = take_int(&p); a->round = take_int(&p); a->centre = take_vec(&p);
         a->u = take_vec(&p); a->v = take_vec(&p); a->axis = take_vec(&p);
         a->half_u = take(&p); a->half_v = take(&p); a->radius = take(&p); a->sin2_half = take(&p);
         a->flux = take(&p); a->first_target = take_int(&p); a->target_count = take_int(&p);
         a->first_segment = take_int(&p); a->segment_count = take_int(&p);
         a->cdf = scene->cdf + take_int(&p););
    READ(targets, target_count, 19,
         a->kind = take_int(&p); a->centre = take_vec(&p); a->u = take_vec(&p); a->v = take_vec(&p);
         a->normal = take_vec(&p); a->half_u = take(&p); a->half_v = take(&p); a->radius = take(&p);
         a->pivot = take(&p);
         int first_cdf = take_int(&p); a->cdf = first_cdf < 0 ? NULL : scene->cdf + first_cdf;
         a->photons = take(&p););
    READ(segments, segment_count, 4,
         a->wavelength_nm = take(&p); a->width_nm = take(&p); a->density_low = take(&p);
         a->density_high = take(&p););
    READ(streams, stream_count, 5 + DIMENSIONS,
         a->emitter = take_int(&p); a->target = take_int(&p); a->photons = (uint32_t)take(&p);
         a->key = (uint64_t)take(&p) << 32; a->key |= (uint64_t)take(&p);
         for (int d = 0; d < DIMENSIONS; d++) a->seeds[d] = (uint32_t)take(&p););
    int rows;
    double *sobol = read_section(file, DIMENSIONS * SOBOL_ROW, &rows);
    for (int k = 0; k < DIMENSIONS * SOBOL_ROW; k++) scene->sobol[k] = (uint32_t)sobol[k];
    free(sobol);
    double *limits = read_section(file, 5, &rows);
    scene->max_interactions = (int)limits[0];
    scene->branch_threshold = limits[1];
    scene->slots_per_photon = (int)limits[2];
    scene->colours = (int)limits[3];
    scene->store_direct = (int)limits[4];
    free(limits);
    fclose(file);
    if (scene->media_count > MAX_MEDIA) { fprintf(stderr, "photon_tracer: too many media\n"); exit(1); }
}

static double cpu_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int argc, char **argv) {
    static Scene scene;
    if (argc != 3) { fprintf(stderr, "usage: %s INPUT RUNS\n", argv[0]); return 2; }
    read_scene(argv[1], &scene);
    size_t room = 0;
    for (int s = 0; s < scene.stream_count; s++)
        room += (size_t)scene.streams[s].photons * (size_t)scene.slots_per_photon;
    for (int run = 0; run < atoi(argv[2]); run++) {
        double start = cpu_seconds();
        Books books = {0};
        Photons photons = {
            allocate(room, sizeof(Vec)), allocate(room, 3 * sizeof(float)),
            allocate(room, sizeof(float)), allocate(room, sizeof(double)),
            allocate(room, sizeof(int32_t)), allocate(room, sizeof(int32_t)),
            allocate(room, sizeof(int32_t)), 0, room,
        };
        for (int s = 0; s < scene.stream_count; s++)
            for (uint32_t i = 0; i < scene.streams[s].photons; i++)
                trace_photon(&scene, scene.streams + s, i, &photons, &books);
        double spent = cpu_seconds() - start;
        if (photons.count > room) { fprintf(stderr, "photon_tracer: no room\n"); return 1; }
        double flux = 0.0;
        for (size_t k = 0; k < photons.count; k++) flux += photons.flux[k];
        printf("%.9f %zu %.17g %.17g %.17g %.17g %.17g %.17g\n", spent, photons.count, flux,
               books.emitted, books.deposited, books.absorbed, books.escaped, books.culled);
        free(photons.position); free(photons.direction); free(photons.wavelength_nm);
        free(photons.flux); free(photons.surface); free(photons.history); free(photons.emitter);
    }
    return 0;
}
