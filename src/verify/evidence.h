/* SPDX-License-Identifier: MIT */
/*
 * Evidence for a person who looks into a failure: what was expected, what was drawn, and where the
 * two differ; in a folder, and as PNG in memory for a report. Evidence that cannot be had is left
 * out: the words of the failure stand without it.
 *
 * A golden image that is the same is evidence as well, and people look at the PNG beside it: what
 * is shown has to be what was compared. Each pixel is that of the golden image, its colours over
 * their background; each text is a note of the golden image, or says when the PNG was drawn; and
 * nothing else is in it (image/png.h). Every verification asks for that, so what proves the
 * golden image proves the PNG. One that is not there shows nothing, and nothing asks for it.
 */
#ifndef VERIFY_EVIDENCE_H
#define VERIFY_EVIDENCE_H

#include "base/buf.h"
#include "command/golden_files.h"

enum { EVIDENCE_MOST = 3 };

/* Begins as {0}. */
struct evidence {
    const char *folder; /* for JOURNAL.NAME.actual.exr and .difference.png; NULL: none */
    bool has_pictures;  /* pictures of a failure are collected as PNG, over black, as seen */
    struct {
        struct buf caption, png;
    } picture[EVIDENCE_MOST];
    size_t pictures;
    uint64_t goldens, pixels; /* golden images that are the same, and their pixels */
};

void evidence_add(struct evidence *evidence, const char *caption, uint32_t width, uint32_t height,
                  const uint8_t *rgba);
void evidence_release(struct evidence *evidence);

/* The judge that refuses every golden image that differs, collects evidence of it, and counts those
 * that do not, whose PNGs it judges. It borrows the evidence. */
struct golden_judge evidence_judge(struct evidence *evidence);

#endif
