/* The colours of labels. */
#ifndef RENDER_PALETTE_H
#define RENDER_PALETTE_H

#include <stdint.h>

struct palette {
    uint8_t rgb[256][3]; /* sRGB, per label */
};

/* Distinct colours, also for people who do not distinguish red from green, in turn. */
void palette_default(struct palette *palette);

#endif
