/* SPDX-License-Identifier: MIT */
/* Lines of a program that drives a session, any bytes at all: each is a request, a cancel or an
 * error in words, in order, and memory is bounded (I1, I2 of program/serve.h). Bytes come in two
 * pieces, parted where the first one says. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/json.h"
#include "program/serve.h"

static void check_request(const struct request *request)
{
    HOLDS(request->id.length > 0 && strlen(buf_text(&request->id)) == request->id.length);
    HOLDS(!strpbrk(buf_text(&request->id), "\n\r"));
    HOLDS(request->fault.code == OK || request->fault.text[0]);
    HOLDS(request->fault.code != OK || request->kind != REQUEST_CANCEL);
    HOLDS(strlen(buf_text(&request->words)) == request->words.length); /* no zero byte */
}

/* A text that was read is written, and read again: it is the same. */
static void check_round(const struct buf *text)
{
    struct buf out = {0};
    struct json json = {.out = &out};
    struct json_member member = {0};
    json_object(&json, NULL);
    json_bytes(&json, "text", buf_text(text), text->length);
    json_end(&json);
    struct json_reader reader = {.bytes = out.data, .length = out.length};
    HOLDS(json_read(&reader, &member, NULL) == OK && member.kind == JSON_TEXT);
    HOLDS(member.text.length == text->length &&
          memcmp(buf_text(&member.text), buf_text(text), text->length) == 0);
    HOLDS(json_read(&reader, &member, NULL) == OK && member.kind == JSON_END);
    json_member_release(&member);
    buf_release(&out);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct inbox inbox = {0};
    struct fault fault;
    if (length < 1)
        return 0;
    const char *at = (const char *)bytes + 1;
    const size_t left = length - 1, first = bytes[0] < left ? bytes[0] : left;
    HOLDS(inbox_take(&inbox, at, first, &fault) == OK);
    for (const struct request *request; (request = inbox_next(&inbox));)
        check_request(request);
    HOLDS(inbox_take(&inbox, at + first, left - first, &fault) == OK);
    HOLDS(inbox_take(&inbox, "\n", 1, &fault) == OK);
    for (const struct request *request; (request = inbox_next(&inbox));) {
        check_request(request);
        check_round(&request->words);
    }
    HOLDS(inbox.bytes == 0 && inbox.count == 0);
    inbox_release(&inbox);
    return 0;
}
