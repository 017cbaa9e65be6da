/* What is said of seeds that end within a distance (`seed within=`). */
#include "command/act.h"

void act_write_reach(struct buf *out, const struct session *session, uint32_t seed)
{
    const struct reach *reach = forest_reach(session_forest(session), seed);
    if (!reach)
        return;
    if (reach->unit[0] == 1)
        buf_printf(out, ", within %lld voxel%s of ", (long long)reach->radius,
                   plural((uint64_t)reach->radius));
    else
        buf_printf(out, ", within %g mm of ", (double)reach->radius / 1e6);
    buf_printf(out, "%u,%u,%u", reach->centre[0], reach->centre[1], reach->centre[2]);
}

void act_write_refusal(struct buf *out, const struct session *session, uint32_t cell)
{
    const struct scene *scene = session_scene(session);
    const uint64_t refused = forest_refused_offer(session_forest(session), cell);
    if (refused >= scene->cell[cell].key)
        return;
    const uint32_t root = key_root(refused);
    const struct place p = grid_place(&scene->grid, root);
    buf_printf(out, "it lies beyond the seed at %u,%u,%u", p.x, p.y, p.z);
    act_write_reach(out, session, root);
    buf_add_text(out, ", of label ");
    label_report_write_name(out, session, scene->cell[root].label);
    buf_printf(out, ", which would take it at a cost of %u\n", key_cost(refused));
}

enum err act_write_reaches(const struct act *act)
{
    const struct forest *forest = session_forest(act->session);
    const size_t seeds = forest_limited_seeds(forest);
    struct buf *out = &act->reply->text;
    size_t voxels;
    if (seeds == 0)
        return OK;
    const enum err err = forest_count_refused(forest, &voxels, act->fault);
    buf_printf(out, "reach     %zu seed%s with `within`; ", seeds, plural(seeds));
    if (voxels)
        buf_printf(out, "%zu voxel%s without a tree, since all around end before\n", voxels,
                   plural(voxels));
    else
        buf_add_text(out, "no voxel is left without a tree by it\n");
    return err;
}
