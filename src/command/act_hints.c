/* Commands about the least certain places of the border: `hints`, `hint`. */
#include "command/act.h"

#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "engine/hints.h"
#include "engine/way.h"
#include "image/geometry.h"
#include "session/session.h"
#include "session/tally.h"

/* The places of the parameters in the table. */
enum { COUNT, LABEL, REPORT, REPLACE };

enum { LISTED = 10 }; /* unless a number is given */

static struct place place_of(const struct act *act, uint32_t cell)
{
    return grid_place(&session_scene(act->session)->grid, cell);
}

/* The hints of the present forest. In a session that skims it is computed first: only a journal
 * that was edited by hand has such a record. */
static enum err find_hints(const struct act *act, const struct hint_list **hints)
{
    struct session *session = act->session;
    const enum err err = session_skims(session) ? session_catch_up(session, act->fault) : OK;
    return err ? err : session_find_hints(session, hints, NULL, act->fault);
}

/* ---- in words ---- */

static void write_size(struct buf *out, const struct session *session, uint32_t voxels)
{
    buf_printf(out, "%u voxel%s", voxels, plural(voxels));
    if (session_geometry(session)->spacing_unknown)
        return;
    buf_add_text(out, ", ");
    tally_write_volume(out, session_geometry(session), voxels);
}

/* "3  at 93,40,61: 812 voxels, 0.81 ml; label 1 brain at a cost of 12, label 0 at 12, an edge of 2
 * between them; strongest edge into 90,41,60" */
static enum err write_hint(const struct act *act, const struct hint *hint, size_t number)
{
    const struct session *session = act->session;
    const unsigned cost = key_cost(session_scene(session)->cell[hint->cell].key);
    const struct place p = place_of(act, hint->cell);
    struct buf *out = &act->reply->text;
    struct way way = {0};
    const enum err err = way_find(&way, session_forest(session), hint->cell, act->fault);
    buf_printf(out, "%zu  at %u,%u,%u: ", number, p.x, p.y, p.z);
    write_size(out, session, hint->voxels);
    buf_add_text(out, "; label ");
    label_report_write_name(out, session, hint->label);
    buf_printf(out, " at a cost of %u, label ", cost);
    label_report_write_name(out, session, hint->other);
    buf_printf(out, " at %u, an edge of %u between them", cost + hint->margin, hint->edge);
    if (!err && way.edge != CELL_NONE) {
        const struct place edge = place_of(act, way.edge);
        buf_printf(out, "; strongest edge into %u,%u,%u", edge.x, edge.y, edge.z);
    }
    buf_add_char(out, '\n');
    way_release(&way);
    return err;
}

/* ---- for programs ---- */

static enum err add_hint(struct json *json, const struct act *act, const struct hint *hint,
                         size_t number)
{
    const struct session *session = act->session;
    const unsigned cost = key_cost(session_scene(session)->cell[hint->cell].key);
    struct way way = {0};
    const enum err err = way_find(&way, session_forest(session), hint->cell, act->fault);
    const struct place p = place_of(act, hint->cell);
    json_object(json, NULL);
    json_count(json, "number", number);
    json_format(json, "place", "%u,%u,%u", p.x, p.y, p.z);
    json_count(json, "voxels", hint->voxels);
    if (!session_geometry(session)->spacing_unknown)
        json_real(json, "volume_mm3", hint->voxels * tally_voxel_mm3(session_geometry(session)), 9);
    json_count(json, "label", hint->label);
    json_count(json, "cost", cost);
    json_count(json, "next_label", hint->other);
    json_count(json, "next_cost", cost + hint->margin);
    json_count(json, "edge_between", hint->edge);
    json_fixed(json, "certainty", hint->certainty, 0);
    json_count(json, "doubt", hint->doubt);
    if (!err && way.edge != CELL_NONE) {
        const struct place edge = place_of(act, way.edge);
        json_format(json, "strongest_edge", "%u,%u,%u", edge.x, edge.y, edge.z);
    }
    json_end(json);
    way_release(&way);
    return err;
}

static bool is_wanted(const struct act *act, const struct hint *hint)
{
    const struct value *label = &act->value[LABEL];
    return !label->given || hint->label == label->number || hint->other == label->number;
}

/* All of them. */
static enum err write_report(const struct act *act, const struct hint_list *hints)
{
    struct buf text = {0};
    struct json json = {.out = &text, .lines = 2};
    enum err err = OK;
    if (!act->value[REPORT].given)
        return OK;
    json_object(&json, NULL);
    json_count(&json, "border_voxels", hints->border);
    json_count(&json, "weak_voxels", hints->weak);
    json_fixed(&json, "certainty_most", hints->limit, 0);
    json_array(&json, "hints");
    for (size_t i = 0; !err && i < hints->count; i++)
        if (is_wanted(act, hints->item + i))
            err = add_hint(&json, act, hints->item + i, i + 1);
    json_end(&json);
    json_end(&json);
    if (!err)
        err = act_write_text(act, &act->value[REPORT], &act->value[REPLACE], &text);
    buf_release(&text);
    return err;
}

/* ---- the commands ---- */

enum err act_hints(const struct act *act)
{
    const struct value *count = &act->value[COUNT], *report = &act->value[REPORT];
    const size_t most = count->given ? (size_t)count->number : LISTED;
    const struct hint_list *hints;
    struct buf *out = &act->reply->text;
    size_t wanted = 0;
    if (report->given && !file_is_named(report->text, ".json"))
        return fault_set(act->fault, ERR_USAGE,
                         "report: expected a name that ends in .json, not %s", report->text);
    enum err err = find_hints(act, &hints);
    if (!err)
        err = write_report(act, hints);
    for (size_t i = 0; !err && i < hints->count; i++) {
        if (!is_wanted(act, hints->item + i))
            continue;
        if (wanted++ < most)
            err = write_hint(act, hints->item + i, i + 1);
    }
    if (!err && !wanted)
        buf_add_text(out, hints->count ? "none at the border of that label\n"
                                       : "no labels meet: there is no border to be uncertain of\n");
    else if (!err)
        buf_printf(out, "%zu place%s in all; `hint N` leads to one\n", wanted, plural(wanted));
    return err;
}

/* Recorded as the `cross` that it comes to: no replay has to find it again. */
enum err act_hint(const struct act *act)
{
    const size_t number = (size_t)act->value[0].number;
    const struct hint_list *hints;
    enum err err = find_hints(act, &hints);
    if (err)
        return err;
    if (!hints->count)
        return fault_set(act->fault, ERR_INPUT,
                         "no labels meet: there is no border to be uncertain of; nothing has "
                         "changed");
    if (number > hints->count)
        return fault_set(act->fault, ERR_INPUT,
                         "N: expected one of the %zu places that `hints` lists, not %zu; nothing "
                         "has changed",
                         hints->count, number);
    const struct hint *hint = hints->item + number - 1;
    const struct place p = place_of(act, hint->cell);
    err = write_hint(act, hint, number);
    act_write_waiting(act);
    memcpy(act->next->outlook.slices.cross, (uint32_t[]){p.x, p.y, p.z}, 3 * sizeof(uint32_t));
    buf_clear(&act->reply->canonical);
    buf_printf(&act->reply->canonical, "cross %u,%u,%u", p.x, p.y, p.z);
    return err ? err : act_go(act);
}
