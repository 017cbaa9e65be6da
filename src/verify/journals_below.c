/* SPDX-License-Identifier: MIT */
#include "verify/journals_below.h"

#include <errno.h>
#include <fts.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/buf.h"
#include "base/file.h"
#include "base/mem.h"

enum { JOURNALS_MOST = 100000 };

static enum err add(struct journal_list *journals, const char *path, struct fault *fault)
{
    if (journals->count == JOURNALS_MOST)
        return fault_set(fault, ERR_LIMIT, "there are more than %d journals; name fewer folders",
                         JOURNALS_MOST);
    char *copy = strdup(path);
    if (!copy || !mem_grow(&journals->path, &journals->capacity, journals->count + 1,
                           sizeof *journals->path)) {
        free(copy);
        return fault_memory(fault, "names of journals");
    }
    journals->path[journals->count++] = copy;
    return OK;
}

static void tell_link(const char *path, const struct printer *printer)
{
    struct buf line = {0};
    buf_add_text(&line, "# not entered: ");
    buf_add_safe_text(&line, path);
    buf_add_text(&line, " is a link to a folder; name that folder as well to verify it\n");
    printer->warn(printer->context, buf_text(&line));
    buf_release(&line);
}

static int compare_names(const FTSENT **a, const FTSENT **b)
{
    return strcmp((*a)->fts_name, (*b)->fts_name);
}

static enum err add_below(struct journal_list *journals, const char *folder,
                          const struct printer *printer, struct fault *fault)
{
    char *const top[] = {(char *)(uintptr_t)folder, NULL};
    const size_t before = journals->count;
    enum err err = OK;
    /* A link in the place of a journal is judged as one, and never followed to a folder. */
    const int follow = file_is_named(folder, ".iftty") ? 0 : FTS_COMFOLLOW;
    FTS *tree = fts_open(top, FTS_PHYSICAL | FTS_NOCHDIR | follow, compare_names);
    FTSENT *entry = NULL;
    while (tree && !err && (entry = fts_read(tree))) {
        const bool is_folder = entry->fts_info == FTS_D || entry->fts_info == FTS_DP;
        if (entry->fts_errno) {
            errno = entry->fts_errno;
            err = fault_errno(fault, "enter", entry->fts_path);
        } else if (!is_folder && file_is_named(entry->fts_path, ".iftty")) {
            err = add(journals, entry->fts_path, fault);
        } else if (entry->fts_info == FTS_SL && file_is_folder(entry->fts_path)) {
            tell_link(entry->fts_path, printer);
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

enum err journals_find(struct journal_list *journals, char *const *path, size_t count,
                       const struct printer *printer, struct fault *fault)
{
    enum err err = OK;
    for (size_t i = 0; !err && i < count; i++)
        err = file_is_folder(path[i]) ? add_below(journals, path[i], printer, fault)
                                      : add(journals, path[i], fault);
    return err;
}

void journals_release(struct journal_list *journals)
{
    for (size_t i = 0; i < journals->count; i++)
        free(journals->path[i]);
    free(journals->path);
}
