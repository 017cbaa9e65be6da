/* SPDX-License-Identifier: MIT */
#include "render/mosaic.h"

#include <string.h>

#include "base/least.h"
#include "base/team.h"
#include "render/palette.h"
#include "render/rendition.h"

static const uint8_t seam_grey[3] = {56, 56, 56};

/* Return the width of the gap between panes. */
static uint32_t seam_of(uint32_t width, uint32_t height)
{
    return width < 128 || height < 128 ? 1 : 2;
}

struct mosaic_box mosaic_box(uint32_t width, uint32_t height, enum mosaic_pane pane)
{
    const uint32_t seam = seam_of(width, height);
    const uint32_t left = (width - seam) / 2, top = (height - seam) / 2;
    const bool is_right = pane == MOSAIC_SAGITTAL || pane == MOSAIC_RENDITION;
    const bool is_low = pane == MOSAIC_AXIAL || pane == MOSAIC_RENDITION;
    return (struct mosaic_box){is_right ? left + seam : 0, is_low ? top + seam : 0,
                               is_right ? width - seam - left : left,
                               is_low ? height - seam - top : top};
}

/* The same for a choice; a pane that is not shown has no width. */
static struct mosaic_box box_of(const struct mosaic_choice *choice, uint32_t width, uint32_t height,
                                enum mosaic_pane pane)
{
    return choice->layout ? choice->layout->box[pane] : mosaic_box(width, height, pane);
}

/* ---- slices ---- */

/* All visible slices share the largest scale at which all fit, and on a screen the line width and
 * letter size of the largest of them. */
struct slice_choice mosaic_slice(const struct scene *scene, const struct mosaic_choice *choice,
                                 uint32_t width, uint32_t height, enum slice_plane plane)
{
    const bool has_axial = box_of(choice, width, height, MOSAIC_AXIAL).width > 0;
    struct slice_choice slice = {
        .plane = plane, .title = choice->title[plane], .has_middle = choice->has_middle};
    uint64_t fitting_pm = 0;
    for (enum slice_plane p = SLICE_AXIAL; p <= SLICE_SAGITTAL; p++) {
        const struct mosaic_box box = box_of(choice, width, height, (enum mosaic_pane)p);
        if (box.width == 0)
            continue;
        const uint64_t pixel_pm = slice_fitting_pixel(scene, p, box.width, box.height);
        const uint32_t size = choice->layout ? least(box.width, box.height) : 0;
        fitting_pm = pixel_pm > fitting_pm ? pixel_pm : fitting_pm;
        slice.size = size > slice.size ? size : slice.size;
    }
    for (int a = 0; a < 3; a++) {
        slice.place[a] = choice->place[a];
        slice.middle[a] = choice->middle[a];
    }
    slice_magnify(&slice, scene, fitting_pm, choice->times ? choice->times : SLICE_TIMES_ONE);
    if (choice->notes) /* draw the bars once, for all three */
        slice.notes = plane == SLICE_AXIAL || !has_axial
                          ? SLICE_LETTERS | SLICE_SCALE | SLICE_COLOURS
                          : SLICE_LETTERS;
    return slice;
}

/* ---- the rendition ---- */

/* The part of the rendition in its pane, which has `shown` pixels from `left`, `top` on. */
struct fitting {
    uint32_t width, height; /* in pixels of the rendition */
    uint32_t from_left, from_top;
    uint32_t shown_width, shown_height; /* in pixels of the pane */
    uint32_t left, top;
};

/* Show it at half its size if it is as large as a mosaic of halves; otherwise as large as it fits,
 * in its own shape, and enlarged by integer factors only. */
static struct fitting fit(const struct rendition *r, const struct mosaic_choice *choice,
                          uint32_t width, uint32_t height)
{
    const struct mosaic_box box = box_of(choice, width, height, MOSAIC_RENDITION);
    struct fitting f = {.width = r->width, .height = r->height};
    if (!r->depth)
        return f;
    if (!choice->layout && width == r->width && height == r->height) {
        f.width = 2 * box.width;
        f.height = 2 * box.height;
        f.from_left = (r->width - f.width) / 2;
        f.from_top = (r->height - f.height) / 2;
        f.shown_width = box.width;
        f.shown_height = box.height;
        return f;
    }
    const uint32_t coarse = choice->coarse ? choice->coarse : 1;
    const uint32_t whole_width = coarse * r->width, whole_height = coarse * r->height;
    const uint32_t across = box.width / whole_width, down = box.height / whole_height;
    const uint32_t times = across < down ? across : down;
    if (times > 0) {
        f.shown_width = times * whole_width;
        f.shown_height = times * whole_height;
    } else if ((uint64_t)box.width * whole_height < (uint64_t)box.height * whole_width) {
        f.shown_width = box.width;
        f.shown_height = (uint32_t)((uint64_t)whole_height * box.width / whole_width);
    } else {
        f.shown_height = box.height;
        f.shown_width = (uint32_t)((uint64_t)whole_width * box.height / whole_height);
    }
    f.shown_width += f.shown_width == 0;
    f.shown_height += f.shown_height == 0;
    f.left = (box.width - f.shown_width) / 2;
    f.top = (box.height - f.shown_height) / 2;
    return f;
}

/* Return the pixels of the rendition that one pixel of the pane shows. */
static struct mosaic_box source_of(const struct fitting *f, uint32_t x, uint32_t y)
{
    const uint32_t left = (uint32_t)((uint64_t)x * f->width / f->shown_width);
    const uint32_t top = (uint32_t)((uint64_t)y * f->height / f->shown_height);
    const uint32_t right = (uint32_t)((uint64_t)(x + 1) * f->width / f->shown_width);
    const uint32_t bottom = (uint32_t)((uint64_t)(y + 1) * f->height / f->shown_height);
    return (struct mosaic_box){f->from_left + left, f->from_top + top,
                               right > left ? right - left : 1, bottom > top ? bottom - top : 1};
}

/* ---- pixels of the pane ---- */

/* Draw one row of the pane; source_of defines each pixel's source. */
static void draw_row(const struct canvas *pane, const struct fitting *f, const struct rendition *r,
                     uint32_t y, const uint8_t *behind)
{
    const uint32_t whole = f->width / f->shown_width, part = f->width % f->shown_width;
    uint32_t at = 0, rest = 0; /* at + rest / shown is x * width / shown, without divisions */
    struct mosaic_box source = source_of(f, 0, y);
    uint8_t *pixel = canvas_pixel(pane, f->left, f->top + y);
    uint32_t *cell = pane->cell ? pane->cell + (f->top + y) * pane->stride + f->left : NULL;
    for (uint32_t x = 0; x < f->shown_width; x++, pixel += 4) {
        const uint32_t left = at;
        at += whole;
        rest += part;
        if (rest >= f->shown_width) {
            rest -= f->shown_width;
            at++;
        }
        source.left = f->from_left + left;
        source.width = at > left ? at - left : 1;
        /* Compute the mean as for samples (render/rendition.h), and the nearest voxel. */
        uint8_t rgba[4];
        const uint32_t shown =
            r->cell[rendition_mean(rgba, r, source.left, source.top, source.width, source.height)];
        background_over(pixel, rgba, behind);
        if (cell)
            cell[x] = shown;
    }
}

/* ---- the whole ---- */

/* Panes share only their input, so each may be drawn by another thread. */
struct drawing {
    const struct canvas *canvas;
    const struct scene *scene;
    const struct rendition *rendition;
    const struct mosaic_choice *choice;
    const struct slice_style *style;
    enum err err[MOSAIC_PANES];
};

static void draw_share(void *context, unsigned worker)
{
    struct drawing *d = context;
    const uint32_t width = d->canvas->width, height = d->canvas->height;
    const struct share share = team_share(d->choice->team, worker, MOSAIC_PANES);
    for (size_t i = share.first; i < share.end; i++) {
        const enum mosaic_pane pane = (enum mosaic_pane)i;
        const struct mosaic_box box = box_of(d->choice, width, height, pane);
        if (box.width == 0)
            continue;
        const struct canvas part = canvas_part(d->canvas, box.left, box.top, box.width, box.height);
        if (pane == MOSAIC_RENDITION) {
            const struct fitting f = fit(d->rendition, d->choice, width, height);
            uint8_t behind[3];
            for (uint32_t y = 0; y < part.height; y++) {
                background_at(behind, background_opaque(d->choice->background), y, part.height);
                canvas_box(&part, 0, y, part.width, 1, behind);
                if (y - f.top < f.shown_height) /* wraps around above */
                    draw_row(&part, &f, d->rendition, y - f.top, behind);
            }
            continue;
        }
        const struct slice_choice slice =
            mosaic_slice(d->scene, d->choice, width, height, (enum slice_plane)pane);
        d->err[pane] = slice_draw(&part, d->scene, &slice, d->style, NULL);
    }
}

enum err mosaic_draw(const struct canvas *canvas, const struct scene *scene,
                     const struct rendition *rendition, const struct mosaic_choice *choice,
                     const struct slice_style *style, struct fault *fault)
{
    struct drawing d = {canvas, scene, rendition, choice, style, {OK}};
    const int64_t seam = seam_of(canvas->width, canvas->height);
    for (int pane = 0; pane < MOSAIC_PANES; pane++) {
        const struct mosaic_box box =
            box_of(choice, canvas->width, canvas->height, (enum mosaic_pane)pane);
        const int64_t right = (int64_t)box.left + box.width, bottom = (int64_t)box.top + box.height;
        if (box.width == 0)
            continue;
        canvas_box(canvas, right, box.top, seam, box.height + seam, seam_grey);
        canvas_box(canvas, box.left, bottom, box.width + seam, seam, seam_grey);
    }
    team_run(choice->team, draw_share, &d);
    for (int i = 0; i < MOSAIC_PANES; i++)
        if (d.err[i])
            return fault_memory(fault, "a slice");
    return OK;
}

struct mosaic_point mosaic_point_of(uint32_t width, uint32_t height,
                                    const struct mosaic_choice *choice,
                                    const struct rendition *rendition, uint32_t column,
                                    uint32_t row)
{
    const struct mosaic_box box = box_of(choice, width, height, MOSAIC_RENDITION);
    const struct fitting f = fit(rendition, choice, width, height);
    const uint32_t x = column < f.from_left ? 0 : column - f.from_left;
    const uint32_t y = row < f.from_top ? 0 : row - f.from_top;
    return (struct mosaic_point){
        box.left + f.left + (uint32_t)((uint64_t)x * f.shown_width / f.width),
        box.top + f.top + (uint32_t)((uint64_t)y * f.shown_height / f.height)};
}

uint32_t mosaic_cell_at(const struct scene *scene, uint32_t width, uint32_t height,
                        const struct rendition *rendition, const struct mosaic_choice *choice,
                        uint32_t column, uint32_t row)
{
    for (int i = 0; i < MOSAIC_PANES; i++) {
        const enum mosaic_pane pane = (enum mosaic_pane)i;
        const struct mosaic_box box = box_of(choice, width, height, pane);
        const uint32_t x = column - box.left, y = row - box.top; /* wraps around left and above */
        if (x >= box.width || y >= box.height)
            continue;
        if (pane == MOSAIC_RENDITION) {
            const struct fitting f = fit(rendition, choice, width, height);
            uint8_t rgba[4];
            if (x - f.left >= f.shown_width || y - f.top >= f.shown_height)
                return CELL_NONE;
            const struct mosaic_box s = source_of(&f, x - f.left, y - f.top);
            return rendition
                ->cell[rendition_mean(rgba, rendition, s.left, s.top, s.width, s.height)];
        }
        const struct slice_choice slice =
            mosaic_slice(scene, choice, width, height, (enum slice_plane)pane);
        return slice_cell_at(scene, &slice, box.width, box.height, x, y);
    }
    return CELL_NONE;
}

/* ---- on a screen ---- */

/* A layout of four panes that fills the screen. Columns and rows are as long as the patient along
 * x, y or z, or as the longest of these (m); an r is the rest, for the rendition, and at least as
 * long as y. In the first layout the lines of the cross-hair continue from pane to pane. */
static const struct arrangement {
    const char *columns, *rows;
    struct stay {
        uint8_t column, row, columns, rows; /* the first track of a pane, and its number of tracks
                                               */
    } stay[MOSAIC_PANES];                   /* axial, coronal, sagittal, rendition */
} arrangement_table[] = {
    {"xy", "zy", {{0, 1, 1, 1}, {0, 0, 1, 1}, {1, 0, 1, 1}, {1, 1, 1, 1}}},
    {"xyr", "zy", {{0, 1, 2, 1}, {0, 0, 1, 1}, {1, 0, 1, 1}, {2, 0, 1, 2}}},
    {"xy", "zyr", {{0, 1, 2, 1}, {0, 0, 1, 1}, {1, 0, 1, 1}, {0, 2, 2, 1}}},
    {"xyxr", "m", {{2, 0, 1, 1}, {0, 0, 1, 1}, {1, 0, 1, 1}, {3, 0, 1, 1}}},
    {"m", "zzyr", {{0, 2, 1, 1}, {0, 0, 1, 1}, {0, 1, 1, 1}, {0, 3, 1, 1}}},
};
enum { ARRANGEMENTS = sizeof arrangement_table / sizeof *arrangement_table, TRACKS_MOST = 4 };

/* Another layout than the first must use more of the screen by this part. */
enum { WORTH = 5 };

enum { LENGTH = 1024, LENGTH_LEAST = LENGTH / 4, SCALE_BITS = 20, CELLS_LEAST = 2 };

/* The patient's lengths, scaled to a maximum of LENGTH; small ones are increased, to leave room
 * for letters. */
static uint64_t length_of(const uint64_t of[3], char track)
{
    const uint64_t most = of[0] > of[1] ? of[0] : of[1];
    return track == 'm' ? (most > of[2] ? most : of[2]) : of[track == 'r' ? 1 : track - 'x'];
}

static uint64_t sum_of(const uint64_t of[3], const char *tracks)
{
    uint64_t sum = 0;
    for (; *tracks; tracks++)
        sum += length_of(of, *tracks);
    return sum;
}

/* Place the beginnings of tracks, and the end of the last, at whole cells, in pixels. If no track
 * fills the rest, all are enlarged. */
static void place_tracks(uint32_t from[TRACKS_MOST + 1], const char *tracks, const uint64_t of[3],
                         uint64_t scale, uint32_t pixels, uint32_t cell)
{
    const uint32_t count = (uint32_t)strlen(tracks), cells = pixels / cell;
    const uint64_t all = sum_of(of, tracks);
    uint64_t before = 0;
    from[0] = 0;
    for (uint32_t i = 1; i < count; i++) {
        before += length_of(of, tracks[i - 1]);
        const uint64_t wanted = strchr(tracks, 'r')
                                    ? ((before * scale >> SCALE_BITS) + cell / 2) / cell
                                    : (before * cells + all / 2) / all;
        const uint32_t first = from[i - 1] / cell + CELLS_LEAST;
        const uint32_t last = cells - (count - i) * CELLS_LEAST;
        from[i] = cell * (wanted < first ? first : wanted > last ? last : (uint32_t)wanted);
    }
    from[count] = pixels;
}

/* Arrange the panes and return the number of pixels in use. Panes that end inside the picture are
 * followed by a seam. */
static uint64_t arrange_panes(struct mosaic_layout *layout, const struct arrangement *a,
                              const struct mosaic_screen *screen, const uint64_t of[3])
{
    const uint64_t across = ((uint64_t)screen->width << SCALE_BITS) / sum_of(of, a->columns);
    const uint64_t down = ((uint64_t)screen->height << SCALE_BITS) / sum_of(of, a->rows);
    const uint64_t scale = across < down ? across : down;
    const uint32_t seam = seam_of(screen->width, screen->height);
    uint32_t column[TRACKS_MOST + 1], row[TRACKS_MOST + 1];
    place_tracks(column, a->columns, of, scale, screen->width, screen->cell_width);
    place_tracks(row, a->rows, of, scale, screen->height, screen->cell_height);
    for (int i = 0; i < MOSAIC_PANES; i++) {
        const struct stay *stay = &a->stay[i];
        const uint32_t right = column[stay->column + stay->columns];
        const uint32_t bottom = row[stay->row + stay->rows];
        struct mosaic_box *box = &layout->box[i];
        box->left = column[stay->column];
        box->top = row[stay->row];
        box->width = right - box->left - (right < screen->width ? seam : 0);
        box->height = bottom - box->top - (bottom < screen->height ? seam : 0);
    }
    const struct mosaic_box *box = &layout->box[MOSAIC_RENDITION];
    const uint64_t side = least(box->width, box->height);
    return (of[0] * of[2] + of[1] * of[2] + of[0] * of[1]) * (scale >> SCALE_BITS / 2) *
               (scale >> SCALE_BITS / 2) / ((uint64_t)1 << SCALE_BITS) +
           side * side;
}

bool mosaic_fits(const struct mosaic_screen *screen)
{
    return screen->width >= MOSAIC_SIDE_LEAST && screen->height >= MOSAIC_SIDE_LEAST &&
           (!screen->shows_all || (screen->width / screen->cell_width >= MOSAIC_COLUMNS_LEAST &&
                                   screen->height / screen->cell_height >= MOSAIC_ROWS_LEAST));
}

void mosaic_lay_out(struct mosaic_layout *layout, const struct scene *scene,
                    const struct mosaic_screen *screen)
{
    static const enum slice_plane across[3] = {SLICE_SAGITTAL, SLICE_CORONAL, SLICE_AXIAL};
    uint64_t length[3], longest = 1;
    for (int i = 0; i < 3; i++) {
        const int axis = slice_axis(scene, across[i]);
        length[i] = (uint64_t)scene->grid.size[axis] * scene->spacing_nm[axis];
        longest = length[i] > longest ? length[i] : longest;
    }
    for (int i = 0; i < 3; i++) {
        const uint64_t part = length[i] / (longest / LENGTH + 1);
        length[i] = part < LENGTH_LEAST ? LENGTH_LEAST : part;
    }
    uint64_t most = 0;
    *layout = (struct mosaic_layout){0};
    if (!screen->shows_all) {
        layout->box[screen->alone] = (struct mosaic_box){0, 0, screen->width, screen->height};
        return;
    }
    for (int i = 0; i < ARRANGEMENTS; i++) {
        const struct arrangement *a = &arrangement_table[i];
        struct mosaic_layout next;
        const bool has_room = /* enough cells for all tracks */
            strlen(a->columns) * CELLS_LEAST <= screen->width / screen->cell_width &&
            strlen(a->rows) * CELLS_LEAST <= screen->height / screen->cell_height;
        const uint64_t used = has_room ? arrange_panes(&next, a, screen, length) : 0;
        if (used > most) {
            most = i == 0 ? used + used / WORTH : used;
            *layout = next;
        }
    }
}
