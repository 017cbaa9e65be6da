#include "engine/net.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum {
    SLACK = NET_ONE / 4,           /* how far outside its cube a vertex may lie */
    PUSH_MOST = 15 * NET_ONE / 16, /* and how far it is pushed at most */
    CORNERS = 8,
    LINKS_MOST = 12,
    NATURAL = 8, /* of `lock`: some crossing of the vertex is not with a closed voxel */
};

/* A box of cubes in the making, with its margin. */
struct work {
    int32_t size[3]; /* voxels; cubes are one fewer */
    uint16_t *voxel; /* [z][y][x] */
    int32_t *first;  /* [z][y][x]: the first vertex of the cube, or -1 */
    int32_t vertices, quads;

    int32_t (*cube)[3], (*at)[3]; /* of each vertex: its cube; its place, in 2^-NET_BITS voxels */
    uint8_t *air, *lock;          /* lock: bit a where it stays where it is along axis a */
    int32_t *link_end, *link;     /* its neighbours */
    int32_t (*normal)[3];

    int32_t (*quad)[4];
    uint8_t *face, *natural; /* of each quad */
};

/* ---- topology ---- */

/* Parts of air by the corners of a cube that are air: how many, and the corners of each. */
static uint8_t part[256][5];

static void find_parts(void)
{
    for (int air = 0; air < 256; air++) {
        int left = air, count = 0;
        while (left) {
            int grown = left & -left, before;
            do {
                before = grown;
                for (int c = 0; c < CORNERS; c++)
                    if (grown >> c & 1)
                        grown |= air & (1 << (c ^ 1) | 1 << (c ^ 2) | 1 << (c ^ 4));
            } while (grown != before);
            part[air][1 + count++] = (uint8_t)grown;
            left &= ~grown;
        }
        part[air][0] = (uint8_t)count;
    }
}

static bool is_in(uint16_t voxel)
{
    return voxel != 0 && voxel != NET_CLOSED;
}

static size_t index_of(const struct work *w, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)w->size[1] + (size_t)y) * (size_t)w->size[0] + (size_t)x;
}

/* From a voxel to the next along each axis. */
static void steps_of(const struct work *w, size_t step[3])
{
    step[0] = 1;
    step[1] = (size_t)w->size[0];
    step[2] = step[1] * (size_t)w->size[1];
}

/* The voxel at a corner of a cube. */
static size_t corner_of(size_t cube, int corner, const size_t step[3])
{
    for (int a = 0; a < 3; a++)
        cube += corner >> a & 1 ? step[a] : 0;
    return cube;
}

/* The vertex of the cube whose part has this corner. */
static int32_t vertex_at(const struct work *w, size_t cube, int corner)
{
    int32_t v = w->first[cube];
    while (!(w->air[v] >> corner & 1))
        v++;
    return v;
}

/* Which corners of a cube are not of the object. */
static uint8_t air_of(const struct work *w, size_t cube, const size_t step[3])
{
    uint8_t air = 0;
    for (int c = 0; c < CORNERS; c++) {
        const size_t at = corner_of(cube, c, step);
        air |= (uint8_t)(!is_in(w->voxel[at]) << c);
    }
    return air;
}

/* A vertex at the mean of its crossings; along axes of closed ones on the face. */
static void place(struct work *w, int32_t v, size_t cube, uint8_t air, const size_t step[3])
{
    int32_t sum[3] = {0}, crossings = 0;
    w->lock[v] = 0;
    for (int c = 0; c < CORNERS; c++)
        for (int a = 0; a < 3 && w->air[v] >> c & 1; a++) {
            const int other = c ^ 1 << a;
            const size_t at = corner_of(cube, c, step);
            if (air >> other & 1)
                continue;
            if (w->voxel[at] == NET_CLOSED) {
                w->lock[v] |= (uint8_t)(1 << a);
                continue;
            }
            w->lock[v] |= NATURAL;
            for (int k = 0; k < 3; k++)
                sum[k] += ((c >> k & 1) + (other >> k & 1)) * (NET_ONE / 2);
            crossings++;
        }
    for (int k = 0; k < 3; k++)
        w->at[v][k] = w->cube[v][k] * NET_ONE +
                      (crossings == 0 || (w->lock[v] >> k & 1) ? NET_ONE / 2 : sum[k] / crossings);
}

static void *array(size_t count, size_t size, bool *failed)
{
    void *items = mem_array(count + 1, size);
    *failed |= !items;
    return items;
}

static bool find_vertices(struct work *w)
{
    size_t step[3];
    bool failed = false;
    steps_of(w, step);
    w->first = array(index_of(w, 0, 0, w->size[2]), sizeof *w->first, &failed);
    if (failed)
        return false;
    for (int pass = 0; pass < 2; pass++) {
        int32_t count = 0;
        for (int32_t z = 0; z + 1 < w->size[2]; z++)
            for (int32_t y = 0; y + 1 < w->size[1]; y++)
                for (int32_t x = 0; x + 1 < w->size[0]; x++) {
                    const size_t cube = index_of(w, x, y, z);
                    const uint8_t air = air_of(w, cube, step);
                    const uint8_t *parts = part[air == UINT8_MAX ? 0 : air];
                    w->first[cube] = parts[0] ? count : -1;
                    for (int k = 1; k <= parts[0]; k++, count++) {
                        if (pass == 0)
                            continue;
                        w->air[count] = parts[k];
                        memcpy(w->cube[count], (int32_t[]){x, y, z}, sizeof *w->cube);
                        place(w, count, cube, air, step);
                    }
                }
        w->vertices = count;
        if (pass == 0) {
            w->cube = array((size_t)count, sizeof *w->cube, &failed);
            w->at = array((size_t)count, sizeof *w->at, &failed);
            w->normal = array((size_t)count, sizeof *w->normal, &failed);
            w->air = array((size_t)count, 1, &failed);
            w->lock = array((size_t)count, 1, &failed);
        }
        if (failed)
            return false;
    }
    return true;
}

/* The four vertices around a face of a voxel, counter-clockwise seen from outside. */
static void corners_of(const struct work *w, size_t voxel, int face, const size_t step[3],
                       int32_t corner[4])
{
    const int a = face / 2, side = face & 1, u = (a + 1) % 3, v = (a + 2) % 3;
    const size_t low = side ? voxel : voxel - step[a];
    for (int k = 0; k < 4; k++) {
        const int turn = side ? k : 3 - k, cu = turn == 0 || turn == 3, cv = turn < 2;
        const size_t cube = low - (size_t)cu * step[u] - (size_t)cv * step[v];
        corner[k] = vertex_at(w, cube, side << a | cu << u | cv << v);
    }
}

static bool find_quads(struct work *w)
{
    size_t step[3];
    bool failed = false;
    steps_of(w, step);
    for (int pass = 0; pass < 2; pass++) {
        int32_t count = 0;
        for (int32_t z = 1; z + 1 < w->size[2]; z++)
            for (int32_t y = 1; y + 1 < w->size[1]; y++)
                for (int32_t x = 1; x + 1 < w->size[0]; x++) {
                    const size_t voxel = index_of(w, x, y, z);
                    for (int face = 0; face < 6 && is_in(w->voxel[voxel]); face++) {
                        const size_t beside =
                            face & 1 ? voxel + step[face / 2] : voxel - step[face / 2];
                        if (is_in(w->voxel[beside]))
                            continue;
                        if (pass) {
                            corners_of(w, voxel, face, step, w->quad[count]);
                            w->face[count] = (uint8_t)face;
                            w->natural[count] = w->voxel[beside] != NET_CLOSED;
                        }
                        count++;
                    }
                }
        w->quads = count;
        if (pass == 0) {
            w->quad = array((size_t)count, sizeof *w->quad, &failed);
            w->face = array((size_t)count, 1, &failed);
            w->natural = array((size_t)count, 1, &failed);
        }
        if (failed)
            return false;
    }
    return true;
}

/* Vertices of cubes with a face in common, through air on it that has a natural crossing there. */
static bool find_links(struct work *w)
{
    size_t step[3];
    bool failed = false;
    int32_t count = 0;
    steps_of(w, step);
    w->link_end = array((size_t)w->vertices + 1, sizeof *w->link_end, &failed);
    w->link = array((size_t)w->vertices * LINKS_MOST, sizeof *w->link, &failed);
    if (failed)
        return false;
    w->link_end[0] = 0;
    for (int32_t v = 0; v < w->vertices; v++) {
        const size_t cube = index_of(w, w->cube[v][0], w->cube[v][1], w->cube[v][2]);
        for (int face = 0; face < 6; face++) {
            const int a = face / 2, side = face & 1;
            const int32_t to = w->cube[v][a] + (side ? 1 : -1);
            if (to < 0 || to + 1 >= w->size[a])
                continue;
            const size_t beside = side ? cube + step[a] : cube - step[a];
            int32_t last = -1;
            for (int c = 0; c < CORNERS; c++) {
                const size_t at = corner_of(cube, c, step);
                bool crosses = false;
                if ((c >> a & 1) != side || !(w->air[v] >> c & 1) || w->voxel[at] == NET_CLOSED)
                    continue;
                for (int b = 0; b < 3; b++)
                    crosses |= b != a && is_in(w->voxel[c >> b & 1 ? at - step[b] : at + step[b]]);
                if (!crosses)
                    continue;
                const int32_t other = vertex_at(w, beside, c ^ 1 << a);
                if (other != last)
                    w->link[count++] = last = other;
            }
        }
        w->link_end[v + 1] = count;
    }
    return true;
}

/* ---- smoothing ---- */

/* Of one thing along x, y, z: how far it is from the mean of its neighbours. */
static int32_t apart(const struct work *w, int32_t (*x)[3], int32_t v, int k)
{
    const int32_t *link = w->link + w->link_end[v], *end = w->link + w->link_end[v + 1];
    const int32_t count = (int32_t)(end - link);
    int32_t sum = 0;
    for (; link < end; link++)
        sum += x[*link][k];
    return count ? x[v][k] - sum / count : 0;
}

/* Chebyshev's polynomial of three passes, least from 1/2 to 2: 1 - u (1092 - 960 u + 256 u^2) / 365
 * of the umbrella operator u. */
static bool smooth(struct work *w)
{
    bool failed = false;
    const size_t all = (size_t)w->vertices;
    int32_t(*g)[3] = array(all, sizeof *g, &failed), (*y)[3] = array(all, sizeof *y, &failed),
    (*t)[3] = array(all, sizeof *t, &failed);
    for (int32_t v = 0; v < w->vertices && !failed; v++)
        for (int k = 0; k < 3; k++) {
            g[v][k] = w->lock[v] >> k & 1 ? 0 : apart(w, w->at, v, k);
            y[v][k] = 256 * g[v][k] / 365;
        }
    for (int pass = 0; pass < 2 && !failed; pass++) {
        for (int32_t v = 0; v < w->vertices; v++)
            for (int k = 0; k < 3; k++)
                t[v][k] = w->lock[v] >> k & 1
                              ? 0
                              : apart(w, y, v, k) + (pass ? 1092 : -960) * g[v][k] / 365;
        memcpy(y, t, all * sizeof *y);
    }
    for (int32_t v = 0; v < w->vertices && !failed; v++)
        for (int k = 0; k < 3; k++)
            w->at[v][k] -= y[v][k];
    free(g);
    free(y);
    free(t);
    return !failed;
}

static void clamp(struct work *w)
{
    for (int32_t v = 0; v < w->vertices; v++)
        for (int k = 0; k < 3; k++) {
            const int32_t low = w->cube[v][k] * NET_ONE - SLACK, high = low + NET_ONE + 2 * SLACK;
            int32_t *at = &w->at[v][k];
            *at = *at < low ? low : *at > high ? high : *at;
        }
}

/* ---- normals ---- */

static uint32_t root_of(uint64_t square)
{
    uint64_t root = 0, bit = UINT64_C(1) << 62;
    while (bit > square)
        bit >>= 2;
    for (; bit; bit >>= 2) {
        const bool fits = square >= root + bit;
        square -= fits ? root + bit : 0;
        root = (root >> 1) + (fits ? bit : 0);
    }
    return (uint32_t)root;
}

static void cross(const int64_t a[3], const int64_t b[3], int64_t out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static void make_long(int32_t n[3], int32_t length)
{
    int64_t square = 0;
    for (int k = 0; k < 3; k++)
        square += (int64_t)n[k] * n[k];
    const int64_t root = root_of((uint64_t)square << 8); /* 16 times as long */
    for (int k = 0; k < 3; k++)
        n[k] = root ? (int32_t)((int64_t)n[k] * length * 16 / root) : 0;
}

/* By the faces of voxels, smoothed a little: which way vertices are pushed. */
static bool face_normals(struct work *w, int32_t (*normal)[3])
{
    bool failed = false;
    int32_t(*t)[3] = array((size_t)w->vertices, sizeof *t, &failed);
    if (failed)
        return false;
    memset(normal, 0, (size_t)w->vertices * sizeof *normal);
    for (int32_t q = 0; q < w->quads; q++)
        for (int k = 0; k < 4 && w->natural[q]; k++)
            normal[w->quad[q][k]][w->face[q] / 2] += w->face[q] & 1 ? 1 : -1;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t v = 0; v < w->vertices; v++)
            for (int k = 0; k < 3; k++) {
                int32_t sum = 2 * normal[v][k];
                for (int32_t l = w->link_end[v]; l < w->link_end[v + 1]; l++)
                    sum += normal[w->link[l]][k];
                t[v][k] = sum;
            }
        memcpy(normal, t, (size_t)w->vertices * sizeof *normal);
    }
    free(t);
    return true;
}

/* From the quads as they lie; weights of the passes' steps are 1/2, 3/5, 3/4 and 1. */
static bool find_normals(struct work *w, const uint32_t scale[3])
{
    static const int32_t step[4][2] = {{1, 2}, {3, 5}, {3, 4}, {1, 1}};
    bool failed = false;
    int32_t(*t)[3] = array((size_t)w->vertices, sizeof *t, &failed);
    if (failed)
        return false;
    memset(w->normal, 0, (size_t)w->vertices * sizeof *w->normal);
    for (int32_t q = 0; q < w->quads; q++) {
        const int32_t *v = w->quad[q];
        int64_t e[3], g[3], area[3];
        for (int k = 0; k < 3; k++) {
            e[k] = w->at[v[2]][k] - w->at[v[0]][k];
            g[k] = w->at[v[3]][k] - w->at[v[1]][k];
        }
        cross(e, g, area);
        for (int k = 0; k < 12 && w->natural[q]; k++)
            w->normal[v[k / 3]][k % 3] += (int32_t)(area[k % 3] >> 8);
    }
    for (int pass = 0; pass < 4; pass++) {
        for (int32_t v = 0; v < w->vertices; v++)
            for (int k = 0; k < 3; k++)
                t[v][k] =
                    w->normal[v][k] - apart(w, w->normal, v, k) / step[pass][1] * step[pass][0];
        memcpy(w->normal, t, (size_t)w->vertices * sizeof *t);
    }
    for (int32_t v = 0; v < w->vertices; v++) {
        for (int k = 0; k < 3; k++)
            w->normal[v][k] = (int32_t)((int64_t)w->normal[v][k] * scale[k] >> 12);
        make_long(w->normal[v], 1 << NET_NORMAL_BITS);
    }
    free(t);
    return true;
}

/* ---- volume ---- */

enum { LOST, BY_PUSH, BY_SQUARE, BY_CUBE, TERMS };

/* What each vertex has lost, its share of the flux of each quad from the middle of its cube to
 * where it is, and what a push by h along the normals gives: BY_PUSH h + BY_SQUARE h^2 + BY_CUBE
 * h^3. In 2^-20 voxels. */
static void sum_terms(const struct work *w, int32_t (*normal)[3], int64_t (*term)[TERMS])
{
    memset(term, 0, (size_t)w->vertices * sizeof *term);
    for (int32_t q = 0; q < w->quads; q++) {
        const int32_t *v = w->quad[q];
        const int a = w->face[q] / 2;
        int64_t e[3], g[3], ec[3], gc[3], en[3], gn[3], is[3], was[3], mixed[3], other[3],
            pushed[3];
        if (!w->natural[q])
            continue;
        for (int k = 0; k < 3; k++) {
            e[k] = w->at[v[2]][k] - w->at[v[0]][k];
            g[k] = w->at[v[3]][k] - w->at[v[1]][k];
            ec[k] = e[k] + (int64_t)(w->cube[v[2]][k] - w->cube[v[0]][k]) * NET_ONE;
            gc[k] = g[k] + (int64_t)(w->cube[v[3]][k] - w->cube[v[1]][k]) * NET_ONE;
            en[k] = normal[v[2]][k] - normal[v[0]][k];
            gn[k] = normal[v[3]][k] - normal[v[1]][k];
        }
        cross(e, g, is);
        cross(ec, gc, was);
        cross(e, gn, mixed);
        cross(en, g, other);
        cross(en, gn, pushed);
        for (int k = 0; k < 3; k++) {
            mixed[k] += other[k];
            was[k] += is[k];
        }
        was[a] += (w->face[q] & 1 ? 2 : -2) * (int64_t)NET_ONE * NET_ONE;
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3; k++) {
                const int64_t middle = (int64_t)w->cube[v[i]][k] * NET_ONE + NET_ONE / 2;
                const int64_t n = normal[v[i]][k];
                term[v[i]][LOST] += (was[k] >> 8) * (middle - w->at[v[i]][k]);
                term[v[i]][BY_PUSH] += (is[k] >> 8) * n;
                term[v[i]][BY_SQUARE] += (mixed[k] >> 8) * n;
                term[v[i]][BY_CUBE] += (pushed[k] >> 8) * n;
            }
    }
}

/* The push at which the terms make up for what is lost. */
static int32_t push_of(const int64_t m[TERMS])
{
    int64_t low = -PUSH_MOST, high = PUSH_MOST;
    while (high - low > 1) {
        const int64_t h = (low + high) >> 1;
        const int64_t got =
            (m[BY_PUSH] + (m[BY_SQUARE] + m[BY_CUBE] * h / NET_ONE) * h / NET_ONE) * h / NET_ONE;
        if (got < m[LOST])
            low = h;
        else
            high = h;
    }
    return (int32_t)low;
}

/* Chebyshev's polynomial of four passes, least from 1/5 to 2:
 * 1 - u (283360 - 516000 u + 352000 u^2 - 80000 u^3) / 45281. */
static bool restore(struct work *w)
{
    static const int64_t factor[4] = {-80000, 352000, -516000, 283360}, divisor = 45281;
    static const int64_t share[TERMS] = {48, 8, 16, 24};
    bool failed = false;
    const size_t all = (size_t)w->vertices;
    int32_t(*normal)[3] = array(all, sizeof *normal, &failed);
    int64_t(*term)[TERMS] = array(all, sizeof *term, &failed);
    int32_t(*x)[TERMS] = array(all, sizeof *x, &failed),
    (*g)[TERMS] = array(all, sizeof *g, &failed);
    int32_t(*y)[TERMS] = array(all, sizeof *y, &failed),
    (*t)[TERMS] = array(all, sizeof *t, &failed);
    failed = failed || !face_normals(w, normal);
    for (int32_t v = 0; v < w->vertices && !failed; v++) {
        for (int k = 0; k < 3; k++)
            normal[v][k] = w->lock[v] >> k & 1 ? 0 : normal[v][k] * 256;
        make_long(normal[v], NET_ONE);
    }
    if (!failed)
        sum_terms(w, normal, term);
    for (int32_t v = 0; v < w->vertices && !failed; v++)
        for (int i = 0; i < TERMS; i++)
            x[v][i] = (int32_t)(term[v][i] / share[i] / NET_ONE);
    for (int pass = 0; pass < 4 && !failed; pass++) {
        int32_t(*from)[TERMS] = pass ? y : x;
        for (int32_t v = 0; v < w->vertices; v++) {
            const int64_t count = w->link_end[v + 1] - w->link_end[v];
            int64_t sum[TERMS] = {0};
            for (int32_t l = w->link_end[v]; l < w->link_end[v + 1]; l++)
                for (int i = 0; i < TERMS; i++)
                    sum[i] += from[w->link[l]][i];
            for (int i = 0; i < TERMS; i++) {
                const int64_t d = count ? from[v][i] - sum[i] / count : 0;
                g[v][i] = pass ? g[v][i] : (int32_t)d;
                t[v][i] = (int32_t)((pass ? d : 0) + factor[pass] * g[v][i] / divisor);
            }
        }
        memcpy(y, t, all * sizeof *y);
    }
    for (int32_t v = 0; v < w->vertices && !failed; v++) {
        int64_t m[TERMS];
        for (int i = 0; i < TERMS; i++)
            m[i] = (int64_t)x[v][i] - y[v][i];
        const int64_t push = push_of(m);
        for (int k = 0; k < 3; k++)
            w->at[v][k] += (int32_t)(push * normal[v][k] / NET_ONE);
    }
    free(normal);
    free(term);
    free(x);
    free(g);
    free(y);
    free(t);
    return !failed;
}

/* ---- the box ---- */

static void release(struct work *w)
{
    free(w->voxel);
    free(w->first);
    free(w->cube);
    free(w->at);
    free(w->air);
    free(w->lock);
    free(w->link_end);
    free(w->link);
    free(w->normal);
    free(w->quad);
    free(w->face);
    free(w->natural);
}

static bool read_voxels(struct work *w, const struct net_source *source, const int32_t first[3],
                        const uint32_t size[3])
{
    bool failed = false;
    size_t voxels = 1;
    for (int a = 0; a < 3; a++)
        w->size[a] = (int32_t)size[a] + 2 * NET_MARGIN;
    for (int a = 0; a < 3 && !failed; a++)
        failed = !size_multiply(voxels, (size_t)w->size[a], &voxels);
    if (failed || voxels > INT32_MAX)
        return false;
    w->voxel = array(voxels, sizeof *w->voxel, &failed);
    for (int32_t z = 0; z < w->size[2] && !failed; z++)
        for (int32_t y = 0; y < w->size[1]; y++)
            source->row(source->context, first[0] - NET_MARGIN, first[1] + y - NET_MARGIN,
                        first[2] + z - NET_MARGIN, (uint32_t)w->size[0],
                        w->voxel + index_of(w, 0, y, z));
    return !failed;
}

/* Which voxel a quad is of: its first corner's cube and the face say it. */
static void voxel_of(const struct work *w, int32_t q, int32_t voxel[3])
{
    const int face = w->face[q], a = face / 2, side = face & 1, turn = side ? 0 : 3;
    const int32_t *cube = w->cube[w->quad[q][0]];
    voxel[a] = cube[a] + !side;
    voxel[(a + 1) % 3] = cube[(a + 1) % 3] + (turn == 0 || turn == 3);
    voxel[(a + 2) % 3] = cube[(a + 2) % 3] + (turn < 2);
}

/* Takes what is of the box itself. */
static bool take(struct net *net, const struct work *w, const int32_t first[3])
{
    bool failed = false;
    struct net out = {.vertices = 0};
    int32_t *number = array((size_t)w->vertices, sizeof *number, &failed);
    out.quad = array((size_t)w->quads, sizeof *out.quad, &failed);
    if (!failed)
        memset(number, UINT8_MAX, (size_t)w->vertices * sizeof *number);
    for (int32_t q = 0; q < w->quads && !failed; q++) {
        int32_t voxel[3];
        bool is_inside = true;
        voxel_of(w, q, voxel);
        for (int a = 0; a < 3; a++)
            is_inside &= voxel[a] >= NET_MARGIN && voxel[a] < w->size[a] - NET_MARGIN;
        if (!is_inside)
            continue;
        struct net_quad *quad = &out.quad[out.quads++];
        *quad = (struct net_quad){.face = w->face[q], .is_closed = !w->natural[q]};
        quad->label = (uint8_t)w->voxel[index_of(w, voxel[0], voxel[1], voxel[2])];
        for (int k = 0; k < 4; k++)
            number[w->quad[q][k]] = 0;
        for (int k = 0; k < 4; k++)
            quad->corner[k] = (uint32_t)w->quad[q][k];
        for (int a = 0; a < 3; a++)
            quad->voxel[a] = voxel[a] + first[a] - NET_MARGIN;
    }
    for (int32_t v = 0; v < w->vertices && !failed; v++)
        out.vertices += number[v] == 0;
    out.vertex = failed ? NULL : array(out.vertices, sizeof *out.vertex, &failed);
    for (int32_t v = 0, count = 0; v < w->vertices && !failed; v++) {
        if (number[v] < 0)
            continue;
        struct net_vertex *vertex = &out.vertex[count];
        number[v] = count++;
        vertex->air = w->air[v];
        for (int a = 0; a < 3; a++) {
            vertex->cube[a] = w->cube[v][a] + first[a] - NET_MARGIN;
            vertex->at[a] = (int16_t)(w->at[v][a] - w->cube[v][a] * NET_ONE);
            vertex->normal[a] = (int16_t)w->normal[v][a];
        }
    }
    for (uint32_t q = 0; q < out.quads && !failed; q++)
        for (int k = 0; k < 4; k++)
            out.quad[q].corner[k] = (uint32_t)number[out.quad[q].corner[k]];
    free(number);
    if (failed) {
        net_release(&out);
        return false;
    }
    *net = out;
    return true;
}

static void centre(struct work *w)
{
    for (int32_t v = 0; v < w->vertices; v++)
        for (int k = 0; k < 3; k++)
            w->at[v][k] = w->cube[v][k] * NET_ONE + NET_ONE / 2;
}

enum err net_make(struct net *net, const struct net_source *source, const int32_t first[3],
                  const uint32_t size[3], struct fault *fault)
{
    struct work w = {.vertices = 0};
    find_parts();
    bool made = read_voxels(&w, source, first, size) && find_vertices(&w) && find_quads(&w) &&
                find_links(&w);
    if (made && !source->is_cubes) {
        made = smooth(&w);
        if (made) {
            clamp(&w);
            made = find_normals(&w, source->scale) && restore(&w);
            clamp(&w);
        }
    } else if (made) {
        made = find_normals(&w, source->scale);
        centre(&w);
    }
    made = made && take(net, &w, first);
    release(&w);
    return made ? OK : fault_memory(fault, "a surface");
}

unsigned net_diagonal(int32_t corner[4][3], unsigned face)
{
    int64_t longer = 0; /* how much 0 to 2 is, squared */
    for (int a = 0; a < 3; a++) {
        const int64_t d = corner[2][a] - corner[0][a], e = corner[3][a] - corner[1][a];
        longer += d * d - e * e;
    }
    return longer == 0 ? !(face & 1) : longer > 0;
}

void net_release(struct net *net)
{
    free(net->vertex);
    free(net->quad);
    *net = (struct net){.vertices = 0};
}
