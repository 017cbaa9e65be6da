/* SPDX-License-Identifier: MIT */
/* The table of programs is complete, and command lines are read by it. */
#include "base/file.h"
#include "program/programs.h"
#include "program/program.h"
#include "tests/check_main.h"

enum { SUMMARY_MOST = 45 }; /* width in the overview */

static const struct option *row(unsigned number)
{
    return program_table.option.row + number;
}

/* ---- the tables ---- */

STORY(every_program_has_what_its_help_needs)
{
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        CHECK(p->words && p->summary && *p->summary && p->run);
        CHECK(strlen(p->summary) <= SUMMARY_MOST && !strchr(p->summary, '\n'));
        CHECK(p->least >= 0 && p->least <= p->most && (p->most > 0) == (*p->words != '\0'));
        CHECK(p->name || p->form || !i); /* the first is the nameless program */
    }
}

STORY(every_option_that_a_program_takes_is_there)
{
    for (unsigned i = 0; i < program_table.rows; i++) {
        const struct program *p = program_table.row + i;
        unsigned taken = 0;
        for (; taken < PROGRAM_OPTIONS_MOST && p->option[taken]; taken++) {
            const struct option *option = row(p->option[taken]);
            CHECK(p->option[taken] < program_table.option.rows);
            CHECK(option->name && option->name[0] == '-' && option->read && option->help);
            for (unsigned j = 0; j < taken; j++)
                CHECK(strcmp(row(p->option[j])->name, option->name) != 0);
        }
        CHECK(taken < PROGRAM_OPTIONS_MOST);
        if (p->form && *p->form == '-')
            CHECK(option_find(&program_table.option, p->option, p->form) != 0);
    }
}

/* An option without help selects a form. */
static bool is_form(const char *name)
{
    for (unsigned i = 0; i < program_table.rows; i++)
        if (program_table.row[i].form && strcmp(program_table.row[i].form, name) == 0)
            return true;
    return false;
}

static bool is_taken(unsigned number)
{
    for (unsigned i = 0; i < program_table.rows; i++)
        for (const uint8_t *o = program_table.row[i].option; *o; o++)
            if (*o == number)
                return true;
    return false;
}

STORY(every_option_is_taken_and_explained)
{
    for (unsigned i = 1; i < program_table.option.rows; i++) {
        CHECK(is_taken(i) && (*row(i)->help || is_form(row(i)->name)));
        for (unsigned j = 1; j < i; j++)
            if (strcmp(row(i)->name, row(j)->name) == 0)
                CHECK(!row(i)->value == !row(j)->value);
    }
}

/* ---- command lines ---- */

static struct options o;
static struct fault fault;

/* Read a line of words, split at blanks; "_" is an empty word. */
static enum err take(const char *line)
{
    static char text[256], *word[32];
    int count = 0;
    snprintf(text, sizeof text, "%s", line);
    for (char *at = strtok(text, " "); at && count < 32; at = strtok(NULL, " "))
        word[count++] = strcmp(at, "_") == 0 ? at + 1 : at;
    o = (struct options){.words = 0};
    fault = (struct fault){.text = ""};
    return program_read(&program_table, count, word, &o, &fault);
}

/* The usage name of the program that a line selects. */
static const char *name_of(const char *line)
{
    static char text[128];
    OWNED(buf_release) struct buf name = {0};
    CHECK(take(line) == OK);
    if (o.program)
        program_add_name(&name, &program_table, o.program);
    snprintf(text, sizeof text, "%s", buf_text(&name));
    return text;
}

STORY(the_program_is_found_wherever_its_name_stands)
{
    CHECK_TEXT(name_of(""), "iftty");
    CHECK_TEXT(name_of("ch2.nii.gz"), "iftty");
    CHECK_TEXT(name_of("run s"), "iftty run");
    CHECK_TEXT(name_of("--journal run run s"), "iftty run");
    CHECK_TEXT(o.journal, "run");
    CHECK_TEXT(name_of("--keep-going run s"), "iftty run");
    CHECK_TEXT(name_of("-c run --keep-going"), "iftty -c");
    CHECK_TEXT(o.commands, "run");
    CHECK_TEXT(name_of("--journal -c"), "iftty");
    CHECK_TEXT(name_of("--version"), "iftty --version");
}

STORY(a_form_is_found_by_its_option_or_operand)
{
    CHECK_TEXT(name_of("verify a b"), "iftty verify");
    CHECK_INT(o.words, 2);
    CHECK_TEXT(name_of("verify a --bisect b"), "iftty verify --bisect");
    CHECK_TEXT(name_of("log --script --anonymise a"), "iftty log --anonymise");
    CHECK_TEXT(name_of("verify --accept --bisect a"), "iftty verify --accept");
    CHECK_TEXT(o.accept, "--bisect");
}

STORY(a_value_may_follow_an_equals_sign)
{
    CHECK_TEXT(name_of("run s --journal=a.iftty --keep-going"), "iftty run");
    CHECK_TEXT(o.journal, "a.iftty");
    CHECK(o.keep_going && take("verify a --until=3 -j 2") == OK);
    CHECK(o.verify.last == 3 && o.verify.processes == 2 && take("run s --journal=") == OK);
    CHECK_TEXT(o.journal, "");
    CHECK(take("run s --journal=a=b") == OK);
    CHECK_TEXT(o.journal, "a=b");
    CHECK_TEXT(name_of("verify --accept=why a"), "iftty verify --accept");
    CHECK(take("run --journal -- -- --x=y") == OK);
    CHECK_TEXT(o.word[0], "--x=y");
    CHECK_TEXT(name_of("-V"), "iftty --version");
}

STORY(two_hyphens_end_the_options)
{
    CHECK(take("run -- --json") == OK);
    CHECK_TEXT(o.word[0], "--json");
    CHECK(take("-- run s") == OK);
    CHECK_TEXT(o.program->name, "run");
    CHECK(take("log -- --script") == OK && !o.program->form);
    CHECK_TEXT(o.word[0], "--script");
    CHECK(take("log -- --") == OK);
    CHECK_TEXT(o.word[0], "--");
    CHECK(take("--out -- run s") == OK);
    CHECK_TEXT(o.out, "--");
    CHECK(take("run -") == OK);
    CHECK_TEXT(o.word[0], "-");
    CHECK(take("run -- --help") == OK && !o.help);
}

STORY(help_may_be_asked_for_anywhere)
{
    static const char *const line[] = {"verify --help", "-h verify", "verify --nonsense -h a",
                                       "verify a b --json 1 --help"};
    for (size_t i = 0; i < sizeof line / sizeof line[0]; i++) {
        CHECK(take(line[i]) == OK && o.help);
        CHECK_TEXT(o.program->name, "verify");
    }
}

static void is_refused(const char *line, const char *words)
{
    CHECK(take(line) == ERR_USAGE);
    CHECK_TEXT(fault.text, words);
}

STORY(what_is_refused_says_what_to_type)
{
    is_refused("run s --junit x.xml --bisect",
               "`iftty run` has no option --junit; it belongs to `iftty verify`");
    is_refused("run s --rounds 9", "`iftty run` has no option --rounds; see `iftty run --help`");
    is_refused("log --check j --repair",
               "`iftty log --check` has no option --repair; it belongs to `iftty log --repair`");
    is_refused("info a -c b", "`iftty info` has no option -c; it belongs to `iftty -c`");
    is_refused("verify a --picture p.png", "`iftty verify` has no option --picture; it belongs to "
                                           "`iftty diff` and `iftty compare`");
    is_refused(
        "verify a --juint x",
        "`iftty verify` has no option --juint; see `iftty verify --help`; did you mean --junit?");
    is_refused("log --chekc a",
               "`iftty log` has no option --chekc; see `iftty log --help`; did you mean --check?");
    is_refused("verify a -j", "-j needs a value, N");
    is_refused("verify a --json=yes", "--json has no value, and yes was given");
    is_refused("verify a --jsn=yes", "`iftty verify` has no option --jsn; see `iftty verify "
                                     "--help`; did you mean --json?");
    is_refused("run s --journal a --journal b", "--journal is given twice; expected one");
    is_refused("run s --json --journal=a --json", "--json is given twice; expected one");
    is_refused("verify a -j 0", "-j: expected a number 1..64, not 0");
    is_refused("verify a -j 3x", "-j: expected a number 1..64, not 3x");
    is_refused("run s --graphics loud",
               "--graphics: expected auto, kitty, tiles, placeholders, iterm, sixel, blocks, "
               "sextants, quadrants, halves or none, not loud");
    is_refused("run", "expected `iftty run FILE|-`, and there are 0 operands");
    is_refused("diff a", "expected `iftty diff A B`, and there is 1 operand");
    is_refused("verify --accept why a b",
               "expected `iftty verify --accept WHY JOURNAL`, and there are 2 operands");
    is_refused("verfy a", "verfy is no program, and no file or folder here; did you mean verify?");
}

/* ---- help ---- */

STORY(help_is_narrow_and_has_every_option)
{
    OWNED(buf_release) struct buf text = {0};
    program_add_overview(&text, &program_table);
    for (unsigned i = 0; i < program_table.rows; i++)
        if (program_table.row[i].name)
            CHECK(program_add_help(&text, &program_table, program_table.row[i].name));
    for (const char *at = buf_text(&text); *at;) {
        const size_t n = strcspn(at, "\n");
        CHECK(n <= 80 && (n == 0 || at[n - 1] != ' '));
        at += n + (at[n] == '\n');
    }
    for (unsigned i = 1; i < program_table.option.rows; i++)
        CHECK_HAS(buf_text(&text), row(i)->name);
    CHECK(!program_add_help(&text, &program_table, "nothing") && !text.failed);
}

STORY(the_keys_of_the_lesson_are_those_of_the_readme)
{
    static const char mark[] = "<!-- organ: the keys of the lesson -->\n\n";
    static const char end[] = "\n<!-- end of organ -->\n";
    OWNED(buf_release) struct buf readme = {0}, keys = {0};
    CHECK(file_read(&readme, "README.md", 1 << 20, NULL) == OK);
    lesson_add_keys(&keys);
    buf_add_text(&keys, end);
    const char *at = strstr(buf_text(&readme), mark);
    CHECK(at && strncmp(at + strlen(mark), buf_text(&keys), keys.length) == 0);
}
