/* SPDX-License-Identifier: MIT */
#include "verify/bisect.h"

#include <fcntl.h>
#include <fts.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "command/command.h"
#include "command/limits.h"
#include "verify/first_difference.h"
#include "verify/process.h"
#include "verify/replay_file.h"

enum { ERRORS_MOST = 1 << 20 };

/* ---- what is printed ---- */

static void write_place(struct buf *text, const struct first_difference *first, int which,
                        const char *name)
{
    buf_add_text(text, "#   in       ");
    buf_add_safe_text(text, name);
    if (first->side[which].goes_on) {
        buf_printf(text, ", line %zu: ", first->side[which].line);
        buf_add_safe_text(text, buf_text(&first->side[which].command));
    } else {
        buf_printf(text, ": it ends with record %zu", first->same);
    }
    buf_add_char(text, '\n');
}

/* `more`: lines to be printed after those of a difference, of each. */
static enum err compare(const char *const path[2], const char *const name[2],
                        const char *const more[2], const struct printer *printer,
                        struct fault *fault)
{
    struct first_difference first = {0};
    struct buf text = {0};
    enum err err = first_difference_of_files(&first, FIRST_RECORD, name, path, 0, fault);
    if (!err && !first.is_there && *more[0] && *more[1]) {
        printer->print(printer->context, more[0]);
        printer->print(printer->context, more[1]);
        err = fault_set(fault, ERR_INPUT, "neither build carries out what follows record %zu",
                        first.same);
    }
    if (!err) {
        buf_printf(&text, "%s 1 - ", first.is_there ? "not ok" : "ok");
        buf_add_safe_text(&text, name[0]);
        buf_add_text(&text, " and ");
        buf_add_safe_text(&text, name[1]);
        buf_printf(&text, " (%zu record%s the same)\n", first.same, plural(first.same));
        const struct buf *one = &first.side[0].command, *other = &first.side[1].command;
        const bool are_there = first.side[0].goes_on && first.side[1].goes_on;
        const bool is_result = are_there && command_is_same(buf_text(one), buf_text(other));
        if (first.is_there) {
            buf_printf(&text, "# record %zu is the first that differs: %s\n", first.same + 1,
                       is_result    ? "the same command gives another result"
                       : !are_there ? "only one of the two goes on"
                                    : "another command stands there");
            write_place(&text, &first, 0, name[0]);
            write_place(&text, &first, 1, name[1]);
        }
        if (is_result)
            divergence_describe(&text, buf_text(&first.side[0].result),
                                buf_text(&first.side[1].result), DIVERGENCE_OF_JOURNALS);
        buf_printf(&text, "%s%s1..1\n", more[0], more[1]);
        err = text.failed ? fault_memory(fault, "a report") : OK;
    }
    if (!err)
        printer->print(printer->context, buf_text(&text));
    if (!err && first.is_there)
        err = fault_set(fault, ERR_CHECK, "record %zu is the first that differs", first.same + 1);
    buf_release(&text);
    first_difference_release(&first);
    return err;
}

/* ---- two journals ---- */

enum err bisect_journals(const char *a, const char *b, const struct printer *printer,
                         struct fault *fault)
{
    const char *const path[2] = {a, b}, *const more[2] = {"", ""};
    return compare(path, path, more, printer, fault);
}

/* ---- two builds ---- */

/* This program, and the other: each writes a journal of its own below a folder that goes away with
 * both. */
struct builds {
    const struct bisect_builds *how;
    struct buf commands, scene; /* paths from the root; a scene that is no path, or "" */
    struct buf folder;
    struct side {
        const char *name;
        struct buf program, folder, journal;
        struct buf words; /* why it ended early: "# ..." lines, or "" */
    } side[2];
    struct process_end end[2]; /* with what they printed to standard error */
};

/* From the root, since each build works where the journal lies. */
static enum err whole_path(struct buf *out, const char *path, struct fault *fault)
{
    char whole[PATH_MAX];
    if (!realpath(path, whole))
        return fault_errno(fault, "find", path);
    buf_add_text(out, whole);
    return out->failed ? fault_memory(fault, "a path") : OK;
}

static enum err prepare_side(struct builds *b, struct side *side, const char *name,
                             const char *program, struct fault *fault)
{
    enum err err = whole_path(&side->program, program, fault);
    buf_printf(&side->folder, "%s/%s", buf_text(&b->folder), name);
    buf_printf(&side->journal, "%s/commands.iftty", buf_text(&side->folder));
    if (!err && (side->folder.failed || side->journal.failed))
        err = fault_memory(fault, "a path");
    return err ? err : file_make_folder(buf_text(&side->folder), fault);
}

/* Where the journal lies, and with nothing to read. What it prints to standard error is handed
 * back. */
static void become(void *context, size_t number, struct buf *out)
{
    const struct builds *b = context;
    const struct side *side = &b->side[number];
    const char *argument[] = {buf_text(&side->program), b->how->word,
                              buf_text(&b->commands),   "--journal",
                              buf_text(&side->journal), "--out",
                              buf_text(&side->folder),  b->how->scene_path ? "--scene" : NULL,
                              buf_text(&b->scene),      NULL};
    struct buf place = {0};
    const int nothing = open("/dev/null", O_RDWR);
    (void)out;
    file_folder(&place, buf_text(&b->commands));
    if (!b->scene.failed && nothing >= 0 && dup2(nothing, 0) >= 0 && dup2(nothing, 1) >= 0 &&
        !place.failed && chdir(buf_text(&place)) == 0)
        execv(argument[0], (char *const *)(uintptr_t)argument);
    _exit(127);
}

/* What both hold now, and have written so far, counts as this process's own. */
static void count(void *context, uint64_t held_bytes)
{
    const struct builds *b = context;
    char *const folder[] = {b->folder.data, NULL};
    FTS *tree = fts_open(folder, FTS_PHYSICAL | FTS_NOCHDIR, NULL);
    uint64_t written_bytes = 0;
    for (const FTSENT *entry; tree && (entry = fts_read(tree));)
        written_bytes += entry->fts_info == FTS_F ? (uint64_t)entry->fts_statp->st_size : 0;
    if (tree)
        fts_close(tree);
    limits_count(held_bytes, written_bytes);
}

static enum err run_both(struct builds *b, struct fault *fault)
{
    const struct buf nothing = {0};
    const struct processes both = {.count = 2,
                                   .at_once = 2,
                                   .most = ERRORS_MOST,
                                   .takes_errors = true,
                                   .context = b,
                                   .work = become,
                                   .end = b->end,
                                   .tick = count,
                                   .watch = b->how->watch,
                                   .what = "replaying"};
    const char *const program[] = {buf_text(&b->side[0].program), buf_text(&b->side[1].program),
                                   NULL};
    enum err err = b->how->begin(b->how->context, buf_text(&b->folder), program, fault);
    if (err)
        return err;
    limits_will_write();
    err = processes_run(&both, fault);
    if (err == ERR_CANCELLED)
        fault_set(fault, err, "cancelled; the two builds were ended");
    return limits_judge(err, &nothing, fault);
}

/* What became of one that did not carry everything out. */
static enum err judge(struct side *side, const struct process_end *end, struct fault *fault)
{
    struct buf *words = &side->words;
    if (!file_exists(buf_text(&side->journal)))
        return fault_set(fault, ERR_IO, "%s could not be started, or wrote no journal", side->name);
    if (WIFEXITED(end->status) && WEXITSTATUS(end->status) == 0)
        return OK;
    buf_add_text(words, "#   ended    ");
    buf_add_safe_text(words, side->name);
    if (WIFSIGNALED(end->status))
        buf_printf(words, " by signal %d (%s)", WTERMSIG(end->status),
                   strsignal(WTERMSIG(end->status)));
    else
        buf_printf(words, " with status %d", WEXITSTATUS(end->status));
    if (end->bytes.length) {
        buf_add_text(words, ": ");
        buf_add_safe(words, buf_text(&end->bytes), strcspn(buf_text(&end->bytes), "\n"));
    }
    buf_add_char(words, '\n');
    return words->failed ? fault_memory(fault, "a report") : OK;
}

enum err bisect_builds(const struct bisect_builds *how, const struct printer *printer,
                       struct fault *fault)
{
    struct builds b = {.how = how, .side = {{.name = "this build"}, {.name = how->other}}};
    enum err err = whole_path(&b.commands, how->journal, fault);
    if (!err && how->scene_path && file_exists(how->scene_path))
        err = whole_path(&b.scene, how->scene_path, fault);
    else if (how->scene_path)
        buf_add_text(&b.scene, how->scene_path);
    if (!err)
        err = folder_passing(&b.folder, NULL, fault);
    if (!err)
        err = prepare_side(&b, b.side, "this", "/proc/self/exe", fault);
    if (!err)
        err = prepare_side(&b, b.side + 1, "other", how->other, fault);
    if (!err)
        err = run_both(&b, fault);
    for (int i = 0; !err && i < 2; i++)
        err = judge(b.side + i, b.end + i, fault);
    if (!err) {
        const char *const path[2] = {buf_text(&b.side[0].journal), buf_text(&b.side[1].journal)};
        const char *const name[2] = {b.side[0].name, b.side[1].name};
        const char *const more[2] = {buf_text(&b.side[0].words), buf_text(&b.side[1].words)};
        err = compare(path, name, more, printer, fault);
    }
    for (int i = 0; i < 2; i++) {
        buf_release(&b.side[i].program);
        buf_release(&b.side[i].folder);
        buf_release(&b.side[i].journal);
        buf_release(&b.side[i].words);
        buf_release(&b.end[i].bytes);
    }
    if (b.folder.length)
        folder_remove(buf_text(&b.folder));
    buf_release(&b.folder);
    buf_release(&b.commands);
    buf_release(&b.scene);
    return err;
}
