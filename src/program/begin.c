/* SPDX-License-Identifier: MIT */
#include "program/programs.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/scan.h"
#include "command/command.h"
#include "command/execute.h"
#include "command/golden_files.h"
#include "image/coprocess.h"
#include "image/image_helper.h"
#include "image/volume_helper.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "command/trust.h"
#include "session/tally.h"
#include "show/decorating.h"
#include "show/draw.h"
#include "tui/cells.h"

enum err begin_by_options(struct interpreter *interp, const struct options *o, struct fault *fault)
{
    OWNED(buf_release) struct buf lines = {0}, path = {0};
    enum err err = interpreter_init(interp, fault);
    session_set_watch(interp->session, console_watch());
    interp->scene_path = o->scene;
    interp->channel_path = o->channel;
    interp->out_folder = o->out;
    interp->is_read_only = o->read_only;
    interp->who = o->who;
    interp->times = o->times;
    interp->has_blocks = isatty(STDOUT_FILENO) && locale_is_utf8();
    if (!err && o->out)
        err = file_make_folder(o->out, fault);
    if (!err && o->whole && (!o->journal || o->read_only))
        err = fault_set(fault, ERR_USAGE, "--whole needs --journal FILE, and excludes --read-only");
    if (!err && o->whole && (o->who || o->times))
        err = fault_set(fault, ERR_USAGE,
                        "--whole makes the same journal each time, and excludes "
                        "--who and --times");
    if (!err && o->who)
        err = fault_prefix(fault, journal_who_check(o->who, fault), "--who");
    buf_add_text(&path, o->journal ? o->journal : "");
    if (o->whole && o->journal && !file_exists(o->journal))
        buf_add_text(&path, JOURNAL_PART);
    else
        interp->is_read_only |= o->whole; /* the journal is complete */
    const char *journal = buf_text(&path);
    if (!err && path.failed)
        err = fault_memory(fault, "a path");
    if (!err && o->journal && file_exists(journal))
        err = interpreter_resume_journal(interp, journal, &lines, fault);
    else if (!err && o->journal && o->read_only)
        err = fault_set(fault, ERR_IO, "--read-only: there is no journal %s", journal);
    else if (!err && o->journal && !(err = interpreter_create_journal(interp, journal, fault)))
        interpreter_write_lock(interp, &lines);
    console_erase_progress();
    if (lines.length)
        fprintf(stderr, "iftty: %s", buf_text(&lines));
    return err;
}

void begin_to_wait(struct interpreter *interp)
{
    const uint64_t least = 1000000000; /* bytes of cells that take a tenth of a second */
    session_let_wait(interp->session, least);
}

enum err begin_check_channels(const struct options *o, bool resumes, struct fault *fault)
{
    return !o->channel[0] || resumes || (o->journal && file_exists(o->journal))
               ? OK
               : fault_set(fault, ERR_USAGE,
                           "--channel: only for a journal that has recorded `channel`; `channel "
                           "FILE`, or a further file after the scene, adds one");
}

enum err begin_check(const struct options *o, const char **first, bool *resumes,
                     struct fault *fault)
{
    const char *name = o->words ? o->word[0] : NULL;
    const bool is_journal = name && interpreter_is_journal(name);
    *first = name;
    *resumes = is_journal;
    if (is_journal && o->words > 1)
        return fault_set(fault, ERR_USAGE, "%s is a journal; expected no other file", name);
    TRY(begin_check_channels(o, is_journal, fault));
    if (o->read_only && !o->journal && !is_journal)
        return fault_set(fault, ERR_USAGE, "--read-only: name the journal to look at");
    if (name && file_is_named(name, ".iftty") && !file_exists(name))
        return fault_set(fault, ERR_IO,
                         "there is no journal %s; `iftty SCENE --journal FILE` begins one", name);
    if (name && file_is_named(name, ".iftty") && !is_journal)
        return fault_set(fault, ERR_INPUT,
                         "%s has no header of a journal; `iftty run %s` carries out the commands "
                         "of a script, and `iftty SCENE --journal FILE` begins a journal",
                         name, name);
    if (is_journal && o->journal)
        return fault_set(fault, ERR_USAGE,
                         "%s is a journal, and is continued in its own file; leave out --journal",
                         name);
    return OK;
}

struct volume_choice begin_volume(const struct options *o, size_t which)
{
    struct volume_choice choice = {.has_volume = o->volume != NULL};
    if (o->volume)
        choice.volume = (uint32_t)scan_list_number(o->volume, which);
    return choice;
}

void begin_opening(struct buf *line, const char *file, bool is_channel)
{
    const bool is_number = is_channel && !file[strspn(file, "0123456789")];
    buf_clear(line);
    buf_add_text(line, is_number ? "channel ./" : is_channel ? "channel " : "open ");
    command_write_word(line, file);
}

void begin_journal_name(struct buf *journal, const char *first)
{
    const char *name = first ? file_name(first) : "session";
    const size_t n = strcspn(name, ".:");
    for (unsigned i = 1; i < 100000; i++) {
        buf_clear(journal);
        buf_add(journal, name, n ? n : strlen(name));
        buf_printf(journal, "-%u.iftty", i);
        if (!file_exists(buf_text(journal)))
            break;
    }
}

enum err end_journal(struct interpreter *interp, enum err err, struct fault *fault)
{
    struct fault words;
    const enum err synced = interp->journal ? journal_sync(interp->journal, &words) : OK;
    if (synced && !err)
        *fault = words;
    return err ? err : synced;
}

enum { LINKED_MOST = 1024, OUTSIDE_MOST = 16 };

/* Files for the confinement: scenes and channels, or targets of links in the journal's folder of
 * golden images. */
struct linked {
    char *path[LINKED_MOST + 1]; /* ended by NULL */
    size_t count;
};

static void linked_release(struct linked *linked)
{
    while (linked->count)
        free(linked->path[--linked->count]);
}

/* Add a path, unless it is known, empty or NULL. */
static enum err add_path(struct linked *linked, const char *path, struct fault *fault)
{
    bool is_known = !path || !*path;
    for (size_t i = 0; !is_known && i < linked->count; i++)
        is_known = strcmp(linked->path[i], path) == 0;
    if (is_known)
        return OK;
    linked->path[linked->count] = strdup(path);
    if (!linked->path[linked->count])
        return fault_memory(fault, "a path");
    linked->count++;
    return OK;
}

/* Find the files outside the journal's folder that T1 (command/trust.h) reads by the proof in a
 * record, except files that options replace. An unreadable journal is left to the replay. */
static enum err find_outside(struct linked *found, const struct options *o, const char *journal,
                             struct fault *fault)
{
    OWNED(buf_release) struct buf bytes = {0}, name = {0}, path = {0};
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    struct record_word word;
    const char *const *channel = o->channel;
    bool is_scene, is_part;
    if (!file_exists(journal) || walk_file(&walk, &bytes, journal, NULL) != OK)
        return OK;
    while (found->count < OUTSIDE_MOST && walk_next(&walk, &record) == WALK_RECORD) {
        buf_clear(&path);
        if (!command_opens(&name, &is_scene, &is_part, record.command))
            continue;
        const bool is_given = is_scene ? o->scene != NULL : *channel != NULL;
        channel += !is_scene && is_given;
        if (!is_given && !is_part &&
            record_word_find(record.result, "sha256", strlen("sha256"), &word) &&
            trust_find_outside(&path, journal, interpreter_scenes(), buf_text(&name)))
            TRY(add_path(found, buf_text(&path), fault));
        if (name.failed || path.failed)
            return fault_memory(fault, "a path");
    }
    return OK;
}

/* Look only at files that the journal's records name. An unreadable journal is left to the
 * replay. */
static void find_linked(struct linked *linked, const char *journal)
{
    OWNED(golden_files_close) struct golden_files files;
    OWNED(buf_release) struct buf bytes = {0}, path = {0};
    if (golden_files_open(&files, journal, false, NULL) == OK && files.folder >= 0 &&
        file_read(&bytes, journal, JOURNAL_BYTES_MAX, NULL) == OK &&
        golden_files_read(&files, buf_text(&bytes), bytes.length, NULL) == OK) {
        const char *name = buf_text(&files.named), *end = name + files.named.length;
        for (; name < end && linked->count < LINKED_MOST; name += strlen(name) + 1) {
            bool leads_out = false;
            buf_clear(&path);
            buf_printf(&path, "%s/%s", buf_text(&files.path), name);
            if (path.failed || trust_look_at_golden(buf_text(&path), &leads_out) != PATH_IS_FILE ||
                !leads_out)
                continue;
            linked->path[linked->count] = realpath(buf_text(&path), NULL);
            linked->count += linked->path[linked->count] != NULL;
        }
    }
}

enum err begin_confined(const struct options *o, const char *journal, const char *written,
                        struct fault *fault)
{
    OWNED(buf_release) struct buf images = {0}, volumes = {0}, goldens = {0};
    OWNED(linked_release) struct linked linked = {.count = 0}, given = {.count = 0};
    struct limits limits;
    TRY(limits_read(&limits, o->limit_memory, o->limit_time, o->limit_output, fault));
    TRY(coprocess_find(&images, IMAGE_HELPER, fault));
    TRY(coprocess_find(&volumes, VOLUME_HELPER, fault));
    TRY(golden_folder(&goldens, journal, fault));
    TRY(find_outside(&given, o, journal, fault));
    TRY(add_path(&given, o->scene, fault));
    for (unsigned i = 0; i < CHANNELS_MOST; i++)
        TRY(add_path(&given, o->channel[i], fault));
    find_linked(&linked, journal);
    char *path = (char *)(uintptr_t)journal;
    const char *const folders[] = {written, NULL};
    const struct trust_places places = {.journal = &path,
                                        .journals = 1,
                                        .goldens = buf_text(&goldens),
                                        .linked = (const char *const *)linked.path,
                                        .scenes = interpreter_scenes(),
                                        .given = (const char *const *)given.path,
                                        .helper = {buf_text(&images), buf_text(&volumes)},
                                        .written = folders};
    trust_confine(&places);
    limits_begin(&limits);
    volume_helper_needs_landlock = !o->unconfined;
    return OK;
}

enum err begin_one(void *context, const char *journal, struct fault *fault)
{
    const struct options *o = context;
    return begin_confined(o, journal, o->out, fault);
}

/* ---- pictures ---- */

unsigned shown_hues(uint32_t hue[256], const struct session *session)
{
    unsigned count = 0;
    uint8_t lightest[3];
    background_at(lightest, session->now.outlook.background, 0, 1);
    if (lightest[0] | lightest[1] | lightest[2])
        hue[count++] = (uint32_t)lightest[0] << 16 | (uint32_t)lightest[1] << 8 | lightest[2];
    for (unsigned label = 1; label < 256; label++) {
        const uint8_t *rgb = session->now.kept.palette.rgb[label];
        if (session->now.kept.visible[label] && session->tally.voxels[label])
            hue[count++] = (uint32_t)rgb[0] << 16 | (uint32_t)rgb[1] << 8 | rgb[2];
    }
    return count;
}

struct image_view shown_picture(struct interpreter *interp, bool smooth)
{
    static uint32_t hue[256];
    const struct canvas *shown = &interp->shown;
    const struct rendition *r = session_frame(interp->session);
    struct image_view view = {.width = r->width, .height = r->height, .rgba = r->rgba};
    if (!shown->rgba && r->rgba) /* transparent pixels are black without memory for it */
        session_show_frame(&interp->shown, interp->session, NULL);
    if (shown->rgba)
        view = (struct image_view){
            .width = shown->width, .height = shown->height, .rgba = shown->rgba};
    if (interp->session->has_scene && session_count_labels(interp->session, NULL) == OK) {
        view.hue = hue;
        view.hues = shown_hues(hue, interp->session);
    }
    view.smooth = smooth;
    return view;
}
