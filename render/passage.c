#include "render/passage.h"

/* Once the ray has been in a cube that is not solid for the label. */
static void begin_again(struct passage *p, struct run *run, uint8_t label)
{
    const int64_t voxel = refine_width(p->refiner), inside = run->until + voxel / 4;
    const int64_t end =
        refine_end(p->refiner, label, p->x, p->y, run->at > inside ? run->at : inside);
    run->is_found = false;
    run->least = (end > run->until ? end : run->until) + LAYERS_GAP * voxel + voxel / 2;
}

static void put(struct passage *p, uint8_t label, int64_t depth, uint32_t cell)
{
    const bool is_opaque = p->refiner->border->opacity[label] == BORDER_OPAQUE;
    layers_put(p->layers, (size_t)p->y * p->layers->width + p->x, depth, cell, label, is_opaque);
    if (is_opaque && depth < p->opaque)
        p->opaque = depth;
}

/* Where a ray comes to a voxel that is solid for a label. */
static void come_to(struct passage *p, const struct walk *walk, uint8_t label)
{
    struct run *run = &p->run[label];
    if (run->last < p->first)
        *run = (struct run){.until = INT64_MIN, .least = INT64_MIN};
    else if (run->last + 1 < p->cube && run->is_found && run->until < walk->at)
        begin_again(p, run, label);
    run->last = p->cube;
    run->at = walk->at;
    if (run->is_found || walk->at <= run->until)
        return;
    int64_t depth = walk->at;
    uint32_t cell = walk->cell;
    run->is_found = refine_label(p->refiner, label, p->x, p->y, &depth, &cell);
    run->until = depth;
    if (run->is_found && depth > run->least)
        put(p, label, depth, cell);
}

static void add_label(struct solid *solid, uint8_t label)
{
    for (int i = 0; i < solid->labels; i++)
        if (solid->label[i] == label)
            return;
    solid->label[solid->labels++] = label;
}

static void find_labels(struct solid *solid, const struct border *border, uint32_t cell)
{
    *solid = (struct solid){.cell = cell};
    if (border_shows(border, cell))
        add_label(solid, labels_at(&border->labels, cell));
    for (int i = 0; i < 6; i++) {
        const ptrdiff_t step = border->scene->grid.step[i / 2];
        const uint32_t beside = cell + (uint32_t)(i % 2 ? step : -step);
        if (border_shows(border, beside))
            add_label(solid, labels_at(&border->labels, beside));
    }
}

static const struct solid *solid_at(struct passage *p, uint32_t cell)
{
    struct solid *solid = &p->solid[(cell * UINT32_C(2654435769) >> 16) % PASSAGE_SOLIDS];
    if (solid->cell != cell)
        find_labels(solid, p->refiner->border, cell);
    return solid;
}

static void come_to_all(struct passage *p, const struct walk *walk)
{
    const struct solid *solid = solid_at(p, walk->cell);
    for (int i = 0; i < solid->labels; i++)
        come_to(p, walk, solid->label[i]);
}

/* What the ray has come through without an edge was all of one label, if that of anything. */
static void come_from(struct passage *p, const struct walk *walk)
{
    const struct border *border = p->refiner->border;
    const uint32_t before = walk->cell + (uint32_t)p->refiner->camera->toward[walk->at & 3];
    if (!border_shows(border, before))
        return;
    struct run *run = &p->run[labels_at(&border->labels, before)];
    run->last = p->cube - 1;
}

/* To the next voxel that is an edge, maybe this one; false where the ray leaves the scene. */
static bool go_to_edge(struct passage *p, struct walk *walk)
{
    const struct seams *seams = p->refiner->seams;
    struct walk here = *walk; /* in registers */
    bool is_within = true;
    while (is_within && !seams_is_edge(seams, here.cell)) {
        p->cube++;
        is_within = seams_is_near(seams, here.cell) ? walk_on(&here) : walk_leap(&here, &p->leap);
    }
    *walk = here;
    return is_within;
}

void passage_walk(struct passage *p, uint32_t x, uint32_t y, int64_t from)
{
    struct walk walk;
    p->x = x, p->y = y;
    p->opaque = INT64_MAX;
    p->first = p->cube += 2;
    if (!walk_begin(&walk, p->refiner->camera, 0, x, y, from))
        return;
    for (uint32_t before = p->cube; go_to_edge(p, &walk) && walk.at <= p->opaque;
         before = p->cube) {
        if (p->cube > before)
            come_from(p, &walk);
        come_to_all(p, &walk);
        p->cube++;
        if (!walk_on(&walk))
            return;
    }
}
