/* SPDX-License-Identifier: MIT */
/* Lists of seeds: what is read lies in the scene, each voxel once, with a label; the rest is
 * refused with the line that is wrong. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/buf.h"
#include "session/seed_file.h"

static void check(const struct seeds *seeds, const struct grid *grid, int label)
{
    for (size_t i = 0; i < seeds->count; i++) {
        const struct edit *edit = &seeds->edit[i];
        HOLDS(edit->cell < grid->cells && (i == 0 || edit->cell > edit[-1].cell));
        HOLDS(label == LABEL_OWN ? edit->label >= 0 && edit->label <= 255 : edit->label == label);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    static const char label_name[256][LABEL_NAME_BYTES] = {[2] = "brain", [9] = "left part"};
    struct grid grid;
    struct buf text = {0};
    HOLDS(grid_init(&grid, (const uint32_t[]){90, 80, 70}, NULL) == OK);
    buf_add(&text, bytes, length);
    for (int label = LABEL_OWN; label <= 3; label += 3 - LABEL_OWN) {
        struct seeds seeds = {0};
        struct fault fault = {.text = ""};
        const enum err err = seeds_from_list(&seeds, buf_text(&text), length, &grid, label_name,
                                             label, NULL, &fault);
        HOLDS(!err || (seeds.count == 0 && fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
        check(&seeds, &grid, label);
        seeds_release(&seeds);
    }
    buf_release(&text);
    return 0;
}
