/* SPDX-License-Identifier: MIT */
/* The user's keys and windows, and shared words and moves. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "tui/pilot/pilot_keys.h"

/* ---- windows ---- */

enum err setup_window(struct pilot_setup *setup, const char *name, int64_t centre, int64_t width,
                      struct fault *fault)
{
    struct setup_window *window = setup->window;
    if (strlen(name) >= SETUP_NAME_BYTES)
        return fault_set(fault, ERR_USAGE, "expected a name of at most %d bytes, not %s",
                         SETUP_NAME_BYTES - 1, name);
    while (window < setup->window + setup->windows && strcmp(window->name, name) != 0)
        window++;
    if (window == setup->window + SETUP_WINDOWS_MOST)
        return fault_set(fault, ERR_LIMIT, "there are %d windows already, the most",
                         SETUP_WINDOWS_MOST);
    if (window == setup->window + setup->windows)
        setup->windows++;
    *window = (struct setup_window){.centre = centre, .width = width};
    snprintf(window->name, sizeof window->name, "%s", name);
    return OK;
}

/* ---- keys ---- */

const struct pilot_row *setup_row(const struct pilot_setup *setup, const char *name)
{
    for (const struct pilot_row *row = setup->table; row < setup->table + setup->rows; row++)
        if (row->name && strcmp(row->name, name) == 0)
            return row;
    return NULL;
}

const char *setup_own(const struct pilot_setup *setup, const struct pilot_row *row)
{
    const char *own = setup->keys[row - setup->table];
    return *own ? own : NULL;
}

/* Find another row to which the user has given the key, or a key that clashes with it. */
static const struct pilot_row *taken_by(const struct pilot_setup *setup,
                                        const struct pilot_row *row, const struct chord *chord)
{
    struct chord other;
    for (const struct pilot_row *r = setup->table; r < setup->table + setup->rows; r++) {
        const char *words = setup_own(setup, r);
        if (r == row || !(r->in & row->in))
            continue;
        while (words && chord_next(&words, &other))
            if (chord_clashes(&other, chord))
                return r;
    }
    return NULL;
}

enum err setup_keys(struct pilot_setup *setup, const struct pilot_row *row, const char *words,
                    struct fault *fault)
{
    const char *at = words;
    struct chord chord;
    if (strlen(words) >= SETUP_KEYS_BYTES)
        return fault_set(fault, ERR_LIMIT, "expected keys of at most %d bytes in all",
                         SETUP_KEYS_BYTES - 1);
    while (chord_next(&at, &chord)) {
        const int length = (int)chord.length;
        if (chord.key == KEY_OTHER || chord.key == KEY_PENDING)
            return fault_set(fault, ERR_USAGE, "there is no key %.*s", length, chord.word);
        if (chord.first != chord.last && !chord.leader)
            return fault_set(fault, ERR_USAGE, "%.*s: expected one key", length, chord.word);
        const struct pilot_row *by = taken_by(setup, row, &chord);
        if (by)
            return fault_set(fault, ERR_USAGE, "%.*s was given to %s", length, chord.word,
                             by->name);
    }
    snprintf(setup->keys[row - setup->table], SETUP_KEYS_BYTES, "%s", words);
    return OK;
}

void setup_add_keys(struct buf *out, const struct pilot_setup *setup, const struct pilot_row *row,
                    size_t most)
{
    const char *own = row->name ? setup_own(setup, row) : NULL, *words = own ? own : row->keys;
    const char *gap = "";
    struct chord chord;
    while (most > 0 && chord_next(&words, &chord)) {
        if (row->name && !own && taken_by(setup, row, &chord))
            continue;
        buf_printf(out, "%s%.*s", gap, (int)chord.length, chord.word);
        gap = " ";
        most--;
    }
}

void setup_say(struct buf *out, const struct pilot_setup *setup, const char *bold,
               const char *format, ...)
{
    OWNED(buf_release) struct buf words = {0};
    va_list values;
    va_start(values, format);
    buf_vprintf(&words, format, values);
    va_end(values);
    for (const char *at = buf_text(&words); *at; at++) {
        const size_t before = out->length;
        char name[32], character = '\0';
        int bytes = 0;
        sscanf(at, "{%31[a-z-]:%c}%n", name, &character, &bytes);
        if (!character)
            sscanf(at, "{%31[a-z-]}%n", name, &bytes);
        if (bytes == 0) { /* a brace of a value too */
            buf_add_char(out, *at);
            continue;
        }
        buf_add_text(out, bold);
        setup_add_keys(out, setup, setup_row(setup, name), 1);
        const char *range = out->length > before + 3 ? out->data + out->length - 3 : "";
        if (character && (strcmp(range, "a-z") == 0 || strcmp(range, "0-9") == 0)) {
            out->length -= 3;
            buf_add_char(out, character);
        }
        buf_add_text(out, *bold ? "\033[m" : "");
        at += bytes - 1;
    }
    out->failed |= words.failed;
}

bool pilot_has_label(const struct press *p, uint32_t label)
{
    uint32_t other;
    const bool exists = p->host->next_label(p->host->context, label, 0, &other);
    if (!exists)
        buf_printf(p->message, "there is no label %u; `:label %u NAME` makes it", label, label);
    return exists;
}

int64_t pilot_times(const struct press *p)
{
    enum { TIMES_MOST = 9999 };
    const uint32_t count = p->state->count;
    return !count ? 1 : count < TIMES_MOST ? count : TIMES_MOST;
}

uint32_t pilot_shifted(uint32_t at, int64_t by, uint32_t end)
{
    const int64_t to = (int64_t)at + by;
    return to < 0 ? 0 : to >= (int64_t)end ? end - 1 : (uint32_t)to;
}

/* ---- decimals ---- */

struct decimal pilot_decimal(double value)
{
    const bool is_huge = fabs(value) >= 1e12;
    if (fabs(value) < 1 || is_huge)
        return decimal_near(value, is_huge ? 17 : 6);
    return decimal_of((int64_t)(value * 1000 + (value < 0 ? -0.5 : 0.5)), 3);
}

void pilot_add_decimal(struct buf *line, double value)
{
    const struct decimal decimal = pilot_decimal(value);
    decimal_write(line, &decimal);
}

/* ---- lines ---- */

/* "2.5mm" */
void pilot_add_radius(struct buf *out, const struct pilot_brush *brush)
{
    pilot_add_decimal(out, brush->in_mm ? brush->radius / 2.0 : brush->radius);
    buf_add_text(out, brush->in_mm ? "mm" : "");
}

const char *const pilot_limits[] = {
    [BRUSH_ALL] = "", [BRUSH_OVER] = " over", [BRUSH_KEEP] = " keep"};

bool pilot_is_exact(const struct pilot_brush *brush, const struct pilot_facts *facts)
{
    return brush->growth == BRUSH_BY_PIECES ? facts->has_pieces : brush->growth == BRUSH_EXACT;
}

bool pilot_may_plant(struct press *p, bool is_ball)
{
    const struct pilot_brush *brush = &p->state->brush;
    if (!pilot_has_label(p, brush->label) ||
        (brush->limit && !pilot_has_label(p, brush->limit_label)))
        return false;
    if (!brush->limit || pilot_is_exact(brush, p->facts) || (is_ball && brush->radius))
        return true;
    pilot_say(p,
              "%s needs an exact brush ({exact}), or a single ball of radius 1 or more; nothing "
              "was planted",
              pilot_limits[brush->limit] + 1);
    return false;
}

/* " within=0 over=17" */
void pilot_add_exact(struct press *p, const struct pilot_brush *brush)
{
    if (pilot_is_exact(brush, p->facts)) {
        buf_add_text(p->line, " within=0");
        p->state->has_exact = true;
    }
    if (brush->limit)
        buf_printf(p->line, "%s=%u", pilot_limits[brush->limit], brush->limit_label);
}

/* " 2 range=80..120 within=0 over=17" */
void pilot_add_label(struct press *p, const struct pilot_brush *brush)
{
    buf_printf(p->line, " %u", brush->label);
    if (brush->has_range) {
        buf_add_text(p->line, " range=");
        interval_write(p->line, brush->range_channel, brush->range);
    }
    pilot_add_exact(p, brush);
}

void pilot_add_brush(struct buf *out, const struct pilot_brush *brush)
{
    if (brush->radius) {
        buf_add_text(out, " r");
        pilot_add_radius(out, brush);
    }
    if (brush->has_range) {
        buf_add_char(out, ' ');
        interval_write(out, brush->range_channel, brush->range);
    }
}

/* ---- the cross-hair ---- */

bool pilot_cross(struct press *p, const uint32_t place[3])
{
    if (memcmp(place, p->facts->place, sizeof p->facts->place) == 0)
        return false;
    buf_printf(p->line, "cross " PLACE "\n", XYZ(place));
    p->state->is_silent = true;
    return true;
}

void pilot_remember_place(struct press *p)
{
    p->state->former.is_set = true;
    memcpy(p->state->former.place, p->facts->place, sizeof p->facts->place);
}

void pilot_jump(struct press *p, const uint32_t place[3])
{
    if (pilot_cross(p, place))
        pilot_remember_place(p);
}

bool pilot_take_voxel(struct press *p, uint32_t place[3])
{
    const uint32_t *pixel = p->state->pixel;
    memcpy(place, p->facts->place, sizeof p->facts->place);
    if (p->state->mode != PILOT_PICKING)
        return true;
    if (!p->host->voxel_of_frame(p->host->context, pixel[0], pixel[1], place)) {
        buf_add_text(p->message, "that pixel shows no object");
        return false;
    }
    pilot_cross(p, place);
    return true;
}

bool pilot_has_edge(struct press *p)
{
    if (!p->state->way.has_edge)
        buf_add_text(p->message, "the cost does not rise on this path: there is no edge to go to");
    return p->state->way.has_edge;
}
