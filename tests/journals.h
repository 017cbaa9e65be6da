/* SPDX-License-Identifier: MIT */
/* Journals as files: their records in the tests of the file layer, and an audit of them. */
#ifndef TESTS_JOURNALS_H
#define TESTS_JOURNALS_H

#include <unistd.h>

#include "base/buf.h"
#include "base/file.h"
#include "journal/journal.h"
#include "tests/check.h"

static inline void content(struct buf *out, const char *path)
{
    CHECK(file_read(out, path, JOURNAL_BYTES_MAX, NULL) == OK);
}

static inline void put(const char *path, const void *bytes, size_t length)
{
    CHECK(file_write(path, bytes, length, FILE_REPLACE, NULL) == OK);
}

static inline bool is_file_of(const char *path, const void *bytes, size_t length)
{
    OWNED(buf_release) struct buf found = {0};
    content(&found, path);
    const bool same =
        found.length == length && (length == 0 || memcmp(found.data, bytes, length) == 0);
    return same;
}

/* The command and words of record n of every journal here. */
static inline enum err append(struct journal *journal, size_t n, struct fault *why)
{
    char command[64], words[64];
    snprintf(command, sizeof command, "seed %zu,2,3 1", n);
    snprintf(words, sizeof words, "forest=%016zx seeds=%zu", n * 77, n);
    if (n % 3 == 0)
        CHECK(journal_comment(journal, "# every third", NULL) == OK);
    return journal_append(journal, command, words, why);
}

/* A new journal of `records`, open. */
static inline struct journal *make_journal(const char *path, size_t records)
{
    struct journal *journal;
    unlink(path);
    if (!CHECK(journal_create(&journal, path, 1, NULL) == OK))
        abort();
    for (size_t n = 1; n <= records; n++)
        CHECK(append(journal, n, NULL) == OK);
    return journal;
}

/*
 *   J2 the journal is sound, and has no torn record;
 *   J3 its file holds every byte that was acknowledged and nothing else, also after an append that
 *      failed and was cut off.
 */
static inline bool journal_audit(const struct journal *journal)
{
    int (*const hook)(enum file_step step, const char *path) = file_step_hook;
    const struct buf *kept = journal_bytes(journal);
    struct journal_condition condition;
    OWNED(buf_release) struct buf found = {0};
    file_step_hook = NULL;
    const bool is_fine =
        journal_check(&condition, buf_text(kept), kept->length, NULL) == OK &&
        condition.state == JOURNAL_INTACT && condition.records == journal_count(journal) &&
        strcmp(condition.chain.hex, journal_chain(journal)) == 0 &&
        file_read(&found, journal_path(journal), JOURNAL_BYTES_MAX, NULL) == OK &&
        found.length == kept->length && memcmp(found.data, kept->data, kept->length) == 0;
    file_step_hook = hook;
    return is_fine;
}

#endif
