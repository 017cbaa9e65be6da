/* SPDX-License-Identifier: MIT */
#include "verify/gesture_picture.h"

#include <stdio.h>
#include <string.h>

#include "base/version.h"
#include "engine/overlap.h"
#include "render/canvas.h"
#include "render/notes.h"
#include "report/comparison_picture.h"
#include "session/state.h"
#include "verify/side.h"

enum {
    WIDTH = 1024,
    TALL = 320,  /* of the frame of all labels */
    SHORT = 170, /* of that of one */
    ACROSS = 3,  /* of those in a row */
    LABELS_MOST = 9,
    MARGIN = 16,
    LETTERS = 13, /* how tall capitals are, */
    LINE = 22,    /* and lines of words */
    BEFORE = 48,  /* room for those of the axis */
};

static const uint8_t paper[3] = {24, 24, 24}, rule[3] = {80, 80, 80};

/* Where a curve is drawn: its Dice 0 is at the bottom. */
struct frame {
    const struct canvas *canvas;
    int64_t left, top, width, height;
    uint32_t gestures; /* that it is wide */
};

static int64_t column_of(const struct frame *f, uint32_t gestures)
{
    return f->left + (f->gestures ? (int64_t)gestures * (f->width - 1) / f->gestures : 0);
}

static int64_t row_of(const struct frame *f, unsigned dice)
{
    return f->top + (int64_t)(DICE_ONE - dice) * (f->height - 1) / DICE_ONE;
}

/* What labels have holds until the next step: a stair, of lines two pixels wide. */
static void draw_curve(const struct frame *f, const struct gestures *g, unsigned label,
                       const uint8_t rgb[3])
{
    unsigned dice = 0;
    int64_t from = column_of(f, 0);
    for (size_t i = 0; i <= g->steps; i++) {
        const bool is_end = i == g->steps;
        const uint32_t until = is_end ? (uint32_t)g->count : g->step[i].gestures;
        const unsigned next = is_end ? dice : g->step[i].dice[label];
        const int64_t to = column_of(f, until), row = row_of(f, dice), next_row = row_of(f, next);
        const int64_t upper = row < next_row ? row : next_row;
        canvas_box(f->canvas, from, row, to - from + 2, 2, rgb);
        canvas_box(f->canvas, to, upper, 2, (row > next_row ? row - next_row : next_row - row) + 2,
                   rgb);
        dice = next;
        from = to;
    }
}

static void draw_frame(const struct frame *f, const struct gesture_report *report, unsigned label,
                       const char *title)
{
    static const char *const tick[] = {"1", ".5", "0"};
    char words[32];
    text_draw(f->canvas, f->left, f->top - LINE, LETTERS, title, &notes_light);
    for (int i = 0; i < 3; i++) {
        const int64_t row = row_of(f, (unsigned)(DICE_ONE - i * DICE_ONE / 2));
        canvas_box(f->canvas, f->left, row, f->width, 1, rule);
        text_draw(f->canvas, f->left - 8 - text_width(tick[i], LETTERS), row - LETTERS / 2, LETTERS,
                  tick[i], &notes_light);
    }
    canvas_box(f->canvas, f->left, f->top, 1, f->height, rule);
    snprintf(words, sizeof words, "%u gesture%s", f->gestures, plural(f->gestures));
    text_draw(f->canvas, f->left + f->width - text_width(words, LETTERS), f->top + f->height + 6,
              LETTERS, words, &notes_light);
    draw_curve(f, report->gestures[0], label, difference_rgb[A_ALONE]);
    draw_curve(f, report->gestures[1], label, difference_rgb[B_ALONE]);
}

/* A box of the colour, and who it is. */
static void draw_key(const struct canvas *canvas, int64_t top, const char *who, const char *name,
                     const uint8_t rgb[3])
{
    char words[256];
    snprintf(words, sizeof words, "%s  %s", who, name);
    text_cut(words, sizeof words, LETTERS, WIDTH - 3 * MARGIN - LINE);
    canvas_box(canvas, MARGIN, top, LETTERS, LETTERS, rgb);
    text_draw(canvas, MARGIN + LINE, top, LETTERS, words, &notes_light);
}

enum err gesture_picture_draw(struct picture *picture, const struct gesture_report *report,
                              struct fault *fault)
{
    const size_t a = report->gestures[0]->count, b = report->gestures[1]->count;
    unsigned label[LABELS_MOST], labels = 0;
    for (unsigned l = 1; l < 256 && labels < LABELS_MOST; l++)
        if (report->has[l])
            label[labels++] = l;
    const int64_t below = MARGIN + 2 * LINE + 2 * LINE + TALL + 2 * LINE;
    const int64_t row = SHORT + 3 * LINE + MARGIN;
    const uint32_t rows = labels > 1 ? (labels + ACROSS - 1) / ACROSS : 0;
    enum err err =
        picture_init(picture, WIDTH, (uint32_t)(below + MARGIN + rows * row), false, fault);
    if (err)
        return err;
    const struct canvas canvas = {.width = picture->width,
                                  .height = picture->height,
                                  .stride = picture->width,
                                  .rgba = picture->rgba};
    struct frame frame = {.canvas = &canvas,
                          .left = MARGIN + BEFORE,
                          .top = MARGIN + 4 * LINE,
                          .width = WIDTH - 2 * MARGIN - BEFORE,
                          .height = TALL,
                          .gestures = (uint32_t)(a > b ? a : b)};
    canvas_box(&canvas, 0, 0, picture->width, picture->height, paper);
    draw_key(&canvas, MARGIN, "expert", side_shown_name(report->side[0]->facts, report->path[0]),
             difference_rgb[A_ALONE]);
    draw_key(&canvas, MARGIN + LINE, "trainee",
             side_shown_name(report->side[1]->facts, report->path[1]), difference_rgb[B_ALONE]);
    draw_frame(&frame, report, DICE_OF_ALL, "Dice with the expert's final labels: all labels");
    frame.width = (WIDTH - MARGIN) / ACROSS - MARGIN - BEFORE;
    frame.height = SHORT;
    for (unsigned i = 0; rows && i < labels; i++) {
        char words[LABEL_NAME_BYTES + 8];
        snprintf(words, sizeof words, "%u %s", label[i], gesture_report_name(report, label[i]));
        text_cut(words, sizeof words, LETTERS, frame.width);
        frame.left = MARGIN + BEFORE + (i % ACROSS) * ((WIDTH - MARGIN) / ACROSS);
        frame.top = below + LINE + i / ACROSS * row;
        draw_frame(&frame, report, label[i], words);
    }
    return picture_note(picture, "Software", "iftty " PROGRAM_VERSION, fault);
}
