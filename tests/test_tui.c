/* SPDX-License-Identifier: MIT */
/* The terminal side without a terminal: encoders against decoders of our own, keys, lines, replies,
 * drawing against a small model of a screen. */
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "tests/check_main.h"
#include "tests/kitty_decode.h"
#include "tests/screen.h"
#include "tests/sixel_decode.h"
#include "tui/keys.h"
#include "tui/prompt/line.h"
#include "tui/prompt/line_edit.h"
#include "tui/probe.h"
#include "tui/picture/shades.h"
#include "tui/picture/graphics.h"

/* ---- pictures ---- */

enum { SIDE_MOST = 1100 };
static uint8_t pixels[4 * SIDE_MOST * SIDE_MOST];
static uint32_t decoded[SIDE_MOST * SIDE_MOST];

static struct image_view blank_picture(uint32_t width, uint32_t height)
{
    memset(pixels, 0, sizeof pixels);
    return (struct image_view){.width = width, .height = height, .rgba = pixels};
}

static void set_pixel(const struct image_view *view, uint32_t x, uint32_t y, uint32_t colour)
{
    uint8_t *p = pixels + 4 * ((size_t)y * view->width + x);
    p[0] = (uint8_t)(colour >> 16);
    p[1] = (uint8_t)(colour >> 8);
    p[2] = (uint8_t)colour;
    p[3] = 255;
}

/* A ball of one hue per quarter, shaded from dark to bright, on nothing. */
static struct image_view ball(uint32_t side, uint32_t levels)
{
    static const uint32_t hue[4][3] = {
        {255, 80, 60}, {60, 220, 90}, {80, 120, 255}, {240, 220, 60}};
    struct image_view view = blank_picture(side, side);
    int32_t radius = (int32_t)side * 2 / 5, middle = (int32_t)side / 2;
    for (int32_t y = 0; y < (int32_t)side; y++) {
        for (int32_t x = 0; x < (int32_t)side; x++) {
            int32_t dx = x - middle, dy = y - middle, d = dx * dx + dy * dy;
            if (d > radius * radius)
                continue;
            uint32_t light = levels - (uint32_t)((int64_t)d * (levels - 1) / (radius * radius));
            const uint32_t *h = hue[(dx > 0) + 2 * (dy > 0)];
            set_pixel(&view, (uint32_t)x, (uint32_t)y,
                      h[0] * light / levels << 16 | h[1] * light / levels << 8 |
                          h[2] * light / levels);
        }
    }
    return view;
}

static struct image_view noise(uint32_t width, uint32_t height, uint64_t seed)
{
    struct image_view view = blank_picture(width, height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++)
            set_pixel(&view, x, y, (uint32_t)check_random(&seed) & 0xFFFFFF);
    return view;
}

/* The largest difference of a channel between `decoded` and the view. */
static uint32_t worst_pixel(const struct image_view *view)
{
    uint32_t worst = 0;
    for (size_t i = 0; i < (size_t)view->width * view->height; i++) {
        uint32_t d = channel_distance(decoded[i], image_view_colour(view, i));
        worst = d > worst ? d : worst;
    }
    return worst;
}

static double mean_error(const struct image_view *view)
{
    double sum = 0;
    size_t count = (size_t)view->width * view->height;
    for (size_t i = 0; i < count; i++)
        sum += channel_distance(decoded[i], image_view_colour(view, i));
    return sum / (double)count;
}

/* ---- kitty, sixel ---- */

struct seen {
    uint32_t width, height;
    unsigned colours, chunks; /* size of the palette; 0: none */
    uint32_t worst;           /* pixel, against the view */
};

/* Encode the view and decode it into `decoded`; the bytes stay until the next call. */
static const char *travel(const struct graphics *graphics, const struct image_view *view,
                          struct seen *seen)
{
    static struct kitty_screen screen;
    static struct buf out;
    buf_clear(&out);
    graphics_encode(&(struct terminal_facts){.graphics = graphics}, view, &out);
    const char *text = buf_text(&out);
    if (graphics == &graphics_kitty) {
        while (text && *text)
            text = kitty_feed(&screen, text, 0, 0);
        const struct decoded_png *png = &screen.picture[0].png;
        CHECK(text && screen.picture[0].is_there && !screen.waits);
        *seen = (struct seen){png->width, png->height, png->colours, screen.chunks, 0};
        memcpy(decoded, png->pixel, sizeof *decoded * png->width * png->height);
        kitty_release(&screen);
    } else {
        struct decoded_sixel s;
        CHECK(sixel_decode(&s, &text) && *text == '\0' && s.all_painted);
        *seen = (struct seen){s.width, s.height, s.colours, 1, 0};
        memcpy(decoded, s.pixel, sizeof *decoded * s.width * s.height);
        free(s.pixel);
    }
    CHECK(seen->width == view->width && seen->height == view->height);
    seen->worst = worst_pixel(view);
    return buf_text(&out);
}

STORY(pictures_of_few_and_many_colours_travel_to_kitty_exactly)
{
    struct seen seen;
    struct image_view view = ball(301, 40);
    travel(&graphics_kitty, &view, &seen);
    CHECK(seen.colours > 0 && seen.chunks > 1 && seen.worst == 0); /* as a palette */
    view = noise(97, 61, 1);
    travel(&graphics_kitty, &view, &seen);
    CHECK(seen.colours == 0 && seen.worst == 0);
    for (uint32_t height = 1; height <= 13; height += 3) {
        view = noise(1, height, height);
        travel(&graphics_kitty, &view, &seen);
        CHECK(seen.chunks == 1 && seen.worst == 0);
    }
}

STORY(a_transparent_pixel_is_black)
{
    struct image_view view = blank_picture(2, 1);
    memcpy(pixels, (uint8_t[]){200, 100, 50, 0, 200, 100, 50, 128}, 8);
    CHECK_INT(image_view_colour(&view, 0), 0);
    CHECK_INT(image_view_colour(&view, 1), 0x643219);
}

STORY(pictures_survive_sixel_as_far_as_its_colours_go)
{
    struct seen seen;
    struct image_view view = ball(302, 50); /* few colours: within a percent */
    travel(&graphics_sixel, &view, &seen);
    CHECK(seen.colours <= SHADES_MOST && seen.worst <= 2);
    view = ball(256, 256); /* many are reduced, always to the same */
    OWNED(mem_release) char *once = strdup(travel(&graphics_sixel, &view, &seen));
    CHECK(seen.colours > 200 && seen.colours <= SHADES_MOST && seen.worst <= 12);
    CHECK(mean_error(&view) < 2.0);
    CHECK_TEXT(travel(&graphics_sixel, &view, &seen), once);
    for (uint32_t height = 1; height < 14; height++) { /* odd sizes */
        view = noise(300 - 23 * height, height, height);
        travel(&graphics_sixel, &view, &seen);
        CHECK(seen.worst < 128);
    }
}

STORY(two_nearly_equal_colours_among_many_do_not_stall_the_reduction)
{
    struct image_view view = noise(64, 64, 9);
    OWNED(shades_release) struct shades shades = {0};
    set_pixel(&view, 0, 0, 0x000000);
    set_pixel(&view, 1, 0, 0x000100);
    CHECK(!shades_take_exact(&shades, &view)); /* there are more */
    CHECK(shades_choose(&shades, &view) && shades.count == 238);
}

/* ---- scaling, blocks ---- */

STORY(shrinking_takes_the_mean_of_whole_and_part_pixels)
{
    struct image_view view = blank_picture(3, 1);
    set_pixel(&view, 0, 0, 0x300000);
    set_pixel(&view, 1, 0, 0x600000);
    set_pixel(&view, 2, 0, 0x000030);
    OWNED(mem_release) uint8_t *half = image_view_shrink(&view, 2, 1);
    CHECK(half != NULL);
    CHECK_INT(half[0], 0x40); /* (1 * 0x30 + 1/2 * 0x60) / 1.5 */
    CHECK_INT(half[4], 0x20);
    CHECK_INT(half[6], 0x20);
    CHECK_INT(half[7], 255);
}

STORY(fitting_keeps_the_shape_and_never_enlarges)
{
    static const uint32_t cases[][6] = {{400, 200, 1000, 1000, 400, 200},
                                        {400, 200, 100, 100, 100, 50},
                                        {400, 200, 400, 10, 20, 10},
                                        {400, 1, 10, 10, 10, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct image_view view = {.width = cases[i][0], .height = cases[i][1]};
        uint32_t w, h;
        image_view_fit(&view, cases[i][2], cases[i][3], &w, &h);
        CHECK(w == cases[i][4] && h == cases[i][5]);
    }
}

/* The view as lines of half blocks, in at most columns x rows cells; until the next call. */
static const char *blocks(const struct image_view *view, enum colours colours, uint32_t columns,
                          uint32_t rows)
{
    static struct buf out;
    const struct terminal_facts facts = {.colours = colours, .shape = BLOCK_HALF};
    buf_clear(&out);
    graphics_halves.lines(&facts, view, columns, rows, &out);
    return buf_text(&out);
}

STORY(blocks_hold_two_pixels_a_cell_and_change_colour_only_where_it_changes)
{
    struct image_view view = blank_picture(3, 2);
    set_pixel(&view, 0, 0, 0xFF0000);
    set_pixel(&view, 0, 1, 0x0000FF);
    set_pixel(&view, 1, 0, 0x0000FF);
    set_pixel(&view, 1, 1, 0xFF0000);
    CHECK_TEXT(blocks(&view, COLOURS_24BIT, 80, 24),
               "\033[38;2;255;0;0;48;2;0;0;255m\u2580\u2584\033[48;2;0;0;0m \033[m\r\n");
    CHECK_TEXT(blocks(&view, COLOURS_256, 80, 24),
               "\033[38;5;196;48;5;21m\u2580\u2584\033[48;5;16m \033[m\r\n");
}

STORY(without_colours_blocks_are_a_ramp_of_plain_characters)
{
    struct image_view view = blank_picture(4, 3);
    set_pixel(&view, 0, 0, 0xFFFFFF);
    set_pixel(&view, 0, 1, 0xFFFFFF);
    set_pixel(&view, 2, 0, 0xFFFFFF);
    CHECK_TEXT(blocks(&view, COLOURS_NONE, 80, 24), "@ +\r\n\r\n");
    unsigned lines = 0;
    view = ball(200, 30); /* in no more cells than there are */
    for (const char *end, *at = blocks(&view, COLOURS_NONE, 33, 10); *at; at = end + 1, lines++) {
        end = strchr(at, '\n');
        CHECK(end - at - 1 <= 20);
    }
    CHECK_INT(lines, 10);
}

STORY(the_nearest_of_256_colours_is_the_nearest)
{
    static const uint32_t level[] = {0, 95, 135, 175, 215, 255};
    struct image_view view = {.width = 1, .height = 2, .rgba = pixels};
    uint64_t seed = 5;
    for (int i = 0; i < 3000; i++) {
        uint32_t colour = (uint32_t)check_random(&seed) & 0xFFFFFF, best = UINT32_MAX;
        if (i % 3 == 0)
            colour = (colour & 255) * 0x010101;
        uint32_t of_chosen = 0, chosen = 0;
        set_pixel(&view, 0, 0, colour);
        set_pixel(&view, 0, 1, colour);
        CHECK(sscanf(blocks(&view, COLOURS_256, 1, 1), "\033[48;5;%u", &chosen) == 1);
        for (uint32_t k = 16; k < 256; k++) {
            uint32_t grey = 8 + 10 * (k - 232), n = k - 16, sum = 0;
            uint32_t c[3] = {k < 232 ? level[n / 36] : grey, k < 232 ? level[n / 6 % 6] : grey,
                             k < 232 ? level[n % 6] : grey};
            for (unsigned j = 0; j < 3; j++) {
                int32_t d = (int32_t)c[j] - (int32_t)(colour >> (16 - 8 * j) & 255);
                sum += (uint32_t)(d * d);
            }
            best = sum < best ? sum : best;
            of_chosen = k == chosen ? sum : of_chosen;
        }
        CHECK_INT(of_chosen, best);
    }
}

/* Check text with a sixel picture between a head and a tail. */
static void check_framed(const char *text, const char *head, uint32_t side, const char *tail)
{
    struct decoded_sixel s = {0};
    CHECK(strncmp(text, head, strlen(head)) == 0);
    text += strlen(head);
    CHECK(sixel_decode(&s, &text) && s.all_painted && s.width == side && s.height == side);
    CHECK_TEXT(text, tail);
    free(s.pixel);
}

STORY(a_picture_at_the_prompt_is_framed_and_fits)
{
    struct terminal_facts facts = {
        .graphics = &graphics_sixel, .cell_width = 10, .cell_height = 20, .image_side_most = 1000};
    struct image_view view = ball(90, 30);
    OWNED(buf_release) struct buf out = {0};
    show_inline(&facts, &view, 80, 24, &out);
    check_framed(buf_text(&out), "\r\n\n\n\n\n\033[5A\0337", 90, "\0338\033[5B\r");
    buf_clear(&out);
    show_inline(&facts, &view, 80, 4, &out); /* three rows of 20 px are left */
    check_framed(buf_text(&out), "\r\n\n\n\033[3A\0337", 60, "\0338\033[3B\r");
    buf_clear(&out);
    view = ball(1050, 30);
    show_inline(&facts, &view, 300, 100, &out);
    CHECK_HAS(buf_text(&out), "\n\033[50A\0337\033P");
    check_framed(strstr(buf_text(&out), "\033P"), "", 1000, "\0338\033[50B\r");
    buf_clear(&out);
    facts.graphics = &graphics_none;
    show_inline(&facts, &view, 80, 24, &out);
    CHECK_INT(out.length, 0);
}

STORY(a_picture_of_512x512_is_encoded_within_a_few_milliseconds)
{
    const struct terminal_facts by[] = {{.graphics = &graphics_kitty},
                                        {.graphics = &graphics_sixel}};
    static const uint32_t levels[] = {32, 256};
    for (unsigned i = 0; i < 2; i++) {
        struct image_view view = ball(512, levels[i]);
        OWNED(buf_release) struct buf out = {0};
        uint64_t best[3] = {UINT64_MAX, UINT64_MAX, UINT64_MAX};
        size_t bytes[3] = {0};
        for (unsigned n = 0; n < 15; n++) {
            for (unsigned k = 0; k < 3; k++) {
                buf_clear(&out);
                const clock_t begin = clock();
                if (k < 2)
                    graphics_encode(&by[k], &view, &out);
                else
                    buf_add_text(&out, blocks(&view, COLOURS_24BIT, 120, 49));
                const uint64_t took = (uint64_t)(clock() - begin) * (1000000000 / CLOCKS_PER_SEC);
                best[k] = took < best[k] ? took : best[k];
                bytes[k] = out.length;
            }
        }
        printf("# %u levels: kitty %.2f ms %zu bytes, sixel %.2f ms %zu bytes, blocks %.2f ms %zu "
               "bytes\n",
               levels[i], (double)best[0] / 1e6, bytes[0], (double)best[1] / 1e6, bytes[1],
               (double)best[2] / 1e6, bytes[2]);
        CHECK(best[0] < 200000000 && best[1] < 200000000 && best[2] < 200000000);
    }
}

/* ---- keys ---- */

/* Feeds bytes and writes the events down, in words. */
static void write_event(struct buf *out, const struct keys *k, const struct key_event *event)
{
    static const char *const name[] = {
        "none", "character", "enter", "tab",    "backspace", "escape", "up",
        "down", "right",     "left",  "home",   "end",       "insert", "delete",
        "pgup", "pgdown",    "paste", "pasted", "reply",     "mouse",  "other"};
    static const char *const button[] = {"left", "middle", "right", "-"};
    static const char *const action[] = {"pressed", "released", "moved", "wheel-up", "wheel-down"};
    if (out->length > 0)
        buf_add_char(out, ' ');
    if (event->modifiers & KEY_CONTROL)
        buf_add_text(out, "C-");
    if (event->modifiers & KEY_ALT)
        buf_add_text(out, "A-");
    if (event->modifiers & KEY_SHIFT)
        buf_add_text(out, "S-");
    if (event->key == KEY_CHARACTER)
        buf_add(out, event->text, event->length);
    else if (event->key == KEY_REPLY)
        buf_printf(out, "<%s>", k->body);
    else if (event->key == KEY_MOUSE)
        buf_printf(out, "%s:%s@%u,%u", button[event->mouse.button], action[event->mouse.action],
                   event->mouse.column, event->mouse.row);
    else
        buf_add_text(out, name[event->key]);
}

static enum mouse_unit unit; /* unit of the reports */
static void feed_keys(struct buf *out, const char *bytes, size_t length)
{
    struct keys k = {.unit = unit};
    struct key_event event;
    buf_clear(out);
    for (size_t i = 0; i < length; i++)
        if (keys_feed(&k, (uint8_t)bytes[i], &event))
            write_event(out, &k, &event);
    if (keys_waiting(&k) && keys_time_out(&k, &event))
        write_event(out, &k, &event);
}

struct key_case {
    const char *bytes, *events;
};

static void check_keys(const struct key_case *cases, size_t count)
{
    OWNED(buf_release) struct buf out = {0};
    for (size_t i = 0; i < count; i++) {
        feed_keys(&out, cases[i].bytes, strlen(cases[i].bytes));
        CHECK_TEXT(buf_text(&out), cases[i].events);
    }
}

#define CHECK_KEYS(...)                                                                            \
    check_keys((const struct key_case[]){__VA_ARGS__},                                             \
               sizeof((const struct key_case[]){__VA_ARGS__}) / sizeof(struct key_case))

STORY(characters_come_out_whole_and_control_and_alt_keys_are_told_from_text)
{
    CHECK_KEYS({"a\u00e4\u20ac\U0001F9E0", "a \u00e4 \u20ac \U0001F9E0"},
               {"\xC3(", "("}, /* truncated: the next byte still counts */
               {"\xE2\x82\xE2\x82\xAC", "\u20ac"}, {"\x80\xBFx\xFF\xC0\xAFy", "x y"},
               {"\xED\xA0\x80z", "z"}, /* a surrogate */
               {"\xC2\x9Bz", "z"});    /* a C1 control in disguise */
    CHECK_KEYS({"\x01\x1A\t\r\n\x7F\x08", "C-a C-z tab enter enter backspace backspace"},
               {"\033b\033\x7F\033\r", "A-b A-backspace A-enter"}, {"\033\u00e4", "A-\u00e4"},
               {"\x1F\x1C", "C-_ C-\\"});
}

STORY(cursor_keys_come_in_two_dialects_and_a_paste_is_marked_off)
{
    CHECK_KEYS({"\033[A\033[B\033[C\033[D\033[H\033[F", "up down right left home end"},
               {"\033OA\033OB\033OC\033OD\033OH\033OF", "up down right left home end"},
               {"\033[1~\033[4~\033[7~\033[8~\033[2~\033[3~\033[5~\033[6~",
                "home end home end insert delete pgup pgdown"},
               {"\033[1;5C\033[1;3D\033[3;2~\033[Z", "C-right A-left S-delete S-tab"},
               {"\033Oc\033OM\033\033[A", "C-right enter A-up"},
               {"\033\033[?62;4cx", "A-<[?62;4c> x"}, /* Escape, then a reply */
               {"\033OP\033[15~\033[[Ax\033[1;2P", "other other other x S-other"});
    CHECK_KEYS({"\033[200~ab\n\033[201~", "paste a b enter pasted"});
}

STORY(replies_are_swallowed_whole_whenever_they_come)
{
    CHECK_KEYS({"a\033[?62;4cb", "a <[?62;4c> b"},
               {"\033P>|kitty(0.26.5)\033\\x", "<P>|kitty(0.26.5)> x"},
               {"\033_Gi=31;OK\033\\x", "<_Gi=31;OK> x"},
               {"\033]11;rgb:0000/0000/0000\007x", "<]11;rgb:0000/0000/0000> x"},
               {"\033[>41;379;0c\033[6;18;9t\033[?2;0;1000;1000S\033[12;40R",
                "<[>41;379;0c> <[6;18;9t> <[?2;0;1000;1000S> <[12;40R>"},
               {"\033]0;never ended\rx", "enter x"}, /* a cut reply does not swallow Enter */
               {"\033[?6\003", "C-c"}, {"\033P>|x\033[Ay", "up y"}, {"\033\\x", "A-other x"});
    OWNED(buf_release) struct buf out = {0}, reply = {0};
    buf_add_text(&reply, "\033P");
    for (int i = 0; i < 5000; i++)
        buf_add_char(&reply, 'x');
    buf_add_text(&reply, "\033\\z");
    feed_keys(&out, reply.data, reply.length);
    CHECK(out.length > 2 && strcmp(out.data + out.length - 3, "> z") == 0);
}

STORY(the_mouse_is_reported_in_two_ways_and_reports_without_sense_are_swallowed)
{
    CHECK_KEYS(
        {"\033[<0;11;6M\033[<0;11;6mx", "left:pressed@10,5 left:released@10,5 x"},
        {"\033[<1;1;1M\033[<2;300;200M", "middle:pressed@0,0 right:pressed@299,199"},
        {"\033[<32;5;6M\033[<35;5;6M", "left:moved@4,5 -:moved@4,5"},
        {"\033[<64;5;6M\033[<65;5;6M", "-:wheel-up@4,5 -:wheel-down@4,5"},
        {"\033[<20;5;6M\033[<8;5;6M", "C-S-left:pressed@4,5 A-left:pressed@4,5"},
        {"\033[M +&\033[M#+&\033[M`!!x", "left:pressed@10,5 -:released@10,5 -:wheel-up@0,0 x"});
    CHECK_KEYS({"\033[<66;5;6M\033[<128;5;6Mx", "other other x"}, /* a wheel that tilts; button 8 */
               {"\033[<0;0;6M\033[<0;5;0M\033[<0;5M\033[<M\033[<0;5;6;7Mx",
                "other other other other other x"},
               {"\033[<0;99999999999999999999;6Mx", "left:pressed@99998,5 x"},
               {"\033[<0;5\003", "C-c"}, {"\033[M !\rx", "enter x"}, {"\033[M   x", "other x"},
               {"\033[I\033[Ox", "other other x"}); /* the focus came and went */
}

STORY(the_mouse_may_be_reported_by_pixels_which_begin_at_0_or_1)
{
    unit = MOUSE_PIXELS;
    CHECK_KEYS({"\033[<0;101;51M\033[<0;101;51m", "left:pressed@100,50 left:released@100,50"},
               {"\033[<0;1;1M\033[<32;0;-17M\033[<0;-3;5m",
                "left:pressed@0,0 left:moved@0,0 left:released@0,4"}, /* outside the window */
               {"\033[<288;0;0Mx", "other x"},                        /* kitty: it has left it */
               {"\033[<0;;6M\033[<0;5;-M\033[<0;5M\033[<0;5-;6M\033[<0;5;6;7Mx",
                "other other other other other x"});
    unit = MOUSE_PIXELS_FROM_0;
    CHECK_KEYS({"\033[<0;100;50M\033[<32;0;0M\033[<0;-2;1m",
                "left:pressed@100,50 left:moved@0,0 left:released@0,1"});
    unit = MOUSE_CELLS;
    CHECK_KEYS({"\033[<0;-3;5Mx", "other x"});
}

STORY(escape_is_a_key_when_nothing_follows)
{
    CHECK_KEYS({"\033", "escape"}, {"\033[", "A-["}, {"\033O", "A-O"}, {"\033P", "A-P"},
               {"\033]", "A-]"}, {"\033\033", "A-escape"});
    struct keys k = {0};
    struct key_event event;
    CHECK(!keys_waiting(&k) && !keys_feed(&k, 033, &event) && keys_waiting(&k));
    keys_feed(&k, '[', &event);
    keys_feed(&k, '1', &event);
    CHECK(!keys_waiting(&k)); /* too far to be a key: the rest may take its time */
}

STORY(any_bytes_at_all_lead_back_to_the_ground)
{
    uint64_t seed = 11;
    for (int round = 0; round < 2000; round++) {
        struct keys k = {0};
        struct key_event event;
        static const char spice[] = "\033\033[]OP_;?0123456789~ABc\\\a\r\xC3\xA4\x80";
        for (int i = 0; i < 40; i++) {
            uint8_t byte = check_below(&seed, 3)
                               ? (uint8_t)spice[check_below(&seed, sizeof spice - 1)]
                               : (uint8_t)check_below(&seed, 256);
            if (keys_feed(&k, byte, &event))
                CHECK(k.state == KEYS_GROUND && event.key != KEY_PENDING);
        }
        keys_feed(&k, '\r', &event);
        CHECK(keys_feed(&k, 'x', &event) && event.key == KEY_CHARACTER && event.point == 'x');
    }
}

/* ---- replies and decisions ---- */

static struct probe probe;
#define heard probe.replies
static struct buf typed;

static void take_all(const char *bytes, size_t piece)
{
    struct keys keys = {0};
    size_t length = strlen(bytes);
    probe = (struct probe){0};
    buf_clear(&typed);
    for (size_t i = 0; i < length; i += piece) {
        probe.due = 1; /* asked again after each DA1 */
        probe_take(&probe, &keys, bytes + i, length - i < piece ? length - i : piece, &typed);
    }
}

STORY(replies_are_understood_however_they_are_split)
{
    static const char bytes[] =
        "\033[>41;379;0c\033P>|XTerm(379)\033\\op\033[6;18;9t\033[4;450;720t"
        "en\033[?2;0;1000;900S\033[?63;1;2;4;6;9;15;22c ch2";
    for (size_t piece = 1; piece < sizeof bytes; piece++) {
        take_all(bytes, piece);
        CHECK(heard.da1 && (heard.attributes >> 4 & 1) && heard.answers[0] == 0);
        CHECK_TEXT(heard.name, "XTerm(379)");
        CHECK_INT(heard.cell_width, 9);
        CHECK_INT(heard.cell_height, 18);
        CHECK_INT(heard.text_width, 720);
        CHECK_INT(heard.image_height, 900);
        CHECK_TEXT(buf_text(&typed), "open ch2");
    }
}

STORY(parameter_4_is_a_whole_number)
{
    static const struct {
        const char *bytes;
        bool sixel;
    } cases[] = {{"\033[?62;4;22c", true},   {"\033[?63;1;2;3;4c", true}, {"\033[?62;42c", false},
                 {"\033[?64;14;24c", false}, {"\033[?1;2c", false},       {"\033[?6c", false},
                 {"\033[?65;1;9c", false},   {"\033[>4;4;4c", false},     {"\033[4;4;4c", false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        take_all(cases[i].bytes, 1);
        CHECK_INT(heard.attributes >> 4 & 1, cases[i].sixel);
    }
}

STORY(garbage_is_no_reply)
{
    static const char *const cases[] = {"\033[?c",
                                        "\033[?;;;c",
                                        "\033[?99999999999999;4444444444c",
                                        "\033P>|\033\\",
                                        "\033[6;t",
                                        "\033[6;18t",
                                        "\033[4;1;2;3t",
                                        "\033_Gi=31;ENOENT\033\\",
                                        "\033[?2;3;0S",
                                        "\033[?1;0;256S"};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        take_all(cases[i], 1);
        CHECK(!(heard.attributes >> 4 & 1) && !strstr(heard.answers, "OK") &&
              heard.cell_width == 0 && heard.image_width == 0 && heard.text_width == 0);
        CHECK_TEXT(buf_text(&typed), "");
    }
}

static struct terminal_facts decide(const char *term, const char *replies_text, const char *name,
                                    bool no_color)
{
    struct term_size size = {.columns = 80, .rows = 24};
    struct graphics_wish wish;
    struct terminal_facts facts;
    take_all(replies_text, 7);
    heard.environment =
        (struct probe_environment){.term = term, .colorterm = "", .no_color = no_color};
    if (strstr(replies_text, "_Gi=31"))
        CHECK(graphics_kitty.question.may_ask(&heard));
    CHECK(graphics_from_name(name, &wish));
    graphics_decide(&heard, &size, wish, &facts);
    return facts;
}

STORY(each_terminal_gets_the_graphics_it_has)
{
    static const struct {
        const char *term, *replies;
        const struct graphics *graphics;
        enum colours colours;
    } cases[] = {
        {"xterm-256color", "\033[>41;379;0c\033P>|XTerm(379)\033\\\033[?63;1;2;4;6c",
         &graphics_sixel, COLOURS_24BIT},
        {"xterm-256color", "\033P>|XTerm(379)\033\\\033[?64;1;2;6c", &graphics_quadrants,
         COLOURS_24BIT},
        {"xterm-kitty", "\033P>|kitty(0.26.5)\033\\\033[?62c\033_Gi=31;OK\033\\\033[?62c",
         &graphics_kitty, COLOURS_24BIT},
        {"foot", "\033P>|foot(1.13.1)\033\\\033[?62;4;22c", &graphics_sixel, COLOURS_24BIT},
        {"mlterm", "\033[?63;1;2;3;4;7;29c", &graphics_sixel, COLOURS_256},
        {"screen-256color", "\033P>|tmux 3.3a\033\\\033[?1;2c", &graphics_halves, COLOURS_24BIT},
        {"tmux-256color", "\033P>|tmux 3.4\033\\\033[?1;2;4c", &graphics_halves, COLOURS_24BIT},
        {"screen", "\033[?1;2;4c", &graphics_halves, COLOURS_256},
        {"linux", "", &graphics_halves, COLOURS_16},
        {"dumb", "", &graphics_none, COLOURS_NONE},
        {"", "", &graphics_none, COLOURS_NONE},
        {"rxvt-unicode-256color", "\033[?1;2c", &graphics_halves, COLOURS_256}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct terminal_facts f = decide(cases[i].term, cases[i].replies, "auto", false);
        CHECK_TEXT(f.graphics->name, cases[i].graphics->name);
        CHECK_INT(f.colours, cases[i].colours);
    }
}

STORY(a_wish_overrides_and_no_color_means_shades)
{
    static const char vt340[] = "\033[?63;1;2;4c";
    CHECK(decide("xterm", vt340, "kitty", false).graphics == &graphics_tiles);
    CHECK(decide("xterm", "\033P>|kitty(0.31)\033\\\033[?62c", "kitty", false).graphics ==
          &graphics_kitty);
    CHECK(decide("xterm", vt340, "tiles", false).graphics == &graphics_tiles);
    CHECK(decide("xterm", vt340, "none", false).graphics == &graphics_none);
    CHECK(decide("xterm", vt340, "auto", true).graphics == &graphics_halves);
    CHECK_INT(decide("xterm", vt340, "auto", true).colours, COLOURS_NONE);
    struct graphics_wish only_halves, only_none, only_kitty;
    CHECK(graphics_from_name("halves", &only_halves) && graphics_from_name("none", &only_none) &&
          graphics_from_name("kitty", &only_kitty));
    struct probe_environment e = {.term = "xterm", .colorterm = ""};
    CHECK(!probe_is_silent(&e, graphics_asks(graphics_auto, &e)));
    CHECK(!probe_is_silent(&e, graphics_asks(only_halves, &e))); /* one question: see test_probe */
    CHECK(probe_is_silent(&e, graphics_asks(only_none, &e)));
    e = (struct probe_environment){.term = "linux", .colorterm = ""};
    CHECK(probe_is_silent(&e, graphics_asks(only_kitty, &e)));
}

STORY(only_the_kitty_family_is_asked_for_kitty_graphics)
{
    static const struct {
        const char *term, *name;
        bool ask;
    } cases[] = {{"xterm-kitty", "", true},
                 {"xterm-kitty", "kitty(0.31.0)", true},
                 {"xterm-ghostty", "", true},
                 {"xterm-256color", "WezTerm 2024", true},
                 {"xterm-256color", "Konsole 23.08", true},
                 {"xterm-256color", "XTerm(379)", false},
                 {"xterm-256color", "", false},
                 {"xterm-kitty", "tmux 3.3a", false},
                 {"screen.xterm-kitty", "", false},
                 {"tmux-256color", "kitty(0.31.0)", false},
                 {"xterm-kitty", "XTerm(379)", false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct probe_replies r = {.environment = {.term = cases[i].term, .colorterm = ""},
                                  .kind = 1};
        snprintf(r.name, sizeof r.name, "%s", cases[i].name);
        CHECK_INT(graphics_kitty.question.may_ask(&r), cases[i].ask);
    }
}

STORY(the_cell_size_comes_from_whoever_tells_a_sensible_one)
{
    static const struct {
        struct term_size size;
        const char *replies;
        uint32_t width, height;
    } cases[] = {{{80, 24, 724, 436}, "\033[6;20;10t", 9, 18},
                 {{80, 24, 0, 0}, "\033[6;20;10t\033[4;1;1t", 10, 20},
                 {{80, 24, 0, 0}, "\033[4;360;560t", 7, 15},
                 {{80, 24, 80, 24}, "", 8, 16},
                 {{80, 24, 60000, 60000}, "\033[6;900;3t", 8, 16}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct terminal_facts f;
        take_all(cases[i].replies, 3);
        heard.environment = (struct probe_environment){.term = "xterm", .colorterm = ""};
        probe_decide(&heard, &cases[i].size, &f);
        CHECK_INT(f.cell_width, cases[i].width);
        CHECK_INT(f.cell_height, cases[i].height);
        CHECK_INT(f.image_side_most, 1000);
    }
    CHECK_INT(decide("foot", "\033[?2;0;10000;8000S\033[?62;4c", "auto", false).image_side_most,
              8000);
}

/* ---- the line ---- */

static struct line_history old_lines;
static struct line line;

static void begin_line(const char *const *entries, size_t count)
{
    line_history_release(&old_lines);
    line_release(&line);
    for (size_t i = 0; i < count; i++)
        line_history_add(&old_lines, entries[i], strlen(entries[i]));
    line = (struct line){.history = &old_lines, .place = old_lines.count};
}

static void type(const char *text)
{
    line_insert(&line, text, strlen(text));
}

static void act(enum line_action action, unsigned times)
{
    while (times-- > 0)
        line_act(&line, action);
}

/* The text with the cursor as a bar. */
static const char *shown(void)
{
    static char text[4096];
    snprintf(text, sizeof text, "%.*s|%s", (int)line.cursor, buf_text(&line.text),
             buf_text(&line.text) + line.cursor);
    return text;
}

/* Keys as a terminal sends them. */
#define LEFT           "\002"
#define RIGHT          "\006"
#define WORD_LEFT      "\033b"
#define WORD_RIGHT     "\033f"
#define HOME           "\001"
#define END            "\005"
#define ERASE          "\177"
#define DELETE         "\033[3~"
#define KILL_TO_END    "\013"
#define KILL_TO_START  "\025"
#define KILL_BLANK     "\027"
#define KILL_WORD_LEFT "\033\177"
#define KILL_WORD      "\033d"
#define YANK           "\031"
#define TRANSPOSE      "\024"
#define UNDO           "\037"
#define OLDER          "\020"
#define NEWER          "\016"
#define OLDEST         "\033<"
#define NEWEST         "\033>"
#define LAST_WORD      "\033."

/* Type text and keys, and compare the line after them. */
struct typed {
    const char *bytes, *shown;
};

static void check_typed(const struct typed *row, size_t rows)
{
    for (; rows-- > 0; row++) {
        struct keys keys = {0};
        struct key_event event;
        char before[LINE_KEYS_MOST] = "";
        for (const char *at = row->bytes; *at; at++) {
            if (!keys_feed(&keys, (uint8_t)*at, &event))
                continue;
            const unsigned found = line_key_find(&event, before);
            if (found < LINE_ACTIONS)
                line_act(&line, (enum line_action)found);
            else
                line_insert(&line, event.text, event.length);
        }
        CHECK_TEXT(shown(), row->shown);
    }
}

#define TYPED(...)                                                                                 \
    check_typed((const struct typed[]){__VA_ARGS__},                                               \
                sizeof((const struct typed[]){__VA_ARGS__}) / sizeof(struct typed))

STORY(typing_moving_and_deleting_what_the_eye_sees_as_one_character)
{
    begin_line(NULL, 0);
    TYPED({LEFT LEFT ERASE DELETE TRANSPOSE KILL_TO_END, "|"}, /* nothing there yet */
          {"seed 1,2,3 brain" WORD_LEFT WORD_LEFT, "seed 1,2,|3 brain"},
          {ERASE DELETE "4", "seed 1,24| brain"}, {WORD_RIGHT, "seed 1,24 brain|"},
          {RIGHT RIGHT RIGHT DELETE HOME RIGHT, "s|eed 1,24 brain"});
    begin_line(NULL, 0);
    TYPED({"ae\u0301\u0323\U0001F9E0\u00e4" LEFT LEFT LEFT, "a|e\u0301\u0323\U0001F9E0\u00e4"},
          {DELETE, "a|\U0001F9E0\u00e4"}, {END TRANSPOSE, "a\u00e4\U0001F9E0|"},
          {ERASE, "a\u00e4|"});
}

STORY(kills_gather_and_come_back_and_letters_are_transposed)
{
    begin_line(NULL, 0);
    TYPED({"view 30 15 0" KILL_BLANK KILL_BLANK, "view 30 |"}, {YANK YANK, "view 30 15 015 0|"},
          {HOME KILL_WORD KILL_TO_END, "|"}, {"x" YANK, "xview 30 15 015 0|"},
          /* something else between: a new kill begins */
          {KILL_WORD_LEFT LEFT KILL_TO_START YANK, "xview 30 15 015| "});
    begin_line(NULL, 0);
    TYPED({"ab" TRANSPOSE, "ba|"}, {HOME TRANSPOSE, "|ba"}, {RIGHT TRANSPOSE, "ab|"});
}

STORY(browsing_older_lines_keeps_the_one_begun)
{
    static const char *const entries[] = {"open ch2", "run", "run", " secret", "render"};
    begin_line(entries, 5);
    CHECK_INT(old_lines.count, 3);       /* no repetition, nothing after a blank */
    TYPED({"see" HOME OLDER, "render|"}, /* every line begins with the empty prefix */
          {OLDER OLDER OLDER OLDER OLDER OLDER OLDER, "open ch2|"}, {NEWER, "run|"},
          {NEWEST, "see|"}, {NEWER, "see|"}, {OLDEST, "open ch2|"});
}

/* "run|seed 2": the list of a search, the one that is chosen after a mark. */
static const char *list_of_search(void)
{
    static struct buf list;
    buf_clear(&list);
    for (size_t i = 0; i < line.found_count; i++)
        buf_printf(&list, "%s%s%s", i ? "|" : "", i == line.chosen ? "> " : "",
                   line.history->line[line.found[i]]);
    return buf_text(&list);
}

STORY(a_search_is_a_list_that_narrows)
{
    static const char *const entries[] = {"seed 1,1,1 a", "run",          "seed 2,2,2 b",
                                          "run",          "seed 1,1,1 a", "save run"};
    begin_line(entries, 6);
    type("dra");
    line_search_begin(&line); /* all lines, each once; the typed text stays until one is chosen */
    CHECK_TEXT(list_of_search(), "save run|seed 1,1,1 a|run|seed 2,2,2 b");
    CHECK_TEXT(shown(), "dra|");
    line_search_older(&line);
    CHECK_TEXT(list_of_search(), "> save run|seed 1,1,1 a|run|seed 2,2,2 b");
    line_search_add(&line, "seed", 4);
    CHECK_TEXT(list_of_search(), "> seed 1,1,1 a|seed 2,2,2 b");
    line_search_newer(&line); /* there is no newer one */
    CHECK_TEXT(shown(), "|seed 1,1,1 a");
    line_search_older(&line);
    CHECK_TEXT(list_of_search(), "seed 1,1,1 a|> seed 2,2,2 b");
    line_search_newer(&line);
    CHECK_TEXT(shown(), "|seed 1,1,1 a");
    line_search_add(&line, " 2", 2);
    CHECK_TEXT(list_of_search(), "> seed 2,2,2 b");
    line_search_add(&line, "x", 1);
    CHECK_TEXT(list_of_search(), "");
    CHECK(line.search_failed);
    CHECK_TEXT(shown(), "|seed 2,2,2 b"); /* the line found last */
    line_search_end(&line, true);
    CHECK_TEXT(shown(), "|seed 2,2,2 b");
}

STORY(searching_goes_back_and_can_be_given_up)
{
    static const char *const entries[] = {"seed 1,1,1 a", "view left", "seed 2,2,2 b", "run"};
    begin_line(entries, 4);
    type("dra");
    line_search_begin(&line);
    line_search_add(&line, "s", 1);
    line_search_add(&line, "eed", 3);
    CHECK_TEXT(shown(), "|seed 2,2,2 b");
    line_search_older(&line);
    CHECK_TEXT(shown(), "|seed 1,1,1 a");
    line_search_older(&line);
    CHECK(line.search_failed);
    CHECK_TEXT(shown(), "|seed 1,1,1 a");
    line_search_erase(&line);
    CHECK(!line.search_failed);
    CHECK_TEXT(shown(), "|seed 2,2,2 b");
    line_search_end(&line, false);
    CHECK_TEXT(shown(), "dra|");
    line_search_begin(&line);
    line_search_add(&line, "lef", 3);
    line_search_end(&line, true);
    CHECK_TEXT(shown(), "view |left");
    type("<");
    CHECK_TEXT(shown(), "view <|left");
}

static const char *const sessions[] = {"seed 1,1,1 a",          "view left",
                                       "seed 2,2,2 b",          "run",
                                       "seed 3,3,3 a radius=2", "label 2 \"left hemi\""};

STORY(older_lines_begin_with_what_stands_before_the_cursor_and_their_last_words_are_cited)
{
    begin_line(sessions, 6);
    TYPED({"seed" OLDER, "seed 3,3,3 a radius=2|"}, {OLDER, "seed 2,2,2 b|"},
          {OLDER OLDER OLDER OLDER OLDER, "seed 1,1,1 a|"}, {NEWER, "seed 2,2,2 b|"},
          {NEWER NEWER, "seed|"}, {NEWER, "seed|"}, {OLDEST, "seed 1,1,1 a|"},
          /* only the text before the cursor counts */
          {NEWEST LEFT LEFT LEFT OLDER, "seed 3,3,3 a radius=2|"},
          {HOME OLDER, "run|"}, /* on from there, whatever they begin with */
          /* no older line any more: it is today's */
          {"x" HOME OLDER, "label 2 \"left hemi\"|"}, {NEWER, "runx|"},
          {"zzz" OLDER, "runxzzz|"}); /* nothing begins so */
    begin_line(sessions, 6);
    TYPED(
        {"x " LAST_WORD, "x \"left hemi\"|"}, {LAST_WORD, "x radius=2|"},
        {LAST_WORD LAST_WORD, "x b|"},
        {LAST_WORD LAST_WORD LAST_WORD LAST_WORD LAST_WORD LAST_WORD LAST_WORD LAST_WORD LAST_WORD,
         "x a|"},
        {UNDO, "x |"}, /* all as one */
        {LEFT LAST_WORD, "x\"left hemi\"| "});
}

STORY(what_was_done_to_a_line_is_undone_step_by_step)
{
    begin_line(sessions, 6);
    TYPED({UNDO "seed 1,2" LEFT LEFT ERASE ERASE, "seed|,2"},
          {UNDO, "seed 1|,2"}, /* characters erased one after another are one step, */
          {UNDO, "seed |"},    /* and so is a word */
          {UNDO, "|"}, {UNDO UNDO UNDO, "|"},
          {"v" OLDER OLDER KILL_TO_START YANK UNDO UNDO, "view left|"}, {UNDO, "v|"});
    line_paste(&line, "a", 1);
    line_paste(&line, " b", 2);
    line_paste(&line, "c", 1);
    TYPED({"", "va bc|"}, {UNDO, "v|"});
}

STORY(letters_of_a_word_change_with_their_bytes)
{
    begin_line(NULL, 0);
    type("label 2 \u00e9tag\u00e8re \u0131x \xff stra\u00dfe");
    TYPED({HOME "\033u", "LABEL| 2 \u00e9tag\u00e8re \u0131x \xff stra\u00dfe"},
          {"\033c\033c", "LABEL 2 \u00c9tag\u00e8re| \u0131x \xff stra\u00dfe"},
          /* two bytes become one; characters without case stay */
          {"\033u\033u\033u", "LABEL 2 \u00c9tag\u00e8re IX \xff STRA\u00dfE|"},
          {"\033u" WORD_LEFT "\033l", "LABEL 2 \u00c9tag\u00e8re IX \xff stra\u00dfe|"},
          {UNDO, "LABEL 2 \u00c9tag\u00e8re IX \xff |STRA\u00dfE"});
}

/* Labels of the name b are no more. */
static bool knows(void *context, const char *text)
{
    ++*(int *)context;
    return text[strlen(text) - 1] != 'b';
}

static const char *suggested(void)
{
    int asked = 0;
    return line_suggestion(&line, knows, &asked);
}

STORY(the_newest_line_that_begins_so_and_is_known_is_suggested)
{
    static const char *const entries[] = {"seed 1,1,1 a radius=2", "se\u0301ed", "seed 2,2,2 b"};
    begin_line(entries, 3);
    CHECK_TEXT(suggested(), ""); /* nothing is typed */
    type("se");
    CHECK_TEXT(suggested(), "ed 1,1,1 a radius=2"); /* neither a combining mark nor the line of b */
    act(LINE_LEFT, 1);
    CHECK_TEXT(suggested(), "");
    CHECK(!line_take_suggestion(&line, "", LINE_RIGHT));
    act(LINE_RIGHT, 1);
    CHECK(!line_take_suggestion(&line, suggested(), LINE_LEFT));
    CHECK(line_take_suggestion(&line, suggested(), LINE_WORD_RIGHT));
    CHECK_TEXT(shown(), "seed|");
    CHECK(line_take_suggestion(&line, suggested(), LINE_WORD_RIGHT));
    CHECK_TEXT(shown(), "seed 1|");
    CHECK(line_take_suggestion(&line, suggested(), LINE_END));
    CHECK_TEXT(shown(), "seed 1,1,1 a radius=2|");
    CHECK_TEXT(suggested(), "");
    TYPED({UNDO, "seed 1|"});
}

STORY(a_hundred_lines_that_are_no_more_known_are_not_all_tried)
{
    int asked = 0;
    begin_line(NULL, 0);
    for (int i = 0; i < 100; i++) {
        char entry[32];
        snprintf(entry, sizeof entry, "seed %d b", i);
        line_history_add(&old_lines, entry, strlen(entry));
    }
    line = (struct line){.history = &old_lines, .place = old_lines.count};
    type("s");
    CHECK_TEXT(line_suggestion(&line, knows, &asked), "");
    CHECK(asked < 100);
}

/* The text of a line before each change, so that undo can be compared. */
STORY(random_edits_are_undone_one_by_one)
{
    static const char *const piece[] = {"a", "\u00e4", "\u8166", " ", "x y", "e\u0301", "\xff"};
    enum { EDITS = 60 };
    uint64_t seed = 5;
    for (int round = 0; round < 300; round++) {
        static char before[EDITS + 1][4096];
        size_t steps = 0, held[EDITS + 1];
        begin_line(sessions, 6);
        for (int i = 0; i < EDITS; i++) {
            const uint32_t what = check_below(&seed, LINE_ACTIONS + 8);
            const size_t had = line.undo.count;
            char text[4096];
            snprintf(text, sizeof text, "%s", buf_text(&line.text));
            if (what == LINE_UNDO)
                continue;
            if (what < LINE_ACTIONS)
                line_act(&line, (enum line_action)what);
            else
                type(piece[check_below(&seed, 7)]);
            CHECK(line.cursor <= line.text.length && line.undo.count >= had);
            if (line.undo.count > had) {
                memcpy(before[steps], text, sizeof text);
                held[steps++] = line.undo.count;
            }
        }
        while (steps-- > 0) {
            CHECK_INT(line.undo.count, held[steps]);
            act(LINE_UNDO, 1);
            CHECK_TEXT(buf_text(&line.text), before[steps]);
            CHECK(line.cursor <= line.text.length);
        }
        CHECK_INT(line.text.length + line.undo.removed.length, 0);
    }
}

STORY(undo_holds_no_more_than_it_may)
{
    OWNED(buf_release) struct buf large = {0};
    begin_line(NULL, 0);
    for (int i = 0; i < 3 * LINE_UNDO_MOST; i++) {
        type("a ");
        type("b ");
    }
    CHECK(line.undo.count <= LINE_UNDO_MOST);
    act(LINE_UNDO, 2 * LINE_UNDO_MOST);
    CHECK(line.text.length > 0 && line.undo.count == 0);
    while (large.length <= LINE_UNDO_BYTES)
        buf_add_text(&large, "0123456789abcdef");
    line_paste(&line, large.data, large.length);
    act(LINE_KILL_TO_START, 1); /* too much to hold */
    act(LINE_UNDO, 1);
    CHECK_INT(line.text.length, 0);
}

STORY(the_table_of_keys_names_them_all)
{
    static const struct {
        const char *bytes;
        unsigned found;
    } cases[] = {{"\x01", LINE_HOME},
                 {"\033[H", LINE_HOME},
                 {"\x1f", LINE_UNDO},
                 {"\033.", LINE_LAST_WORD},
                 {"\033u", LINE_UPPER},
                 {"\033U", LINE_UPPER},
                 {"\033[1;2D", LINE_LEFT}, /* with Shift */
                 {"\033[1;3D", LINE_WORD_LEFT},
                 {"\033[1;6C", LINE_WORD_RIGHT}, /* Ctrl and Shift */
                 {"\033[3;5~", LINE_KILL_WORD_RIGHT},
                 {"\033<", LINE_OLDEST},
                 {"\x18", DUTY_MORE},
                 {"\x18\x05", DUTY_OTHER_EDITOR},
                 {"\x18\x18", DUTY_NONE},
                 {"\x18\x18\x05", LINE_END},
                 {"\x18x\x05", LINE_END},
                 {"\033[2~", DUTY_NONE},
                 {"\033q", DUTY_NONE},
                 {"\033\u00e9", DUTY_NONE},
                 {"\r", DUTY_SUBMIT}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct keys keys = {0};
        struct key_event event;
        char before[LINE_KEYS_MOST] = "";
        unsigned found = DUTY_NONE;
        for (const char *at = cases[i].bytes; *at; at++)
            if (keys_feed(&keys, (uint8_t)*at, &event))
                found = line_key_find(&event, before);
        CHECK_INT(found, cases[i].found);
        CHECK(*before == '\0' || found == DUTY_MORE);
    }
}

STORY(the_page_of_keys_is_the_one_in_the_readme)
{
    OWNED(buf_release) struct buf page = {0}, readme = {0};
    line_keys_page(&page);
    for (const char *at = buf_text(&page); *at; at += strcspn(at, "\n") + 1)
        CHECK(strcspn(at, "\n") <= 80);
    CHECK(file_read(&readme, "tui/README.md", 1 << 20, NULL) == OK);
    CHECK_HAS(buf_text(&readme), buf_text(&page));
}

/* ---- drawing, on a screen of 10x6 ---- */

static struct screen screen;
static struct line_drawing drawn;

static void begin_screen(void)
{
    memset(&screen, 0, sizeof screen);
    screen_resize(&screen, 10, 6);
    drawn = (struct line_drawing){0};
}

/* The rows of the screen, separated by '/', with the cursor as a bar. */
static const char *screen_text(const struct screen *s)
{
    static char text[2][2048];
    static unsigned next;
    char *out = text[next++ % 2];
    size_t used = 0, kept = 0;
    for (unsigned r = 0; r < s->rows; r++) {
        for (unsigned c = 0; c < s->columns; c++) {
            const bool is_cursor = r == s->row && c == s->column;
            const int n = sprintf(out + used, "%s%s", is_cursor ? "|" : "", s->cell[r][c].text);
            used += (size_t)n;
            kept = n > 0 ? used : kept;
        }
        out[used++] = '/';
    }
    out[kept] = '\0';
    return out;
}

static const char *draw_on(struct screen *s, struct line_drawing *d, const char *text,
                           size_t cursor, const char *below)
{
    OWNED(buf_release) struct buf out = {0};
    const struct line_content content = {
        .prompt = "> ", .text = text, .length = strlen(text), .cursor = cursor, .below = below};
    line_draw(d, &content, s->columns, s->rows, &out);
    screen_write(s, buf_text(&out), out.length);
    return screen_text(s);
}

static const char *draw(const char *text, size_t cursor)
{
    return draw_on(&screen, &drawn, text, cursor, NULL);
}

STORY(a_line_is_drawn_with_its_cursor_and_wraps_at_the_right_margin)
{
    begin_screen();
    CHECK_TEXT(draw("", 0), "> |");
    CHECK_TEXT(draw("abc", 3), "> abc|");
    CHECK_TEXT(draw("abc", 1), "> a|bc");
    CHECK_TEXT(draw("x", 0), "> |x");
    CHECK_TEXT(draw("abcdefg", 7), "> abcdefg|");
    CHECK_TEXT(draw("abcdefgh", 8), "> abcdefgh/|"); /* just full: the cursor is a row further */
    CHECK_TEXT(draw("abcdefghi", 9), "> abcdefgh/i|");
    CHECK_TEXT(draw("abcdefghi", 0), "> |abcdefgh/i");
    CHECK_TEXT(draw("abcdefghijklmnopqrstuvw", 23), "> abcdefgh/ijklmnopqr/stuvw|");
    CHECK_TEXT(draw("abc", 3), "> abc|");
}

STORY(what_stands_below_a_line_has_the_rows_that_are_left)
{
    begin_screen();
    CHECK_TEXT(draw_on(&screen, &drawn, "abc", 1, "one\ntwo\n"), "> a|bc/one/two");
    CHECK_TEXT(draw_on(&screen, &drawn, "abcdefghij", 10, "one\ntwo\n"),
               "> abcdefgh/ij|/one/two"); /* two rows */
    CHECK_TEXT(draw_on(&screen, &drawn, "abcdefghij", 1, "1\n2\n3\n4\n5\n6\n7\n"),
               "> a|bcdefgh/ij/1/2/3/4");
    CHECK_TEXT(draw("abc", 3), "> abc|");
    CHECK_INT(screen.scrolled, 0);
}

STORY(wide_characters_and_marks_take_the_cells_they_take)
{
    begin_screen();
    /* the wide one does not fit in the last column */
    CHECK_TEXT(draw("abcdefg\u8166x", 10), "> abcdefg/\u8166|x");
    CHECK_TEXT(draw("abcdefge\u0301x", 10), "> abcdefge\u0301/|x");
    CHECK_TEXT(draw("a\x1b[2J\u202e", 5), "> a\\x1b[2J/|\\xe2\\x80\\x/ae");
    CHECK_INT(cells_width("a\u8166e\u0301", 7), 4);
}

STORY(a_line_taller_than_the_screen_shows_what_is_around_the_cursor)
{
    char text[100];
    begin_screen();
    for (unsigned i = 0; i < 99; i++)
        text[i] = (char)('a' + i % 26);
    text[99] = '\0';
    CHECK_TEXT(draw(text, 99), /* 101 cells: eleven rows of ten */
               "wxyzabcdef/ghijklmnop/qrstuvwxyz/abcdefghij/klmnopqrst/u|");
    CHECK_TEXT(draw(text, 0), "> |abcdefgh/ijklmnopqr/stuvwxyzab/cdefghijkl/mnopqrstuv/wxyzabcdef");
    draw(text, 30);
    CHECK_TEXT(draw("abc", 3), "> abc|");
    CHECK_INT(screen.scrolled, 0);
}

STORY(random_edits_always_draw_what_a_fresh_screen_would_show)
{
    static const char *const piece[] = {"a",       "bc",   "\u00e4", "\u8166",
                                        "e\u0301", "\x01", " ",      "x y"};
    static struct screen fresh;
    uint64_t seed = 21;
    begin_screen();
    begin_line(NULL, 0);
    for (int i = 0; i < 4000; i++) {
        uint32_t what = check_below(&seed, LINE_ACTIONS + 5);
        if (line.text.length > 40)
            line_clear(&line);
        if (what < LINE_ACTIONS)
            line_act(&line, (enum line_action)what);
        type(piece[check_below(&seed, 8)]);
        struct line_drawing nothing = {0};
        memset(&fresh, 0, sizeof fresh);
        screen_resize(&fresh, 10, 6);
        const char *now = draw(buf_text(&line.text), line.cursor);
        CHECK_TEXT(now, draw_on(&fresh, &nothing, buf_text(&line.text), line.cursor, NULL));
    }
}

STORY(widths_of_characters)
{
    static const struct {
        uint32_t point;
        unsigned width;
    } cases[] = {{'a', 1},    {0xE4, 1},    {0x301, 0},  {0x200D, 0}, {0x4E2D, 2}, {0xFF21, 2},
                 {0xFE0F, 0}, {0x1F9E0, 2}, {0x2580, 1}, {0xAC00, 2}, {0x1160, 0}, {0x10FFFF, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        CHECK_INT(char_width(cases[i].point), cases[i].width);
}

/* ---- replies ---- */

static void wraps(const char *text, unsigned columns, const char *expected)
{
    OWNED(buf_release) struct buf in = {0}, out = {0};
    buf_add_text(&in, text);
    cells_wrap(&out, &in, columns);
    CHECK_TEXT(buf_text(&out), expected);
}

STORY(replies_are_broken_between_words_and_go_on_where_their_text_began)
{
    wraps("", 10, "");
    wraps("one two", 10, "one two");
    wraps("one\ntwo\n", 10, "one\r\ntwo\r\n");
    wraps("1234567890\n", 10, "1234567890\r\n");
    wraps("one two three\n", 10, "one two\r\nthree\r\n");
    wraps("12345 7890 1\n", 10, "12345 7890\r\n1\r\n");
    wraps("one two \n", 7, "one two\r\n");
    wraps("a/path/that/is/long and on\n", 10, "a/path/that/is/long\r\nand on\r\n");
    wraps("at a/path/that/is/long\n", 10, "at\r\na/path/that/is/long\r\n");
    wraps("\u00e9\u00e9 \u00e9\u00e9 \u00e9\n", 5, "\u00e9\u00e9 \u00e9\u00e9\r\n\u00e9\r\n");
    wraps("\u4e2d\u4e2d \u4e2d\n", 6, "\u4e2d\u4e2d\r\n\u4e2d\r\n"); /* two cells each */
    wraps("\033[31merror:\033[m bad\n", 10, "\033[31merror:\033[m bad\r\n");
    wraps("view  one two three\n", 14, "view  one two\r\n      three\r\n");
    wraps("  one two three\n", 9, "  one two\r\n  three\r\n");
    wraps("one two three  four\n", 16, "one two three\r\nfour\r\n"); /* beyond the middle */
    wraps("    a b\n", 1, "    a\r\nb\r\n");
}
