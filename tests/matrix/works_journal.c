/* SPDX-License-Identifier: MIT */
/* Records and their chain, walks over whole and broken journals, replay, golden images. */
#include "tests/matrix/works.h"

#include <unistd.h>

#include "base/file.h"
#include "journal/golden.h"
#include "journal/journal.h"
#include "journal/replay.h"
#include "tests/check.h"

enum { RECORDS = 200 };

static void write_journal(const char *path)
{
    OWNED(journal_drop) struct journal *journal = NULL;
    struct fault fault;
    uint64_t random = 99;
    must(journal_create(&journal, path, 7, &fault), &fault, "a journal");
    for (unsigned i = 0; i < RECORDS; i++) {
        char command[100], words[100];
        const uint32_t x = check_below(&random, 181), y = check_below(&random, 217);
        snprintf(command, sizeof command, "seed %u,%u,90 %u", x, y, i % 7);
        snprintf(words, sizeof words, "forest=%016" PRIx64 " seeds=%u", check_random(&random), i);
        if (i % 9 == 4)
            must(journal_comment(journal, "# why", &fault), &fault, "a comment");
        must(journal_append(journal, command, i % 11 ? words : "", &fault), &fault, "a record");
    }
}

/* Result of journal_check for bytes, as one digest. */
static uint64_t condition_digest(const char *bytes, size_t length)
{
    struct journal_condition c;
    struct fault fault = {0};
    char text[1024];
    const enum err err = journal_check(&c, bytes, length, &fault);
    snprintf(text, sizeof text, "%d %d %zu %s %u %zu %zu %" PRIu64 " %s", err, c.state, c.records,
             c.chain.hex, c.semantics, c.number, c.line, c.offset, c.text);
    return bytes_digest(text, strlen(text));
}

/* Cut and flipped at many places. */
static void broken(struct buf *bytes)
{
    for (size_t at = 1; at < bytes->length; at += 1 + bytes->length / 40) {
        tell(condition_digest(bytes->data, at), "journal/cut-%zu", at);
        bytes->data[at] ^= 1;
        tell(condition_digest(bytes->data, bytes->length), "journal/flipped-%zu", at);
        bytes->data[at] ^= 1;
    }
}

static enum err echo(void *context, const char *command, struct buf *words, struct fault *fault)
{
    unsigned *executed = context;
    (void)fault;
    buf_printf(words, "command=%016" PRIx64 " seeds=%u", bytes_digest(command, strlen(command)),
               (*executed)++);
    return words->failed ? ERR_MEMORY : OK;
}

/* A replay that diverges at once, since it returns no word of the record. */
static void replay(const struct buf *bytes)
{
    static const struct replay_options options = {0};
    unsigned executed = 0;
    const struct replay_host host = {.context = &executed, .execute = echo};
    OWNED(replay_report_release) struct replay_report report = {0};
    struct fault fault = {0};
    const enum err err = replay_run(bytes->data, bytes->length, &host, &options, &report, &fault);
    must_hold(err == ERR_CHECK && report.outcome == REPLAY_DIVERGED, "a replay that diverges");
    tell(bytes_digest(fault.text, strlen(fault.text)), "journal/replay");
}

static void golden(void)
{
    enum { SIDE = 16 };
    uint8_t rgba[2][SIDE * SIDE * 4];
    float depth[2][SIDE * SIDE];
    uint32_t voxel[2][SIDE * SIDE];
    OWNED(golden_difference_release) struct golden_difference difference = {0};
    OWNED(buf_release) struct buf text = {0};
    struct fault fault;
    uint64_t random = 4;
    for (int i = 0; i < SIDE * SIDE; i++) {
        for (int k = 0; k < 4; k++)
            rgba[0][4 * i + k] = (uint8_t)check_below(&random, 256);
        depth[0][i] = (float)check_below(&random, 100000) / 16;
        voxel[0][i] = check_below(&random, 7000000);
    }
    memcpy(rgba[1], rgba[0], sizeof rgba[0]);
    memcpy(depth[1], depth[0], sizeof depth[0]);
    memcpy(voxel[1], voxel[0], sizeof voxel[0]);
    depth[1][77] += 0.5f;
    voxel[1][90]++;
    rgba[1][1001] ^= 1;
    const struct golden_planes a = {SIDE, SIDE, {rgba[0], depth[0], NULL, voxel[0]}},
                               b = {SIDE, SIDE, {rgba[1], depth[1], NULL, voxel[1]}};
    must(golden_compare(&a, &b, &difference, &fault), &fault, "a comparison");
    golden_describe(&text, &difference);
    tell(bytes_digest(buf_text(&text), text.length), "golden/words");
    tell(bytes_digest(difference.image, SIDE * SIDE * 4), "golden/image");
}

void works_journal(const char *folder)
{
    OWNED(buf_release) struct buf path = {0}, bytes = {0};
    struct fault fault;
    buf_printf(&path, "%s/works.iftty", folder);
    unlink(buf_text(&path));
    write_journal(buf_text(&path));
    must(file_read(&bytes, buf_text(&path), JOURNAL_BYTES_MAX, &fault), &fault, "the journal");
    unlink(buf_text(&path));
    tell(bytes_digest(bytes.data, bytes.length), "journal/bytes");
    tell(condition_digest(bytes.data, bytes.length), "journal/whole");
    broken(&bytes);
    replay(&bytes);
    golden();
}
