/*
 * What it means that a command gave other results than are recorded: in words, from the result
 * words alone ("forest=0123456789abcdef labels=... seeds=12"). Which words commands have is known
 * here and where they are made (command/interpreter.c, act_*.c), and nowhere below.
 */
#ifndef VERIFY_DIVERGENCE_H
#define VERIFY_DIVERGENCE_H

#include "base/buf.h"

/* Which two results differ, and so what they are called. */
enum divergence_of {
    DIVERGENCE_OF_REPLAY,  /* "7 was recorded, 9 now" */
    DIVERGENCE_OF_JOURNALS /* "7 in the first, 9 in the second" */
};

/* Adds lines "#   meaning   ..." : whether labels or only keys differ, or a picture, or what the
 * command read; then a line for each word that differs, counts with how many more or less, and one
 * for those that are the same. Safe to print. */
void divergence_describe(struct buf *lines, const char *expected, const char *actual,
                         enum divergence_of of);

#endif
