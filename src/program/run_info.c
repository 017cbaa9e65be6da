/* SPDX-License-Identifier: MIT */
/*
 * `iftty info` describes a picture, a scene, a journal or this program. `iftty show` shows a
 * picture. `iftty help` and `iftty --version`.
 *
 * OpenEXR is read by our own reader, and by the image helper if another program wrote it in a way
 * that our reader does not support; other pictures are read by the helper. A TIFF is a scene if
 * `open` reads it, and a picture if it has colours. Pictures are decoded: a damaged or truncated
 * one is an error. Of a scene the header alone is read, unless its histogram is wanted. A torn,
 * edited or damaged journal is described too, with ERR_CHECK. Text of a file is escaped for the
 * terminal.
 */
#include <libdeflate.h>
#include <nettle/version.h>
#include <openexr_base.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include "base/file.h"
#include "base/json.h"
#include "base/version.h"
#include "command/command.h"
#include "command/interpreter.h"
#include "base/confine.h"
#include "base/mem.h"
#include "image/coprocess.h"
#include "image/exr.h"
#include "image/image_helper.h"
#include "image/volume.h"
#include "journal/journal.h"
#include "program/programs.h"
#include "show/export_picture.h"
#include "show/histogram.h"
#include "session/session.h"
#include "tui/cells.h"
#include "tui/prompt/line_edit.h"
#include "tui/prompt/repl.h"

/* ---- facts ---- */

/* "name      value" lines, or the members of a JSON object. */
struct facts {
    struct buf *out; /* for lines; the same as json.out */
    struct json json;
    bool is_json;
    unsigned lines;
    struct volume_choice volume; /* the one to read of several */
    bool wants_histogram, has_histogram;
    struct histogram histogram; /* for lines: printed after them */
};

/* Begin a line; false for JSON, where the caller adds a member. */
static bool begin_line(struct facts *f, const char *name)
{
    if (!f->is_json)
        buf_printf(f->out, "%s%-9s ", f->lines++ ? "\n" : "", name);
    return !f->is_json;
}

static void add_text(struct facts *f, const char *name, const char *value)
{
    if (begin_line(f, name))
        buf_add_safe_text(f->out, value);
    else
        json_text(&f->json, name, value);
}

static void add_count(struct facts *f, const char *name, uint64_t value)
{
    if (begin_line(f, name))
        buf_printf(f->out, "%llu", (unsigned long long)value);
    else
        json_count(&f->json, name, value);
}

/* Add "pixels", "voxels" or "size", along each axis. */
static void add_sides(struct facts *f, const char *name, const uint32_t *side, unsigned axes)
{
    const bool is_line = begin_line(f, name);
    for (unsigned a = 0; is_line && a < axes; a++)
        buf_printf(f->out, "%s%u", a ? "x" : "", side[a]);
    if (!is_line)
        json_counts(&f->json, name, side, axes);
}

static void add_spacing(struct facts *f, const struct geometry *g)
{
    if (g->spacing_unknown) {
        add_text(f, "spacing", "unknown");
        return;
    }
    if (begin_line(f, "spacing")) {
        buf_printf(f->out, "%.6gx%.6gx%.6g mm", g->spacing_nm[0] / 1e6, g->spacing_nm[1] / 1e6,
                   g->spacing_nm[2] / 1e6);
        return;
    }
    json_array(&f->json, "spacing");
    for (unsigned a = 0; a < 3; a++)
        json_real(&f->json, NULL, g->spacing_nm[a] / 1e6, 6);
    json_end(&f->json);
}

/* ---- pictures ---- */

/* In formats with a single text, its lines "name: value" are the notes. */
static enum err take_lines(struct picture *notes, const char *text)
{
    OWNED(buf_release) struct buf line = {0};
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
    return line.failed ? ERR_MEMORY : err;
}

/* Collect the notes of a picture: ours, then those of its format, each name once. */
static enum err collect_notes(struct picture *notes, const struct picture *p)
{
    *notes = (struct picture){0};
    for (int ours = 1; ours >= 0; ours--)
        for (size_t i = 0; i < p->attributes; i++) {
            const struct attribute *note = &p->attribute[i];
            const bool is_text = strncmp(note->value, "Software: iftty", 15) == 0;
            if (is_text && ours)
                TRY(take_lines(notes, note->value));
            else if (!is_text && !ours && !picture_find(notes, note->name))
                TRY(picture_note(notes, note->name, note->value, NULL));
        }
    return OK;
}

static void add_notes(struct facts *f, const struct picture *p)
{
    OWNED(picture_release) struct picture notes = {0};
    if (!p->attributes && !f->is_json)
        return;
    if (!begin_line(f, "notes"))
        json_object(&f->json, "notes");
    if (collect_notes(&notes, p))
        f->out->failed = true;
    for (size_t i = 0; i < notes.attributes; i++) {
        const struct attribute *note = &notes.attribute[i];
        if (f->is_json) {
            json_text(&f->json, note->name, note->value);
            continue;
        }
        buf_add_text(f->out, i == 0 ? "" : "\n          ");
        buf_add_safe_text(f->out, note->name);
        buf_add_text(f->out, ": ");
        buf_add_safe_text(f->out, note->value);
    }
    if (f->is_json)
        json_end(&f->json);
}

static void add_picture(struct facts *f, const char *format, const char *channels, unsigned frames,
                        const struct picture *p)
{
    const uint32_t side[2] = {p->width, p->height};
    add_text(f, "format", format);
    add_sides(f, "pixels", side, 2);
    add_text(f, "channels", channels);
    if (frames > 1 || f->is_json)
        add_count(f, "frames", frames);
    add_notes(f, p);
}

/* Describe an OpenEXR file by our own reader, which knows every channel. */
static enum err add_own_exr(struct facts *f, const char *path, struct fault *fault)
{
    OWNED(picture_release) struct picture p;
    OWNED(buf_release) struct buf channels = {0};
    TRY(exr_read(&p, path, fault));
    buf_add_text(&channels, p.is_associated ? "R G B A half, associated alpha" : "R G B A half");
    buf_add_text(&channels, !p.depth_mm ? "" : p.is_associated ? ", Z depth float" : ", Z float");
    buf_add_text(&channels, p.label ? ", label uint" : "");
    buf_add_text(&channels, p.voxel ? ", voxel uint" : "");
    buf_add_text(&channels, p.normal ? ", N.X N.Y N.Z float" : "");
    add_picture(f, p.tiled ? "openexr, tiled" : "openexr, lines", buf_text(&channels), 1, &p);
    f->out->failed |= channels.failed;
    return OK;
}

/* needs_colours: fail silently if pixels have fewer than three values. */
static enum err add_image(struct facts *f, const char *path, bool needs_colours,
                          struct fault *fault)
{
    struct image_helper *helper;
    OWNED(image_facts_release) struct image_facts facts = {0};
    OWNED(buf_release) struct buf channels = {0};
    enum err err = image_helper_new(&helper, NULL, fault);
    if (!err)
        err = image_helper_about(helper, path, &facts, fault);
    image_helper_free(helper);
    if (err)
        return err;
    const char *comma = strchr(facts.channels, ',');
    if (needs_colours && !(comma && strchr(comma + 1, ',')))
        return ERR_INPUT;
    for (const char *at = facts.channels; *at; at++)
        buf_add_char(&channels, *at == ',' ? ' ' : *at);
    buf_printf(&channels, " %s", facts.type);
    add_picture(f, facts.format, buf_text(&channels), facts.frames, &facts.picture);
    f->out->failed |= channels.failed;
    return OK;
}

/* ---- scenes and journals ---- */

/* Add the histogram of all voxels, between black and white, and the scale of inexact
 * intensities. */
static void add_histogram(struct facts *f, const struct volume *volume)
{
    static uint32_t count[UINT16_MAX + 1];
    const struct levels *levels = volume->levels;
    const struct histogram *h = &f->histogram;
    OWNED(buf_release) struct buf scale = {0};
    const size_t voxels = (size_t)volume->size[0] * volume->size[1] * volume->size[2];
    for (size_t i = 0; i < voxels; i++)
        count[volume->intensity[i]]++;
    histogram_of_counts(&f->histogram, count, &volume->geometry);
    f->has_histogram = true;
    if (levels)
        buf_printf(&scale, "%.6g..%.6g, a level is %.3g; %zu voxel%s below, %zu above",
                   levels->ends[0], levels->ends[1], levels->step, levels->beyond[0],
                   plural(levels->beyond[0]), levels->beyond[1]);
    if (levels)
        add_text(f, "scale", buf_text(&scale));
    f->out->failed |= scale.failed;
    if (!f->is_json)
        return;
    json_object(&f->json, "histogram");
    json_real(&f->json, "least", h->least, 9);
    json_real(&f->json, "most", h->most, 9);
    json_count(&f->json, "below", h->below);
    json_count(&f->json, "above", h->above);
    json_array(&f->json, "bins");
    for (unsigned i = 0; i < h->bins; i++)
        json_count(&f->json, NULL, h->bin[i]);
    json_end(&f->json);
    json_end(&f->json);
}

/* Add the notes of `open`, a line each. */
static void add_open_notes(struct facts *f, const char *notes)
{
    OWNED(buf_release) struct buf line = {0};
    if (f->is_json)
        json_array(&f->json, "open_notes");
    for (size_t n; *notes; notes += n + 1) {
        n = strcspn(notes, "\n");
        buf_clear(&line);
        buf_add(&line, notes, n);
        if (f->is_json)
            json_text(&f->json, NULL, buf_text(&line));
        else
            add_text(f, "note", buf_text(&line));
    }
    if (f->is_json)
        json_end(&f->json);
    f->out->failed |= line.failed;
}

static enum err add_scene(struct facts *f, const char *path, struct fault *fault)
{
    struct volume_reader reader;
    OWNED(volume_release) struct volume volume = {0};
    OWNED(buf_release) struct buf series = {0}; /* the series of a folder with several */
    struct volume_choice choice = f->volume;
    choice.list = f->is_json ? NULL : &series;
    char towards[4];
    enum err err = volume_begin(&reader, path, &choice, NULL, fault);
    const struct volume_header facts = reader.header;
    volume_close(&reader);
    fputs(buf_text(&series), stdout);
    if (!err && f->wants_histogram) {
        err = volume_read(&volume, path, &f->volume, console_watch(), fault);
        console_erase_progress();
    }
    if (err)
        return err;
    const bool oriented = facts.geometry.orientation != ORIENTATION_UNKNOWN;
    geometry_axes(towards, &facts.geometry);
    add_text(f, "format", facts.format);
    add_sides(f, f->is_json ? "size" : "voxels", facts.size, 3); /* "size" as in records */
    add_text(f, "type", facts.type_name);
    if (facts.volumes > 1 || f->is_json)
        add_count(f, "volumes", facts.volumes);
    add_spacing(f, &facts.geometry);
    add_text(f, "axes", oriented ? towards : "unknown");
    add_text(f, "order", facts.big_endian ? "big-endian" : "little-endian");
    add_open_notes(f, f->wants_histogram ? volume.notes : facts.notes);
    if (*facts.refusal)
        add_text(f, "refused", facts.refusal);
    if (f->wants_histogram)
        add_histogram(f, &volume);
    return OK;
}

static enum err add_journal(struct facts *f, const char *path, struct fault *fault)
{
    struct journal_condition condition = {0};
    OWNED(buf_release) struct buf bytes = {0};
    enum err err = file_read(&bytes, path, JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = journal_check(&condition, buf_text(&bytes), bytes.length, fault);
    if (err && err != ERR_CHECK)
        return err;
    add_text(f, "format", "iftty journal");
    add_count(f, "records", condition.records);
    add_text(f, "condition", condition.text);
    if (condition.records)
        add_text(f, "chain", condition.chain.hex);
    return err;
}

/* ---- files, and the program ---- */

static enum err add_file(struct facts *f, const char *path, struct fault *fault)
{
    if (!file_exists(path))
        return fault_set(fault, ERR_IO, "there is no file %s", path);
    if (!file_is_folder(path) && !file_begins_with(path, ""))
        return fault_set(fault, ERR_INPUT, "%s is not a regular file that can be read", path);
    add_text(f, "file", path);
    const enum volume_guess guess = volume_guess(path);
    if (file_is_folder(path) || guess == GUESS_PATIENT)
        return add_scene(f, path, fault);
    if (interpreter_is_journal(path))
        return add_journal(f, path, fault);
    if (file_begins_with(path, "\x76\x2f\x31\x01")) {
        /* A file of another program may be readable by the helper alone; our reader reports the
         * error. */
        const enum err err = add_own_exr(f, path, fault);
        return err && add_image(f, path, false, NULL) == OK ? OK : err;
    }
    if (volume_ending(path) && !file_begins_with(path, "#?RADIANCE"))
        return add_scene(f, path, fault);
    if (guess == GUESS_TIFF) {
        const enum err err = add_scene(f, path, fault);
        return err && add_image(f, path, true, NULL) == OK ? OK : err;
    }
    const enum err err = add_image(f, path, false, fault);
    return err && guess == GUESS_VOLUME ? add_scene(f, path, fault) : err;
}

/* Describe the program, with the kernel's means of confinement. */
static void add_program(struct facts *f)
{
    const int landlock = confine_version();
    const bool knows_calls = confine_knows_calls();
    add_text(f, "version", PROGRAM_VERSION);
    add_count(f, "semantics", SEMANTICS);
    if (!begin_line(f, "landlock")) {
        json_count(&f->json, "landlock", (uint64_t)landlock);
        json_boolean(&f->json, "seccomp", knows_calls);
        return;
    }
    if (landlock == 0)
        buf_add_text(f->out, "none in this kernel: replay and verify check names alone, and the "
                             "helpers can open all your files");
    else
        buf_printf(f->out,
                   "version %d: replay, verify and the helpers open only the files they need",
                   landlock);
    add_text(f, "seccomp",
             knows_calls
                 ? "the helpers make few system calls: no network, no other program or process"
                 : "none on this machine: the helpers may make any system call");
}

enum err run_info(const struct options *o, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0};
    struct facts facts = {.out = &text,
                          .json = {.out = &text},
                          .is_json = o->json,
                          .wants_histogram = o->histogram,
                          .volume = begin_volume(o, 0)};
    enum err err = OK;
    if (o->json)
        json_object(&facts.json, NULL);
    if (o->words)
        err = add_file(&facts, o->word[0], fault);
    else
        add_program(&facts);
    if (o->json)
        json_end(&facts.json);
    else
        buf_add_char(&text, '\n');
    if (!o->json && facts.has_histogram)
        histogram_write(&text, &facts.histogram, isatty(STDOUT_FILENO) && locale_is_utf8());
    if (text.failed)
        err = fault_memory(fault, "the description of a file");
    if (!err || err == ERR_CHECK)
        fputs(buf_text(&text), stdout);
    return err;
}

/* ---- iftty show ---- */

/* Succeeds silently if standard output is no terminal. */
enum err run_show(const struct options *o, struct fault *fault)
{
    struct image_helper *helper;
    OWNED(picture_release) struct picture picture = {0};
    enum err err = image_helper_new(&helper, NULL, fault);
    if (!err)
        err = image_helper_read(helper, o->word[0], &picture, fault);
    if (!err) {
        const struct image_view view = {.width = picture.width,
                                        .height = picture.height,
                                        .rgba = picture.rgba,
                                        .smooth = o->smooth};
        show_picture_once(o->graphics, &view);
    }
    image_helper_free(helper);
    return err;
}

/* ---- iftty help and --version ---- */

enum err run_help(const struct options *o, struct fault *fault)
{
    const char *name = o->words ? o->word[0] : NULL;
    const struct command *command = name ? command_find(name) : NULL;
    OWNED(buf_release) struct buf of_command = {0}, of_program = {0};
    if (command || (name && strcmp(name, "all") == 0))
        command_help(&of_command, command);
    else if (command_page(name))
        buf_add_text(&of_command, command_page(name));
    else if (strcmp(name, "keys") == 0)
        line_keys_page(&of_command);
    if (name && !program_add_help(&of_program, &program_table, name) && !of_command.length) {
        struct near near = near_to(name);
        command_try_names(&near);
        program_try_names(&program_table, &near);
        fault_set(fault, ERR_USAGE, "there is no command or program %s%s", name,
                  near.count ? "" : "; see `iftty help all` and `iftty --help`");
        return near_append(&near, "", fault);
    }
    printf("%s%s%s", buf_text(&of_command), of_command.length && of_program.length ? "\n" : "",
           buf_text(&of_program));
    return OK;
}

enum err run_version(const struct options *o, struct fault *fault)
{
    static const char *const helpers[][2] = {{"iftty-image", "iftty-image"},
                                             {"iftty-volume", "iftty-volume"},
                                             {"iftty-register", "iftty-volume"}}; /* packages */
    int exr[3];
    const char *extra;
    (void)o;
    exr_get_library_version(&exr[0], &exr[1], &exr[2], &extra);
    /* A version next to "deflate" in the binary is a copy of zlib to lintian. */
    printf("iftty " PROGRAM_VERSION "\n"
           "journal semantics %d\n"
           "OpenEXR %d.%d.%d, zlib %s, libdeflate %s, nettle %d.%d\n",
           SEMANTICS, exr[0], exr[1], exr[2], zlibVersion(), LIBDEFLATE_VERSION_STRING,
           nettle_version_major(), nettle_version_minor());
    OWNED(buf_release) struct buf text = {0};
    for (size_t i = 0; i < sizeof helpers / sizeof *helpers; i++) {
        buf_printf(&text, "%s: ", helpers[i][0]);
        coprocess_add_versions(&text, helpers[i][0], helpers[i][1]);
        buf_add_char(&text, '\n');
    }
    fputs(buf_text(&text), stdout);
    return text.failed ? fault_memory(fault, "versions") : OK;
}
