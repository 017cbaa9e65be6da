/* SPDX-License-Identifier: MIT */
/* nudge FILE.exr PLANE: changes one sample of one plane of a golden image by the smallest possible
 * amount, in the middle of its object, and writes it again. PLANE is colour, depth, label or
 * voxel. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "image/exr.h"
#include "image/exr_write.h"

/* The pixel in the middle of the object's pixels. */
static size_t pixel_in_the_middle(const struct picture *p)
{
    const size_t pixels = (size_t)p->width * p->height;
    size_t seen = 0, at = 0;
    for (size_t i = 0; i < pixels; i++)
        seen += p->label[i] != 0;
    for (size_t left = seen / 2; left || !p->label[at]; at++)
        left -= p->label[at] != 0;
    return at;
}

static void nudge(struct picture *p, const char *plane)
{
    const size_t at = pixel_in_the_middle(p);
    uint32_t bits;
    if (strcmp(plane, "colour") == 0)
        p->rgba[4 * at + 1] ^= 1;
    if (strcmp(plane, "label") == 0)
        p->label[at] ^= 1;
    if (strcmp(plane, "voxel") == 0)
        p->voxel[at] ^= 1;
    if (strcmp(plane, "depth") == 0) {
        memcpy(&bits, &p->depth_mm[at], sizeof bits);
        bits ^= 1;
        memcpy(&p->depth_mm[at], &bits, sizeof bits);
    }
}

int main(int count, char **word)
{
    OWNED(picture_release) struct picture picture = {0};
    struct fault fault = {.text = "nudge FILE.exr PLANE"};
    if (count != 3 || exr_read(&picture, word[1], &fault)) {
        fprintf(stderr, "%s\n", fault.text);
        return 1;
    }
    nudge(&picture, word[2]);
    return strips_write(&exr_strips, word[1], FILE_REPLACE, &picture, &fault) != OK;
}
