/* SPDX-License-Identifier: MIT */
#include "render/projection.h"

#include <string.h>

#include "render/layers.h"

enum {
    PIXEL = 1 << POINT_BITS,
    POINT_SHIFT = 30 - POINT_BITS, /* positions in pictures are first in 2^-30 pixels */
    DEPTH_SHIFT = 30 - (CROSSING_PIXEL_BITS - NUMBER_BITS),
    POINTS_MOST = 1024, /* corners of a brick projected once; if it has more, once for each quad */
};

/* Larger than any visible slope, and small enough for the sums. */
static const int64_t SLOPE_MOST = INT64_C(1) << 40;

struct point {
    int32_t x, y; /* in 256ths of pixels */
    int64_t z;    /* depth, without the number */
};

/* ---- places ---- */

static int64_t dot30(const int64_t a[3], const int32_t b[3])
{
    return times30(a[0], b[0]) + times30(a[1], b[1]) + times30(a[2], b[2]);
}

void drawer_init(struct drawer *d, const struct camera *camera, const struct mesh *mesh)
{
    const int32_t *r = camera->right, *u = camera->up;
    int64_t normal[3];
    *d = (struct drawer){.camera = camera, .mesh = mesh};
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            d->step[k][a] = (camera->flip[a] ? -1 : 1) * camera->column[k][a];
    for (int i = 0; i < 3; i++) { /* right x down */
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        normal[i] = times30(r[k], u[j]) - times30(r[j], u[k]);
    }
    d->is_mirrored = dot30(normal, camera->ahead) < 0;
}

void project_place(const struct camera *camera, struct place place, int64_t centre[3])
{
    const uint32_t voxel[3] = {place.x, place.y, place.z};
    for (int k = 0; k < 3; k++) {
        centre[k] = camera->centre[k];
        for (int a = 0; a < 3; a++) {
            const int64_t size = camera->scene->grid.size[a];
            centre[k] += (camera->flip[a] ? size - 1 - voxel[a] : voxel[a]) * camera->column[k][a];
        }
    }
}

static void base_of(const struct drawer *d, const uint32_t first[3], int64_t base[3])
{
    project_place(d->camera, (struct place){first[0], first[1], first[2]}, base);
}

static inline int64_t along(const struct drawer *d, int k, const int64_t base[3],
                            const int32_t at[3])
{
    const int64_t *step = d->step[k];
    return base[k] + ((step[0] * at[0] + step[1] * at[1] + step[2] * at[2]) >> NET_BITS);
}

static inline struct point point_of(const struct drawer *d, const int64_t base[3],
                                    const int32_t at[3])
{
    return (struct point){(int32_t)(along(d, 0, base, at) >> POINT_SHIFT),
                          (int32_t)(along(d, 1, base, at) >> POINT_SHIFT),
                          along(d, 2, base, at) >> DEPTH_SHIFT};
}

/* ---- triangles ---- */

struct window {
    int32_t left, top, right, bottom; /* both ends included */
    bool is_by_pixel;                 /* each pixel on its own, as in the ray walk */
};

static inline struct edge_function side_of(const struct point *a, const struct point *b, int32_t x,
                                           int32_t y)
{
    const int64_t dx = b->x - a->x, dy = b->y - a->y;
    const int64_t at = dx * ((int64_t)y * PIXEL - a->y) - dy * ((int64_t)x * PIXEL - a->x);
    return (struct edge_function){at, -dy * PIXEL, dx * PIXEL};
}

/* An edge through a pixel's centre counts for one of its two directions alone. */
static inline struct edge_function edge_of(const struct point *a, const struct point *b, int32_t x,
                                           int32_t y)
{
    struct edge_function e = side_of(a, b, x, y);
    const bool owns = b->y < a->y || (b->y == a->y && b->x > a->x);
    e.at -= !owns;
    return e;
}

/* Return twice the area, positive for a front face. */
static inline int64_t area_of(const struct point *a, const struct point *b, const struct point *c)
{
    return (int64_t)(b->x - a->x) * (c->y - a->y) - (int64_t)(c->x - a->x) * (b->y - a->y);
}

static inline int32_t least_of(int32_t a, int32_t b)
{
    return a < b ? a : b;
}
static inline int32_t most_of(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

/* The depth of a triangle's plane. */
struct slope {
    const struct point *from;
    int64_t right, down; /* per pixel */
    int64_t least, most;
};

static int64_t slope_within(int64_t slope)
{
    return slope < -SLOPE_MOST ? -SLOPE_MOST : slope > SLOPE_MOST ? SLOPE_MOST : slope;
}

static struct slope slope_of(const struct point *a, const struct point *b, const struct point *c,
                             int64_t area)
{
    const int64_t z1 = b->z - a->z, z2 = c->z - a->z;
    const int64_t right = z1 * (c->y - a->y) - z2 * (b->y - a->y);
    const int64_t down = z2 * (b->x - a->x) - z1 * (c->x - a->x);
    struct slope s = {a, slope_within(right * PIXEL / area), slope_within(down * PIXEL / area),
                      a->z < b->z ? a->z : b->z, a->z > b->z ? a->z : b->z};
    s.least = c->z < s.least ? c->z : s.least;
    s.most = c->z > s.most ? c->z : s.most;
    return s;
}

static inline int64_t depth_at(const struct slope *s, int32_t x, int32_t y)
{
    const int64_t right = (int64_t)x * PIXEL - s->from->x, down = (int64_t)y * PIXEL - s->from->y;
    const int64_t z = s->from->z + ((s->right * right + s->down * down) >> POINT_BITS);
    return z < s->least ? s->least : z > s->most ? s->most : z;
}

/* The owner of a triangle's pixels. */
struct owner {
    uint32_t cell;
    uint8_t label;
    unsigned number;
    bool is_layer; /* the picture has layers */
    bool is_opaque;
};

static inline void put_pixel(struct rendition *r, size_t pixel, size_t tile, int64_t key,
                             const struct owner *o)
{
    if (o->is_layer) {
        layers_put(r->layers, pixel, (struct layer){key, o->cell, o->label}, o->is_opaque);
    } else if (key < r->depth[pixel] || (key == r->depth[pixel] && o->cell < r->cell[pixel])) {
        r->depth[pixel] = key;
        r->cell[pixel] = o->cell;
    } else {
        return;
    }
    r->is_drawn[tile] = true;
}

static void draw_triangle(struct rendition *r, const struct window *w, const struct point *a,
                          const struct point *b, const struct point *c, int64_t area,
                          const struct owner *o)
{
    const int32_t left =
        most_of(w->left, (least_of(a->x, least_of(b->x, c->x)) + PIXEL - 1) >> POINT_BITS);
    const int32_t right = least_of(w->right, most_of(a->x, most_of(b->x, c->x)) >> POINT_BITS);
    const int32_t top =
        most_of(w->top, (least_of(a->y, least_of(b->y, c->y)) + PIXEL - 1) >> POINT_BITS);
    const int32_t bottom = least_of(w->bottom, most_of(a->y, most_of(b->y, c->y)) >> POINT_BITS);
    if (left > right || top > bottom)
        return;
    if (w->is_by_pixel) {
        for (int32_t y = top; y <= bottom; y++)
            for (int32_t x = left; x <= right; x++)
                draw_triangle(r, &(struct window){x, y, x, y, false}, a, b, c, area, o);
        return;
    }
    struct edge_function e[3] = {edge_of(a, b, left, top), edge_of(b, c, left, top),
                                 edge_of(c, a, left, top)};
    struct slope slope = {0};
    for (int32_t y = top; y <= bottom; y++) {
        int64_t e0 = e[0].at, e1 = e[1].at, e2 = e[2].at;
        for (int32_t x = left; x <= right; x++) {
            if ((e0 | e1 | e2) >= 0) {
                if (!slope.from)
                    slope = slope_of(a, b, c, area);
                put_pixel(r, (size_t)y * r->width + (size_t)x,
                          (size_t)(y / TILE) * r->tiles_x + (size_t)(x / TILE),
                          depth_at(&slope, x, y) * (1 << NUMBER_BITS) + o->number, o);
            }
            e0 += e[0].right, e1 += e[1].right, e2 += e[2].right;
        }
        for (int i = 0; i < 3; i++)
            e[i].at += e[i].down;
    }
}

/* ---- bricks ---- */

/* Corners of a quad's triangles; in the picture they run the other way round, unless mirrored. */
static const uint8_t triangle[2][3] = {{0, 1, 2}, {0, 2, 3}};

static void draw_brick(const struct drawer *d, struct rendition *r, const struct window *w,
                       uint32_t number, const uint32_t first[3])
{
    const struct mesh *mesh = d->mesh;
    const struct mesh_brick *brick = mesh->brick[number];
    const bool is_kept = brick->vertices <= POINTS_MOST;
    const unsigned middle = d->is_mirrored ? 1 : 2;
    struct point kept[POINTS_MOST], own[4];
    int64_t base[3];
    base_of(d, first, base);
    for (uint32_t v = 0; is_kept && v < brick->vertices; v++)
        kept[v] = point_of(d, base, brick->vertex[v].at);
    for (uint32_t q = 0; q < brick->quads; q++) {
        const struct mesh_quad *quad = &brick->quad[q];
        const struct point *p[4];
        for (int k = 0; k < 4; k++) {
            if (!is_kept)
                own[k] = point_of(d, base, brick->vertex[quad->corner[k]].at);
            p[k] = is_kept ? &kept[quad->corner[k]] : &own[k];
        }
        for (unsigned t = 0; t < 2; t++) {
            const struct point *second = p[triangle[t][middle]];
            const struct point *third = p[triangle[t][3 - middle]];
            const int64_t area = area_of(p[0], second, third);
            if (area <= 0)
                continue;
            const struct place voxel = mesh_voxel(first, quad->key);
            const struct owner o = {
                .cell = grid_cell(&mesh->border->scene->grid, voxel.x, voxel.y, voxel.z),
                .label = quad->label,
                .number = quad->key % MESH_FACES * 2 + t,
                .is_layer = r->layers != NULL,
                .is_opaque = mesh->opacity[quad->label] == BORDER_OPAQUE,
            };
            draw_triangle(r, w, p[0], second, third, area, &o);
        }
    }
}

/* Return the pixels within `reach` of `middle`, and one more on each side. */
static struct footprint between(const struct camera *camera, const int64_t middle[2],
                                const int64_t reach[2])
{
    const int64_t most[2] = {(int64_t)camera->view.width - 1, (int64_t)camera->view.height - 1};
    int64_t end[2][2];
    for (int k = 0; k < 2; k++) {
        end[k][0] = ((middle[k] - reach[k]) >> 30) - 1;
        end[k][1] = ((middle[k] + reach[k]) >> 30) + 2;
        end[k][0] = end[k][0] < 0 ? 0 : end[k][0] > most[k] ? most[k] + 1 : end[k][0];
        end[k][1] = end[k][1] > most[k] ? most[k] : end[k][1] < 0 ? -1 : end[k][1];
    }
    return (struct footprint){(int32_t)end[0][0], (int32_t)end[1][0], (int32_t)end[0][1],
                              (int32_t)end[1][1]};
}

/* Return the extent of `bricks` adjacent bricks along x, from a voxel on. */
static struct sight seen_of(const struct drawer *d, const uint32_t first[3], uint32_t bricks)
{
    const int64_t last[3] = {(int64_t)bricks * MESH_SIDE - 1, MESH_SIDE - 1, MESH_SIDE - 1};
    struct sight seen;
    int64_t middle[3], reach[3] = {0, 0, 0};
    base_of(d, first, middle);
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) {
            const int64_t step = d->step[k][a], size = step < 0 ? -step : step;
            middle[k] += step * last[a] / 2;
            reach[k] += size * last[a] / 2 + size + size / 4 + 1;
        }
    seen.pixels = between(d->camera, middle, reach);
    seen.near = ((middle[2] - reach[2]) >> DEPTH_SHIFT) * (1 << NUMBER_BITS);
    return seen;
}

static bool may_cover(const struct sight *seen, const struct window *w)
{
    const struct footprint f = seen->pixels;
    return f.left <= w->right && f.right >= w->left && f.top <= w->bottom && f.bottom >= w->top;
}

static int64_t depth_of(const struct rendition *r, size_t pixel)
{
    return r->layers ? r->layers->last[pixel].depth : r->depth[pixel];
}

/* Return the largest depth of a tile's pixels, or of its opaque layers. */
static int64_t far_of(struct rendition *r, size_t tile)
{
    if (!r->is_drawn[tile])
        return r->far[tile];
    const struct tile_bounds t = rendition_bounds(r, tile);
    int64_t far = INT64_MIN;
    for (uint32_t y = t.top; y < t.bottom; y++)
        for (uint32_t x = t.left; x < t.right; x++) {
            const size_t pixel = (size_t)y * r->width + x;
            const int64_t depth = depth_of(r, pixel);
            far = depth > far ? depth : far;
        }
    r->far[tile] = far;
    r->is_drawn[tile] = false;
    return far;
}

/* Return true if all pixels of stale tiles that a brick may cover show something nearer. */
static bool is_hidden(struct rendition *r, const struct sight *seen, const struct window *w)
{
    const struct footprint f = seen->pixels;
    const int32_t right = least_of(f.right, w->right), bottom = least_of(f.bottom, w->bottom);
    for (int32_t y = most_of(f.top, w->top) / TILE; y <= bottom / TILE; y++)
        for (int32_t x = most_of(f.left, w->left) / TILE; x <= right / TILE; x++) {
            const size_t tile = (size_t)y * r->tiles_x + (size_t)x;
            if (r->stale[tile] == TILE_STALE && far_of(r, tile) >= seen->near)
                return false;
        }
    return true;
}

/* ---- the ways ---- */

/* Units of work in a brick: one for each voxel. */
enum { MESH_UNITS = MESH_SIDE * MESH_SIDE * MESH_SIDE };

static uint64_t units_of(const struct mesh *mesh)
{
    return (uint64_t)mesh->bricks * MESH_UNITS;
}

static struct window window_of(struct tile_bounds t)
{
    return (struct window){(int32_t)t.left, (int32_t)t.top, (int32_t)t.right - 1,
                           (int32_t)t.bottom - 1, false};
}

static void clear_layers(struct rendition *r, struct tile_bounds t)
{
    for (uint32_t y = t.top; r->layers && y < t.bottom; y++)
        for (uint32_t x = t.left; x < t.right; x++)
            layers_put_none(r->layers, (size_t)y * r->width + x);
}

/* Clear the picture and mark it stale; return the window of the whole picture. */
static struct window clear(struct rendition *r)
{
    const struct tile_bounds whole = {0, 0, r->width, r->height};
    rendition_clear(r);
    clear_layers(r, whole);
    return window_of(whole);
}

/* Draw a brick, unless it is outside the window. */
static void draw_seen(const struct drawer *d, struct rendition *r, const struct window *window,
                      uint32_t number)
{
    uint32_t first[3];
    mesh_first(d->mesh, number, first);
    const struct sight seen = seen_of(d, first, 1);
    if (may_cover(&seen, window))
        draw_brick(d, r, window, number, first);
}

void project_scene(struct rendition *r, const struct camera *camera, const struct mesh *mesh)
{
    struct task task = task_begin(camera->scene->watch, "rendition", units_of(mesh));
    const struct window window = clear(r);
    struct drawer d;
    drawer_init(&d, camera, mesh);
    for (uint32_t b = 0; b < mesh->bricks && task_advance(&task, MESH_UNITS); b++)
        if (mesh->brick[b])
            draw_seen(&d, r, &window, b);
}

/* Draw bricks from the nearest on, in the order of their rows. */
static void draw_border(struct task *task, struct rendition *r, const struct camera *camera,
                        const struct mesh *mesh, const struct window *window)
{
    struct drawer d;
    const uint32_t *size = mesh->size;
    drawer_init(&d, camera, mesh);
    for (uint32_t k = 0; k < size[2]; k++) {
        const uint32_t z = camera->flip[2] ? size[2] - 1 - k : k;
        if (!task_advance(task, (uint64_t)size[0] * size[1] * MESH_UNITS))
            return;
        for (uint32_t j = 0; j < size[1]; j++) {
            const uint32_t y = camera->flip[1] ? size[1] - 1 - j : j;
            const uint32_t row = (z * size[1] + y) * size[0];
            uint32_t first[3] = {0, y * MESH_SIDE, z * MESH_SIDE};
            const struct sight all = seen_of(&d, first, size[0]);
            for (uint32_t i = 0; may_cover(&all, window) && i < size[0]; i++) {
                const uint32_t x = camera->flip[0] ? size[0] - 1 - i : i;
                if (!mesh->brick[row + x])
                    continue;
                first[0] = x * MESH_SIDE;
                const struct sight seen = seen_of(&d, first, 1);
                if (may_cover(&seen, window) && !is_hidden(r, &seen, window))
                    draw_brick(&d, r, window, row + x, first);
            }
        }
    }
}

void project_border_part(struct rendition *r, const struct camera *camera, const struct mesh *mesh,
                         unsigned thread)
{
    struct task task = task_begin_part(camera->scene->watch, "rendition", units_of(mesh), thread);
    const struct window window = clear(r);
    draw_border(&task, r, camera, mesh, &window);
}

void project_border(struct rendition *r, const struct camera *camera, const struct mesh *mesh)
{
    project_border_part(r, camera, mesh, 0);
}

void project_stale(struct rendition *r, const struct camera *camera, const struct mesh *mesh)
{
    struct task task = task_begin(camera->scene->watch, "rendition", units_of(mesh));
    const size_t tiles = (size_t)r->tiles_x * r->tiles_y;
    struct window window = {INT32_MAX, INT32_MAX, -1, -1, false};
    for (size_t i = 0; rendition_tile(r, &i, tiles, TILE_STALE); i++) {
        const struct tile_bounds bounds = rendition_bounds(r, i);
        const struct window tile = window_of(bounds);
        window.left = least_of(window.left, tile.left), window.top = least_of(window.top, tile.top);
        window.right = most_of(window.right, tile.right);
        window.bottom = most_of(window.bottom, tile.bottom);
        rendition_clear_tile(r, i);
        clear_layers(r, bounds);
    }
    if (window.right >= 0)
        draw_border(&task, r, camera, mesh, &window);
}

void project_rays(struct rendition *r, const struct camera *camera, const struct mesh *mesh)
{
    const size_t tiles = (size_t)r->tiles_x * r->tiles_y;
    struct task task = task_begin(camera->scene->watch, "rendition", 8 * tiles * mesh->bricks);
    struct drawer d;
    drawer_init(&d, camera, mesh);
    clear(r);
    for (size_t tile = 0; tile < tiles && task_advance(&task, 8 * mesh->bricks); tile++) {
        struct window window = window_of(rendition_bounds(r, tile));
        window.is_by_pixel = true;
        for (uint32_t b = 0; b < mesh->bricks; b++)
            if (mesh->brick[b])
                draw_seen(&d, r, &window, b);
    }
}

/* ---- by several threads ---- */

enum { ROWS_MOST = 4 * VIEW_SIDE_MOST / TILE };

struct splitting {
    const struct rendition *rendition;
    const struct camera *camera;
    const struct mesh *mesh;
    uint32_t first[TEAM_MOST + 1]; /* first row of tiles of each thread, and the end */
};

/* Divide the rows so that each thread has about the same work. */
static void share_rows(struct splitting *s, unsigned threads)
{
    uint32_t work[ROWS_MOST], y = 0;
    uint64_t all = 0, before = 0;
    struct drawer d;
    const int64_t last = (int64_t)s->rendition->tiles_y - 1;
    drawer_init(&d, s->camera, s->mesh);
    for (int64_t i = 0; i <= last; i++)
        work[i] = 1 + s->rendition->width / 32;
    for (uint32_t b = 0; b < s->mesh->bricks; b++) {
        uint32_t first[3];
        int64_t base[3];
        if (!s->mesh->brick[b])
            continue;
        mesh_first(s->mesh, b, first);
        base_of(&d, first, base);
        const int64_t row = base[1] >> 30;
        if (row >= 0 && row / TILE <= last)
            work[row / TILE] += s->mesh->brick[b]->quads;
    }
    for (uint32_t i = 0; i < s->rendition->tiles_y; i++)
        all += work[i];
    for (unsigned i = 1; i < threads; i++) {
        while (y < s->rendition->tiles_y && before + work[y] / 2 < all * i / threads)
            before += work[y++];
        s->first[i] = y;
    }
    s->first[0] = 0;
    s->first[threads] = s->rendition->tiles_y;
}

static void draw_share(void *context, unsigned thread)
{
    const struct splitting *s = context;
    const uint32_t top = s->first[thread] * TILE, end = s->first[thread + 1] * TILE;
    const uint32_t height = (end < s->rendition->height ? end : s->rendition->height) - top;
    if (end <= top)
        return;
    struct rendition part = rendition_rows(s->rendition, top, height);
    struct layers layers;
    if (s->rendition->layers) { /* their rows from `top` on */
        const size_t first = (size_t)top * s->rendition->width;
        layers = *s->rendition->layers;
        layers.last += first;
        layers.layer += first;
        layers.count += first;
        part.layers = &layers;
    }
    const struct camera camera = camera_rows(s->camera, top, height);
    project_border_part(&part, &camera, s->mesh, thread);
}

void project_border_shared(struct rendition *r, const struct camera *camera,
                           const struct mesh *mesh, struct team *team)
{
    struct splitting s = {.rendition = r, .camera = camera, .mesh = mesh};
    if (team_size(team) == 1 || r->tiles_y > ROWS_MOST) {
        project_border(r, camera, mesh);
        return;
    }
    share_rows(&s, team_size(team));
    team_run(team, draw_share, &s);
}

/* ---- where things fall ---- */

struct sight project_quad(const struct drawer *d, uint32_t number, const struct mesh_brick *brick,
                          const struct mesh_quad *quad)
{
    uint32_t first[3];
    int64_t base[3], least[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, most[2] = {INT64_MIN, INT64_MIN};
    int64_t middle[2], reach[2];
    mesh_first(d->mesh, number, first);
    base_of(d, first, base);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) {
            const int64_t at = along(d, k, base, brick->vertex[quad->corner[i]].at);
            least[k] = at < least[k] ? at : least[k];
            if (k < 2)
                most[k] = at > most[k] ? at : most[k];
        }
    for (int k = 0; k < 2; k++) {
        middle[k] = (least[k] + most[k]) / 2;
        reach[k] = (most[k] - least[k]) / 2 + 1;
    }
    return (struct sight){between(d->camera, middle, reach),
                          (least[2] >> DEPTH_SHIFT) * (1 << NUMBER_BITS)};
}

bool project_is_hidden(const struct rendition *r, const struct sight *sight)
{
    const struct footprint f = sight->pixels;
    for (int32_t y = f.top; y <= f.bottom; y++)
        for (int32_t x = f.left; x <= f.right; x++)
            if (depth_of(r, (size_t)y * r->width + (size_t)x) >= sight->near)
                return false;
    return true;
}

struct footprint project_around(const struct camera *camera, uint32_t cell, int around)
{
    int64_t centre[3];
    project_place(camera, grid_place(&camera->scene->grid, cell), centre);
    return between(camera, centre,
                   (const int64_t[]){(2 * around + 1) * camera->reach[0],
                                     (2 * around + 1) * camera->reach[1]});
}

void drawer_triangle(const struct drawer *d, struct seen *seen, unsigned number, uint32_t cell)
{
    const struct place place = grid_place(&d->camera->scene->grid, cell);
    const struct mesh_brick *brick;
    const struct mesh_quad *quad = mesh_find(d->mesh, &brick, place, number / 2);
    const uint32_t last = MESH_SIDE - 1;
    const uint32_t first[3] = {place.x & ~last, place.y & ~last, place.z & ~last};
    int64_t base[3];
    struct point p[3];
    base_of(d, first, base);
    for (int k = 0; k < 3; k++) {
        const struct mesh_vertex *v = &brick->vertex[quad->corner[triangle[number & 1][k]]];
        memcpy(seen->normal[k], v->normal, sizeof seen->normal[k]);
        p[k] = point_of(d, base, v->at);
    }
    for (int k = 0; k < 2; k++) {
        const struct point *one = &p[k + 1], *other = &p[(k + 2) % 3];
        seen->share[k] = d->is_mirrored ? side_of(one, other, 0, 0) : side_of(other, one, 0, 0);
    }
    const int64_t area = area_of(&p[0], &p[1], &p[2]);
    seen->all = d->is_mirrored ? area : -area;
    seen->cell = cell;
    seen->number = number;
    seen->open = quad->is_closed ? (uint8_t)(number / 2 + 1) : 0;
}
