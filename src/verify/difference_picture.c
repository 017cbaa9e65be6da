#include "verify/difference_picture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "render/canvas.h"
#include "render/text.h"

enum {
    SEAM = 2,   /* pixels between panes */
    BORDER = 4, /* around words */
    ROWS = 3,   /* of words below */
    NAME_MOST = 200,
};

/* Labels of the pane on the right. */
enum { SAME_OBJECT = 1, A_ALONE = 1, B_ALONE, ANOTHER, KINDS };

static const uint8_t ghost_rgb[3] = {150, 150, 150};
static const uint8_t kind_rgb[KINDS][3] = {
    [A_ALONE] = {230, 159, 0}, [B_ALONE] = {86, 180, 233}, [ANOTHER] = {204, 121, 167}};
static const char *const kind_words[KINDS] = {
    [A_ALONE] = "A alone", [B_ALONE] = "B alone", [ANOTHER] = "another label"};
static const uint8_t paper[3] = {24, 24, 24}, ink[3] = {232, 232, 232};

/* Where things lie. */
struct sheet {
    uint32_t width, height; /* of a pane */
    uint32_t scale;         /* of letters */
    uint32_t top, bottom;   /* heights of the strips */
    struct canvas canvas;   /* the picture's pixels */
};

static struct sheet plan_sheet(const struct view *view)
{
    const uint32_t scale = view->height >= 800 ? view->height / 400 : 1;
    const uint32_t line = TEXT_LINE * scale;
    return (struct sheet){.width = view->width,
                          .height = view->height,
                          .scale = scale,
                          .top = line + 2 * BORDER,
                          .bottom = ROWS * line + 2 * BORDER};
}

static uint32_t pane_left(const struct sheet *sheet, uint32_t pane)
{
    return pane * (sheet->width + SEAM);
}

/* ---- labels into the scene ---- */

struct relabelling {
    const struct difference_picture *difference_picture;
    const bool *visible;
    enum { AS_B, AS_OBJECT, AS_KIND } as;
};

static uint8_t new_label(const struct relabelling *r, size_t voxel)
{
    const uint8_t whole_b = r->difference_picture->label[1][voxel];
    const uint8_t a = r->visible[r->difference_picture->label[0][voxel]]
                          ? r->difference_picture->label[0][voxel]
                          : 0;
    const uint8_t b = r->visible[whole_b] ? whole_b : 0;
    if (r->as == AS_B)
        return whole_b;
    if (r->as == AS_OBJECT)
        return a || b ? SAME_OBJECT : 0;
    return a == b ? 0 : !b ? A_ALONE : !a ? B_ALONE : ANOTHER;
}

static void relabel(struct session *session, const struct relabelling *r)
{
    const struct grid *grid = &session->scene->grid;
    size_t voxel = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                session->scene->cell[c].label = new_label(r, voxel++);
        }
}

/* Shows those labels, all of them where they are no longer the user's. */
static enum err draw_as(struct session *session, const struct relabelling *r, struct fault *fault)
{
    relabel(session, r);
    for (int label = 1; label < 256; label++)
        session->border.visible[label] = r->as == AS_B ? r->visible[label] : true;
    border_recount(&session->border);
    session->rendered = false;
    return session_draw(session, RENDER_BORDER, fault);
}

/* ---- panes ---- */

static void put_pixel(const struct sheet *sheet, uint32_t pane, size_t at, const uint8_t rgb[3])
{
    canvas_dot(&sheet->canvas, (int64_t)(pane_left(sheet, pane) + at % sheet->width),
               (int64_t)(sheet->top + at / sheet->width), rgb);
}

/* The rendition over black. */
static void put_frame(const struct sheet *sheet, uint32_t pane, const struct session *session)
{
    const struct rendition *frame = session_frame(session);
    const size_t pixels = (size_t)frame->width * frame->height;
    for (size_t i = 0; i < pixels; i++) {
        const uint8_t *from = frame->rgba + 4 * i;
        uint8_t rgb[3];
        for (int k = 0; k < 3; k++)
            rgb[k] = (uint8_t)((from[k] * from[3] + 127) / 255);
        put_pixel(sheet, pane, i, rgb);
    }
}

/* What differs over the shade of all objects, which is in the pane already with these depths. */
static void put_kinds(const struct sheet *sheet, const int64_t *depth,
                      const struct session *session)
{
    const struct rendition *frame = session_frame(session);
    const size_t pixels = (size_t)frame->width * frame->height;
    for (size_t i = 0; i < pixels; i++) {
        const uint8_t *shade = canvas_pixel(&sheet->canvas, pane_left(sheet, 2) + i % sheet->width,
                                            sheet->top + i / sheet->width);
        const uint8_t *over = frame->rgba + 4 * i;
        const bool is_seen = frame->depth[i] <= depth[i];
        const int weight = frame->cell[i] == CELL_NONE ? 0 : is_seen ? over[3] : over[3] * 5 / 8;
        uint8_t rgb[3];
        for (int k = 0; k < 3; k++)
            rgb[k] = (uint8_t)((over[k] * weight + shade[k] * 3 / 5 * (255 - weight) + 127) / 255);
        put_pixel(sheet, 2, i, rgb);
    }
}

static enum err draw_difference(const struct sheet *sheet, struct session *session,
                                struct relabelling *r, struct fault *fault)
{
    const size_t pixels = (size_t)sheet->width * sheet->height;
    int64_t *depth = mem_array(pixels, sizeof *depth);
    struct palette *palette = &session->now.kept.palette;
    if (!depth)
        return fault_memory(fault, "a picture");
    memcpy(palette->rgb[SAME_OBJECT], ghost_rgb, 3);
    r->as = AS_OBJECT;
    enum err err = draw_as(session, r, fault);
    if (!err) {
        memcpy(depth, session_frame(session)->depth, pixels * sizeof *depth);
        put_frame(sheet, 2, session);
        for (int kind = A_ALONE; kind < KINDS; kind++)
            memcpy(palette->rgb[kind], kind_rgb[kind], 3);
        r->as = AS_KIND;
        err = draw_as(session, r, fault);
    }
    if (!err)
        put_kinds(sheet, depth, session);
    free(depth);
    return err;
}

static enum err draw_panes(const struct sheet *sheet, struct session *session,
                           const struct difference_picture *difference_picture, struct fault *fault)
{
    bool visible[256];
    struct relabelling r = {.difference_picture = difference_picture, .visible = visible};
    memcpy(visible, session->border.visible, sizeof visible);
    enum err err = session_draw(session, RENDER_AS_KEPT, fault);
    if (err)
        return err;
    put_frame(sheet, 0, session);
    r.as = AS_B;
    err = draw_as(session, &r, fault);
    if (err)
        return err;
    put_frame(sheet, 1, session);
    return draw_difference(sheet, session, &r, fault);
}

/* ---- words ---- */

/* As much of it as fits. */
static void write_title(const struct sheet *sheet, uint32_t pane, const char *letter,
                        const char *name)
{
    char words[NAME_MOST];
    const int64_t room = (int64_t)sheet->width - 2 * BORDER;
    int length = snprintf(words, sizeof words, "%s%s%s", letter, *name ? "  " : "", name);
    length = length < NAME_MOST ? length : NAME_MOST - 1;
    while (length && text_width(words, sheet->scale) > room)
        words[--length] = '\0';
    text_draw(&sheet->canvas, (int64_t)pane_left(sheet, pane) + BORDER, BORDER + sheet->scale,
              sheet->scale, words, ink);
}

/* A row of the strip below: a box of the colour and words. Gives where they end. */
static int64_t write_entry(const struct sheet *sheet, int64_t left, uint32_t row,
                           const uint8_t rgb[3], const char *words)
{
    const int64_t scale = sheet->scale;
    const int64_t top =
        (int64_t)sheet->top + sheet->height + BORDER + scale + row * TEXT_LINE * scale;
    const int64_t indent = (TEXT_TALL + 3) * scale;
    canvas_box(&sheet->canvas, left, top, TEXT_TALL * scale, TEXT_TALL * scale, rgb);
    text_draw(&sheet->canvas, left + indent, top, sheet->scale, words, ink);
    return left + indent + text_width(words, sheet->scale);
}

/* Labels in columns, as many as there is room for below the two panes. */
static void write_labels(const struct sheet *sheet, const struct session *session,
                         const struct overlap *overlap)
{
    const int64_t end = (int64_t)pane_left(sheet, 2) - BORDER;
    int64_t left = BORDER, widest = 0;
    uint32_t row = 0;
    for (int label = 1; label < 256; label++) {
        char words[LABEL_NAME_BYTES + 32];
        const char *name = session->now.kept.label_name[label];
        const unsigned dice = overlap_dice(overlap, (uint8_t)label);
        if (!overlap->a[label] && !overlap->b[label])
            continue;
        snprintf(words, sizeof words, "%d%s%s  Dice %u.%04u", label, *name ? " " : "", name,
                 dice / DICE_ONE, dice % DICE_ONE);
        if (left + 10 * (int64_t)sheet->scale + text_width(words, sheet->scale) > end)
            return;
        const int64_t right =
            write_entry(sheet, left, row, session->now.kept.palette.rgb[label], words);
        widest = right > widest ? right : widest;
        if (++row == ROWS) {
            row = 0;
            left = widest + 2 * TEXT_ADVANCE * sheet->scale;
        }
    }
}

static void write_words(const struct sheet *sheet, const struct session *session,
                        const struct difference_picture *difference_picture)
{
    write_title(sheet, 0, "A", difference_picture->name[0]);
    write_title(sheet, 1, "B", difference_picture->name[1]);
    write_title(sheet, 2, "where they differ", "");
    write_labels(sheet, session, difference_picture->overlap);
    for (uint32_t kind = A_ALONE; kind < KINDS; kind++)
        write_entry(sheet, (int64_t)pane_left(sheet, 2) + BORDER, kind - A_ALONE, kind_rgb[kind],
                    kind_words[kind]);
}

enum err difference_picture_draw(struct picture *picture, struct session *session,
                                 const struct difference_picture *difference_picture,
                                 struct fault *fault)
{
    struct sheet sheet = plan_sheet(&session->now.outlook.view);
    const uint32_t width = pane_left(&sheet, 3) - SEAM;
    const uint32_t height = sheet.top + sheet.height + sheet.bottom;
    enum err err = picture_init(picture, width, height, false, fault);
    if (err)
        return err;
    sheet.canvas = (struct canvas){width, height, width, picture->rgba, NULL};
    canvas_box(&sheet.canvas, 0, 0, width, height, paper);
    /* The colours of labels are gone once the pane on the right is drawn. */
    write_words(&sheet, session, difference_picture);
    return draw_panes(&sheet, session, difference_picture, fault);
}
