/* SPDX-License-Identifier: MIT */
/* `iftty replay`, `iftty verify` and its forms, `iftty log --reseal`, `iftty diff`. */
#include <errno.h>
#include <fts.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/mem.h"
#include "base/scan.h"
#include "journal/journal.h"
#include "program/programs.h"
#include "verify/verify.h"
#include "verify/replay_file.h"

/* ---- replay ---- */

enum err run_replay(const struct options *o, struct fault *fault)
{
    OWNED(buf_release) struct buf fresh = {0}, text = {0};
    struct options here = *o;
    TRY(o->out ? file_make_folder(o->out, fault) : folder_held(&fresh, NULL, fault));
    here.out = o->out ? o->out : buf_text(&fresh);
    console_handle_interrupts();
    enum err err = begin_confined(o, o->word[0], here.out, fault);
    if (!err) {
        OWNED(interpreter_release) struct interpreter interp;
        err = begin_by_options(&interp, &here, fault);
        if (!err)
            err = replay_aloud(&interp, o->word[0], &console_printer, fault);
    }
    /* Remove the temporary folder if no file was written. */
    if (!o->out && folder_release(here.out)) {
        buf_add_safe_text(&text, here.out);
        console_erase_progress();
        fprintf(stderr, "# files are in %s\n", buf_text(&text));
    }
    return err;
}

/* ---- the journals to verify ---- */

/*
 * The journals to verify: files that the user names, and all journals below named folders.
 *
 * A file is a journal by the ending ".iftty", in any letter case. Hidden folders are entered. Links
 * to folders are not followed, since they may lead out or in a circle; each is reported.
 */
/* Begins as {0}. */
struct journal_list {
    char **path;
    size_t count, capacity;
};

enum { JOURNALS_MOST = 100000 };

static enum err add_journal(struct journal_list *journals, const char *path, struct fault *fault)
{
    if (journals->count == JOURNALS_MOST)
        return fault_set(fault, ERR_LIMIT, "there are more than %d journals; name fewer folders",
                         JOURNALS_MOST);
    if (!mem_grow(&journals->path, &journals->capacity, journals->count + 1,
                  sizeof *journals->path) ||
        !(journals->path[journals->count] = strdup(path)))
        return fault_memory(fault, "names of journals");
    journals->count++;
    return OK;
}

static int compare_names(const FTSENT **a, const FTSENT **b)
{
    return strcmp((*a)->fts_name, (*b)->fts_name);
}

static enum err add_below(struct journal_list *journals, const char *folder, struct fault *fault)
{
    char *const top[] = {(char *)(uintptr_t)folder, NULL};
    const size_t before = journals->count;
    enum err err = OK;
    /* A link with the name of a journal counts as a journal, and is not followed to a folder. */
    const int follow = file_is_named(folder, ".iftty") ? 0 : FTS_COMFOLLOW;
    FTS *tree = fts_open(top, FTS_PHYSICAL | FTS_NOCHDIR | follow, compare_names);
    FTSENT *entry = NULL;
    while (tree && !err && (entry = fts_read(tree))) {
        const bool is_folder = entry->fts_info == FTS_D || entry->fts_info == FTS_DP;
        if (entry->fts_errno) {
            errno = entry->fts_errno;
            err = fault_errno(fault, "enter", entry->fts_path);
        } else if (!is_folder && file_is_named(entry->fts_path, ".iftty")) {
            err = add_journal(journals, entry->fts_path, fault);
        } else if (entry->fts_info == FTS_SL && file_is_folder(entry->fts_path)) {
            OWNED(buf_release) struct buf line = {0};
            buf_add_text(&line, "# not entered: ");
            buf_add_safe_text(&line, entry->fts_path);
            buf_add_text(&line, " is a link to a folder; name that folder as well to verify it\n");
            console_warn(NULL, buf_text(&line));
        }
    }
    if (!err && !entry && errno)
        err = fault_errno(fault, "read the folder", folder);
    if (tree)
        fts_close(tree);
    if (!err && journals->count == before)
        err = fault_set(fault, ERR_CHECK, "there is no journal *.iftty in %s or below", folder);
    return err;
}

static void journals_release(struct journal_list *journals)
{
    for (size_t i = 0; i < journals->count; i++)
        free(journals->path[i]);
    free(journals->path);
}

/* ---- shards ---- */

/*
 * Sharing journals between machines: "2/5" is the second of five parts. The SHA-256 of a journal's
 * bytes selects its part: not its place in the list, so that a new journal moves no other, and not
 * its path, so that machines may keep it in different places. So every journal is in exactly one
 * part. An unreadable one is in all of them, where it fails.
 */

enum { SHARDS_MOST = 10000 };

/* Keep the journals of the shard "K/N" alone, in their order. */
static enum err shard_keep(struct journal_list *journals, const char *text, struct fault *fault)
{
    int64_t number, of;
    size_t kept = 0;
    const char *at = text;
    if (!scan_integer(&at, 1, SHARDS_MOST, &number) || !scan_text(&at, "/") ||
        !scan_integer(&at, number, SHARDS_MOST, &of) || *at)
        return fault_set(fault, ERR_USAGE, "--shard: expected K/N, as 1/4 to 4/4, not %s", text);
    for (size_t i = 0; i < journals->count; i++) {
        OWNED(buf_release) struct buf bytes = {0};
        char hex[SHA256_HEX];
        uint64_t first;
        bool is_kept = true;
        if (!file_read(&bytes, journals->path[i], JOURNAL_BYTES_MAX, NULL)) {
            const char *digit = hex;
            sha256_bytes_hex(hex, buf_text(&bytes), bytes.length);
            hex[16] = '\0';
            is_kept = !scan_hex(&digit, 16, &first) || first % (uint64_t)of == (uint64_t)number - 1;
        }
        if (is_kept)
            journals->path[kept++] = journals->path[i];
        else
            free(journals->path[i]);
    }
    journals->count = kept;
    return OK;
}

/* ---- verify ---- */

/* Check combinations of options. */
static enum err check_options(const struct options *o, struct fault *fault)
{
    const struct verify_options *how = &o->verify;
    if (how->last && how->first > how->last)
        return fault_set(fault, ERR_USAGE, "--from %zu --until %zu: no record is between",
                         how->first, how->last);
    if (how->strict && o->no_strict)
        return fault_set(fault, ERR_USAGE, "--strict and --no-strict: give one of them");
    if (how->expect && (o->words != 1 || !scan_is_hex(how->expect, RECORD_CHAIN_DIGITS)))
        return fault_set(fault, ERR_USAGE,
                         "--expect: expected one journal, and the 32 digits of its last chain");
    if (how->removes_orphans && ci_is_set())
        return fault_set(fault, ERR_USAGE,
                         "--remove-orphans is a person's decision, and refused where CI is set");
    return OK;
}

static enum err verify_journals(const struct options *o, const struct journal_list *journals,
                                struct fault *fault)
{
    struct verify_options how = o->verify;
    how.path = journals->path;
    how.count = journals->count;
    how.scene_path = o->scene;
    how.channel_path = o->channel;
    how.evidence_folder = o->out;
    how.json = o->json;
    how.strict = how.strict || (ci_is_set() && !o->no_strict);
    how.begin = begin_one;
    how.context = (void *)(uintptr_t)o;
    how.watch = console_watch();
    if (how.expect && journals->count != 1)
        return fault_set(fault, ERR_USAGE, "--expect: expected one journal, not %zu",
                         journals->count);
    TRY(o->out ? file_make_folder(o->out, fault) : OK);
    console_handle_interrupts();
    return verify_files(&how, &console_printer, fault);
}

enum err run_verify(const struct options *o, struct fault *fault)
{
    OWNED(journals_release) struct journal_list journals = {0};
    TRY(check_options(o, fault));
    /* In the order of the paths, those below a folder sorted by name. */
    for (int i = 0; i < o->words; i++)
        TRY((file_is_folder(o->word[i]) ? add_below : add_journal)(&journals, o->word[i], fault));
    if (o->shard)
        TRY(shard_keep(&journals, o->shard, fault));
    return verify_journals(o, &journals, fault);
}

/* ---- the first record that differs ---- */

enum err run_verify_bisect(const struct options *o, struct fault *fault)
{
    console_handle_interrupts();
    return bisect_journals(o->word[0], o->word[1], &console_printer, fault);
}

enum err run_diff(const struct options *o, struct fault *fault)
{
    const struct diff_options how = {.path = {o->word[0], o->word[1]},
                                     .side = {.scene_path = o->scene,
                                              .channel_path = o->channel,
                                              .last = o->until,
                                              .begin = begin_one,
                                              .context = (void *)(uintptr_t)o,
                                              .watch = console_watch()},
                                     .picture = o->picture,
                                     .json = o->json};
    console_handle_interrupts();
    return diff_journals(&how, &console_printer, fault);
}

/* ---- accepting and resealing ---- */

/* Reseal an edited journal by `log --reseal`, which is a form; accept pictures by `verify`. */
enum err run_reseal(const struct options *o, struct fault *fault)
{
    OWNED(interpreter_release) struct interpreter interp;
    console_handle_interrupts();
    TRY(begin_by_options(&interp, o, fault));
    return o->is_form
               ? reseal_edited(&interp, o->word[0], o->accept, &console_printer, fault)
               : reseal_accept(&interp, o->word[0], o->accept, o->only, &console_printer, fault);
}
