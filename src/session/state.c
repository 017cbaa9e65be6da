#include "session/state.h"

#include <string.h>

#include "session/semantics.h"
#include "session/setting.h"

struct state state_default(unsigned semantics)
{
    const uint32_t look = LOOK_FIRST + (uint32_t)semantics_has(semantics, MEANING_LOOK) +
                          (uint32_t)semantics_has(semantics, MEANING_PATCHES) +
                          (uint32_t)semantics_has(semantics, MEANING_SMOOTH_LAYERS);
    struct state state = {.kept = {.cut = cut_none(), .weight = {WEIGHT_MORPH, 1}},
                          .outlook = {.look.number = look, .slices = {.times = SLICE_TIMES_ONE}}};
    settings_begin(&state);
    if (look == LOOK_FIRST)
        state.outlook.background = BACKGROUND_FADE;
    palette_default(&state.kept.palette, look);
    for (int label = 1; label < 256; label++)
        state.kept.visible[label] = true;
    memset(state.kept.opacity, BORDER_OPAQUE, sizeof state.kept.opacity);
    return state;
}

void kept_show(const struct kept *kept, struct border *border)
{
    for (int label = 0; label < 256; label++)
        border->visible[label] = kept_shows(kept, label);
    memcpy(border->opacity, kept->opacity, sizeof border->opacity);
    border->cut = kept->cut;
}

/* ---- equality ---- */

/* Three that only matter while something else is so, and what is true of every member. */
enum { MADE_BY_POLARITY = 64, MADE_BY_WINDOW = 128, MADE_BY_OPACITY = 256, DIFFERS = 512 };

/* A member that is no setting, which has no padding within, and what follows from it. */
static const struct state_field {
    size_t at, bytes;
    unsigned made;
} fields[] = {
#define FIELD(member, made)                                                                        \
    {                                                                                              \
        offsetof(struct state, member), sizeof(((struct state *)NULL)->member), made               \
    }
    FIELD(kept.palette, MADE_COLOURS),
    FIELD(kept.label_name, 0),
    FIELD(kept.label_number, 0),
    FIELD(kept.visible, MADE_BORDER),
    FIELD(kept.opacity, MADE_BY_OPACITY),
    FIELD(kept.orient, MADE_CAMERA),
    FIELD(kept.cut, MADE_BORDER),
    FIELD(kept.weight, MADE_WEIGHTS),
    FIELD(kept.polarity, MADE_BY_POLARITY),
    FIELD(kept.weight_map, MADE_WEIGHTS),
    FIELD(kept.mask, MADE_ROI),
    FIELD(kept.weight_file, 0),
    FIELD(kept.mask_file, 0),
    FIELD(kept.mask_regions, 0),
    FIELD(kept.has_range, MADE_ROI),
    FIELD(kept.range, MADE_ROI),
    FIELD(kept.finish, 0),
    FIELD(outlook.view.angle, MADE_CAMERA),
    FIELD(outlook.view.zoom, MADE_CAMERA),
    FIELD(outlook.view.focus, MADE_CAMERA),
    FIELD(outlook.look.number, MADE_CAMERA),
    FIELD(outlook.slices.cross, 0),
    FIELD(outlook.slices.zoom, 0),
    FIELD(outlook.slices.times, 0),
    FIELD(outlook.slices.has_middle, 0),
    FIELD(outlook.slices.middle, 0),
    FIELD(outlook.slices.has_window, MADE_BY_WINDOW),
    FIELD(outlook.slices.window, MADE_BY_WINDOW),
    FIELD(outlook.runs_by_itself, 0),
    FIELD(outlook.shows_finished, MADE_COLOURS),
};

/* A part of a state. */
struct extent {
    size_t first, end;
};
static const struct extent of_kept = {offsetof(struct state, kept),
                                      offsetof(struct state, outlook)},
                           of_outlook = {offsetof(struct state, outlook),
                                         offsetof(struct state, lists)};

/* What follows from a member that lies in the part, where it differs. */
static unsigned compare_member(const char *a, const char *b, const struct extent *part,
                               const struct state_field *field)
{
    const size_t at = field->at - part->first;
    const bool differs = field->at >= part->first && field->at < part->end &&
                         memcmp(a + at, b + at, field->bytes) != 0;
    return differs ? DIFFERS | field->made : 0;
}

/* DIFFERS and what follows from the members that do, or 0; a and b are two of that part. */
static unsigned compare(const void *a, const void *b, const struct extent *part)
{
    unsigned made = 0;
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        made |= compare_member(a, b, part, &fields[i]);
    for (const struct command *setting = setting_table; setting->name; setting++)
        for (const struct parameter *p = setting->parameter; p->type; p++)
            made |= compare_member(a, b, part,
                                   &(struct state_field){p->sets.at, p->sets.bytes, p->sets.made});
    return made;
}

bool kept_equals(const struct kept *a, const struct kept *b)
{
    return compare(a, b, &of_kept) == 0;
}

bool outlook_equals(const struct outlook *a, const struct outlook *b)
{
    return compare(a, b, &of_outlook) == 0;
}

size_t state_bytes_compared(void)
{
    size_t bytes = 0;
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        bytes += fields[i].bytes;
    for (const struct command *setting = setting_table; setting->name; setting++)
        for (const struct parameter *p = setting->parameter; p->type; p++)
            bytes += p->sets.bytes;
    return bytes;
}

/* Whether a label is shown in renditions of one, and not in those of the other. */
static bool hides_others(const uint8_t a[256], const uint8_t b[256])
{
    for (int label = 0; label < 256; label++)
        if (!a[label] != !b[label])
            return true;
    return false;
}

/* Polarities are heeded by one weight alone; the window of slices colours what is cut open,
 * and the context. */
unsigned state_difference(const struct state *a, const struct state *b)
{
    unsigned made =
        compare(&a->kept, &b->kept, &of_kept) | compare(&a->outlook, &b->outlook, &of_outlook);
    if (made & MADE_BY_POLARITY && b->kept.weight.kind == WEIGHT_POLARITY)
        made |= MADE_WEIGHTS;
    if (made & MADE_BY_WINDOW && (!cut_is_none(&b->kept.cut) || b->outlook.context))
        made |= MADE_COLOURS;
    if (made & MADE_BY_OPACITY)
        made |= hides_others(a->kept.opacity, b->kept.opacity) ? MADE_BORDER : MADE_COLOURS;
    return made & ~(unsigned)(MADE_BY_POLARITY | MADE_BY_WINDOW | MADE_BY_OPACITY | DIFFERS);
}

/* ---- ownership ---- */

void kept_hold(const struct kept *kept)
{
    packed_hold(kept->weight_map);
    packed_hold(kept->mask);
}

void kept_release(struct kept *kept)
{
    packed_release(kept->weight_map);
    packed_release(kept->mask);
    kept->weight_map = kept->mask = NULL;
}

void state_release(struct state *state)
{
    kept_release(&state->kept);
    edit_lists_release(&state->lists);
}

void state_assign(struct state *to, const struct state *from)
{
    struct state former = *to;
    kept_hold(&from->kept);
    edit_lists_hold(&from->lists);
    *to = *from;
    state_release(&former);
}
