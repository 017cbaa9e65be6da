/* SPDX-License-Identifier: MIT */
/* Cost of a journal: records alone, recording a session, verifying it. */
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "command/golden_files.h"
#include "tests/bench/times.h"
#include "journal/journal.h"
#include "journal/record.h"
#include "session/session.h"
#include "session/session_inside.h"
#include "show/draw.h"
#include "verify/replay_file.h"

enum { RECORDS = 100000, ROUNDS = 5, VERIFYINGS = 3 };

struct figures {
    char name[128];            /* of the journal */
    size_t records;            /* of the journal */
    size_t many_bytes;         /* of RECORDS records */
    double encode_ms, read_ms; /* RECORDS records */
    double scene_ms, forest_ms, rendition_ms, verify_ms;
    double record_ms, synced_ms; /* all records of the journal, appended without and with a sync */
    bool is_unsynced;            /* record_ms could be taken: there is a folder in memory */
    struct bench_resume resume;  /* commands 0 where it was not timed */
};

/* ---- many records ---- */

static void encode_many(struct buf *out)
{
    struct record_chain chain = record_chain_zero;
    char command[64], words[128];
    OWNED(buf_release) struct buf header = {0};
    buf_clear(out);
    record_header(out, SEMANTICS);
    buf_add(&header, out->data, out->length);
    for (unsigned i = 0; i < RECORDS; i++) {
        snprintf(command, sizeof command, "seed %u,%u,%u %u radius=2", i % 181, i % 217, i % 179,
                 i % 9);
        snprintf(words, sizeof words, "forest=%016llx labels=%016llx seeds=%u",
                 i * 0x9e3779b97f4a7c15ull, i * 0xc4ceb9fe1a85ec53ull, i);
        const struct record record = {.number = i + 1, .command = command, .result = words};
        must(record_encode(out, &chain, i ? "" : buf_text(&header), "", &record, &bench_fault));
    }
}

static void read_many(const struct buf *bytes)
{
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    must(walk_begin(&walk, bytes->data, bytes->length, &bench_fault));
    while (walk_next_sound(&walk, &record) == WALK_RECORD)
        ;
    if (walk.over != WALK_END || walk.records != RECORDS)
        must(fault_set(&bench_fault, ERR_CHECK, "%zu of %d records were read: %s", walk.records,
                       RECORDS, walk.fault.text));
}

static void time_many(struct figures *f)
{
    OWNED(buf_release) struct buf bytes = {0};
    struct times encode = {.count = 0}, read = {.count = 0};
    for (int i = 0; i < ROUNDS; i++) {
        const uint64_t begin = clock_ns();
        encode_many(&bytes);
        const uint64_t between = times_add(&encode, begin);
        read_many(&bytes);
        times_add(&read, between);
    }
    f->many_bytes = bytes.length;
    f->encode_ms = times_median(encode.ms, ROUNDS);
    f->read_ms = times_median(read.ms, ROUNDS);
}

/* ---- verifying ---- */

static bool gives(const struct record *record, const char *key)
{
    struct record_word word;
    return record_word_find(record->result, key, strlen(key), &word);
}

/* Replay a record and compare. Its picture is rendered before, so that this time is separate from
 * reading and comparing golden images, unless the record applies edits first. */
static void verify_record(struct interpreter *interp, const struct record *record,
                          struct figures *f)
{
    struct replaying replaying = {.interp = interp, .judge = interp->judge};
    const struct replay_host host = replay_file_host(&replaying);
    OWNED(replay_report_release) struct replay_report report = {0};
    uint64_t begin = clock_ns();
    if (gives(record, "picture") && !gives(record, "forest") && interp->session->has_scene)
        must(session_render(interp->session, RENDER_AS_KEPT, &bench_fault));
    f->rendition_ms += times_since(begin);
    begin = clock_ns();
    must(replay_record(record, &host, &report, &bench_fault));
    if (gives(record, "scene"))
        f->scene_ms += times_since(begin);
    else if (gives(record, "forest"))
        f->forest_ms += times_since(begin);
}

static void verify_records(struct interpreter *interp, const struct buf *bytes, struct figures *f)
{
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    must(walk_begin(&walk, bytes->data, bytes->length, &bench_fault));
    if (walk.semantics)
        must(session_set_semantics(interp->session, walk.semantics, &bench_fault));
    while (walk_next_sound(&walk, &record) == WALK_RECORD)
        verify_record(interp, &record, f);
    if (walk.over != WALK_END || walk.records == 0)
        must(fault_set(&bench_fault, ERR_CHECK, "%s",
                       walk.records ? walk.fault.text : "there are no records to verify"));
    f->records = walk.records;
}

static void verify_once(const char *path, const struct buf *bytes, struct figures *f)
{
    static const struct golden_judge strict_judge = {.differs = NULL};
    struct interpreter interp;
    const uint64_t begin = clock_ns();
    f->scene_ms = f->forest_ms = f->rendition_ms = 0;
    must(interpreter_init(&interp, &bench_fault));
    interp.mode = MODE_REPLAY;
    interp.judge = &strict_judge;
    must(interpreter_set_home(&interp, path, &bench_fault));
    verify_records(&interp, bytes, f);
    interpreter_release(&interp);
    f->verify_ms = times_since(begin);
}

/* Keep the fastest of several runs, part for part. */
static void time_verifying(const char *path, const struct buf *bytes, struct figures *f)
{
    struct figures best = {.verify_ms = 0};
    for (int i = 0; i < VERIFYINGS; i++) {
        verify_once(path, bytes, f);
        if (i == 0 || f->verify_ms < best.verify_ms)
            best = *f;
    }
    *f = best;
}

/* ---- recording ---- */

/* The records of the journal once more into a new one in a folder of its own below `where`. */
static double time_recording(const char *where, const struct buf *bytes)
{
    OWNED(buf_release) struct buf path = {0};
    OWNED(journal_drop) struct journal *journal = NULL;
    OWNED(walk_release) struct walk walk = {0};
    struct record record;
    buf_printf(&path, "%s/again.iftty", bench_folder(where));
    must(journal_create(&journal, buf_text(&path), SEMANTICS, &bench_fault));
    const uint64_t begin = clock_ns();
    must(walk_begin(&walk, bytes->data, bytes->length, &bench_fault));
    while (walk_next(&walk, &record) == WALK_RECORD)
        must(journal_append(journal, record.command, record.result, &bench_fault));
    const double ms = times_since(begin);
    return ms;
}

/* ---- what is told ---- */

static void print_table(const struct figures *f)
{
    const double parts = f->forest_ms + f->rendition_ms;
    const double session = f->scene_ms + parts;
    printf("%d records of %.1f MB\n", RECORDS, (double)f->many_bytes / 1e6);
    printf("    %-44s %10.1f  ms\n", "encoded", f->encode_ms);
    printf("    %-44s %10.1f  ms\n", "read, numbers and chain checked", f->read_ms);
    printf("%s, %zu records\n", f->name, f->records);
    printf("    %-44s %10.1f  ms\n", "scene opened and weighed", f->scene_ms);
    printf("    %-44s %10.1f  ms\n", "forests", f->forest_ms);
    printf("    %-44s %10.1f  ms\n", "renditions", f->rendition_ms);
    printf("    %-44s %10.1f  ms  %.2f of forests and renditions\n", "verified, all told",
           f->verify_ms, f->verify_ms / parts);
    if (f->is_unsynced)
        printf("    %-44s %10.1f  ms  %.2f %% of the session\n",
               "recorded, but for the syncs (/dev/shm)", f->record_ms,
               100 * f->record_ms / session);
    printf("    %-44s %10.1f  ms  %.2f ms each\n", "recorded, with a sync each (/tmp)",
           f->synced_ms, f->synced_ms / (double)f->records);
    if (!f->resume.commands)
        return;
    printf("%u commands on %.1f million voxels\n", f->resume.commands,
           (double)f->resume.voxels / 1e6);
    printf("    %-44s %10.1f  ms\n", "carried out", f->resume.session_ms);
    printf("    %-44s %10.1f  ms\n", "resumed", f->resume.resume_ms);
}

static void write_figures(const struct figures *f)
{
    struct json *json = bench_json();
    json_object(json, NULL);
    json_count(json, "records", RECORDS);
    json_fixed(json, "encode_ms", f->encode_ms, 3);
    json_fixed(json, "read_ms", f->read_ms, 3);
    json_object(json, "journal");
    json_count(json, "records", f->records);
    json_fixed(json, "scene_ms", f->scene_ms, 3);
    json_fixed(json, "forest_ms", f->forest_ms, 3);
    json_fixed(json, "rendition_ms", f->rendition_ms, 3);
    json_fixed(json, "verify_ms", f->verify_ms, 3);
    json_fixed(json, "synced_ms", f->synced_ms, 3);
    if (f->is_unsynced)
        json_fixed(json, "record_ms", f->record_ms, 3);
    json_end(json);
    if (f->resume.commands) {
        json_object(json, "resume");
        json_count(json, "commands", f->resume.commands);
        json_fixed(json, "session_ms", f->resume.session_ms, 3);
        json_fixed(json, "resume_ms", f->resume.resume_ms, 3);
        json_end(json);
    }
    json_end(json);
}

enum err run_journal(const struct options *o, struct fault *fault)
{
    struct figures f = {.records = 0};
    OWNED(buf_release) struct buf path = {0}, bytes = {0}, name = {0};
    struct interpreter interp;
    (void)fault;
    must(interpreter_init(&interp, &bench_fault));
    if (o->words)
        buf_add_text(&path, o->word[0]);
    else
        must(bench_find_example(&path, &interp, &bench_fault));
    interpreter_release(&interp);
    must(file_read(&bytes, buf_text(&path), JOURNAL_BYTES_MAX, &bench_fault));
    time_many(&f);
    time_verifying(buf_text(&path), &bytes, &f);
    f.synced_ms = time_recording("/tmp", &bytes);
    f.is_unsynced = access("/dev/shm", W_OK) == 0; /* in memory: a sync has nothing to do */
    if (f.is_unsynced)
        f.record_ms = time_recording("/dev/shm", &bytes);
    if (!o->words)
        f.resume = bench_resuming();
    const char *last = file_name(buf_text(&path));
    buf_add_safe(&name, last, strlen(last));
    snprintf(f.name, sizeof f.name, "%s", buf_text(&name));
    (o->json ? write_figures : print_table)(&f);
    return OK;
}
