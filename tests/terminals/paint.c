/* SPDX-License-Identifier: MIT */
/* A picture that is known, painted by the program's own painter into the terminal that this runs
 * in: paint FOLDER SEED EDITS COLUMN ROW COLUMNS ROWS [GRAPHICS|slices]
 *
 * GRAPHICS is a word of --graphics. With `slices` greys lie below, which the terminal is to keep
 * (tui/picture/painter.h): two slices beside each other, which change to others and back.
 *
 * The picture fills COLUMNS x ROWS cells from COLUMN, ROW (0: as many as there are from there on,
 * less the window's last row, which is not for pictures). It follows from SEED and the place's size
 * alone: shades of a few hues in discs and bars, 128 colours at most. Then EDITS patches of it
 * change, each shown before the next, some cleared and painted again. The painter must bring the
 * screen to the same pixels as one whole frame.
 *
 * Left in FOLDER: expected.ppm, the picture after the last edit; facts, "NAME VALUE" lines; and at
 * last `ready`, when the terminal has answered that it has parsed everything. A key ends it. */
#include "base/clock.h"
#include "tests/check.h"
#include "tui/picture/graphics.h"
#include "tui/picture/painter.h"
#include "tui/term.h"

enum { HUES = 8, SHADES = 16, ANSWER_MS = 20000 };

struct known {
    uint32_t width, height;
    uint8_t *rgba;
    uint8_t *below; /* of slices, or NULL */
    uint64_t random;
};

static uint32_t below(struct known *p, uint32_t most)
{
    return (uint32_t)(check_random(&p->random) % most);
}

static void put(struct known *p, uint32_t x, uint32_t y, uint32_t hue, uint32_t shade)
{
    uint8_t *pixel = p->rgba + 4 * ((size_t)y * p->width + x);
    const uint32_t level = 40 + 14 * shade; /* at most 250 */
    pixel[0] = (uint8_t)(hue & 1 ? level : level / 3);
    pixel[1] = (uint8_t)(hue & 2 ? level : level / 5);
    pixel[2] = (uint8_t)(hue & 4 ? level : level / 7);
    pixel[3] = 255;
}

/* A patch that is a disc, a bar, single pixels, or black. */
static void change(struct known *p, uint32_t side)
{
    const uint32_t w = 1 + below(p, side < p->width ? side : p->width);
    const uint32_t h = 1 + below(p, side < p->height ? side : p->height);
    const uint32_t left = below(p, p->width - w + 1), top = below(p, p->height - h + 1);
    const uint32_t kind = below(p, 4), hue = below(p, HUES), shade = below(p, SHADES);
    for (uint32_t y = 0; y < h; y++) {
        for (uint32_t x = 0; x < w; x++) {
            const int64_t dx = 2 * (int64_t)x - w, dy = 2 * (int64_t)y - h;
            const bool inside = dx * dx * h * h + dy * dy * w * w < (int64_t)w * w * h * h;
            if (kind == 0 && inside)
                put(p, left + x, top + y, hue, (shade + x * SHADES / w) % SHADES);
            else if (kind == 1)
                put(p, left + x, top + y, hue, (shade + y / 3) % SHADES);
            else if (kind == 2 && below(p, 29) == 0)
                put(p, left + x, top + y, hue, shade);
            else if (kind == 3)
                memcpy(p->rgba + 4 * ((size_t)(top + y) * p->width + left + x), "\0\0\0\377", 4);
        }
    }
}

/* Greys as the terminal has them, of slice number `n`; what is black shows them. */
static void lay_below(struct known *p, uint32_t n)
{
    for (size_t i = 0; p->below && i < (size_t)p->width * p->height; i++) {
        uint8_t *pixel = p->rgba + 4 * i;
        const uint32_t x = (uint32_t)(i % p->width), y = (uint32_t)(i / p->width);
        const bool is_grey = pixel[0] == pixel[1] && pixel[1] == pixel[2];
        if (y % 200 == 0 && x == 0)
            n++;
        p->below[i] = (uint8_t)strips_colour(
            strips_level((uint8_t)((x * x / 97 + y * y / 61 + n * x / 3) % 256)));
        if (is_grey)
            memset(pixel, p->below[i], 3);
    }
}

static bool begin_picture(struct known *p, bool has_slices)
{
    p->rgba = calloc((size_t)p->width * p->height, 4);
    p->below = has_slices ? calloc((size_t)p->width * p->height, 1) : NULL;
    if (!p->rgba || (has_slices && !p->below))
        return false;
    for (size_t i = 0; i < (size_t)p->width * p->height; i++)
        p->rgba[4 * i + 3] = 255;
    for (int i = 0; i < 40; i++)
        change(p, 220);
    lay_below(p, 0);
    return true;
}

static void write_picture(const struct known *p, const char *path)
{
    OWNED(stream_release) FILE *out = fopen(path, "wb");
    if (!out)
        return;
    fprintf(out, "P6\n%u %u\n255\n", p->width, p->height);
    for (size_t i = 0; i < (size_t)p->width * p->height; i++)
        fwrite(p->rgba + 4 * i, 1, 3, out);
}

/* Send `bytes` and wait until the terminal has received them. */
static bool send(struct buf *bytes, const char *barrier, struct fault *fault)
{
    OWNED(buf_release) struct buf typed = {0};
    buf_add_text(bytes, barrier);
    const bool sent = !bytes->failed && !term_write(bytes->data, bytes->length, fault) &&
                      probe_await(1, ANSWER_MS, &typed) == 1;
    buf_clear(bytes);
    return sent;
}

struct place {
    unsigned column, row, columns, rows;
};

static struct place read_place(char **word)
{
    const struct term_size size = term_size();
    struct place place = {(unsigned)atoi(word[0]), (unsigned)atoi(word[1]), (unsigned)atoi(word[2]),
                          (unsigned)atoi(word[3])};
    if (place.columns == 0)
        place.columns = size.columns - place.column;
    if (place.rows == 0)
        place.rows = size.rows - 1 - place.row;
    return place;
}

struct sent {
    size_t first, edits;
    double ms; /* from before the first frame until the last was parsed */
};

static void show(struct painter *painter, const struct known *p, struct buf *bytes)
{
    static const uint32_t hue[] = {0xFF5533};
    const uint32_t half = p->width / 2;
    const struct raster_box slice[] = {{3, 5, half - 10, p->height - 9},
                                       {half, 0, p->width - half, p->height}};
    struct image_view view = {.width = p->width, .height = p->height, .rgba = p->rgba};
    if (p->below) {
        view.hue = hue;
        view.hues = 1;
        view.below = p->below;
        view.slice = slice;
        view.slices = 2;
        painter_keep(painter, &view, SIZE_MAX, bytes);
    }
    painter_show(painter, &view, bytes);
}

/* Shows the picture and its edits; false where the terminal does not follow. */
static bool paint(struct painter *painter, struct known *p, unsigned edits, struct sent *sent,
                  struct fault *fault)
{
    OWNED(buf_release) struct buf bytes = {0};
    const uint64_t begin = clock_ns();
    buf_add_text(&bytes, "\033[?25l\033[2J");
    show(painter, p, &bytes);
    sent->first = bytes.length;
    bool good = send(&bytes, painter->facts.barrier, fault);
    for (unsigned i = 0; i < edits && good; i++) {
        change(p, 60);
        lay_below(p, i / 5 % 3);
        show(painter, p, &bytes);
        sent->edits += bytes.length;
        good = send(&bytes, painter->facts.barrier, fault);
    }
    sent->ms = (double)(clock_ns() - begin) / 1e6;
    return good;
}

static void write_facts(const char *path, const struct terminal_facts *facts,
                        const struct place *place, const struct sent *sent)
{
    const struct term_size size = term_size();
    OWNED(stream_release) FILE *out = fopen(path, "w");
    if (!out)
        return;
    fprintf(out, "graphics %s\ncell_width %u\ncell_height %u\ncolumns %u\nrows %u\n",
            facts->graphics->name, facts->cell_width, facts->cell_height, size.columns, size.rows);
    fprintf(out, "column %u\nrow %u\nfirst_bytes %zu\nedit_bytes %zu\nms %.1f\n", place->column,
            place->row, sent->first, sent->edits, sent->ms);
}

/* Waits for a key, and leaves the terminal as it was. */
static void wait_key(void)
{
    OWNED(buf_release) struct buf typed = {0};
    term_read(&typed, -1, -1);
}

static bool run(const char *folder, char **word, struct fault *fault)
{
    struct known p = {.random = strtoull(word[0], NULL, 10)};
    OWNED(painter_release) struct painter painter = {0};
    struct terminal_facts facts;
    struct sent sent = {0};
    OWNED(buf_release) struct buf typed = {0};
    char path[512];
    struct graphics_probe probe = {0};
    const bool has_slices = word[6] && strcmp(word[6], "slices") == 0;
    if (word[6] && !has_slices && !graphics_from_name(word[6], &probe.wish))
        return false;
    if (term_set_mode(TERM_RAW, fault))
        return false;
    graphics_probe(&probe, 0, &facts, &typed);
    const struct place place = read_place(word + 2);
    painter_place(&painter, &facts, place.column, place.row, place.columns, place.rows);
    painter_size(&painter, &p.width, &p.height);
    if (!begin_picture(&p, has_slices))
        return false;
    const bool good = paint(&painter, &p, (unsigned)atoi(word[1]), &sent, fault);
    snprintf(path, sizeof path, "%s/expected.ppm", folder);
    write_picture(&p, path);
    snprintf(path, sizeof path, "%s/facts", folder);
    write_facts(path, &facts, &place, &sent);
    snprintf(path, sizeof path, "%s/%s", folder, good ? "ready" : "failed");
    write_picture(&p, path);
    wait_key();
    free(p.rgba);
    free(p.below);
    return good;
}

int main(int count, char **word)
{
    struct fault fault = {0};
    if (count != 8 && count != 9) {
        fputs("paint FOLDER SEED EDITS COLUMN ROW COLUMNS ROWS [GRAPHICS|slices]\n", stderr);
        return 2;
    }
    if (term_open(0, 1, &fault))
        return 2;
    const bool good = run(word[1], word + 2, &fault);
    term_close();
    return good ? 0 : 1;
}
