/* SPDX-License-Identifier: MIT */
/*
 * Replay with a host that is not a session at all, and golden images of a few pixels.
 */
#include <stdlib.h>

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

/* What an adder in order writes. */
static void make_journal(struct buf *out)
{
    struct adder adder = {0};
    struct buf header = {0}, words = {0};
    struct record_chain chain = record_chain_zero;
    record_header(&header, 3);
    buf_clear(out);
    buf_add_text(out, buf_text(&header));
    for (size_t i = 0; i < COMMANDS; i++) {
        buf_clear(&words);
        CHECK(add(&adder, commands[i], &words, NULL) == OK);
        const struct record record = {
            .number = i + 1, .command = commands[i], .result = buf_text(&words)};
        CHECK(record_encode(out, &chain, i ? "" : buf_text(&header), i == 1 ? "# two\n" : "",
                            &record, NULL) == OK);
    }
    buf_release(&words);
    buf_release(&header);
}

/* Replays with this adder; the caller releases the report. */
static enum err replay(const struct buf *bytes, struct adder adder, struct replay_report *report,
                       struct fault *fault)
{
    const struct replay_host host = {.context = &adder, .execute = add};
    const struct replay_options options = {0};
    *report = (struct replay_report){.outcome = REPLAY_SAME};
    *fault = (struct fault){.text = ""};
    return replay_run(bytes->data, bytes->length, &host, &options, report, fault);
}

STORY(a_replay_reproduces_every_word)
{
    struct buf bytes = {0};
    struct replay_report report;
    struct fault fault;
    make_journal(&bytes);
    CHECK(replay(&bytes, (struct adder){.extra = "later=1"}, &report, &fault) == OK);
    CHECK_INT(report.outcome, REPLAY_SAME);
    CHECK_INT(report.executed, COMMANDS);
    CHECK_INT(report.compared, COMMANDS);
    CHECK_INT(report.semantics, 3);
    CHECK(report.is_journal && report.is_intact && !report.is_torn);
    CHECK_INT(report.number, 0);
    replay_report_release(&report);
    buf_release(&bytes);
}

STORY(it_stops_at_the_first_word_that_differs)
{
    struct buf bytes = {0};
    struct replay_report report;
    struct fault fault;
    make_journal(&bytes);
    CHECK(replay(&bytes, (struct adder){.is_wrong_from_third = true}, &report, &fault) ==
          ERR_CHECK);
    CHECK_INT(report.outcome, REPLAY_DIVERGED);
    CHECK_INT(report.executed, 2); /* and the fourth was never carried out */
    CHECK_INT(report.number, 3);
    CHECK_INT(report.line, 7);
    CHECK_TEXT(buf_text(&report.command), "add -2");
    CHECK_TEXT(buf_text(&report.word), "sum");
    CHECK_TEXT(buf_text(&report.expected), "10");
    CHECK_TEXT(buf_text(&report.actual), "11");
    CHECK(report.is_intact);
    CHECK_TEXT(fault.text, "record 3 (line 7) diverges: sum is 11, 10 was recorded; "
                           "command: add -2");
    replay_report_release(&report);

    CHECK(replay(&bytes, (struct adder){.missing = "add 7"}, &report, &fault) == ERR_CHECK);
    CHECK_INT(report.number, 2);
    CHECK_TEXT(buf_text(&report.expected), "12");
    CHECK_TEXT(buf_text(&report.actual), "");
    CHECK_HAS(fault.text, "sum is missing, 12 was recorded");
    replay_report_release(&report);
    buf_release(&bytes);
}

STORY(a_command_that_fails_now_is_named)
{
    static const struct {
        enum err host, replay;
    } c[] = {{ERR_USAGE, ERR_CHECK},   {ERR_CHECK, ERR_CHECK},         {ERR_INPUT, ERR_INPUT},
             {ERR_MEMORY, ERR_MEMORY}, {ERR_CANCELLED, ERR_CANCELLED}, {ERR_IO, ERR_IO}};
    struct buf bytes = {0};
    make_journal(&bytes);
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        struct replay_report report;
        struct fault fault;
        const struct adder adder = {.failing = "add 7", .failure = c[i].host};
        CHECK_INT(replay(&bytes, adder, &report, &fault), c[i].replay);
        CHECK_INT(fault.code, c[i].replay);
        CHECK_INT(report.outcome, REPLAY_FAILED);
        CHECK_INT(report.number, 2);
        CHECK_INT(report.executed, 1);
        CHECK_TEXT(buf_text(&report.actual), "the adder is out of order");
        CHECK_HAS(fault.text, "record 2 (line 5) fails: add 7: the adder is out of order");
        replay_report_release(&report);
    }
    buf_release(&bytes);
}

STORY(an_edited_journal_fails_and_names_the_first_command_that_differs)
{
    struct buf bytes = {0};
    struct replay_report report;
    struct fault fault;
    make_journal(&bytes);
    *strstr(bytes.data, "add 7") = 'A'; /* a command that the host does not know */
    CHECK(replay(&bytes, (struct adder){0}, &report, &fault) == ERR_CHECK);
    CHECK_INT(report.outcome, REPLAY_FAILED);
    CHECK_INT(report.number, 2);
    CHECK_INT(report.edited_number, 2);
    CHECK_HAS(fault.text, "edited or damaged at record 2 (line 5)");
    replay_report_release(&report);

    make_journal(&bytes);
    strstr(bytes.data, "add 5")[4] = '6'; /* the sum differs at once */
    CHECK(replay(&bytes, (struct adder){0}, &report, &fault) == ERR_CHECK);
    CHECK_INT(report.outcome, REPLAY_DIVERGED);
    CHECK_INT(report.number, 1);
    CHECK_INT(report.edited_number, 1);
    CHECK_TEXT(buf_text(&report.actual), "6");
    replay_report_release(&report);

    make_journal(&bytes);
    strstr(bytes.data, "count=3")[-1] = '\t'; /* a tab between words */
    CHECK(replay(&bytes, (struct adder){0}, &report, &fault) == ERR_INPUT);
    replay_report_release(&report);

    make_journal(&bytes);
    char *last_chain = bytes.data + bytes.length - 33;
    memset(last_chain, '0', 32);          /* a second edit is not the one that is named */
    strstr(bytes.data, "# two")[2] = 'T'; /* a comment: nothing diverges, and yet it is no proof */
    CHECK(replay(&bytes, (struct adder){0}, &report, &fault) == ERR_CHECK);
    CHECK_INT(report.outcome, REPLAY_SAME);
    CHECK_INT(report.executed, COMMANDS);
    CHECK(!report.is_intact);
    CHECK_INT(report.edited_number, 2);
    CHECK_INT(report.edited_line, 5);
    CHECK_INT(report.edited_offset, strstr(bytes.data, "# Two") - bytes.data);
    CHECK_HAS(fault.text, "though every command reproduces its result");
    replay_report_release(&report);
    buf_release(&bytes);
}

STORY(a_command_added_by_hand_is_an_edit)
{
    struct buf bytes = {0}, other = {0};
    struct replay_report report;
    struct fault fault;
    make_journal(&bytes);
    const char *third = strstr(bytes.data, "add -2");
    buf_add(&other, bytes.data, (size_t)(third - bytes.data));
    buf_add_text(&other, "add 0\n");
    buf_add_text(&other, third);
    CHECK(replay(&other, (struct adder){0}, &report, &fault) == ERR_CHECK);
    CHECK_INT(report.outcome, REPLAY_DIVERGED); /* it counts one more */
    CHECK_TEXT(buf_text(&report.word), "count");
    CHECK_INT(report.number, 4);
    CHECK_INT(report.edited_number, 3);
    CHECK_INT(report.executed, 3);
    CHECK_INT(report.compared, 2);
    replay_report_release(&report);
    buf_release(&other);
    buf_release(&bytes);
}

STORY(torn_and_unreadable_journals_are_replayed_as_far_as_they_go)
{
    struct buf bytes = {0};
    struct replay_report report;
    struct fault fault;
    make_journal(&bytes);
    const size_t length = bytes.length;
    bytes.length -= 3;
    CHECK(replay(&bytes, (struct adder){0}, &report, &fault) == OK);
    CHECK(report.is_torn);
    CHECK_INT(report.torn_offset, strstr(bytes.data, "add 30") - bytes.data);
    CHECK_INT(report.executed, COMMANDS - 1);
    replay_report_release(&report);
    bytes.length = length;
    strstr(bytes.data, "= 3")[1] = '_';
    CHECK(replay(&bytes, (struct adder){0}, &report, &fault) == ERR_INPUT);
    CHECK_INT(report.outcome, REPLAY_UNREADABLE);
    CHECK_INT(report.executed, 2);
    CHECK_INT(report.number, 3);
    CHECK_HAS(fault.text, "malformed");
    replay_report_release(&report);
    bytes.data[16] = '7';
    CHECK(replay(&bytes, (struct adder){0}, &report, &fault) == ERR_INPUT);
    CHECK_INT(report.outcome, REPLAY_UNREADABLE);
    CHECK_HAS(fault.text, "format 7");
    replay_report_release(&report);
    buf_release(&bytes);
}

STORY(a_script_is_carried_out_and_compared_with_nothing)
{
    struct buf script = {0};
    struct replay_report report;
    struct fault fault;
    buf_add_text(&script, "# adds\nadd 1\n  add 2");
    CHECK(replay(&script, (struct adder){0}, &report, &fault) == OK);
    CHECK(!report.is_journal && report.is_intact);
    CHECK_INT(report.executed, 2);
    CHECK_INT(report.compared, 0);
    replay_report_release(&report);
    buf_release(&script);
}

static enum err refuse_three(void *context, unsigned semantics, struct fault *fault)
{
    (void)context;
    return semantics == 3 ? fault_set(fault, ERR_INPUT, "semantics 3") : OK;
}

STORY(a_replay_may_stop_early_and_a_host_may_refuse_semantics)
{
    struct buf bytes = {0};
    struct adder adder = {.is_wrong_from_third = true};
    const struct replay_host host = {.context = &adder, .execute = add};
    struct replay_report report = {.outcome = REPLAY_SAME};
    struct fault fault;
    make_journal(&bytes);
    const struct replay_options two = {.last = 2};
    CHECK(replay_run(bytes.data, bytes.length, &host, &two, &report, NULL) == OK);
    CHECK_INT(report.executed, 2);
    CHECK_INT(adder.count, 2);
    replay_report_release(&report);
    report = (struct replay_report){.outcome = REPLAY_SAME};
    adder = (struct adder){.is_wrong_from_third = true};
    const struct replay_host strict = {.context = &adder, .execute = add, .begin = refuse_three};
    const struct replay_options all = {0};
    CHECK(replay_run(bytes.data, bytes.length, &strict, &all, &report, &fault) == ERR_INPUT);
    CHECK_TEXT(fault.text, "semantics 3");
    CHECK_INT(report.outcome, REPLAY_UNREADABLE);
    CHECK_INT(adder.count, 0);
    replay_report_release(&report);
    buf_release(&bytes);
}

STORY(hostile_commands_are_harmless_in_messages)
{
    struct replay_report report;
    struct fault fault;
    struct buf script = {0};
    buf_add_text(&script, "\x1b]0;title\x07 \xE2\x80\xAE rm\n");
    CHECK(replay(&script, (struct adder){0}, &report, &fault) == ERR_CHECK);
    CHECK_HAS(fault.text, "\\x1b]0;title\\x07");
    CHECK(strpbrk(fault.text, "\x1b\x07\n\xE2") == NULL);
    replay_report_release(&report);
    buf_clear(&script); /* and of any length */
    for (int i = 0; i < 60000; i++)
        buf_add_text(&script, "\xC3");
    CHECK(replay(&script, (struct adder){0}, &report, &fault) == ERR_CHECK);
    replay_report_release(&report);
    buf_release(&script);
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

static void compare(const struct picture *actual, struct golden_difference *out)
{
    const struct golden_planes a = planes(&plain), b = planes(actual);
    CHECK(golden_compare(&a, &b, out, NULL) == OK);
}

STORY(equal_pictures_are_the_same)
{
    struct picture copy = plain;
    struct golden_difference d;
    compare(&copy, &d);
    CHECK(d.is_same && !d.image && d.pixels == 0);
    golden_difference_release(&d);
}

STORY(every_plane_of_every_pixel_is_compared)
{
    for (uint32_t pixel = 0; pixel < PIXELS; pixel++)
        for (enum golden_plane plane = 0; plane < GOLDEN_PLANES; plane++) {
            struct picture other = plain;
            struct golden_difference d;
            if (plane == GOLDEN_RGBA)
                other.rgba[pixel][pixel % 4] ^= 1;
            else if (plane == GOLDEN_DEPTH)
                other.depth[pixel] += 0.25f;
            else
                (plane == GOLDEN_LABEL ? other.label : other.voxel)[pixel] += 7;
            compare(&other, &d);
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
            golden_difference_release(&d);
        }
}

STORY(the_first_difference_is_told_in_words)
{
    struct picture other = plain;
    struct golden_difference d;
    struct buf words = {0};
    other.depth[1] = 12.5f;
    other.label[1] = 9;
    other.rgba[4][0] = 3;
    other.voxel[1] = 201;
    compare(&other, &d);
    CHECK_INT(d.pixels, 2);
    CHECK_INT(d.image[0], 30); /* grey 90 at a third, equal in all channels */
    CHECK_INT(d.image[2], 30);
    golden_describe(&words, &d);
    CHECK_TEXT(buf_text(&words),
               "2 of 6 pixels differ, first column 1, row 0: depth is 12.5 (0x41480000), "
               "2.5 (0x40200000) was expected; labels differ in 1 pixel, voxels differ in 1 pixel; "
               "it shows voxel 201 instead of 200");
    golden_difference_release(&d);
    other = plain;
    other.rgba[0][3] = 0;
    compare(&other, &d);
    CHECK_TEXT(d.expected, "90,90,90,255");
    CHECK_TEXT(d.actual, "90,90,90,0");
    buf_clear(&words);
    golden_describe(&words, &d);
    CHECK_HAS(buf_text(&words), "; colours alone differ, labels and voxels are the same");
    golden_difference_release(&d);
    other.voxel[1] = UINT32_MAX;
    other.rgba[0][3] = 255;
    compare(&other, &d);
    buf_clear(&words);
    golden_describe(&words, &d);
    CHECK_HAS(buf_text(&words), "; it shows nothing instead of voxel 200");
    golden_difference_release(&d);
    other = plain;
    other.depth[3] += 1;
    compare(&other, &d);
    buf_clear(&words);
    golden_describe(&words, &d);
    CHECK_HAS(buf_text(&words), "; depths differ, labels and voxels are the same");
    golden_difference_release(&d);
    buf_release(&words);
}

STORY(depths_are_compared_as_bits)
{
    struct picture other = plain;
    struct golden_difference d;
    other.depth[2] = -0.0f;
    compare(&other, &d);
    CHECK_INT(d.pixels, 1);
    golden_difference_release(&d);
    struct picture nan = plain;
    const uint32_t bits = 0x7fc00000;
    memcpy(&nan.depth[2], &bits, sizeof bits);
    const struct golden_planes a = planes(&nan), b = planes(&nan);
    CHECK(golden_compare(&a, &b, &d, NULL) == OK);
    CHECK(d.is_same);
    golden_difference_release(&d);
}

STORY(another_size_or_a_missing_plane_is_told)
{
    struct golden_difference d;
    struct buf words = {0};
    struct golden_planes a = planes(&plain), b = planes(&plain);
    b.width--;
    CHECK(golden_compare(&a, &b, &d, NULL) == OK);
    CHECK(d.shape_differs && !d.is_same && !d.image);
    golden_describe(&words, &d);
    CHECK_HAS(buf_text(&words), "sizes");
    golden_difference_release(&d);
    b = planes(&plain);
    b.plane[GOLDEN_VOXEL] = NULL;
    CHECK(golden_compare(&a, &b, &d, NULL) == OK);
    CHECK(d.shape_differs);
    a.plane[GOLDEN_VOXEL] = NULL; /* missing in both is fine */
    CHECK(golden_compare(&a, &b, &d, NULL) == OK);
    CHECK(d.is_same);
    a = b = (struct golden_planes){.width = UINT32_MAX, .height = UINT32_MAX};
    CHECK(golden_compare(&a, &b, &d, NULL) == ERR_MEMORY);
    buf_release(&words);
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
    struct buf path = {0};
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
    buf_release(&path);
}
