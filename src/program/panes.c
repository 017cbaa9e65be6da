/* SPDX-License-Identifier: MIT */
#include "program/panes.h"

#include <stdlib.h>
#include <string.h>

#include "base/hash.h"
#include "base/least.h"
#include "base/mem.h"
#include "engine/way.h"
#include "render/notes.h"
#include "session/markers.h"
#include "session/paint.h"
#include "session/session.h"
#include "session/state.h"
#include "session/tally.h"
#include "show/draw.h"

static const uint8_t white[3] = {255, 255, 255}, yellow[3] = {230, 200, 90}, black[3] = {0, 0, 0},
                     ink[3] = {232, 232, 232};

static bool is_inside(const struct voxels *inside, uint32_t cell)
{
    size_t low = 0, high = inside->count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        *(inside->cell[middle] <= cell ? &low : &high) = middle;
    }
    return inside->count > 0 && inside->cell[low] == cell;
}

/* Tint the pixels of these voxels as labels are tinted, so that edges stay visible. */
static void tint(const struct canvas *pane, const struct voxels *inside, const uint8_t rgb[3])
{
    uint32_t last = CELL_NONE;
    bool is_filled = false;
    for (uint32_t y = 0; y < pane->height; y++)
        for (uint32_t x = 0; x < pane->width; x++) {
            const size_t at = y * pane->stride + x;
            uint8_t *pixel = canvas_pixel(pane, x, y);
            if (pane->cell[at] != last) { /* neighbouring pixels show one voxel */
                last = pane->cell[at];
                is_filled = is_inside(inside, last);
            }
            for (int k = 0; is_filled && !pane->words[at] && k < 3; k++)
                pixel[k] = (uint8_t)((2 * pixel[k] + rgb[k] + 1) / 3);
        }
}

/* Draw a line from pixel to pixel; a dotted one has every third. */
static void draw_line(const struct canvas *pane, const int64_t from[2], const int64_t to[2],
                      bool is_dotted)
{
    const int64_t way[2] = {to[0] - from[0], to[1] - from[1]};
    const int64_t across = llabs(way[0]), down = llabs(way[1]);
    const int64_t steps = across > down ? across : down, parts = steps ? steps : 1;
    for (int64_t i = 0; i <= steps; i++) {
        const int64_t column = from[0] + way[0] * i / parts, row = from[1] + way[1] * i / parts;
        if (!is_dotted || i % 3 == 0) {
            canvas_dot(pane, column + (across < down), row + (across >= down), black);
            canvas_dot(pane, column, row, white);
        }
    }
}

/* Draw the outline over the slice in a box of a canvas with cells, words and greys below. Without
 * memory the line alone. */
static void draw_outline(const struct canvas *canvas, const struct scene *scene,
                         const struct slice_choice *slice, const struct mosaic_box *box,
                         const struct pilot_wish *mark, const uint8_t rgb[3])
{
    const struct canvas pane = canvas_part(canvas, box->left, box->top, box->width, box->height);
    OWNED(voxels_release) struct voxels inside = {0};
    struct slice_plan plan;
    slice_plan_init(&plan, scene, slice, box->width, box->height);
    for (size_t i = 0; i < mark->corners; i++)
        if (mark->corner[i][plan.across] != slice->place[plan.across])
            return;
    if (paint_polygon(&inside, &scene->grid, mark->corner, mark->corners, NULL, NULL) == OK)
        tint(&pane, &inside, rgb);
    for (size_t i = 0; i < mark->corners; i++) {
        const uint32_t *end[2] = {mark->corner[i], mark->corner[(i + 1) % mark->corners]};
        int64_t at[2][2];
        for (int k = 0; k < 4; k++) {
            const struct slice_side *side = &plan.side[k % 2];
            at[k / 2][k % 2] = slice_side_pixel(side, slice_side_counted(side, end[k / 2]));
        }
        const int64_t size[2] = {pane.width, pane.height};
        bool is_outside = false; /* on one side of the pane */
        for (int k = 0; k < 2; k++)
            is_outside |=
                (at[0][k] < 0 && at[1][k] < 0) || (at[0][k] >= size[k] && at[1][k] >= size[k]);
        if (!is_outside)
            draw_line(&pane, at[0], at[1], i + 1 == mark->corners);
    }
}

_Static_assert((int)PILOT_AXIAL == (int)SLICE_AXIAL && (int)PILOT_CORONAL == (int)SLICE_CORONAL &&
                   (int)PILOT_SAGITTAL == (int)SLICE_SAGITTAL &&
                   (int)PILOT_RENDITION == (int)MOSAIC_RENDITION,
               "the pilot's panes are planes, and those of a mosaic");

void panes_release(struct panes *p)
{
    canvas_release(&p->canvas);
    canvas_release(&p->beyond);
    way_release(&p->way);
    *p = (struct panes){0};
}

/* The slice of a pane. */
static struct slice_choice slice_of(const struct panes *p, const struct session *session,
                                    enum slice_plane plane)
{
    return mosaic_slice(session->scene, &p->panel.choice, p->canvas.width, p->canvas.height, plane);
}

/* ---- marks ---- */

/* Draw a line, upright or across, that stays sharp in coarse pictures as words do. */
static void mark_line(const struct canvas *canvas, int64_t left, int64_t top, int64_t width,
                      int64_t height)
{
    canvas_box(canvas, left, top, width, height, white);
    for (int64_t y = top; y < top + height; y++)
        for (int64_t x = left; x < left + width; x++)
            if (x >= 0 && y >= 0 && x < canvas->width && y < canvas->height)
                canvas->words[(size_t)y * canvas->stride + (size_t)x] = 1;
}

/* Draw a cross of short lines around a pixel. */
static void mark_point(const struct canvas *canvas, int64_t column, int64_t row, int gap)
{
    enum { ARM = 6 };
    mark_line(canvas, column - gap - ARM + 1, row, ARM, 1);
    mark_line(canvas, column + gap, row, ARM, 1);
    mark_line(canvas, column, row - gap - ARM + 1, 1, ARM);
    mark_line(canvas, column, row + gap, 1, ARM);
}

/* Find the pixel of a voxel in a slice, or of its projection onto it. False outside the box. */
static bool find_pixel(const struct scene *scene, const struct slice_choice *slice,
                       const struct mosaic_box *box, uint32_t cell, int64_t pixel[2])
{
    uint32_t place[3], found[2];
    grid_find(&scene->grid, cell, place);
    slice_move(scene, slice->plane, slice_index(scene, slice->plane, slice->place), place);
    if (!slice_pixel_of(scene, slice, box->width, box->height, place, found))
        return false;
    pixel[0] = (int64_t)box->left + found[0];
    pixel[1] = (int64_t)box->top + found[1];
    return true;
}

static void mark_way(const struct canvas *canvas, const struct scene *scene,
                     const struct slice_choice *slice, const struct mosaic_box *box,
                     const struct way *way)
{
    int64_t pixel[2];
    for (size_t i = 0; i < way->count; i++) {
        uint32_t place[3];
        grid_find(&scene->grid, way->cell[i], place);
        const bool lies_in_it = slice_index(scene, slice->plane, place) ==
                                slice_index(scene, slice->plane, slice->place);
        if (find_pixel(scene, slice, box, way->cell[i], pixel))
            canvas_box(canvas, pixel[0], pixel[1], 2, 2, lies_in_it ? white : yellow);
    }
    if (way->edge != CELL_NONE && find_pixel(scene, slice, box, way->edge, pixel))
        mark_point(canvas, pixel[0], pixel[1], 3);
}

static enum err draw_heat(const struct panes *p, struct session *session, struct fault *fault)
{
    const struct canvas *canvas = &p->canvas;
    const bool over_tint = session->now.outlook.slices.overlay == SLICE_TINT;
    const struct hint_list *found;
    const uint8_t *heat;
    TRY(session_find_hints(session, &found, &heat, fault));
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const struct mosaic_box *box = &p->panel.layout.box[plane];
        for (uint32_t y = box->top; y < box->top + box->height; y++)
            for (uint32_t x = box->left; x < box->left + box->width; x++) {
                const size_t at = y * canvas->stride + x;
                const uint32_t cell = canvas->cell[at];
                const uint8_t grey = canvas->below[at];
                uint8_t *pixel = canvas_pixel(canvas, x, y);
                const bool is_grey = pixel[0] == grey && pixel[1] == grey && pixel[2] == grey;
                if (cell == CELL_NONE || !heat[cell] || canvas->words[at] ||
                    !(is_grey || over_tint))
                    continue;
                const unsigned quarters = heat[cell] + 1u; /* parts of the heat's colour: 2 or 3 */
                for (int k = 0; k < 3; k++) {
                    const unsigned hue = PANES_HEAT_HUE >> (16 - 8 * k) & 255;
                    pixel[k] = (uint8_t)((hue * quarters + grey * (4 - quarters)) / 4);
                }
            }
    }
    return OK;
}

/* Draw lines in the middle of a box, if they fit. */
static void draw_lines(const struct canvas *canvas, const struct mosaic_box *box,
                       const struct buf line[PANES_LINES])
{
    const int64_t width = box->width, height = box->height;
    static const struct ink grey = {{200, 200, 200}, {0, 0, 0}};
    const uint32_t tall = notes_tall(least(box->width, box->height));
    const int64_t apart = 2 * (int64_t)tall;
    int64_t widest = 0;
    for (int i = 0; i < PANES_LINES; i++) {
        const int64_t wide = text_width(buf_text(line + i), tall);
        widest = wide > widest ? wide : widest;
    }
    for (int i = 0; i < PANES_LINES && widest <= width && PANES_LINES * apart <= height; i++)
        text_draw(canvas, box->left + (width - text_width(buf_text(line + i), tall)) / 2,
                  box->top + (height - PANES_LINES * apart + tall) / 2 + i * apart, tall,
                  buf_text(line + i), &grey);
}

/* ---- notes ---- */

enum { BAR_FROM_COLUMNS = 16, BAR_FROM_ROWS = 7 }; /* cells of a pane */

/* A pane in cells: its first ones, and the last that no other pane touches, so that letters of two
 * panes are apart. */
struct cells {
    uint32_t left, top, right, bottom;
};

static void add_note(struct panes *p, uint32_t column, uint32_t row, char character)
{
    if (p->notes < PANES_NOTES_MOST)
        p->note[p->notes++] = (struct raster_note){(uint16_t)column, (uint16_t)row, character};
}

static void add_letters(struct panes *p, const struct scene *scene, enum slice_plane plane,
                        const struct cells *pane)
{
    const uint32_t centre = (pane->left + pane->right + 1) / 2;
    const uint32_t middle = (pane->top + pane->bottom + 1) / 2;
    char letter[4];
    slice_letters(scene, plane, letter);
    if (pane->right < pane->left + 2 || pane->bottom < pane->top + 2)
        return; /* one letter alone would mislead */
    add_note(p, pane->left, middle, letter[0]);
    add_note(p, pane->right, middle, letter[1]);
    add_note(p, centre, pane->top, letter[2]);
    add_note(p, centre, pane->bottom, letter[3]);
}

/* Draw a scale bar bottom left, in the lower part of a row of cells, with its length above it;
 * unless it reaches the letter in the middle. */
static void add_bar(struct panes *p, const struct mosaic_box *box, const struct cells *pane,
                    uint64_t pixel_pm)
{
    const struct mosaic_screen *screen = &p->panel.screen;
    const uint64_t length = slice_round_length(pixel_pm * box->width / 3 + 1);
    const int64_t pixels = (int64_t)((length + pixel_pm / 2) / pixel_pm);
    const int64_t tall = screen->cell_height, thick = (tall + 2) / 3;
    const int64_t left = (pane->left + 1) * (int64_t)screen->cell_width,
                  top = (pane->bottom - 1) * tall;
    char words[32];
    slice_length_words(words, length);
    if (pane->left + 2 + strlen(words) > (pane->left + pane->right) / 2)
        return;
    canvas_box(&p->canvas, left, top, pixels, tall - thick, black);
    canvas_box(&p->canvas, left, top + tall - thick, pixels, thick, ink);
    for (uint32_t i = 0; words[i]; i++)
        add_note(p, pane->left + 1 + i, pane->bottom - 2, words[i]);
}

/* Write lines in the middle of the rendition's pane, if they fit. */
static void add_lines(struct panes *p, const struct buf line[PANES_LINES])
{
    const struct mosaic_screen *screen = &p->panel.screen;
    const struct mosaic_box *box = &p->panel.layout.box[MOSAIC_RENDITION];
    const uint32_t columns = box->width / screen->cell_width,
                   rows = box->height / screen->cell_height;
    bool fit = rows >= PANES_LINES;
    for (int i = 0; i < PANES_LINES; i++)
        fit &= line[i].length <= columns;
    for (uint32_t i = 0; i < PANES_LINES && fit; i++)
        for (uint32_t k = 0; k < line[i].length; k++)
            add_note(
                p, box->left / screen->cell_width + (columns - (uint32_t)line[i].length) / 2 + k,
                box->top / screen->cell_height + (rows - PANES_LINES) / 2 + i, line[i].data[k]);
}

static void add_notes(struct panes *p, const struct session *session)
{
    const struct scene *scene = session->scene;
    const struct mosaic_screen *screen = &p->panel.screen;
    bool has_bar = false;
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const struct mosaic_box *box = &p->panel.layout.box[plane];
        if (box->width == 0 || !session->now.outlook.slices.words)
            continue;
        const struct cells pane = {box->left / screen->cell_width, box->top / screen->cell_height,
                                   (box->left + box->width) / screen->cell_width - 1,
                                   (box->top + box->height) / screen->cell_height - 1};
        if (!scene->sides_unknown)
            add_letters(p, scene, plane, &pane);
        if (!has_bar && !scene->spacing_unknown && pane.right - pane.left >= BAR_FROM_COLUMNS - 1 &&
            pane.bottom - pane.top >= BAR_FROM_ROWS - 1)
            add_bar(p, box, &pane, slice_of(p, session, plane).pixel_pm);
        has_bar = true;
    }
}

/* ---- the picture ---- */

bool panes_have_object(const struct session *session)
{
    const struct edit *seed = edits_first(&session->now.lists.pending);
    bool has = session->tally.stale;
    for (size_t i = 0; i < session_pendings(session); i++)
        has |= seed[i].label > 0;
    for (unsigned label = 1; label < 256; label++)
        has |= session->tally.voxels[label] > 0;
    return has;
}

/* Hatching that is seen without colours: every second pixel of held voxels, and oblique lines over
 * voxels with a changed label, with the label's colour between the lines. */
static bool is_hatched(const struct panes *p, const struct session *session, bool marks_held,
                       uint32_t cell, uint32_t x, uint32_t y)
{
    enum { APART = 5 };
    return (marks_held && (x + y) % 2 == 0 && session_is_held(session, &p->held, cell)) ||
           (p->former && (x + y) % APART == 0 &&
            p->former[cell] != session->scene->cell[cell].label);
}

static void draw_marks(struct panes *p, const struct session *session,
                       const struct pilot_wish *wish)
{
    const struct scene *scene = session->scene;
    const struct canvas *canvas = &p->canvas;
    if (wish->marks_held || p->former) {
        for (uint32_t y = 0; y < canvas->height; y++)
            for (uint32_t x = 0; x < canvas->width; x++) {
                const uint32_t at = canvas->cell[y * canvas->stride + x];
                if (at != CELL_NONE && is_hatched(p, session, wish->marks_held, at, x, y))
                    memcpy(canvas_pixel(canvas, x, y), white, sizeof white);
            }
    }
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const struct mosaic_box *box = &p->panel.layout.box[plane];
        const struct slice_choice slice = slice_of(p, session, plane);
        uint32_t pixel[2];
        if (box->width == 0)
            continue;
        if (wish->marks_outline)
            draw_outline(canvas, scene, &slice, box, wish,
                         session->now.kept.palette.rgb[wish->label]);
        for (size_t i = 0; wish->marks_corners && i < wish->corners; i++)
            if (slice_pixel_of(scene, &slice, box->width, box->height, wish->corner[i], pixel))
                mark_point(canvas, (int64_t)box->left + pixel[0], (int64_t)box->top + pixel[1], 1);
        if (wish->marks_way)
            mark_way(canvas, scene, &slice, box, &p->way);
    }
    if (wish->marks_pixel && session_frame(session)->depth) {
        const struct mosaic_point at =
            mosaic_point_of(canvas->width, canvas->height, &p->panel.choice, session_frame(session),
                            wish->pixel[0], wish->pixel[1]);
        mark_point(canvas, at.column, at.row, 2);
    }
}

enum err panes_draw(struct panes *p, struct session *session, const struct pilot_wish *wish,
                    const struct buf line[PANES_LINES], struct fault *fault)
{
    const struct mosaic_box *box = p->panel.layout.box;
    p->notes = 0;
    p->panel = (struct slicing_panel){.screen = {wish->width, wish->height, wish->cell_width,
                                                 wish->cell_height, !wish->is_alone,
                                                 (enum mosaic_pane)wish->pane},
                                      .words = wish->words,
                                      .within_ns = wish->within_ns};
    enum err err = session_count_labels(session, fault); /* for the hues */
    if (err)
        canvas_release(&p->canvas);
    else
        err = slicing_draw_panel(&p->canvas, session, &p->panel, fault);
    const bool waits = wish->heat && wish->within_ns && !session_has_heat(session);
    p->panel.is_hasty |= waits;
    if (!err && wish->heat && !waits)
        err = draw_heat(p, session, fault);
    if (err)
        return err;
    if (!wish->is_alone) {
        const int64_t left = box[wish->pane].left, top = box[wish->pane].top,
                      width = box[wish->pane].width, height = box[wish->pane].height;
        mark_line(&p->canvas, left, top, width, 1);
        mark_line(&p->canvas, left, top + height - 1, width, 1);
        mark_line(&p->canvas, left, top, 1, height);
        mark_line(&p->canvas, left + width - 1, top, 1, height);
    }
    if (!panes_have_object(session)) {
        if (wish->words)
            draw_lines(&p->canvas, &box[PILOT_RENDITION], line);
        else
            add_lines(p, line);
    }
    draw_marks(p, session, wish);
    if (!wish->words)
        add_notes(p, session);
    return OK;
}

struct raster_box panes_box(const struct panes *p, enum pilot_pane pane)
{
    const struct mosaic_box *box = &p->panel.layout.box[pane];
    return (struct raster_box){box->left, box->top, box->width, box->height};
}

/* A slice next to the one shown. */
struct beyond {
    enum slice_plane plane;
    uint32_t place[3];
};

/* False if the scene ends on that side, or the pane is not shown. */
static bool find_beyond(struct beyond *b, const struct panes *p, const struct session *session,
                        enum pilot_pane first, unsigned number)
{
    const int64_t far = (int64_t)number / 6 + 1;
    int64_t by[PANES_SLICES] = {0};
    if (!session->has_scene)
        return false;
    const struct scene *scene = session->scene;
    b->plane = (enum slice_plane)((first + number % 6 / 2) % PANES_SLICES);
    by[b->plane] = number % 2 ? far : -far;
    panes_move(session, by, b->place);
    const int64_t here = slice_index(scene, b->plane, session->now.outlook.slices.cross);
    return p->panel.layout.box[b->plane].width > 0 &&
           slice_index(scene, b->plane, b->place) == here + by[b->plane];
}

/* The cross-hair decides about the part of a magnified slice that is shown. */
uint64_t panes_name_beyond(const struct panes *p, struct session *session, enum pilot_pane first,
                           unsigned number)
{
    struct beyond b;
    if (!find_beyond(&b, p, session, first, number))
        return 0;
    const struct mosaic_choice *choice = &p->panel.choice;
    const struct mosaic_box *box = &p->panel.layout.box[b.plane];
    const bool hangs = choice->times != SLICE_TIMES_ONE || choice->has_middle;
    int32_t window[2];
    window_of(window, session);
    const uint64_t parts[] = {b.plane, slice_index(session->scene, b.plane, b.place),
                              (uint64_t)box->width << 32 | box->height,
                              (uint64_t)(uint32_t)window[0] << 32 | (uint32_t)window[1],
                              choice->times};
    uint64_t name = 0;
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++)
        name += hash_mix_at(i, parts[i]);
    for (size_t a = 0; a < 3 && hangs; a++)
        name +=
            hash_mix_at(a + 8, (uint64_t)b.place[a] << 32 | choice->middle[a]) + choice->has_middle;
    return name ? name : 1;
}

bool panes_draw_beyond(struct panes *p, struct session *session, enum pilot_pane first,
                       unsigned number)
{
    struct beyond b;
    canvas_release(&p->beyond);
    return find_beyond(&b, p, session, first, number) &&
           slicing_draw_below(&p->beyond, session, &p->panel, b.plane, b.place, NULL) == OK;
}

bool panes_pan(const struct panes *p, const struct session *session, enum pilot_pane pane,
               const int by[2], uint32_t middle[3], uint32_t place[3])
{
    const struct mosaic_box *box = &p->panel.layout.box[pane];
    struct mosaic_choice choice = slicing_choice(session);
    choice.layout = &p->panel.layout;
    if (box->width == 0)
        return false;
    const struct slice_choice slice = mosaic_slice(session->scene, &choice, p->panel.screen.width,
                                                   p->panel.screen.height, (enum slice_plane)pane);
    return slice_pan(session->scene, &slice, box->width, box->height, by, middle, place);
}

void panes_move(const struct session *session, const int64_t by[PANES_SLICES], uint32_t place[3])
{
    const struct scene *scene = session->scene;
    memcpy(place, session->now.outlook.slices.cross, 3 * sizeof *place);
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const int64_t count = slice_count(scene, plane);
        int64_t index = (int64_t)slice_index(scene, plane, place) + by[plane];
        index = index < 0 ? 0 : index >= count ? count - 1 : index;
        slice_move(scene, plane, (uint32_t)index, place);
    }
}
