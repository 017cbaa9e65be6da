/* SPDX-License-Identifier: MIT */
/*
 * The colours of labels.
 *
 * Those that a session begins with stand off grey, which slices are, off the yellows of the
 * cross-hair and of the pilot's frames, off the red of eliminators, and off one another; also for
 * eyes without long, middle or short cones. Label 1 and 2, then 3, ... are furthest apart.
 *
 * Distances are those of OKLab (Ottosson 2020) in 10 000ths; 200 is about what can just be told
 * apart side by side. What an eye without one kind of cones sees is that of Machado, Oliveira and
 * Fernandes (2009). tests/test_palette.c measures them.
 */
#ifndef RENDER_PALETTE_H
#define RENDER_PALETTE_H

#include <stdint.h>

struct palette {
    uint8_t rgb[256][3]; /* sRGB, per label */
};

/* No distance is less, for eyes with all cones, and for each of the others. */
enum {
    PALETTE_CHOSEN = 16, /* labels whose colours were searched for together */

    PALETTE_APART_4 = 2890, /* of labels 1 to 4 from one another, */
    PALETTE_APART_4_BLIND = 1220,
    PALETTE_APART_8 = 1680, /* of labels 1 to 8, */
    PALETTE_APART_8_BLIND = 885,
    PALETTE_APART_16 = 1090, /* of labels 1 to 16, */
    PALETTE_APART_16_BLIND = 610,
    PALETTE_APART_NEAR = 890, /* from 17 on, of the twelve before it, */
    PALETTE_APART_NEAR_BLIND = 440,
    PALETTE_APART_ALL = 220, /* of any two, */
    PALETTE_APART_ALL_BLIND = 100,

    PALETTE_OFF_GREY = 1230, /* of labels 1 to 16 from the nearest grey, */
    PALETTE_OFF_GREY_BLIND = 530,
    PALETTE_OFF_GREY_ALL = 700, /* of any, */
    PALETTE_OFF_GREY_ALL_BLIND = 200,
    PALETTE_OFF_MARKS = 1150, /* of labels 1 to 16 from those yellows, */
    PALETTE_OFF_MARKS_BLIND = 670,
    PALETTE_OFF_MARKS_ALL = 500, /* and of any */
    PALETTE_OFF_MARKS_ALL_BLIND = 250,
};

void palette_default(struct palette *palette);

#endif
