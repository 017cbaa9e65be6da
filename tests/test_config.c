/* SPDX-License-Identifier: MIT */
/* The configuration: each kind of line, and messages about wrong lines. */

#include "base/file.h"
#include "program/programs.h"
#include "tests/check_main.h"
#include "tests/folder.h"
#include "tui/pilot/pilot_keys.h"

static struct config config;

static void take(const char *text)
{
    config_release(&config);
    config = (struct config){.setup = pilot_setup_default};
    buf_add_text(&config.path, "c");
    config_take(&config, text, strlen(text));
}

static const char *words_of(const char *text)
{
    take(text);
    return buf_text(&config.words);
}

static void read_file(void)
{
    config_release(&config);
    config = (struct config){.setup = pilot_setup_default};
    config_read(&config);
}

static const char *keys_of(const char *name)
{
    static struct buf keys;
    buf_clear(&keys);
    setup_add_keys(&keys, &config.setup, setup_row(&config.setup, name), SIZE_MAX);
    return buf_text(&keys);
}

STORY(every_kind_of_line)
{
    take(
        "# a comment\n\n  theme\tlight \r\nbrush 3 2\nwindow liver 60 160\nwindow bone 700.5 3000\n"
        "key undo U Ctrl-u\nkey plant p2 ä\nstart overlay tint\nstart  label 1 \"left hemi\"");
    CHECK_TEXT(buf_text(&config.words), "");
    CHECK_TEXT(config.setup.theme->name, "light");
    CHECK(config.setup.brush.label == 3 && config.setup.brush.radius == 2);
    CHECK_INT(config.setup.windows, 5);
    CHECK_TEXT(config.setup.window[4].name, "liver");
    CHECK(config.setup.window[4].centre == 60000 && config.setup.window[4].width == 160000);
    CHECK(config.setup.window[0].centre == 700500 && config.setup.window[0].width == 3000000);
    CHECK_TEXT(keys_of("undo"), "U Ctrl-u");
    CHECK_TEXT(keys_of("plant"), "p2 ä");
    CHECK_TEXT(buf_text(&config.start), "9 overlay tint\n10 label 1 \"left hemi\"\n");
}

STORY(an_empty_file_gives_the_defaults)
{
    take("");
    CHECK_TEXT(buf_text(&config.words), "");
    CHECK(!config.setup.theme); /* by the terminal */
    CHECK(config.setup.brush.label == 1 && config.setup.brush.radius == 6 &&
          config.setup.windows == 4);
    take("brush 7\ntheme none");
    CHECK(config.setup.brush.label == 7 && config.setup.brush.radius == 6);
    take("brush 7 0");
    CHECK(config.setup.brush.radius == 0);
    take("graphics quadrants");
    CHECK(config.graphics.count == 1 && config.graphics.of[0] == &graphics_quadrants);
    take("graphics quadrants\ngraphics auto");
    CHECK_INT(config.graphics.count, graphics_auto.count);
    take("theme none");
    CHECK(!config.setup.theme->has_colours);
}

STORY(slices_are_sent_ahead_unless_it_says_otherwise)
{
    take("");
    CHECK(!config.setup.sends_none_ahead);
    take("ahead off");
    CHECK(config.setup.sends_none_ahead);
    CHECK_TEXT(buf_text(&config.words), "");
    take("ahead off\nahead on");
    CHECK(!config.setup.sends_none_ahead);
    take("ahead never");
    CHECK_TEXT(buf_text(&config.words), "c:1: expected on or off, not never; left out\n");
}

STORY(a_brush_is_passed_to_the_pilot_and_exact_or_not_from_the_start)
{
    const struct pilot_brush *brush = &config.setup.brush;
    take("brush 3 2.5mm range=-40.5..80");
    CHECK_TEXT(buf_text(&config.words), "");
    CHECK(brush->label == 3 && brush->in_mm && brush->radius == 5);
    CHECK(brush->has_range && decimal_value(&brush->range[0]) == -40.5 &&
          decimal_value(&brush->range[1]) == 80);
    take("brush 4 range=1..2");
    CHECK(brush->label == 4 && !brush->in_mm && brush->radius == 6 && brush->has_range);
    take("brush 4 32mm");
    CHECK(brush->in_mm && brush->radius == 64 && !brush->has_range);
    take("brush 3 2\nbrush exact\nbrush 4");
    CHECK_TEXT(buf_text(&config.words), "");
    CHECK(brush->growth == BRUSH_EXACT && brush->label == 4 && brush->radius == 6);
    take("brush exact\nbrush grows");
    CHECK(brush->growth == BRUSH_GROWS);
    take("brush 4");
    CHECK(brush->growth == BRUSH_BY_PIECES);
    CHECK_HAS(words_of("brush exact 4"), "range=LOW..HIGH; or exact or grows alone; left out\n");
    CHECK_HAS(words_of("brush 4 exact"), "c:1: expected a label");
}

STORY(the_default_brush_fits_the_scene)
{
    static const struct {
        const char *line;
        uint32_t side;
        unsigned radius;
    } row[] = {{"", 181, 6},         {"", 59, 5},
               {"", 12, 1},          {"", 3, 1},
               {"brush 2", 30, 3},   {"brush 2 range=1..9", 30, 3},
               {"brush 2 9", 30, 9}, {"brush 2 9mm", 30, 18}};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        struct pilot_state state;
        take(row[i].line);
        pilot_state_init(&state, &config.setup);
        pilot_fit_brush(&state, row[i].side);
        CHECK_INT(state.brush.radius, row[i].radius);
        state.brush.radius = 20; /* chosen by the user */
        pilot_fit_brush(&state, row[i].side);
        CHECK_INT(state.brush.radius, 20);
    }
}

STORY(a_bad_line_is_named_with_its_number_and_left_out)
{
    static const char *const bad[][2] = {
        {"theme blue", "c:1: expected dark|light|none, not blue; left out\n"},
        {"graphics loud", "c:1: graphics: expected auto, kitty, tiles, placeholders, iterm, sixel, "
                          "blocks, sextants, quadrants, halves or none, not loud; left out\n"},
        {"\nthem dark",
         "c:2: expected theme, graphics, brush, window, key, pager, ahead, start or who, "
         "not them; did you mean "
         "theme?; left out\n"},
        {"brush 256",
         "c:1: expected a label 0..255, then optionally a radius 0..32 in voxels, or in mm"},
        {"brush 1 33", "c:1: expected a label"},
        {"brush 1 2 3", "c:1: expected a label"},
        {"brush", "c:1: expected a label"},
        {"brush 1 32.5mm", "c:1: expected a label"},
        {"brush 1 2.3mm", "c:1: expected a label"},
        {"brush 1 2.5", "c:1: expected a label"},
        {"brush 1 2 mm", "c:1: expected a label"},
        {"brush 1 range=5", "c:1: expected a label"},
        {"brush 1 range=9..5", "c:1: expected a label"},
        {"brush 1 range=1..5 2", "c:1: expected a label"},
        {"window", "c:1: expected a name, a centre, and a width"},
        {"window lung 5", "c:1: expected a name, a centre, and a width"},
        {"window lung 5 0", "c:1: expected a name, a centre, and a width"},
        {"window lung 5 -1", "c:1: expected a name, a centre, and a width"},
        {"window lung 5 1e9", "c:1: expected a name, a centre, and a width"},
        {"window a-very-long-name 5 9", "c:1: expected a name of at most 11 bytes, not a-very"},
        {"key", "c:1: there is no action ;"},
        {"key undu U", "c:1: there is no action undu; did you mean undo?; left out\n"},
        {"key undo", "c:1: expected keys after undo; left out\n"},
        {"key undo Ctrl-Foo", "c:1: there is no key Ctrl-Foo; left out\n"},
        {"key undo any", "c:1: there is no key any"},
        {"key undo a-z", "c:1: a-z: expected one key"},
        {"key undo U\nkey redo U", "c:2: U was given to undo; left out\n"},
        {"key undo U\nkey redo Ux", "c:2: Ux was given to undo; left out\n"},
        {"start", "c:1: expected a command, or none; left out\n"},
        {"start \x1b[2J", "c:1: byte 7, 1b, is not text; left out\n"},
        {"theme d\xff", "c:1: byte 8, ff, is not text; left out\n"},
        {"start \xe2\x80\xae",
         "c:1: byte 7, e2, is not text"}, /* it changes the direction of text */
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_HAS(words_of(bad[i][0]), bad[i][1]);
    take("brush 300\nbrush 5\nkey undu U\nkey undo U");
    CHECK(config.setup.brush.label == 5); /* the other lines are used */
    CHECK_TEXT(keys_of("undo"), "U");
}

STORY(lines_and_their_number_are_limited)
{
    OWNED(buf_release) struct buf text = {0};
    for (int i = 0; i < 20; i++)
        buf_add_text(&text, "no\n");
    CHECK_HAS(words_of(buf_text(&text)), "c:10: expected");
    CHECK_HAS(buf_text(&config.words), "left out\nand 10 lines more\n");
    buf_clear(&text);
    buf_add_text(&text, "start ");
    for (int i = 0; i < CONFIG_LINE_MOST; i++)
        buf_add_char(&text, 'x');
    CHECK_HAS(words_of(buf_text(&text)), "c:1: it has 1006 bytes, and may have 1000");
    buf_clear(&text);
    for (int i = 0; i < CONFIG_LINES_MOST + 5; i++)
        buf_add_text(&text, "start run\n");
    CHECK_TEXT(words_of(buf_text(&text)),
               "c:1001: it and those after it are more than 1000 lines; left out\n");
    CHECK(strstr(buf_text(&config.start), "\n1000 run\n") &&
          !strstr(buf_text(&config.start), "1001"));
    take("window a 1 2\nwindow b 1 2\nwindow c 1 2\nwindow d 1 2\nwindow e 1 2\nwindow f 1 2\n");
    CHECK_HAS(buf_text(&config.words), "c:6: there are 9 windows already, the most");
}

STORY(the_environment_selects_the_file)
{
    char folder[FOLDER_LENGTH];
    OWNED(buf_release) struct buf path = {0};
    CHECK(make_folder(folder, "config"));
    buf_printf(&path, "%s/iftty", folder);
    setenv("XDG_CONFIG_HOME", folder, 1);
    unsetenv("IFTTY_CONFIG");
    CHECK(mkdir(buf_text(&path), 0700) == 0);
    read_file(); /* no file */
    CHECK_TEXT(buf_text(&config.words), "");
    CHECK_TEXT(buf_text(&config.start), "finish relax\nfinished on\n");
    buf_add_text(&path, "/config");
    CHECK(file_write(buf_text(&path), "brush 9\nx", 9, FILE_KEEP, NULL) == OK);
    read_file();
    CHECK_INT(config.setup.brush.label, 9);
    CHECK_HAS(buf_text(&config.words), "/iftty/config:2: expected theme");
    setenv("IFTTY_CONFIG", "", 1);
    read_file();
    CHECK_INT(config.setup.brush.label, 1);
    CHECK_TEXT(buf_text(&config.start), "finish relax\nfinished on\n");
    CHECK(file_write(buf_text(&path), "start none", 10, FILE_REPLACE, NULL) == OK);
    setenv("IFTTY_CONFIG", buf_text(&path), 1);
    read_file(); /* replaces the default start commands */
    CHECK_TEXT(buf_text(&config.start), "");
    setenv("IFTTY_CONFIG", folder, 1); /* a folder is no file */
    read_file();
    CHECK_HAS(buf_text(&config.words), "left out\n");
    buf_add_text(&path, "-of-mine"); /* a file that is named must exist, */
    setenv("IFTTY_CONFIG", buf_text(&path), 1);
    read_file();
    CHECK_HAS(buf_text(&config.words), "-of-mine: No such file or directory; left out\n");
    unsetenv("IFTTY_CONFIG"); /* and one that cannot be looked for is reported */
    buf_clear(&path);
    buf_printf(&path, "%s/round", folder);
    CHECK(symlink("round", buf_text(&path)) == 0);
    setenv("XDG_CONFIG_HOME", buf_text(&path), 1);
    read_file();
    CHECK_HAS(buf_text(&config.words), "symbolic links; left out\n");
    config_release(&config);
    unsetenv("XDG_CONFIG_HOME");
    CHECK_INT(remove_folder(folder), 0);
}

/* ---- keys of one's own ---- */

static struct pilot_state state;
static bool next_label(void *context, uint32_t of, int by, uint32_t *next)
{
    (void)context;
    *next = of + (uint32_t)by;
    return true;
}
static void label(void *context, uint32_t number, struct buf *out)
{
    (void)context;
    buf_printf(out, "%u", number);
}
static const struct pilot_host host = {.next_label = next_label, .label = label};
static const struct pilot_facts facts = {.place = {1, 2, 3}, .zoom = 1000};
static struct buf line, message;

static const char *type(const char *letters)
{
    for (; *letters; letters++) {
        const struct key_event event = {.key = KEY_CHARACTER, .point = (uint8_t)*letters};
        buf_clear(&line);
        buf_clear(&message);
        pilot_press(
            &(struct press){&state, &event, &host, &facts, &line, &message, 0, PILOT_NOTHING});
    }
    return buf_text(&line);
}

STORY(user_keys_override_the_table)
{
    OWNED(buf_release) struct buf page = {0};
    take("key undo s\nkey plant-label 7 ,0-9\nkey roll gg");
    CHECK_TEXT(buf_text(&config.words), "");
    pilot_state_init(&state, &config.setup);
    CHECK_TEXT(type("s"), "undo\n"); /* no longer a prefix of two keys */
    CHECK_TEXT(type("u"), "");
    CHECK_HAS(buf_text(&message), "this key does nothing here");
    CHECK_TEXT(type("gg"), "turn 0 0 15\n");
    CHECK_TEXT(type(",3"), "seed 1,2,3 3 radius=6\n");
    CHECK_TEXT(type("7"), "seed 1,2,3 7 radius=6\n"); /* no longer a digit of a count */
    pilot_keys_page(&page, &(struct pilot_keys_wish){&config.setup, false, 60, NULL, NULL,
                                                     NULL}); /* one entry on a line */
    CHECK_HAS(buf_text(&page), "  s Ctrl-R . gu    undo, redo, again; log\n");
    CHECK_HAS(buf_text(&page), "  7 ,0-9           a seed of 0-9\n");
    CHECK_HAS(buf_text(&page), "  G                first, last, 90G\n"); /* without gg */
    buf_clear(&page);
    take("key next-plane q");
    pilot_keys_page(&page, &(struct pilot_keys_wish){&config.setup, false, 60, NULL, NULL, NULL});
    CHECK_HAS(buf_text(&page), "  -                back to the prompt\n");
}

STORY(every_action_is_in_the_readme)
{
    static const char mark[] = "<!-- actions: of the table of keys -->\n\n";
    OWNED(buf_release) struct buf list = {0}, readme = {0};
    size_t begin = 0;
    for (size_t i = 0; i < pilot_rows; i++) {
        OWNED(buf_release) struct buf item = {0};
        if (!pilot_table[i].name)
            continue;
        buf_printf(&item, "%s (%s)", pilot_table[i].name, pilot_table[i].keys);
        const bool fits = list.length - begin + 2 + item.length <= 4 + 74;
        buf_add_text(&list, list.length == 0 ? "    " : fits ? ", " : ",\n    ");
        begin = fits ? begin : list.length - 4;
        buf_add_text(&list, buf_text(&item));
    }
    buf_add_text(&list, "\n\n<!-- end");
    CHECK(file_read(&readme, "tui/README.md", 1 << 20, NULL) == OK);
    const char *card = strstr(buf_text(&readme), mark);
    CHECK(card && strncmp(card + strlen(mark), buf_text(&list), list.length) == 0);
}

static bool is_printable(const struct buf *text)
{
    for (size_t i = 0; i < text->length; i++)
        if (((uint8_t)text->data[i] < ' ' && text->data[i] != '\n') || text->data[i] == 0x7F)
            return false;
    return true;
}

/* Any bytes, and words of the configuration in any order. */
STORY(any_text_gives_a_valid_setup)
{
    static const char *const word[] = {
        "theme", "graphics", "halves", "brush", "window", "key",  "start", "dark", "undo", "plant",
        "left",  "Ctrl-",    "Alt-",   "s0-9",  "gg",     "x",    "0",     "9",    "255",  "-1.5",
        " ",     "\n",       "\t",     "#",     "\x1b",   "\xc3", "ä",     "1-9",  "Tab",  "''"};
    uint64_t seed = 7;
    for (int round = 0; round < 3000; round++) {
        OWNED(buf_release) struct buf text = {0}, page = {0};
        for (uint64_t n = check_below(&seed, 60); n > 0; n--) {
            buf_add_text(&text, word[check_below(&seed, sizeof word / sizeof word[0])]);
            buf_add_text(&text, check_below(&seed, 3) ? " " : check_below(&seed, 2) ? "\n" : "");
        }
        take(buf_text(&text));
        CHECK(config.setup.brush.label < 256 && config.setup.brush.radius <= 64);
        CHECK(config.setup.windows <= SETUP_WINDOWS_MOST);
        CHECK(is_printable(&config.words) && is_printable(&config.start));
        pilot_keys_page(&page,
                        &(struct pilot_keys_wish){&config.setup, false, 80, NULL, NULL, NULL});
        CHECK(!page.failed && !config.words.failed);
        pilot_state_init(&state, &config.setup);
        pilot_keys_hint(&state, &facts, "", &page);
    }
    config_release(&config);
    buf_release(&line);
    buf_release(&message);
}
