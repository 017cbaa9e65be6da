/* SPDX-License-Identifier: MIT */
#include "image/nrrd_segments.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/safe.h"
#include "base/scan.h"

enum { SEGMENTS_MOST = 64, VALUE_MOST = 65535 };

struct segment {
    const char *name;
    int name_length;
    int64_t layer, value;
};

/* The value of "SegmentN_KEY:=VALUE", to the end of its line; NULL where there is none. */
static const char *find(const char *bytes, size_t length, unsigned number, const char *key)
{
    char field[48];
    const int n = snprintf(field, sizeof field, "Segment%u_%s:=", number, key);
    for (const char *at = bytes, *end = bytes + length; at && end - at > n;) {
        if (memcmp(at, field, (size_t)n) == 0)
            return at + n;
        at = memchr(at, '\n', (size_t)(end - at));
        at += at != NULL;
    }
    return NULL;
}

static int64_t find_number(const char *bytes, size_t length, unsigned number, const char *key,
                           int64_t usual)
{
    const char *at = find(bytes, length, number, key);
    int64_t value;
    return at && scan_integer(&at, 0, VALUE_MOST, &value) ? value : usual;
}

static bool read_segment(struct segment *segment, const char *bytes, size_t length, unsigned number)
{
    segment->name = find(bytes, length, number, "Name");
    if (!segment->name)
        segment->name = find(bytes, length, number, "ID");
    if (!segment->name)
        return false;
    const size_t left = (size_t)(bytes + length - segment->name);
    const char *end = memchr(segment->name, '\n', left);
    segment->name_length = end ? (int)(end - segment->name) : (int)left;
    segment->name_length -= end && end > segment->name && end[-1] == '\r';
    segment->layer = find_number(bytes, length, number, "Layer", number);
    segment->value = find_number(bytes, length, number, "LabelValue", 1);
    return true;
}

/* "vessel (1), stone (2)" */
static void write_layer(struct buf *out, const struct segment *segment, unsigned count,
                        uint32_t layer)
{
    const char *between = "";
    for (unsigned i = 0; i < count; i++) {
        if (segment[i].layer != layer)
            continue;
        buf_add_text(out, between);
        buf_add_safe(out, segment[i].name, (size_t)segment[i].name_length);
        buf_printf(out, " (%" PRId64 ")", segment[i].value);
        between = ", ";
    }
    if (!*between)
        buf_add_text(out, "none");
}

void nrrd_segments_tell(struct volume_header *out, const char *bytes, size_t length)
{
    struct segment segment[SEGMENTS_MOST];
    struct buf text = {0};
    unsigned count = 0;
    while (count < SEGMENTS_MOST && read_segment(&segment[count], bytes, length, count))
        count++;
    if (count == 0)
        return;
    buf_add_text(&text, out->choice.has_volume ? "the segments " : "layers of segments:");
    if (out->choice.has_volume)
        write_layer(&text, segment, count, out->choice.volume);
    for (uint32_t v = 0; v < out->volumes && v < SEGMENTS_MOST && !out->choice.has_volume; v++) {
        buf_printf(&text, "%s volume=%" PRIu32 " ", v ? ";" : "", v);
        write_layer(&text, segment, count, v);
    }
    safe_copy(out->contents, sizeof out->contents, buf_text(&text), text.length);
    buf_release(&text);
}
