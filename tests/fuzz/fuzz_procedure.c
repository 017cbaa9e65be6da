/* SPDX-License-Identifier: MIT */
/* Procedures: what is read is written again as the same bytes, and says nothing that the engine or
 * a command could not bear. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "apply/procedure.h"

enum { VOXELS_MOST = 1 << 22 };

/* The digest would let no change through, so it is made right. */
static void seal(struct buf *text, const uint8_t *bytes, size_t length)
{
    static const char word[] = "digest ";
    char digest[SHA256_HEX];
    size_t end = length;
    while (end > 0 && (end == length || bytes[end - 1] != '\n'))
        end--;
    buf_add(text, bytes, end);
    sha256_bytes_hex(digest, buf_text(text), text->length);
    buf_add_text(text, word);
    buf_add_text(text, digest);
    buf_add_char(text, '\n');
}

/* Whether its size would take long here, where nothing else is wrong with it. */
static bool is_large(const char *text)
{
    const char *at = strstr(text, "\nsize ");
    unsigned long size[3] = {0};
    return at && sscanf(at, "\nsize %5lu %5lu %5lu", &size[0], &size[1], &size[2]) == 3 &&
           size[0] * size[1] * size[2] > VOXELS_MOST;
}

static void check(const struct procedure *p)
{
    struct affine inverse;
    HOLDS(affine_invert(&inverse, &p->to_mm));
    for (size_t i = 0; i < p->gestures; i++) {
        HOLDS(p->gesture[i].corners > 0);
        HOLDS(p->gesture[i].corner + p->gesture[i].corners <= p->corners);
        HOLDS(p->gesture[i].radius_mm >= 0 && p->gesture[i].within_mm >= 0);
    }
    for (unsigned l = 0; l < 256; l++) {
        HOLDS(memchr(p->label[l].name, '\0', sizeof p->label[l].name));
        HOLDS(!strpbrk(p->label[l].name, "\n\r\033\""));
        HOLDS(p->label[l].low <= p->label[l].high);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t length)
{
    struct procedure procedure = {.has_place = false};
    struct buf text = {0}, written = {0};
    struct fault fault = {.text = ""};
    seal(&text, bytes, length);
    if (!text.failed && !is_large(buf_text(&text))) {
        const enum err err = procedure_read(&procedure, buf_text(&text), text.length, &fault);
        HOLDS(!err || (fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
        if (!err) {
            check(&procedure);
            procedure_write(&written, &procedure);
            procedure_release(&procedure);
            HOLDS(procedure_read(&procedure, buf_text(&written), written.length, &fault) == OK);
        }
    }
    procedure_release(&procedure);
    buf_release(&text);
    buf_release(&written);
    return 0;
}
