/* SPDX-License-Identifier: MIT */
/* Accuracy of surface nets: balls, rods, planes and sheets at random places. */
#include "tests/bench/bench.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/net.h"
#include "tests/bench/times.h"

enum { SIDE = 48, BALLS = 24, DIRECTIONS = 20, FAR = 14, RAYS = 400 };

/* ---- objects ---- */

struct object {
    double middle[3], along[3]; /* the axis of a rod, the normal of a plane */
    double size;                /* radius, or thickness of a sheet */
    bool (*is_in)(const struct object *object, const double from_middle[3]);
    int32_t side;
    uint8_t *voxel; /* [side][side][side] */
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

enum { SEED = 88172645 };
static uint64_t state;
static double by_chance(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) / 9007199254740992.0;
}

static bool in_ball(const struct object *o, const double p[3])
{
    return dot(p, p) < o->size * o->size;
}

static bool in_rod(const struct object *o, const double p[3])
{
    const double s = dot(p, o->along);
    return dot(p, p) - s * s < o->size * o->size;
}

static bool below_plane(const struct object *o, const double p[3])
{
    return dot(p, o->along) < 0;
}

static bool in_sheet(const struct object *o, const double p[3])
{
    return fabs(dot(p, o->along)) < o->size / 2;
}

/* As thick as its voxels need to hang together by faces. */
static bool in_plate(const struct object *o, const double p[3])
{
    const double d = dot(p, o->along);
    const double most = fabs(o->along[0]) + fabs(o->along[1]) + fabs(o->along[2]);
    return d >= -most / 2 && d < most / 2;
}

static void turn_by_chance(struct object *o)
{
    double length;
    do {
        for (int k = 0; k < 3; k++)
            o->along[k] = 2 * by_chance() - 1;
        length = sqrt(dot(o->along, o->along));
    } while (length > 1 || length < 0.1);
    for (int k = 0; k < 3; k++)
        o->along[k] /= length;
}

/* Fills the voxels, two at the sides left empty; how many are of the object. */
static long fill(struct object *o)
{
    long count = 0;
    uint8_t *voxel = o->voxel;
    for (int k = 0; k < 3; k++)
        o->middle[k] = o->side / 2 + by_chance();
    for (int32_t z = 0; z < o->side; z++)
        for (int32_t y = 0; y < o->side; y++)
            for (int32_t x = 0; x < o->side; x++, voxel++) {
                const double p[3] = {x - o->middle[0], y - o->middle[1], z - o->middle[2]};
                const bool edge = x < 2 || y < 2 || z < 2 || x >= o->side - 2 || y >= o->side - 2 ||
                                  z >= o->side - 2;
                *voxel = !edge && o->is_in(o, p);
                count += *voxel;
            }
    return count;
}

static void object_row(void *context, int32_t x, int32_t y, int32_t z, uint32_t count,
                       uint16_t *voxel)
{
    const struct object *o = context;
    for (uint32_t k = 0; k < count; k++, x++) {
        const bool inside = x >= 0 && y >= 0 && z >= 0 && x < o->side && y < o->side && z < o->side;
        voxel[k] =
            inside
                ? o->voxel[((size_t)z * (size_t)o->side + (size_t)y) * (size_t)o->side + (size_t)x]
                : NET_CLOSED;
    }
}

/* ---- meshes ---- */

struct figure_mesh {
    double (*at)[3], (*normal)[3]; /* points, in voxels; normals outward, of length 1 */
    uint32_t (*triangle)[3];       /* counter-clockwise seen from outside */
    uint32_t points, triangles;
};

static struct figure_mesh mesh_of_net(const struct object *o)
{
    OWNED(net_release) struct net net = {0};
    const struct net_source source = {
        .row = object_row, .context = (void *)(uintptr_t)o, .scale = {4096, 4096, 4096}};
    const uint32_t size[3] = {(uint32_t)o->side, (uint32_t)o->side, (uint32_t)o->side};
    must(net_make(&net, &source, (const int32_t[]){0, 0, 0}, size, &bench_fault));
    struct figure_mesh m = {.at = must_have((net.vertices + 1) * sizeof *m.at),
                            .normal = must_have((net.vertices + 1) * sizeof *m.normal),
                            .triangle = must_have((2 * net.quads + 1) * sizeof *m.triangle),
                            .points = net.vertices,
                            .triangles = 2 * net.quads};
    for (uint32_t v = 0; v < net.vertices; v++)
        for (int k = 0; k < 3; k++) {
            m.at[v][k] = net.vertex[v].cube[k] + net.vertex[v].at[k] / (double)NET_ONE;
            m.normal[v][k] = net.vertex[v].normal[k] / (double)(1 << NET_NORMAL_BITS);
        }
    for (uint32_t q = 0; q < net.quads; q++) {
        const uint32_t *c = net.quad[q].corner;
        double d[2] = {0, 0};
        for (int k = 0; k < 3; k++) {
            d[0] += pow(m.at[c[0]][k] - m.at[c[2]][k], 2);
            d[1] += pow(m.at[c[1]][k] - m.at[c[3]][k], 2);
        }
        const int s = d[1] < d[0];
        memcpy(m.triangle[2 * q], (uint32_t[]){c[s], c[s + 1], c[s + 2]}, sizeof *m.triangle);
        memcpy(m.triangle[2 * q + 1], (uint32_t[]){c[s], c[s + 2], c[(s + 3) % 4]},
               sizeof *m.triangle);
    }
    return m;
}

static void figure_mesh_release(struct figure_mesh *mesh)
{
    free(mesh->at);
    free(mesh->normal);
    free(mesh->triangle);
}

/* ---- figures ---- */

static double volume_of(const struct figure_mesh *m)
{
    double sum = 0, c[3];
    for (uint32_t t = 0; t < m->triangles; t++) {
        const uint32_t *v = m->triangle[t];
        cross(m->at[v[1]], m->at[v[2]], c);
        sum += dot(m->at[v[0]], c) / 6;
    }
    return sum;
}

/* The radius of a disc as large as what the mesh covers, seen along an axis. */
static double silhouette_of(const struct figure_mesh *m, int axis)
{
    enum { PIXELS = 32 };
    const int u = (axis + 1) % 3, w = (axis + 2) % 3, side = SIDE * PIXELS;
    OWNED(mem_release) uint8_t *is_covered = must_have((size_t)side * (size_t)side);
    long count = 0;
    for (uint32_t t = 0; t < m->triangles; t++) {
        double p[3][2], low[2] = {side, side}, high[2] = {0, 0};
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 2; i++) {
                p[k][i] = (m->at[m->triangle[t][k]][i ? w : u] + 2) * PIXELS;
                low[i] = fmin(low[i], p[k][i]);
                high[i] = fmax(high[i], p[k][i]);
            }
        for (int y = (int)ceil(low[1]); y <= high[1]; y++)
            for (int x = (int)ceil(low[0]); x <= high[0]; x++) {
                int left = 0, right = 0;
                for (int k = 0; k < 3; k++) {
                    const double *a = p[k], *b = p[(k + 1) % 3];
                    const double side_of = (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
                    left += side_of >= 0;
                    right += side_of <= 0;
                }
                if (left == 3 || right == 3)
                    is_covered[(size_t)y * (size_t)side + (size_t)x] = 1;
            }
    }
    for (int i = 0; i < side * side; i++)
        count += is_covered[i];
    return sqrt((double)count / 3.14159265358979) / PIXELS;
}

/* The radius of a rod that holds as much as the mesh does, by a window along the middle of it. */
static double rod_radius_of(const struct figure_mesh *m, const struct object *o)
{
    const double half = SIDE / 2 - FAR + 2;
    double sum = 0;
    for (uint32_t t = 0; t < m->triangles; t++) {
        const uint32_t *v = m->triangle[t];
        double e[3], g[3], area[3], p[3];
        for (int k = 0; k < 3; k++) {
            e[k] = m->at[v[1]][k] - m->at[v[0]][k];
            g[k] = m->at[v[2]][k] - m->at[v[0]][k];
            p[k] = (m->at[v[0]][k] + m->at[v[1]][k] + m->at[v[2]][k]) / 3 - o->middle[k];
        }
        const double s = dot(p, o->along);
        if (fabs(s) >= half)
            continue;
        cross(e, g, area);
        for (int k = 0; k < 3; k++)
            p[k] -= s * o->along[k];
        sum += dot(p, area) / 4 * (1 + cos(3.14159265358979 * s / half)) / 2;
    }
    return sqrt(fmax(0, sum) / half / 3.14159265358979);
}

static struct {
    double *value;
    size_t count, room;
} angles;

static void add_angle(const double normal[3], const double truth[3])
{
    const double c = dot(normal, truth) / sqrt(dot(truth, truth) * dot(normal, normal) + 1e-30);
    if (mem_grow(&angles.value, &angles.room, angles.count + 1, sizeof *angles.value))
        angles.value[angles.count++] = acos(fmax(-1, fmin(1, c))) * 180 / 3.14159265358979;
}

static double angle_at(double part)
{
    return times_quantile(angles.value, angles.count, part);
}

/* ---- the table ---- */

static void measure_balls(double radius)
{
    double by_volume = 0, seen = 0, ratio = 0, worst = 0;
    struct object o = {.size = radius, .is_in = in_ball, .side = (int32_t)(2 * radius + 14)};
    o.voxel = must_have((size_t)o.side * (size_t)o.side * (size_t)o.side);
    angles.count = 0;
    state = SEED;
    for (int i = 0; i < BALLS; i++) {
        long count;
        while ((count = fill(&o)) == 0)
            ;
        OWNED(figure_mesh_release) struct figure_mesh m = mesh_of_net(&o);
        const double volume = volume_of(&m), off = volume / (double)count - 1;
        by_volume += cbrt(volume * 3 / 4 / 3.14159265358979) / BALLS;
        seen += silhouette_of(&m, i % 3) / BALLS;
        ratio += volume / (double)count / BALLS;
        worst = fabs(off) > fabs(worst) ? off : worst;
        for (uint32_t v = 0; v < m.points; v++) {
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] = m.at[v][k] - o.middle[k];
            add_angle(m.normal[v], p);
        }
    }
    printf("ball %5.2f: radius by volume %6.3f, seen %6.3f; volume/voxels %.4f, worst %+.4f; "
           "normals %4.1f %4.1f\n",
           radius, by_volume, seen, ratio, worst, angle_at(0.5), angle_at(0.95));
    free(o.voxel);
}

static void measure_rods(double radius)
{
    double mean = 0, least_one = 1e9, most_one = 0;
    struct object o = {.size = radius, .is_in = in_rod, .side = SIDE};
    o.voxel = must_have((size_t)SIDE * SIDE * SIDE);
    state = SEED;
    for (int i = 0; i < BALLS; i++) {
        turn_by_chance(&o);
        fill(&o);
        OWNED(figure_mesh_release) struct figure_mesh m = mesh_of_net(&o);
        const double r = rod_radius_of(&m, &o);
        mean += r / BALLS;
        least_one = fmin(least_one, r);
        most_one = fmax(most_one, r);
    }
    printf("rod  %5.2f: radius by volume %6.3f (%.3f to %.3f)\n", radius, mean, least_one,
           most_one);
    free(o.voxel);
}

/* Planes; sheets from both sides, whose voxels are thick enough to hang together by faces or not;
 * how many rays across one see the inside of the mesh first. */
static void measure_sheets(const char *name, double thickness,
                           bool (*is_in)(const struct object *, const double[3]))
{
    double square = 0, mean = 0, thick = 0, is = 0;
    long count = 0;
    struct object o = {.size = thickness, .is_in = is_in, .side = SIDE};
    o.voxel = must_have((size_t)SIDE * SIDE * SIDE);
    state = SEED;
    angles.count = 0;
    for (int i = 0; i < DIRECTIONS; i++) {
        turn_by_chance(&o);
        fill(&o);
        OWNED(figure_mesh_release) struct figure_mesh m = mesh_of_net(&o);
        const double most = fabs(o.along[0]) + fabs(o.along[1]) + fabs(o.along[2]);
        const double half = is_in == in_plate ? most / 2 : is_in == in_sheet ? thickness / 2 : 0;
        double sums[2] = {0}, counts[2] = {0};
        for (uint32_t v = 0; v < m.points; v++) {
            double p[3];
            bool far = false;
            for (int k = 0; k < 3; k++) {
                p[k] = m.at[v][k] - o.middle[k];
                far |= fabs(m.at[v][k] - SIDE / 2) > SIDE / 2 - FAR;
            }
            const double d = dot(p, o.along);
            const bool side = half > 0 ? dot(m.normal[v], o.along) > 0 : true;
            if (far || fabs(d) > half + 3)
                continue;
            const double e = side ? d - half : -d - half;
            const double truth[3] = {side ? o.along[0] : -o.along[0],
                                     side ? o.along[1] : -o.along[1],
                                     side ? o.along[2] : -o.along[2]};
            square += e * e;
            mean += e;
            sums[side] += side ? d : -d;
            counts[side]++;
            count++;
            add_angle(m.normal[v], truth);
        }
        thick += half > 0 ? sums[0] / fmax(1, counts[0]) + sums[1] / fmax(1, counts[1]) : 0;
        is += 2 * half;
    }
    printf("%s: ripple %.4f (mean %+.4f), normals %4.1f %4.1f", name,
           sqrt(square / (double)count - mean * mean / (double)count / (double)count),
           mean / (double)count, angle_at(0.5), angle_at(0.95));
    if (is > 0)
        printf("; thickness %.3f of %.3f", thick / DIRECTIONS, is / DIRECTIONS);
    putchar('\n');
    free(o.voxel);
}

enum err run_surface(const struct options *options, struct fault *fault)
{
    static const double balls[] = {0.8, 1.1, 1.5, 2.37, 3.19, 4.06, 5.09, 10};
    static const double rods[] = {1, 1.47, 2.49, 4};
    (void)options, (void)fault;
    puts("lengths in voxels; normals: median and 95 %, degrees");
    for (size_t k = 0; k < sizeof balls / sizeof *balls; k++)
        measure_balls(balls[k]);
    for (size_t k = 0; k < sizeof rods / sizeof *rods; k++)
        measure_rods(rods[k]);
    measure_sheets("plane  ", 0, below_plane);
    measure_sheets("sheet 1", 1, in_sheet);
    measure_sheets("sheet 2", 2, in_sheet);
    measure_sheets("sheet 3", 3, in_sheet);
    measure_sheets("plate  ", 0, in_plate);
    free(angles.value);
    return OK;
}
