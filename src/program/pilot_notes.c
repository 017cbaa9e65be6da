
#include <string.h>

enum { BAR_FROM_COLUMNS = 16, BAR_FROM_ROWS = 7 }; /* cells of a pane */

static const uint8_t black[3] = {0, 0, 0}, ink[3] = {232, 232, 232};

struct notes {
    struct image_note *note;
    size_t count;
};

/* A pane in cells: the first ones, and the last that are no other pane's neighbours, so that no two
 * letters stand together. */
struct cells {
    uint32_t left, top, right, bottom;
};

static struct cells cells_of(const struct mosaic_screen *screen, const struct mosaic_box *box)
{
    return (struct cells){box->left / screen->cell_width, box->top / screen->cell_height,
                          (box->left + box->width) / screen->cell_width - 1,
                          (box->top + box->height) / screen->cell_height - 1};
}

static void add_note(struct notes *notes, uint32_t column, uint32_t row, char character)
{
    if (notes->count < PILOT_NOTES_MOST)
        notes->note[notes->count++] =
            (struct image_note){(uint16_t)column, (uint16_t)row, character};
}

static void add_letters(struct notes *notes, enum slice_plane plane, const struct cells *pane)
{
    const uint32_t centre = (pane->left + pane->right + 1) / 2;
    const uint32_t middle = (pane->top + pane->bottom + 1) / 2;
    char letter[4];
    slice_letters(plane, letter);
    if (pane->right < pane->left + 2 || pane->bottom < pane->top + 2)
        return; /* no room for all of them, and one alone misleads */
    add_note(notes, pane->left, middle, letter[0]);
    add_note(notes, pane->right, middle, letter[1]);
    add_note(notes, centre, pane->top, letter[2]);
    add_note(notes, centre, pane->bottom, letter[3]);
}

/* Bottom left: a bar in the lower part of a row of cells, and its length above it. None where that
 * would reach the middle, where a letter is. */
static void add_bar(struct notes *notes, const struct canvas *canvas,
                    const struct mosaic_screen *screen, const struct mosaic_box *box,
                    const struct cells *pane, uint64_t pixel_pm)
{
    const uint64_t length = slice_round_length(pixel_pm * box->width / 3 + 1);
    const int64_t pixels = (int64_t)((length + pixel_pm / 2) / pixel_pm);
    const int64_t tall = screen->cell_height, thick = (tall + 2) / 3;
    const int64_t left = (pane->left + 1) * (int64_t)screen->cell_width,
                  top = (pane->bottom - 1) * tall;
    char words[32];
    slice_length_words(words, length);
    if (pane->left + 2 + strlen(words) > (pane->left + pane->right) / 2)
        return;
    canvas_box(canvas, left, top, pixels, tall - thick, black);
    canvas_box(canvas, left, top + tall - thick, pixels, thick, ink);
    for (uint32_t i = 0; words[i]; i++)
        add_note(notes, pane->left + 1 + i, pane->bottom - 2, words[i]);
}

size_t pilot_notes_add(struct image_note note[PILOT_NOTES_MOST], const struct canvas *canvas,
                       const struct session *session, const struct slicing_panel *panel)
{
    struct notes notes = {note, 0};
    const struct scene *scene = session->scene;
    const struct mosaic_screen *screen = &panel->screen;
    bool has_bar = false;
    for (enum slice_plane plane = SLICE_AXIAL; plane <= SLICE_SAGITTAL; plane++) {
        const struct mosaic_box *box = &panel->layout.box[plane];
        if (box->width == 0 || !session->now.outlook.slices.words)
            continue;
        const struct cells pane = cells_of(screen, box);
        if (!scene->sides_unknown)
            add_letters(&notes, plane, &pane);
        if (!has_bar && !scene->spacing_unknown && pane.right - pane.left >= BAR_FROM_COLUMNS - 1 &&
            pane.bottom - pane.top >= BAR_FROM_ROWS - 1)
            add_bar(
                &notes, canvas, screen, box, &pane,
                mosaic_slice(scene, &panel->choice, canvas->width, canvas->height, plane).pixel_pm);
        has_bar = true;
    }
    return notes.count;
}
