/* SPDX-License-Identifier: MIT */
/* Replay with a host that is not a session at all, and golden images of a few pixels. */
#include "base/buf.h"
#include "journal/golden.h"
#include "journal/replay.h"
#include "tests/check_main.h"

/* ---- a host that adds numbers ---- */

/* "add N" adds to a sum; the words tell sum and count. */
struct adder {
    long sum, count;
    const char *extra;   /* more words than were recorded */
    const char *missing; /* the command that no longer tells its sum */
    const char *failing; /* the command that fails, and how */
    enum err failure;
    bool is_wrong_from_third; /* the sum is off by one from the third command on */
};

static enum err add(void *context, const char *command, struct buf *words, struct fault *fault)
{
    struct adder *adder = context;
    CHECK_INT(words->length, 0);
    if (adder->failing && strcmp(command, adder->failing) == 0)
        return fault_set(fault, adder->failure, "the adder is out of order");
    if (strncmp(command, "add ", 4) != 0)
        return fault_set(fault, ERR_USAGE, "there is no command %s", command);
    adder->sum += atol(command + 4);
    adder->count++;
    if (adder->extra)
        buf_printf(words, "%s ", adder->extra);
    if (!adder->missing || strcmp(command, adder->missing) != 0)
        buf_printf(words, "sum=%ld ",
                   adder->sum + (adder->is_wrong_from_third && adder->count >= 3));
    buf_printf(words, "count=%ld", adder->count);
    return OK;
}

static const char *const commands[] = {"add 5", "add 7", "add -2", "add 30"};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

/* The journal that an adder in order writes, its last replay, and why that failed. */
static struct buf journal;
static struct replay_report report;
static struct fault why;

static void make_journal(void)
{
    struct adder adder = {0};
    OWNED(buf_release) struct buf header = {0}, words = {0};
    struct record_chain chain = record_chain_zero;
    record_header(&header, 3);
    buf_clear(&journal);
    buf_add_text(&journal, buf_text(&header));
    for (size_t i = 0; i < COMMANDS; i++) {
        buf_clear(&words);
        CHECK(add(&adder, commands[i], &words, NULL) == OK);
        const struct record record = {
            .number = i + 1, .command = commands[i], .result = buf_text(&words)};
        CHECK(record_encode(&journal, &chain, i ? "" : buf_text(&header), i == 1 ? "# two\n" : "",
                            &record, NULL) == OK);
    }
}

static enum err replay_by(const struct replay_host *host, struct replay_options options)
{
    replay_report_release(&report);
    report = (struct replay_report){.outcome = REPLAY_SAME};
    why = (struct fault){.text = ""};
    return replay_run(journal.data, journal.length, host, &options, &report, &why);
}

/* Replay by this adder; check the result, the outcome, and the record at which it stopped. */
static void replay(struct adder adder, enum err err, enum replay_outcome outcome, size_t number)
{
    const struct replay_host host = {.context = &adder, .execute = add};
    CHECK_INT(replay_by(&host, (struct replay_options){0}), err);
    CHECK_INT(report.outcome, outcome);
    CHECK_INT(report.number, number);
}

/* Define a story about the journal. */
#define JOURNAL_STORY(told)                                                                        \
    STORY_WITHIN(told, make_journal(), (replay_report_release(&report), buf_release(&journal)))

JOURNAL_STORY(a_replay_reproduces_every_word)
{
    replay((struct adder){.extra = "later=1"}, OK, REPLAY_SAME, 0);
    CHECK_INT(report.executed, COMMANDS);
    CHECK_INT(report.compared, COMMANDS);
    CHECK(report.is_journal && report.is_intact && !report.is_torn);
}

JOURNAL_STORY(it_stops_at_the_first_word_that_differs)
{
    replay((struct adder){.is_wrong_from_third = true}, ERR_CHECK, REPLAY_DIVERGED, 3);
    CHECK_INT(report.executed, 2); /* and the fourth was never carried out */
    CHECK_INT(report.line, 7);
    CHECK_TEXT(buf_text(&report.command), "add -2");
    CHECK_TEXT(buf_text(&report.word), "sum");
    CHECK_TEXT(buf_text(&report.expected), "10");
    CHECK_TEXT(buf_text(&report.actual), "11");
    CHECK(report.is_intact);
    CHECK_TEXT(why.text, "record 3 (line 7) diverges: sum is 11, 10 was recorded; "
                         "command: add -2");

    replay((struct adder){.missing = "add 7"}, ERR_CHECK, REPLAY_DIVERGED, 2);
    CHECK_TEXT(buf_text(&report.expected), "12");
    CHECK_TEXT(buf_text(&report.actual), "");
    CHECK_HAS(why.text, "sum is missing, 12 was recorded");
}

JOURNAL_STORY(a_command_that_fails_now_is_named)
{
    static const struct {
        enum err host, replay;
    } c[] = {{ERR_USAGE, ERR_CHECK},   {ERR_CHECK, ERR_CHECK},         {ERR_INPUT, ERR_INPUT},
             {ERR_MEMORY, ERR_MEMORY}, {ERR_CANCELLED, ERR_CANCELLED}, {ERR_IO, ERR_IO}};
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        const struct adder adder = {.failing = "add 7", .failure = c[i].host};
        replay(adder, c[i].replay, REPLAY_FAILED, 2);
        CHECK_INT(why.code, c[i].replay);
        CHECK_INT(report.executed, 1);
        CHECK_TEXT(buf_text(&report.actual), "the adder is out of order");
        CHECK_HAS(why.text, "record 2 (line 5) fails: add 7: the adder is out of order");
    }
}

JOURNAL_STORY(an_edited_journal_fails_and_names_the_first_command_that_differs)
{
    *strstr(journal.data, "add 7") = 'A'; /* a command that the host does not know */
    replay((struct adder){0}, ERR_CHECK, REPLAY_FAILED, 2);
    CHECK_INT(report.edited_number, 2);
    CHECK_HAS(why.text, "edited or damaged at record 2 (line 5)");

    make_journal();
    strstr(journal.data, "add 5")[4] = '6'; /* the sum differs at once */
    replay((struct adder){0}, ERR_CHECK, REPLAY_DIVERGED, 1);
    CHECK_INT(report.edited_number, 1);
    CHECK_TEXT(buf_text(&report.actual), "6");

    make_journal();
    strstr(journal.data, "count=3")[-1] = '\t'; /* a tab between words */
    replay((struct adder){0}, ERR_INPUT, REPLAY_UNREADABLE, 3);

    make_journal();
    char *last_chain = journal.data + journal.length - 33;
    memset(last_chain, '0', 32); /* a second edit is not the one that is named */
    strstr(journal.data, "# two")[2] =
        'T'; /* a comment: nothing diverges, and yet it is no proof */
    replay((struct adder){0}, ERR_CHECK, REPLAY_SAME, 0);
    CHECK_INT(report.executed, COMMANDS);
    CHECK(!report.is_intact);
    CHECK_INT(report.edited_number, 2);
    CHECK_INT(report.edited_line, 5);
    CHECK_INT(report.edited_offset, strstr(journal.data, "# Two") - journal.data);
    CHECK_HAS(why.text, "though every command reproduces its result");
}

JOURNAL_STORY(a_command_added_by_hand_is_an_edit)
{
    struct buf other = {0};
    const char *third = strstr(journal.data, "add -2");
    buf_add(&other, journal.data, (size_t)(third - journal.data));
    buf_add_text(&other, "add 0\n");
    buf_add_text(&other, third);
    buf_release(&journal);
    journal = other;
    replay((struct adder){0}, ERR_CHECK, REPLAY_DIVERGED, 4); /* it counts one more */
    CHECK_TEXT(buf_text(&report.word), "count");
    CHECK_INT(report.edited_number, 3);
    CHECK_INT(report.executed, 3);
    CHECK_INT(report.compared, 2);
}

JOURNAL_STORY(torn_and_unreadable_journals_are_replayed_as_far_as_they_go)
{
    const size_t length = journal.length;
    journal.length -= 3;
    replay((struct adder){0}, OK, REPLAY_SAME, 0);
    CHECK(report.is_torn);
    CHECK_INT(report.torn_offset, strstr(journal.data, "add 30") - journal.data);
    CHECK_INT(report.executed, COMMANDS - 1);
    journal.length = length;
    strstr(journal.data, "= 3")[1] = '_';
    replay((struct adder){0}, ERR_INPUT, REPLAY_UNREADABLE, 3);
    CHECK_INT(report.executed, 2);
    CHECK_HAS(why.text, "malformed");
    journal.data[16] = '7';
    replay((struct adder){0}, ERR_INPUT, REPLAY_UNREADABLE, 0);
    CHECK_HAS(why.text, "format 7");
}

JOURNAL_STORY(a_script_is_carried_out_and_compared_with_nothing)
{
    buf_clear(&journal);
    buf_add_text(&journal, "# adds\nadd 1\n  add 2");
    replay((struct adder){0}, OK, REPLAY_SAME, 0);
    CHECK(!report.is_journal && report.is_intact);
    CHECK_INT(report.executed, 2);
    CHECK_INT(report.compared, 0);
}

static enum err refuse_three(void *context, unsigned semantics, struct fault *fault)
{
    (void)context;
    return semantics == 3 ? fault_set(fault, ERR_INPUT, "semantics 3") : OK;
}

JOURNAL_STORY(a_replay_may_stop_early_and_a_host_may_refuse_semantics)
{
    struct adder adder = {.is_wrong_from_third = true};
    const struct replay_host host = {.context = &adder, .execute = add};
    CHECK(replay_by(&host, (struct replay_options){.last = 2}) == OK);
    CHECK_INT(report.executed, 2);
    CHECK_INT(adder.count, 2);
    adder = (struct adder){.is_wrong_from_third = true};
    const struct replay_host strict = {.context = &adder, .execute = add, .begin = refuse_three};
    CHECK(replay_by(&strict, (struct replay_options){0}) == ERR_INPUT);
    CHECK_TEXT(why.text, "semantics 3");
    CHECK_INT(report.outcome, REPLAY_UNREADABLE);
    CHECK_INT(adder.count, 0);
}

JOURNAL_STORY(hostile_commands_are_harmless_in_messages)
{
    buf_clear(&journal);
    buf_add_text(&journal, "\x1b]0;title\x07 \xE2\x80\xAE rm\n");
    replay((struct adder){0}, ERR_CHECK, REPLAY_FAILED, 1);
    CHECK_HAS(why.text, "\\x1b]0;title\\x07");
    CHECK(strpbrk(why.text, "\x1b\x07\n\xE2") == NULL);
    buf_clear(&journal); /* and of any length */
    for (int i = 0; i < 60000; i++)
        buf_add_text(&journal, "\xC3");
    replay((struct adder){0}, ERR_CHECK, REPLAY_FAILED, 1);
}

/* ---- golden images ---- */

enum { WIDTH = 3, HEIGHT = 2, PIXELS = WIDTH * HEIGHT };

struct picture {
    uint8_t rgba[PIXELS][4];
    float depth[PIXELS];
    uint32_t label[PIXELS], voxel[PIXELS];
};

static const struct picture plain = {
    .rgba = {{90, 90, 90, 255}, {0, 0, 0, 0}, {255, 255, 255, 255}},
    .depth = {1.5f, 2.5f, 0.0f},
    .label = {1, 2, 3, 4, 5, 6},
    .voxel = {100, 200, 300, 400, 500, 600},
};

static struct golden_planes planes(const struct picture *p)
{
    return (struct golden_planes){WIDTH, HEIGHT, {p->rgba, p->depth, p->label, p->voxel}};
}

/* The difference of two pictures, and its words. */
static struct golden_difference d;
static struct buf words;

static enum err compare_planes(const struct golden_planes *a, const struct golden_planes *b)
{
    golden_difference_release(&d);
    const enum err err = golden_compare(a, b, &d, NULL);
    buf_clear(&words);
    golden_describe(&words, &d);
    return err;
}

static void compare(const struct picture *actual)
{
    const struct golden_planes a = planes(&plain), b = planes(actual);
    CHECK(compare_planes(&a, &b) == OK);
}

/* Define a story about such differences. */
#define GOLDEN_STORY(told)                                                                         \
    STORY_WITHIN(told, (void)0, (golden_difference_release(&d), buf_release(&words)))

GOLDEN_STORY(equal_pictures_are_the_same)
{
    struct picture copy = plain;
    compare(&copy);
    CHECK(d.is_same && !d.image && d.pixels == 0);
}

GOLDEN_STORY(every_plane_of_every_pixel_is_compared)
{
    for (uint32_t pixel = 0; pixel < PIXELS; pixel++)
        for (enum golden_plane plane = 0; plane < GOLDEN_PLANES; plane++) {
            struct picture other = plain;
            if (plane == GOLDEN_RGBA)
                other.rgba[pixel][pixel % 4] ^= 1;
            else if (plane == GOLDEN_DEPTH)
                other.depth[pixel] += 0.25f;
            else
                (plane == GOLDEN_LABEL ? other.label : other.voxel)[pixel] += 7;
            compare(&other);
            CHECK(!d.is_same && !d.shape_differs);
            CHECK_INT(d.pixels, 1);
            CHECK_INT(d.pixels_of[plane], 1);
            CHECK_INT(d.column, pixel % WIDTH);
            CHECK_INT(d.row, pixel / WIDTH);
            CHECK_INT(d.plane, plane);
            CHECK(strcmp(d.expected, d.actual) != 0);
            CHECK_INT(d.expected_voxel, plain.voxel[pixel]);
            CHECK_INT(d.actual_voxel, other.voxel[pixel]);
            for (uint32_t i = 0; i < PIXELS && CHECK(d.image); i++) {
                const bool is_red = d.image[4 * i] == 255 && d.image[4 * i + 1] == 32;
                CHECK(is_red == (i == pixel));
                CHECK_INT(d.image[4 * i + 3], 255);
            }
        }
}

GOLDEN_STORY(the_first_difference_is_told_in_words)
{
    struct picture other = plain;
    other.depth[1] = 12.5f;
    other.label[1] = 9;
    other.rgba[4][0] = 3;
    other.voxel[1] = 201;
    compare(&other);
    CHECK_INT(d.pixels, 2);
    CHECK_INT(d.image[0], 30); /* grey 90 at a third, equal in all channels */
    CHECK_INT(d.image[2], 30);
    CHECK_TEXT(buf_text(&words),
               "2 of 6 pixels differ, first column 1, row 0: depth is 12.5 (0x41480000), "
               "2.5 (0x40200000) was expected; labels differ in 1 pixel, voxels differ in 1 pixel; "
               "it shows voxel 201 instead of 200");
    other = plain;
    other.rgba[0][3] = 0;
    compare(&other);
    CHECK_TEXT(d.expected, "90,90,90,255");
    CHECK_TEXT(d.actual, "90,90,90,0");
    CHECK_HAS(buf_text(&words), "; colours alone differ, labels and voxels are the same");
    other.voxel[1] = UINT32_MAX;
    other.rgba[0][3] = 255;
    compare(&other);
    CHECK_HAS(buf_text(&words), "; it shows nothing instead of voxel 200");
    other = plain;
    other.depth[3] += 1;
    compare(&other);
    CHECK_HAS(buf_text(&words), "; depths differ, labels and voxels are the same");
}

GOLDEN_STORY(depths_are_compared_as_bits)
{
    struct picture other = plain;
    other.depth[2] = -0.0f;
    compare(&other);
    CHECK_INT(d.pixels, 1);
    struct picture nan = plain;
    const uint32_t bits = 0x7fc00000;
    memcpy(&nan.depth[2], &bits, sizeof bits);
    const struct golden_planes a = planes(&nan), b = planes(&nan);
    CHECK(compare_planes(&a, &b) == OK && d.is_same);
}

GOLDEN_STORY(another_size_or_a_missing_plane_is_told)
{
    struct golden_planes a = planes(&plain), b = planes(&plain);
    b.width--;
    CHECK(compare_planes(&a, &b) == OK && d.shape_differs && !d.is_same && !d.image);
    CHECK_HAS(buf_text(&words), "sizes");
    b = planes(&plain);
    b.plane[GOLDEN_VOXEL] = NULL;
    CHECK(compare_planes(&a, &b) == OK && d.shape_differs);
    a.plane[GOLDEN_VOXEL] = NULL; /* missing in both is fine */
    CHECK(compare_planes(&a, &b) == OK && d.is_same);
    a = b = (struct golden_planes){.width = UINT32_MAX, .height = UINT32_MAX};
    CHECK(compare_planes(&a, &b) == ERR_MEMORY);
}

STORY(golden_names_lead_nowhere_else)
{
    static const char *const good[] = {
        "a", "0", "left-view_2",
        "0123456789012345678901234567890123456789012345678901234567890123"};
    static const char *const bad[] = {
        "",     ".",   "..",  "a/b",
        "../a", "-a",  "_a",  "A",
        "a.b",  "a b", "a\n", "\xC3\xA9",
        "/a",   "a\\", "a*",  "01234567890123456789012345678901234567890123456789012345678901234"};
    OWNED(buf_release) struct buf path = {0};
    struct fault fault;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        CHECK(golden_name_is_valid(good[i]));
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CHECK(!golden_name_is_valid(bad[i]));
        CHECK(golden_path(&path, "a.iftty", bad[i], &fault) == ERR_INPUT);
    }
    static const char *const c[][2] = {
        {"brain.iftty", "brain.golden/left.exr"},   {"a/brain.iftty", "a/brain.golden/left.exr"},
        {"brain.txt", "brain.txt.golden/left.exr"}, {"a.iftty/b", "a.iftty/b.golden/left.exr"},
        {".iftty", ".iftty.golden/left.exr"},       {"a/.iftty", "a/.iftty.golden/left.exr"},
    };
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        CHECK(golden_path(&path, c[i][0], "left", &fault) == OK);
        CHECK_TEXT(buf_text(&path), c[i][1]);
    }
    CHECK(golden_folder(&path, "brain.iftty", NULL) == OK);
    CHECK_TEXT(buf_text(&path), "brain.golden");
}
