/* SPDX-License-Identifier: MIT */
#include "verify/difference_picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/least.h"
#include "base/mem.h"
#include "render/border.h"
#include "render/canvas.h"
#include "render/notes.h"
#include "show/comparison_picture.h"
#include "session/session.h"
#include "session/state.h"
#include "show/decorating.h"
#include "show/draw.h"

enum {
    SEAM = 2,   /* pixels between panes */
    BORDER = 4, /* around words */
    ROWS = 3,   /* of words below */
    NAME_MOST = 200,
};

/* A label of the pane on the right, before it has differences as labels. */
enum { SAME_OBJECT = AGREES };

static const uint8_t ghost_rgb[3] = {150, 150, 150};
static const uint8_t paper[3] = {24, 24, 24};

/* What is drawn, and where it lies. */
struct sheet {
    const struct difference_picture *of;
    struct session *session; /* A's */
    bool visible[256];       /* which labels its user sees */
    struct state state;      /* in which the session is to be for what is drawn next, */
    uint8_t *label;          /* and the labels of that, by cell */
    uint32_t width, height;  /* of a pane */
    uint32_t tall;           /* of letters */
    uint32_t top, bottom;    /* heights of the strips */
    struct canvas canvas;    /* the picture's pixels */
};

static uint32_t pane_left(const struct sheet *sheet, uint32_t pane)
{
    return pane * (sheet->width + SEAM);
}

static struct canvas pane_of(const struct sheet *sheet, uint32_t pane)
{
    return canvas_part(&sheet->canvas, pane_left(sheet, pane), sheet->top, sheet->width,
                       sheet->height);
}

/* ---- other labels ---- */

enum relabelled { AS_B, AS_OBJECT, AS_KIND };

static uint8_t new_label(const struct sheet *sheet, enum relabelled as, size_t voxel)
{
    const uint8_t whole_a = sheet->of->label[0][voxel], whole_b = sheet->of->label[1][voxel];
    const uint8_t a = sheet->visible[whole_a] ? whole_a : 0;
    const uint8_t b = sheet->visible[whole_b] ? whole_b : 0;
    if (as == AS_B)
        return whole_b;
    if (as == AS_OBJECT)
        return a || b ? SAME_OBJECT : 0;
    return a == b ? 0 : (uint8_t)difference_of(a, b);
}

/* Renders those labels, in the sheet's state. */
static enum err render_as(const struct sheet *sheet, enum relabelled as, struct fault *fault)
{
    struct session *session = sheet->session;
    const struct grid *grid = &session_scene(session)->grid;
    const struct labels labels = {session_scene(session), sheet->label};
    size_t voxel = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                sheet->label[c] = new_label(sheet, as, voxel++);
        }
    const enum err err = session_go(session, &sheet->state, NULL, 0, fault);
    return err ? err : session_draw_labels(session, &labels, RENDER_BORDER, fault);
}

/* ---- panes ---- */

/* The rendition over its background. */
static enum err put_frame(const struct sheet *sheet, uint32_t pane, struct fault *fault)
{
    struct canvas frame;
    const struct canvas canvas = pane_of(sheet, pane);
    const enum err err = session_show_frame(&frame, sheet->session, fault);
    if (err)
        return err;
    for (size_t y = 0; y < frame.height; y++)
        memcpy(canvas_pixel(&canvas, 0, y), canvas_pixel(&frame, 0, y), (size_t)4 * frame.width);
    canvas_release(&frame);
    return OK;
}

/* What differs over the shade of all objects, which is in the pane already with these depths. */
static void put_kinds(const struct sheet *sheet, const int64_t *depth)
{
    const struct rendition *frame = session_frame(sheet->session);
    const struct canvas canvas = pane_of(sheet, 2);
    const size_t pixels = (size_t)frame->width * frame->height;
    for (size_t i = 0; i < pixels; i++) {
        const uint8_t *over = frame->rgba + 4 * i;
        uint8_t *to = canvas_pixel(&canvas, i % frame->width, i / frame->width);
        const bool is_seen = frame->depth[i] <= depth[i];
        const int weight = frame->cell[i] == CELL_NONE ? 0 : is_seen ? over[3] : over[3] * 5 / 8;
        for (int k = 0; k < 3; k++)
            to[k] = (uint8_t)((over[k] * weight + to[k] * 3 / 5 * (255 - weight) + 127) / 255);
    }
}

/* All labels are shown, since they are no longer the user's. */
static enum err draw_difference(struct sheet *sheet, struct fault *fault)
{
    const size_t pixels = (size_t)sheet->width * sheet->height;
    int64_t *depth = mem_array(pixels, sizeof *depth);
    struct kept *kept = &sheet->state.kept;
    if (!depth)
        return fault_memory(fault, "a picture");
    memset(kept->visible + 1, true, 255 * sizeof *kept->visible);
    memset(kept->opacity + 1, BORDER_OPAQUE, 255);
    memcpy(kept->palette.rgb[SAME_OBJECT], ghost_rgb, 3);
    sheet->state.outlook.background = BACKGROUND_PLAIN; /* black: colours show what differs */
    enum err err = render_as(sheet, AS_OBJECT, fault);
    if (!err) {
        memcpy(depth, session_frame(sheet->session)->depth, pixels * sizeof *depth);
        err = put_frame(sheet, 2, fault);
    }
    if (!err) {
        for (int kind = A_ALONE; kind < DIFFERENCES; kind++)
            memcpy(kept->palette.rgb[kind], difference_rgb[kind], 3);
        err = render_as(sheet, AS_KIND, fault);
    }
    if (!err)
        put_kinds(sheet, depth);
    free(depth);
    return err;
}

/* ---- words ---- */

/* From the top of a strip to that of its first capitals. */
static int64_t title_top(const struct sheet *sheet)
{
    return BORDER + (text_line(sheet->tall) - sheet->tall) / 2;
}

/* As much of it as fits. */
static void write_title(const struct sheet *sheet, uint32_t pane, const char *letter,
                        const char *name)
{
    char words[NAME_MOST];
    const int64_t room = (int64_t)sheet->width - 2 * BORDER;
    snprintf(words, sizeof words, "%s%s%s", letter, *name ? "  " : "", name);
    text_cut(words, sizeof words, sheet->tall, room);
    text_draw(&sheet->canvas, (int64_t)pane_left(sheet, pane) + BORDER, title_top(sheet),
              sheet->tall, words, &notes_light);
}

/* A row of the strip below: a box of the colour and words. Gives where they end. */
static int64_t write_entry(const struct sheet *sheet, int64_t left, uint32_t row,
                           const uint8_t rgb[3], const char *words)
{
    const int64_t tall = sheet->tall, indent = 3 * tall / 2;
    const int64_t top =
        sheet->top + sheet->height + title_top(sheet) + row * text_line(sheet->tall);
    canvas_box(&sheet->canvas, left, top, tall, tall, rgb);
    text_draw(&sheet->canvas, left + indent, top, sheet->tall, words, &notes_light);
    return left + indent + text_width(words, sheet->tall);
}

/* Labels in columns, as many as there is room for below the two panes. */
static void write_labels(const struct sheet *sheet)
{
    const struct kept *kept = session_kept(sheet->session);
    const struct overlap *overlap = sheet->of->overlap;
    const int64_t end = (int64_t)pane_left(sheet, 2) - BORDER;
    int64_t left = BORDER, widest = 0;
    uint32_t row = 0;
    for (int label = 1; label < 256; label++) {
        char words[LABEL_NAME_BYTES + 32];
        const char *name = kept->label_name[label];
        const unsigned dice = overlap_dice(overlap, (uint8_t)label);
        if (!overlap->a[label] && !overlap->b[label])
            continue;
        snprintf(words, sizeof words, "%d%s%s  Dice %u.%04u", label, *name ? " " : "", name,
                 dice / DICE_ONE, dice % DICE_ONE);
        if (left + 2 * (int64_t)sheet->tall + text_width(words, sheet->tall) > end)
            return;
        const int64_t right = write_entry(sheet, left, row, kept->palette.rgb[label], words);
        widest = right > widest ? right : widest;
        if (++row == ROWS) {
            row = 0;
            left = widest + 2 * (int64_t)sheet->tall;
        }
    }
}

enum err difference_picture_draw(struct picture *picture, struct session *session,
                                 const struct difference_picture *of, struct fault *fault)
{
    const struct view *view = &session_outlook(session)->view;
    const uint32_t tall = notes_tall(least(view->width, view->height));
    const uint32_t line = (uint32_t)text_line(tall);
    struct sheet sheet = {.of = of,
                          .session = session,
                          .state = *session_state(session),
                          .width = view->width,
                          .height = view->height,
                          .tall = tall,
                          .top = line + 2 * BORDER,
                          .bottom = ROWS * line + 2 * BORDER};
    for (int label = 0; label < 256; label++)
        sheet.visible[label] = kept_shows(&sheet.state.kept, label);
    sheet.state.outlook.shows_finished = 0;
    const uint32_t width = pane_left(&sheet, 3) - SEAM;
    const uint32_t height = sheet.top + sheet.height + sheet.bottom;
    enum err err = picture_init(picture, width, height, false, fault);
    if (err)
        return err;
    sheet.canvas =
        (struct canvas){.width = width, .height = height, .stride = width, .rgba = picture->rgba};
    canvas_box(&sheet.canvas, 0, 0, width, height, paper);
    /* First, since the colours of labels are gone once the pane on the right is drawn. */
    write_title(&sheet, 0, "A", of->name[0]);
    write_title(&sheet, 1, "B", of->name[1]);
    write_title(&sheet, 2, "where they differ", "");
    write_labels(&sheet);
    for (uint32_t kind = A_ALONE; kind < DIFFERENCES; kind++)
        write_entry(&sheet, (int64_t)pane_left(&sheet, 2) + BORDER, kind - A_ALONE,
                    difference_rgb[kind], difference_words[kind]);
    sheet.label = mem_new(session_scene(session)->grid.cells);
    err = sheet.label ? session_draw(session, RENDER_AS_KEPT, fault)
                      : fault_memory(fault, "a picture");
    if (!err)
        err = put_frame(&sheet, 0, fault);
    if (!err)
        err = render_as(&sheet, AS_B, fault);
    if (!err)
        err = put_frame(&sheet, 1, fault);
    if (!err)
        err = draw_difference(&sheet, fault);
    free(sheet.label);
    return err;
}
