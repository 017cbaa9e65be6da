/* SPDX-License-Identifier: MIT */
#include "tui/pilot/pilot_keys.h"

#include <string.h>

#include "base/mem.h"
#include "tui/cells.h"

/* Ranks of parts; the last one is left out first. */
enum rank { FIRST, CHIEF, STATE, NAME, VALUE, WORLD, SHOWN, VOLUME, CHANGE, BRUSH, REST, RANKS };

enum { PARTS_MOST = 32 };

/* A part of the row. One that begins with a blank belongs to the group of the part before, and is
 * shown only with the first part of the group. */
struct status {
    struct buf text;
    size_t count;
    struct part {
        size_t start, length, head; /* bytes in the text; the first part of its group */
        enum rank rank;
        bool is_shown;
    } part[PARTS_MOST];
};

/* Make the text added since the last part a part. */
static void end_part(struct status *s, enum rank rank)
{
    const struct part *last = s->count ? &s->part[s->count - 1] : NULL;
    const size_t start = last ? last->start + last->length : 0;
    if (s->text.length == start || s->count == PARTS_MOST)
        return;
    const bool joins = last && s->text.data[start] == ' ';
    s->part[s->count] =
        (struct part){start, s->text.length - start, joins ? last->head : s->count, rank, false};
    s->count++;
}

static void add_part(struct status *s, enum rank rank, const char *text)
{
    buf_add_text(&s->text, text);
    end_part(s, rank);
}

static void add_place(struct status *s, const struct pilot_state *state,
                      const struct pilot_facts *facts)
{
    const bool has_name = facts->plane[state->pane][1] != '\0';
    const unsigned axis = facts->axis[state->pane];
    add_part(s, FIRST, state->pen.is_down ? "PEN DOWN" : "");
    add_part(s, FIRST, pilot_outlines(state->base) ? "OUTLINE" : "");
    add_part(s, FIRST, state->base == PILOT_PICKING ? "CORRECT" : "");
    if (has_name)
        buf_add_text(&s->text, facts->plane[state->pane]);
    else /* a pane of voxels, whose axes have no names */
        buf_printf(&s->text, "%c=%u", "xyz"[axis], facts -> place[axis]);
    end_part(s, FIRST);
    if (facts->times != PILOT_TIMES_ONE) {
        buf_add_text(&s->text, " x");
        pilot_add_decimal(&s->text, facts->times / 1000.0);
        end_part(s, STATE);
    }
    buf_printf(&s->text, " at " PLACE, XYZ(facts->place));
    end_part(s, FIRST);
}

/* Add a label after these words: its number by one rank, its name by another. */
static void add_label(struct status *s, const struct pilot_host *host, const char *words,
                      uint32_t label, enum rank rank, enum rank rank_of_name)
{
    OWNED(buf_release) struct buf name = {0};
    host->label(host->context, label, &name);
    const size_t number = strcspn(buf_text(&name), " ");
    buf_printf(&s->text, "%s %.*s", words, (int)number, buf_text(&name));
    end_part(s, rank);
    add_part(s, rank_of_name, buf_text(&name) + number);
    s->text.failed |= name.failed;
}

static void add_brush(struct status *s, const struct pilot_state *state,
                      const struct pilot_host *host, const struct pilot_facts *facts)
{
    const size_t corners = state->outline.count;
    const struct pilot_brush *brush = &state->brush;
    add_label(s, host, "brush", brush->label, CHIEF, BRUSH);
    pilot_add_brush(&s->text, brush);
    end_part(s, CHIEF);
    add_part(s, CHIEF, pilot_is_exact(brush, facts) ? " exact" : facts->has_pieces ? " grows" : "");
    if (brush->limit)
        add_label(s, host, pilot_limits[brush->limit], brush->limit_label, STATE, STATE);
    add_part(s, STATE, state->stroke.is_set ? " stroke" : "");
    if (corners)
        buf_printf(&s->text, " %zu corner%s", corners, corners == 1 ? "" : "s");
    end_part(s, STATE);
}

static void add_known(struct status *s, const struct pilot_facts *facts)
{
    static const enum rank rank[PILOT_KNOWN] = {
        [PILOT_HERE] = CHIEF,     [PILOT_NAME] = NAME, [PILOT_VOLUME] = VOLUME,
        [PILOT_CHANGE] = CHANGE,  [PILOT_MM] = WORLD,  [PILOT_INTENSITY] = VALUE,
        [PILOT_IN_FOREST] = REST, [PILOT_SUMS] = REST};
    if (facts->waiting)
        buf_printf(&s->text, "%zu wait%s for space", facts->waiting,
                   facts->waiting == 1 ? "s" : "");
    end_part(s, STATE);
    if (facts->shows != PILOT_FOREST)
        add_part(s, facts->shows == PILOT_ROUGH ? STATE : SHOWN,
                 facts->shows == PILOT_ROUGH ? "finishing" : "finished");
    for (enum pilot_known i = PILOT_HERE; i < PILOT_KNOWN; i++)
        add_part(s, rank[i], facts->known[i]);
}

/* Return the width of the gap before a part: two blanks between groups. */
static size_t gap_before(const struct status *s, const struct part *part)
{
    return part > s->part && s->part + part->head == part ? 2 : 0;
}

/* Choose the parts that fit, by rank. */
static void choose(struct status *s, unsigned columns)
{
    size_t used = 0;
    for (enum rank rank = FIRST; rank < RANKS; rank++)
        for (struct part *p = s->part; p < s->part + s->count; p++) {
            const size_t cells =
                gap_before(s, p) + cells_width(buf_text(&s->text) + p->start, p->length);
            const bool is_led = s->part + p->head == p || s->part[p->head].is_shown;
            if (p->rank != rank || !is_led || (used > 0 && used + cells > columns))
                continue;
            p->is_shown = true;
            used += cells;
        }
}

void pilot_add_status(struct buf *out, const struct pilot_state *state,
                      const struct pilot_host *host, const struct pilot_facts *facts,
                      unsigned columns)
{
    struct status s = {.count = 0};
    add_place(&s, state, facts);
    add_brush(&s, state, host, facts);
    add_known(&s, facts);
    if (state->sends_ahead)
        add_part(&s, VOLUME, ">");
    choose(&s, columns);
    for (const struct part *p = s.part; p < s.part + s.count; p++)
        if (p->is_shown) {
            buf_printf(out, "%*s", (int)gap_before(&s, p), "");
            buf_add(out, buf_text(&s.text) + p->start, p->length);
        }
    out->failed |= s.text.failed;
    buf_release(&s.text);
}
