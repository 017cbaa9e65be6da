/* SPDX-License-Identifier: MIT */
/* The mesh: after any sequence of changes it equals the mesh computed from scratch. */
#include "tests/check_main.h"

#include "tests/scarce_memory.h"
#include "tests/stage.h"
#include "tests/stopping.h"

/* ---- one mesh beside another ---- */

static bool is_same_vertex(const struct mesh_brick *a, const struct mesh_quad *p,
                           const struct mesh_brick *b, const struct mesh_quad *q)
{
    for (int k = 0; k < 4; k++)
        if (memcmp(&a->vertex[p->corner[k]], &b->vertex[q->corner[k]], sizeof *a->vertex) != 0)
            return false;
    return true;
}

/* Compare quad by quad; a brick without quads equals a missing one. */
static bool is_same_brick(const struct mesh_brick *a, const struct mesh_brick *b)
{
    const uint32_t count = a ? a->quads : 0;
    if (count != (b ? b->quads : 0))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        const struct mesh_quad *p = &a->quad[i], *q = &b->quad[i];
        if (p->key != q->key || p->label != q->label || p->is_closed != q->is_closed ||
            !is_same_vertex(a, p, b, q))
            return false;
    }
    return count == 0 || memcmp(a->row, b->row, sizeof a->row) == 0;
}

static bool is_same_mesh(const struct mesh *a, const struct mesh *b)
{
    for (uint32_t i = 0; i < b->bricks; i++)
        if (a->bricks != b->bricks || !is_same_brick(a->brick[i], b->brick[i])) {
            uint32_t first[3];
            mesh_first(b, i, first);
            printf("# brick of %u,%u,%u: %u quads, %u from nothing\n", first[0], first[1], first[2],
                   a->brick[i] ? a->brick[i]->quads : 0, b->brick[i] ? b->brick[i]->quads : 0);
            return false;
        }
    return true;
}

/* Check the promises of render/mesh.h for vertices and the order of quads, and that each quad
 * belongs to a visible voxel. */
static bool holds(const struct mesh *mesh)
{
    size_t bytes = 0;
    for (uint32_t i = 0; i < mesh->bricks; i++) {
        const struct mesh_brick *b = mesh->brick[i];
        uint32_t first[3];
        if (!b)
            continue;
        mesh_first(mesh, i, first);
        bytes += sizeof *b + b->vertices * sizeof *b->vertex + b->quads * sizeof *b->quad;
        for (uint32_t v = 0; v < b->vertices; v++)
            for (int a = 0; a < 3; a++) {
                const int32_t at = b->vertex[v].at[a];
                if (at < -MESH_BEYOND || at > (MESH_SIDE - 1) * NET_ONE + MESH_BEYOND)
                    return false;
            }
        for (uint32_t q = 0; q < b->quads; q++) {
            const unsigned at = b->quad[q].key >> 3;
            const uint32_t cell = grid_cell(&mesh->border->scene->grid, first[0] + at % MESH_SIDE,
                                            first[1] + at / MESH_SIDE % MESH_SIDE,
                                            first[2] + at / MESH_SIDE / MESH_SIDE);
            if (q > 0 && b->quad[q].key <= b->quad[q - 1].key)
                return false;
            if (!border_shows(mesh->border, cell) ||
                labels_at(&mesh->border->labels, cell) != b->quad[q].label)
                return false;
        }
    }
    return bytes <= mesh_bytes(mesh);
}

/* Compare with a mesh computed from scratch, and check its promises. */
static bool is_right(const struct mesh *mesh, const struct border *border, enum mesh_kind kind)
{
    OWNED(mesh_release) struct mesh whole = {0};
    CHECK(mesh_update(&whole, border, kind, NULL, NULL, NULL) == OK);
    return CHECK(is_same_mesh(mesh, &whole)) & CHECK(holds(mesh));
}

/* ---- at random ---- */

/* An empty or full scene of several bricks and regions. */
static void stage_at_random(struct stage *s, uint64_t *random)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 1 + check_below(random, check_below(random, 4) ? 40 : 4);
    size[check_below(random, 3)] += check_below(random, 3) ? 0 : 60;
    CHECK(stage_init(s, size, 6, NULL) == OK);
    const bool is_full = check_below(random, 2);
    for (size_t i = 0; i < s->scene->grid.cells; i++)
        if (!(s->scene->cell[i].flags & CELL_RIM))
            s->scene->cell[i].label = is_full ? 1 : 0;
    for (int a = 0; a < 3; a++)
        s->scene->spacing_nm[a] =
            check_below(random, 2) ? 1000000 : 300000 + check_below(random, 3000000);
    border_recount(&s->border);
}

/* Change labels at random, without the forest: of one voxel, or of a box. Some of these lists of
 * changes come as "everything". */
static struct changes change_labels(struct stage *s, struct change *item, uint64_t *random)
{
    enum { ITEMS = 9000 };
    const struct grid *grid = &s->scene->grid;
    uint32_t from[3], end[3], count = 0;
    const bool is_box = check_below(random, 2), is_large = check_below(random, 4) == 0;
    const uint8_t label = (uint8_t)check_below(random, 4);
    random_place(&s->scene->grid, random, from);
    for (int a = 0; a < 3; a++) {
        end[a] = from[a] + 1 + (is_box ? check_below(random, is_large ? 30 : 7) : 0);
        end[a] = end[a] < grid->size[a] ? end[a] : grid->size[a];
    }
    for (uint32_t z = from[2]; z < end[2]; z++)
        for (uint32_t y = from[1]; y < end[1]; y++)
            for (uint32_t x = from[0]; x < end[0] && count < ITEMS; x++) {
                struct cell *cell = &s->scene->cell[grid_cell(grid, x, y, z)];
                if (cell->label == label)
                    continue;
                item[count++] = (struct change){grid_cell(grid, x, y, z), cell->label, label};
                cell->label = label;
            }
    return (struct changes){.everything = check_below(random, 8) == 0,
                            .item = item,
                            .count = count,
                            .listed = count,
                            .voxels = count};
}

static void change_cut_or_labels(struct stage *s, uint64_t *random)
{
    uint32_t a[3], b[3];
    struct cut *cut = &s->border.cut;
    random_place(&s->scene->grid, random, a);
    random_place(&s->scene->grid, random, b);
    switch (check_below(random, 4)) {
    case 0:
        *cut = cut_none();
        break;
    case 1:
        *cut = cut_none();
        cut->plane[cut->planes++] =
            stage_plane_through(s->scene, a,
                                (int32_t[]){(int32_t)check_below(random, 2000) - 1000,
                                            (int32_t)check_below(random, 2000) - 1000,
                                            (int32_t)check_below(random, 2000) - 1000});
        break;
    case 2:
        *cut = cut_none();
        cut->boxes = 1;
        for (int k = 0; k < 3; k++) {
            cut->box[0].first[k] = a[k] < b[k] ? a[k] : b[k];
            cut->box[0].last[k] = a[k] < b[k] ? b[k] : a[k];
        }
        break;
    default:
        s->border.visible[1 + check_below(random, 3)] = check_below(random, 2);
    }
}

/* Make several changes at once, as a command may. */
static void change_what_is_shown(struct stage *s, uint64_t *random)
{
    for (uint32_t i = 1 + check_below(random, 4); i > 0; i--)
        change_cut_or_labels(s, random);
    border_recount(&s->border);
}

static void change_opacity(struct stage *s, uint64_t *random)
{
    s->border.opacity[1 + check_below(random, 3)] =
        (uint8_t)(check_below(random, 2) ? 100 : 1 + check_below(random, 99));
}

/* Make any change that a mesh must follow, mostly edits with a note. */
static void happens(struct stage *s, enum mesh_kind *kind, uint64_t *random)
{
    static struct change item[9000];
    switch (check_below(random, 8)) {
    case 0:
        change_what_is_shown(s, random);
        break;
    case 1:
        change_opacity(s, random);
        break;
    case 2:
        *kind = (enum mesh_kind)check_below(random, 4);
        break;
    default: {
        const struct changes changes = change_labels(s, item, random);
        if (check_below(random, 5))
            border_update(&s->border, &changes);
        else
            border_recount(&s->border);
        const bool is_late = check_below(random, 9) == 0;
        if (is_late)
            border_recount(&s->border);
        mesh_note(&s->mesh, &s->border, &changes);
    }
    }
}

STORY(a_mesh_that_follows_is_the_one_from_nothing)
{
    for (unsigned number = 0; number < check_scaled(70) && check_failures == 0; number++) {
        uint64_t random = number;
        OWNED(stage_release) struct stage s;
        enum mesh_kind kind = MESH_SMOOTH;
        stage_at_random(&s, &random);
        for (int step = 0; step < 25 && check_failures == 0; step++) {
            happens(&s, &kind, &random);
            if (check_below(&random, 3) == 0)
                continue; /* several changes before the next update */
            CHECK(mesh_update(&s.mesh, &s.border, kind, NULL, NULL, NULL) == OK);
            if (!is_right(&s.mesh, &s.border, kind))
                printf("# number %u step %d kind %d\n", number, step, (int)kind);
        }
    }
}

/* The voxels of two halves of a ball change sides one after the other, without a change of shape.
 * */
STORY(a_voxel_that_is_repainted_changes_what_is_around_it)
{
    enum { SIDE = 24, MIDDLE = SIDE / 2, RADIUS = 8 };
    OWNED(stage_release) struct stage s;
    OWNED(mesh_release) struct mesh mesh = {0};
    uint64_t random = 11;
    CHECK(stage_init(&s, (uint32_t[]){SIDE, SIDE, SIDE}, 6, NULL) == OK);
    const struct grid *grid = &s.scene->grid;
    for (int32_t i = 0; i < SIDE * SIDE * SIDE; i++) {
        const int32_t x = i % SIDE - MIDDLE, y = i / SIDE % SIDE - MIDDLE,
                      z = i / SIDE / SIDE - MIDDLE;
        const uint32_t cell =
            grid_cell(grid, (uint32_t)(x + MIDDLE), (uint32_t)(y + MIDDLE), (uint32_t)(z + MIDDLE));
        if (x * x + y * y + z * z < RADIUS * RADIUS)
            s.scene->cell[cell].label = x + y > 0 ? 1 : 2;
    }
    border_recount(&s.border);
    CHECK(mesh_update(&mesh, &s.border, MESH_SMOOTH, NULL, NULL, NULL) == OK);
    for (int round = 0; round < 150;) {
        uint32_t p[3];
        random_place(&s.scene->grid, &random, p);
        const uint32_t cell = grid_cell(grid, p[0], p[1], p[2]);
        const uint8_t label = s.scene->cell[cell].label, next = (uint8_t)(3 - label);
        if (!label || (!border_holds(&s.border, cell) && check_below(&random, 8)))
            continue;
        struct change change = {cell, label, next};
        const struct changes changes = {.item = &change, .count = 1, .listed = 1, .voxels = 1};
        s.scene->cell[cell].label = next;
        border_update(&s.border, &changes);
        mesh_note(&mesh, &s.border, &changes);
        CHECK(mesh_update(&mesh, &s.border, MESH_SMOOTH, NULL, NULL, NULL) == OK);
        if (!is_right(&mesh, &s.border, MESH_SMOOTH))
            break;
        round++;
    }
}

/* No voxel becomes visible or hidden, and yet a face is no longer closed. */
STORY(what_was_cut_away_and_is_hidden_now_leaves_an_open_face)
{
    OWNED(stage_release) struct stage s;
    CHECK(stage_init(&s, (uint32_t[]){24, 24, 24}, 6, NULL) == OK);
    for (uint32_t v = 0; v < s.scene->grid.voxels; v++)
        s.scene->cell[grid_cell(&s.scene->grid, v % 24, v / 24 % 24, v / 576)].label =
            v % 24 < 12 ? 1 : 2;
    s.border.cut.last[0] = 11;
    border_recount(&s.border);
    CHECK(mesh_update(&s.mesh, &s.border, MESH_SMOOTH, NULL, NULL, NULL) == OK);
    s.border.cut = cut_none();
    s.border.visible[2] = false;
    border_recount(&s.border);
    CHECK(mesh_update(&s.mesh, &s.border, MESH_SMOOTH, NULL, NULL, NULL) == OK);
    is_right(&s.mesh, &s.border, MESH_SMOOTH);
}

STORY(any_number_of_threads_makes_the_same_mesh)
{
    static const unsigned threads[] = {2, 5};
    for (int i = 0; i < 2; i++) {
        OWNED(team_drop) struct team *team = NULL;
        CHECK(team_new(&team, threads[i], NULL) == OK);
        for (unsigned number = 0; number < check_scaled(8) && check_failures == 0; number++) {
            uint64_t random = 100 + number;
            OWNED(stage_release) struct stage s;
            enum mesh_kind kind = MESH_SMOOTH;
            stage_at_random(&s, &random);
            for (int step = 0; step < 20 && check_failures == 0; step++) {
                happens(&s, &kind, &random);
                CHECK(mesh_update(&s.mesh, &s.border, kind, team, NULL, NULL) == OK);
                if (step % 4 == 3 && !is_right(&s.mesh, &s.border, kind))
                    printf("# number %u step %d, %u threads\n", number, step, threads[i]);
            }
        }
    }
}

/* Noise has the largest number of faces. */
STORY(a_mesh_keeps_little_of_what_making_it_takes)
{
    enum { SIDE = 70, TABLES = 1 << 20 };
    OWNED(stage_release) struct stage s;
    uint64_t random = 5;
    size_t bricks = 0;
    CHECK(stage_init(&s, (uint32_t[]){SIDE, SIDE, SIDE}, 6, NULL) == OK);
    for (uint32_t v = 0; v < s.scene->grid.voxels; v++)
        s.scene->cell[grid_cell(&s.scene->grid, v % SIDE, v / SIDE % SIDE, v / SIDE / SIDE)].label =
            (uint8_t)check_below(&random, 3);
    border_recount(&s.border);
    CHECK(mesh_update(&s.mesh, &s.border, MESH_SMOOTH, NULL, NULL, NULL) == OK);
    for (uint32_t i = 0; i < s.mesh.bricks; i++)
        if (s.mesh.brick[i])
            bricks += s.mesh.brick[i]->vertices * sizeof *s.mesh.brick[i]->vertex +
                      s.mesh.brick[i]->quads * sizeof *s.mesh.brick[i]->quad;
    CHECK(bricks > MESH_SCRATCH_MOST && mesh_bytes(&s.mesh) <= bricks + MESH_SCRATCH_MOST + TABLES);
}

/* ---- updates that fail ---- */

/* Copy the quads of a mesh, to check later that they are unchanged. */
static void make_copy(struct mesh *copy, const struct mesh *mesh)
{
    *copy = (struct mesh){.bricks = mesh->bricks, .border = mesh->border, .kind = mesh->kind};
    memcpy(copy->opacity, mesh->opacity, sizeof copy->opacity);
    memcpy(copy->size, mesh->size, sizeof copy->size);
    copy->brick = mem_new(mesh->bricks * sizeof *copy->brick);
    for (uint32_t i = 0; i < mesh->bricks; i++) {
        const struct mesh_brick *from = mesh->brick[i];
        if (!from)
            continue;
        struct mesh_brick *b, to = *from;
        const struct mem_part parts[] = {{&b, 1, sizeof *b},
                                         {&to.vertex, to.vertices, sizeof *to.vertex},
                                         {&to.quad, to.quads, sizeof *to.quad}};
        CHECK(mem_parts(parts, sizeof parts / sizeof *parts));
        memcpy(to.vertex, from->vertex, to.vertices * sizeof *to.vertex);
        memcpy(to.quad, from->quad, to.quads * sizeof *to.quad);
        *b = to;
        copy->brick[i] = b;
    }
}

/* A failure changes nothing, and more changes may follow before an update succeeds. */
static void fails_and_comes_right(unsigned number, bool is_stopped)
{
    uint64_t random = 1000 + number;
    OWNED(stage_release) struct stage s;
    enum mesh_kind kind = MESH_SMOOTH;
    stage_at_random(&s, &random);
    for (int i = 0; i < 3; i++)
        happens(&s, &kind, &random);
    CHECK(mesh_update(&s.mesh, &s.border, kind, NULL, NULL, NULL) == OK);
    for (size_t left = 0; left < 40 && check_failures == 0; left += 1 + left / 4) {
        OWNED(mesh_release) struct mesh copy = {0};
        struct fault fault = {0};
        int looks = (int)left;
        struct watch watch = {.context = &looks, .poll = stop_after_looks, .step = 1};
        make_copy(&copy, &s.mesh);
        happens(&s, &kind, &random);
        if (is_stopped)
            s.scene->watch = &watch;
        else
            allow_allocations(left);
        const enum err err = mesh_update(&s.mesh, &s.border, kind, NULL, NULL, &fault);
        mem_allows = NULL;
        s.scene->watch = NULL;
        CHECK(err == OK || err == (is_stopped ? ERR_CANCELLED : ERR_MEMORY));
        if (err)
            CHECK(is_same_mesh(&s.mesh, &copy) && s.mesh.kind == copy.kind &&
                  memcmp(s.mesh.opacity, copy.opacity, sizeof copy.opacity) == 0);
        else
            is_right(&s.mesh, &s.border, kind);
        if (check_below(&random, 2))
            happens(&s, &kind, &random);
        if (check_below(&random, 2)) {
            CHECK(mesh_update(&s.mesh, &s.border, kind, NULL, NULL, NULL) == OK);
            is_right(&s.mesh, &s.border, kind);
        }
    }
    CHECK(mesh_update(&s.mesh, &s.border, kind, NULL, NULL, NULL) == OK);
    if (!is_right(&s.mesh, &s.border, kind))
        printf("# number %u\n", number);
}

STORY(an_update_without_memory_or_stopped_changes_nothing_and_the_next_is_right)
{
    for (unsigned i = 0; i < 2 * check_scaled(12) && check_failures == 0; i++)
        fails_and_comes_right(i / 2, i % 2);
}

/* ---- who listens ---- */

static struct heard {
    uint32_t bricks, others;
} heard;

static void hear(void *context, const struct mesh *mesh, uint32_t number,
                 const struct mesh_brick *next)
{
    struct mesh *copy = context; /* is updated to equal the mesh */
    struct mesh from = {.bricks = 1, .brick = (struct mesh_brick *[]){(struct mesh_brick *)next}};
    struct mesh taken;
    heard.bricks++;
    heard.others += !is_same_brick(mesh->brick[number], copy->brick[number]);
    make_copy(&taken, &from);
    free(copy->brick[number]);
    copy->brick[number] = taken.brick[0];
    free(taken.brick);
}

STORY(who_listens_hears_of_every_brick_that_becomes_another)
{
    for (unsigned number = 0; number < check_scaled(10) && check_failures == 0; number++) {
        uint64_t random = 50 + number;
        OWNED(stage_release) struct stage s;
        OWNED(mesh_release) struct mesh copy;
        enum mesh_kind kind = MESH_SMOOTH;
        stage_at_random(&s, &random);
        CHECK(mesh_update(&s.mesh, &s.border, kind, NULL, NULL, NULL) == OK);
        make_copy(&copy, &s.mesh);
        heard = (struct heard){0};
        const struct mesh_listener listener = {hear, &copy};
        for (int step = 0; step < 20; step++) {
            happens(&s, &kind, &random);
            CHECK(mesh_update(&s.mesh, &s.border, kind, NULL, &listener, NULL) == OK);
            CHECK(is_same_mesh(&s.mesh, &copy));
        }
        CHECK(heard.bricks > 0 && heard.others == 0);
    }
}
