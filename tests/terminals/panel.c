/* SPDX-License-Identifier: MIT */
/* Expected picture of the pilot: panel JOURNAL COLUMNS ROWS CELL_WIDTH CELL_HEIGHT PANE OUT
 *
 * Carries the journal out in a process of its own, without a terminal, and draws the state that it
 * leaves, as the pilot would with PANE marked (0 axial, 1 coronal, 2 sagittal), into OUT, a PPM. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "command/execute.h"
#include "program/programs.h"

static bool write_picture(const struct image_view *view, const char *path)
{
    FILE *out = fopen(path, "wb");
    if (!out)
        return false;
    fprintf(out, "P6\n%u %u\n255\n", view->width, view->height);
    for (size_t i = 0; i < (size_t)view->width * view->height; i++) {
        const uint32_t colour = image_view_colour(view, i);
        fputc((int)(colour >> 16), out);
        fputc((int)(colour >> 8 & 255), out);
        fputc((int)(colour & 255), out);
    }
    return fclose(out) == 0;
}

int main(int count, char **word)
{
    OWNED(interpreter_release) struct interpreter interp;
    struct pilot_interpreter pilot = {.interp = &interp};
    struct pilot_host host = {.context = &pilot};
    struct image_view view;
    OWNED(buf_release) struct buf told = {0};
    struct fault fault = {0};
    if (count != 8) {
        fputs("panel JOURNAL COLUMNS ROWS CELL_WIDTH CELL_HEIGHT PANE OUT\n", stderr);
        return 2;
    }
    const uint32_t cell_width = (uint32_t)atoi(word[4]), cell_height = (uint32_t)atoi(word[5]);
    const struct pilot_wish wish = {.width = (uint32_t)atoi(word[2]) * cell_width,
                                    .height = (uint32_t)atoi(word[3]) * cell_height,
                                    .cell_width = cell_width,
                                    .cell_height = cell_height,
                                    .words = true,
                                    .pane = (enum pilot_pane)atoi(word[6])};
    pilot_host_fill(&host);
    enum err err = interpreter_init(&interp, &fault);
    interp.is_read_only = true;
    if (!err)
        err = interpreter_resume_journal(&interp, word[1], &told, &fault);
    if (!err)
        err = host.picture(&pilot, &wish, &view, &fault);
    if (err)
        fprintf(stderr, "%s\n", fault.text);
    const bool good = !err && write_picture(&view, word[7]);
    panes_release(&pilot.panes);
    return good ? 0 : 1;
}
