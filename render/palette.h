/* The colours of labels. */
#ifndef RENDER_PALETTE_H
#define RENDER_PALETTE_H

#include <stdint.h>

struct palette {
    uint8_t rgb[256][3]; /* sRGB, per label */
};

/* Distinct colours, also for people who do not distinguish red from green, in turn; `look` is the
 * number of a look (render/look.h). */
void palette_default(struct palette *palette, uint32_t look);

#endif
