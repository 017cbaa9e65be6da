/* Keys that ask: how a voxel came to its label, and where labels are uncertain. */
#include "tui/pilot/pilot_press.h"

#include <string.h>

/* ---- why ---- */

static void add_key(struct press *p, const char *before, const char *row)
{
    buf_add_text(p->message, before);
    setup_add_first_key(p->message, p->state->setup, row);
}

void pilot_explain(struct press *p)
{
    struct pilot_way *way = &p->state->way;
    uint32_t place[3];
    if (!pilot_take_voxel(p, place) || !p->host->why(p->host->context, place, way, p->message))
        return;
    p->state->mode = PILOT_EXPLAINING;
    if (!way->has_edge)
        return;
    add_key(p, "; ", "to-edge");
    add_key(p, " goes there, ", "plant-there");
    buf_printf(p->message, " plants label %u there, ", way->next);
    add_key(p, "", "enclose-there");
    add_key(p, " a shell, ", "stroke-there");
    buf_add_text(p->message, " a stroke");
}

/* False, with a message, where the path has none. */
static bool has_edge(struct press *p)
{
    if (!p->state->way.has_edge)
        buf_add_text(p->message, "the cost does not rise on this path: there is no edge to go to");
    return p->state->way.has_edge;
}

void pilot_go_to_edge(struct press *p)
{
    if (has_edge(p))
        pilot_jump(p, p->state->way.edge);
}

/* As large as the brush, whose label it then is. */
void pilot_plant_at_edge(struct press *p)
{
    struct pilot_state *state = p->state;
    if (!has_edge(p))
        return;
    state->brush.label = p->by ? p->event->point - '0' : state->way.next;
    pilot_jump(p, state->way.edge);
    pilot_begin_seed(p->line, state->way.edge, &state->brush);
    buf_add_char(p->line, '\n');
    state->is_silent = false;
}

/* That of the ball around the path's seed through the edge. */
void pilot_enclose_at_edge(struct press *p)
{
    const struct pilot_way *way = &p->state->way;
    if (!has_edge(p))
        return;
    if (memcmp(way->root, way->edge, sizeof way->root) == 0 || way->label == way->next) {
        buf_add_text(p->message, "there is no shell between a voxel and itself");
        return;
    }
    pilot_jump(p, way->edge);
    pilot_add_place(p->line, "seed ", way->root);
    buf_printf(p->line, " %u shell=yes around=%u", way->next, way->label);
    pilot_add_place(p->line, " through=", way->edge);
    buf_add_char(p->line, '\n');
    p->state->is_silent = false;
}

/* One end of it; the next seed is the other. */
void pilot_stroke_at_edge(struct press *p)
{
    struct pilot_state *state = p->state;
    if (!has_edge(p))
        return;
    state->brush.label = state->way.next;
    memcpy(state->stroke.place, state->way.edge, sizeof state->stroke.place);
    state->stroke.is_set = true;
    pilot_jump(p, state->way.edge);
    buf_add_text(p->message, "one end of a stroke; a seed where the other is draws it");
}

/* ---- hints ---- */

/* Round and round. */
void pilot_go_to_hint(struct press *p)
{
    struct pilot_state *state = p->state;
    const unsigned hints = p->host->hints(p->host->context);
    if (state->count)
        state->hint = state->count;
    else if (p->by > 0)
        state->hint = state->hint < hints ? state->hint + 1 : 1;
    else
        state->hint = state->hint > 1 && state->hint <= hints + 1 ? state->hint - 1 : hints;
    state->hint = state->hint ? state->hint : 1;
    state->former.is_set = true;
    memcpy(state->former.place, p->facts->place, sizeof p->facts->place);
    buf_printf(p->line, "hint %u\n", state->hint);
}

void pilot_show_heat(struct press *p)
{
    p->state->heat = !p->state->heat;
    if (p->state->heat)
        buf_add_text(p->message, "red, where the border is least certain");
}
