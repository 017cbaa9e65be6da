#include "render/palette.h"

#include <string.h>

void palette_default(struct palette *palette, uint32_t look)
{
    (void)look;
    /* Sky, amber, green, rose, violet, sand, teal, brick: of different lightness too. */
    static const uint8_t hue[8][3] = {{214, 178, 150}, {86, 180, 233},  {240, 200, 66},
                                      {0, 158, 115},   {204, 121, 167}, {230, 130, 40},
                                      {130, 130, 220}, {190, 190, 190}};
    memset(palette, 0, sizeof *palette);
    for (int label = 1; label < 256; label++) {
        const uint8_t *base = hue[(label - 1) % 8];
        int dim = (label - 1) / 8 % 4; /* further rounds are darker */
        for (int k = 0; k < 3; k++)
            palette->rgb[label][k] = (uint8_t)(base[k] * (8 - dim) / 8);
    }
}
