/* SPDX-License-Identifier: MIT */
/* Readers of texts: a setup, tables of labels, procedures, requests, lists of seeds, transforms. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "apply/procedure.h"
#include "base/buf.h"
#include "base/json.h"
#include "base/safe.h"
#include "helper/itk_transform.h"
#include "program/programs.h"
#include "program/serve.h"
#include "session/map.h"
#include "session/seed_file.h"
#include "session/setting.h"
#include "show/label_table.h"
#include "tui/pilot/pilot_keys.h"

/* What a user has written down: whatever it is, the setup can be used, and what is printed and
 * carried out of it is text. */

static void check_lines(const struct buf *text)
{
    HOLDS(!text->failed);
    for (const char *at = buf_text(text); *at; at += *at == '\n') {
        const size_t n = strcspn(at, "\n");
        for (size_t i = 0, step; i < n; i += step) {
            step = safe_character(at + i, n - i);
            HOLDS(step > 0);
        }
        at += n;
    }
    HOLDS(strlen(buf_text(text)) == text->length);
}

void fuzz_config(const uint8_t *bytes, size_t length)
{
    OWNED(config_release) struct config config = {.setup = pilot_setup_default};
    struct pilot_state state;
    const struct pilot_facts facts = {.zoom = 1000};
    OWNED(buf_release) struct buf page = {0};
    buf_add_text(&config.path, "config");
    config_take(&config, (const char *)bytes, length);
    check_lines(&config.words);
    check_lines(&config.start);
    const struct pilot_setup *setup = &config.setup;
    HOLDS(setup->brush.label < 256 && setup->brush.radius <= 64);
    HOLDS(setup->windows <= SETUP_WINDOWS_MOST);
    for (size_t i = 0; i < setup->windows; i++)
        HOLDS(setup->window[i].width > 0 && memchr(setup->window[i].name, '\0', SETUP_NAME_BYTES));
    pilot_state_init(&state, setup);
    pilot_keys_page(&page, &(struct pilot_keys_wish){setup, false, 80, NULL, NULL, NULL});
    for (enum pilot_mode mode = PILOT_MOVING; mode <= PILOT_WINDOWING; mode++) {
        state.mode = mode;
        pilot_keys_hint(&state, &facts, "", &page);
    }
    check_lines(&page);
}

/* Tables of labels: what is read gives labels names that a command can hold, and colours; what is
 * written can be read again. */

static void check_names(const struct kept *kept)
{
    for (unsigned l = 0; l < 256; l++) {
        const char *name = kept->label_name[l];
        const size_t length = strnlen(name, LABEL_NAME_BYTES);
        HOLDS(length < LABEL_NAME_BYTES);
        for (size_t i = length; i < LABEL_NAME_BYTES; i++)
            HOLDS(name[i] == '\0');
        HOLDS(!*name || label_name_fits(name));
        const char *code = kept->label_code[l];
        HOLDS(!*code || label_code_fits(code));
        for (size_t i = strnlen(code, LABEL_CODE_BYTES); i < LABEL_CODE_BYTES; i++)
            HOLDS(code[i] == '\0');
    }
}

static bool take(struct kept *kept, const struct label_table *table)
{
    struct label_tally tally;
    OWNED(regions_release) struct regions regions;
    HOLDS(regions_read(&regions, NULL, NULL, NULL) == OK);
    const enum err err = label_table_apply(kept, &tally, table, &regions, NULL);
    return err == OK;
}

void fuzz_labels(const uint8_t *bytes, size_t length)
{
    static const enum label_table_format format[] = {TABLE_ITKSNAP, TABLE_SLICER, TABLE_FREESURFER,
                                                     TABLE_BIDS};
    static const bool used[256] = {[7] = true};
    struct state state = state_default();
    struct label_table table, again;
    struct label_writing writing;
    OWNED(buf_release) struct buf text = {0}, written = {0};
    buf_add(&text, bytes, length);
    if (label_table_read_lut(&table, bytes, length, NULL) == OK)
        HOLDS(take(&state.kept, &table));
    label_table_release(&table);
    if (label_table_read(&table, buf_text(&text), length, true, NULL) == OK &&
        take(&state.kept, &table)) {
        check_names(&state.kept);
        label_table_write(&written, &writing, format[length % 3], &state.kept, used);
        HOLDS(label_table_read(&again, buf_text(&written), written.length, false, NULL) == OK);
        label_table_release(&again);
    }
    label_table_release(&table);
}

/* Procedures: what is read is written again as the same bytes, and says nothing that the engine or
 * a command could not bear. */

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

/* True if the procedure is valid except for a size that would be slow here. */
static bool is_large(const char *text)
{
    const char *at = strstr(text, "\nsize ");
    unsigned long size[3] = {0};
    return at && sscanf(at, "\nsize %5lu %5lu %5lu", &size[0], &size[1], &size[2]) == 3 &&
           size[0] * size[1] * size[2] > VOXELS_MOST;
}

static void check_procedure(const struct procedure *p)
{
    struct affine inverse;
    HOLDS(affine_invert(&inverse, &p->to_mm));
    for (size_t i = 0; i < p->gestures; i++) {
        HOLDS(p->gesture[i].corners > 0);
        HOLDS(p->gesture[i].corner + p->gesture[i].corners <= p->corners);
        HOLDS(p->gesture[i].radius_mm >= 0);
        HOLDS(p->gesture[i].within_mm >= 0 || p->gesture[i].within_mm == GESTURE_EXACT);
    }
    for (unsigned l = 0; l < 256; l++) {
        HOLDS(memchr(p->label[l].name, '\0', sizeof p->label[l].name));
        HOLDS(!strpbrk(p->label[l].name, "\n\r\033\""));
        HOLDS(p->label[l].low <= p->label[l].high);
    }
}

void fuzz_procedure(const uint8_t *bytes, size_t length)
{
    struct procedure procedure = {.has_place = false};
    OWNED(buf_release) struct buf text = {0}, written = {0};
    struct fault fault = {.text = ""};
    seal(&text, bytes, length);
    if (!text.failed && !is_large(buf_text(&text))) {
        const enum err err = procedure_read(&procedure, buf_text(&text), text.length, &fault);
        HOLDS(!err || (fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
        if (!err) {
            check_procedure(&procedure);
            procedure_write(&written, &procedure);
            procedure_release(&procedure);
            HOLDS(procedure_read(&procedure, buf_text(&written), written.length, &fault) == OK);
        }
    }
    procedure_release(&procedure);
}

/* Lines of a program that drives a session, any bytes at all: each is a request, a cancel or an
 * error in words, in order, and memory is bounded (I1, I2 of program/serve.h). Bytes come in two
 * pieces, parted where the first one says. */

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
    OWNED(buf_release) struct buf out = {0};
    struct json json = {.out = &out};
    OWNED(json_member_release) struct json_member member = {0};
    json_object(&json, NULL);
    json_bytes(&json, "text", buf_text(text), text->length);
    json_end(&json);
    struct json_reader reader = {.bytes = out.data, .length = out.length};
    HOLDS(json_read(&reader, &member, NULL) == OK && member.kind == JSON_TEXT);
    HOLDS(member.text.length == text->length &&
          memcmp(buf_text(&member.text), buf_text(text), text->length) == 0);
    HOLDS(json_read(&reader, &member, NULL) == OK && member.kind == JSON_END);
}

void fuzz_request(const uint8_t *bytes, size_t length)
{
    OWNED(inbox_release) struct inbox inbox = {0};
    struct fault fault;
    if (length < 1)
        return;
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
}

/* Lists of seeds: what is read lies in the scene, each voxel once, with a label; the rest is
 * refused with the line that is wrong. */

void fuzz_seeds(const uint8_t *bytes, size_t length)
{
    static const struct kept kept = {.label_name = {[2] = "brain", [9] = "left part"}};
    struct grid grid;
    OWNED(buf_release) struct buf text = {0};
    HOLDS(grid_init(&grid, (const uint32_t[]){90, 80, 70}, NULL) == OK);
    buf_add(&text, bytes, length);
    for (int label = LABEL_OWN; label <= 3; label += 3 - LABEL_OWN) {
        OWNED(seeds_release) struct seeds seeds = {0};
        struct fault fault = {.text = ""};
        const enum err err =
            seeds_from_list(&seeds, buf_text(&text), length, &grid, &kept, label, NULL, &fault);
        HOLDS(!err || (seeds.count == 0 && fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
        for (size_t i = 0; i < seeds.count; i++) {
            const struct edit *edit = &seeds.edit[i];
            HOLDS(edit->cell < grid.cells && (i == 0 || edit->cell > edit[-1].cell));
            HOLDS(label == LABEL_OWN ? edit->label >= 0 && edit->label <= 255
                                     : edit->label == label);
        }
    }
}

/* Transforms of ITK, as text and as MATLAB's: what is read has a name, and a refusal has words and
 * leaves the map alone. */
void fuzz_transform(const uint8_t *bytes, size_t length)
{
    OWNED(buf_release) struct buf text = {0}, kind = {0};
    struct affine out = {{{42}}};
    struct fault fault = {.text = ""};
    buf_add(&text, bytes, length);
    if (itk_transform_read(&out, &kind, buf_text(&text), length, &fault))
        HOLDS(*fault.text && out.m[0][0] >= 42 && out.m[0][0] <= 42);
    else
        HOLDS(kind.length > 0);
}
