/* SPDX-License-Identifier: MIT */
/* Probing all known terminals: their answers are a table of facts measured with the real programs.
 * No terminal is opened. */
#include "tests/check_main.h"
#include "tui/picture/graphics.h"

enum { QUESTIONS = 15 };
static const char *const question[QUESTIONS] = {
    "\033[>c",
    "\033[>q",
    "\033[16t",
    "\033[14t",
    "\033[?2;4;0S",
    "\033[c",
    "\033[?2026$p",
    "\033_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\033\\",
    "\033[?1016$p",
    "\r\xF0\x9F\xAC\x80\033[6n",
    "\033Ptmux;\033\033[>q\033\\",
    PROBE_OUTER_BARRIER,
    "\033Ptmux;\033\033[5n\033\\",
    "\033Ptmux;\033\033_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\033\033\\\033\\",
    "\033]11;?\033\\"};
enum { DA2, VERSION, CELL, AREA, LIMIT, DA1, MODE, KITTY, POINTS, SEXTANT };
enum { OUTER_VERSION = SEXTANT + 1, OUTER_DA1, OUTER_END, OUTER_KITTY }; /* through tmux */
enum { BACKGROUND = OUTER_KITTY + 1 };
#define PRINTS(place) (1u << (place))

struct known {
    const char *about;
    struct probe_environment environment;
    const char *answer[QUESTIONS]; /* NULL: none */
    unsigned prints;               /* questions that appear as text; POINTS, BACKGROUND as MODE */
    const struct graphics *graphics;
    enum colours colours;
    enum block_shape shape;
    bool synchronizes;
    uint32_t cell_width, cell_height;
    enum mouse_unit unit;
};

#define TERM(name)                                                                                 \
    {                                                                                              \
        .term = name                                                                               \
    }
/* A terminal, by its TERM. */
#define AS(name, about)  about, TERM(name)
#define VERSION_IS(name) "\033P>|" name "\033\\"
#define KITTY_OK         "\033_Gi=31;OK\033\\"
#define NOT_KNOWN        "\033[?2026;0$y"
#define KNOWN            "\033[?2026;2$y"
#define POINTS_NOT       "\033[?1016;0$y"
#define POINTS_AT        "\033[?1016;2$y"
#define NARROW           "\033[6;2R"
#define COLOURED         COLOURS_24BIT
/* Questions that come out as text, graphics, colours, shape of blocks, whether it synchronizes, the
 * size of a cell, what the mouse counts. */
#define FACTS(prints, graphics, colours, shape, synchronizes, width, height, unit)                 \
    prints, &graphics_##graphics, colours, BLOCK_##shape, synchronizes, width, height, MOUSE_##unit
#define XTERM_SAYS(attrs) "\033[>41;379;0c", VERSION_IS("XTerm(379)"), NULL, NULL, NULL, attrs

static const struct known terminals[] = {
    {AS("xterm-256color", "xterm -ti vt340"),
     {"\033[>41;379;0c", VERSION_IS("XTerm(379)"), NULL, NULL, "\033[?2;0;1000;1000S",
      "\033[?63;1;2;4;6;9;15;16;17;18;21;22;28c", NOT_KNOWN, NULL, POINTS_AT},
     FACTS(0, sixel, COLOURED, QUADRANT, false, 8, 16, CELLS)},
    {AS("xterm-256color", "xterm"),
     {"\033[>41;379;0c", VERSION_IS("XTerm(379)"), NULL, NULL, "\033[?2;3S",
      "\033[?64;1;2;6;9;15;16;17;18;21;22;28c", NOT_KNOWN, NULL, POINTS_AT},
     FACTS(0, quadrants, COLOURED, QUADRANT, false, 8, 16, CELLS)},
    {AS("xterm-kitty", "kitty"),
     {"\033[>1;4000;26c", VERSION_IS("kitty(0.26.5)"), "\033[6;20;9t", "\033[4;400;639t", NULL,
      "\033[?62;c", KNOWN, KITTY_OK, POINTS_AT, NARROW},
     FACTS(PRINTS(LIMIT), kitty, COLOURED, SEXTANT, true, 9, 20, PIXELS_FROM_0)},
    {AS("xterm-256color", "kitty over ssh, with a TERM that is known there"),
     {"\033[>1;4000;26c", VERSION_IS("kitty(0.26.5)"), "\033[6;20;9t", "\033[4;400;639t", NULL,
      "\033[?62;c", KNOWN, KITTY_OK, POINTS_AT, NARROW},
     FACTS(PRINTS(LIMIT), kitty, COLOURED, SEXTANT, true, 9, 20, PIXELS_FROM_0)},
    {AS("xterm-ghostty", "ghostty"),
     {"\033[>1;10;0c", VERSION_IS("ghostty 1.0.0"), "\033[6;34;16t", NULL, NULL, "\033[?62;22c",
      KNOWN, KITTY_OK, POINTS_AT, NARROW},
     FACTS(0, tiles, COLOURED, SEXTANT, true, 16, 34, PIXELS_FROM_0)},
    {AS("xterm-256color", "WezTerm"),
     {"\033[>1;277;0c", VERSION_IS("WezTerm 20240203-110809-5046fc22"), "\033[6;18;8t", NULL, NULL,
      "\033[?65;4;6;18;22c", KNOWN, KITTY_OK, POINTS_AT, NARROW},
     FACTS(0, tiles, COLOURED, SEXTANT, true, 8, 18, PIXELS)},
    {AS("xterm-256color", "WezTerm without kitty graphics"),
     {"\033[>1;277;0c", VERSION_IS("WezTerm 20220319"), "\033[6;18;8t", NULL, NULL,
      "\033[?65;4;6;18;22c", KNOWN, "\033_Gi=31;ENOTSUPPORTED\033\\", NULL, NARROW},
     FACTS(0, sixel, COLOURED, SEXTANT, true, 8, 18, CELLS)},
    {AS("xterm-256color", "Konsole"),
     {"\033[>1;220380;0c", VERSION_IS("Konsole 22.12.3"), NULL, "\033[4;480;640t", NULL,
      "\033[?62;1;4c", NOT_KNOWN, KITTY_OK, POINTS_NOT},
     FACTS(0, tiles, COLOURED, QUADRANT, false, 8, 20, CELLS)},
    {AS("xterm-256color", "iTerm2"),
     {"\033[>0;95;0c", VERSION_IS("iTerm2 3.5.0"), "\033[6;18;9t", NULL, NULL, "\033[?62;1;2;4;6c",
      KNOWN, NULL},
     FACTS(PRINTS(KITTY), iterm, COLOURED, QUADRANT, true, 9, 18, CELLS)},
    {"an older iTerm2, through ssh that sends LC_*",
     {.term = "xterm-256color", .lc_terminal = "iTerm2"},
     {"\033[>0;95;0c", NULL, NULL, NULL, NULL, "\033[?62;4c", NULL, NULL},
     FACTS(PRINTS(KITTY), iterm, COLOURED, HALF, false, 8, 16, CELLS)},
    {"an older iTerm2 at home",
     {.term = "xterm-256color", .term_program = "iTerm.app"},
     {"\033[>0;95;0c", NULL, NULL, NULL, NULL, "\033[?62;4c", NULL, NULL},
     FACTS(PRINTS(KITTY), iterm, COLOURED, HALF, false, 8, 16, CELLS)},
    {"xterm started from a shell in iTerm2",
     {.term = "xterm-256color", .term_program = "iTerm.app", .lc_terminal = "iTerm2"},
     {XTERM_SAYS("\033[?64;1;2;6c"), NOT_KNOWN, NULL, POINTS_AT},
     FACTS(0, quadrants, COLOURED, QUADRANT, false, 8, 16, CELLS)},
    {AS("mlterm", "mlterm"),
     {"\033[>24;279;0c", NULL, "\033[6;22;10t", "\033[4;528;800t", "\033[?1;3;0S",
      "\033[?63;1;2;3;4;6;7;15;18;22;29c", NOT_KNOWN, NULL, POINTS_NOT},
     FACTS(0, sixel, COLOURS_256, HALF, false, 10, 22, CELLS)},
    {AS("foot", "foot"),
     {"\033[>1;11301;0c", VERSION_IS("foot(1.13.1)"), "\033[6;15;7t", "\033[4;360;560t",
      "\033[?2;0;10000;10000S", "\033[?62;4;22c", KNOWN, NULL, POINTS_AT, NARROW},
     FACTS(0, sixel, COLOURED, SEXTANT, true, 7, 15, PIXELS)},
    {AS("xterm-256color", "VTE"),
     {"\033[>65;7006;1c", VERSION_IS("VTE(7006)"), "\033[6;17;8t", "\033[4;408;640t", NULL,
      "\033[?65;1;9c", NOT_KNOWN, NULL, POINTS_NOT, NARROW},
     FACTS(0, sextants, COLOURED, SEXTANT, false, 8, 17, CELLS)},
    {AS("xterm-256color", "VTE where sextants are wide"),
     {"\033[>65;7006;1c", VERSION_IS("VTE(7006)"), NULL, NULL, NULL, "\033[?65;1;9c", NOT_KNOWN,
      NULL, POINTS_NOT, "\033[6;3R"},
     FACTS(0, quadrants, COLOURED, QUADRANT, false, 8, 16, CELLS)},
    {AS("xterm-256color", "VTE before 0.66"),
     {"\033[>65;6400;1c", VERSION_IS("VTE(6400)"), NULL, NULL, NULL, "\033[?65;1;9c", NOT_KNOWN,
      NULL, POINTS_NOT},
     FACTS(0, quadrants, COLOURED, QUADRANT, false, 8, 16, CELLS)},
    {AS("xterm-256color", "an older VTE, without a name"),
     {"\033[>65;6003;1c", NULL, NULL, NULL, NULL, "\033[?65;1;9c", NULL, NULL},
     FACTS(PRINTS(KITTY), quadrants, COLOURED, QUADRANT, false, 8, 16, CELLS)},
    {AS("alacritty", "alacritty"),
     {"\033[>0;1203;1c", NULL, NULL, "\033[4;432;640t", NULL, "\033[?6c", KNOWN, NULL},
     FACTS(0, quadrants, COLOURED, QUADRANT, true, 8, 18, CELLS)},
    {AS("st-256color", "st"),
     {NULL, NULL, NULL, NULL, NULL, "\033[?6c", NULL, NULL},
     FACTS(0, halves, COLOURS_256, HALF, false, 8, 16, CELLS)},
    {AS("rxvt-unicode-256color", "urxvt"),
     {"\033[>85;95;0c", NULL, NULL, "\033[4;316;496t", NULL, "\033[?1;2c", NOT_KNOWN, NULL,
      POINTS_NOT},
     FACTS(PRINTS(KITTY), halves, COLOURS_256, HALF, false, 6, 13, CELLS)},
    {AS("xterm", "PuTTY"),
     {"\033[>0;136;0c", NULL, NULL, "\033[4;314;496t", NULL, "\033[?6c", NULL, NULL},
     FACTS(PRINTS(KITTY), halves, COLOURS_256, HALF, false, 6, 13, CELLS)},
    {AS("xterm-256color", "Apple's Terminal, which prints the p of $p"),
     {"\033[>1;95;0c", NULL, NULL, NULL, NULL, "\033[?1;2c", NULL, NULL},
     FACTS(PRINTS(KITTY) | PRINTS(MODE), halves, COLOURS_256, HALF, false, 8, 16, CELLS)},
    {AS("screen-256color", "tmux"),
     {"\033[>84;0;0c", VERSION_IS("tmux 3.3a"), NULL, NULL, NULL, "\033[?1;2c", NULL, NULL, NULL,
      NARROW},
     FACTS(0, halves, COLOURED, HALF, false, 8, 16, CELLS)},
#define TMUX                                                                                       \
    "\033[>84;0;0c", VERSION_IS("tmux 3.5a"), "\033[6;18;9t", NULL, NULL,                          \
        "\033[?1;2;4c", [SEXTANT] = NARROW
#define OUTSIDE(name, attributes)                                                                  \
    [OUTER_VERSION] = VERSION_IS(name), [OUTER_DA1] = attributes, [OUTER_END] = "\033[0n"
    {AS("tmux-256color", "tmux, which has sixel whatever is outside, and passes nothing"),
     {TMUX},
     FACTS(0, halves, COLOURED, HALF, false, 9, 18, CELLS)},
    {AS("tmux-256color", "tmux in kitty"),
     {TMUX, OUTSIDE("kitty(0.41.1)", "\033[?62;c"), [OUTER_KITTY] = KITTY_OK},
     FACTS(0, placeholders, COLOURED, SEXTANT, false, 9, 18, CELLS)},
    {AS("tmux-256color", "tmux in ghostty"),
     {TMUX, OUTSIDE("ghostty 1.1.3", "\033[?62;22c"), [OUTER_KITTY] = KITTY_OK},
     FACTS(0, placeholders, COLOURED, SEXTANT, false, 9, 18, CELLS)},
    {AS("tmux-256color", "tmux in an older kitty, which answers but has no placeholders"),
     {TMUX, OUTSIDE("kitty(0.27.1)", "\033[?62;c"), [OUTER_KITTY] = KITTY_OK},
     FACTS(PRINTS(OUTER_KITTY), sextants, COLOURED, SEXTANT, false, 9, 18, CELLS)},
    {AS("tmux-256color", "tmux in WezTerm, which has sixel and no placeholders"),
     {TMUX, OUTSIDE("WezTerm 20240203", "\033[?65;4;6;18;22c"), [OUTER_KITTY] = KITTY_OK},
     FACTS(PRINTS(OUTER_KITTY), sixel, COLOURED, SEXTANT, false, 9, 18, CELLS)},
    {AS("tmux-256color", "tmux in xterm -ti vt340"),
     {TMUX, OUTSIDE("XTerm(398)", "\033[?63;1;2;4;6;9;15;16;22;28c")},
     FACTS(0, sixel, COLOURED, QUADRANT, false, 9, 18, CELLS)},
    {AS("tmux-256color", "tmux in xterm -ti vt100"),
     {TMUX, OUTSIDE("XTerm(398)", "\033[?1;2c")},
     FACTS(0, quadrants, COLOURED, QUADRANT, false, 9, 18, CELLS)},
    {AS("tmux-256color", "tmux in a terminal without a name"),
     {TMUX, [OUTER_DA1] = "\033[?1;2c", [OUTER_END] = "\033[0n"},
     FACTS(PRINTS(OUTER_KITTY), halves, COLOURED, HALF, false, 9, 18, CELLS)},
    {AS("xterm-kitty", "tmux in kitty, whose TERM has come along"),
     {"\033[>84;0;0c", VERSION_IS("tmux 3.3a"), NULL, NULL, NULL, "\033[?1;2c", NULL, NULL, NULL,
      NARROW},
     FACTS(PRINTS(KITTY), halves, COLOURED, HALF, false, 8, 16, CELLS)},
    {"tmux in iTerm2",
     {.term = "screen", .lc_terminal = "iTerm2", .term_program = "tmux"},
     {"\033[>84;0;0c", VERSION_IS("tmux 3.3a"), NULL, NULL, NULL, "\033[?1;2c", NULL, NULL, NULL,
      NARROW},
     FACTS(PRINTS(KITTY), halves, COLOURED, HALF, false, 8, 16, CELLS)},
    {AS("screen", "screen"),
     {"\033[>83;40900;0c", NULL, NULL, NULL, NULL, "\033[?1;2c", NULL, NULL},
     FACTS(PRINTS(KITTY), halves, COLOURS_256, HALF, false, 8, 16, CELLS)},
    {AS("screen.xterm-256color", "screen that claims sixel"),
     {"\033[>83;50000;0c", NULL, NULL, NULL, NULL, "\033[?1;2;4c", NULL, NULL},
     FACTS(PRINTS(KITTY), halves, COLOURS_256, HALF, false, 8, 16, CELLS)},
    {AS("xterm-kitty", "screen in kitty, whose TERM has come along"),
     {"\033[>83;40900;0c", NULL, NULL, NULL, NULL, "\033[?1;2c", NULL, NULL},
     FACTS(PRINTS(KITTY), halves, COLOURS_256, HALF, false, 8, 16, CELLS)},
    {AS("linux", "the Linux console"),
     {NULL, NULL, NULL, NULL, NULL, "\033[?6c", NULL, NULL},
     FACTS(PRINTS(KITTY) | PRINTS(MODE) | PRINTS(DA2) | PRINTS(VERSION), halves, COLOURS_16, HALF,
           false, 8, 16, CELLS)},
    {AS("eterm-color", "Emacs"),
     {NULL},
     FACTS(0xFF, halves, COLOURS_16, HALF, false, 8, 16, CELLS)},
    {AS("dumb", "a dumb terminal"),
     {NULL},
     FACTS(0xFF, none, COLOURS_NONE, HALF, false, 8, 16, CELLS)},
    {AS("", "no TERM at all"), {NULL}, FACTS(0xFF, none, COLOURS_NONE, HALF, false, 8, 16, CELLS)},
    {AS("xterm", "a line that answers nothing"),
     {NULL},
     FACTS(PRINTS(KITTY) | PRINTS(MODE), halves, COLOURS_256, HALF, false, 8, 16, CELLS)},
};
enum { TERMINALS = sizeof terminals / sizeof terminals[0] };

/* ---- a terminal that is asked ---- */

/* Answer the questions in order, except for the question `lost` (-1: none). */
static void answer(const struct known *t, const char *asked, int lost, struct buf *replies)
{
    while (*asked) {
        int which = 0;
        while (which < QUESTIONS && strncmp(asked, question[which], strlen(question[which])) != 0)
            which++;
        if (which == QUESTIONS) {
            CHECK_TEXT(asked, "\r\033[K"); /* the only other output, at the end */
            return;
        }
        if (!check_report(
                !(t->prints >> (which == POINTS || which == BACKGROUND ? MODE : which) & 1),
                __FILE__, __LINE__, "it prints the question"))
            printf("#   %s: question %d\n", t->about, which);
        if (which == SEXTANT) /* text, for terminals that are known to draw it */
            CHECK(t->answer[SEXTANT]);
        if (t->answer[which] && which != lost)
            buf_add_text(replies, t->answer[which]);
        asked += strlen(question[which]);
    }
}

static struct probed {
    struct probe probe;
    struct terminal_facts facts;
    struct buf typed;
    unsigned rounds; /* with any question */
    size_t bytes;    /* received */
} probed;

/* Ask in all rounds. The received bytes are cut in two at `cut`, counted over all rounds. */
static void ask(const struct known *t, struct graphics_wish wish, int lost, size_t cut)
{
    struct probed *const p = &probed;
    const struct term_size size = {.columns = 80, .rows = 24};
    OWNED(buf_release) struct buf asked = {0}, back = {0};
    struct keys keys = {0};
    *p = (struct probed){.typed = p->typed,
                         .probe = {.wish = graphics_asks(wish, &t->environment),
                                   .replies.environment = t->environment}};
    buf_clear(&p->typed);
    for (; probe_ask(&p->probe, &asked); p->rounds++) {
        buf_clear(&back);
        answer(t, buf_text(&asked), lost, &back);
        buf_clear(&asked);
        const size_t first = cut < p->bytes ? 0 : cut - p->bytes;
        const size_t head = first < back.length ? first : back.length;
        probe_take(&p->probe, &keys, buf_text(&back), head, &p->typed);
        probe_take(&p->probe, &keys, buf_text(&back) + head, back.length - head, &p->typed);
        p->bytes += back.length;
    }
    graphics_decide(&p->probe.replies, &size, wish, &p->facts);
}

static void check_facts(const struct known *t, const struct terminal_facts *f)
{
    const unsigned before = check_failures;
    CHECK_TEXT(f->graphics->name, t->graphics->name);
    CHECK_INT(f->colours, t->colours);
    CHECK_INT(f->shape, t->shape);
    CHECK_INT(f->synchronizes, t->synchronizes);
    CHECK_INT(f->cell_width, t->cell_width);
    CHECK_INT(f->cell_height, t->cell_height);
    CHECK_INT(f->mouse_unit, t->unit);
    if (check_failures > before)
        printf("#   that is %s\n", t->about);
}

/* ---- stories ---- */

STORY(each_terminal_gets_what_it_has_and_prints_nothing)
{
    for (size_t i = 0; i < TERMINALS; i++) {
        ask(&terminals[i], graphics_auto, -1, SIZE_MAX);
        check_facts(&terminals[i], &probed.facts);
        CHECK_TEXT(buf_text(&probed.typed), "");
        CHECK_INT(probed.facts.answers, probed.rounds > 0 && terminals[i].answer[DA1] != NULL);
        CHECK_INT(probed.facts.mouse, probed.facts.answers);
        CHECK(probed.rounds <= 4);
    }
}

STORY(the_background_is_light_or_dark)
{
    static const struct {
        const char *answer;
        bool is_light;
    } rows[] = {{"\033]11;rgb:ffff/ffff/ffff\033\\", true},  {"\033]11;rgb:fd/f6/e3\a", true},
                {"\033]11;rgb:0000/2b2b/3636\033\\", false}, {"\033]11;rgb:8/8/7\033\\", true},
                {"\033]11;rgb:7/7/7\033\\", false},          {"\033]11;rgb:ffff/ffff\033\\", false},
                {"\033]11;rgb:fffff/f/f\033\\", false},      {NULL, false}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        struct known xterm = terminals[0];
        xterm.answer[BACKGROUND] = rows[i].answer;
        ask(&xterm, graphics_auto, -1, SIZE_MAX);
        check_facts(&xterm, &probed.facts);
        CHECK_TEXT(buf_text(&probed.typed), "");
        CHECK_INT(probed.facts.is_light, rows[i].is_light);
    }
}

/* They are used only if the size of a cell is known, here from the window. */
STORY(the_mouse_counts_pixels_where_the_terminal_says_so)
{
    static const struct {
        const char *name, *reply;
        unsigned width;
        enum mouse_unit unit;
    } cases[] = {{"XTerm(379)", "[?1016;2$y", 640, MOUSE_PIXELS},
                 {"XTerm(379)", "[?1016;1$y", 640, MOUSE_PIXELS},
                 {"XTerm(379)", "[?1016;2$y", 0, MOUSE_CELLS},
                 {"XTerm(300)", "[?1016;0$y", 640, MOUSE_CELLS},
                 {"XTerm(379)", "[?1016;3$y", 640, MOUSE_CELLS},
                 {"XTerm(379)", "[?1016;4$y", 640, MOUSE_CELLS},
                 {"XTerm(379)", "[?1015;2$y", 640, MOUSE_CELLS},
                 {"kitty(0.26.5)", "[?1016;2$y", 640, MOUSE_PIXELS_FROM_0},
                 {"ghostty 1.0.0", "[?1016;2$y", 640, MOUSE_PIXELS_FROM_0},
                 {"tmux 3.3a", "[?1016;2$y", 640, MOUSE_PIXELS},
                 {"tmux 3.3a", "", 640, MOUSE_CELLS}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct term_size size = {80, 24, cases[i].width, cases[i].width * 3 / 5};
        struct probe_replies r = {.environment = TERM("xterm-256color"), .da1 = true};
        struct terminal_facts f;
        snprintf(r.name, sizeof r.name, "%s", cases[i].name);
        probe_reply(&r, cases[i].reply);
        graphics_decide(&r, &size, graphics_auto, &f);
        CHECK_INT(f.mouse_unit, cases[i].unit);
    }
}

STORY(it_does_not_matter_where_the_answers_are_cut)
{
    for (size_t i = 0; i < TERMINALS; i++) {
        ask(&terminals[i], graphics_auto, -1, SIZE_MAX);
        for (size_t cut = 0, bytes = probed.bytes; cut < bytes; cut++) {
            ask(&terminals[i], graphics_auto, -1, cut);
            check_facts(&terminals[i], &probed.facts);
            CHECK_TEXT(buf_text(&probed.typed), "");
        }
    }
}

/* Without one answer: no garbage, and no better graphics than the terminal has. */
STORY(an_answer_that_is_missing_leaves_the_fallback)
{
    for (size_t i = 0; i < TERMINALS; i++)
        for (int lost = 0; lost < QUESTIONS; lost++) {
            const struct known *t = &terminals[i];
            ask(t, graphics_auto, lost, SIZE_MAX);
            const struct graphics *got = probed.facts.graphics;
            if (!check_report(got == t->graphics || got->kind == GRAPHICS_TEXT ||
                                  (got == &graphics_sixel &&
                                   !probe_is_tmux(&probed.probe.replies) &&
                                   probed.probe.replies.attributes >> 4 & 1),
                              __FILE__, __LINE__, "the graphics are there"))
                printf("#   %s without answer %d: %s\n", t->about, lost, got->name);
            CHECK(t->answer[MODE] || !probed.facts.synchronizes);
            CHECK_TEXT(buf_text(&probed.typed), "");
        }
}

STORY(answers_that_come_late_are_never_text)
{
    for (size_t i = 0; i < TERMINALS; i++)
        for (int which = 0; which < QUESTIONS; which++) {
            struct keys keys = {0};
            struct key_event event;
            const char *text = terminals[i].answer[which];
            for (const char *at = text; at && *at; at++)
                if (keys_feed(&keys, (uint8_t)*at, &event))
                    CHECK_INT(event.key, KEY_REPLY);
            CHECK_INT(keys.state, KEYS_GROUND);
        }
}

STORY(what_is_typed_between_the_answers_is_kept)
{
    static const char bytes[] = "a\033P>|kitty(0.26.5)\033\\b\033[?2026;1$yc\033[?62;cd\033[A";
    for (size_t cut = 0; cut < sizeof bytes - 1; cut++) {
        struct probe p = {.due = 1};
        struct keys keys = {0};
        OWNED(buf_release) struct buf typed = {0};
        probe_take(&p, &keys, bytes, cut, &typed);
        probe_take(&p, &keys, bytes + cut, sizeof bytes - 1 - cut, &typed);
        CHECK_TEXT(buf_text(&typed), "abcd\033[A");
        CHECK(p.replies.da1 && p.replies.synchronizes);
        CHECK_TEXT(p.replies.name, "kitty(0.26.5)");
    }
}

/* Otherwise its beginning would swallow the next keys. */
STORY(what_was_cut_short_goes_with_the_answer_behind_it)
{
    static const struct {
        const char *bytes, *typed;
    } cases[] = {{"a\033P>|cut\033[?62;cb", "ab"},
                 {"a\033[?6\033[?62;cb", "ab"},
                 {"\033\033[?62;c[?6c", "[?6c"},
                 {"\xC3\033[?62;c\xA4x", "\xA4x"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct probe p = {.due = 1};
        struct keys keys = {0};
        OWNED(buf_release) struct buf typed = {0};
        probe_take(&p, &keys, cases[i].bytes, strlen(cases[i].bytes), &typed);
        CHECK_TEXT(buf_text(&typed), cases[i].typed);
    }
}

static struct graphics_wish wish(const char *name)
{
    struct graphics_wish of_name;
    CHECK(graphics_from_name(name, &of_name));
    return of_name;
}

STORY(a_wish_is_kept_and_asks_no_more_than_it_needs)
{
    OWNED(buf_release) struct buf asked = {0};
    for (size_t i = 0; i < TERMINALS; i++)
        for (size_t k = 0; k < graphics_auto.count; k++) {
            const struct graphics *g = graphics_auto.of[k];
            ask(&terminals[i], wish(g->name), -1, SIZE_MAX);
            const bool is_kitty = strstr(terminals[i].about, "kitty") == terminals[i].about;
            if (g == &graphics_kitty && probed.facts.graphics == &graphics_tiles)
                CHECK(!is_kitty);
            else
                CHECK(probed.facts.graphics == g);
            CHECK_TEXT(probed.probe.replies.answers, "");
        }
    static const struct {
        struct probe_environment environment;
        const char *wish, *asked;
    } cases[] = {{TERM("xterm"), "none", ""},
                 {TERM("linux"), "kitty", ""},
                 {TERM("xterm"), "halves", "\033[c"},
                 {{.term = "xterm", .no_color = true}, "auto", "\033[c"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct probe p = {.wish = graphics_asks(wish(cases[i].wish), &cases[i].environment),
                          .replies.environment = cases[i].environment};
        buf_clear(&asked);
        CHECK_INT(probe_ask(&p, &asked), *cases[i].asked != '\0');
        CHECK_TEXT(buf_text(&asked), cases[i].asked);
    }
}

/* As fine as the terminal is known to show them. */
STORY(blocks_are_text_of_any_shape)
{
    for (size_t i = 0; i < TERMINALS; i++) {
        const struct known *t = &terminals[i];
        ask(t, wish("blocks"), -1, SIZE_MAX);
        CHECK_INT(probed.facts.graphics->kind, GRAPHICS_TEXT);
        CHECK_INT(probed.facts.shape, t->shape);
        CHECK_TEXT(probed.probe.replies.answers, "");
    }
}

STORY(tmux_tells_which_terminal_it_is_shown_in)
{
    static const struct {
        const char *answer, *name;
        bool has_sixel;
        enum tmux_passing passing;
    } cases[] = {
        {"kitty(0.41.1)|256,RGB,ccolour,title|off\n", "kitty(0.41.1)", false, TMUX_PASSES_NOTHING},
        {"XTerm(398)|256,sixel|all\n", "XTerm(398)", true, TMUX_PASSES},
        {"foot(1.13.1)|sixel,RGB|1\n", "foot(1.13.1)", true, TMUX_PASSES},
        {"|bpaste,sixels,nosixel|0\n", "", false, TMUX_PASSES_NOTHING},
        {"||\n", "", false, TMUX_PASSING_UNKNOWN},
        {"\n", "\n", false, TMUX_PASSING_UNKNOWN},
        {"", "", false, TMUX_PASSING_UNKNOWN},
        {"a|sixel", "a", true, TMUX_PASSING_UNKNOWN},
        {"a|b|onward\n", "a", false, TMUX_PASSING_UNKNOWN},
        {"a|b|a long word that is none of these\n", "a", false, TMUX_PASSING_UNKNOWN},
        {"a name that is longer than any terminal has ever had, by far too much|sixel|on\n", "",
         true, TMUX_PASSES}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct tmux_client client;
        tmux_read(&client, cases[i].answer);
        CHECK_TEXT(client.name, cases[i].name);
        CHECK_INT(client.has_sixel, cases[i].has_sixel);
        CHECK_INT(client.passing, cases[i].passing);
    }
}

STORY(inside_tmux_text_has_the_shape_of_the_terminal_outside)
{
    static const struct {
        const char *outside;
        uint32_t column;
        enum block_shape shape;
    } cases[] = {{"kitty(0.41.1)", 2, BLOCK_SEXTANT}, {"kitty(0.41.1)", 3, BLOCK_QUADRANT},
                 {"VTE(7006)", 2, BLOCK_SEXTANT},     {"VTE(6400)", 2, BLOCK_QUADRANT},
                 {"XTerm(398)", 2, BLOCK_QUADRANT},   {"", 2, BLOCK_HALF}};
    const struct term_size size = {.columns = 80, .rows = 24};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct probe_replies r = {.environment = TERM("xterm-kitty"),
                                  .da1 = true,
                                  .name = "tmux 3.5a",
                                  .column = cases[i].column};
        struct terminal_facts f;
        snprintf(r.outer.name, sizeof r.outer.name, "%s", cases[i].outside);
        graphics_decide(&r, &size, graphics_auto, &f);
        CHECK_INT(f.shape, cases[i].shape);
        CHECK_INT(f.graphics->kind, GRAPHICS_TEXT);
    }
}

static enum probe_heard hear_all(struct probe *p, const char *const *bodies)
{
    enum probe_heard heard = PROBE_IGNORES;
    for (; *bodies; bodies++)
        heard = probe_hear(p, *bodies);
    return heard;
}

/* Frames are answered meanwhile, by tmux itself; and answers of an earlier probe come first. */
STORY(answers_may_come_during_the_session)
{
    static const struct probe_environment environment = TERM("tmux-256color");
    const struct term_size size = {.columns = 80, .rows = 24};
    OWNED(buf_release) struct buf asked = {0};
    struct terminal_facts f;
    struct probe p = {.wish = graphics_asks(graphics_auto, &environment),
                      .replies.environment = environment,
                      .due = 1};
    CHECK(probe_ask(&p, &asked) && !probe_ask(&p, &asked));
    CHECK_INT(hear_all(&p, (const char *const[]){"[?1;2;4c", NULL}), PROBE_HEARS);
    CHECK(!p.replies.da1);
    CHECK_INT(hear_all(&p, (const char *const[]){"[>84;0;0c", "P>|tmux 3.5a", "[?1;2;4c", NULL}),
              PROBE_HAS_ALL);
    CHECK(probe_ask(&p, &asked));
    CHECK_INT(hear_all(&p, (const char *const[]){"[6;2R", "[?1;2;4c", NULL}), PROBE_HAS_ALL);
    CHECK(probe_ask(&p, &asked) && p.replies.is_outer);
    CHECK_INT(hear_all(&p, (const char *const[]){"[?1;2;4c", "[?1;2;4c", NULL}), PROBE_IGNORES);
    graphics_decide(&p.replies, &size, graphics_auto, &f);
    CHECK(f.graphics == &graphics_halves && f.advice);
    CHECK_TEXT(f.barrier, PROBE_BARRIER);
    CHECK_INT(hear_all(&p, (const char *const[]){"P>|kitty(0.41.1)", "[?62;c", "[0n", NULL}),
              PROBE_HAS_ALL);
    CHECK(probe_ask(&p, &asked));
    CHECK_INT(hear_all(&p, (const char *const[]){"_Gi=31;OK", "[0n", NULL}), PROBE_HAS_ALL);
    CHECK(!probe_ask(&p, &asked));
    CHECK_INT(hear_all(&p, (const char *const[]){"[0n", "_Gi=31;OK", "[?62;c", NULL}),
              PROBE_IGNORES);
    graphics_decide(&p.replies, &size, graphics_auto, &f);
    CHECK(f.graphics == &graphics_placeholders && !f.advice && f.images_most == 0);
    CHECK_TEXT(f.barrier, PROBE_OUTER_BARRIER);
}

STORY(modes_are_answered_with_a_number)
{
    static const struct {
        const char *reply;
        bool synchronizes;
    } cases[] = {{"[?2026;0$y", false}, {"[?2026;1$y", true},  {"[?2026;2$y", true},
                 {"[?2026;3$y", false}, {"[?2026;4$y", false}, {"[?2026$y", false},
                 {"[?2027;2$y", false}, {"[?2026;2y", false},  {"[2026;2$y", false}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct probe_replies r = {0};
        probe_reply(&r, cases[i].reply);
        CHECK_INT(r.synchronizes, cases[i].synchronizes);
    }
}

STORY(colours_are_those_of_the_name)
{
    static const struct {
        const char *term, *colorterm;
        bool no_color;
        enum colours colours;
    } cases[] = {{"xterm", "", false, COLOURS_256},
                 {"xterm", "truecolor", false, COLOURS_24BIT},
                 {"xterm", "24bit", false, COLOURS_24BIT},
                 {"xterm", "yes", false, COLOURS_256},
                 {"xterm-direct", "", false, COLOURS_24BIT},
                 {"xterm-256color", "", false, COLOURS_256},
                 {"xterm-16color", "", false, COLOURS_16},
                 {"xterm-color", "", false, COLOURS_16},
                 {"rxvt", "", false, COLOURS_16},
                 {"linux", "truecolor", false, COLOURS_16},
                 {"screen", "truecolor", false, COLOURS_256},
                 {"vt100", "", false, COLOURS_NONE},
                 {"vt220", "truecolor", false, COLOURS_NONE},
                 {"dumb", "truecolor", false, COLOURS_NONE},
                 {"xterm-kitty", "truecolor", true, COLOURS_NONE}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const struct term_size size = {.columns = 80, .rows = 24};
        const struct probe_replies none = {.environment = {.term = cases[i].term,
                                                           .colorterm = cases[i].colorterm,
                                                           .no_color = cases[i].no_color}};
        struct terminal_facts f;
        graphics_decide(&none, &size, graphics_auto, &f);
        CHECK_INT(f.colours, cases[i].colours);
    }
}
