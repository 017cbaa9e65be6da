/* SPDX-License-Identifier: MIT */
/* Requests of `iftty serve`: JSON, keys, order, cancels, limits; and answers. Whole sessions are in
 * test_serve.sh. */
#include "base/json.h"
#include "program/serve.h"
#include "tests/check_main.h"

static struct buf text;
static struct fault fault;

/* ---- JSON input ---- */

static enum err read_whole(const char *bytes, size_t length)
{
    struct json_reader reader = {.bytes = bytes, .length = length};
    OWNED(json_member_release) struct json_member m = {0};
    enum err err;
    buf_clear(&text);
    while (!(err = json_read(&reader, &m, &fault)) && m.kind != JSON_END) {
        buf_printf(&text, "%s:%d", buf_text(&m.key), (int)m.kind);
        if (m.kind == JSON_TEXT)
            buf_printf(&text, "=%s", buf_text(&m.text));
        if (m.kind == JSON_NUMBER)
            buf_printf(&text, "=%" PRId64, m.number);
        buf_add_char(&text, ' ');
    }
    return err;
}

static void reads(const char *json, const char *expected)
{
    CHECK_INT(read_whole(json, strlen(json)), OK);
    CHECK_TEXT(buf_text(&text), expected);
}

static void refuses(const char *json, const char *why)
{
    if (CHECK(read_whole(json, strlen(json)) == ERR_USAGE))
        CHECK_TEXT(fault.text, why);
    else
        printf("#   %s\n", json);
}

STORY(an_object_is_read_member_by_member)
{
    reads("{}", "");
    reads(" { \"a\" : 1 , \"b\":true,\"c\":false,\"d\":null,\"e\":\"\" }\r", "a:2=1 b:3 c:4 d:5 "
                                                                             "e:1= ");
    reads("{\"n\":-0,\"m\":-9007199254740991,\"o\":9007199254740991}",
          "n:2=0 m:2=-9007199254740991 o:2=9007199254740991 ");
}

STORY(texts_and_escapes_are_utf_8)
{
    reads("{\"a\":\"\\\"\\\\\\/\\n\\t\\u0041\\u00e4\\u20AC\\ud83d\\uDE00\"}",
          "a:1=\"\\/\n\tA\xc3\xa4\xe2\x82\xac\xf0\x9f\x98\x80 ");
    refuses("{\"a\":\"\\ud83d\"}", "byte 13: expected surrogates in a pair, the high one first");
    refuses("{\"a\":\"\\ude00\\ud83d\"}",
            "byte 13: expected surrogates in a pair, the high one first");
    refuses("{\"a\":\"\\ud83d\\u0041\"}",
            "byte 19: expected surrogates in a pair, the high one first");
    refuses("{\"a\":\"\\u0000\"}", "byte 13: expected no zero byte in a text");
    refuses("{\"a\":\"\\u00g0\"}", "byte 9: expected four hexadecimal digits");
    refuses("{\"a\":\"\\x\"}", "byte 8: expected one of \"\\/bfnrtu after a backslash");
    refuses("{\"a\":\"\xff\"}", "byte 7: expected UTF-8");
    refuses("{\"a\":\"\xc0\xaf\"}", "byte 7: expected UTF-8");
    refuses("{\"a\":\"\xed\xa0\x80\"}", "byte 7: expected UTF-8");
    refuses("{\"a\":\"b\nc\"}", "byte 8: expected control characters as \\n, \\t or \\u00NN");
    refuses("{\"a\":\"b", "byte 8: expected the quote that ends a text");
    CHECK(read_whole("{\"a\":\"b\0c\"}", 11) == ERR_USAGE);
}

STORY(what_is_no_json_is_refused_where_it_stands)
{
    static const char nests[] =
        "byte 6: expected a text, a number, true, false or null: no object or array is known here";
    static const char whole[] = "expected a whole number of at most 9007199254740991";
    refuses("", "byte 1: expected an object, as in {\"id\": 1}");
    refuses("[1]", "byte 1: expected an object, as in {\"id\": 1}");
    refuses("{\"a\":{}}", nests);
    refuses("{\"a\":[[[[[[", nests);
    refuses("{\"a\" 1}", "byte 6: expected a colon after the key");
    refuses("{\"a\":1,}", "byte 8: expected a key between double quotes");
    refuses("{,\"a\":1}", "byte 2: expected a key between double quotes");
    refuses("{\"a\":1 \"b\":2}", "byte 8: expected a comma, or } at the end of the object");
    refuses("{\"a\":1}{}", "byte 8: expected nothing after the object");
    refuses("{\"a\":tru}", "byte 6: expected a text, a number, true, false or null");
    refuses("{\"a\":1", "byte 7: expected a comma, or } at the end of the object");
    const char *const numbers[] = {
        "01", "1.5", "1e3", "-", "9007199254740992", "+1", "99999999999999999999999"};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char json[64];
        snprintf(json, sizeof json, "{\"a\":%s}", numbers[i]);
        CHECK(read_whole(json, strlen(json)) == ERR_USAGE);
        if (*numbers[i] != '+')
            CHECK_HAS(fault.text, whole);
    }
}

/* ---- requests ---- */

static struct inbox inbox;

static void take(const char *bytes)
{
    CHECK_INT(inbox_take(&inbox, bytes, strlen(bytes), &fault), OK);
}

/* The next request as "ID WORDS", or "ID ! WHY". */
static const char *next(void)
{
    const struct request *r = inbox_next(&inbox);
    buf_clear(&text);
    if (!r)
        return "none";
    buf_printf(&text, "%s ", buf_text(&r->id));
    if (r->fault.code)
        buf_printf(&text, "! %s", r->fault.text);
    else
        buf_printf(&text, "%s%s%s", r->kind == REQUEST_ARRAY ? "array " : "", buf_text(&r->words),
                   r->is_cancelled ? ", cancelled" : "");
    return buf_text(&text);
}
#define INBOX_STORY(told) STORY_WITHIN(told, (void)0, inbox_release(&inbox))

INBOX_STORY(requests_come_in_order_in_any_pieces)
{
    take("{\"id\": 1, \"do\": \"zo");
    CHECK_TEXT(next(), "none");
    take("om 2\"}\r\n\n  \n{\"id\": \"b\\n\", \"array\": \"labels\", \"finished\": true}\n{\"do");
    CHECK_TEXT(next(), "1 zoom 2");
    const struct request *r = inbox_next(&inbox);
    CHECK(r && r->kind == REQUEST_ARRAY && r->finished);
    CHECK_TEXT(buf_text(&r->id), "\"b\\u000a\"");
    take("\": \"info\"}\n");
    CHECK_TEXT(next(), "null info");
    CHECK_TEXT(next(), "none");
}

INBOX_STORY(keys_are_known_given_once_and_go_together)
{
    take("{\"id\": 1, \"du\": \"x\"}\n{\"id\": 2, \"id\": 2}\n{\"id\": 3}\n"
         "{\"id\": 4, \"do\": \"a\", \"array\": \"b\"}\n{\"id\": 5, \"do\": 7}\n"
         "{\"id\": 6, \"cancel\": 1}\n{\"id\": null, \"do\": \"a\"}\n"
         "{\"id\": 7, \"do\": \"a\", \"finished\": true}\n");
    CHECK_TEXT(next(), "1 ! expected do, array or cancel, with id, not the key du");
    CHECK_TEXT(next(), "2 ! id is given twice");
    CHECK_TEXT(next(), "3 ! expected one of the keys do, array and cancel");
    CHECK_TEXT(next(), "4 ! expected one of the keys do, array and cancel");
    CHECK_TEXT(next(), "5 ! do: expected a text");
    CHECK_TEXT(next(), "1 ! cancel has no id of its own: it gets no answer");
    CHECK_TEXT(next(), "null ! id: expected a whole number, or a text of at most 64 bytes");
    CHECK_TEXT(next(), "7 ! finished belongs to array; commands have their own parameters");
    take("{\"finish\": true}\n");
    CHECK_HAS(next(), "did you mean finished?");
}

INBOX_STORY(a_cancel_stops_what_is_at_hand_or_waits_and_nothing_else)
{
    take(
        "{\"id\": 1, \"do\": \"a\"}\n{\"id\": 2, \"do\": \"b\"}\n{\"id\": \"2\", \"do\": \"c\"}\n");
    CHECK_TEXT(next(), "1 a");
    CHECK(!inbox.stops);
    take("{\"cancel\": 2}\n{\"cancel\": 9}\n");
    CHECK(!inbox.stops);
    take("{\"cancel\": 1}\n");
    CHECK(inbox.stops);
    CHECK_TEXT(next(), "2 b, cancelled");
    CHECK_TEXT(next(), "\"2\" c");
    CHECK(!inbox.stops);
    take("{\"cancel\": 1}\n");
    CHECK(!inbox.stops);
}

INBOX_STORY(a_line_that_is_too_long_is_passed_over_and_the_next_is_read)
{
    static char long_line[REQUEST_BYTES_MOST + 2];
    memset(long_line, ' ', sizeof long_line);
    memcpy(long_line, "{\"id\":1,\"do\":\"info\"}", 20);
    CHECK_INT(inbox_take(&inbox, long_line, REQUEST_BYTES_MOST, &fault), OK);
    take("\n");
    CHECK_TEXT(next(), "1 info");
    CHECK_INT(inbox_take(&inbox, long_line, REQUEST_BYTES_MOST + 1, &fault), OK);
    for (int i = 0; i < 8; i++)
        CHECK_INT(inbox_take(&inbox, long_line, REQUEST_BYTES_MOST, &fault), OK);
    CHECK(inbox.line.capacity <= 4 * (size_t)REQUEST_BYTES_MOST);
    take("\n{\"id\":2,\"do\":\"info\"}\n");
    CHECK_TEXT(next(), "null ! the line is longer than 1048576 bytes; it is skipped");
    CHECK_TEXT(next(), "2 info");
}

INBOX_STORY(no_more_is_read_than_there_is_room_for)
{
    for (int i = 0; i < INBOX_WAITING_MOST - 1; i++)
        take("{\"do\":\"zoom 2\"}\n");
    CHECK(inbox_has_room(&inbox));
    take("{\"id\":7,\"do\":\"zoom 2\"}\n");
    CHECK(!inbox_has_room(&inbox));
    for (int i = 0; i < INBOX_WAITING_MOST - 1; i++)
        CHECK_TEXT(next(), "null zoom 2");
    CHECK_TEXT(next(), "7 zoom 2");
    CHECK(inbox_has_room(&inbox) && inbox.bytes == 0);
}

/* ---- answers ---- */

STORY(an_error_has_its_column_in_characters_and_the_words_that_were_meant)
{
    buf_clear(&text);
    fault_set(&fault, ERR_USAGE, "unknown command sed; did you mean seed, set= or \"x?");
    fault.at = 4;
    answer_fault(&text, "\"a\"", &fault, "\xc3\xa4 sed", "one\n");
    CHECK_TEXT(buf_text(&text),
               "{\"id\": \"a\", \"ok\": false, \"kind\": \"bad usage\", \"why\": \"unknown command "
               "sed; did you mean seed, set= or \\\"x?\", \"hints\": [\"seed\", \"set=\", "
               "\"\\\"x\"], \"column\": 3, \"list\": \"one\\u000a\"}\n");
    buf_clear(&text);
    fault_set(&fault, ERR_IO, "no");
    answer_fault(&text, "1", &fault, "line", "");
    CHECK_TEXT(buf_text(&text), "{\"id\": 1, \"ok\": false, \"kind\": \"input or output failed\", "
                                "\"why\": \"no\", \"hints\": []}\n");
}

STORY(words_of_a_record_are_numbers_where_they_are_counts)
{
    struct interpreter interp = {.acknowledged = 3};
    OWNED(reply_release) struct reply reply = {0};
    buf_clear(&text);
    buf_add_text(&reply.words,
                 "seeds=123456789012345 forest=1123456789012345 marker=3-4 at=0 old=007");
    buf_add_text(&reply.canonical, "run");
    buf_add(&reply.files, "a\0b", 4);
    answer_command(&text, "1", &interp, &reply, NULL);
    CHECK_TEXT(buf_text(&text),
               "{\"id\": 1, \"ok\": true, \"record\": null, \"command\": \"run\", \"text\": \"\", "
               "\"words\": {\"seeds\": 123456789012345, \"forest\": \"1123456789012345\", "
               "\"marker\": \"3-4\", "
               "\"at\": 0, \"old\": \"007\"}, \"files\": [\"a\", \"b\"], \"journal\": null}\n");
}
