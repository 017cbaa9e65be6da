/* Commands that only answer: nothing changes, nothing is recorded. */
#include "command/act.h"

#include <string.h>

#include "base/choice.h"
#include "engine/rival.h"
#include "engine/roi.h"
#include "engine/way.h"
#include "journal/journal.h"
#include "session/map.h"
#include "session/semantics.h"
#include "show/decorating.h"
#include "show/export_picture.h"
#include "report/histogram.h"

enum { RISES_MOST = 8 }; /* places where the cost rose that `why` lists */

void act_write_spacing(struct buf *out, const struct session *session)
{
    const uint32_t *nm = session_scene(session)->spacing_nm;
    if (session_geometry(session)->spacing_unknown)
        buf_add_text(out, " of unknown size");
    else
        buf_printf(out, " of %gx%gx%g mm", nm[0] / 1e6, nm[1] / 1e6, nm[2] / 1e6);
}

void act_write_axes(struct buf *out, const struct geometry *geometry)
{
    char towards[4];
    geometry_axes(towards, geometry);
    if (geometry->orientation == ORIENTATION_UNKNOWN)
        buf_add_text(out, "orientation unknown");
    else
        buf_printf(out, "axes towards %s%s", towards,
                   geometry->orientation == ORIENTATION_TOLD ? " as told by the user" : "");
}

void act_write_waiting(const struct act *act)
{
    const size_t waits = session_pendings(act->session);
    if (waits == 1)
        buf_add_text(&act->reply->text, "without the edit that waits for `run`\n");
    else if (waits > 1)
        buf_printf(&act->reply->text, "without the %zu edits that wait for `run`\n", waits);
}

void act_write_no_seeds(const struct act *act)
{
    if (!forest_seeds(session_forest(act->session)))
        buf_add_text(&act->reply->text, "no seed is planted: no voxel has a label\n");
}

/* The weight of the voxel; where weights are those of steps, of the step from its predecessor. */
static void write_voxel_weight(struct buf *out, const struct session *session,
                               const struct cell *cell)
{
    const struct arc_rule *arcs = forest_arcs(session_forest(session));
    if (arcs->kind == ARC_TARGET) {
        buf_printf(out, "weight %u, ", cell->weight);
        return;
    }
    const struct cell *cells = session_scene(session)->cell;
    const uint32_t before = cell_is_reached(cell) ? forest_predecessor(session_forest(session),
                                                                       (uint32_t)(cell - cells))
                                                  : CELL_NONE;
    if (before != CELL_NONE)
        buf_printf(out, "a step of weight %u, ", arc_weight_now(arcs, cells + before, cell));
}

void act_write_voxel(struct buf *out, const struct session *session, uint32_t at)
{
    const struct grid *grid = &session_scene(session)->grid;
    const struct cell *cell = session_scene(session)->cell + at;
    struct place p = grid_place(grid, at);
    double mm[3];
    geometry_point(session_geometry(session), (const uint32_t[]){p.x, p.y, p.z}, mm);
    buf_printf(out, "voxel %u,%u,%u", p.x, p.y, p.z);
    if (geometry_has_place(session_geometry(session)))
        buf_printf(out, " at %.1f,%.1f,%.1f mm", mm[0], mm[1], mm[2]);
    buf_add_text(out, ": intensity ");
    levels_write(out, session_geometry(session), session_levels(session), cell->intensity);
    buf_add_text(out, ", ");
    write_voxel_weight(out, session, cell);
    if (!cell_is_reached(cell)) {
        buf_add_text(out, cell->flags & CELL_OUTSIDE ? "outside the region of interest\n"
                                                     : "no seed reaches it\n");
        return;
    }
    struct place root = grid_place(grid, key_root(cell->key));
    buf_add_text(out, "label ");
    label_report_write_name(out, session, cell->label);
    buf_printf(out, ", of the seed at %u,%u,%u", root.x, root.y, root.z);
    act_write_reach(out, session, key_root(cell->key));
    buf_add_char(out, '\n');
}

/* Which label would take the voxel, were it not for the seeds of its own. */
static enum err write_rival(const struct act *act, uint32_t at)
{
    const struct session *session = act->session;
    struct rival rival;
    if (forest_arcs(session_forest(session))->kind == ARC_POLARITY)
        return OK;
    const enum err err = rival_find(&rival, session_forest(session), at, act->fault);
    if (err || !rival.exists)
        return err;
    buf_add_text(&act->reply->text, "next is label ");
    label_report_write_name(&act->reply->text, session, rival.label);
    if (rival.cost == key_cost(session_scene(session)->cell[at].key))
        buf_add_text(&act->reply->text, ", at the same cost\n");
    else
        buf_printf(&act->reply->text, ", at a cost of %u\n", rival.cost);
    return OK;
}

/* Where on a path the cost rises. */
static void write_rises(const struct act *act, const struct way *way)
{
    const struct session *session = act->session;
    const struct cell *cell = session_scene(session)->cell;
    size_t rises = 0;
    for (size_t i = 0; i + 1 < way->count && rises < RISES_MOST; i++) {
        const uint32_t at = way->cell[i];
        const struct place rise = grid_place(&session_scene(session)->grid, at);
        if (key_hops(cell[at].key) > 0)
            continue;
        buf_printf(&act->reply->text, "    the cost rises to %u at %u,%u,%u%s\n",
                   key_cost(cell[at].key), rise.x, rise.y, rise.z,
                   rises++ == 0 ? ": its strongest edge" : "");
    }
}

/* How a voxel came to its label: its path back to the seed, and where on it the cost rose. */
enum err act_why(const struct act *act)
{
    const struct session *session = act->session;
    const uint32_t *p = act->value[0].place;
    const uint32_t place = grid_cell(&session_scene(session)->grid, p[0], p[1], p[2]);
    const struct cell *cell = session_scene(session)->cell + place;
    struct way way = {0};
    act_write_voxel(&act->reply->text, session, place);
    act_write_refusal(&act->reply->text, session, place);
    if (!cell_is_reached(cell))
        return OK;
    buf_printf(&act->reply->text, "cost %u, %u step%s since it last rose\n", key_cost(cell->key),
               key_hops(cell->key), plural(key_hops(cell->key)));
    const enum err err = way_find(&way, session_forest(session), place, act->fault);
    if (!err) {
        write_rises(act, &way);
        buf_printf(&act->reply->text, "%zu step%s from the seed in all\n", way.count - 1,
                   plural(way.count - 1));
    }
    way_release(&way);
    return err ? err : write_rival(act, place);
}

#define UNIT_NUMBER  1.0
#define UNIT_DECIMAL 1000.0
#define PLAIN_ARGUMENT(name, type, least, most)                                                    \
    {                                                                                              \
        " ", UNIT_##type                                                                           \
    }
#define KEYED_ARGUMENT(name, type, least, most)                                                    \
    {                                                                                              \
        " " name "=", UNIT_##type                                                                  \
    }

/* "gauss 1.5", "polarity 1:50 2:-20", "of edges.nii" */
void act_write_weight(struct buf *out, const struct kept *kept)
{
    const struct weight_choice *choice = &kept->weight;
    const struct weight_row *row = &weight_table[choice->kind];
    static const struct {
        const char *before;
        double unit;
    } form[] = {WEIGHT_ARGUMENTS(PLAIN_ARGUMENT, KEYED_ARGUMENT)};
    if (choice->kind == WEIGHT_FILE) {
        buf_add_text(out, "of ");
        buf_add_safe_text(out, kept->weight_file);
        return;
    }
    buf_add_text(out, row->name);
    if (choice->argument != row->usual)
        buf_printf(out, "%s%g", form[row->takes].before, choice->argument / form[row->takes].unit);
    for (unsigned label = 0; choice->kind == WEIGHT_POLARITY && label < 256; label++)
        if (kept->polarity[label])
            buf_printf(out, " %u:%d", label, kept->polarity[label]);
}

void act_write_region(struct buf *out, const struct session *session)
{
    struct buf roi = {0};
    if (act_write_roi(&roi, session))
        buf_printf(out, "region    %s: %zu of %zu voxels inside\n", buf_text(&roi),
                   session_roi_tally(session)->inside, session_scene(session)->grid.voxels);
    buf_release(&roi);
}

/* "part      4-19,2-17,3-12 of the file's 24x20x16 voxels, the mean of each 2x2x2" */
static void write_part(struct buf *out, const struct map_part *part)
{
    const struct volume_choice *choice = &part->choice;
    const uint32_t *whole = part->whole, n = choice->reduce;
    if (!whole[0])
        return;
    buf_add_text(out, "part      ");
    for (int a = 0; a < 3 && choice->has_crop; a++)
        buf_printf(out, "%s%u-%u", a ? "," : "", choice->first[a], choice->last[a]);
    buf_printf(out, "%s of the file's %ux%ux%u voxels", choice->has_crop ? "" : "all", whole[0],
               whole[1], whole[2]);
    if (n > 1)
        buf_printf(out, ", the mean of each %ux%ux%u", n, n, n);
    buf_add_text(out, choice->straightens ? ", straightened\n" : "\n");
}

/* The scene's bytes a voxel are what README promises; the rest does not depend on its voxels, but
 * for answers, which are made when they are asked for. */
/* Of labels that are other numbers in files. */
static void write_numbers(struct buf *out, const struct kept *kept)
{
    unsigned count = 0, least = UINT16_MAX, most = 0;
    for (unsigned label = 1; label < 256; label++) {
        const unsigned number = kept->label_number[label];
        if (!number)
            continue;
        least = number < least ? number : least;
        most = number > most ? number : most;
        count++;
    }
    if (count)
        buf_printf(out, "numbers   %u label%s %u to %u in files; `stats` lists them\n", count,
                   count == 1 ? " is" : "s are", least, most);
}

static void write_memory(struct buf *out, const struct act *act)
{
    const struct session_memory parts = session_memory_parts(act->session);
    buf_printf(out, "memory    %.1f MB: scene %.1f, %.1f bytes a voxel; seeds %.1f; pictures %.1f",
               (double)session_memory(act->session) / 1e6, (double)parts.scene / 1e6,
               (double)parts.scene / (double)session_scene(act->session)->grid.voxels,
               (double)parts.seeds / 1e6, (double)parts.pictures / 1e6);
    if (parts.answers)
        buf_printf(out, "; answers %.1f", (double)parts.answers / 1e6);
    buf_printf(out, "; and %.1f MB for what can be undone\n",
               (double)history_memory(&act->interp->history) / 1e6);
}

enum err act_info(const struct act *act)
{
    struct session *session = act->session;
    struct buf *out = &act->reply->text;
    if (act->interp->journal) {
        buf_add_text(out, "journal   ");
        buf_add_safe(out, journal_path(act->interp->journal),
                     strlen(journal_path(act->interp->journal)));
        buf_printf(out, ", %zu record%s", journal_count(act->interp->journal),
                   plural(journal_count(act->interp->journal)));
        if (session_semantics(session) != SEMANTICS)
            buf_printf(out, ", semantics %u", session_semantics(session));
        buf_add_char(out, '\n');
    }
    if (!session_has_scene(session)) {
        buf_add_text(out, "no scene is open\n");
        return OK;
    }
    const enum err err = session_complete(session, act->fault);
    if (err)
        return err;
    const struct scene *scene = session_scene(session);
    buf_printf(out, "scene     %ux%ux%u voxels", scene->grid.size[0], scene->grid.size[1],
               scene->grid.size[2]);
    act_write_spacing(out, session);
    buf_add_text(out, ", ");
    act_write_axes(out, session_geometry(session));
    buf_printf(out, ", digest %016llx\n", (unsigned long long)session_scene_digest(session));
    write_part(out, session_part(session));
    buf_printf(out, "values    %g * intensity %+.*g\n", session_geometry(session)->slope,
               geometry_digits(session_geometry(session)), session_geometry(session)->intercept);
    levels_write_scale(out, session_levels(session), "          ");
    buf_printf(out, "forest    %zu seed%s, %zu edit%s waiting, adjacency %u, weight ",
               forest_seeds(session_forest(session)), plural(forest_seeds(session_forest(session))),
               session_pendings(session), plural(session_pendings(session)),
               session_kept(session)->adjacency);
    act_write_weight(out, session_kept(session));
    buf_add_char(out, '\n');
    struct histogram histogram;
    histogram_of_session(&histogram, session);
    histogram_write(out, &histogram, act->interp->has_blocks);
    act_write_region(out, session);
    const enum err counted = act_write_reaches(act);
    if (counted)
        return counted;
    act_write_finish(out, session);
    write_numbers(out, session_kept(session));
    act_write_view(out, session);
    buf_add_text(out, "look      ");
    settings_write(out, GROUP_LOOK, session_state(session));
    buf_add_char(out, '\n');
    struct buf cut = {0}, opacity = {0};
    export_opacity(&opacity, session_kept(session));
    if (opacity.length)
        buf_printf(out, "opacity   %s\n", buf_text(&opacity));
    buf_release(&opacity);
    if (act_write_cut(&cut, session))
        buf_printf(out, "cut away  %s\n", buf_text(&cut));
    buf_release(&cut);
    buf_add_text(out, "slices    ");
    act_write_slices(out, session);
    write_memory(out, act);
    return OK;
}

enum err act_help(const struct act *act)
{
    const char *about = act->value[0].given ? act->value[0].text : NULL;
    const struct command *command = about ? command_find(about) : NULL;
    if (!about || command)
        command_help(&act->reply->text, command);
    else if (act->interp->add_keys)
        act->interp->add_keys(&act->reply->text);
    else
        buf_add_text(&act->reply->text, "keys are those of the prompt: see `iftty help keys`\n");
    return OK;
}

enum err act_pilot(const struct act *act)
{
    if (!act->interp->has_pilot)
        return fault_set(act->fault, ERR_USAGE, "the pilot needs the prompt of a terminal");
    act->interp->wish = WISH_PILOT;
    return OK;
}

enum err act_quit(const struct act *act)
{
    act->interp->wish = WISH_QUIT;
    return OK;
}
