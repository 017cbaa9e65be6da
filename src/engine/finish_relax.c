#include "engine/finish_relax.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/wide.h"

/* Values side by side, which the compiler takes to pieces where the machine has no such. */
enum { LANES = 8, BYTES = 16, FEW = 8 };
typedef int32_t lanes __attribute__((vector_size(4 * LANES)));
typedef uint16_t half_lanes __attribute__((vector_size(2 * LANES)));
typedef uint8_t bytes __attribute__((vector_size(BYTES)));
typedef uint8_t few_bytes __attribute__((vector_size(FEW))); /* which labels have after the last */

/* ---- what a difference of greys lets through ---- */

/* 65536 * exp(-400 * (d / 255)^2), to the nearest; 1 from there on. */
static const uint32_t through[] = {
    65536, 65134, 63943, 62006, 59393, 56194, 52517, 48481, 44208, 39818, 35426,
    31133, 27026, 23173, 19627, 16420, 13569, 11076, 8931,  7113,  5596,  4348,
    3338,  2531,  1895,  1402,  1024,  739,   527,   371,   258,   177,   120,
    81,    53,    35,    23,    14,    9,     6,     3,     2,
};

static uint32_t lets_through(uint8_t a, uint8_t b)
{
    const unsigned difference = a < b ? b - a : a - b;
    return difference < sizeof through / sizeof through[0] ? through[difference] : 1;
}

void relax_find_greys(struct relax_greys *greys, const struct scene *scene, struct team *team)
{
    static uint32_t count[UINT16_MAX + 1];
    int32_t range[2];
    intensities_count(count, scene, team);
    intensities_range(range, count, 1, 999);
    const int64_t low = range[0], high = range[1] > low ? range[1] : low + 1;
    for (int64_t i = 0; i <= UINT16_MAX; i++) {
        const int64_t grey = (2 * (i - low) * 255 + high - low) / (2 * (high - low));
        greys->of[i] = (uint8_t)(i <= low ? 0 : grey < 255 ? grey : 255);
    }
}

/* ---- the band ---- */

/* What a field is made from, by a thread team. */
struct making {
    struct relax_field *field;
    const uint8_t *label;
    const struct relax_greys *greys;
    struct team *team;
    uint8_t which;
};

enum { NOT_YET = 100 }; /* steps: of voxels that no way has come to; far more than RELAX_REACH */

/* Stored bytes of a row of `far`. */
static size_t far_length(const struct relax_field *f)
{
    return ((size_t)f->size[0] + BYTES - 1) / BYTES * BYTES;
}

static uint8_t *far_row(const struct relax_field *f, uint32_t y, uint32_t z)
{
    return f->far + ((size_t)z * f->size[1] + y) * far_length(f);
}

static uint32_t first_cell(const struct relax_field *f, uint32_t y, uint32_t z)
{
    return grid_cell(&f->scene->grid, f->box.first[0], f->box.first[1] + y, f->box.first[2] + z);
}

/* The row beside, or the row itself where that is at the edge of the scene. */
static const uint8_t *beside(const uint8_t *row, const struct grid *grid, int axis, uint32_t at,
                             int way)
{
    const bool is_edge = way < 0 ? at == 0 : at == grid->size[axis] - 1;
    return is_edge ? row : row + way * grid->step[axis];
}

/* One step where a neighbour by a face is on the other side, and NOT_YET elsewhere. */
static void begin_far(const struct making *m, uint32_t y, uint32_t z)
{
    const struct relax_field *f = m->field;
    const struct grid *grid = &f->scene->grid;
    const uint8_t *row = m->label + first_cell(f, y, z);
    const uint8_t *near[6] = {row - 1, row + 1};
    uint8_t *far = far_row(f, y, z);
    near[2] = beside(row, grid, 1, f->box.first[1] + y, -1);
    near[3] = beside(row, grid, 1, f->box.first[1] + y, 1);
    near[4] = beside(row, grid, 2, f->box.first[2] + z, -1);
    near[5] = beside(row, grid, 2, f->box.first[2] + z, 1);
    for (uint32_t x = 0; x < f->size[0]; x += FEW) {
        few_bytes own, other, differs = {0};
        memcpy(&own, row + x, sizeof own);
        for (int i = 0; i < 6; i++) {
            memcpy(&other, near[i] + x, sizeof other);
            differs |= (few_bytes)(other == m->which) ^ (few_bytes)(own == m->which);
        }
        differs = (differs & 1) | (~differs & NOT_YET);
        memcpy(far + x, &differs, sizeof differs);
    }
    for (int end = 0; end < 2; end++) { /* what lies beyond the scene is no other side */
        const uint32_t x = end ? f->size[0] - 1 : 0, at = f->box.first[0] + x;
        const bool is_beyond[6] = {at == 0, at + 1 == grid->size[0]};
        bool differs = false;
        for (int i = 0; i < 6; i++)
            differs |= !is_beyond[i] && (near[i][x] == m->which) != (row[x] == m->which);
        far[x] = differs ? 1 : NOT_YET;
    }
}

WIDE static void spread_to_row(uint8_t *far, const uint8_t *from, size_t length)
{
    for (size_t x = 0; x < length; x += BYTES) {
        bytes own, other;
        memcpy(&own, far + x, sizeof own);
        memcpy(&other, from + x, sizeof other);
        other += 1;
        const bytes nearer = (bytes)(other < own);
        own = (other & nearer) | (own & ~nearer);
        memcpy(far + x, &own, sizeof own);
    }
}

/* There and back through rows that are so many bytes apart, along y or z. */
static void spread_across(const struct relax_field *f, uint8_t *first, uint32_t rows, size_t apart)
{
    const size_t length = far_length(f);
    for (uint32_t i = 1; i < rows; i++)
        spread_to_row(first + i * apart, first + (i - 1) * apart, length);
    for (uint32_t i = rows - 1; i > 0; i--)
        spread_to_row(first + (i - 1) * apart, first + i * apart, length);
}

/* ---- values and weights ---- */

static size_t stored_row(const struct relax_field *f, uint32_t y, uint32_t z)
{
    return ((size_t)z + 1) * (f->size[1] + 2) + y + 1;
}

/* The parity of the voxel at x = 0 of a row of the box. */
static unsigned parity_of(const struct relax_field *f, uint32_t y, uint32_t z)
{
    return (f->box.first[0] + f->box.first[1] + f->box.first[2] + y + z) & 1;
}

static size_t stored_at(const struct relax_field *f, size_t row, uint32_t x)
{
    return row * f->length + 1 + x / 2;
}

int32_t relax_value(const struct relax_field *f, uint32_t x, uint32_t y, uint32_t z)
{
    return f->u[(parity_of(f, y, z) + x) & 1][stored_at(f, stored_row(f, y, z), x)];
}

/* False for a voxel that stays. */
static bool find_weights(uint16_t w[6], const struct making *m, uint32_t at)
{
    const struct scene *scene = m->field->scene;
    const ptrdiff_t *step = scene->grid.step;
    const ptrdiff_t way[6] = {-step[2], -step[1], -step[0], step[0], step[1], step[2]};
    const struct cell *cell = scene->cell + at;
    uint32_t through_face[6], sum = 0;
    if (cell->flags & (CELL_SEED | CELL_OUTSIDE))
        return false;
    for (int i = 0; i < 6; i++) {
        const struct cell *other = cell + way[i];
        through_face[i] =
            other->flags & (CELL_RIM | CELL_OUTSIDE)
                ? 0
                : lets_through(m->greys->of[cell->intensity], m->greys->of[other->intensity]);
        sum += through_face[i];
    }
    if (sum == 0)
        return false;
    const uint64_t each = (UINT64_C(1536) << 32) / sum;
    for (int i = 0; i < 6; i++)
        w[i] = (uint16_t)(through_face[i] * each >> 32);
    return true;
}

static void fill_row(const struct making *m, uint32_t y, uint32_t z)
{
    struct relax_field *f = m->field;
    const uint32_t cell = first_cell(f, y, z);
    const uint8_t *far = far_row(f, y, z);
    const size_t row = stored_row(f, y, z);
    const unsigned parity = parity_of(f, y, z);
    for (uint32_t x = 0; x < f->size[0]; x++) {
        const unsigned colour = (parity + x) & 1;
        const size_t at = stored_at(f, row, x);
        uint16_t w[6];
        if (m->label[cell + x] == m->which)
            f->u[colour][at] = RELAX_ONE;
        if (far[x] > RELAX_REACH || !find_weights(w, m, cell + x))
            continue;
        struct span *part = &f->part[colour][row];
        for (int i = 0; i < 6; i++)
            f->w[colour][i][at] = w[i];
        if (part->first == part->end)
            part->first = (uint32_t)(at - row * f->length);
        part->end = (uint32_t)(at - row * f->length) + 1;
        f->moving[z + 1]++;
    }
}

static void make_part(void *context, unsigned worker)
{
    const struct making *m = context;
    const struct relax_field *f = m->field;
    const struct share planes = team_share(m->team, worker, f->size[2]);
    const struct share rows = team_share(m->team, worker, f->size[1]);
    const size_t length = far_length(f);
    struct task task = task_begin_part(f->scene->watch, "relaxed labels", 0, worker);
    bool goes_on = true;
    for (size_t z = planes.first; z < planes.end; z++) {
        for (uint32_t y = 0; y < f->size[1] && goes_on; y++) {
            begin_far(m, y, (uint32_t)z);
            const uint32_t width = f->size[0];
            uint8_t *far = far_row(f, y, (uint32_t)z);
            for (uint32_t x = 1; x < width; x++)
                far[x] = far[x] > far[x - 1] + 1 ? (uint8_t)(far[x - 1] + 1) : far[x];
            for (uint32_t x = width - 1; x > 0; x--)
                far[x - 1] = far[x - 1] > far[x] + 1 ? (uint8_t)(far[x] + 1) : far[x - 1];
            goes_on = task_advance(&task, f->size[0]);
        }
        if (goes_on)
            spread_across(f, far_row(f, 0, (uint32_t)z), f->size[1], length);
    }
    team_wait(m->team);
    for (size_t y = rows.first; y < rows.end && goes_on; y++) {
        spread_across(f, far_row(f, (uint32_t)y, 0), f->size[2], length * f->size[1]);
        goes_on = task_advance(&task, length * f->size[2] / 4);
    }
    team_wait(m->team);
    for (size_t z = planes.first; z < planes.end; z++)
        for (uint32_t y = 0; y < f->size[1] && goes_on; y++) {
            fill_row(m, y, (uint32_t)z);
            goes_on = task_advance(&task, 4 * (uint64_t)f->size[0]);
        }
}

/* ---- made and released ---- */

/* Where the field of a label lies that lies there: RELAX_REACH further, within the scene. */
static struct finish_box box_around(const struct grid *grid, const struct finish_box *label)
{
    struct finish_box box;
    for (int a = 0; a < 3; a++) {
        const uint32_t first = label->first[a], last = label->last[a], end = grid->size[a] - 1;
        box.first[a] = first > RELAX_REACH ? first - RELAX_REACH : 0;
        box.last[a] = end - last > RELAX_REACH ? last + RELAX_REACH : end;
    }
    return box;
}

enum err relax_field_init(struct relax_field *field, const struct finish_work *work, uint8_t which,
                          const struct finish_box *around, const struct relax_greys *greys,
                          struct fault *fault)
{
    struct making making = {field, work->label, greys, work->team, which};
    *field =
        (struct relax_field){.scene = work->scene, .box = box_around(&work->scene->grid, around)};
    for (int a = 0; a < 3; a++)
        field->size[a] = field->box.last[a] - field->box.first[a] + 1;
    /* A stored row ends with room for a whole step of lanes. */
    const size_t rows = ((size_t)field->size[1] + 2) * ((size_t)field->size[2] + 2);
    field->length = field->size[0] / 2 + 2 + LANES;
    field->cells = rows * field->length;
    field->far = mem_pages(far_length(field) * field->size[1] * field->size[2]);
    field->moving = mem_new(((size_t)field->size[2] + 1) * sizeof *field->moving);
    bool fits = field->far && field->moving;
    for (int colour = 0; colour < 2; colour++) {
        field->part[colour] = mem_new(rows * sizeof *field->part[colour]);
        field->u[colour] = mem_pages(field->cells * sizeof *field->u[colour]);
        fits = fits && field->part[colour] && field->u[colour];
        for (int i = 0; i < 6; i++) {
            field->w[colour][i] = mem_pages(field->cells * sizeof *field->w[colour][i]);
            fits = fits && field->w[colour][i];
        }
    }
    if (!fits) {
        relax_field_release(field);
        return fault_memory(fault, "relaxed labels");
    }
    team_run(work->team, make_part, &making);
    for (uint32_t z = 0; z < field->size[2]; z++)
        field->moving[z + 1] += field->moving[z];
    return OK;
}

void relax_field_release(struct relax_field *f)
{
    mem_pages_free(f->far, far_length(f) * f->size[1] * f->size[2]);
    for (int colour = 0; colour < 2; colour++) {
        free(f->part[colour]);
        mem_pages_free(f->u[colour], f->cells * sizeof *f->u[colour]);
        for (int i = 0; i < 6; i++)
            mem_pages_free(f->w[colour][i], f->cells * sizeof *f->w[colour][i]);
    }
    free(f->moving);
    *f = (struct relax_field){0};
}

/* ---- sweeps ---- */

/* A row's part from `u` on, of which near[i] and w[i] are neighbours and weights. Values and
 * weights are such that no sum leaves 32 bits: 1536 * RELAX_ONE < 2^31. */
WIDE static void move_part(int32_t *u, const int32_t *const near[6], const uint16_t *const w[6],
                           size_t count)
{
    for (size_t at = 0; at < count; at += LANES) {
        lanes own, sum = {0};
        memcpy(&own, u + at, sizeof own);
        for (int i = 0; i < 6; i++) {
            lanes other;
            half_lanes weight;
            memcpy(&other, near[i] + at, sizeof other);
            memcpy(&weight, w[i] + at, sizeof weight);
            sum += __builtin_convertvector(weight, lanes) * (other - own);
        }
        own += (sum + 511 + (sum >> 10 & 1)) >> 10;
        own &= own > 0;
        const lanes over = own > RELAX_ONE;
        own = (own & ~over) | (RELAX_ONE & over);
        memcpy(u + at, &own, sizeof own);
    }
}

static uint64_t move_row(struct relax_field *f, unsigned colour, uint32_t y, uint32_t z)
{
    const size_t row = stored_row(f, y, z), base = row * f->length;
    const struct span *part = &f->part[colour][row];
    const bool is_even = parity_of(f, y, z) == colour; /* its voxels have an even x in the box */
    const int32_t *other = f->u[!colour] + base + part->first;
    const ptrdiff_t length = (ptrdiff_t)f->length, plane = length * (ptrdiff_t)(f->size[1] + 2);
    const int32_t *const near[6] = {other - plane,       other - length, other - is_even,
                                    other - is_even + 1, other + length, other + plane};
    const uint16_t *w[6];
    for (int i = 0; i < 6; i++)
        w[i] = f->w[colour][i] + base + part->first;
    move_part(f->u[colour] + base + part->first, near, w, part->end - part->first);
    return part->end - part->first;
}

/*
 * Half-sweeps are done several at a time, so that what moves is still in the cache: half-sweep h of
 * a plane follows once h - 1 is done in the planes beside it, and h + 1 is in none of them. Each
 * worker has a slab of planes. First it does what needs its slab alone, which is a plane less at
 * both ends with each half-sweep; then, when all have done so, what is left around its last plane.
 */
enum { HALVES_AT_ONCE = 16 };

struct sweeping {
    struct relax_field *field;
    struct team *team;
    uint32_t first, end, halves; /* of so many half-sweeps */
    uint32_t slabs, slab[TEAM_MOST + 1];
};

/* Slabs of about as much that moves, with room for `halves` at both ends of each. */
static void divide(struct sweeping *s, uint32_t halves)
{
    const struct relax_field *f = s->field;
    const uint32_t planes = f->size[2], least = 2 * halves, workers = team_size(s->team);
    const uint64_t all = f->moving[planes];
    s->slabs = planes / least < workers ? planes / least : workers;
    s->slabs = s->slabs ? s->slabs : 1;
    for (uint32_t i = 1, z = 0; i < s->slabs; i++) {
        const uint32_t most = planes - least * (s->slabs - i);
        for (z += least; z < most && f->moving[z] < all * i / s->slabs;)
            z++;
        s->slab[i] = z;
    }
    s->slab[0] = 0;
    s->slab[s->slabs] = planes;
}

static bool move_plane(const struct sweeping *s, uint32_t half, uint32_t z, struct task *task)
{
    bool goes_on = true;
    for (uint32_t y = 0; y < s->field->size[1] && goes_on; y++)
        goes_on = task_advance(task, move_row(s->field, half & 1, y, z));
    return goes_on;
}

static bool sweep_slab(const struct sweeping *s, unsigned worker, struct task *task)
{
    const uint32_t first = s->slab[worker], end = s->slab[worker + 1], count = s->end - s->first;
    const bool is_low = first == 0, is_high = end == s->field->size[2]; /* no slab is beside */
    bool goes_on = true;
    for (uint32_t at = first; at < end + count && goes_on; at++)
        for (uint32_t h = 0; h < count && goes_on; h++)
            if (at >= first + (is_low ? h : 2 * h) && at < (is_high ? end + h : end))
                goes_on = move_plane(s, s->first + h, at - h, task);
    return goes_on;
}

static void sweep_between(const struct sweeping *s, uint32_t end, struct task *task)
{
    bool goes_on = true;
    for (uint32_t h = 1; h < s->end - s->first && goes_on; h++)
        for (uint32_t z = end - h; z < end + h && goes_on; z++)
            goes_on = move_plane(s, s->first + h, z, task);
}

static void sweep_part(void *context, unsigned worker)
{
    const struct sweeping *s = context;
    const size_t *moving = s->field->moving;
    const bool has_slab = worker < s->slabs;
    const uint64_t each =
        has_slab ? moving[s->slab[worker + 1]] - moving[s->slab[worker]] : 0; /* in a sweep */
    struct task task =
        task_begin_part(s->field->scene->watch, "relaxed labels", s->halves * each / 2, worker);
    task.done = s->first * each / 2;
    const bool goes_on = has_slab && sweep_slab(s, worker, &task);
    team_wait(s->team);
    if (goes_on && worker + 1 < s->slabs)
        sweep_between(s, s->slab[worker + 1], &task);
}

void relax_field_sweep(struct relax_field *field, uint32_t sweeps, struct team *team)
{
    struct watch *watch = field->scene->watch;
    struct sweeping sweeping = {.field = field, .team = team, .halves = 2 * sweeps};
    const uint32_t fit = field->size[2] / (2 * team_size(team));
    const uint32_t most = fit < HALVES_AT_ONCE ? fit : HALVES_AT_ONCE;
    const uint32_t halves = most < 1 ? 1 : most;
    divide(&sweeping, halves);
    for (; sweeping.first < sweeping.halves; sweeping.first = sweeping.end) {
        const uint32_t left = sweeping.halves - sweeping.first;
        sweeping.end = sweeping.first + (left < halves ? left : halves);
        team_run(team, sweep_part, &sweeping);
        if (watch_wants_show(watch) && !watch->ignores_stop)
            watch_show(watch);
    }
}

/* ---- the step ---- */

struct relaxing {
    struct finish_work *work;
    const struct finish_step *step;
    struct relax_greys greys;
    struct finish_box box[256]; /* where labels lie, */
    struct finish_box all;      /* and where their fields do */
    struct relax_field field;   /* of the label at hand */
    uint8_t label;
    size_t voxels;  /* of `all`, of each of which: */
    uint32_t *best; /* the greatest rank; 0 where no band has come to */
    int32_t *sum;   /* of all fields */
};

/* What is compared: the value; then whether it is the voxel's own label; then the smaller label. */
static uint32_t rank_of(int32_t value, bool is_own, uint8_t label)
{
    return (uint32_t)value << 9 | (uint32_t)is_own << 8 | (255u - label);
}

/* A voxel of `all` among its voxels. */
static size_t place_in_all(const struct relaxing *r, uint32_t x, uint32_t y, uint32_t z)
{
    const struct finish_box *b = &r->all;
    const size_t row = (size_t)(z - b->first[2]) * (b->last[1] - b->first[1] + 1) + y - b->first[1];
    return row * (b->last[0] - b->first[0] + 1) + x - b->first[0];
}

static void rank_part(void *context, unsigned worker)
{
    const struct relaxing *r = context;
    const struct relax_field *f = &r->field;
    const struct share planes = team_share(r->work->team, worker, f->size[2]);
    struct task task = task_begin_part(r->work->scene->watch, "relaxed labels", 0, worker);
    for (uint32_t z = (uint32_t)planes.first; z < planes.end; z++)
        for (uint32_t y = 0; y < f->size[1] && task_advance(&task, f->size[0]); y++) {
            const uint32_t *at = f->box.first;
            const uint32_t cell = grid_cell(&f->scene->grid, at[0], at[1] + y, at[2] + z);
            const size_t place = place_in_all(r, at[0], at[1] + y, at[2] + z);
            for (uint32_t x = 0; x < f->size[0]; x++) {
                if (far_row(f, y, z)[x] > RELAX_REACH)
                    continue;
                const int32_t value = relax_value(f, x, y, z);
                const uint32_t rank =
                    rank_of(value, r->work->label[cell + x] == r->label, r->label);
                uint32_t *best = &r->best[place + x];
                *best = rank > *best ? rank : *best;
                r->sum[place + x] += value;
            }
        }
}

static void choose_part(void *context, unsigned worker)
{
    const struct relaxing *r = context;
    const struct finish_work *work = r->work;
    const struct grid *grid = &work->scene->grid;
    const uint32_t *first = r->all.first, *last = r->all.last;
    const struct slab slab = grid_slab(grid, worker, team_size(work->team));
    struct task task = task_begin_part(work->scene->watch, "relaxed labels", 0, worker);
    for (uint32_t z = slab.first; z < slab.end; z++)
        for (uint32_t y = 0; y < grid->size[1] && task_advance(&task, grid->size[0]); y++) {
            const struct span row = grid_row(grid, y, z);
            memcpy(work->next + row.first, work->label + row.first, row.end - row.first);
            if (r->voxels && y >= first[1] && y <= last[1] && z >= first[2] && z <= last[2]) {
                const uint32_t cell = row.first + first[0];
                const size_t place = place_in_all(r, first[0], y, z);
                const uint32_t count = last[0] - first[0] + 1;
                const uint8_t *label = r->work->label + cell;
                uint8_t *next = r->work->next + cell;
                for (uint32_t i = 0; i < count; i++) {
                    const uint32_t best = r->best[place + i];
                    const int32_t left = RELAX_ONE - r->sum[place + i];
                    const uint32_t rest = rank_of(left > 0 ? left : 0, label[i] == 0, 0);
                    const uint8_t wins = (uint8_t)(255 - ((rest > best ? rest : best) & 255));
                    const bool moves =
                        best && (finish_is_for(r->step, label[i]) || finish_is_for(r->step, wins));
                    next[i] = moves ? wins : label[i];
                }
            }
        }
}

/* Where fields will lie, and memory for what is known of the voxels there. */
static enum err find_all(struct relaxing *r, struct fault *fault)
{
    const enum err err = finish_find_boxes(r->box, r->work, "relaxed labels", fault);
    if (err)
        return err;
    struct finish_box labels = r->box[1];
    for (unsigned label = 2; label < 256; label++)
        finish_box_include(&labels, &r->box[label]);
    if (finish_box_is_empty(&labels))
        return OK;
    r->all = box_around(&r->work->scene->grid, &labels);
    r->voxels = place_in_all(r, r->all.last[0], r->all.last[1], r->all.last[2]) + 1;
    r->best = mem_pages(r->voxels * sizeof *r->best);
    r->sum = mem_pages(r->voxels * sizeof *r->sum);
    return r->best && r->sum ? OK : fault_memory(fault, "relaxed labels");
}

static enum err relax_label(struct relaxing *r, unsigned label, struct fault *fault)
{
    struct finish_work *work = r->work;
    r->label = (uint8_t)label;
    const enum err err =
        relax_field_init(&r->field, work, r->label, &r->box[label], &r->greys, fault);
    if (err)
        return err;
    relax_field_sweep(&r->field, r->step->argument, work->team);
    team_run(work->team, rank_part, r);
    relax_field_release(&r->field);
    return watch_fault(work->scene->watch, fault);
}

enum err finish_relax(struct finish_work *work, const struct finish_step *step, struct fault *fault)
{
    struct relaxing *r = mem_new(sizeof *r);
    if (!r)
        return fault_memory(fault, "relaxed labels");
    *r = (struct relaxing){.work = work, .step = step};
    enum err err = find_all(r, fault);
    if (!err)
        relax_find_greys(&r->greys, work->scene, work->team);
    for (unsigned label = 1; label < 256 && !err; label++)
        if (!finish_box_is_empty(&r->box[label]))
            err = relax_label(r, label, fault);
    if (!err) {
        team_run(work->team, choose_part, r);
        err = watch_fault(work->scene->watch, fault);
    }
    mem_pages_free(r->best, r->voxels * sizeof *r->best);
    mem_pages_free(r->sum, r->voxels * sizeof *r->sum);
    free(r);
    finish_take_next(work);
    return err;
}
