/* SPDX-License-Identifier: MIT */
/*
 * The manual and the completions of shells, made of the tables of programs, options and commands:
 * what a table has, they have; by hand are the few sentences between. The format of journals is
 * that of journal/FORMAT.md.
 *
 * The pages are in the macros of man(7), which groff and mandoc both set. `iftty-manual FOLDER
 * FORMAT.md` writes all of it when iftty is built (manual_files.c); it is not installed.
 */
#ifndef MANUAL_MANUAL_H
#define MANUAL_MANUAL_H

#include <stdbool.h>

#include "base/buf.h"

/* iftty(1), and the page of the program of that name: iftty-verify(1). */
void manual_page(struct buf *out);
void manual_program_page(struct buf *out, const char *name);

/* iftty-journal(5), with the text of FORMAT.md; 0, or the line of that which could not be set. */
unsigned manual_journal_page(struct buf *out, const char *format);

/* Whether a row of the table of programs is of that name, NULL for those without one. */
bool manual_has_name(unsigned row, const char *name);

/* The name of a row, so that each comes once: NULL where a former row has it, or there is none. */
const char *manual_new_name(unsigned row);

/* What the program of a name does, in the words of its first form. */
const char *manual_summary(const char *name);

/* What the shell is to read before it completes a line of iftty. */
void completion_bash(struct buf *out);
void completion_zsh(struct buf *out);
void completion_fish(struct buf *out);

#endif
