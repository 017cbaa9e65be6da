/* SPDX-License-Identifier: MIT */
/* The command language: every command of the table by its example, by random lines and by wrong
 * lines; and interpreter_execute, which undoes a command that cannot be recorded. */
#include <errno.h>

#include "command/command.h"
#include "base/choice.h"
#include "tests/journals.h"
#include "tests/random_commands.h"
#include "tests/small_scene.h"
#include "tests/scarce_memory.h"

/* ---- the table ---- */

STORY(the_table_is_in_order)
{
    for (unsigned i = 0; i < command_count(); i++) {
        const struct command *c = command_at(i);
        CHECK(command_find(c->name) == c); /* so names are unique */
        CHECK(*c->summary && *c->example && (c->act || c->parameter[0].sets.bytes));
        CHECK(strncmp(c->example, c->name, strlen(c->name)) == 0);
        if (c->flags & COMMAND_EDITS)
            CHECK(c->flags & COMMAND_RECORDED);
        bool may = false;
        for (int p = 0; p < PARAMETERS_MOST && c->parameter[p].type; p++) {
            const struct parameter *q = &c->parameter[p];
            if (!q->keyed) {
                CHECK(!may || q->optional); /* optional ones come last */
                may |= q->optional;
            }
            CHECK(!q->paired || (p > 0 && q[-1].choices && !q->keyed && q->optional));
            CHECK(q->type != VALUE_LINE || (q->keyed && c->parameter[0].type == VALUE_POSITION));
            CHECK(q->least <= q->most && (q->type != VALUE_CHOICE || q->choices));
        }
    }
}

STORY(a_choice_is_a_whole_word_told_by_its_number)
{
    static const char words[] = "axial|ax|coronal";
    const char *at = words;
    struct choice choice = {0};
    for (unsigned i = 0; i < 3; i++) {
        const struct choice same = choice_at(words, i);
        CHECK(choice_next(&choice, &at));
        CHECK(choice.word == same.word && choice.length == same.length);
    }
    CHECK(!choice_next(&choice, &at) && *at == '\0');
    CHECK_INT(choice_find(words, "axial"), 0);
    CHECK_INT(choice_find(words, "ax"), 1);
    CHECK_INT(choice_find(words, "coronal"), 2);
    for (const char *const *none = (const char *[]){"", "a", "axi", "coronals", "ax|coronal", NULL};
         *none; none++)
        CHECK_INT(choice_find(words, *none), -1);
    CHECK_INT(choice_find("", ""), -1);
    CHECK(choice_at(words, 9).length == strlen("coronal"));
    CHECK(file_is_named("/there/a.NII.gz", ".nii|.nii.gz") && file_is_named("a.nii", ".gz|.nii"));
    CHECK(!file_is_named("/there.nii/a", ".nii|.gz") && !file_is_named(".nii", ".nii"));
}

static void canonical(struct buf *out, const char *line, const struct session *session)
{
    OWNED(call_release) struct call call = {0};
    buf_clear(out);
    if (CHECK(command_parse(&call, line, session, &fault) == OK))
        command_write(out, &call);
    else
        printf("#   %s: %s\n", line, fault.text);
}

BEGUN_STORY(recipes_of_help_parse_and_fit_76_columns, begin_interpreter)
{
    OWNED(buf_release) struct buf once = {0};
    unsigned commands = 0;
    CHECK(!command_page("seed"));
    must(interp, "open synth:geom");
    for (const char *at = command_page("correct"); *at; at += strcspn(at, "\n") + 1) {
        char line[100];
        snprintf(line, sizeof line, "%.*s", (int)strcspn(at, "\n"), at);
        CHECK(strlen(line) <= 76);
        if (*line != ' ' || line[4] == '$')
            continue;
        canonical(&once, line, interp->session);
        CHECK_TEXT(buf_text(&once), line + 4);
        commands++;
    }
    CHECK(commands > 10);
    unsigned lines = 0;
    for (const char *at = command_page(NULL); *at; at += strcspn(at, "\n") + 1, lines++)
        CHECK(strcspn(at, "\n") <= 76);
    CHECK_INT(lines, 20); /* it fits a screen of 24 rows */
}

BEGUN_STORY(every_example_parses_and_its_canonical_form_is_its_own, begin_interpreter)
{
    OWNED(buf_release) struct buf once = {0}, twice = {0};
    must(interp, "open synth:geom");
    for (unsigned i = 0; i < command_count(); i++) {
        canonical(&once, command_at(i)->example, interp->session);
        canonical(&twice, buf_text(&once), interp->session);
        CHECK_TEXT(buf_text(&twice), buf_text(&once));
        CHECK_TEXT(buf_text(&once), command_at(i)->example);
    }
}

/* Return the form of a parameter in help. */
static const char *form_of(const struct parameter *p)
{
    static char form[80], radius[32];
    const bool is_place = p->type == VALUE_POSITION || p->type == VALUE_LINE;
    const char *type = p->form                     ? p->form
                       : is_place                  ? "X,Y,Z"
                       : p->type == VALUE_RANGE    ? "A-B"
                       : p->type == VALUE_LIST     ? "A-B,C"
                       : p->type == VALUE_INTERVAL ? "LOW..HIGH"
                       : p->type == VALUE_RADIUS   ? radius
                       : p->type == VALUE_COLOUR   ? "#rrggbb"
                       : p->type == VALUE_FILE     ? "FILE"
                                                   : p->name;
    snprintf(radius, sizeof radius, "%lld..%lld|Rmm", (long long)p->least, (long long)p->most);
    if (!p->choices)
        return type;
    if (p[1].paired) { /* "LOW HIGH|none" */
        snprintf(form, sizeof form, "%s %s|%s", type, is_place ? type : p[1].name, p->choices);
        return form;
    }
    const bool alone = p->type == VALUE_CHOICE || p->type == VALUE_PARTS;
    snprintf(form, sizeof form, "%s%s%s", p->choices, alone ? "" : "|",
             alone || (p->keyed && p->type == VALUE_DECIMAL) ? "" : type);
    return form;
}

STORY(help_names_every_command_and_parameter)
{
    OWNED(buf_release) struct buf all = {0}, one = {0};
    command_help(&all, NULL);
    for (unsigned i = 0; i < command_count(); i++) {
        const struct command *c = command_at(i);
        char start[64];
        snprintf(start, sizeof start, "\n%s", c->name);
        CHECK(strncmp(buf_text(&all), c->name, strlen(c->name)) == 0 ||
              strstr(buf_text(&all), start));
        CHECK_HAS(buf_text(&all), c->summary);
        CHECK_HAS(buf_text(&all), command_group_name[c->group]);
        buf_clear(&one);
        command_help(&one, c);
        CHECK_HAS(buf_text(&one), c->example);
        for (int p = 0; p < PARAMETERS_MOST && c->parameter[p].type; p++) {
            CHECK_HAS(buf_text(&one), form_of(&c->parameter[p]));
            CHECK_HAS(buf_text(&all), form_of(&c->parameter[p]));
            if (c->parameter[p].keyed)
                CHECK_HAS(buf_text(&one), c->parameter[p].name);
        }
    }
}

static void fits_76_columns(const char *text)
{
    for (; *text; text += strcspn(text, "\n") + 1)
        CHECK_WITH(strcspn(text, "\n") <= 76, "%.100s", text); /* `iftty -c` adds 4 columns */
}

STORY(help_fits_76_columns)
{
    OWNED(buf_release) struct buf out = {0};
    command_help(&out, NULL);
    fits_76_columns(buf_text(&out));
    for (unsigned i = 0; i < command_count(); i++) {
        buf_clear(&out);
        command_help(&out, command_at(i));
        fits_76_columns(buf_text(&out));
        CHECK(!strstr(buf_text(&out), " \n"));
    }
}

/* ---- random lines that are right ---- */

DRAW_FROM(0)

static void add_decimal(struct buf *out, const struct parameter *p)
{
    int64_t n = p->least + (int64_t)(check_random(&seed) % (uint64_t)(p->most - p->least + 1));
    if (below(3) == 0)
        n = n / 1000 * 1000 >= p->least ? n / 1000 * 1000 : n;
    int64_t whole = llabs(n) / 1000, rest = llabs(n) % 1000;
    buf_printf(out, "%s%lld", n < 0 ? "-" : "", (long long)whole);
    if (rest || below(2))
        buf_printf(out, ".%03lld%s", (long long)rest, below(2) ? "00" : "");
}

/* Add a word of odd characters, quoted if necessary and sometimes if not. */
static void add_word(struct buf *out)
{
    static const char *const piece[] = {"a",  "Z",  "7",        ".", "/", "-", "_", " ",
                                        "\"", "\\", "\xc3\xa9", "#", "=", ";", "'"};
    char word[64] = "w";
    bool must_quote = below(4) == 0;
    for (uint32_t i = below(12); i > 0; i--)
        strcat(word, piece[below(sizeof piece / sizeof piece[0])]);
    must_quote |= strpbrk(word, " ") != NULL;
    if (!must_quote) {
        buf_add_text(out, word);
        return;
    }
    buf_add_char(out, '"');
    for (const char *at = word; *at; at++) {
        if (*at == '"' || *at == '\\')
            buf_add_char(out, '\\');
        buf_add_char(out, *at);
    }
    buf_add_char(out, '"');
}

static void add_position(struct buf *out)
{
    uint32_t v[3] = {below(size[0]), below(size[1]), below(size[2])};
    double mm[3];
    for (int i = 0; i < 3; i++)
        mm[i] = to_mm[i][0] * v[0] + to_mm[i][1] * v[1] + to_mm[i][2] * v[2] + to_mm[i][3];
    if (below(2))
        buf_printf(out, "%u,%u,%u", v[0], v[1], v[2]);
    else
        buf_printf(out, "%.3f,%.2f,%.4fmm", mm[0], mm[1], mm[2]);
}

static void add_ranges(struct buf *out, const struct parameter *p, uint32_t ranges)
{
    for (; ranges > 0; ranges--) {
        const uint32_t first = (uint32_t)p->least + below((uint32_t)(p->most - p->least + 1));
        buf_printf(out, "%u", first);
        if (below(2))
            buf_printf(out, "-%u", first + below((uint32_t)p->most - first + 1));
        buf_add_text(out, ranges > 1 ? "," : "");
    }
}

static void add_value(struct buf *out, const struct parameter *p)
{
    if (p->choices && (p->type == VALUE_CHOICE || p->type == VALUE_PARTS || below(3) == 0)) {
        uint32_t n = 1;
        for (const char *at = p->choices; *at; at++)
            n += *at == '|';
        const struct choice choice = choice_at(p->choices, below(n));
        buf_add(out, choice.word, choice.length);
        return;
    }
    if (p->type == VALUE_POSITION || p->type == VALUE_LINE)
        add_position(out);
    else if (p->type == VALUE_LABEL && below(4) == 0)
        buf_add_text(out, "cerebellum");
    else if (p->type == VALUE_LABEL)
        buf_printf(out, "%u", (uint32_t)p->least + below(256 - (uint32_t)p->least));
    else if (p->type == VALUE_NUMBER)
        buf_printf(out, "%lld",
                   (long long)p->least + (long long)below((uint32_t)(p->most - p->least + 1)));
    else if (p->type == VALUE_DECIMAL)
        add_decimal(out, p);
    else if (p->type == VALUE_RADIUS)
        buf_printf(out, below(2) ? "%u" : "%u.%03umm",
                   (uint32_t)p->least + below((uint32_t)(p->most - p->least) + 1), below(1000));
    else if (p->type == VALUE_REAL)
        buf_printf(out, "%d.%03ue%d", (int)below(50) - 25, below(1000), (int)below(30) - 15);
    else if (p->type == VALUE_INTERVAL)
        buf_printf(out, "%d.%03u..%u.5e%u", -(int)below(50), below(1000), 1 + below(300), below(9));
    else if (p->type == VALUE_COLOUR)
        buf_printf(out, "#%06x", below(1u << 24));
    else if (p->type == VALUE_COMMAND)
        buf_add_text(out, command_at(below(command_count()))->name);
    else if (p->type == VALUE_RANGE || p->type == VALUE_LIST)
        add_ranges(out, p, p->type == VALUE_LIST ? 1 + below(3) : 1);
    else if (p->type == VALUE_LABELS)
        add_ranges(out, &(struct parameter){.most = 255}, 1 + below(3));
    else
        add_word(out);
}

static void random_line(struct buf *out, const struct command *command)
{
    struct buf keyed[PARAMETERS_MOST] = {{0}};
    buf_clear(out);
    for (uint32_t n = below(3); n > 0; n--)
        buf_add_text(out, below(2) ? " " : "\t");
    buf_add_text(out, command->name);
    bool ended = false; /* no more positional ones */
    for (int i = 0; i < PARAMETERS_MOST && command->parameter[i].type; i++) {
        const struct parameter *p = &command->parameter[i];
        bool given = !p->optional || below(2);
        for (uint32_t n = p->type == VALUE_LINE ? 1 + below(5) : 1; p->keyed && given && n > 0;
             n--) {
            buf_printf(&keyed[i], "%s%s=", keyed[i].length ? " " : "", p->name);
            add_value(&keyed[i], p);
        }
    }
    for (int i = 0; i < PARAMETERS_MOST && command->parameter[i].type; i++) {
        const struct parameter *p = &command->parameter[i];
        for (int k = 0; k < PARAMETERS_MOST; k++)
            if (keyed[k].length && below(3) == 0) {
                buf_printf(out, " %s", buf_text(&keyed[k]));
                buf_clear(&keyed[k]);
            }
        ended |= p->optional && !p->keyed && below(2);
        if (p->keyed || ended)
            continue;
        buf_add_text(out, below(5) ? " " : " \t ");
        add_value(out, p);
    }
    for (int k = 0; k < PARAMETERS_MOST; k++) {
        if (keyed[k].length)
            buf_printf(out, " %s", buf_text(&keyed[k]));
        buf_release(&keyed[k]);
    }
    for (uint32_t n = below(3); n > 0; n--)
        buf_add_char(out, ' ');
}

static bool same_values(const struct call *a, const struct call *b)
{
    bool same = a->command == b->command;
    for (int i = 0; i < PARAMETERS_MOST; i++) {
        const struct value *x = &a->value[i], *y = &b->value[i];
        same &= x->given == y->given && x->number == y->number && !x->text == !y->text &&
                memcmp(x->real, y->real, sizeof x->real) == 0 && x->in_mm == y->in_mm &&
                !x->line == !y->line && memcmp(x->place, y->place, sizeof x->place) == 0;
        if (x->text && y->text)
            same &= strcmp(x->text, y->text) == 0;
        if (x->line && y->line)
            same &= x->line->count == y->line->count &&
                    memcmp(x->line->corner, y->line->corner,
                           x->line->count * sizeof x->line->corner[0]) == 0;
    }
    return same;
}

SCENE_STORY(a_random_line_and_its_canonical_form_mean_the_same)
{
    OWNED(buf_release) struct buf line = {0}, once = {0}, twice = {0};
    seed = 1;
    for (unsigned i = 0; i < 40000 && check_failures < 5; i++) {
        OWNED(call_release) struct call first = {0}, second = {0};
        random_line(&line, command_at(i % command_count()));
        if (!CHECK(command_parse(&first, buf_text(&line), interp->session, &fault) == OK)) {
            printf("#   %s: %s\n", buf_text(&line), fault.text);
            continue;
        }
        buf_clear(&once);
        command_write(&once, &first);
        if (CHECK(command_parse(&second, buf_text(&once), interp->session, &fault) == OK)) {
            buf_clear(&twice);
            command_write(&twice, &second);
            CHECK_TEXT(buf_text(&twice), buf_text(&once));
            CHECK(same_values(&first, &second));
        } else {
            printf("#   %s: %s\n", buf_text(&once), fault.text);
        }
    }
}

SCENE_STORY(a_radius_is_written_with_all_its_digits)
{
    static const char *const word[] = {"0",         "32",          "0.000001mm", "0.00001mm",
                                       "0.05001mm", "999.99999mm", "1000mm"};
    OWNED(buf_release) struct buf out = {0};
    char line[64];
    for (size_t i = 0; i < sizeof word / sizeof word[0]; i++) {
        snprintf(line, sizeof line, "seed 0,0,0 1 radius=%s", word[i]);
        canonical(&out, line, interp->session);
        CHECK_TEXT(buf_text(&out), line);
    }
}

/* ---- positions ---- */

SCENE_STORY(millimetres_lead_to_the_nearest_voxel)
{
    static const char *const row[][2] = {
        {"seed 0,0,0 1", "seed 0,0,0 1"},
        {"seed 5.5,-20,7mm 1", "seed 0,0,0 1"},
        {"seed 2.5,-14,18mm 1", "seed 3,4,5 1"}, /* z = 0.25*4 + 2*5 + 7 */
        {"seed 2.9,-13.5,17.6mm 1", "seed 3,4,5 1"},
        {"seed -5.5,-5,27.5mm 2", "seed 11,10,9 2"},
        {"remove -5.5,-5,27.5mm", "remove 11,10,9"},
        {"why 3.000,4.0,5", "why 3,4,5"},
    };
    static const char *const outside[] = {
        "seed 12,0,0 1",      "seed 0,11,0 1",       "seed 0,0,10 1", "seed -1,0,0 1",
        "seed 6.1,-20,7mm 1", "seed 999999,0,0mm 1", "why 900000,0,0"};
    OWNED(buf_release) struct buf out = {0};
    struct call call;
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        canonical(&out, row[i][0], interp->session);
        CHECK_TEXT(buf_text(&out), row[i][1]);
    }
    for (size_t i = 0; i < sizeof outside / sizeof outside[0]; i++) {
        CHECK(command_parse(&call, outside[i], interp->session, &fault) == ERR_INPUT);
        CHECK_HAS(fault.text, "is outside the scene, whose voxels are 0,0,0 to 11,10,9");
        CHECK_HAS(fault.text, "nothing has changed");
    }
}

/* ---- lines that are wrong ---- */

SCENE_STORY(each_synonym_suggests_one_command)
{
    static char said[4096]; /* "|exit|bye|" */
    strcpy(said, "|");
    for (unsigned i = 0; i < command_count(); i++) {
        const char *also = command_at(i)->also ? command_at(i)->also : "";
        struct choice word;
        while (choice_next(&word, &also)) {
            char line[64], key[66], words[160];
            OWNED(call_release) struct call call = {0};
            snprintf(line, sizeof line, "%.*s", (int)word.length, word.word);
            snprintf(key, sizeof key, "|%s|", line);
            snprintf(words, sizeof words, "unknown command %s; did you mean %s?", line,
                     command_at(i)->name);
            CHECK_INT(command_parse(&call, line, interp->session, &fault), ERR_USAGE);
            CHECK_TEXT(fault.text, words);
            CHECK(!strstr(said, key));
            strcat(said, key + 1);
        }
    }
    CHECK_HAS(said, "|exit|");
}

SCENE_STORY(an_error_names_the_expected_form)
{
    static const char *const row[][2] = {
        {"sede 1,1,1 1", "unknown command sede; did you mean seed?"},
        {"xylophone 1", "unknown command xylophone; `help all` lists them"},
        {"Seed 1,1,1 1", "unknown command Seed; did you mean seed?"},
        {"interp 2 2 2", "unknown command interp; did you mean interpolate?"},
        {"exit", "unknown command exit; did you mean quit?"},
        {"load a.nii", "unknown command load; did you mean open?"},
        {"help erase", "erase; did you mean remove?"},
        {"see 1,1,1 1", "unknown command see; did you mean seed or seed-file?"},
        {"s", "unknown command s; `help all` lists them"},
        {"\"\"", "unknown command"},
        {"= 1", "unknown command ="},
        {"seed 1,1,1 liver", "LABEL: expected a label 0..255 or the name of one, not liver"},
        {"seed 1,1,1 cerebelum", "the name of one, not cerebelum; did you mean cerebellum?"},
        {"hide bakground", "the name of one, not bakground; name one with"},
        {"seed 1,1,1 256", "expected a label 0..255"},
        {"seed 1,1,1 -1", "expected a label 0..255"},
        {"seed 1,1,1 1x", "not 1x"},
        {"hide 0", "LABEL: expected all, a label 1..255 or the name of one, not 0; name one"},
        {"hide background", "expected all, a label 1..255"},
        {"show al", "the name of one, not al; did you mean all?"},
        {"opacity alll 3", "the name of one, not alll; did you mean all?"},
        {"adjacency 18", "COUNT: expected 6|26, not 18"},
        {"auto yes", "STATE: expected on|off, not yes"},
        {"auto o", "STATE: expected on|off, not o"},
        {"auto onn", "STATE: expected on|off, not onn; did you mean on?"},
        {"view lfet", "not lfet; did you mean left?"},
        {"zoom fitt", "not fitt; did you mean fit?"},
        {"focus secne", "not secne; did you mean scene?"},
        {"weight sobl", "there is no file sobl here; nothing has changed; did you mean sobel?"},
        {"seed 1,1,1 1 radus=2", "seed has no radus=; did you mean radius=?"},
        {"seed 1,1,1 radus=2", "seed has no radus=; did you mean radius=?"},
        {"seed-file x.csv ech=2", "seed-file has no ech=; did you mean each=?"},
        {"help sede", "there is no command sede; did you mean seed?"},
        {"weight paint",
         "expected morph|sobel|gauss|difference|polarity or a file: there is no file "
         "paint here; nothing has changed"},
        {"weight gauss", "SIGMA: `weight gauss` needs one"},
        {"interpolate 2 2", "missing: Z; usage: interpolate X Y Z"},
        {"interpolate 3 1 1", "X: expected a number 1..2, not 3"},
        {"weight sobel 1", "SIGMA: `weight sobel` has none"},
        {"weight gauss 0.499", "SIGMA: expected a number 0.5..8 with at most three decimals"},
        {"weight gauss 8.001", "SIGMA: expected a number 0.5..8"},
        {"weight morph radius=4", "radius: expected a number 1..3, not 4"},
        {"weight sobel radius=2", "radius: `weight sobel` has none"},
        {"render mode=fast", "mode: expected sp|bp|ii|ray, not fast"},
        {"render mode=", "not nothing"},
        {"render mode=sp|bp", "expected sp|bp|ii|ray"},
        {"save maps x.nii", "labels|cost|root|border|distance|margin|seeds|names"},
        {"seed 1,1,1", "missing: LABEL; usage: seed X,Y,Z LABEL [radius=0..512|Rmm]"},
        {"seed", "missing: PLACE"},
        {"save labels", "missing: FILE"},
        {"run now", "one word too many: now; usage: run"},
        {"seed 1,1,1 1 2", "one word too many: 2"},
        {"seed 1,1,1 1 size=2", "one word too many: size=2"},
        {"view 1 2 3 4", "one word too many: 4"},
        {"label 2 \"a b", "a word in quotes does not end"},
        {"render \"a\tb.png\"", "a tab in a word"},
        {"label 2 \"a\"b", "a word in quotes does not end"},
        {"label 2 \"a\\\"", "a word in quotes does not end"},
        {"\"", "a word in quotes does not end"},
        {"label 2 \"\"", "NAME: expected a word, not nothing"},
        {"seed 1,1,1 1 radius=513",
         "radius: expected a number 0..512, or millimetres as in 2.5mm, above 0 and "
         "up to 1000 with at most six decimals, not 513"},
        {"seed 1,1,1 1 radius=-1",
         "radius: expected a number 0..512, or millimetres as in 2.5mm, above 0 and "
         "up to 1000 with at most six decimals, not -1"},
        {"seed 1,1,1 1 radius=99999999999999999999", "expected a number 0..512"},
        {"seed 1,1,1 1 radius=1 radius=2", "given twice: radius=2"},
        {"zoom 64.001", "FACTOR: expected fit or a number 0.01..64 with at most three decimals"},
        {"zoom 0.009", "FACTOR: expected fit or a number 0.01..64"},
        {"zoom nan", "FACTOR: expected fit or a number"},
        {"zoom 1e3", "FACTOR: expected fit or a number"},
        {"size 0 5", "WIDTH: expected a number 1..8192, not 0"},
        {"size 5 8193", "HEIGHT: expected a number 1..8192"},
        {"turn 3600.001", "YAW: expected a number -3600..3600"},
        {"turn 1.2345", "at most three decimals"},
        {"view sideways", "YAW: expected front|back|left|right|top|bottom or a number"},
        {"seed 1.5,1,1 1", "expected whole voxel indices, or mm at the end"},
        {"seed 1,1 1", "X,Y,Z (voxel indices) or X,Y,Zmm (world)"},
        {"seed 1,1,1,1 1", "X,Y,Z (voxel indices)"},
        {"seed 1, 1, 1 1", "X,Y,Z (voxel indices)"},
        {"seed 1,1,1cm 1", "X,Y,Z (voxel indices)"},
        {"label 2 x #12345", "#rrggbb"},
        {"label 2 x #12345G", "#rrggbb"},
        {"label 2 x #1234567", "#rrggbb"},
        {"label 3 99", "no number"},
        {"label 3 \"9 9\"", "no number"},
        {"label 3 \"#9\"", "no # at its beginning"},
        {"label 3 a=b", "no = or \\"},
        {"label 3 \"a b \"", "no blank at its ends"},
        {"label 3 a\x1b[31m", "a\\x1b[31m"},
        {"label 3 abcdefghijklmnopqrstuvwxyzabcdef", "at most 31 bytes"},
        {"label 3 cerebellum", "label 2 is already called cerebellum"},
        {"label 3 x code=SCT", "code: expected none, or for a label above 0 SCHEME:VALUE"},
        {"label 3 x code=:1", "16 letters, digits or ._+/- at most each"},
        {"label 3 x code=SCT:", "not SCT:"},
        {"label 3 x code=SCT:1:", "not SCT:1:"},
        {"label 3 x code=SCT:12345678901234567", "not SCT:1234"},
        {"label 3 x code=ABCDEFGHIJKLMNOPQ:1", "not ABC"},
        {"label 3 x \"code=SCT:1 2\"", "not SCT:1 2"},
        {"label 3 x code=SC\xc3\xa4:1", "not SC"},
        {"label 3 x code=SCT:1:a\\b", "64 bytes without \\\"^~|<>&"},
        {"label 3 x code=SCT:1:a|b", "not SCT:1:a|b"},
        {"label 3 x \"code=SCT:1: a\"", "not SCT:1: a"},
        {"label 0 x code=SCT:1", "for a label above 0"},
        {"help nothing", "there is no command nothing"},
        {"view left 3", "a named view has no angles"},
        {"pan 1", "missing: DOWN; usage: pan RIGHT DOWN"},
        {"pan 8192.001 0", "RIGHT: expected a number -8192..8192 with at most three decimals"},
        {"pan up 3", "RIGHT: expected a number"},
        {"pan 8192 0", "too far from the scene; the view is unchanged"},
        {"clip axial", "expected axial slices A-B within 0-9, feet to head"},
        {"clip sagittal 5-12", "there are sagittal slices 0-11, right to left, not 12"},
        {"clip coronal 5-4", "SLICES: expected A-B, or A, within 0-65533, not 5-4"},
        {"clip oblique 1-2", "PLANE: expected axial|coronal|sagittal|none, not oblique"},
        {"clip none 1-2", "`clip none` has no slices; the view is unchanged"},
        {"plane", "missing: PLACE; usage: plane none|X,Y,Z"},
        {"plane 12,0,0", "is outside the scene"},
        {"plane all", "PLACE: expected none or X,Y,Z (voxel indices) or X,Y,Zmm (world), not all"},
        {"cut 1,1,1", "expected two corners X,Y,Z X,Y,Z, or none alone; the view is unchanged"},
        {"cut none 1,1,1", "expected two corners"},
        {"cut 1,1,1 2,2,10", "is outside the scene"},
        {"cut 1,1,1 2,2,x", "OPPOSITE: expected X,Y,Z (voxel indices)"},
        {"focus here",
         "PLACE: expected scene or X,Y,Z (voxel indices) or X,Y,Zmm (world), not here"},
        {"focus 12,0,0", "is outside the scene, whose voxels are 0,0,0 to 11,10,9"},
        {"golden ../front", "lower-case letters"},
        {"pick 0 0", "`render` first"},
        {"remove 1,1,1", "no seed reaches it"},
        {"cross 12,0,0", "is outside the scene, whose voxels are 0,0,0 to 11,10,9"},
        {"cross", "missing: PLACE; usage: cross X,Y,Z"},
        {"window", "missing: LOW"},
        {"window 5", "expected LOW and HIGH, or auto alone; nothing has changed"},
        {"window auto 5", "expected LOW and HIGH, or auto alone"},
        {"window 5 5", "HIGH is not above LOW; nothing has changed"},
        {"window wide 5",
         "LOW: expected auto or a number, as in 40, -0.5 or 1.5e-3, of at most 19 digits"},
        {"overlay", "expected what to change, as in `overlay tint cross=off`"},
        {"overlay paint", "LABELS: expected none|tint|contour, not paint"},
        {"overlay words=maybe", "words: expected on|off, not maybe"},
        {"slice", "missing: PLANE; usage: slice axial|coronal|sagittal [N] [FILE]"},
        {"slice transverse", "PLANE: expected axial|coronal|sagittal, not transverse"},
        {"slice axial 10", "N: expected one of the axial slices 0..9, not 10"},
        {"slice coronal 11", "N: expected one of the coronal slices 0..10"},
        {"slice sagittal 12", "N: expected one of the sagittal slices 0..11"},
        {"slice axial -1", "N: expected a number 0..65533, not -1"},
        {"slice axial left", "N: expected a number 0..65533, not left"},
        {"slice axial 1 2", "its name says no format; expected for instance .png"},
        {"slice axial zoom=0", "zoom: expected fit or a number 0.01..64"},
        {"slice axial missing-folder/x.exr", "there is no folder"},
        {"mosaic missing-folder/x.exr", "there is no folder"},
        {"golden x of=oblique",
         "of: expected rendition|axial|coronal|sagittal|mosaic, not oblique"},
        {"open elsewhere.nii", "there is no scene elsewhere.nii here"},
        {"open elsewhere.iftty", "there is no journal elsewhere.iftty here, and `open` opens "},
        {"open synth:geom", "a scene is open already"},
        {"render missing-folder/x.exr", "there is no folder"},
        {"\x1b]0;title\x07", "\\x1b]0;title\\x07"},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++)
        is_refused(interp, row[i][0], row[i][1]);
    OWNED(mem_release) char *lengthy = malloc(100001);
    if (CHECK(lengthy != NULL)) {
        memset(lengthy, 'a', 100000);
        lengthy[100000] = '\0';
        is_refused(interp, lengthy, "longer than 65535 bytes");
        lengthy[4000] = '\0';
        is_refused(interp, lengthy, "unknown command aaaa");
    }
}

/* Check the word under the caret of an error; "" for a position behind the end. */
static void is_wrong_at(struct interpreter *interp, const char *line, const char *word)
{
    CHECK(execute(interp, line) != OK);
    const size_t length = strlen(line);
    if (!CHECK(fault.at > 0 && fault.at <= length + 2))
        return;
    if (fault.at - 1 > length)
        CHECK_TEXT("", word);
    else if (!CHECK(strncmp(line + fault.at - 1, word, strlen(word)) == 0))
        printf("#   %s: at %s\n", line, line + fault.at - 1);
}

SCENE_STORY(an_error_has_the_position_of_the_wrong_word)
{
    is_wrong_at(interp, "sede 1,1,1 1", "sede");
    is_wrong_at(interp, "  \t sede 1,1,1 1", "sede");
    is_wrong_at(interp, "seed 1,1 1", "1,1 ");
    is_wrong_at(interp, "seed 99,1,1 1", "99,1,1");
    is_wrong_at(interp, "seed   1,1,1   liver", "liver");
    is_wrong_at(interp, "seed 1,1,1", "");
    is_wrong_at(interp, "seed 1,1,1 ", "");
    is_wrong_at(interp, "run now and then", "now");
    is_wrong_at(interp, "seed radius=513 1,1,1 1", "radius=513");
    is_wrong_at(interp, "label 2 \"\" #40c060", "\"\" #");
    is_wrong_at(interp, "save \"labels\" x.nii replace=maybe", "replace=maybe");
    is_wrong_at(interp, "\"sa\\\"ve\" x", "\"sa");
    is_wrong_at(interp, "render \"a b", "\"a b");
    is_wrong_at(interp, "label 2 \xc3\xa4\x1b[m", "\x1b[m");
    is_wrong_at(interp, "mask elsewhere.nii", "elsewhere.nii");
    is_wrong_at(interp, "mask \"else where.nii\" regions=1", "\"else where.nii\"");
    is_wrong_at(interp, "goto nowhere", "nowhere");
    is_wrong_at(interp, "label 1 cerebellum", "cerebellum");
    is_wrong_at(interp, "save labels nowhere/x.nii empty=yes", "nowhere/x.nii");
    CHECK(execute(interp, "open synth:geom") != OK); /* no single word is wrong */
    CHECK_INT(fault.at, 0);
}

BEGUN_STORY(without_a_scene_only_what_needs_none_works, begin_interpreter)
{
    for (unsigned i = 0; i < command_count(); i++) {
        const struct command *c = command_at(i);
        if (c->flags & COMMAND_NEEDS_SCENE)
            is_refused(interp, c->example, "scene");
    }
    is_refused(interp, "seed 1,1,1 1", "no scene is open; open one first");
    is_refused(interp, "run", "run needs a scene; open one first");
    is_refused(interp, "open synth:geom:333", "each of X, Y, Z 1 or 2");
    is_refused(interp, "open synth:cube", "nothing was opened");
    MUST_MENTION(interp, "label 1 liver; auto on; info", "no scene is open");
    MUST_MENTION(interp, "help seed", "radius=0..512");
    must(interp, "quit");
    CHECK(interp->wish == WISH_QUIT);
}

SCENE_STORY(comments_and_empty_lines_do_nothing)
{
    static const char *const line[] = {"", "   ", "\t", "# seed 1,1,1 1", "  # x", "#"};
    for (size_t i = 0; i < sizeof line / sizeof line[0]; i++) {
        struct snapshot before;
        take_snapshot(&before, interp);
        CHECK(execute(interp, line[i]) == OK);
        CHECK_INT(reply.canonical.length, 0);
        is_as_before(&before, interp, line[i]);
    }
}

/* Mix words of the language and random bytes. */
static void garbage(char *out, size_t capacity)
{
    size_t n = 0;
    for (uint32_t pieces = below(12); pieces > 0; pieces--) {
        const struct command *c = command_at(below(command_count()));
        uint32_t kind = below(6);
        char piece[80];
        if (kind == 0)
            snprintf(piece, sizeof piece, "%s", c->name);
        else if (kind == 1)
            snprintf(piece, sizeof piece, "%.70s", c->example);
        else if (kind == 2 && c->parameter[2].type)
            snprintf(piece, sizeof piece, "%s=%d", c->parameter[2].name, (int)below(99) - 9);
        else if (kind == 3)
            snprintf(piece, sizeof piece, "%d,%d,%dmm", (int)below(99) - 9, (int)below(9),
                     (int)below(1u << 30));
        else
            for (size_t k = below(20), i = (piece[k] = '\0', 0); i < k; i++)
                piece[i] = (char)(1 + below(255));
        n += (size_t)snprintf(out + n, capacity - n, "%s%s", piece, below(2) ? " " : "");
    }
    if (n && below(3) == 0)
        out[below((uint32_t)n)] = (char)(1 + below(255));
    out[n] = '\0';
}

SCENE_STORY(garbage_is_parsed_or_refused_in_one_plain_line)
{
    OWNED(buf_release) struct buf once = {0}, twice = {0};
    char line[2048];
    unsigned parsed = 0;
    seed = 2;
    for (unsigned i = 0; i < 30000 && check_failures < 5; i++) {
        OWNED(call_release) struct call call = {0};
        line[0] = '\0';
        garbage(line, sizeof line);
        fault = (struct fault){.text = ""};
        if (command_parse(&call, line, interp->session, &fault) != OK) {
            CHECK(fault.text[0] != '\0' && is_plain(fault.text) && fault.code != OK);
            CHECK(fault.at <= strlen(line) + 2);
        } else if (call.command) {
            parsed++;
            buf_clear(&once);
            command_write(&once, &call);
            canonical(&twice, buf_text(&once), interp->session);
            CHECK_TEXT(buf_text(&twice), buf_text(&once));
        }
        buf_clear(&once);
        size_t start = 0, cursor = below((uint32_t)strlen(line) + 1);
        command_complete(&once, &start, line, cursor, interp);
        CHECK(start <= cursor);
    }
    CHECK(parsed > 300); /* else the mixture tests nothing */
}

/* ---- completion ---- */

/* Complete a line; keep the words without their explanations. */
static void complete_words(struct buf *out, size_t *start, const char *line,
                           const struct interpreter *interp)
{
    size_t kept = 0;
    bool is_word = true;
    buf_clear(out);
    command_complete(out, start, line, strlen(line), interp);
    for (size_t i = 0; i < out->length; i++) {
        is_word = (is_word && out->data[i] != '\t') || out->data[i] == '\n';
        if (is_word)
            out->data[kept++] = out->data[i];
    }
    if (out->data)
        out->data[out->length = kept] = '\0';
}

static void completes(const struct interpreter *interp, const char *line, const char *expected,
                      size_t expected_start)
{
    OWNED(buf_release) struct buf out = {0};
    size_t start = 99;
    complete_words(&out, &start, line, interp);
    CHECK_TEXT(buf_text(&out), expected);
    CHECK_INT(start, expected_start);
}

SCENE_STORY(completion_offers_valid_words)
{
    OWNED(buf_release) struct buf out = {0}, names = {0};
    size_t start;
    must(interp, "label 7 cortex");
    complete_words(&out, &start, "", interp);
    for (unsigned i = 0; i < command_count(); i++)
        buf_printf(&names, "%s\n", command_at(i)->name);
    CHECK_TEXT(buf_text(&out), buf_text(&names));
    buf_clear(&out);
    complete_words(&out, &start, "help ", interp);
    CHECK(strncmp(buf_text(&out), "all\nkeys\ncorrect\n", 17) == 0);
    CHECK_TEXT(buf_text(&out) + 17, buf_text(&names));
    completes(interp, "see", "seed\nseed-file\n", 0);
    completes(interp, "  see", "seed\nseed-file\n", 2);
    completes(interp, "xyz", "", 0);
    completes(interp, "xyz ", "", 4);
    completes(interp, "help see", "seed\nseed-file\n", 5);
    completes(interp, "help seed ", "", 10);
    completes(interp, "save ",
              "labels\ncost\nroot\nborder\ndistance\nmargin\nseeds\nnames\nsurface\nreplace="
              "\nfinished=\nlabel=\nsmooth=\ntriangles=\nempty=\nidentity=\ntimes=\n",
              5);
    completes(interp, "save c", "cost\n", 5);
    completes(interp, "save cost x.nii replace=y", "yes\n", 24);
    completes(interp, "render mode=", "sp\nbp\nii\nray\n", 12);
    completes(interp, "render mode=b", "bp\n", 12);
    completes(interp, "seed 1,1,1 ce", "cerebellum\n", 11);
    completes(interp, "seed 1,1,1 c", "cerebellum\ncortex\n", 11);
    completes(interp, "seed 1,1,1 7 r", "radius=\nrange=\n", 13);
    completes(interp, "seed-file x.nii label=c", "cerebellum\ncortex\n", 22);
    completes(interp, "hide cor", "cortex\n", 5);
    completes(interp, "show a", "all\n", 5);
    completes(interp, "view b", "back\nbottom\n", 5);
    completes(interp, "zoom f", "fit\n", 5);
    completes(interp, "adjacency ", "6\n26\n", 10);
}

static void means(const struct interpreter *interp, const char *line, const char *part)
{
    OWNED(buf_release) struct buf out = {0};
    size_t start;
    command_complete(&out, &start, line, strlen(line), interp);
    CHECK_HAS(buf_text(&out), part);
}

SCENE_STORY(completion_explains_words)
{
    must(interp, "label 7 cortex; seed 1,1,1 7");
    means(interp, "un", "undo\tundo the last change of the segmentation\n");
    means(interp, "help ", "keys\tlist the keys of the prompt.\n");
    means(interp, "help c", "correct\tshow how to correct a segmentation of another program.\n");
    means(interp, "shade ", "cubes\tdraw voxel faces, with the normals of the surface.\n");
    means(interp, "shade ",
          "surface\tdraw the smooth surfaces of visible objects.\n"); /* surface, the default: */
    means(interp, "weight so", "sobel\tthe 3-D Sobel operator.\n");
    means(interp, "remove 1,1,1 of=t",
          "tree\tremove only the seed of the tree that contains the voxel");
    means(interp, "seed-file x.nii er", "erode=\tthe number of erosions of each region;");
    means(interp, "seed-file x.nii gen", "generator=\tthe start value of the random generator");
    means(interp, "spin 9 x.gif del", "delay=\tthe time of each picture");
    means(interp, "hide co", "cortex\tlabel 7\n");
    means(interp, "goto ", "\tseed 1,1,1 7\n");
    means(interp, "adjacency 2", "26\n");
}

STORY(commands_are_the_same_wherever_their_file_is_seen_from)
{
    static const struct {
        const char *a, *b;
        bool are_same;
    } pair[] = {
        {"open a.nii weight=morph", "open ../x/a.nii weight=morph", true},
        {"mask \"b c.nii\"", "mask ../b c.nii", false},
        {"mask \"b c.nii\"", "mask \"../b c.nii\"", true},
        {"open a.nii weight=morph", "open a.nii weight=sobel", false},
        {"open a.nii weight=morph", "open a.nii", false},
        {"open a.nii", "open b.nii", false},
        {"open a.nii", "mask a.nii", false},
        {"render a.png", "render b/a.png", false}, /* a file that is written */
        {"undo", "undo", true},
        {"undo", "undo 2", false},
        {"later x/a", "later a", false},
        {"", "undo", false},
    };
    for (size_t i = 0; i < sizeof pair / sizeof *pair; i++) {
        CHECK(command_is_same(pair[i].a, pair[i].b) == pair[i].are_same);
        CHECK(command_is_same(pair[i].b, pair[i].a) == pair[i].are_same);
    }
    OWNED(buf_release) struct buf name = {0};
    bool is_scene, is_part;
    CHECK(command_opens(&name, &is_scene, &is_part, "open volume=2 \"a b.nii\" series=2") &&
          is_scene && !is_part);
    CHECK_TEXT(buf_text(&name), "a b.nii");
    CHECK(command_opens(&name, &is_scene, &is_part, "channel 'a crop=b' name=\"b data=c\"") &&
          !is_scene && !is_part);
    CHECK_TEXT(buf_text(&name), "a crop=b");
    static const char *const others[] = {"mask a.nii",         "open volume=2",
                                         "open a.nii b.nii",   "channel 2 percent=50",
                                         "open a.nii serie=2", "open a.nii missing=blan volume=x",
                                         "open 'a.nii"};
    static const char *const parts[] = {"open\ta.nii\tcrop=1-2,1-2,1-2", "open a.nii 'reduce=2'",
                                        "open raw:a size=2,2,2", "channel a.nii resample=yes",
                                        "channel a.h5 data=/b"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        CHECK(!command_opens(&name, &is_scene, &is_part, others[i]));
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        CHECK(command_opens(&name, &is_scene, &is_part, parts[i]) && is_part);
}

/* Create files with names of all kinds in a folder, and change to it. */
static void begin_with_files(struct interpreter *interp)
{
    static const char *const name[] = {"a.nii",     "ab c.nii", "\"q\\.nii",
                                       "#hash.nii", ".hidden",  "bad\nname",
                                       "bad\x1b[m", "\xff",     "b\xc3\xa4r.nii"};
    begin_with_scene(interp);
    must(interp, "label 7 cortex");
    CHECK(file_make_folder(place("files"), NULL) == OK);
    CHECK(file_make_folder(place("files/masks"), NULL) == OK);
    CHECK(file_make_folder(place("files/to do"), NULL) == OK);
    for (size_t i = 0; i < sizeof name / sizeof *name; i++) {
        char path[64];
        snprintf(path, sizeof path, "files/%s", name[i]);
        write_text(path, "");
    }
    write_text("files/masks/m.nii", "");
    write_text("files/to do/one.nii", "");
    CHECK(symlink("masks", place("files/link")) == 0 && chdir(place("files")) == 0);
}

BEGUN_STORY(completion_offers_files, begin_with_files)
{
    completes(interp, "open a", "\"a.nii\"\n\"ab c.nii\"\n", 5);
    completes(interp, "open a.", "a.nii\n", 5);
    completes(interp, "open \"a", "\"a.nii\"\n\"ab c.nii\"\n", 5);
    completes(interp, "open \"a.", "\"a.nii\"\n", 5);
    completes(interp, "open \"a.nii\"", "", 12);
    completes(interp, "open m", "masks/\nmissing=\n", 5);
    completes(interp, "open l", "link/\n", 5);
    completes(interp, "open masks/", "masks/m.nii\n", 5);
    completes(interp, "open masks/n", "", 5);
    completes(interp, "open t", "\"to do/\ntype=\n", 5);
    completes(interp, "open \"to do/", "\"to do/one.nii\"\n", 5);
    completes(interp, "open ./a.", "./a.nii\n", 5);
    completes(interp, "open #", "\"#hash.nii\"\n", 5);
    completes(interp, "open ./#", "./#hash.nii\n", 5);
    completes(interp, "open \"\\\"", "\"\\\"q\\\\.nii\"\n", 5);
    completes(interp, "open b", "b\xc3\xa4r.nii\n", 5); /* others cannot be in a command */
    completes(interp, "open .", ".hidden\n", 5);
    completes(interp, "open \"\"x", "", 8);
    completes(interp, "save labels m", "masks/\n", 12);
    completes(interp, "weight m", "morph\nmasks/\n", 7);
    completes(interp, "slice axial m", "masks/\n", 12);
    completes(interp, "slice axial 3 m", "masks/\n", 14);
    completes(interp, "render l", "link/\nlayout=\n", 7);
    completes(interp, "render layout=l", "lines\n", 14);
    completes(interp, "seed 1,1,1 m", "", 11);
    completes(interp, "hide \"co", "\"cortex\"\n", 5);
    completes(interp, "save nowhere/", "", 5);
    setenv("HOME", place("files/masks"), 1);
    completes(interp, "open ~/m", "~/m.nii\n", 5);
    completes(interp, "save labels \"~/", "\"~/m.nii\"\n", 12);
    unsetenv("HOME");
    CHECK(chdir(folder) == 0);
}

SCENE_STORY(a_key_that_is_given_is_not_offered_again)
{
    completes(interp, "overlay cross=on ", "none\ntint\ncontour\nmarks=\nwords=\n", 17);
    completes(interp, "overlay cross=on m", "marks=\n", 17);
    completes(interp, "fill 1,1,1 2 to=3,1,1 t", "to=\n", 22); /* except for a line */
    completes(interp, "hide b", "", 5);                        /* label 0 cannot be hidden */
    completes(interp, "# see", "", 5);
}

STORY(goldens_branches_and_records_are_offered)
{
    OWNED(interpreter_release) struct interpreter interp;
    begin_with_journal(&interp, "offers.iftty");
    completes(&interp, "golden ", "of=\nfinished=\n", 7);
    must(&interp, "seed 1,1,1 2; seed 9,9,9 1; size 20 20; golden front-1; "
                  "golden front-2 of=axial; branch stem");
    completes(&interp, "golden f", "front-1\nfront-2\nfinished=\n", 7);
    completes(&interp, "golden front-1 of=a", "axial\n", 18);
    completes(&interp, "goto s", "stem\n", 5);
    completes(&interp, "goto ", "main\nstem\n1\n2\n3\n5\n", 5);
    completes(&interp, "goto 2", "2\n", 5);
}

/* ---- hints ---- */

#define SHELL_KEYS "[shell=yes] [around=LABEL] [through=X,Y,Z] [within=0..512|Rmm] " OVER_KEYS
#define OVER_KEYS  "[over=A-B,NAME] [keep=A-B,NAME]"
#define SEED_TO    "[to=X,Y,Z ...] [joined=yes] " SHELL_KEYS
#define SEED_RANGE "[range=LOW..HIGH] " SEED_TO
#define SEED_KEYS  "[radius=0..512|Rmm] " SEED_RANGE

STORY(a_hint_is_the_rest_of_the_usage)
{
    static const char *const row[][2] = {
        {"", ""},
        {"see", ""},
        {"seed", " X,Y,Z LABEL " SEED_KEYS},
        {"seed ", "X,Y,Z LABEL " SEED_KEYS},
        {"  seed   ", "X,Y,Z LABEL " SEED_KEYS},
        {"seed 1", " LABEL " SEED_KEYS},
        {"seed 1,1,1", " LABEL " SEED_KEYS},
        {"seed 1,1,1 ", "LABEL " SEED_KEYS},
        {"seed 1,1,1 2", " " SEED_KEYS},
        {"seed 1,1,1 2 ", SEED_KEYS},
        {"seed 1,1,1 2 r", ""},
        {"seed 1,1,1 2 radius=", "0..512|Rmm " SEED_RANGE},
        {"seed 1,1,1 2 radius=3", " " SEED_RANGE},
        {"seed radius=", "0..512|Rmm X,Y,Z LABEL " SEED_RANGE},
        {"seed radius=3 ", "X,Y,Z LABEL " SEED_RANGE},
        {"seed 1,1,1 2 radius=3 ", SEED_RANGE},
        {"seed 1,1,1 2 radius=3 to=2,2,2 ", SEED_RANGE},
        {"range ", "LOW HIGH|none"},
        {"range 20 ", "HIGH"},
        {"range none", ""},
        {"range none ", ""},
        {"cut 1,1,1", " X,Y,Z"},
        {"seed 1,1,1 2 3 ", SEED_KEYS},
        {"overlay words=off ", "[none|tint|contour] [cross=on|off] [marks=on|off]"},
        {"slice axial a.png ", "[N] [zoom=fit|0.01..64] [replace=yes|no] [finished=yes|no]"},
        {"label 2 \"a", ""},
        {"label \"2\"", " NAME [#rrggbb] [number=N] [code=none|SCHEME:VALUE]"},
        {"\"seed\" ", "X,Y,Z LABEL " SEED_KEYS},
        {"\"seed", ""},
        {"run", " [for=QUESTION]"},
        {"quit", ""},
        {"quit ", ""},
        {"nonsense ", ""},
        {"# seed ", ""},
        {"seed \"1\"2 ", ""},
    };
    OWNED(buf_release) struct buf out = {0};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        buf_clear(&out);
        command_hint(&out, row[i][0], strlen(row[i][0]));
        if (strcmp(buf_text(&out), row[i][1]) != 0)
            printf("#   %s\n", row[i][0]);
        CHECK_TEXT(buf_text(&out), row[i][1]);
    }
}

/* ---- the door ---- */

static char journal_file[PATH_MAX];
static enum file_step failing_step;
static unsigned failed_steps;

static int fail_on_journal(enum file_step step, const char *path)
{
    if (step != failing_step || strcmp(path, journal_file) != 0)
        return 0;
    failed_steps++;
    return step == FILE_STEP_WRITE ? ENOSPC : EIO;
}

/* Deeds are lines to execute, with "; " between them. "~" comes before lines that change only the
 * view, whose records may be synced later, and " > FILE" after lines that write it. "@" is the
 * folder of the test. */
struct deed {
    char line[PATH_MAX + 64], file[64];
    bool only_looks;
};

/* Take the next deed at *cursor; false at the end. */
static bool next_deed(struct deed *deed, const char **cursor)
{
    const char *at = *cursor;
    OWNED(buf_release) struct buf line = {0}, file = {0};
    struct buf *to = &line;
    if (!*at)
        return false;
    for (deed->only_looks = *at == '~', at += *at == '~'; *at && *at != ';'; at++)
        if (strncmp(at, " > ", 3) == 0)
            to = &file, at += 2;
        else
            buf_add(to, *at == '@' ? folder : at, *at == '@' ? strlen(folder) : 1);
    *cursor = at + strspn(at, "; ");
    snprintf(deed->line, sizeof deed->line, "%s", buf_text(&line));
    snprintf(deed->file, sizeof deed->file, "%s", buf_text(&file));
    return true;
}

/* Check that a command whose record cannot be written changes nothing; then record it. */
static void fails_then_works(struct interpreter *interp, const struct deed *deed)
{
    static const enum file_step step[] = {FILE_STEP_WRITE, FILE_STEP_SYNC};
    const char *line = deed->line, *file = *deed->file ? deed->file : NULL;
    for (size_t i = 0; i < (deed->only_looks ? 1 : 2); i++) {
        struct snapshot before;
        take_snapshot(&before, interp);
        failing_step = step[i];
        failed_steps = 0;
        file_step_hook = fail_on_journal;
        enum err err = execute(interp, line);
        file_step_hook = NULL;
        CHECK(failed_steps > 0 && err == ERR_IO);
        CHECK_HAS(fault.text, "the command was undone because it could not be recorded");
        CHECK_HAS(fault.text, i == 0 ? "No space left on device" : "Input/output error");
        CHECK(is_plain(fault.text));
        is_as_before(&before, interp, line);
        if (file && !CHECK(!file_exists(place(file))))
            printf("#   %s is left by %s\n", file, line);
    }
    must(interp, line);
    if (file)
        CHECK(file_exists(place(file)));
    CHECK(interp->session->has_scene ? forest_check(interp->session->forest, NULL) : true);
    CHECK(journal_audit(interp->journal));
}

static void all_fail_then_work(struct interpreter *interp, const char *deeds)
{
    struct deed deed;
    while (next_deed(&deed, &deeds))
        fails_then_works(interp, &deed);
}

static void say_nothing(void *context, const char *text)
{
    struct buf *kept = context;
    buf_add_text(kept, text);
}

/* Replay the journal in another interpreter: the result is the same, or, with `words`, the error
 * about a file that was changed since. */
static void replay_tells(const char *words)
{
    OWNED(buf_release) struct buf told = {0};
    OWNED(interpreter_release) struct interpreter interp;
    const struct printer printer = {&told, say_nothing, say_nothing, NULL, NULL};
    begin_interpreter(&interp);
    fault = (struct fault){.text = ""};
    const enum err err = replay_aloud(&interp, journal_file, &printer, &fault);
    CHECK_WITH((err == OK) == !words, "%s", fault.text);
    buf_add_text(&told, fault.text);
    CHECK_HAS(buf_text(&told), words ? words : "");
}

static void journal_verifies(void)
{
    replay_tells(NULL);
}

/* ---- seeds out of files ---- */

/* Copy weights.nii with other scl_slope and scl_inter, given as the bytes of two floats. */
static void make_scaled(const char *name, const char scale[8])
{
    OWNED(buf_release) struct buf file = {0};
    CHECK(file_read(&file, place("weights.nii"), 1 << 20, NULL) == OK && file.length > 352);
    memcpy(file.data + 112, scale, 8);
    CHECK(file_write(place(name), file.data, file.length, FILE_REPLACE, NULL) == OK);
}

static void make_seed_files(void)
{
    make_weights("weights.nii", 0);
    make_weights("heavier.nii", 3);
    write_text("bright.csv", "11,10,9,1\n");
    write_text("seeds.csv", "x,y,z,label\n1,1,1,1\n# far\n10,9,8,cerebellum\n");
    write_text("names.txt", "7 spleen 16 32 48 0\n5 kidney\n");
    make_regions("regions.nii", size[0], 0);
}

static bool has_seed(const struct interpreter *interp, uint32_t x, uint32_t y, uint32_t z)
{
    const struct scene *scene = interp->session->scene;
    return scene->cell[grid_cell(&scene->grid, x, y, z)].flags & CELL_SEED;
}

SCENE_STORY(a_stroke_is_balls_along_a_line)
{
    must(interp, "seed 1,1,1 1 to=9,5,1; run");
    CHECK_INT(forest_seeds(interp->session->forest),
              9); /* one for each step along the longest axis */
    CHECK(has_seed(interp, 1, 1, 1) && has_seed(interp, 5, 3, 1) && has_seed(interp, 9, 5, 1));
    must(interp, "undo 2");
    must(interp, "seed 9,5,1 1 to=1,1,1 radius=1"); /* each voxel once, though balls overlap */
    must_leave_seeds(interp, "run", 47);
    CHECK(has_seed(interp, 5, 3, 2) && has_seed(interp, 10, 5, 1) && !has_seed(interp, 5, 3, 3));
    must(interp, "seed 3,3,3 2 to=3,3,3");
    CHECK_INT(session_pendings(interp->session), 1);
    CHECK(execute(interp, "seed 1,1,1 1 to=99,1,1") == ERR_INPUT);
}

SCENE_STORY(a_seed_that_is_erased_before_a_run_waits_no_more)
{
    must(interp, "seed 4,4,4 1; remove 4,4,4 of=tree");
    is_refused(interp, "remove 4,4,4 of=tree", "no tree holds this voxel: no seed reaches it");
    is_refused(interp, "remove 4,4,4", "no tree holds this voxel: no seed reaches it");
    must(interp, "seed 4,4,4 2");
    is_refused(interp, "remove 5,5,5", "seeds wait for `run`");
    must(interp, "remove 4,4,4 of=tree");
}

SCENE_STORY(seeds_are_read_from_files)
{
    make_seed_files();
    MUST_RECORD(interp, "seed-file seeds.csv", "added=2 marker=1-2 forest=");
    CHECK_HAS(buf_text(&reply.words), " pending=2");
    must_leave_seeds(interp, "run", 2);
    const uint32_t cell = grid_cell(&interp->session->scene->grid, 10, 9, 8);
    CHECK_INT(interp->session->scene->cell[cell].label, 2);
    must(interp, "seed-file seeds.csv label=7; run");
    CHECK_INT(interp->session->scene->cell[cell].label, 7);
    must(interp, "seed-file regions.nii"); /* four of twelve columns each */
    CHECK_HAS(buf_text(&reply.words), "added=880 marker=4-5 forest=");
    must(interp, "seed-file regions.nii erode=1 regions=2");
    CHECK_TEXT(buf_text(&reply.canonical), "seed-file regions.nii regions=2 erode=1");
    CHECK_HAS(buf_text(&reply.words), "added=144 marker=6 forest="); /* 2 x 9 x 8 */
    MUST_RECORD(interp, "seed-file regions.nii each=5 label=cerebellum",
                "added=10 marker=7-8 forest=");
    must(interp, "run");
    CHECK(forest_check(interp->session->forest, NULL));
}

SCENE_STORY(a_seed_file_that_is_wrong_plants_nothing)
{
    static const char *const row[][2] = {
        {"seed-file elsewhere.csv", "there is no file elsewhere.csv here; nothing has changed"},
        {"seed-file bad.csv", "bad.csv: line 3: 12,1,1 is outside the scene"},
        {"seed-file seeds.csv each=2", "are for label maps, and seeds.csv is a list"},
        {"seed-file seeds.csv regions=1-2", "are for label maps"},
        {"seed-file narrow.nii", "the map has 9x11x10 voxels and the scene 12x11x10"},
        {"seed-file regions.nii regions=3-9", "the map has no voxel of regions 3-9"},
        {"seed-file regions.nii erode=2", "erode=2 leaves no voxel of regions 1-65533"},
        {"seed-file bad.csv.nii", "there is no file"},
        {"seed-file text.nii", "text.nii: "},
        {"seed-file regions.nii erode=10", "erode: expected a number 0..9"},
        {"seed-file regions.nii each=0", "each: expected a number 1..100000"},
        {"seed-file regions.nii regions=2-1",
         "regions: expected A-B, or A, within 0-4294967295, not 2-1"},
        {"seed-file regions.nii regions=1-", "regions: expected A-B"},
        {"seed-file regions.nii regions=-1", "regions: expected A-B"},
        {"seed-file regions.nii regions=1-4294967296", "regions: expected A-B"},
        {"seed-file regions.nii regions=", "not nothing"},
        {"seed-file regions.nii label=256", "label: expected a label 0..255"},
    };
    make_seed_files();
    make_regions("narrow.nii", 9, 0);
    write_text("bad.csv", "1,1,1,1\n2,2,2,2\n12,1,1,1\n");
    write_text("text.nii", "1,1,1,1\n");
    must(interp, "seed 5,5,5 1");
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++)
        is_refused(interp, row[i][0], row[i][1]);
}

/* Begin a new journal. Steps on its file fail while fail_on_journal is the hook. */
static void begin_recording(struct interpreter *interp, const char *name)
{
    snprintf(journal_file, sizeof journal_file, "%s", place(name));
    begin_interpreter(interp);
    CHECK(interpreter_create_journal(interp, journal_file, &fault) == OK);
}

STORY(a_replay_detects_a_changed_seed_file)
{
    struct interpreter interp;
    make_seed_files();
    begin_recording(&interp, "files.iftty");
    must(&interp, "open scene.nii; label 2 cerebellum; seed-file seeds.csv; "
                  "seed-file regions.nii each=3 erode=1 generator=5; run");
    interpreter_release(&interp);
    journal_verifies();
    write_text("seeds.csv", "10,9,8,2\n1,1,1,1\n"); /* the same seeds */
    journal_verifies();
    write_text("seeds.csv", "10,9,8,2\n1,1,2,1\n");
    replay_tells("file is ");
    make_seed_files();
    make_regions("regions.nii", size[0], 1);
    replay_tells("file is ");
    CHECK(unlink(place("regions.nii")) == 0);
    replay_tells("there is no file regions.nii next to the journal or among the scenes");
    make_seed_files();
    journal_verifies();
}

STORY(a_command_that_cannot_be_recorded_is_undone)
{
    static const char before[] = "~auto on; ~auto off; label 4 liver #102030; open @/scene.nii";
    static const char deeds[] =
        "label 2 cerebellum code=SCT:113305005:Cerebellum; label 2 cerebellum code=none; label 0 "
        "nothing #010203; label-file @/names.txt; weight morph; adjacency 26; adjacency 6; seed "
        "1,1,1 1; seed 10,9,8 2 radius=1; run; seed-file "
        "@/seeds.csv; seed-file @/regions.nii label=4 erode=1 each=2; seed 5,5,5 3; remove 5,5,5; "
        "seed 6,2,7 0; save border @/b.nii > b.nii; weight gauss 1.5; adjacency 26; weight sobel; "
        "weight morph radius=2; weight @/weights.nii; weight @/heavier.nii; adjacency 6; weight "
        "difference; adjacency 26; polarity 4 50; weight polarity; polarity 4 -50; polarity 2 100; "
        "weight @/heavier.nii; weight sobel; mask @/regions.nii regions=0-2; remove 6,2,7; range 0 "
        "290.5; run; mask @/regions.nii; range none; weight polarity; mask none; ~size 40 30; "
        "render; render mode=ii; ~size 33 32; render mode=bp; ~view left; render mode=ray; ~turn "
        "10 -5; ~zoom 2; render mode=sp; weight gauss 0.5; ~zoom fit; ~pan 3.5 -1; render; ~focus "
        "2,3,4; hide 2; render; show 2; render; hide all; show 3; render; show all; render; "
        "opacity 2 40; render; ~samples 2; render mode=sp; seed 8,8,2 1; run; render mode=ray; "
        "~samples 1; opacity all 70; clip axial 1-8; render; plane 6,4,3; cut 0,0,0 5,5,5; render "
        "mode=ray; plane 6,5,4 normal=1,-0.5,2 offset=1.5; render; ~focus scene; cut none; render; "
        "clip sagittal 3-10; seed 9,9,3 5; run; plane none; render; opacity 2 0; clip none; label "
        "1 heart #ff0000; ~shade cubes; render; ~light 20 40.5; ~cue 60; ~edges on; ~decorate "
        "scale; ~samples 2; ~background #405060; ~context mip; render; ~shade surface; render "
        "mode=sp; render @/p.exr > p.exr; render @/p.png > p.png; spin 3 @/s%d.png > s2.png; spin "
        "3 @/s.gif > s.gif; save labels @/l.nii.gz > l.nii.gz; golden first > "
        "door.golden/first.exr; golden second > door.golden/second.png; ~cross 3,4,5; ~window 10 "
        "90.5; mosaic; ~window auto; ~overlay tint marks=off; slice sagittal; slice coronal 2 "
        "@/s.png > s.png; slice axial @/s.exr zoom=3 > s.exr; ~overlay none words=off cross=off "
        "marks=on; ~hint 1; mosaic @/m.exr > m.exr; golden third of=sagittal > "
        "door.golden/third.exr; golden fourth of=mosaic > door.golden/fourth.png; seed 3,3,3 4; "
        "render mode=bp; ~auto on; seed 7,3,3 5; seed 7,3,3 6; seed 8,8,8 liver radius=2; remove "
        "1,1,1; adjacency 6; render; seed 2,8,1 3; ~view 30 20 10; run; undo; undo 7; redo 3; "
        "branch other; seed 4,4,4 2; seed 5,5,5 2 radius=1.7mm range=20..190.5 to=6,6,6 to=6,8,6; "
        "seed 6,8,6 2 to=2,2,2 to=7,2,9 joined=yes; remove 7,2,9; box 1,1,1 3,4,1 5 "
        "range=-10..9999; fill 8,1,3 6 to=11,1,9 to=8,1,9; outline 2,7,3 6 to=5,7,3 to=2,7,5 "
        "ring=1; undo; mask @/regions.nii regions=0-2; goto main; render; goto 30; goto other; "
        "undo 44; render; redo 12; ~magnify 2.5 at=3,4,5; finish majority; finish components "
        "voxels=9 label=2; save labels @/f.nii finished=yes > f.nii; render finished=yes; mosaic "
        "finished=yes; slice axial @/fs.exr finished=yes > fs.exr; golden fifth finished=yes > "
        "door.golden/fifth.exr; ~finished on; render; seed 3,7,7 4; mosaic; undo; golden sixth "
        "of=sagittal > door.golden/sixth.exr; finish none; object 2 threshold 0..90 from=3,3,3; "
        "fill 1,1,2 4 to=4,1,2 to=4,4,2 within=0; "
        "fill 2,2,6 4 to=6,2,6 to=6,6,6 within=0; between 4 over=0-6; "
        "labels @/regions.nii erode=1 > "
        "door.golden/labels-adf152d6330b2c5f3d6197c6a06ac573.nii.gz; orient sform; landmark AC "
        "3,4,5; landmark PC 3,2,5; landmark AC none; weight morph; channel @/regions.nii "
        "percent=200; ~show-channel 2; channel 2 remove=yes; origin "
        "74120d6c3f0cc54e2237dc0bced98ab5 "
        "volumes=1:900";
    OWNED(interpreter_release) struct interpreter interp;
    struct snapshot end, again;
    OWNED(buf_release) struct buf told = {0};
    begin_recording(&interp, "door.iftty");
    all_fail_then_work(&interp, before);
    all_fail_then_work(&interp, deeds);
    take_snapshot(&end, &interp);
    interpreter_release(&interp);
    for (unsigned i = 0; i < command_count(); i++) { /* all recorded commands are among them */
        const char *name = command_at(i)->name;
        bool is_there = !(command_at(i)->flags & COMMAND_RECORDED) || strcmp(name, "open") == 0 ||
                        strcmp(name, "interpolate") == 0; /* in a story of its own */
        struct deed deed;
        for (const char *at = deeds; next_deed(&deed, &at);)
            is_there |= strncmp(deed.line, name, strlen(name)) == 0;
        CHECK_WITH(is_there, "%s", name);
    }
    begin_interpreter(&interp); /* resuming gives the same session */
    if (!CHECK(interpreter_resume_journal(&interp, journal_file, &told, &fault) == OK))
        printf("#   %s\n", fault.text);
    take_snapshot(&again, &interp);
    again.rendered = end.rendered, again.picture = end.picture;
    CHECK(is_same_kept(&again.kept, &end.kept)); /* maps have other addresses */
    again.kept = end.kept;
    CHECK(memcmp(&again, &end, sizeof end) == 0);
}

/* Write the scene with voxels of this length. */
static void make_long(const char *name, double z_mm)
{
    const double spacing[3] = {1, 1, z_mm};
    struct geometry geometry = {.slope = 1,
                                .spacing_nm = {1000000, 1000000, (uint32_t)(z_mm * 1e6)}};
    geometry_place_plain(&geometry, spacing);
    CHECK(volume_write(place(name), FILE_REPLACE,
                       &(struct volume_map){size, &geometry, VOXEL_UINT8, "test", scene_row, NULL,
                                            NULL, NULL, NULL},
                       NULL, NULL) == OK);
}

STORY(zoom_fit_works_for_any_samples)
{
    static const char *const open[] = {"open synth:geom:1x1x1", "open synth:geom:3x2x1",
                                       "open long.nii"};
    make_long("long.nii", 90);
    for (size_t i = 0; i < sizeof open / sizeof open[0]; i++) {
        OWNED(interpreter_release) struct interpreter interp;
        begin_interpreter(&interp);
        must(&interp, open[i]);
        must(&interp, "size 1000 1000; samples 4; zoom fit; samples 1");
        must(&interp, "zoom fit"); /* may be larger now */
        must(&interp, "render");
    }
}

BEGUN_STORY(voxels_too_long_for_any_picture_are_rejected, begin_interpreter)
{
    make_long("needles.nii", 3000);
    must(interp, "open needles.nii");
    interpreter_release(interp);
    begin_interpreter(interp);
    OWNED(buf_release) struct buf file = {0};
    const float thin = 0.1f;
    CHECK(file_read(&file, place("needles.nii"), 1 << 20, NULL) == OK);
    memcpy(file.data + 80, &thin, 4); /* pixdim[1] */
    CHECK(file_write(place("needles.nii"), file.data, file.length, FILE_REPLACE, NULL) == OK);
    CHECK(execute(interp, "open needles.nii") == ERR_LIMIT);
    CHECK_TEXT(fault.text, "voxels of 0.1x1x3000 mm are too long for their width: no picture could "
                           "show them; nothing was opened");
    CHECK(!interp->session->has_scene);
}

SCENE_STORY(a_replaced_file_is_restored)
{
    OWNED(buf_release) struct buf former = {0}, now = {0};
    snprintf(journal_file, sizeof journal_file, "%s", place("replaced.iftty"));
    failing_step = FILE_STEP_SYNC;
    CHECK(interpreter_create_journal(interp, journal_file, &fault) == OK);
    must(interp, "seed 1,1,1 1; save labels replaced.nii");
    CHECK(file_read(&former, "replaced.nii", 1 << 20, NULL) == OK);
    must(interp, "seed 1,1,1 2");
    for (int tries = 0; tries < 2; tries++) {
        file_step_hook = tries == 0 ? fail_on_journal : NULL;
        CHECK_INT(execute(interp, "save labels replaced.nii replace=yes"), tries ? OK : ERR_IO);
        file_step_hook = NULL;
        CHECK(file_read(&now, "replaced.nii", 1 << 20, NULL) == OK);
        bool same = now.length == former.length && memcmp(now.data, former.data, now.length) == 0;
        CHECK(same == (tries == 0));
    }
    CHECK(system("ls -A | grep -q ^.iftty-") != 0); /* no backup is left */
}

STORY(a_replay_gives_the_recorded_results)
{
    struct interpreter interp;
    begin_recording(&interp, "replay.iftty");
    static const char deeds[] =
        "open scene.nii; seed 1,1,1 1; seed 10,9,8 2; run; ~size 32 32; adjacency 26; remove "
        "1,1,1; weight sobel; ~auto on; weight gauss 2; seed 2,2,2 7 radius=2; weight weights.nii; "
        "mask regions.nii regions=0-2; weight polarity; polarity 7 -40; range -5 220.125; "
        "adjacency 6; golden third > replay.golden/third.exr; remove 2,2,2; ~auto off; seed 5,6,7 "
        "2; remove 9,9,9; ~cross 5,6,7; ~overlay tint; golden waiting of=axial > "
        "replay.golden/waiting.exr; golden waiting-too of=mosaic > replay.golden/waiting-too.exr; "
        "run; slice coronal 3 zoom=5; golden near of=coronal > replay.golden/near.exr; seed 8,6,7 "
        "2; why 8,6,7; seed 8,6,8 2; golden applied of=coronal > replay.golden/applied.exr";
    all_fail_then_work(&interp, deeds);
    interpreter_release(&interp);
    journal_verifies();
}

STORY(an_interpolated_scene_is_the_same_when_replayed)
{
    struct interpreter interp;
    static const char deeds[] =
        "open scene.nii; ~size 8 8; interpolate 1 1 2; ~size 32 32; render; hide 3; weight morph "
        "radius=2; range 0 211; interpolate 2 1 1; interpolate 1 1 1; seed 1,1,1 1; seed 21,9,17 "
        "2; weight sobel; run; golden finer > finer.golden/finer.exr; golden slice of=sagittal > "
        "finer.golden/slice.exr";
    begin_recording(&interp, "finer.iftty");
    all_fail_then_work(&interp, deeds);
    is_refused(&interp, "interpolate 2 2 2", "a scene is interpolated before its first seed");
    interpreter_release(&interp);
    journal_verifies();
}

/* Random edits fail at random: the journal alone determines the session. */
STORY(random_edits_fail_at_random)
{
    struct interpreter interp;
    char line[128];
    static const char *const forms[] = {
        "remove X,Y,Z",
        "run",
        "auto [on|off]",
        "render mode=[ii|bp]",
        "[hide <1-4>|show <1-4>|hide <1-4>|show <1-4>|opacity <1-4> 0|opacity <1-4> 25|"
        "opacity <1-4> 50|opacity <1-4> 75|opacity <1-4> 100]",
        "adjacency [6|26]",
        "weight [morph|morph radius=3|sobel|gauss 0.75|difference|polarity|weights.nii|"
        "heavier.nii]",
        "polarity <5> [-|]<101>",
        "[mask none|mask regions.nii|mask regions.nii regions=0-1|"
        "mask weights.nii regions=10-39|range none|range 20 90|range 40 300]",
        "[slice axial 3|slice coronal zoom=4|slice sagittal 5 zoom=fit|mosaic|window 20 99.5|"
        "overlay contour|overlay tint marks=on]",
        "[undo|undo|redo] <1-4>",
        "[branch|goto] b<9>",
        "goto",
        "seed X,Y,Z <5> radius=[0|0|0|0|0|0|0|1]"};
    enum { FORMS = sizeof forms / sizeof *forms };
    unsigned undone = 0;
    seed = 3;
    begin_recording(&interp, "random.iftty");
    must(&interp, "open scene.nii; size 24 24");
    for (unsigned i = 0; i < 600 && check_failures < 5; i++) {
        struct snapshot before;
        const uint32_t which = below(18); /* five of them plant seeds */
        random_command(line, sizeof line, forms[which < FORMS ? which : FORMS - 1], size, &seed);
        if (strcmp(line, "goto") == 0)
            snprintf(line, sizeof line, "goto %u", 1 + below(i));
        if (session_pendings(interp.session) > 48)
            snprintf(line, sizeof line, "run");
        take_snapshot(&before, &interp);
        failing_step = below(2) ? FILE_STEP_WRITE : FILE_STEP_SYNC;
        file_step_hook = below(2) ? fail_on_journal : NULL;
        enum err err = execute(&interp, line);
        file_step_hook = NULL;
        undone += err == ERR_IO;
        if (err)
            is_as_before(&before, &interp, line);
    }
    CHECK(undone > 90 && journal_audit(interp.journal));
    interpreter_release(&interp);
    journal_verifies();
}

/* ---- weights and regions of interest ---- */

static const struct cell *cell_at(const struct interpreter *interp, uint32_t x, uint32_t y,
                                  uint32_t z)
{
    const struct scene *scene = interp->session->scene;
    return scene->cell + grid_cell(&scene->grid, x, y, z);
}

SCENE_STORY(weights_are_read_from_a_file)
{
    must(interp, "seed 1,1,1 1; seed 10,9,8 2; run; weight morph radius=2");
    const uint64_t morph = forest_digest(interp->session->forest);
    MUST_RECORD(interp, "weight weights.nii", "weights=");
    CHECK_INT(cell_at(interp, 3, 4, 5)->weight, (21 + 20 + 15) % 40);
    CHECK(forest_digest(interp->session->forest) != morph);
    MUST_MENTION(interp, "info", "weight of weights.nii\n");
    MUST_MENTION(interp, "why 3,4,5", "weight 16, ");
    must(interp, "adjacency 26"); /* the weights do not change */
    CHECK_INT(cell_at(interp, 3, 4, 5)->weight, 16);
    must(interp, "weight difference; adjacency 6; weight morph radius=2");
    CHECK(forest_digest(interp->session->forest) == morph);
    make_weights("heaviest.nii", 65535 - 39);
    must(interp, "weight heaviest.nii");
    CHECK_INT(cell_at(interp, 0, 0, 0)->weight, 65535 - 39);
}

SCENE_STORY(weights_of_steps_go_by_both_ends)
{
    MUST_MENTION(interp, "seed 0,0,0 1; auto on; weight difference; info", "weight difference\n");
    CHECK_INT(key_cost(cell_at(interp, 5, 0, 0)->key), 3); /* 3 a step along x */
    CHECK_INT(key_cost(cell_at(interp, 6, 0, 0)->key), 63);
    MUST_MENTION(interp, "why 5,0,0", "intensity 15, a step of weight 3, label 1");
    MUST_MENTION(interp, "polarity 1 50", "used only under `weight polarity`");
    CHECK_INT(key_cost(cell_at(interp, 6, 0, 0)->key), 63);
    must(interp, "weight polarity");
    CHECK_INT(key_cost(cell_at(interp, 6, 0, 0)->key), 31); /* up to brighter: half */
    must(interp, "polarity 1 -50");
    CHECK(strstr(buf_text(&reply.text), "used only") == NULL);
    CHECK_INT(key_cost(cell_at(interp, 6, 0, 0)->key), 94);
    MUST_MENTION(interp, "stats", "weight polarity 1:-50\n");
    must(interp, "seed 0,0,0 cerebellum"); /* another label, whose polarity is 0 */
    CHECK_INT(key_cost(cell_at(interp, 6, 0, 0)->key), 63);
    CHECK(forest_check(interp->session->forest, NULL));
}

SCENE_STORY(trees_stay_in_the_region_of_interest)
{
    must(interp, "auto on; seed 1,1,1 1; mask regions.nii"); /* columns 0..3 and 8..11 */
    CHECK_HAS(buf_text(&reply.words), "file=");
    CHECK_HAS(buf_text(&reply.words), " inside=880 forest=");
    CHECK_INT(cell_at(interp, 3, 5, 5)->label, 1);
    CHECK(!cell_is_reached(cell_at(interp, 4, 5, 5)) && !cell_is_reached(cell_at(interp, 8, 5, 5)));
    MUST_MENTION(interp, "info", "region    mask regions.nii regions 1-65533: 880 of 1320");
    MUST_MENTION(interp, "why 4,5,5", "outside the region of interest");
    MUST_RECORD(interp, "range 0 20", "fence=");
    CHECK(!cell_is_reached(cell_at(interp, 3, 10, 5)));
    MUST_MENTION(interp, "stats", "mask regions.nii regions 1-65533, range 0..20: ");
    MUST_MENTION(interp, "seed 3,1,1 1 radius=2", "left out, outside the region of interest: ");
    is_refused(interp, "seed 5,5,5 2", "outside the region of interest, where no tree grows");
    is_refused(interp, "seed-file bright.csv", "nothing was planted");
    MUST_RECORD(interp, "seed-file seeds.csv", "added=1 ");
    CHECK_HAS(buf_text(&reply.text), "left out, outside the region of interest: 1 voxel\n");
    is_refused(interp, "remove 5,5,5", "no seed reaches it");
    MUST_RECORD(interp, "range none; mask none", "fence=0000000000000000 inside=1320 ");
    CHECK_INT(cell_at(interp, 11, 10, 9)->label, 1);
    must(interp, "info");
    CHECK(strstr(buf_text(&reply.text), "region") == NULL);
}

SCENE_STORY(a_roi_is_refused_that_leaves_seeds_outside)
{
    must(interp, "seed 5,5,5 1");
    is_refused(interp, "mask regions.nii", "0 planted and 1 pending seeds would be outside");
    must(interp, "remove 5,5,5; seed 6,5,5 1; remove 6,5,5");
    must(interp, "mask regions.nii"); /* none of them would be planted */
    must(interp, "run; mask none; seed 5,5,5 1; run; seed 6,5,5 1; seed 6,5,5 2");
    is_refused(interp, "mask regions.nii", "1 planted and 1 pending seeds would be outside");
    is_refused(interp, "range 0 10", "remove them and run first; nothing has changed");
    is_refused(interp, "range 900 1000", "no voxel of the scene would be inside");
    is_refused(interp, "mask regions.nii regions=7", "no voxel of the scene would be inside");
    must(interp, "mask regions.nii regions=0; run");
    CHECK_INT(cell_at(interp, 7, 0, 0)->label, 2);
}

SCENE_STORY(a_roi_or_weights_that_are_wrong_change_nothing)
{
    static const char *const row[][2] = {
        {"mask elsewhere.nii", "there is no file elsewhere.nii here; nothing has changed"},
        {"mask narrow.nii", "narrow.nii: the map has 9x11x10 voxels and the scene 12x11x10"},
        {"mask seeds.csv", "seeds.csv: "},
        {"mask", "missing: FILE; usage: mask none|FILE [regions=A-B]"},
        {"mask none regions=1", "regions: `mask none` has no regions"},
        {"weight narrow.nii", "narrow.nii: the map has 9x11x10 voxels"},
        {"weight wide.nii",
         "wide.nii: voxel 0,0,0 of the map holds 65536; weights are whole numbers"},
        {"weight half.nii",
         "half.nii: voxel 1,0,0 of the map holds 3.5; weights are whole numbers"},
        {"mask half.nii", "half.nii: voxel 1,0,0 of the map holds 3.5; regions are whole numbers"},
        {"weight seeds.csv", "seeds.csv: "},
        {"weight weights.nii radius=2", "radius: `weight FILE` has none"},
        {"weight weights.nii 1", "SIGMA: `weight FILE` has none"},
        {"weight difference radius=1", "radius: `weight difference` has none"},
        {"weight", "missing: FILE"},
        {"polarity 1", "missing: PERCENT"},
        {"polarity 1 101", "PERCENT: expected a number -100..100, not 101"},
        {"polarity liver 5", "LABEL: expected a label 0..255"},
        {"range 5", "expected LOW and HIGH, 2:LOW..HIGH, or none alone"},
        {"range none 5", "expected LOW and HIGH, 2:LOW..HIGH, or none alone"},
        {"range 5 4.999", "HIGH is below LOW"},
        {"range low 5",
         "LOW: expected none or LOW..HIGH, as in 40..1200.5, or 2:LOW..HIGH of channel 2, of at "
         "most 19 digits each"},
        {"range 1.5e 5", "LOW: expected none or LOW..HIGH"},
        {"range 1 99999999999999999999", "of at most 19 digits, not 99999999999999999999"},
    };
    make_regions("narrow.nii", 9, 0);
    make_scaled("wide.nii", "\0\0\x80\x3f\0\0\x80\x47"); /* 1 and 65536 */
    make_scaled("half.nii", "\0\0\0\x3f\0\0\0\0");       /* 0.5 and 0 */
    must(interp, "seed 1,1,1 1; run; weight weights.nii; mask regions.nii");
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++)
        is_refused(interp, row[i][0], row[i][1]);
}

STORY(a_replay_detects_changed_weights_and_masks)
{
    struct interpreter interp;
    make_seed_files();
    begin_recording(&interp, "maps.iftty");
    must(&interp, "open scene.nii; weight weights.nii");
    must(&interp, "range 0 9"); /* so that the range hides later effects of the mask */
    must(&interp, "mask regions.nii");
    interpreter_release(&interp);
    journal_verifies();
    make_regions("regions.nii", size[0], 253); /* 255 is 1 and above too */
    journal_verifies();
    make_regions("regions.nii", size[0], 254); /* 256 is 0 */
    replay_tells("file is ");
    CHECK(unlink(place("regions.nii")) == 0);
    replay_tells("there is no file regions.nii next to the journal or among the scenes");
    make_seed_files();
    make_weights("weights.nii", 1);
    replay_tells("weights is ");
    make_seed_files();
    journal_verifies();
}

/* A watch that stops at the look of this number and at all later ones, like Ctrl-C. */
struct looks {
    unsigned count, stop_at;
};

static bool after_some_polls(void *context, const char *what, uint64_t done, uint64_t total)
{
    struct looks *looks = context;
    CHECK(!what || !total || done <= total);
    return looks->count++ >= looks->stop_at;
}

static void begin_interesting_work(struct interpreter *interp)
{
    begin_interpreter(interp);
    must(interp, "open synth:geom:40x32x32; size 64 64; seed 20,16,16 1 radius=2; seed 1,1,1 2; "
                 "render; remove 1,1,1");
}

/* Count the looks at the watch during a command on a new session; then begin again. */
static unsigned looks_of(struct interpreter *interp, const char *line)
{
    struct looks looks = {0, UINT32_MAX};
    struct watch watch = {.context = &looks, .poll = after_some_polls};
    interpreter_release(interp);
    begin_interesting_work(interp);
    interp->session->watch = &watch;
    CHECK_INT(execute(interp, line), OK);
    interpreter_release(interp);
    begin_interesting_work(interp);
    return looks.count;
}

/* Return looks further and further apart, then each of the last ones. */
static unsigned next_look(unsigned at, unsigned *step, unsigned total)
{
    const unsigned last = total > 8 ? total - 8 : 0;
    if (at >= last)
        return at + 1;
    at += *step;
    *step *= 4;
    return at < last ? at : last;
}

/* Stop a command at looks below `total`; return the number of stops. */
static unsigned stop_everywhere(struct interpreter *interp, const char *line, unsigned total,
                                const struct snapshot *before)
{
    struct looks looks;
    struct watch watch = {.context = &looks, .poll = after_some_polls};
    unsigned stopped = 0;
    for (unsigned at = 0, step = 1; at < total; at = next_look(at, &step, total), stopped++) {
        looks = (struct looks){0, at};
        interp->session->watch = &watch;
        CHECK_INT(execute(interp, line), ERR_CANCELLED);
        interp->session->watch = NULL;
        CHECK_TEXT(fault.text, "cancelled; nothing has changed");
        is_as_before(before, interp, line);
    }
    return stopped;
}

/* A command is undone wherever it is stopped. */
BEGUN_STORY(a_command_that_is_cancelled_is_undone, begin_interesting_work)
{
    static const char lines[] =
        "adjacency 26; run; render; render mode=sp; weight sobel; weight gauss 2; hide 1; "
        "plane 20,16,16; cut 4,4,4 30,30,30; weight polarity; save cost x.nii replace=yes; "
        "range 0 300; undo 3; seed 4,4,4 1 radius=4 to=30,30,30 to=4,30,4; box 1,1,1 30,30,30 2; "
        "fill 1,1,5 1 to=30,1,5 to=15,30,5; outline 4,1,4 1 to=4,30,2 to=4,15,30; mosaic";
    static const char *const picture[] = {"render mode=sp", "render mode=bp", "render mode=ray"};
    OWNED(buf_release) struct buf line = {0};
    struct snapshot before;
    unsigned cancelled = 0;
    take_snapshot(&before, interp);
    for (const char *at = lines; next_line(&line, &at);)
        cancelled +=
            stop_everywhere(interp, buf_text(&line), looks_of(interp, buf_text(&line)), &before);
    CHECK(cancelled > 60);
    must(interp, "run; render");
    take_snapshot(&before, interp);
    for (size_t i = 0; i < sizeof picture / sizeof picture[0]; i++) /* with nothing else to do */
        CHECK(stop_everywhere(interp, picture[i], 1, &before) == 1);
    CHECK(forest_check(interp->session->forest, NULL));
    CHECK(border_check(&interp->session->border, NULL));
}

/* Stop a command at looks further and further apart until it succeeds; return the number of
 * stops. */
static unsigned stop_until_done(struct interpreter *interp, const char *line)
{
    struct snapshot before;
    unsigned cancelled = 0;
    enum err err = ERR_CANCELLED;
    take_snapshot(&before, interp);
    for (unsigned at = 0; err == ERR_CANCELLED; at += 1 + at / 4) {
        struct looks looks = {0, at};
        struct watch watch = {.context = &looks, .poll = after_some_polls};
        interp->session->watch = &watch;
        err = execute(interp, line);
        interp->session->watch = NULL;
        if (err)
            is_as_before(&before, interp, line);
        cancelled += err == ERR_CANCELLED;
    }
    CHECK_INT(err, OK);
    return cancelled;
}

BEGUN_STORY(interpolation_that_is_cancelled_is_undone, begin_interpreter)
{
    must(interp, "open synth:geom:120x100x90; range 0 300; render mode=sp");
    CHECK(stop_until_done(interp, "interpolate 2 1 1") > 5);
    CHECK_INT(interp->session->scene->grid.size[0], 239);
}

STORY(opening_that_is_cancelled_opens_nothing)
{
    static const char *const line[] = {"open synth:geom:120x100x90", "open synth:geom:211",
                                       "open scene.nii"};
    for (size_t i = 0; i < sizeof line / sizeof line[0]; i++) {
        OWNED(interpreter_release) struct interpreter interp;
        begin_interpreter(&interp);
        CHECK(stop_until_done(&interp, line[i]) > 0 && interp.session->has_scene);
    }
}

SCENE_STORY(weights_are_named_and_stay_without_memory)
{
    struct snapshot before;
    MUST_MENTION(interp, "seed 1,1,1 1; weight sobel; run; info", "weight sobel\n");
    take_snapshot(&before, interp);
    allow_allocations(0);
    CHECK(execute(interp, "weight gauss 1.5") == ERR_MEMORY);
    mem_allows = NULL;
    is_as_before(&before, interp, "weight gauss 1.5");
    MUST_RECORD(interp, "weight gauss 1.5", "weights=");
    CHECK_HAS(buf_text(&reply.words), " forest=");
    MUST_MENTION(interp, "info", "weight gauss 1.5\n");
    MUST_MENTION(interp, "weight morph radius=3; info", "weight morph radius=3\n");
}

/* ---- without memory ---- */

/* Let the first allocation fail, then the second one, and so on, until the command succeeds. */
static void fails_at_every_allocation(struct interpreter *interp, const char *line,
                                      const char *kept)
{
    OWNED(buf_release) struct buf former = {0}, now = {0};
    const unsigned files = count_names(folder, ""); /* with drafts and backups */
    enum err err = ERR_MEMORY;
    CHECK(files > 0 && (!kept || file_read(&former, place(kept), 1 << 20, NULL) == OK));
    for (unsigned n = 0; n < 400 && err && check_failures < 5; n++) {
        struct snapshot before;
        const unsigned failures = check_failures;
        take_snapshot(&before, interp);
        allow_allocations(n);
        err = execute(interp, line);
        mem_allows = NULL;
        if (!err)
            break;
        CHECK((err == ERR_MEMORY || strstr(fault.text, strerror(ENOMEM))) && is_plain(fault.text));
        is_as_before(&before, interp, line);
        CHECK_INT(count_names(folder, ""), files);
        CHECK(!kept ||
              (file_read(&now, place(kept), 1 << 20, NULL) == OK && now.length == former.length &&
               memcmp(now.data, former.data, now.length) == 0));
        if (check_failures > failures)
            printf("#   allocation %u of %s: %s\n", n, line, fault.text);
    }
    CHECK(err == OK);
}

SCENE_STORY(pictures_without_memory_leave_everything_as_it_was)
{
    static const char row[] =
        "render mode=bp; render @/old.png replace=yes > old.png; render @/old.exr replace=yes > "
        "old.exr; render @/new.exr; spin 3 @/old.gif replace=yes > old.gif; spin 3 @/old%d.png "
        "replace=yes > old1.png; spin 3 @/new%d.exr; slice axial 3 @/old.png replace=yes > "
        "old.png; mosaic @/old.exr replace=yes > old.exr; mosaic; save labels @/old.nii.gz "
        "replace=yes > old.nii.gz; golden bright; golden dark of=mosaic; clip axial 2-5; plane "
        "3,3,3; samples 2; background white; decorate all; shade surface; mosaic @/small.png; "
        "render";
    static const char *const before[] = {"old.png",  "old.exr",  "old.gif",   "old0.png",
                                         "old1.png", "old2.png", "old.nii.gz"};
    CHECK(interpreter_create_journal(interp, place("poor.iftty"), &fault) == OK);
    for (size_t i = 0; i < sizeof before / sizeof before[0]; i++)
        CHECK(file_write(place(before[i]), before[i], 3, FILE_REPLACE, NULL) == OK);
    CHECK(file_make_folder(place("poor.golden"), NULL) == OK);
    must(interp, "seed 3,3,3 1 radius=2; seed 0,0,0 0; run; size 40 30");
    struct deed deed;
    for (const char *at = row; !check_failures && next_deed(&deed, &at);)
        fails_at_every_allocation(interp, deed.line, *deed.file ? deed.file : NULL);
}

/* Execute lines, the last of which has these words in its record. */
static void is_recorded_as(struct interpreter *interp, const char *lines, const char *words)
{
    must(interp, lines);
    CHECK_TEXT(buf_text(&reply.words), words);
}

/* Execute lines and copy the words of the last record. */
static void record_of(char out[128], struct interpreter *interp, const char *line)
{
    must(interp, line);
    snprintf(out, 128, "%s", buf_text(&reply.words));
}

SCENE_STORY(opacity_is_a_setting_of_the_segmentation_and_one_picture_in_every_mode)
{
    char opaque[128], words[128];
    record_of(opaque, interp, "seed 1,1,1 1; seed 10,9,8 2; view 30 20; render");
    record_of(words, interp, "opacity 1 40; render");
    CHECK(strcmp(words, opaque) != 0);
    static const char *const mode[] = {"render mode=sp", "render mode=bp", "render mode=ray",
                                       "render mode=ii"};
    for (size_t i = 0; i < sizeof mode / sizeof *mode; i++)
        is_recorded_as(interp, mode[i], words);
    MUST_MENTION(interp, "info", "opacity   100 %, 40 % of label 1\n");
    MUST_MENTION(interp, "stats", ", opacity 40 %\n");
    is_recorded_as(interp, "opacity all 100; render", opaque);
    must(interp, "info");
    CHECK(strstr(buf_text(&reply.text), "opacity") == NULL);
    is_recorded_as(interp, "undo; render", words);
    must(interp, "opacity 1 0"); /* as hidden, in renditions alone */
    record_of(words, interp, "render");
    is_recorded_as(interp, "undo; hide 1; render", words);
    is_refused(interp, "opacity 1 101", "expected a number 0..100");
    is_refused(interp, "opacity 0 50", "expected all, a label 1..255");
}

/* The same for edits. Without memory the forest cannot be restored at once: seeds and settings are,
 * and the next command restores the rest. */
static void grows_anew_after_every_failure(struct interpreter *interp, const char *line)
{
    enum err err = ERR_MEMORY;
    for (unsigned n = 0; n < 400 && err && check_failures < 5; n++) {
        struct snapshot before;
        take_snapshot(&before, interp);
        allow_allocations(n);
        err = execute(interp, line);
        mem_allows = NULL;
        if (!err)
            break;
        CHECK_INT(err, ERR_MEMORY);
        CHECK_INT(session_pendings(interp->session), before.pendings);
        const uint64_t acknowledged = interp->acknowledged;
        must(interp, "why 1,1,1");
        interp->acknowledged = acknowledged;
        is_as_before(&before, interp, line);
    }
    CHECK(err == OK);
}

SCENE_STORY(edits_without_memory_leave_everything_as_it_was)
{
    static const char *const line[] = {
        "seed 3,3,3 1 radius=2 within=4",
        "seed 5,5,5 2 within=2",
        "remove 3,3,3",
        "seed 4,4,4 0 radius=3 shell=yes",
        "seed 6,6,6 2 radius=2 within=0 over=0,1",
        "seed 8,8,8 1 radius=2 over=0-2",
        "labels here",
        "seed 7,7,7 2 radius=2 keep=3",
        "box 1,1,1 6,6,6 0",
        "undo 2",
        "redo",
    };
    must(interp, "auto on; seed 0,0,0 0");
    for (size_t i = 0; i < sizeof line / sizeof line[0] && !check_failures; i++)
        grows_anew_after_every_failure(interp, line[i]);
}

SCENE_STORY(exact_gestures_say_what_they_leave_out_and_refuse_what_would_not_be_exact)
{
    static const struct {
        const char *line, *part;
    } refused[] = {
        {"seed 3,3,3 2 over=1", "over, keep: only with within=0, or for one ball"},
        {"seed 3,3,3 2 radius=2 to=5,5,5 keep=1", "over, keep: only with within=0, or for one"},
        {"box 1,1,1 3,3,3 2 over=1", "over, keep: only with within=0"},
        {"seed 9,3,3 2 radius=1 within=0 over=1", "no voxel of it has a label that may change"},
        {"seed 9,3,3 2 radius=1 over=1", "no voxel of it has a label that may change"},
        {"seed 3,3,3 2 radius=3 within=2 over=1", "within: less than the radius"},
        {"outline 2,2,2 1 to=6,2,2 to=2,6,2 within=0 over=0 ring=2", "without `over` and `keep`"},
        {"seed 3,3,3 2 radius=1 within=0 over=cerebelum", "did you mean cerebellum?"},
        {"seed 3,3,3 2 radius=1 within=0 over=0-256", "over: expected a label 0..255"},
        {"seed 3,3,3 2 radius=1 within=0 over=", "over: expected a label 0..255"},
        {"labels here regions=1", "here: only with finished, erode and least"},
        {"labels regions.nii finished=yes", "finished: only with `labels here`"},
        {"box 1,1,1 3,3,3 2 within=1", "within: expected a number 0..0, not 1"},
    };
    make_regions("regions.nii", size[0], 0);
    CHECK(chdir(folder) == 0);
    must(interp, "auto on; labels regions.nii"); /* x below 4: label 1; from 8 on: label 2 */
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++)
        is_refused(interp, refused[i].line, refused[i].part);
    MUST_MENTION(interp, "box 0,0,0 7,0,0 2 within=0 over=1",
                 "left out, of labels that stay: 4 voxels\n4 voxels changed, "
                 "label 2 cerebellum: 1.31 ml (+11.8 mm3), label 1: 1.29 ml (-11.8 mm3), ");
    MUST_RECORD(interp, "box 0,2,0 7,2,0 cerebellum within=0 keep=0,3", "spared=5-8");
    MUST_MENTION(interp, "why 0,2,0", "label 2 cerebellum, of the seed at 0,2,0, within=0");
    MUST_MENTION(interp, "undo 3; seed 3,3,3 1; seed 9,9,9 2; box 0,0,0 1,1,1 2 within=0",
                 "`labels here` keeps them as they are");
    must(interp, "box 0,3,0 1,3,1 2 within=0"); /* once is enough */
    CHECK(!strstr(buf_text(&reply.text), "labels here"));
    must(interp, "undo 2; finish open radius=1");
    interp->has_pilot = true;
    must(interp, "finished on; labels here");
    CHECK_HAS(buf_text(&reply.canonical), "labels here finished=yes erode=0 copy=");
    must(interp, "undo; finished off; labels here");
    CHECK_HAS(buf_text(&reply.canonical), "labels here finished=no erode=0 copy=");
    must(interp, "box 0,5,0 1,5,1 2 within=0"); /* nothing is left that has grown */
    CHECK(!strstr(buf_text(&reply.text), "labels here"));
    MUST_MENTION(interp, "undo 2; box 0,5,0 1,5,1 2 within=0", "`labels here` keeps them");
    MUST_MENTION(interp, "undo; labels here; seed 9,9,9 3; box 0,5,0 1,5,1 2 within=0",
                 "`labels here` keeps them");
}

static void finished_label_is(struct interpreter *interp, uint32_t x, uint8_t expected)
{
    struct labels labels;
    CHECK(session_labels(interp->session, true, &labels, NULL) == OK);
    CHECK_INT(labels_at(&labels, grid_cell(&interp->session->scene->grid, x, 6, 6)), expected);
}

SCENE_STORY(relaxation_keeps_exact_voxels_and_other_steps_do_not)
{
    make_regions("regions.nii", size[0], 0);
    CHECK(chdir(folder) == 0);
    must(interp, "auto on; labels regions.nii; seed 6,6,6 2 within=0; finish relax");
    finished_label_is(interp, 6, 2);
    must(interp, "finish largest");
    finished_label_is(interp, 6, 0);
    must(interp, "finish none; finish majority");
    finished_label_is(interp, 6, 0);
    MUST_MENTION(interp, "help finish", "also those of exact");
}

SCENE_STORY(the_context_lies_behind_objects_and_goes_by_the_window)
{
    char alone[128], words[128], other[128];
    record_of(alone, interp, "view 30 20; render");
    record_of(words, interp, "context mip; render"); /* the scene alone */
    CHECK(strcmp(words, alone) != 0);
    CHECK_INT(session_frame(interp->session)->rgba[4 * (256 * 512 + 256) + 3], 255);
    is_recorded_as(interp, "samples 2; samples 1; render", words);
    record_of(other, interp, "window 0 50; render");
    CHECK(strcmp(words, other) != 0);
    MUST_MENTION(interp, "info", ", context mip\n");
    is_recorded_as(interp, "context none; render", alone);
    record_of(words, interp,
              "context mip; seed 1,1,1 1; seed 10,9,8 2; opacity 1 40; render mode=ii");
    is_recorded_as(interp, "render mode=ray", words);
    record_of(other, interp, "clip axial 0-4; render");
    CHECK(strcmp(words, other) != 0);
    is_recorded_as(interp, "undo; render", words);
}

SCENE_STORY(a_journal_that_cannot_begin_undoes_the_command)
{
    char missing[PATH_MAX];
    snprintf(missing, sizeof missing, "%s", place("no-folder/x.iftty"));
    interp->new_journal = missing;
    is_refused(interp, "seed 1,1,1 1", "No such file or directory");
    is_refused(interp, "seed 1,1,1 1", "No such file or directory");
    must(interp, "info"); /* a question needs no journal */
    interp->new_journal = NULL;
    must(interp, "seed 1,1,1 1");
}

int main(void)
{
    if (!begin_folder())
        return 1;
    make_scene();
    make_seed_files();
    int status = check_run();
    return status | end_folder();
}
