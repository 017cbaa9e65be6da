#include "render/mosaic_screen.h"

#include <string.h>

#include "base/least.h"

/* A way to lay four panes out. Columns and rows are as long as the patient along x, y or z, or as
 * the longest of these (m); an r has what is left, for the rendition, and a y at least. */
static const struct arrangement {
    const char *columns, *rows;
    struct stay {
        uint8_t column, row, columns, rows; /* the first that a pane lies in, and how many */
    } stay[MOSAIC_PANES];
} arrangement_table[] = {
    {"xy",
     "zy",
     {[MOSAIC_CORONAL] = {0, 0, 1, 1},
      [MOSAIC_SAGITTAL] = {1, 0, 1, 1},
      [MOSAIC_AXIAL] = {0, 1, 1, 1},
      [MOSAIC_RENDITION] = {1, 1, 1, 1}}},
    {"xyr",
     "zy",
     {[MOSAIC_CORONAL] = {0, 0, 1, 1},
      [MOSAIC_SAGITTAL] = {1, 0, 1, 1},
      [MOSAIC_AXIAL] = {0, 1, 1, 1},
      [MOSAIC_RENDITION] = {2, 0, 1, 2}}},
    {"xy",
     "zyr",
     {[MOSAIC_CORONAL] = {0, 0, 1, 1},
      [MOSAIC_SAGITTAL] = {1, 0, 1, 1},
      [MOSAIC_AXIAL] = {0, 1, 1, 1},
      [MOSAIC_RENDITION] = {0, 2, 2, 1}}},
    {"xyxr",
     "m",
     {[MOSAIC_CORONAL] = {0, 0, 1, 1},
      [MOSAIC_SAGITTAL] = {1, 0, 1, 1},
      [MOSAIC_AXIAL] = {2, 0, 1, 1},
      [MOSAIC_RENDITION] = {3, 0, 1, 1}}},
    {"m",
     "zzyr",
     {[MOSAIC_CORONAL] = {0, 0, 1, 1},
      [MOSAIC_SAGITTAL] = {0, 1, 1, 1},
      [MOSAIC_AXIAL] = {0, 2, 1, 1},
      [MOSAIC_RENDITION] = {0, 3, 1, 1}}},
};
enum { ARRANGEMENTS = sizeof arrangement_table / sizeof *arrangement_table, TRACKS_MOST = 4 };

enum { LENGTH = 1024, LENGTH_LEAST = LENGTH / 4, SCALE_BITS = 20, CELLS_LEAST = 2 };

/* The patient's lengths: the longest is LENGTH, and what is very flat counts as less so, for its
 * letters need room. */
struct lengths {
    uint64_t of[3];
};

static struct lengths lengths_of(const struct scene *scene)
{
    static const enum slice_plane across[3] = {SLICE_SAGITTAL, SLICE_CORONAL, SLICE_AXIAL};
    struct lengths lengths;
    uint64_t most = 1;
    for (int i = 0; i < 3; i++) {
        const int axis = slice_axis(scene, across[i]);
        lengths.of[i] = (uint64_t)scene->grid.size[axis] * scene->spacing_nm[axis];
        most = lengths.of[i] > most ? lengths.of[i] : most;
    }
    for (int i = 0; i < 3; i++) {
        const uint64_t part = lengths.of[i] / (most / LENGTH + 1);
        lengths.of[i] = part < LENGTH_LEAST ? LENGTH_LEAST : part;
    }
    return lengths;
}

static uint64_t length_of(const struct lengths *lengths, char track)
{
    const uint64_t *of = lengths->of;
    const uint64_t most = of[0] > of[1] ? of[0] : of[1];
    return track == 'm' ? (most > of[2] ? most : of[2]) : of[track == 'r' ? 1 : track - 'x'];
}

static uint64_t sum_of(const struct lengths *lengths, const char *tracks)
{
    uint64_t sum = 0;
    for (; *tracks; tracks++)
        sum += length_of(lengths, *tracks);
    return sum;
}

/* Where tracks begin and the last one ends, in pixels, at whole cells. Where none takes what is
 * left, all are longer than they need be. */
static void place_tracks(uint32_t from[TRACKS_MOST + 1], const char *tracks,
                         const struct lengths *lengths, uint64_t scale, uint32_t pixels,
                         uint32_t cell)
{
    const uint32_t count = (uint32_t)strlen(tracks), cells = pixels / cell;
    const uint64_t all = sum_of(lengths, tracks);
    uint64_t before = 0;
    from[0] = 0;
    for (uint32_t i = 1; i < count; i++) {
        before += length_of(lengths, tracks[i - 1]);
        const uint64_t wanted = strchr(tracks, 'r')
                                    ? ((before * scale >> SCALE_BITS) + cell / 2) / cell
                                    : (before * cells + all / 2) / all;
        const uint32_t first = from[i - 1] / cell + CELLS_LEAST;
        const uint32_t last = cells - (count - i) * CELLS_LEAST;
        from[i] = cell * (wanted < first ? first : wanted > last ? last : (uint32_t)wanted);
    }
    from[count] = pixels;
}

/* Panes that end inside the picture leave a seam free. */
static void place_panes(struct mosaic_layout *layout, const struct arrangement *a,
                        const struct mosaic_screen *screen, const struct lengths *lengths,
                        uint64_t scale)
{
    const uint32_t seam = mosaic_seam(screen->width, screen->height);
    uint32_t column[TRACKS_MOST + 1], row[TRACKS_MOST + 1];
    place_tracks(column, a->columns, lengths, scale, screen->width, screen->cell_width);
    place_tracks(row, a->rows, lengths, scale, screen->height, screen->cell_height);
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
}

/* Lays the panes out; how many pixels show something. */
static uint64_t arrange(struct mosaic_layout *layout, const struct arrangement *a,
                        const struct mosaic_screen *screen, const struct lengths *lengths)
{
    const uint64_t *of = lengths->of;
    const uint64_t across = ((uint64_t)screen->width << SCALE_BITS) / sum_of(lengths, a->columns);
    const uint64_t down = ((uint64_t)screen->height << SCALE_BITS) / sum_of(lengths, a->rows);
    const uint64_t scale = across < down ? across : down;
    place_panes(layout, a, screen, lengths, scale);
    const struct mosaic_box *box = &layout->box[MOSAIC_RENDITION];
    const uint64_t side = least(box->width, box->height);
    return (of[0] * of[2] + of[1] * of[2] + of[0] * of[1]) * (scale >> SCALE_BITS / 2) *
               (scale >> SCALE_BITS / 2) / ((uint64_t)1 << SCALE_BITS) +
           side * side;
}

/* Whether there are cells for all tracks. */
static bool has_room(const struct arrangement *a, const struct mosaic_screen *screen)
{
    return strlen(a->columns) * CELLS_LEAST <= screen->width / screen->cell_width &&
           strlen(a->rows) * CELLS_LEAST <= screen->height / screen->cell_height;
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
    const struct lengths lengths = lengths_of(scene);
    uint64_t most = 0;
    *layout = (struct mosaic_layout){0};
    if (!screen->shows_all) {
        layout->box[screen->alone] = (struct mosaic_box){0, 0, screen->width, screen->height};
        return;
    }
    for (int i = 0; i < ARRANGEMENTS; i++) {
        const struct arrangement *a = &arrangement_table[i];
        struct mosaic_layout next;
        const uint64_t used = has_room(a, screen) ? arrange(&next, a, screen, &lengths) : 0;
        if (used > most) {
            most = used;
            *layout = next;
        }
    }
}
