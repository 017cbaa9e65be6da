/* SPDX-License-Identifier: MIT */
#include "show/comparison_picture.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"
#include "render/mosaic.h"
#include "render/notes.h"
#include "show/figures.h"
#include "show/export_picture.h"
#include "show/slicing.h"
#include "show/window.h"

const uint8_t difference_rgb[DIFFERENCES][3] = {[AGREES] = {225, 225, 225},
                                                [A_ALONE] = {230, 159, 0},
                                                [B_ALONE] = {86, 180, 233},
                                                [ANOTHER_LABEL] = {204, 121, 167}};
const char *const difference_words[DIFFERENCES] = {[AGREES] = "A and B",
                                                   [A_ALONE] = "A alone",
                                                   [B_ALONE] = "B alone",
                                                   [ANOTHER_LABEL] = "another label"};

enum difference difference_of(uint8_t label_a, uint8_t label_b)
{
    if (label_a == label_b)
        return label_a ? AGREES : 0;
    return !label_b ? A_ALONE : !label_a ? B_ALONE : ANOTHER_LABEL;
}

/* By cell, as labels that slices show; NULL without memory. */
static uint8_t *differences_of(const struct compared *compared, const struct grid *grid)
{
    uint8_t *difference = mem_new(grid->cells);
    size_t i = 0;
    for (uint32_t z = 0; difference && z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++, i++)
                difference[c] =
                    (uint8_t)difference_of(compared->label[0][i], compared->label[1][i]);
        }
    return difference;
}

/* ---- slices ---- */

static enum err draw_slices(const struct canvas *canvas, struct session *session,
                            const uint8_t *difference, const uint32_t place[3], struct fault *fault)
{
    struct palette palette = {0};
    const bool visible[256] = {[AGREES] = true, true, true, true};
    struct slice_style style = {.overlay = SLICE_CONTOUR,
                                .palette = &palette,
                                .visible = visible,
                                .crosses = true,
                                .finished = difference};
    struct mosaic_layout layout = {0};
    struct mosaic_choice choice = {.notes = true, .team = session_team(session), .layout = &layout};
    char least[WINDOW_WORDS_BYTES], most[WINDOW_WORDS_BYTES], title[3][32];
    int32_t window[2];
    window_of(window, session);
    window_words(least, most, session);
    slice_window(style.grey, window[0], window[1]);
    style.least = least;
    style.most = most;
    memcpy(palette.rgb, difference_rgb, sizeof difference_rgb);
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        choice.place[plane] = place[plane];
        layout.box[plane] = mosaic_box(canvas->width, canvas->height, (enum mosaic_pane)plane);
        snprintf(title[plane], sizeof title[plane], "%s %u",
                 slice_name(session_scene(session), plane), slicing_number(session, plane, place));
        choice.title[plane] = title[plane];
    }
    return mosaic_draw(canvas, session_scene(session), NULL, &choice, &style, fault);
}

/* ---- words ---- */

/* Where the next line goes. */
struct sheet {
    struct canvas canvas;
    uint32_t tall;
    int64_t top, next;
};

/* As much of it as fits from column `left` on, in heights of a capital; and whether more of its
 * line follows. */
static void write_words(struct sheet *sheet, unsigned left, const char *words, bool goes_on)
{
    const int64_t at = (int64_t)left * sheet->tall;
    struct buf fitting = {0};
    buf_add_safe_text(&fitting, words);
    if (fitting.length)
        text_cut(fitting.data, fitting.length + 1, sheet->tall, sheet->canvas.width - at);
    text_draw(&sheet->canvas, at, sheet->top, sheet->tall, buf_text(&fitting), &notes_light);
    buf_release(&fitting);
    sheet->top += goes_on ? 0 : sheet->next;
}

/* Figures before the name: what is cut off is the end of a long name. */
static void write_row(struct sheet *sheet, const char *dice, const char *far, const char *label)
{
    write_words(sheet, 1, dice, true);
    write_words(sheet, 7, far, true);
    write_words(sheet, 18, label, false);
}

static void write_report(const struct canvas *canvas, const struct comparison_report *report)
{
    const struct mosaic_box box = mosaic_box(canvas->width, canvas->height, MOSAIC_RENDITION);
    const uint32_t tall = notes_tall(least(box.width, box.height));
    struct sheet sheet = {
        .canvas = canvas_part(canvas, box.left, box.top, box.width, box.height),
        .tall = tall,
        .top = notes_margin(tall),
        .next = text_line(tall),
    };
    struct buf name = {0};
    for (int i = 0; i < 2; i++) {
        buf_clear(&name);
        buf_printf(&name, "%c  %s", 'A' + i, report->name[i]);
        write_words(&sheet, 1, buf_text(&name), false);
    }
    buf_release(&name);
    for (int i = AGREES; i < DIFFERENCES; i++) {
        canvas_box(&sheet.canvas, tall, sheet.top, tall, tall, difference_rgb[i]);
        write_words(&sheet, 3, difference_words[i], false);
    }
    write_row(&sheet, "Dice", "Hausdorff mm", "of label");
    for (unsigned label = 1; label < 256 && sheet.top < box.height; label++)
        if (comparison_has(report->comparison, label)) {
            const struct label_distances *d = &report->comparison->distance[label];
            char dice[24], far[24] = "none", words[LABEL_NAME_BYTES + 8];
            snprintf(dice, sizeof dice, "%.4f", figures_dice(&report->comparison->overlap, label));
            if (d->has_hausdorff)
                snprintf(far, sizeof far, "%.2f", d->hausdorff_mm);
            snprintf(words, sizeof words, "%u %s", label, report->label_name[label]);
            write_row(&sheet, dice, far, words);
        }
}

/* ---- the whole ---- */

static enum err note(struct picture *picture, const struct session *session,
                     const struct comparison_report *report, const uint32_t place[3],
                     struct fault *fault)
{
    struct buf words = {0};
    buf_printf(&words, "%" PRIu64 " of %" PRIu64 " voxels, through %u,%u,%u",
               report->comparison->overlap.differing, report->comparison->overlap.voxels, place[0],
               place[1], place[2]);
    enum err err = words.failed ? fault_memory(fault, "a note on a picture")
                                : export_notes(picture, session, NULL, fault);
    if (!err)
        err = picture_note(picture, "iftty:differ", buf_text(&words), fault);
    buf_release(&words);
    return err;
}

enum err comparison_picture_draw(struct picture *picture, struct session *session,
                                 const struct compared *compared,
                                 const struct comparison_report *report, const uint32_t place[3],
                                 struct fault *fault)
{
    const struct view *view = &session_outlook(session)->view;
    enum err err = slicing_check_size(view, fault);
    if (!err)
        err = picture_init(picture, view->width, view->height, false, fault);
    if (err)
        return err;
    const struct canvas canvas = {
        .width = view->width, .height = view->height, .stride = view->width, .rgba = picture->rgba};
    uint8_t *difference = differences_of(compared, &session_scene(session)->grid);
    err = difference ? draw_slices(&canvas, session, difference, place, fault)
                     : fault_memory(fault, "a picture");
    free(difference);
    if (!err) {
        write_report(&canvas, report);
        err = note(picture, session, report, place, fault);
    }
    if (err)
        picture_release(picture);
    return err;
}
