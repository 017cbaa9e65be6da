/* SPDX-License-Identifier: MIT */
/* Records and walks in memory: what FORMAT.md says, what a cut, a flip and hostile bytes do. */
#include "base/buf.h"
#include "base/file.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "tests/check_main.h"

enum { RECORDS = 5, SEMANTICS = 1 };
#define HEADER "# iftty journal 1 semantics 1\n"

static const struct {
    const char *comments, *command, *words;
} story[RECORDS] = {
    {"# opened first\n", "open synth:geom:64", "scene=0123456789abcdef size=64,64,64"},
    {"", "label 2 cervelet \xC3\xA9 #40c060", ""},
    {"\n# why\n\n", "seed 20,30,40 2", "forest=00ff00ff00ff00ff seeds=1"},
    {"", "undo", "forest=0 seeds=0"},
    {"#\n", "redo", "forest=00ff00ff00ff00ff seeds=1 new-word=a=b"},
};

/* The story as a journal; where[i] is the offset behind record i, where[0] behind the header. */
static struct buf journal;
static size_t where[RECORDS + 1];

static void make_journal(void)
{
    struct record_chain chain = record_chain_zero;
    OWNED(buf_release) struct buf header = {0};
    record_header(&header, SEMANTICS);
    buf_add_text(&journal, buf_text(&header));
    where[0] = journal.length;
    for (size_t i = 0; i < RECORDS; i++) {
        struct fault fault;
        const struct record record = {
            .number = i + 1, .command = story[i].command, .result = story[i].words};
        CHECK(record_encode(&journal, &chain, i == 0 ? buf_text(&header) : "", story[i].comments,
                            &record, &fault) == OK);
        where[i + 1] = journal.length;
    }
}

/* Define a story about that journal. */
#define JOURNAL_STORY(told) STORY_WITHIN(told, make_journal(), buf_release(&journal))

/* Walks bytes that may not be read behind their end: a copy of their exact size tells ASan. */
struct outcome {
    enum err err;
    enum walk_step step;
    size_t records;
    struct record place;
    struct fault fault;
};

static struct outcome walk_all(const char *bytes, size_t length, bool only_sound)
{
    struct outcome out = {.err = OK};
    struct walk walk;
    struct record record;
    OWNED(mem_release) char *copy = malloc(length ? length : 1);
    if (length)
        memcpy(copy, bytes, length);
    out.err = walk_begin(&walk, copy, length, &out.fault);
    if (!out.err) {
        while ((only_sound ? walk_next_sound : walk_next)(&walk, &record) == WALK_RECORD)
            CHECK(record.end > record.offset && record.end <= length);
        out.step = walk.over;
        out.records = walk.records;
        out.place = record;
        out.fault = walk.fault;
        CHECK(walk_next(&walk, &record) == out.step); /* an end stays one */
        walk_release(&walk);
    }
    return out;
}

JOURNAL_STORY(what_is_encoded_is_walked)
{
    OWNED(walk_release) struct walk walk;
    struct record record;
    CHECK(walk_begin(&walk, journal.data, journal.length, NULL) == OK && walk.is_journal);
    CHECK_INT(walk.semantics, SEMANTICS);
    const size_t line[RECORDS] = {3, 5, 10, 12, 15};
    for (size_t i = 0; i < RECORDS; i++) {
        if (!CHECK(walk_next(&walk, &record) == WALK_RECORD))
            break;
        CHECK_INT(record.number, i + 1);
        CHECK_INT(record.noted, i + 1);
        CHECK_INT(record.line, line[i]);
        CHECK_INT(record.offset, where[i]);
        CHECK_INT(record.end, where[i + 1]);
        CHECK_TEXT(record.command, story[i].command);
        CHECK_TEXT(record.result, story[i].words);
        CHECK(record.has_result && record.chain_fits && record.number_fits);
        CHECK(record_judge(&record, NULL) == OK);
    }
    CHECK(walk_next(&walk, &record) == WALK_END);
}

/* ---- FORMAT.md ---- */

/* The bytes between the regions of interest of the example, from the page itself. */
static bool read_example(struct buf *out)
{
    OWNED(buf_release) struct buf page = {0};
    static const char roi[] = "\n```journal\n";
    struct fault fault;
    buf_clear(out);
    if (!CHECK(file_read(&page, "journal/FORMAT.md", 1 << 20, &fault) == OK)) {
        printf("# %s (run me in the top folder)\n", fault.text);
        return false;
    }
    const char *begin = strstr(buf_text(&page), roi);
    const char *end = begin ? strstr(begin + sizeof roi - 1, "```") : NULL;
    if (CHECK(end))
        buf_add(out, begin + sizeof roi - 1, (size_t)(end - begin) - (sizeof roi - 1));
    return end != NULL;
}

STORY(the_example_in_FORMAT_is_decoded)
{
    static const char *const expected[3][2] = {
        {"open synth:geom:222", "scene=8c1f0e52a7b3d946 size=222,222,222"},
        {"label 2 cerebellum #40c060", ""},
        {"seed 20,30,40 2 radius=3",
         "forest=0123456789abcdef labels=fedcba9876543210 seeds=123 changed=1200"}};
    OWNED(buf_release) struct buf bytes = {0};
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    if (!read_example(&bytes))
        return;
    CHECK(walk_begin(&walk, bytes.data, bytes.length, NULL) == OK);
    for (size_t i = 0; i < 3; i++) {
        CHECK(walk_next_sound(&walk, &record) == WALK_RECORD);
        CHECK_TEXT(record.command, expected[i][0]);
        CHECK_TEXT(record.result, expected[i][1]);
        CHECK(i > 0 || record.line == 3);
    }
    CHECK(walk_next_sound(&walk, &record) == WALK_END);
    CHECK_INT(walk.records, 3);
}

/* ---- cuts and flips ---- */

/* The rest of a record may be missing, or be zeros, as file systems leave them. */
JOURNAL_STORY(every_prefix_is_sound_records_and_a_torn_tail)
{
    size_t whole = 0;
    OWNED(mem_release) char *zeroed = calloc(1, journal.length + 5000);
    for (size_t cut = 0; cut <= journal.length; cut++) {
        whole += whole < RECORDS && where[whole + 1] == cut;
        const size_t sound = cut < where[0] ? 0 : where[whole];
        const struct outcome prefix = walk_all(journal.data, cut, true);
        const struct outcome zeros = walk_all(zeroed, journal.length + (cut % 2 ? 5000 : 1), true);
        CHECK(prefix.err == OK && zeros.err == OK);
        CHECK_INT(prefix.records, whole);
        CHECK_INT(zeros.records, whole);
        CHECK_INT(prefix.step, cut > 0 && cut == where[whole] ? WALK_END : WALK_TORN);
        CHECK_INT(zeros.step, WALK_TORN);
        CHECK_INT(prefix.place.offset, sound);
        CHECK_INT(zeros.place.offset, sound);
        CHECK_INT(prefix.place.number, whole + 1);
        zeroed[cut] = cut < journal.length ? journal.data[cut] : '\0';
    }
}

/* Which record holds this byte; the header belongs to the first. */
static size_t record_of(size_t offset)
{
    size_t number = 1;
    while (number < RECORDS && where[number] <= offset)
        number++;
    return number;
}

static void check_flip(size_t at)
{
    struct journal_condition found;
    struct outcome out = walk_all(journal.data, journal.length, true);
    enum err err = journal_check(&found, journal.data, journal.length, NULL);
    const size_t number = record_of(at);
    CHECK_INT(err, ERR_CHECK);
    CHECK(found.state != JOURNAL_INTACT && found.state != JOURNAL_SCRIPT);
    if (!CHECK(found.number == number))
        printf("#   byte %zu is now %02x: %s\n", at, (unsigned char)journal.data[at], found.text);
    if (found.state == JOURNAL_TORN)
        CHECK_INT(number, RECORDS);
    /* a flip in the first letters of the header leaves a script, which no journal_open takes */
    const bool refused = out.err || out.step == WALK_DAMAGED || out.step == WALK_TORN;
    CHECK(refused || (found.state == JOURNAL_EDITED && at < where[0]));
    if (!out.err && refused)
        CHECK_INT(out.place.number, number);
}

JOURNAL_STORY(every_flip_of_a_byte_is_noticed_in_its_record)
{
    for (size_t at = 0; at < journal.length; at++) {
        const char kept = journal.data[at];
        for (unsigned bit = 0; bit < 8; bit++) {
            journal.data[at] = (char)(kept ^ (1 << bit));
            check_flip(at);
        }
        for (const char *c = "\n#= 0x\t\r"; *c; c++)
            if (*c != kept) {
                journal.data[at] = *c;
                check_flip(at);
            }
        journal.data[at] = '\0';
        check_flip(at);
        journal.data[at] = kept;
    }
    CHECK(walk_all(journal.data, journal.length, true).step == WALK_END);
}

JOURNAL_STORY(every_byte_left_out_or_doubled_is_noticed)
{
    OWNED(buf_release) struct buf other = {0};
    for (size_t at = 0; at < journal.length; at++) {
        struct journal_condition found;
        for (int doubled = 0; doubled < 2; doubled++) {
            buf_clear(&other);
            buf_add(&other, journal.data, at + (doubled != 0));
            buf_add(&other, journal.data + at + (doubled == 0),
                    journal.length - at - (doubled == 0));
            CHECK_INT(journal_check(&found, other.data, other.length, NULL), ERR_CHECK);
            CHECK(found.number <= record_of(at) + 1);
        }
    }
}

/* Whole records taken out, doubled or exchanged. */
JOURNAL_STORY(records_moved_about_are_noticed)
{
    OWNED(buf_release) struct buf other = {0};
    struct journal_condition found;
    for (size_t i = 1; i < RECORDS; i++) { /* without record i: the one behind it is named */
        buf_clear(&other);
        buf_add(&other, journal.data, where[i - 1]);
        buf_add(&other, journal.data + where[i], journal.length - where[i]);
        CHECK(journal_check(&found, other.data, other.length, NULL) == ERR_CHECK);
        CHECK_INT(found.state, JOURNAL_EDITED);
        CHECK_INT(found.number, i);
        CHECK_INT(found.offset, where[i - 1]);
    }
    buf_clear(&other);
    buf_add(&other, journal.data, where[2]);
    buf_add(&other, journal.data + where[1], journal.length - where[1]);
    CHECK(journal_check(&found, other.data, other.length, NULL) == ERR_CHECK);
    CHECK_INT(found.number, 3);
}

JOURNAL_STORY(only_the_record_that_was_edited_is_unsound)
{
    OWNED(walk_release) struct walk walk;
    struct record record;
    *strstr(journal.data, "20,30,40") = '1';
    CHECK(walk_begin(&walk, journal.data, journal.length, NULL) == OK);
    for (size_t i = 1; i <= RECORDS; i++) {
        struct fault fault = {.text = ""};
        CHECK(walk_next(&walk, &record) == WALK_RECORD);
        CHECK_INT(record_judge(&record, &fault), i == 3 ? ERR_INPUT : OK);
        if (i == 3)
            CHECK_HAS(fault.text, "record 3 (line 10, from byte ");
    }
}

/* ---- headers, scripts ---- */

STORY(headers_have_one_spelling)
{
    static const struct {
        const char *text;
        const char *words; /* part of the refusal; NULL: fine */
    } c[] = {
        {HEADER, NULL},
        {"# iftty journal 1 semantics 999999999\n", NULL},
        {"# iftty journal 2 semantics 1\n", "format 2"},
        {"# iftty journal 01 semantics 1\n", "malformed"},
        {"# iftty journal 1 semantics 01\n", "malformed"},
        {"# iftty journal 1 semantics 0\n", "malformed"},
        {"# iftty journal 1 semantics -1\n", "malformed"},
        {"# iftty journal 1 semantics 1 \n", "malformed"},
        {"# iftty journal 1 semantics 1\r\n", "line ends of Windows"},
        {"# iftty journal 1 semantics 1000000000\n", "malformed"},
        {"# iftty journal 1\n", "malformed"},
        {"# iftty journal \x1b[31m\n", "\\x1b[31m"},
    };
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        struct outcome out = walk_all(c[i].text, strlen(c[i].text), false);
        CHECK_INT(out.err, c[i].words ? ERR_INPUT : OK);
        if (c[i].words)
            CHECK_HAS(out.fault.text, c[i].words);
    }
}

STORY(a_script_is_walked_too)
{
    static const char text[] = "\n# a script\nopen ch2.nii\n  seed 1,2,3 4\n\t\n# end\nrun";
    OWNED(walk_release) struct walk walk;
    struct record record;
    static const struct {
        const char *command;
        size_t line, offset;
    } expected[] = {{"open ch2.nii", 3, 0}, {"seed 1,2,3 4", 4, 25}, {"run", 7, 40}};
    CHECK(walk_begin(&walk, text, sizeof text - 1, NULL) == OK && !walk.is_journal);
    for (size_t i = 0; i < 3; i++) {
        CHECK(walk_next_sound(&walk, &record) == WALK_RECORD);
        CHECK_TEXT(record.command, expected[i].command);
        CHECK_INT(record.line, expected[i].line);
        CHECK_INT(record.offset, expected[i].offset);
        CHECK_INT(record.number, i + 1);
        CHECK(!record.has_result && !record.chain_fits);
        CHECK_TEXT(record.result, "");
    }
    CHECK(walk_next(&walk, &record) == WALK_END);
}

JOURNAL_STORY(the_log_prints_the_commands_alone)
{
    OWNED(buf_release) struct buf script = {0};
    static const char expected[] = "# opened first\nopen synth:geom:64\n"
                                   "label 2 cervelet \xC3\xA9 #40c060\n"
                                   "\n# why\n\nseed 20,30,40 2\nundo\n#\nredo\n";
    CHECK(journal_script(&script, journal.data, journal.length, NULL) == OK);
    CHECK_TEXT(buf_text(&script), expected);
    buf_clear(&script); /* a torn tail was never acknowledged */
    CHECK(journal_script(&script, journal.data, journal.length - 1, NULL) == OK);
    CHECK(strncmp(buf_text(&script), expected, sizeof expected - 8) == 0);
    CHECK_INT(script.length, sizeof expected - 1 - 7);
    static const char text[] = "  run # now\n# last";
    buf_clear(&script);
    CHECK(journal_script(&script, text, sizeof text - 1, NULL) == OK);
    CHECK_TEXT(buf_text(&script), text);
    buf_clear(&script);
    CHECK(journal_script(&script, "run\n= 2 chain=no\n", 17, NULL) == ERR_INPUT);
    buf_clear(&script);
    CHECK(journal_script(&script, NULL, 0, NULL) == OK);
    CHECK_INT(script.length, 0);
}

/* Check bytes, and the condition of their journal: its state and words. */
static struct journal_condition condition_is(const char *bytes, size_t length,
                                             enum journal_state state, const char *words)
{
    const bool is_fine = state == JOURNAL_INTACT || state == JOURNAL_SCRIPT;
    struct journal_condition found;
    struct fault fault;
    CHECK_INT(journal_check(&found, bytes, length, &fault), is_fine ? OK : ERR_CHECK);
    CHECK_INT(found.state, state);
    CHECK_HAS(found.text, words);
    CHECK(is_fine || strcmp(fault.text, found.text) == 0);
    return found;
}

JOURNAL_STORY(the_log_says_whether_a_journal_is_intact)
{
    const char *bytes = journal.data;
    size_t length = journal.length;
    struct journal_condition found = condition_is(bytes, length, JOURNAL_INTACT, "");
    CHECK_INT(found.records, RECORDS);
    CHECK(strncmp(found.chain.hex, bytes + length - 33, 32) == 0);
    CHECK_TEXT(found.text, "intact, 5 records");
    found = condition_is(bytes, length - 7, JOURNAL_TORN, "record 5 is torn");
    CHECK_INT(found.offset, where[RECORDS - 1]);
    CHECK_INT(found.records, RECORDS - 1);
    CHECK_INT(condition_is("run\n", 4, JOURNAL_SCRIPT, "").records, 1);
    /* Its header was not written yet. */
    CHECK_INT(condition_is(NULL, 0, JOURNAL_TORN, "").records, 0);
    found = condition_is(bytes + where[0], length - where[0], JOURNAL_EDITED, "header");
    CHECK_INT(found.number, 1);
    buf_add_text(&journal, "undo\nredo\n"); /* two commands behind the end are no torn write */
    bytes = journal.data;
    length = journal.length;
    found = condition_is(bytes, length, JOURNAL_EDITED, "no result line");
    CHECK_INT(found.number, RECORDS + 1);
    condition_is(bytes, length - 3, JOURNAL_EDITED, ""); /* nor is one, and a begin of another */
    condition_is(bytes, length - 5, JOURNAL_TORN, "");   /* one command is */
}

/* ---- lines that no writer of ours writes, sealed all the same ---- */

/* A journal of one record: these lines, and the seal that fits them. */
static void seal(struct buf *out, const char *lines, size_t length)
{
    OWNED(buf_release) struct buf header = {0};
    struct record_chain chain;
    record_header(&header, SEMANTICS);
    record_chain_compute(&chain, &record_chain_zero, header.data, header.length, lines, length);
    buf_clear(out);
    buf_add(out, header.data, header.length);
    buf_add(out, lines, length);
    buf_printf(out, " chain=%s\n", chain.hex);
}

STORY(a_seal_does_not_make_a_line_valid)
{
    static const struct {
        const char *lines;
        enum walk_step step; /* of a walk over sound records */
        const char *words;
    } c[] = {
        {"run\n= 1", WALK_END, ""},
        {"run\n= 1 a=b", WALK_END, ""},
        {"# one\n\n#two\nrun\n= 1 a=\xC3\xA9", WALK_END, ""},
        {"run\n= 01", WALK_DAMAGED, "malformed"},
        {"run\n= 0", WALK_DAMAGED, "malformed"},
        {"run\n=1", WALK_DAMAGED, "malformed"},
        {"run\n=  1", WALK_DAMAGED, "malformed"},
        {"run\n= 1 ", WALK_DAMAGED, "malformed"},
        {"run\n= 1  a=b", WALK_DAMAGED, "malformed"},
        {"run\n= 1 a=b ", WALK_DAMAGED, "malformed"},
        {"run\n= 1 a", WALK_DAMAGED, "malformed"},
        {"run\n= 1 a=b a=b", WALK_DAMAGED, "malformed"},
        {"run\n= 1a=b", WALK_DAMAGED, "malformed"},
        {"run\n= ", WALK_DAMAGED, "malformed"},
        {"run\n= 9999999999999999999999999", WALK_DAMAGED, "malformed"},
        {"run\n= 2", WALK_DAMAGED, "out of order"},
        {"run\nrun\n= 1", WALK_DAMAGED, "no result line"},
        {"run\n\n= 1", WALK_DAMAGED, "no result line"},
        {" run\n= 1", WALK_DAMAGED, "begins with a blank"},
        {"\trun\n= 1", WALK_DAMAGED, "begins with a blank"},
        {"= 1", WALK_DAMAGED, "has no command line"},
        {"# run\n= 1", WALK_DAMAGED, "has no command line"},
        {"run = 1", WALK_DAMAGED, "runs into the line before"},
    };
    OWNED(buf_release) struct buf bytes = {0};
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        seal(&bytes, c[i].lines, strlen(c[i].lines));
        struct outcome out = walk_all(bytes.data, bytes.length, true);
        if (!CHECK(out.err == OK && out.step == c[i].step))
            printf("#   step %d for %s\n", (int)out.step, c[i].lines);
        CHECK_HAS(out.fault.text, c[i].words);
    }
    static const char zero[] = "run\0ning\n= 1", zero_in_result[] = "run\n= 1 a=\0";
    seal(&bytes, zero, sizeof zero - 1);
    CHECK_HAS(walk_all(bytes.data, bytes.length, true).fault.text, "zero byte");
    seal(&bytes, zero_in_result, sizeof zero_in_result - 1);
    CHECK_HAS(walk_all(bytes.data, bytes.length, true).fault.text, "zero byte");
}

/* ---- what may be written, and what hostile bytes do ---- */

STORY(what_would_break_a_record_is_refused)
{
    static const char *const bad_command[] = {
        "",      " run", "# run",   "= 1",   "run\nrun",
        "run\r", "a\tb", "\x1b[2J", "a\x7f", "x chain=0123456789abcdef0123456789abcdef"};
    static const char *const bad_words[] = {" ",        "a",        "a=",   "=b",       "a=b ",
                                            " a=b",     "a=b  c=d", "A=b",  "a=b a=c",  "chain=1",
                                            "a=b\nc=d", "a=\x1b",   "1a=b", "a=b\tc=d", "a b=c"};
    static const char *const good_words[] = {"", "a=b", "a=b=c", "a-1_=\xC3\xA9 b=,", "chains=1"};
    OWNED(buf_release) struct buf out = {0};
    struct record_chain chain = record_chain_zero;
    struct fault fault;
    buf_add_text(&out, "kept");
    for (size_t i = 0; i < sizeof bad_command / sizeof bad_command[0]; i++) {
        const struct record record = {.number = 1, .command = bad_command[i], .result = ""};
        CHECK(record_encode(&out, &chain, "", "", &record, &fault) == ERR_INPUT);
        CHECK(strchr(fault.text, '\x1b') == NULL);
    }
    for (size_t i = 0; i < sizeof bad_words / sizeof bad_words[0]; i++) {
        const struct record record = {.number = 1, .command = "run", .result = bad_words[i]};
        if (!CHECK(record_encode(&out, &chain, "", "", &record, &fault) == ERR_INPUT))
            printf("#   %s\n", bad_words[i]);
    }
    for (size_t i = 0; i < sizeof good_words / sizeof good_words[0]; i++)
        CHECK(record_words_check(good_words[i], NULL) == OK);
    CHECK(record_command_check("x chain=0123456789abcdef0123456789abcdeF", NULL) == OK);
    CHECK(record_comment_check("# fine", NULL) == OK && record_comment_check("", NULL) == OK);
    CHECK(record_comment_check("run", NULL) == ERR_INPUT);
    CHECK(record_comment_check("# a\nrun", NULL) == ERR_INPUT);
    CHECK_TEXT(out.data, "kept");
    CHECK_TEXT(chain.hex, record_chain_zero.hex);
}

STORY(lines_have_a_limit_on_both_sides)
{
    OWNED(buf_release) struct buf out = {0}, words = {0};
    struct record_chain chain = record_chain_zero;
    char *line = malloc(RECORD_LINE_MAX + 2);
    memset(line, 'x', RECORD_LINE_MAX + 1);
    line[RECORD_LINE_MAX + 1] = '\0';
    CHECK(record_command_check(line, NULL) == ERR_LIMIT);
    CHECK(walk_all(line, RECORD_LINE_MAX + 1, false).step == WALK_DAMAGED);
    line[RECORD_LINE_MAX] = '\0';
    CHECK(record_command_check(line, NULL) == OK);
    OWNED(buf_release) struct buf header = {0};
    record_header(&header, SEMANTICS);
    buf_add_text(&out, buf_text(&header));
    struct record record = {.number = 1, .command = line, .result = "a=1"};
    CHECK(record_encode(&out, &chain, buf_text(&header), "", &record, NULL) == OK);
    struct outcome walked = walk_all(out.data, out.length, true);
    CHECK(walked.step == WALK_END && walked.records == 1);
    /* the longest result line, and one byte more */
    const size_t value = RECORD_LINE_MAX - strlen("= 2 v=") - strlen(" chain=") - 32;
    buf_add_text(&words, "v=");
    buf_add(&words, line, value);
    record = (struct record){.number = 2, .command = "run", .result = buf_text(&words)};
    CHECK(record_encode(&out, &chain, "", "", &record, NULL) == OK);
    walked = walk_all(out.data, out.length, true);
    CHECK(walked.step == WALK_END && walked.records == 2);
    const size_t length = out.length;
    buf_add_char(&words, 'x');
    record = (struct record){.number = 3, .command = "run", .result = buf_text(&words)};
    CHECK(record_encode(&out, &chain, "", "", &record, NULL) == ERR_LIMIT);
    CHECK_INT(out.length, length);
    /* an unfinished line that is too long is no beginning of a record */
    for (size_t i = 0; i <= RECORD_LINE_MAX; i++)
        buf_add_char(&out, '#');
    CHECK(walk_all(out.data, out.length, true).step == WALK_DAMAGED);
    /* 64 words are fine, 65 are not */
    buf_clear(&words);
    for (int i = 0; i < RECORD_WORDS_MAX; i++)
        buf_printf(&words, "%sw%d=1", i ? " " : "", i);
    CHECK(record_words_check(buf_text(&words), NULL) == OK);
    buf_add_text(&words, " last=1");
    CHECK(record_words_check(buf_text(&words), NULL) == ERR_INPUT);
    free(line);
}

STORY(random_bytes_end_in_order)
{
    static const char *const piece[] = {
        HEADER, "# iftty", "\n",  "= ", "= 1",     " chain=",  "0123456789abcdef0123456789abcdef",
        "a=b",  " ",       "run", "#",  "\x1b[2J", "\xff\xfe", "\xE2\x80\xAE",
        "\r\n", "chain=",  "1",   "="};
    uint64_t random = 7;
    OWNED(buf_release) struct buf bytes = {0}, script = {0};
    for (int round = 0; round < 20000; round++) {
        struct journal_condition found;
        struct fault fault = {.text = ""};
        buf_clear(&bytes);
        buf_clear(&script);
        if (check_below(&random, 2))
            buf_add_text(&bytes, piece[0]);
        for (unsigned n = check_below(&random, 24); n > 0; n--)
            if (check_below(&random, 8) == 0)
                buf_add_char(&bytes, (char)check_below(&random, 256));
            else
                buf_add_text(&bytes, piece[check_below(&random, sizeof piece / sizeof *piece)]);
        walk_all(bytes.data, bytes.length, false);
        struct outcome out = walk_all(bytes.data, bytes.length, true);
        CHECK(strpbrk(out.fault.text, "\x1b\n") == NULL || out.err == OK);
        journal_check(&found, bytes.data, bytes.length, &fault);
        CHECK(strpbrk(found.text, "\x1b\n") == NULL);
        journal_script(&script, bytes.data, bytes.length, &fault);
    }
}
