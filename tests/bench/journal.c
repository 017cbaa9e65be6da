/* SPDX-License-Identifier: MIT */
/* Cost of a journal: records alone, recording a session, verifying it. */
#include "tests/bench/bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/file.h"
#include "base/json.h"
#include "command/golden_files.h"
#include "tests/bench/times.h"
#include "command/interpreter.h"
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

static enum err encode_many(struct buf *out, struct fault *fault)
{
    struct record_chain chain = record_chain_zero;
    char command[64], words[128];
    enum err err = OK;
    buf_clear(out);
    record_header(out, SEMANTICS);
    const size_t header_length = out->length;
    struct buf header = {0};
    buf_add(&header, out->data, header_length);
    for (unsigned i = 0; !err && i < RECORDS; i++) {
        snprintf(command, sizeof command, "seed %u,%u,%u %u radius=2", i % 181, i % 217, i % 179,
                 i % 9);
        snprintf(words, sizeof words, "forest=%016llx labels=%016llx seeds=%u",
                 i * 0x9e3779b97f4a7c15ull, i * 0xc4ceb9fe1a85ec53ull, i);
        const struct record record = {.number = i + 1, .command = command, .result = words};
        err = record_encode(out, &chain, i ? "" : buf_text(&header), "", &record, fault);
    }
    buf_release(&header);
    return err;
}

static enum err read_many(const struct buf *bytes, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes->data, bytes->length, fault);
    if (err)
        return err;
    while (walk_next_sound(&walk, &record) == WALK_RECORD)
        ;
    if (walk.over != WALK_END || walk.records != RECORDS)
        err = fault_set(fault, ERR_CHECK, "%zu of %d records were read: %s", walk.records, RECORDS,
                        walk.fault.text);
    walk_release(&walk);
    return err;
}

static enum err time_many(struct figures *f, struct fault *fault)
{
    struct buf bytes = {0};
    double encode[ROUNDS], read[ROUNDS];
    enum err err = OK;
    for (int i = 0; !err && i < ROUNDS; i++) {
        const uint64_t begin = clock_ns();
        err = encode_many(&bytes, fault);
        encode[i] = times_since(begin);
        const uint64_t between = clock_ns();
        err = err ? err : read_many(&bytes, fault);
        read[i] = times_since(between);
    }
    f->many_bytes = bytes.length;
    buf_release(&bytes);
    if (err)
        return err;
    f->encode_ms = times_median(encode, ROUNDS);
    f->read_ms = times_median(read, ROUNDS);
    return OK;
}

/* ---- verifying ---- */

static bool gives(const struct record *record, const char *key)
{
    struct record_word word;
    return record_word_find(record->result, key, strlen(key), &word);
}

/* Replay a record and compare. Its picture is rendered before, so that this time is separate from
 * reading and comparing golden images, unless the record applies edits first. */
static enum err verify_record(struct interpreter *interp, const struct record *record,
                              struct figures *f, struct fault *fault)
{
    struct replaying replaying = {.interp = interp, .judge = interp->judge};
    const struct replay_host host = replay_file_host(&replaying);
    struct replay_report report = {0};
    uint64_t begin = clock_ns();
    enum err err = OK;
    if (gives(record, "picture") && !gives(record, "forest") && interp->session->has_scene)
        err = session_render(interp->session, RENDER_AS_KEPT, fault);
    f->rendition_ms += times_since(begin);
    begin = clock_ns();
    err = err ? err : replay_record(record, &host, &report, fault);
    if (gives(record, "scene"))
        f->scene_ms += times_since(begin);
    else if (gives(record, "forest"))
        f->forest_ms += times_since(begin);
    replay_report_release(&report);
    return err;
}

static enum err verify_records(struct interpreter *interp, const struct buf *bytes,
                               struct figures *f, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes->data, bytes->length, fault);
    if (err)
        return err;
    if (walk.semantics)
        err = session_set_semantics(interp->session, walk.semantics, fault);
    while (!err && walk_next_sound(&walk, &record) == WALK_RECORD)
        err = verify_record(interp, &record, f, fault);
    if (!err && (walk.over != WALK_END || walk.records == 0))
        err = fault_set(fault, ERR_CHECK, "%s",
                        walk.records ? walk.fault.text : "there are no records to verify");
    f->records = walk.records;
    walk_release(&walk);
    return err;
}

static enum err verify_once(const char *path, const struct buf *bytes, struct figures *f,
                            struct fault *fault)
{
    static const struct golden_judge strict_judge = {.differs = NULL};
    struct interpreter interp;
    const uint64_t begin = clock_ns();
    f->scene_ms = f->forest_ms = f->rendition_ms = 0;
    enum err err = interpreter_init(&interp, fault);
    interp.mode = MODE_REPLAY;
    interp.judge = &strict_judge;
    if (!err)
        err = interpreter_set_home(&interp, path, fault);
    if (!err)
        err = verify_records(&interp, bytes, f, fault);
    interpreter_release(&interp);
    f->verify_ms = times_since(begin);
    return err;
}

/* Keep the fastest of several runs, part for part. */
static enum err time_verifying(const char *path, const struct buf *bytes, struct figures *f,
                               struct fault *fault)
{
    struct figures best = {.verify_ms = 0};
    enum err err = OK;
    for (int i = 0; !err && i < VERIFYINGS; i++) {
        err = verify_once(path, bytes, f, fault);
        if (i == 0 || f->verify_ms < best.verify_ms)
            best = *f;
    }
    if (!err)
        *f = best;
    return err;
}

/* ---- recording ---- */

static enum err append_all(struct journal *journal, const struct buf *bytes, struct fault *fault)
{
    struct walk walk;
    struct record record;
    enum err err = walk_begin(&walk, bytes->data, bytes->length, fault);
    if (err)
        return err;
    while (!err && walk_next(&walk, &record) == WALK_RECORD)
        err = journal_append(journal, record.command, record.result, fault);
    walk_release(&walk);
    return err;
}

/* The records of the journal once more into a new one in a folder of its own below `where`. */
static enum err time_recording(double *ms, const char *where, const struct buf *bytes,
                               struct fault *fault)
{
    struct buf folder = {0}, path = {0};
    struct journal *journal = NULL;
    enum err err = folder_fresh(&folder, where, fault);
    if (err)
        return err;
    buf_printf(&path, "%s/again.iftty", buf_text(&folder));
    err = path.failed ? fault_memory(fault, "a path")
                      : journal_create(&journal, buf_text(&path), SEMANTICS, fault);
    const uint64_t begin = clock_ns();
    if (!err)
        err = append_all(journal, bytes, fault);
    *ms = times_since(begin);
    journal_close(journal);
    folder_remove(buf_text(&folder));
    buf_release(&folder);
    buf_release(&path);
    return err;
}

static enum err time_recordings(const struct buf *bytes, struct figures *f, struct fault *fault)
{
    enum err err = time_recording(&f->synced_ms, "/tmp", bytes, fault);
    f->is_unsynced = access("/dev/shm", W_OK) == 0; /* in memory: a sync has nothing to do */
    if (!err && f->is_unsynced)
        err = time_recording(&f->record_ms, "/dev/shm", bytes, fault);
    return err;
}

/* ---- what is told ---- */

static void print_table(FILE *out, const struct figures *f)
{
    const double parts = f->forest_ms + f->rendition_ms;
    const double session = f->scene_ms + parts;
    fprintf(out, "%d records of %.1f MB\n", RECORDS, (double)f->many_bytes / 1e6);
    fprintf(out, "    %-44s %10.1f  ms\n", "encoded", f->encode_ms);
    fprintf(out, "    %-44s %10.1f  ms\n", "read, numbers and chain checked", f->read_ms);
    fprintf(out, "%s, %zu records\n", f->name, f->records);
    fprintf(out, "    %-44s %10.1f  ms\n", "scene opened and weighed", f->scene_ms);
    fprintf(out, "    %-44s %10.1f  ms\n", "forests", f->forest_ms);
    fprintf(out, "    %-44s %10.1f  ms\n", "renditions", f->rendition_ms);
    fprintf(out, "    %-44s %10.1f  ms  %.2f of forests and renditions\n", "verified, all told",
            f->verify_ms, f->verify_ms / parts);
    if (f->is_unsynced)
        fprintf(out, "    %-44s %10.1f  ms  %.2f %% of the session\n",
                "recorded, but for the syncs (/dev/shm)", f->record_ms,
                100 * f->record_ms / session);
    fprintf(out, "    %-44s %10.1f  ms  %.2f ms each\n", "recorded, with a sync each (/tmp)",
            f->synced_ms, f->synced_ms / (double)f->records);
    if (!f->resume.commands)
        return;
    fprintf(out, "%u commands on %.1f million voxels\n", f->resume.commands,
            (double)f->resume.voxels / 1e6);
    fprintf(out, "    %-44s %10.1f  ms\n", "carried out", f->resume.session_ms);
    fprintf(out, "    %-44s %10.1f  ms\n", "resumed", f->resume.resume_ms);
}

static void print_json(FILE *out, const struct figures *f)
{
    struct buf text = {0};
    struct json json = {.out = &text};
    json_object(&json, NULL);
    json_count(&json, "records", RECORDS);
    json_fixed(&json, "encode_ms", f->encode_ms, 3);
    json_fixed(&json, "read_ms", f->read_ms, 3);
    json_object(&json, "journal");
    json_count(&json, "records", f->records);
    json_fixed(&json, "scene_ms", f->scene_ms, 3);
    json_fixed(&json, "forest_ms", f->forest_ms, 3);
    json_fixed(&json, "rendition_ms", f->rendition_ms, 3);
    json_fixed(&json, "verify_ms", f->verify_ms, 3);
    json_fixed(&json, "synced_ms", f->synced_ms, 3);
    if (f->is_unsynced)
        json_fixed(&json, "record_ms", f->record_ms, 3);
    json_end(&json);
    if (f->resume.commands) {
        json_object(&json, "resume");
        json_count(&json, "commands", f->resume.commands);
        json_fixed(&json, "session_ms", f->resume.session_ms, 3);
        json_fixed(&json, "resume_ms", f->resume.resume_ms, 3);
        json_end(&json);
    }
    json_end(&json);
    fputs(buf_text(&text), out);
    buf_release(&text);
}

/* The journal of the demo, where its scene is here. */
static enum err find_journal(struct buf *path, struct fault *fault)
{
    struct interpreter interp;
    enum err err = interpreter_init(&interp, fault);
    if (!err)
        err = bench_find_example(path, &interp, fault);
    interpreter_release(&interp);
    return err;
}

enum err run_journal(const struct options *o, struct fault *fault)
{
    struct figures f = {.records = 0};
    struct buf path = {0}, bytes = {0}, name = {0};
    enum err err = OK;
    if (o->words)
        buf_add_text(&path, o->word[0]);
    else
        err = find_journal(&path, fault);
    if (!err)
        err = file_read(&bytes, buf_text(&path), JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = time_many(&f, fault);
    if (!err)
        err = time_verifying(buf_text(&path), &bytes, &f, fault);
    if (!err)
        err = time_recordings(&bytes, &f, fault);
    if (!err && !o->words)
        err = bench_resuming(&f.resume, fault);
    const char *last = file_name(buf_text(&path));
    buf_add_safe(&name, last, strlen(last));
    snprintf(f.name, sizeof f.name, "%s", buf_text(&name));
    if (!err)
        (o->json ? print_json : print_table)(stdout, &f);
    buf_release(&name);
    buf_release(&bytes);
    buf_release(&path);
    return err;
}
