#include "render/passage.h"

/* Once the ray has been in a cube that is not solid for the label. */
static void begin_again(const struct passage *p, struct run *run)
{
    const int64_t inside = run->until + refine_width(p->refiner) / 4;
    run->is_found = false;
    run->has_layer = true;
    run->layer = run->until;
    run->left = run->at > inside ? run->at : inside;
}

/* Whether a surface is further than a gap from where the ray has left the same label. That is
 * looked for where it may matter alone. */
static bool is_layer(struct passage *p, const struct run *run, uint8_t label, int64_t depth)
{
    const int64_t voxel = refine_width(p->refiner), gap = LAYERS_GAP * voxel + voxel / 2;
    if (!run->has_layer || depth > run->left + REFINE_END * voxel + gap)
        return true;
    return depth > run->layer + gap &&
           depth > refine_end(p->refiner, label, p->x, p->y, run->left) + gap;
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
        *run = (struct run){.until = INT64_MIN};
    else if (run->last + 1 < p->cube && run->is_found && run->until < walk->at)
        begin_again(p, run);
    run->last = p->cube;
    run->at = walk->at;
    if (run->is_found || walk->at <= run->until)
        return;
    int64_t depth = walk->at;
    uint32_t cell = walk->cell;
    run->is_found = refine_label(p->refiner, label, p->x, p->y, &depth, &cell);
    run->until = depth;
    if (run->is_found && is_layer(p, run, label, depth))
        put(p, label, depth, cell);
}

static void come_to_all(struct passage *p, const struct walk *walk)
{
    const struct solid solid = refine_solid(p->refiner, walk->cell);
    for (int i = 0; i < solid.labels; i++)
        come_to(p, walk, solid.label[i]);
}

/* What the ray has come through without an edge was all of one label, if that of anything. */
static void come_from(struct passage *p, const struct walk *walk)
{
    const struct border *border = p->refiner->border;
    const uint32_t before = walk->cell + (uint32_t)p->refiner->camera->toward[walk->at & 3];
    if (!border_shows(border, before))
        return;
    struct run *run = &p->run[seams_label(p->refiner->seams, before)];
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
