#include "session/setting.h"

#include <stdlib.h>
#include <string.h>

#include "base/choice.h"
#include "render/decoration.h"

/* ---- the table ---- */

enum { R = COMMAND_RECORDED, S = COMMAND_NEEDS_SCENE, E = COMMAND_EDITS };

/* What every row begins with, on one line. */
#define SETTING(NAME, GROUP, FLAGS) NAME, NULL, NULL, NULL, GROUP, FLAGS
#define KEYED                       .optional = true, .keyed = true

/* The member, as what a session begins with, and what else there is to say of it. */
#define HELD(member) ((struct state *)NULL)->member
#define SETS(member, begins, ...)                                                                  \
    .sets = {.at = offsetof(struct state, member),                                                 \
             .bytes = sizeof HELD(member),                                                         \
             .is_signed = (__typeof__(HELD(member)))-1 < 1,                                        \
             .usual = (begins),                                                                    \
             __VA_ARGS__}

const struct command setting_table[] = {
    {SETTING("adjacency", GROUP_WEIGHT, R | S | E),
     {{"COUNT", VALUE_CHOICE, .choices = "6|26",
       SETS(kept.adjacency, 6, .made = MADE_WEIGHTS, .as = HELD_AS_COUNT)}},
     "neighbours of a voxel: by faces, or by corners too",
     "6 is the default.",
     "adjacency 26"},
    {SETTING("size", GROUP_VIEW, R | S),
     {{"WIDTH", VALUE_NUMBER, .least = 1, .most = VIEW_SIDE_MOST,
       SETS(outlook.view.width, 512, .made = MADE_CAMERA)},
      {"HEIGHT", VALUE_NUMBER, .least = 1, .most = VIEW_SIDE_MOST,
       SETS(outlook.view.height, 512, .made = MADE_CAMERA)}},
     "the size of pictures, in pixels",

     "Of renditions, slices and mosaics alike; 512 512 by default.",

     "size 512 512"},
    {SETTING("shade", GROUP_LOOK, R | S),
     {{"NORMALS", VALUE_CHOICE, .choices = SHADE_MODES,
       SETS(outlook.look.mode, SHADE_SURFACE, .made = MADE_CAMERA)},
      {"ao", VALUE_NUMBER, KEYED, .most = 100, .form = "PERCENT",
       SETS(outlook.look.ao_percent, 0, .made = MADE_CAMERA)},
      {"creases", VALUE_CHOICE, KEYED, .choices = "yes|no",
       SETS(outlook.look.creases, 0, .made = MADE_CAMERA, .as = HELD_AS_SWITCH)}},
     "where the normals of a surface come from",
     "surface, the default: the shown objects, smoothed.\n"
     "scene: the gradient of the intensities, with finer detail where objects end at an edge of "
     "the scene.\n"
     "depth: the depths around a pixel.\n"
     "cubes: as surface, on the faces of voxels. The others show a smooth surface between them.\n"
     "ao: ambient occlusion; 0, the default, is none. Sulci and other hollows, which little light "
     "comes into, are darker by up to so much. Not while an object is translucent, nor on faces "
     "that are cut open.\n"
     "creases: yes shades each object as if it were alone, so that a crease is seen where two "
     "touch; else one surface runs across both. Not by depths.",
     "shade scene"},
    {SETTING("light", GROUP_LOOK, R | S),
     {{"YAW", VALUE_DECIMAL, .least = -VIEW_TURN / 2, .most = VIEW_TURN / 2,
       SETS(outlook.look.light[0], -25000, .made = MADE_CAMERA)},
      {"PITCH", VALUE_DECIMAL, .least = -LIGHT_PITCH_MOST, .most = LIGHT_PITCH_MOST,
       SETS(outlook.look.light[1], 30000, .made = MADE_CAMERA)}},
     "where the light comes from, in degrees",
     "It moves with you: 0 0 comes from behind you, YAW turns it to your right, PITCH upwards. The "
     "default is -25 30, over your left shoulder.",
     "light -25 30"},
    {SETTING("cue", GROUP_LOOK, R | S),
     {{"PERCENT", VALUE_NUMBER, .most = 100,
       SETS(outlook.look.cue_percent, 30, .made = MADE_CAMERA)}},
     "how much darker distant surfaces are",
     "So much at the far end of the scene; 30 by default.",
     "cue 50"},
    {SETTING("edges", GROUP_LOOK, R | S),
     {{"STATE", VALUE_CHOICE, .choices = "on|off",
       SETS(outlook.look.edges, 0, .made = MADE_CAMERA, .as = HELD_AS_SWITCH)}},
     "draw lines where something hides or is folded",

     "off by default. A line lies on what is in front, one pixel wide: dark where another object, "
     "or a part of the same, is behind it or touches it, and where its surface has a fold; light, "
     "with a dark one within, where nothing is behind it.",

     "edges on"},
    {SETTING("samples", GROUP_LOOK, R | S),
     {{"COUNT", VALUE_CHOICE, .choices = "1|2|4",
       SETS(outlook.look.samples, 1, .made = MADE_CAMERA, .as = HELD_AS_COUNT)}},
     "smooth outlines: COUNT x COUNT samples a pixel",
     "Each pixel is the mean of its samples; depth, label and voxel are those of the nearest one. "
     "1 by default.",
     "samples 2"},
    {SETTING("background", GROUP_LOOK, R | S),
     {{"COLOUR", VALUE_COLOUR, .choices = BACKGROUNDS,
       SETS(outlook.background, BACKGROUND_GRADIENT, .made = 0, .as = HELD_AS_BACKGROUND)}},
     "what is seen where no object is",
     "Of renditions, on the screen and in files; or #rrggbb. gradient, the default: from a calm "
     "grey at the top to a darker one.\n"
     "transparent: .png and .tif have alpha then; it is black on the screen, in mosaics and in "
     "other formats.\n"
     ".exr always has the objects alone, with their alpha, and so have golden images.",
     "background white"},
    {SETTING("decorate", GROUP_LOOK, R | S),
     {{"PART", VALUE_PARTS, .choices = DECORATIONS "|all|none",
       SETS(outlook.decorations, 0, .made = 0)}},
     "what is drawn over the rendition",
     "none by default. It is drawn over the colours, on the screen, in files and in golden images, "
     "as large as the picture has room for; `pick` finds what is below.\n"
     "letters: the patient's sides, R L A P S I, or the axes where nobody knows them.\n"
     "scale: a bar and its length in millimetres, or in voxels where their distance is unknown.\n"
     "legend: the labels that are shown, with their volumes.\n"
     "seeds: seeds and eliminators of the last run, where their voxels are seen.\n"
     "cross: the cross-hair, where its voxel is seen.",

     "decorate letters scale legend"},
    {SETTING("context", GROUP_LOOK, R | S),
     {{"WHAT", VALUE_CHOICE, .choices = CONTEXTS,
       SETS(outlook.context, CONTEXT_NONE, .made = MADE_COLOURS)}},
     "the scene itself behind and around the objects",
     "none is the default.\n"
     "mip: a maximum intensity projection. Where no object is, a pixel is as bright as the "
     "brightest voxel on its ray, within the `window` of slices; what is cut away is left out. "
     "What is dark lets the background through.",
     "context mip"},
    {SETTING("overlay", GROUP_SLICES, R | S),
     {{"LABELS", VALUE_CHOICE, .optional = true, .choices = SLICE_OVERLAYS,
       SETS(outlook.slices.overlay, SLICE_CONTOUR, .made = 0, .stays = true)},
      {"cross", VALUE_CHOICE, KEYED, .choices = "on|off",
       SETS(outlook.slices.crosses, 1, .made = 0, .as = HELD_AS_SWITCH, .stays = true)},
      {"marks", VALUE_CHOICE, KEYED, .choices = "on|off",
       SETS(outlook.slices.marks, 1, .made = 0, .as = HELD_AS_SWITCH, .stays = true)},
      {"words", VALUE_CHOICE, KEYED, .choices = "on|off",
       SETS(outlook.slices.words, 1, .made = 0, .as = HELD_AS_SWITCH, .stays = true)}},
     "what is drawn over the grey of slices",
     "none, tint or contour of the labels that are shown; contour by default.\n"
     "cross: the cross-hair.\n"
     "marks: a dot for a seed in the slice, of seeds side by side for the outermost alone; an x "
     "for an eliminator of the last run; in the pilot, a white rim means that it waits for a run.\n"
     "words: the title, letters for the patient's sides, the scale bar, the grey bar.",
     "overlay tint cross=off"},
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

void settings_begin(struct state *state)
{
    for (const struct command *setting = setting_table; setting->name; setting++)
        for (const struct parameter *p = setting->parameter; p->type; p++)
            setting_put(state, &p->sets, p->sets.usual);
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

static void write_member(struct buf *out, const struct parameter *p, int64_t number)
{
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

void setting_write(struct buf *out, const struct command *setting, const struct state *state)
{
    buf_add_text(out, setting->name);
    for (const struct parameter *p = setting->parameter; p->type; p++) {
        const int64_t number = setting_get(state, &p->sets);
        if (p->keyed && number == p->sets.usual)
            continue;
        buf_printf(out, p->keyed ? " %s=" : " ", p->name);
        write_member(out, p, number);
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
