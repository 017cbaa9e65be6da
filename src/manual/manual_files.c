/* SPDX-License-Identifier: MIT */
/* iftty-manual FOLDER FORMAT.md: writes the manual and the completions below a folder, laid out as
 * below PREFIX/share. It runs where iftty is built, and is no part of it. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "manual/manual.h"
#include "program/program.h"

/* Makes the folders on the way to a file. */
static bool make_folders(char *path)
{
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        const bool is_there = mkdir(path, 0777) == 0 || errno == EEXIST;
        *slash = '/';
        if (!is_there)
            return false;
    }
    return true;
}

/* Empties both. False, after a line on standard error, where it cannot be written. */
static bool write_file(struct buf *path, struct buf *text)
{
    bool written = false;
    if (!path->failed && !text->failed && make_folders(path->data)) {
        FILE *file = fopen(path->data, "w");
        written = file && fwrite(text->data, 1, text->length, file) == text->length;
        written = file && fclose(file) == 0 && written;
    }
    if (!written)
        fprintf(stderr, "iftty-manual: cannot write %s: %s\n", buf_text(path), strerror(errno));
    buf_clear(path);
    buf_clear(text);
    return written;
}

/* False, after a line on standard error. */
static bool add_journal_page(struct buf *out, const char *path)
{
    struct buf format = {0};
    struct fault fault = {0};
    unsigned wrong = 0;
    if (file_read(&format, path, 1 << 20, &fault) != OK)
        fprintf(stderr, "iftty-manual: %s\n", fault.text);
    else if ((wrong = manual_journal_page(out, buf_text(&format))) != 0)
        fprintf(stderr, "iftty-manual: %s:%u: written as no page can be (src/manual/markdown.h)\n",
                path, wrong);
    buf_release(&format);
    return fault.code == OK && !wrong;
}

int main(int count, char **word)
{
    static const struct {
        const char *path;
        void (*add)(struct buf *out);
    } single[] = {
        {"man/man1/iftty.1", manual_page},
        {"bash-completion/completions/iftty", completion_bash},
        {"zsh/site-functions/_iftty", completion_zsh},
        {"fish/vendor_completions.d/iftty.fish", completion_fish},
    };
    struct buf path = {0}, text = {0};
    if (count != 3) {
        fputs("expected `iftty-manual FOLDER FORMAT.md`\n", stderr);
        return 2;
    }
    buf_printf(&path, "%s/man/man5/iftty-journal.5", word[1]);
    bool written = add_journal_page(&text, word[2]) && write_file(&path, &text);
    for (size_t i = 0; written && i < sizeof single / sizeof single[0]; i++) {
        buf_printf(&path, "%s/%s", word[1], single[i].path);
        single[i].add(&text);
        written = write_file(&path, &text);
    }
    for (unsigned i = 0; written && i < program_table.rows; i++) {
        const char *name = manual_new_name(i);
        if (!name)
            continue;
        buf_printf(&path, "%s/man/man1/iftty-%s.1", word[1], name);
        manual_program_page(&text, name);
        written = write_file(&path, &text);
    }
    buf_release(&path);
    buf_release(&text);
    return written ? 0 : 3;
}
