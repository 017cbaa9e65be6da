/* SPDX-License-Identifier: MIT */
/* The pure parts of a verification: what a difference means, results on their way through a pipe,
 * text in markup, and pictures as PNG. */
#include <zlib.h>

#include "verify/replay_file.h"
#include "verify/verify.h"
#include "verify/verify_inside.h"
#include "image/png.h"
#include "journal/record.h"
#include "tests/check_main.h"

/* ---- words ---- */

static void check_meaning(const char *expected, const char *actual, const char *part)
{
    OWNED(buf_release) struct buf lines = {0};
    divergence_describe(&lines, expected, actual, DIVERGENCE_OF_REPLAY);
    CHECK_HAS(buf_text(&lines), part);
    for (const char *at = buf_text(&lines); *at; at = strchr(at, '\n') + 1)
        CHECK(strncmp(at, "#   ", 4) == 0); /* TAP takes them as comments */
}

STORY(a_difference_is_told_by_what_it_means)
{
    check_meaning("forest=1 labels=2 seeds=3", "forest=9 labels=2 seeds=3", "only keys differ");
    check_meaning("forest=1 labels=2 seeds=3", "forest=9 labels=8 seeds=3", "labels differ");
    check_meaning("forest=1 labels=2", "forest=1 labels=8", "labels differ");
    check_meaning("picture=5 forest=1 labels=2", "picture=6 forest=1 labels=2",
                  "only the picture differs");
    check_meaning("picture=5", "picture=6", "says nothing of the forest");
    check_meaning("picture=5 forest=1 labels=2", "picture=6 forest=3 labels=2", "only keys");
    check_meaning("spin=5", "spin=6", "the picture differs");
    check_meaning("scene=1 size=2,2,2", "scene=2 size=2,2,2", "the scene is another one");
    check_meaning("file=1 added=3 forest=1 labels=1", "file=2 added=3 forest=2 labels=2",
                  "a file that the command read");
    check_meaning("weights=1 forest=1 labels=1", "weights=2 forest=2 labels=2", "the arc weights");
}

STORY(counts_tell_how_many_more_or_less)
{
    check_meaning("seeds=12", "seeds=9", "seeds: 12 was recorded, 9 now (3 less)");
    check_meaning("inside=100", "inside=101", "inside: 100 was recorded, 101 now (1 more)");
    check_meaning("seeds=12", "", "seeds: 12 was recorded, nothing now\n");
    check_meaning("a=1 b=2 c=3", "c=3 b=9 a=1", "the same a, c\n");
    OWNED(buf_release) struct buf lines = {0};
    divergence_describe(&lines, "forest=1234567890123456 size=1,2,3",
                        "forest=1234567890123457 size=1,2,4", DIVERGENCE_OF_JOURNALS);
    CHECK(!strstr(buf_text(&lines), "more")); /* a digest of digits is no count */
    buf_clear(&lines);
    divergence_describe(&lines, "a=\x1b[31m", "a=2", DIVERGENCE_OF_REPLAY);
    CHECK(!strchr(buf_text(&lines), '\x1b'));
}

/* ---- two journals ---- */

/* `count` records; from `other` on (0: none) a result differs, from `comment` on there is one. */
static void make_journal(struct buf *out, size_t count, size_t other, size_t comment)
{
    OWNED(buf_release) struct buf header = {0};
    struct record_chain chain = record_chain_zero;
    record_header(&header, 3);
    buf_clear(out);
    buf_add_text(out, buf_text(&header));
    for (size_t n = 1; n <= count; n++) {
        char words[40];
        snprintf(words, sizeof words, "forest=%zu labels=7", other && n >= other ? n + 1000 : n);
        const struct record record = {.number = n, .command = "turn 1", .result = words};
        CHECK(record_encode(out, &chain, n == 1 ? buf_text(&header) : "",
                            n == comment ? "# why\n" : "", &record, NULL) == OK);
    }
}

static void check_first(const struct buf two[2], enum err err, size_t number)
{
    static const char *const name[2] = {"a", "b"};
    OWNED(first_difference_release) struct first_difference first = {0};
    CHECK_INT(first_difference_find(&first, FIRST_RECORD, name, two, 0, NULL), err);
    if (!err)
        CHECK_INT(first.is_there ? first.same + 1 : 0, number);
    for (int i = 0; i < 2 && !err; i++)
        if (first.side[i].has_command)
            CHECK_INT(first.side[i].number, number);
}

STORY(the_first_record_that_differs_is_found)
{
    struct buf two[2] = {{0}, {0}};
    for (size_t count = 0; count < 20; count++)
        for (size_t other = 0; other <= count; other++) {
            make_journal(two, count, 0, 0);
            make_journal(two + 1, count, other, 0);
            check_first(two, OK, other);
            make_journal(two, count, other, 0);
            make_journal(two + 1, count, other, other / 2);
            check_first(two, OK, 0); /* comments are no results */
        }
    make_journal(two, 1000, 0, 3);
    make_journal(two + 1, 1000, 900, 0);
    check_first(two, OK, 900);
    make_journal(two + 1, 998, 0, 0);
    check_first(two, OK, 999);
    two[1].data[two[1].length / 2] ^= 1;
    check_first(two, ERR_INPUT, 0);
    make_journal(two + 1, 1000, 2, 0);
    two[1].data[two[1].length / 2] ^= 1; /* after the first that differs */
    check_first(two, ERR_INPUT, 0);
    buf_release(two);
    buf_release(two + 1);
}

/* ---- results on their way through a pipe ---- */

static void make_result(struct verify_result *r)
{
    static const uint8_t pixel[8] = {255, 0, 0, 255, 0, 255, 0, 255};
    *r = (struct verify_result){.err = ERR_CHECK,
                                .executed = 12,
                                .compared = 7,
                                .digests = 9,
                                .evidence = {.goldens = 1, .pixels = 4},
                                .took_ms = 1234};
    buf_add_text(&r->why, "it differs");
    buf_add_text(&r->lines, "# one\n# two\n");
    buf_add_text(&r->chain, "0123456789abcdef0123456789abcdef");
    evidence_add(&r->evidence, "expected", 2, 1, pixel);
    evidence_add(&r->evidence, "actual", 1, 2, pixel);
}

STORY(a_result_comes_back_as_it_was_sent)
{
    OWNED(verify_result_release) struct verify_result sent, got = {.path = "a"};
    OWNED(buf_release) struct buf bytes = {0};
    make_result(&sent);
    verify_result_write(&bytes, &sent);
    CHECK(verify_result_read(&got, &bytes, NULL) == OK);
    CHECK_TEXT(got.path, "a");
    CHECK(got.err == ERR_CHECK);
    CHECK_INT(got.executed, 12);
    CHECK_INT(got.compared, 7);
    CHECK_INT(got.digests, 9);
    CHECK_INT(got.evidence.goldens, 1);
    CHECK_INT(got.evidence.pixels, 4);
    CHECK_TEXT(buf_text(&got.chain), "0123456789abcdef0123456789abcdef");
    CHECK_INT(got.took_ms, 1234);
    CHECK_TEXT(buf_text(&got.why), "it differs");
    CHECK_TEXT(buf_text(&got.lines), "# one\n# two\n");
    CHECK_INT(got.evidence.pictures, 2);
    for (int i = 0; i < 2; i++) {
        const struct buf *a = &got.evidence.picture[i].png, *b = &sent.evidence.picture[i].png;
        CHECK_TEXT(buf_text(&got.evidence.picture[i].caption), i ? "actual" : "expected");
        CHECK(a->length == b->length && memcmp(a->data, b->data, a->length) == 0);
    }
}

static void check_refused(const char *bytes, size_t length)
{
    OWNED(verify_result_release) struct verify_result got = {.path = NULL};
    OWNED(buf_release) struct buf text = {0};
    buf_add(&text, bytes, length);
    CHECK(verify_result_read(&got, &text, NULL) == ERR_INPUT);
}

/* What differs in length, all of it empty. */
#define PARTS "part 0\npart 0\npart 0\npart 0\npart 0\n"

STORY(half_a_result_is_none)
{
    static const char *const wrong[] = {
        "result 99 0 0 0 0 0 0 0\n" PARTS,
        "result 1 0 0 0 0 0 0 0\npart 9999999999999\n" PARTS,
        "result 1 0 0 0 0 0 0 4\n" PARTS,
        "result -1 0 0 0 0 0 0 0\n" PARTS,
        "result 0 0 0 0 0 0 0 0\n" PARTS "\n",
        "result 0 0 0 0 0 0 0 1\n" PARTS "part 1\n",
        "result 0 0 0 0 0 0 0 1\n" PARTS "part -1\n",
    };
    struct verify_result sent;
    OWNED(buf_release) struct buf bytes = {0};
    make_result(&sent);
    verify_result_write(&bytes, &sent);
    for (size_t length = 0; length < bytes.length; length++)
        check_refused(bytes.data, length);
    buf_clear(&bytes);
    buf_add_text(&bytes, "result 0 0 0 0 0 0 0 0\n" PARTS); /* the least that is whole */
    verify_result_release(&sent);
    sent = (struct verify_result){.path = NULL};
    CHECK(verify_result_read(&sent, &bytes, NULL) == OK);
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++)
        check_refused(wrong[i], strlen(wrong[i]));
    verify_result_release(&sent);
}

/* ---- reports ---- */

STORY(text_from_outside_cannot_be_markup)
{
    OWNED(buf_release) struct buf out = {0};
    markup_add(&out, "a<b>&\"c'\x1b\n\xff", "");
    CHECK_TEXT(buf_text(&out), "a&lt;b&gt;&amp;&quot;c&#39;\\x1b\n\\xff");
    buf_clear(&out);
    markup_add(&out, "\xEF\xBF\xBE!\xEF\xBF\xBF", ""); /* XML has no such characters */
    CHECK_TEXT(buf_text(&out), "\\xef\\xbf\\xbe!\\xef\\xbf\\xbf");
}

STORY(bytes_as_base64)
{
    static const char *const c[][2] = {{"", ""},
                                       {"f", "Zg=="},
                                       {"fo", "Zm8="},
                                       {"foo", "Zm9v"},
                                       {"foob", "Zm9vYg=="},
                                       {"fooba", "Zm9vYmE="},
                                       {"foobar", "Zm9vYmFy"},
                                       {"\xff\xff\xbe", "//++"}};
    OWNED(buf_release) struct buf out = {0};
    for (size_t i = 0; i < sizeof c / sizeof c[0]; i++) {
        buf_clear(&out);
        buf_add_base64(&out, c[i][0], strlen(c[i][0]));
        CHECK_TEXT(buf_text(&out), c[i][1]);
    }
}

STORY(a_report_names_what_failed_and_how)
{
    struct verify_result r[2] = {{.executed = 5, .compared = 5, .took_ms = 1005}};
    OWNED(buf_release) struct buf out = {0};
    make_result(r + 1);
    r[0].path = "fine.iftty";
    r[1].path = "<script>.iftty";
    verify_report_text(&out, VERIFY_JUNIT, r, 2);
    CHECK_HAS(buf_text(&out),
              "tests=\"2\" failures=\"1\" errors=\"0\" skipped=\"0\" time=\"2.239\"");
    CHECK_HAS(buf_text(&out), "name=\"fine.iftty\" time=\"1.005\"/>");
    CHECK_HAS(buf_text(&out), "message=\"it differs\"># one\n# two\n</failure>");
    buf_clear(&out);
    verify_report_text(&out, VERIFY_HTML, r, 2);
    CHECK_HAS(buf_text(&out), "<h1>1 verified, <span class=\"failed\">1 failed</span></h1>");
    CHECK_HAS(buf_text(&out), "<h2>&lt;script&gt;.iftty</h2>");
    CHECK(!strstr(buf_text(&out), "<script"));
    CHECK_HAS(buf_text(&out), "src=\"data:image/png;base64,iVBORw0KGgo");
    buf_clear(&out);
    verify_report_text(&out, VERIFY_JSON, r, 2);
    CHECK_TEXT(buf_text(&out),
               "{\n"
               "  \"verified\": 1,\n"
               "  \"failed\": 1,\n"
               "  \"ms\": 2239,\n"
               "  \"journals\": [\n"
               "    {\"journal\": \"fine.iftty\", \"verified\": true, \"commands\": 5, "
               "\"results_the_same\": 5, \"digests\": 0, \"golden_images\": 0, \"pixels\": 0, "
               "\"ms\": 1005},\n"
               "    {\"journal\": \"<script>.iftty\", \"verified\": false, \"commands\": 12, "
               "\"results_the_same\": 7, \"digests\": 9, \"golden_images\": 1, \"pixels\": 4, "
               "\"chain\": \"0123456789abcdef0123456789abcdef\", "
               "\"ms\": 1234, \"kind\": \"check failed\", "
               "\"why\": \"it differs\", \"lines\": [\"# one\", \"# two\"]}\n"
               "  ]\n"
               "}\n");
    verify_result_release(r + 1);
}

/* ---- PNG ---- */

static uint32_t number_at(const char *bytes)
{
    const uint8_t *b = (const uint8_t *)bytes;
    return (uint32_t)b[0] << 24 | (uint32_t)b[1] << 16 | (uint32_t)b[2] << 8 | b[3];
}

STORY(a_picture_as_png_holds_its_pixels)
{
    enum { WIDTH = 5, HEIGHT = 3, LINE = 1 + 4 * WIDTH };
    uint8_t rgba[WIDTH * HEIGHT * 4], lines[LINE * HEIGHT + 1];
    uint64_t state = 7;
    OWNED(buf_release) struct buf out = {0};
    uLongf length = sizeof lines;
    for (size_t i = 0; i < sizeof rgba; i++)
        rgba[i] = (uint8_t)check_random(&state);
    CHECK(png_encode(&out, WIDTH, HEIGHT, rgba, NULL) == OK);
    CHECK(memcmp(out.data, "\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\5\0\0\0\3\10\6\0\0\0", 29) == 0);
    const char *data = out.data + 33;
    const uint32_t packed = number_at(data);
    CHECK(memcmp(data + 4, "IDAT", 4) == 0);
    CHECK_INT(number_at(data + 8 + packed), crc32_z(0, (const Bytef *)data + 4, packed + 4));
    CHECK_INT(8 + 25 + 12 + packed + 12, out.length);
    CHECK(uncompress(lines, &length, (const Bytef *)data + 8, packed) == Z_OK);
    CHECK_INT(length, LINE * HEIGHT);
    for (size_t y = 0; y < HEIGHT; y++) {
        CHECK_INT(lines[y * LINE], 0);
        CHECK(memcmp(lines + y * LINE + 1, rgba + y * 4 * WIDTH, 4 * WIDTH) == 0);
    }
    CHECK(png_encode(&out, 0, 3, rgba, NULL) == ERR_LIMIT);
    CHECK(png_encode(&out, 3, 16385, rgba, NULL) == ERR_LIMIT);
}
