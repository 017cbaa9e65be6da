#include "program/about.h"

#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/scan.h"
#include "command/interpreter.h"
#include "image/exr.h"
#include "image/volume.h"
#include "journal/log.h"

/* ---- two ways to say it ---- */

/* A list of facts: "name      value" lines, or the members of a JSON object. */
struct teller_of_facts {
    struct buf *out;
    bool json;
    unsigned told;
};

static void add_json_text(struct buf *out, const char *text)
{
    json_add_text(out, text, strlen(text));
}

static void begin_fact(struct teller_of_facts *t, const char *name)
{
    if (!t->json) {
        buf_printf(t->out, "%s%-9s ", t->told++ ? "\n" : "", name);
        return;
    }
    buf_add_text(t->out, t->told++ ? ", " : "{");
    add_json_text(t->out, name);
    buf_add_text(t->out, ": ");
}

static void tell_text(struct teller_of_facts *t, const char *name, const char *value)
{
    begin_fact(t, name);
    if (t->json)
        add_json_text(t->out, value);
    else
        buf_add_safe(t->out, value, strlen(value));
}

static void tell_number(struct teller_of_facts *t, const char *name, uint64_t value)
{
    begin_fact(t, name);
    buf_printf(t->out, "%llu", (unsigned long long)value);
}

/* "pixels" or "voxels", along each axis. */
static void tell_sides(struct teller_of_facts *t, const char *what, const uint32_t *side,
                       unsigned axes)
{
    begin_fact(t, what);
    buf_add_text(t->out, t->json ? "[" : "");
    for (unsigned a = 0; a < axes; a++)
        buf_printf(t->out, "%s%u", a == 0 ? "" : t->json ? ", " : "x", side[a]);
    buf_add_text(t->out, t->json ? "]" : "");
}

static void end_facts(struct teller_of_facts *t)
{
    buf_add_text(t->out, t->json ? "}\n" : "\n");
}

/* ---- pictures ---- */

static void tell_note(struct teller_of_facts *t, unsigned *told, const char *name,
                      const char *value)
{
    if (t->json) {
        buf_add_text(t->out, (*told)++ ? ", " : "");
        add_json_text(t->out, name);
        buf_add_text(t->out, ": ");
        add_json_text(t->out, value);
        return;
    }
    buf_printf(t->out, "%s", (*told)++ ? "\n          " : "");
    buf_add_safe(t->out, name, strlen(name));
    buf_add_text(t->out, ": ");
    buf_add_safe(t->out, value, strlen(value));
}

/* Formats with one text for everything have the notes as its lines "name: value": those lines are
 * the notes they were. */
static enum err take_lines(struct picture *notes, const char *text)
{
    struct buf line = {0};
    enum err err = OK;
    for (; *text && !err; text += strcspn(text, "\n"), text += *text == '\n') {
        buf_clear(&line);
        buf_add(&line, text, strcspn(text, "\n"));
        char *colon = line.length ? strstr(line.data, ": ") : NULL;
        if (colon)
            *colon = '\0';
        if (colon)
            err = picture_note(notes, line.data, colon + 2, NULL);
    }
    err = line.failed ? ERR_MEMORY : err;
    buf_release(&line);
    return err;
}

/* The notes of a picture, ours before those that its format adds, each name once. */
static enum err collect(struct picture *notes, const struct picture *p)
{
    enum err err = OK;
    *notes = (struct picture){0};
    for (int ours = 1; ours >= 0; ours--)
        for (size_t i = 0; i < p->attributes && !err; i++) {
            const struct attribute *note = &p->attribute[i];
            const bool is_text = strncmp(note->value, "Software: iftty", 15) == 0;
            if (is_text && ours)
                err = take_lines(notes, note->value);
            else if (!is_text && !ours && !picture_find(notes, note->name))
                err = picture_note(notes, note->name, note->value, NULL);
        }
    return err;
}

static void tell_notes(struct teller_of_facts *t, const struct picture *p)
{
    struct picture notes;
    unsigned told = 0;
    if (!p->attributes && !t->json)
        return;
    begin_fact(t, "notes");
    buf_add_text(t->out, t->json ? "{" : "");
    if (collect(&notes, p))
        t->out->failed = true;
    for (size_t i = 0; i < notes.attributes; i++)
        tell_note(t, &told, notes.attribute[i].name, notes.attribute[i].value);
    buf_add_text(t->out, t->json ? "}" : "");
    picture_release(&notes);
}

static void tell_picture(struct teller_of_facts *t, const char *format, const char *channels,
                         unsigned frames, const struct picture *p)
{
    const uint32_t side[2] = {p->width, p->height};
    tell_text(t, "format", format);
    tell_sides(t, "pixels", side, 2);
    tell_text(t, "channels", channels);
    if (frames > 1 || t->json)
        tell_number(t, "frames", frames);
    tell_notes(t, p);
}

/* As our own reader has it, which knows every channel. */
static enum err about_exr(struct teller_of_facts *t, const char *path, struct fault *fault)
{
    struct picture p;
    struct buf channels = {0};
    enum err err = exr_read(&p, path, fault);
    if (err)
        return err;
    buf_add_text(&channels, "R G B A half");
    buf_add_text(&channels, p.depth_mm ? ", Z float" : "");
    buf_add_text(&channels, p.label ? ", label uint" : "");
    buf_add_text(&channels, p.voxel ? ", voxel uint" : "");
    buf_add_text(&channels, p.normal ? ", N.X N.Y N.Z float" : "");
    tell_picture(t, p.tiled ? "openexr, tiled" : "openexr, lines", buf_text(&channels), 1, &p);
    buf_release(&channels);
    picture_release(&p);
    return OK;
}

static enum err about_image(struct teller_of_facts *t, const char *path,
                            struct image_helper *helper, struct fault *fault)
{
    struct image_facts facts;
    struct buf channels = {0};
    enum err err = image_helper_about(helper, path, &facts, fault);
    if (err)
        return err;
    for (const char *at = facts.channels; *at; at++)
        buf_add_char(&channels, *at == ',' ? ' ' : *at);
    buf_printf(&channels, " %s", facts.type);
    tell_picture(t, facts.format, buf_text(&channels), facts.frames, &facts.picture);
    t->out->failed |= channels.failed;
    buf_release(&channels);
    image_facts_release(&facts);
    return OK;
}

/* What another program wrote may be beyond our reader and not the helper's; if it is beyond both,
 * ours says why. */
static enum err about_openexr(struct teller_of_facts *t, const char *path,
                              struct image_helper *helper, struct fault *fault)
{
    enum err err = about_exr(t, path, fault);
    return err && about_image(t, path, helper, NULL) == OK ? OK : err;
}

/* ---- scenes ---- */

static enum err about_scene(struct teller_of_facts *t, const char *path, struct fault *fault)
{
    struct volume_header facts;
    enum err err = volume_about(&facts, path, fault);
    if (err)
        return err;
    const struct geometry *g = &facts.geometry;
    char towards[4];
    geometry_axes(towards, g);
    tell_text(t, "format", facts.format);
    tell_sides(t, "voxels", facts.size, 3);
    tell_text(t, "type", facts.type_name);
    begin_fact(t, "spacing");
    buf_printf(t->out, t->json ? "[%.6g, %.6g, %.6g]" : "%.6gx%.6gx%.6g mm", g->spacing_nm[0] / 1e6,
               g->spacing_nm[1] / 1e6, g->spacing_nm[2] / 1e6);
    tell_text(t, "axes", towards);
    tell_text(t, "order", facts.big_endian ? "big-endian" : "little-endian");
    return OK;
}

/* ---- journals ---- */

static enum err about_journal(struct teller_of_facts *t, const char *path, struct fault *fault)
{
    struct journal_condition condition = {0};
    struct buf bytes = {0};
    enum err err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = journal_check(&condition, buf_text(&bytes), bytes.length, fault);
    buf_release(&bytes);
    if (err && err != ERR_CHECK)
        return err;
    tell_text(t, "format", "iftty journal");
    tell_number(t, "records", condition.records);
    tell_text(t, "condition", condition.text);
    return err;
}

enum err about_file(struct buf *out, const char *path, bool json, struct image_helper *helper,
                    struct fault *fault)
{
    struct teller_of_facts teller = {.out = out, .json = json};
    const size_t before = out->length;
    enum err err;
    if (!file_exists(path))
        return fault_set(fault, ERR_IO, "there is no file %s", path);
    if (!file_begins_with(path, ""))
        return fault_set(fault, ERR_INPUT, "%s is not a regular file that can be read", path);
    tell_text(&teller, "file", path);
    if (interpreter_is_journal(path))
        err = about_journal(&teller, path, fault);
    else if (file_begins_with(path, "\x76\x2f\x31\x01"))
        err = about_openexr(&teller, path, helper, fault);
    else if (volume_ending(path))
        err = about_scene(&teller, path, fault);
    else
        err = about_image(&teller, path, helper, fault);
    end_facts(&teller);
    if (out->failed)
        return fault_memory(fault, "what a file is");
    if (err && err != ERR_CHECK && out->data)
        out->data[out->length = before] = '\0';
    return err;
}
