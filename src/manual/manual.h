/*
 * The manual and the completions of shells, made of the tables of programs, options and commands:
 * what a table has, they have, and nothing of them is written by hand.
 *
 * The pages are in the macros of man(7), which groff and mandoc both set. `iftty-manual FOLDER`
 * writes all of it when iftty is built (manual_files.c); it is not installed.
 */
#ifndef MANUAL_MANUAL_H
#define MANUAL_MANUAL_H

#include <stdbool.h>

#include "base/buf.h"

/* iftty(1), iftty-journal(5), and the page of the program of that name: iftty-verify(1). */
void manual_page(struct buf *out);
void manual_journal_page(struct buf *out);
void manual_program_page(struct buf *out, const char *name);

/* Whether a row of the table of programs is the first one with its name. */
bool manual_is_first(unsigned row);

/* What the shell is to read before it completes a line of iftty. */
void completion_bash(struct buf *out);
void completion_zsh(struct buf *out);
void completion_fish(struct buf *out);

#endif
