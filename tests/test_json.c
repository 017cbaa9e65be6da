/* SPDX-License-Identifier: MIT */
/* The JSON writer, compared with texts written by hand; and arenas of buffers. */
#include <math.h>

#include "base/file.h"
#include "base/json.h"
#include "tests/check_main.h"
#include "tests/scarce_memory.h"

static struct buf text;

static struct json begin(unsigned lines)
{
    buf_clear(&text);
    return (struct json){.out = &text, .lines = lines};
}

STORY(members_are_parted_by_commas)
{
    struct json json = begin(0);
    json_object(&json, NULL);
    json_text(&json, "file", "a.nii");
    json_array(&json, "size");
    for (int a = 3; a < 6; a++)
        json_count(&json, NULL, (uint64_t)a);
    json_end(&json);
    json_boolean(&json, "whole", true);
    json_boolean(&json, "torn", false);
    json_end(&json);
    CHECK_TEXT(buf_text(&text),
               "{\"file\": \"a.nii\", \"size\": [3, 4, 5], \"whole\": true, \"torn\": false}\n");
}

STORY(what_is_empty_is_closed_at_once)
{
    struct json json = begin(9);
    json_array(&json, NULL);
    json_object(&json, NULL);
    json_end(&json);
    json_array(&json, NULL);
    json_end(&json);
    json_end(&json);
    CHECK_TEXT(buf_text(&text), "[\n  {},\n  []\n]\n");
}

STORY(outer_levels_have_a_line_for_each_member)
{
    struct json json = begin(2);
    json_object(&json, NULL);
    json_object(&json, "entity");
    for (int i = 1; i < 3; i++) {
        json_object(&json, i == 1 ? "one" : "two");
        json_count(&json, "number", (uint64_t)i);
        json_text(&json, "kind", "state");
        json_end(&json);
    }
    json_end(&json);
    json_object(&json, "used");
    json_end(&json);
    json_end(&json);
    CHECK_TEXT(buf_text(&text), "{\n"
                                "  \"entity\": {\n"
                                "    \"one\": {\"number\": 1, \"kind\": \"state\"},\n"
                                "    \"two\": {\"number\": 2, \"kind\": \"state\"}\n"
                                "  },\n"
                                "  \"used\": {}\n"
                                "}\n");
}

STORY(each_outermost_value_is_a_line_and_texts_are_escaped_wherever_they_stand)
{
    struct json json = begin(0);
    json_count(&json, NULL, 1);
    json_object(&json, NULL);
    json_end(&json);
    json_text(&json, NULL, "");
    CHECK_TEXT(buf_text(&text), "1\n{}\n\"\"\n");
    json = begin(0);
    json_object(&json, NULL);
    json_text(&json, "a\"b\\", "\n\033[1m\x7f");
    json_bytes(&json, "zero", "a\0b", 3);
    json_text(&json, "umlaut", "\xc3\xa4");
    json_text(&json, "half", "\xc3");
    json_text(&json, "C1", "\xc2\x9b");
    json_text(&json, "hidden", "\xe2\x80\xae\xf3\xa0\x80\x81");
    json_format(&json, "digest", "%016llx", 0xabcULL);
    json_end(&json);
    CHECK_TEXT(buf_text(&text), "{\"a\\\"b\\\\\": \"\\u000a\\u001b[1m\\u007f\", "
                                "\"zero\": \"a\\u0000b\", \"umlaut\": \"\xc3\xa4\", "
                                "\"half\": \"\\u00c3\", \"C1\": \"\\u009b\", "
                                "\"hidden\": \"\\u202e\\udb40\\udc01\", "
                                "\"digest\": \"0000000000000abc\"}\n");
}

STORY(numbers_are_whole_at_the_ends_of_their_range_and_reals_have_a_point)
{
    struct json json = begin(0);
    json_array(&json, NULL);
    json_count(&json, NULL, UINT64_MAX);
    json_count(&json, NULL, 0);
    json_end(&json);
    CHECK_TEXT(buf_text(&text), "[18446744073709551615, 0]\n");
    json = begin(0);
    json_array(&json, NULL);
    json_fixed(&json, NULL, 1.5, 3);
    json_fixed(&json, NULL, -0.0625, 4);
    json_fixed(&json, NULL, 2.5, 0);
    json_real(&json, NULL, 1.25, 6);
    json_real(&json, NULL, 1e300, 6);
    json_fixed(&json, NULL, (double)NAN, 3);
    json_real(&json, NULL, -(double)INFINITY, 3);
    json_end(&json);
    CHECK_TEXT(buf_text(&text), "[1.500, -0.0625, 2, 1.25, 1e+300, null, null]\n");
    json = begin(0);
    json_fixed(&json, NULL, 1e308, 6); /* the longest number */
    CHECK_INT(text.length, 309 + 7 + 1);
}

STORY(a_failed_buffer_stays_failed)
{
    struct json json = begin(0);
    json_object(&json, NULL);
    text.failed = true;
    json_text(&json, "a", "b");
    json_format(&json, "c", "%d", 1);
    json_end(&json);
    CHECK(text.failed);
    CHECK_TEXT(buf_text(&text), "{");
}

STORY(an_arena_without_memory_for_a_buffer_has_failed_even_if_memory_returns)
{
    struct arena arena = {0};
    buf_add_text(arena_buf(&arena), "one");
    CHECK(!arena_failed(&arena));
    allow_allocations(0);
    struct buf *first = arena_buf(&arena), *second = arena_buf(&arena);
    mem_allows = NULL;
    file_folder(first, "x/y"); /* clears it first */
    CHECK(first->failed && arena_failed(&arena));
    buf_clear(second);
    buf_add_text(second, "two");
    CHECK_TEXT(buf_text(first), "");
    CHECK_TEXT(buf_text(second), "");
    arena_release(&arena);
    CHECK(!arena_failed(&arena));
}
