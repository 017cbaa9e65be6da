/* SPDX-License-Identifier: MIT */
#include "session/setting.h"

#include <string.h>

#include "base/choice.h"
#include "base/scan.h"
#include "render/decoration.h"

/* ---- the table ---- */

enum { R = COMMAND_RECORDED, S = COMMAND_NEEDS_SCENE, E = COMMAND_EDITS, C = COMMAND_CARRIED };

/* Beginning of every row, on one line. */
#define SETTING(NAME, GROUP, FLAGS) NAME, NULL, NULL, NULL, GROUP, FLAGS
#define KEYED                       .optional = true, .keyed = true

/* Descriptor of the member, its initial value, and further fields. */
#define HELD(member) ((struct state *)NULL)->member
#define SETS(member, begins, ...)                                                                  \
    .sets = {.at = offsetof(struct state, member),                                                 \
             .bytes = sizeof HELD(member),                                                         \
             .is_signed = (__typeof__(HELD(member)))-1 < 1,                                        \
             .usual = (begins),                                                                    \
             __VA_ARGS__}

const struct command setting_table[] = {
    {SETTING("adjacency", GROUP_WEIGHT, R | S | E | C),
     {{"COUNT", VALUE_CHOICE, .choices = "6|26",
       SETS(kept.adjacency, 6, .made = MADE_WEIGHTS, .as = HELD_AS_COUNT, .says = SAYS_WEIGHTS)}},
     "connect voxels by faces, or also by corners",
     "6, the default, connects voxels by faces; 26 also connects them by edges and corners.",
     "adjacency 26"},
    {SETTING("auto", GROUP_SEEDS, R),
     {{"STATE", VALUE_CHOICE, .choices = "on|off",
       SETS(outlook.runs_by_itself, 0, .made = 0, .as = HELD_AS_SWITCH, .says = SAYS_WAITING)}},
     "apply each edit at once, or when needed",
     "The default is off in scripts and on at the prompt. With off, edits remain pending until "
     "`run` or a command that needs the labels (`help run`). After `auto on`, pending edits are "
     "applied with the next edit; undo, redo and goto do not apply them.",
     "auto on"},
    {SETTING("size", GROUP_VIEW, R | S),
     {{"WIDTH", VALUE_NUMBER, .least = 1, .most = VIEW_SIDE_MOST,
       SETS(outlook.view.width, 512, .made = MADE_CAMERA)},
      {"HEIGHT", VALUE_NUMBER, .least = 1, .most = VIEW_SIDE_MOST,
       SETS(outlook.view.height, 512, .made = MADE_CAMERA)}},
     "set the size of pictures, in pixels",

     "Sets the size of renditions, slices and mosaics, 1..8192 each; the default is 512 512.",

     "size 512 512"},
    {SETTING("shade", GROUP_LOOK, R | S),
     {{"FORM", VALUE_CHOICE, .choices = SHADE_MODES,
       SETS(outlook.look.mode, SHADE_SURFACE, .made = MADE_CAMERA)},
      {"ao", VALUE_NUMBER, KEYED, .most = 100, .form = "PERCENT",
       SETS(outlook.look.ao_percent, 0, .made = MADE_CAMERA)},
      {"creases", VALUE_CHOICE, KEYED, .choices = "yes|no",
       SETS(outlook.look.creases, 0, .made = MADE_CAMERA, .as = HELD_AS_SWITCH)}},
     "draw smooth surfaces, or the faces of voxels",
     "surface, the default: draw the smooth surfaces of visible objects.\n"
     "cubes: draw voxel faces, with the normals of the surface.\n"
     "ao: ambient occlusion: darken sulci and other concave places by up to this percentage, "
     "except on translucent objects and on cut faces. The default is 0.\n"
     "creases: yes shades each object separately, so that a crease is visible where two objects "
     "touch; no, the default, draws one surface across both.",
     "shade cubes"},
    {SETTING("light", GROUP_LOOK, R | S),
     {{"YAW", VALUE_DECIMAL, .least = -VIEW_TURN / 2, .most = VIEW_TURN / 2,
       SETS(outlook.look.light[0], -25000, .made = MADE_CAMERA)},
      {"PITCH", VALUE_DECIMAL, .least = -LIGHT_PITCH_MOST, .most = LIGHT_PITCH_MOST,
       SETS(outlook.look.light[1], 30000, .made = MADE_CAMERA)}},
     "set the direction of the light, in degrees",
     "The light moves with the viewer. At 0 0 it comes from behind the viewer; YAW moves it to the "
     "right, and PITCH upwards. The default, -25 30, is over the viewer's left shoulder.",
     "light -25 30"},
    {SETTING("cue", GROUP_LOOK, R | S),
     {{"PERCENT", VALUE_NUMBER, .most = 100,
       SETS(outlook.look.cue_percent, 30, .made = MADE_CAMERA)}},
     "darken distant surfaces",
     "PERCENT is the darkening at the far end of the scene; the default is 30.",
     "cue 50"},
    {SETTING("edges", GROUP_LOOK, R | S),
     {{"STATE", VALUE_CHOICE, .choices = "on|off",
       SETS(outlook.look.edges, 0, .made = MADE_CAMERA, .as = HELD_AS_SWITCH)}},
     "draw lines at folds and occluding edges",

     "The default is off. Lines are one pixel wide, on the surface in front. They are dark at "
     "folds, and where another object, or another part of the same object, is behind or touches. "
     "In front of the background they are light, with a dark line inside.",

     "edges on"},
    {SETTING("samples", GROUP_LOOK, R | S),
     {{"COUNT", VALUE_CHOICE, .choices = "1|2|4",
       SETS(outlook.look.samples, 1, .made = MADE_CAMERA, .as = HELD_AS_COUNT)}},
     "smooth outlines by 1, 4 or 16 samples per pixel",
     "`samples 4` uses 4 x 4 samples per pixel; the default is 1. The colour of a pixel is the "
     "mean of its samples; depth, label and voxel are those of the nearest sample.",
     "samples 2"},
    {SETTING("background", GROUP_LOOK, R | S),
     {{"COLOUR", VALUE_COLOUR, .choices = BACKGROUNDS,
       SETS(outlook.background, BACKGROUND_GRADIENT, .made = 0, .as = HELD_AS_BACKGROUND)}},
     "set the background of renditions",
     "Applies to the screen and to files. gradient, the default, is from grey at the top to dark "
     "grey at the bottom.\n"
     "transparent: write alpha to .png and .tif; the background is black on the screen, in mosaics "
     "and in other formats.\n"
     ".exr files and golden images never have a background, only the objects with their alpha.",
     "background white"},
    {SETTING("decorate", GROUP_LOOK, R | S),
     {{"PART", VALUE_PARTS, .choices = DECORATIONS "|all|none",
       SETS(outlook.decorations, 0, .made = 0)}},
     "draw letters, a scale or a legend over renditions",
     "The default is `none`. Decorations are drawn over the picture on the screen, in files and in "
     "golden images. They scale with the picture, and `pick` ignores them.\n"
     "letters: the sides of the patient, R L A P S I, or the axes if the orientation is unknown.\n"
     "scale: a bar with its length in millimetres, or in voxels if the spacing is unknown.\n"
     "legend: the visible labels, with their volumes.\n"
     "seeds: the seeds whose voxels are visible, as in `overlay marks`.\n"
     "cross: the cross-hair, if its voxel is visible.",

     "decorate letters scale legend"},
    {SETTING("context", GROUP_LOOK, R | S),
     {{"WHAT", VALUE_CHOICE, .choices = CONTEXTS,
       SETS(outlook.context, CONTEXT_NONE, .made = MADE_COLOURS)}},
     "show the scene behind and around the objects",
     "The default is `none`.\n"
     "mip: draw a maximum intensity projection, without cut parts, in pixels without an object. It "
     "uses the `window` of slices; dark pixels show the background.",
     "context mip"},
    {SETTING("overlay", GROUP_SLICES, R | S),
     {{"LABELS", VALUE_CHOICE, .optional = true, .choices = SLICE_OVERLAYS,
       SETS(outlook.slices.overlay, SLICE_CONTOUR, .made = 0, .stays = true, .says = SAYS_SLICES)},
      {"cross", VALUE_CHOICE, KEYED, .choices = "on|off",
       SETS(outlook.slices.crosses, 1, .made = 0, .as = HELD_AS_SWITCH, .stays = true)},
      {"marks", VALUE_CHOICE, KEYED, .choices = "on|off",
       SETS(outlook.slices.marks, 1, .made = 0, .as = HELD_AS_SWITCH, .stays = true)},
      {"words", VALUE_CHOICE, KEYED, .choices = "on|off",
       SETS(outlook.slices.words, 1, .made = 0, .as = HELD_AS_SWITCH, .stays = true)}},
     "draw labels and marks over the grey of slices",
     "Draws no labels, a tint, or contours of the visible labels; the default is contour. cross, "
     "marks and words are on by default.\n"
     "cross: the cross-hair.\n"
     "marks: a dot for each seed in the slice, except for seeds of `labels` and seeds with four "
     "neighbours in the slice that are seeds of the same label; and an x where `remove` was "
     "applied in the last run. In the pilot, pending marks have a white rim.\n"
     "words: the title, the letters of the patient's sides, the scale bar and the grey bar.",
     "overlay tint cross=off"},
    {SETTING("finished", GROUP_KEPT, R | S),
     {{"STATE", VALUE_CHOICE, .choices = "on|off",
       SETS(outlook.shows_finished, 0, .made = MADE_COLOURS, .as = HELD_AS_SWITCH,
            .says = SAYS_FINISH)}},
     "show finished labels in pictures",
     "Finished labels are the result of the steps of `finish`. With on, slices, mosaics, "
     "renditions and the pilot show them after each edit; the pilot first shows the labels of the "
     "forest, until the finished ones are computed. Maps, surfaces and reports have finished "
     "labels with `finished=yes`; at a prompt, this setting is the default of `finished=`, and the "
     "record has the value. The default is off; a session at a terminal begins with on.",
     "finished on"},
    {.name = NULL},
};

/* ---- members ---- */

int64_t setting_get(const struct state *state, const struct setting_member *member)
{
    const char *at = (const char *)state + member->at;
    uint32_t word;
    if (member->bytes == 1)
        return *(const uint8_t *)at;
    memcpy(&word, at, sizeof word);
    return member->is_signed ? (int32_t)word : (int64_t)word;
}

void setting_put(struct state *state, const struct setting_member *member, int64_t number)
{
    char *at = (char *)state + member->at;
    const uint32_t word = (uint32_t)number;
    if (member->bytes == 1)
        *(uint8_t *)at = (uint8_t)number;
    else
        memcpy(at, &word, sizeof word);
}

struct state state_default(void)
{
    struct state state = {.kept = {.cut = cut_none(), .weight = {WEIGHT_MORPH, 1}, .percent = 100},
                          .outlook.slices.times = SLICE_TIMES_ONE};
    for (const struct command *setting = setting_table; setting->name; setting++)
        for (const struct parameter *p = setting->parameter; p->type; p++)
            setting_put(&state, &p->sets, p->sets.usual);
    palette_default(&state.kept.palette);
    for (int label = 1; label < 256; label++)
        state.kept.visible[label] = true;
    memset(state.kept.opacity, BORDER_OPAQUE, sizeof state.kept.opacity);
    return state;
}

/* ---- equality ---- */

/* Three parts that matter only under a condition, and a bit for every member. */
enum { MADE_BY_POLARITY = 64, MADE_BY_WINDOW = 128, MADE_BY_OPACITY = 256, DIFFERS = 512 };

/* A member that is no setting, without padding, and the parts that depend on it. */
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
    FIELD(kept.label_code, 0),
    FIELD(kept.label_number, 0),
    FIELD(kept.label_is_region, 0),
    FIELD(kept.visible, MADE_BORDER),
    FIELD(kept.opacity, MADE_BY_OPACITY),
    FIELD(kept.orient, MADE_CAMERA),
    FIELD(kept.cut, MADE_BORDER),
    FIELD(kept.weight, MADE_WEIGHTS),
    FIELD(kept.polarity, MADE_BY_POLARITY),
    FIELD(kept.weight_map, MADE_WEIGHTS),
    FIELD(kept.channel, MADE_CHANNELS | MADE_WEIGHTS | MADE_ROI),
    FIELD(kept.percent, MADE_CHANNELS | MADE_WEIGHTS),
    FIELD(kept.mask, MADE_ROI),
    FIELD(kept.rest, 0),
    FIELD(kept.weight_file, 0),
    FIELD(kept.mask_file, 0),
    FIELD(kept.mask_regions, 0),
    FIELD(kept.landmark, 0),
    FIELD(kept.origin, 0),
    FIELD(kept.origin_mm3, 0),
    FIELD(kept.has_range, MADE_ROI),
    FIELD(kept.range_channel, MADE_ROI),
    FIELD(kept.range, MADE_ROI),
    FIELD(kept.finish, 0),
    FIELD(outlook.view.angle, MADE_CAMERA),
    FIELD(outlook.view.zoom, MADE_CAMERA),
    FIELD(outlook.view.focus, MADE_CAMERA),
    FIELD(outlook.slices.window_of, MADE_BY_WINDOW),
    FIELD(outlook.slices.window, MADE_BY_WINDOW),
    FIELD(outlook.slices.channel, MADE_CHANNELS),
};

_Static_assert(offsetof(struct state, kept) == 0, "a struct kept is the beginning of a state");

/* Return the parts that depend on a member before `end`, if it differs. */
static unsigned compare_member(const char *a, const char *b, size_t end,
                               const struct state_field *field)
{
    const bool differs = field->at < end && memcmp(a + field->at, b + field->at, field->bytes) != 0;
    return differs ? DIFFERS | field->made : 0;
}

/* Return DIFFERS and the parts that depend on different members before `end`, or 0. */
static unsigned compare(const void *a, const void *b, size_t end)
{
    unsigned made = 0;
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        made |= compare_member(a, b, end, &fields[i]);
    for (const struct command *setting = setting_table; setting->name; setting++)
        for (const struct parameter *p = setting->parameter; p->type; p++)
            made |= compare_member(a, b, end,
                                   &(struct state_field){p->sets.at, p->sets.bytes, p->sets.made});
    return made;
}

bool kept_equals(const struct kept *a, const struct kept *b)
{
    return compare(a, b, sizeof *a) == 0;
}

/* True if renditions with these opacities show different labels. */
static bool hides_others(const uint8_t a[256], const uint8_t b[256])
{
    for (int label = 0; label < 256; label++)
        if (!a[label] != !b[label])
            return true;
    return false;
}

/* Only one weight uses polarities. The window of slices also colours cut faces and the context.
 * */
unsigned state_difference(const struct state *a, const struct state *b)
{
    unsigned made = compare(a, b, sizeof *a);
    if (made & MADE_BY_POLARITY && b->kept.weight.kind == WEIGHT_POLARITY)
        made |= MADE_WEIGHTS;
    if (made & MADE_BY_WINDOW && (!cut_is_none(&b->kept.cut) || b->outlook.context))
        made |= MADE_COLOURS;
    if (made & MADE_BY_OPACITY)
        made |= hides_others(a->kept.opacity, b->kept.opacity) ? MADE_BORDER : MADE_COLOURS;
    return made & ~(unsigned)(MADE_BY_POLARITY | MADE_BY_WINDOW | MADE_BY_OPACITY | DIFFERS);
}

/* ---- in words ---- */

void setting_write_parts(struct buf *out, const char *choices, int64_t bits)
{
    const char *between = "", *none = strrchr(choices, '|') + 1;
    for (unsigned i = 0; bits >> i; i++) {
        const struct choice part = choice_at(choices, i);
        if (bits >> i & 1)
            buf_printf(out, "%s%.*s", between, (int)part.length, part.word);
        between = bits >> i & 1 ? " " : between;
    }
    buf_add_text(out, bits ? "" : none);
}

static void write_choice(struct buf *out, const char *choices, int64_t number)
{
    const struct choice word = choice_at(choices, (unsigned)number);
    buf_add(out, word.word, word.length);
}

void setting_write(struct buf *out, const struct command *setting, const struct state *state)
{
    buf_add_text(out, setting->name);
    for (const struct parameter *p = setting->parameter; p->type; p++) {
        const int64_t number = setting_get(state, &p->sets);
        if (p->keyed && number == p->sets.usual)
            continue;
        buf_printf(out, p->keyed ? " %s=" : " ", p->name);
        if (p->sets.as == HELD_AS_BACKGROUND)
            background_write(out, (uint32_t)number);
        else if (p->sets.as == HELD_AS_SWITCH)
            write_choice(out, p->choices, number ? 0 : 1);
        else if (p->type == VALUE_PARTS)
            setting_write_parts(out, p->choices, number);
        else if (p->type == VALUE_CHOICE && p->sets.as == HELD_AS_NUMBER)
            write_choice(out, p->choices, number);
        else
            buf_printf(out, "%g", (double)number / (p->type == VALUE_DECIMAL ? 1000 : 1));
    }
}

void settings_write(struct buf *out, enum command_group group, const struct state *state)
{
    const char *between = "";
    for (const struct command *setting = setting_table; setting->name; setting++) {
        if (setting->group != group)
            continue;
        buf_add_text(out, between);
        setting_write(out, setting, state);
        between = ", ";
    }
}
