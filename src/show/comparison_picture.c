/* SPDX-License-Identifier: MIT */
#include "show/comparison_picture.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"
#include "render/decoration.h"
#include "render/fit.h"
#include "render/mosaic.h"
#include "render/notes.h"
#include "render/slice.h"
#include "session/map.h"
#include "show/decorating.h"
#include "show/draw.h"
#include "show/export_picture.h"
#include "show/comparison.h"
#include "show/slicing.h"

/* ---- colours ---- */

enum { NEAREST = COMPARISON_CLASS_ON, STEPS = COMPARISON_CLASS_STEPS };

/* Colours of the ends and of the middle; the others are interpolated. */
static const uint8_t inside_rgb[3] = {20, 80, 220}, on_rgb[3] = {206, 206, 206},
                     outside_rgb[3] = {214, 30, 24};

/* ---- the rendition ---- */

/* The state of the session for this picture. */
static struct state state_of(const struct session *session)
{
    struct state state = session->now;
    struct kept *kept = &state.kept;
    memset(kept->visible + 1, true, 255 * sizeof *kept->visible);
    memset(kept->opacity + 1, BORDER_OPAQUE, 255);
    for (int class = 1; class < 256; class ++) {
        const int off = abs(class - NEAREST);
        const uint8_t *end = class < NEAREST ? inside_rgb : outside_rgb;
        for (int k = 0; k < 3; k++)
            kept->palette.rgb[class][k] =
                (uint8_t)((end[k] * off + on_rgb[k] * (STEPS - off) + STEPS / 2) / STEPS);
    }
    state.outlook.shows_finished = 0;
    state.outlook.look.creases = false; /* the colours belong to one surface */
    state.outlook.decorations &= DECORATE_LETTERS | DECORATE_SCALE;
    return state;
}

/* Fit the view to all of A. */
static enum err fit_view(struct state *state, struct session *session, uint8_t *class,
                         const struct compared *compared, struct fault *fault)
{
    const struct labels classes = {session->scene, class};
    struct view *view = &state->outlook.view;
    OWNED(border_release) struct border border = {0};
    OWNED(fit_release) struct fit fit = {0};
    uint32_t place[3];
    TRY(comparison_classify(class, &classes.scene->grid, compared, 1, session->team, session->watch,
                            fault));
    TRY(border_init(&border, session->scene, fault));
    border.labels = classes;
    border_recount(&border);
    TRY(fit_init(&fit, &border, fault));
    fit_place(&fit, view, place);
    view->zoom = fit_zoom(&fit, view, place, state->outlook.look.samples);
    view_focus_on(view, session->scene, place);
    return OK;
}

/* The least of 1, 2, 5, 10, ... that is not less than a voxel or `mm`. */
static double round_up(const struct compared *compared, double mm)
{
    double most = 1e-6;
    for (int a = 0; a < 3; a++)
        mm = mm < compared->spacing_nm[a] / 1e6 ? compared->spacing_nm[a] / 1e6 : mm;
    for (int i = 0; most < mm; i++)
        most *= i % 3 == 1 ? 2.5 : 2;
    return most;
}

/* The steps that 95 of 100 of the pixels off B's contour do not exceed. */
static int steps_seen(const struct rendition *frame)
{
    uint64_t count[STEPS + 1] = {0}, all = 0, within = 0;
    int steps = 0;
    for (size_t i = 0; i < (size_t)frame->width * frame->height; i++)
        if (frame->label[i] && frame->label[i] != NEAREST) {
            count[abs(frame->label[i] - NEAREST)]++;
            all++;
        }
    while (within * 100 < all * 95)
        within += count[++steps];
    return steps;
}

/* Render all classes up to the largest distance, then again up to the length of the last colour. */
static enum err render_classes(uint8_t *class, double *most_mm, struct session *session,
                               const struct compared *compared, double farthest_mm,
                               struct fault *fault)
{
    const struct labels classes = {session->scene, class};
    *most_mm = round_up(compared, farthest_mm);
    for (int pass = 0; pass < 2; pass++) {
        TRY(comparison_classify(class, &classes.scene->grid, compared, *most_mm, session->team,
                                session->watch, fault));
        TRY(session_draw_labels(session, &classes, RENDER_ONCE, fault));
        if (pass == 0)
            *most_mm = round_up(compared, *most_mm * steps_seen(session_frame(session)) / STEPS);
    }
    return session_decorate(session, &classes, fault);
}

/* ---- the bar ---- */

static void write_beside(const struct canvas *canvas, int64_t right, int64_t top, uint32_t unit,
                         const char *words)
{
    text_draw(canvas, right - text_width(words, unit), top, unit, words, &notes_light);
}

/* The bar is bottom right, a third of the picture tall, with lengths at its ends and its middle. */
static void draw_bar(const struct canvas *canvas, const struct palette *palette, double most_mm,
                     const char *unit_name, bool has_more)
{
    const uint32_t unit = notes_tall(notes_side(canvas));
    const int64_t u = (unit + 7) / 8, wide = 6 * u, tall = canvas->height / 3;
    const int64_t left = canvas->width - wide - 4 * u, top = canvas->height - tall - 4 * u;
    const int64_t right = left - 4 * u, letter = unit;
    const char *more = has_more ? " or more" : "";
    char words[64];
    if (notes_side(canvas) < NOTES_BARS_FROM)
        return;
    canvas_box(canvas, left - u, top - u, wide + 2 * u, tall + 2 * u, notes_light.outline);
    for (int64_t i = 0; i < tall; i++)
        canvas_box(canvas, left, top + i, wide, 1,
                   palette->rgb[NEAREST + STEPS - 2 * STEPS * i / (tall - 1)]);
    snprintf(words, sizeof words, "%g %s%s outside B", most_mm, unit_name, more);
    write_beside(canvas, right, top, unit, words);
    write_beside(canvas, right, top + (tall - letter) / 2, unit, "0");
    snprintf(words, sizeof words, "%g %s%s inside B", most_mm, unit_name, more);
    write_beside(canvas, right, top + tall - letter, unit, words);
}

static void write_names(const struct canvas *canvas, const struct comparison_report *report)
{
    const uint32_t unit = notes_tall(notes_side(canvas));
    int64_t top = notes_margin(unit);
    const int64_t room = canvas->width / 2 - 2 * (int64_t)unit; /* clear of the upper letter */
    for (int i = 0; i < 2 && notes_side(canvas) >= NOTES_BARS_FROM; i++) {
        OWNED(buf_release) struct buf safe = {0};
        buf_printf(&safe, "%c  ", 'A' + i);
        buf_add_safe_text(&safe, report->name[i]);
        while (safe.length && text_width(safe.data, unit) > room)
            safe.data[--safe.length] = '\0';
        text_draw(canvas, notes_margin(unit), top, unit, buf_text(&safe), &notes_light);
        top += text_line(unit);
    }
}

/* ---- the whole ---- */

/* Draw the legend over the frame, which becomes the picture. */
static enum err take_picture(struct picture *picture, struct session *session,
                             const struct comparison_report *report, double most_mm,
                             struct fault *fault)
{
    const bool has_more = report->comparison->distance[0].most_mm > most_mm;
    struct canvas canvas;
    TRY(session_show_frame(&canvas, session, fault));
    *picture =
        (struct picture){.width = canvas.width, .height = canvas.height, .rgba = canvas.rgba};
    const char *unit = report->geometry->spacing_unknown ? "voxels" : "mm";
    char words[96];
    draw_bar(&canvas, &session->now.kept.palette, most_mm, unit, has_more);
    write_names(&canvas, report);
    snprintf(words, sizeof words, "of A's surface from B's, -%g %s inside to %g %s outside",
             most_mm, unit, most_mm, unit);
    TRY(export_notes(picture, session, NULL, fault));
    return picture_note(picture, "iftty:distance", words, fault);
}

enum err distance_picture_draw(struct picture *picture, struct session *session,
                               const struct comparison_report *report, bool fits,
                               struct fault *fault)
{
    const struct label_distances *distance = &report->comparison->distance[0];
    const struct compared *compared = report->comparison->of;
    const struct state before = session->now;
    struct state state = state_of(session);
    double most_mm = 0;
    if (!distance->has_surfaces)
        return fault_set(fault, ERR_INPUT,
                         "there is no picture of the surface: expected an object in A and in B, "
                         "which the edge of the scene does not cut off all around");
    OWNED(mem_release) uint8_t *class = mem_new(session->scene->grid.cells);
    if (!class)
        return fault_memory(fault, "a picture");
    if (fits)
        TRY(fit_view(&state, session, class, compared, fault));
    TRY(session_go(session, &state, NULL, 0, fault));
    TRY(render_classes(class, &most_mm, session, compared, distance->most_mm, fault));
    TRY(take_picture(picture, session, report, most_mm, fault));
    return session_go(session, &before, NULL, 0, fault);
}

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

/* The differences by cell, as labels that slices show; NULL without memory. */
static uint8_t *differences_of(const struct compared *compared, const struct grid *grid)
{
    uint8_t *difference = mem_new(grid->cells);
    size_t i = 0;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); difference && grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++, i++)
            difference[c] = (uint8_t)difference_of(compared->label[0][i], compared->label[1][i]);
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
    struct mosaic_choice choice = {.notes = true, .team = session->team, .layout = &layout};
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
        snprintf(title[plane], sizeof title[plane], "%s %u", slice_name(session->scene, plane),
                 place[slice_axis(session->scene, plane)]);
        choice.title[plane] = title[plane];
    }
    return mosaic_draw(canvas, session->scene, NULL, &choice, &style, fault);
}

/* ---- words ---- */

/* A column of lines. */
struct sheet {
    struct canvas canvas;
    uint32_t tall;
    int64_t top, next;
};

/* Write text from column `left` on, in heights of a capital, cut to the width of the sheet;
 * `stays_on_line`: the next text is on the same line. */
static void write_words(struct sheet *sheet, unsigned left, const char *words, bool stays_on_line)
{
    const int64_t at = (int64_t)left * sheet->tall;
    OWNED(buf_release) struct buf fitting = {0};
    buf_add_safe_text(&fitting, words);
    if (fitting.length)
        text_cut(fitting.data, fitting.length + 1, sheet->tall, sheet->canvas.width - at);
    text_draw(&sheet->canvas, at, sheet->top, sheet->tall, buf_text(&fitting), &notes_light);
    sheet->top += stays_on_line ? 0 : sheet->next;
}

/* Figures come before the name: a long name is cut at its end. */
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
    for (int i = 0; i < 2; i++) {
        OWNED(buf_release) struct buf name = {0};
        buf_printf(&name, "%c  %s", 'A' + i, report->name[i]);
        write_words(&sheet, 1, buf_text(&name), false);
    }
    for (int i = AGREES; i < DIFFERENCES; i++) {
        canvas_box(&sheet.canvas, tall, sheet.top, tall, tall, difference_rgb[i]);
        write_words(&sheet, 3, difference_words[i], false);
    }
    write_row(&sheet, "Dice", "Hausdorff mm", "of label");
    uint32_t number[256];
    uint8_t order[256];
    numbering_fill(number, report->kept);
    numbering_order(order, number);
    for (unsigned i = 1; i < 256 && sheet.top < box.height; i++)
        if (comparison_has(report->comparison, order[i])) {
            const unsigned label = order[i];
            const struct label_distances *d = &report->comparison->distance[label];
            char dice[24], far[24] = "none", words[LABEL_NAME_BYTES + 12];
            snprintf(dice, sizeof dice, "%.4f", figures_dice(&report->comparison->overlap, label));
            if (d->has_hausdorff)
                snprintf(far, sizeof far, "%.2f", d->hausdorff_mm);
            snprintf(words, sizeof words, "%u %s", number[label], report->kept->label_name[label]);
            write_row(&sheet, dice, far, words);
        }
}

/* ---- the whole ---- */

enum err comparison_picture_draw(struct picture *picture, struct session *session,
                                 const struct comparison_report *report, const uint32_t place[3],
                                 struct fault *fault)
{
    const struct view *view = &session->now.outlook.view;
    TRY(slicing_check_size(view, fault));
    TRY(picture_init(picture, view->width, view->height, 0, fault));
    const struct canvas canvas = {
        .width = view->width, .height = view->height, .stride = view->width, .rgba = picture->rgba};
    OWNED(mem_release)
    uint8_t *difference = differences_of(report->comparison->of, &session->scene->grid);
    OWNED(buf_release) struct buf words = {0};
    TRY(difference ? draw_slices(&canvas, session, difference, place, fault)
                   : fault_memory(fault, "a picture"));
    write_report(&canvas, report);
    buf_printf(&words, "%" PRIu64 " of %" PRIu64 " voxels, through %u,%u,%u",
               report->comparison->overlap.differing, report->comparison->overlap.voxels, place[0],
               place[1], place[2]);
    TRY(export_notes(picture, session, NULL, fault));
    return export_note(picture, "iftty:differ", &words, fault);
}
