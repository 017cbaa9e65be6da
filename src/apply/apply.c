/* SPDX-License-Identifier: MIT */
#include "apply/apply.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/scan.h"
#include "command/table.h"
#include "session/map.h"
#include "verify/replay_file.h"

struct applying {
    const struct apply_options *options;
    const struct printer *printer;
    struct procedure procedure;
    struct buf image;
    struct procedure_landmark landmark[PROCEDURE_LANDMARKS];
    struct subject_choice choice;
    struct buf text; /* report as JSON, printed at the end */
    struct json json;
    size_t refused, failed, made, there;
    uint32_t number[256]; /* numbers of the procedure's labels */
    uint8_t order[256];   /* labels by their numbers */
};

/* ---- options and inputs ---- */

static enum err take_options(struct applying *a, struct fault *fault)
{
    const struct apply_options *o = a->options;
    const int way = o->by ? choice_find(ORIGIN_WAYS, o->by) : CARRY_AFFINE;
    const int kind = o->fit ? choice_find(CARRY_FITS, o->fit) : AFFINE_FULL;
    a->choice.folder = o->out ? o->out : ".";
    a->choice.orient = o->orient;
    a->choice.depth_mm = APPLY_DEPTH_MM;
    a->choice.gate = APPLY_GATE;
    a->choice.watch = o->procedure.journal.watch;
    a->choice.carry.landmark = a->landmark;
    a->choice.carry.way = way < 0 ? CARRY_FILE : (enum carry_way)way;
    a->choice.carry.file = o->by;
    a->choice.plants = o->as ? choice_find(ORIGIN_PLANTS, o->as) : PLANT_LABELS;
    if (a->choice.plants < 0)
        return fault_set(fault, ERR_USAGE, "--as: expected labels or seeds, not %s", o->as);
    if (kind < 0)
        return fault_set(fault, ERR_USAGE, "--fit: expected rigid, similarity or affine, not %s",
                         o->fit);
    a->choice.carry.kind = (enum affine_kind)kind;
    if (a->choice.carry.way == CARRY_LANDMARKS && !o->landmarks)
        return fault_set(fault, ERR_USAGE,
                         "--by landmarks: name the subject's landmarks by --landmarks FILE: lines "
                         "NAME X,Y,Z in millimetres, or a journal with the command `landmark`");
    if (o->landmarks && o->scenes > 1)
        return fault_set(
            fault, ERR_USAGE,
            "--landmarks: the landmarks belong to one subject; expected one scene, not %zu",
            o->scenes);
    if (a->choice.carry.way == CARRY_FILE && o->scenes > 1)
        return fault_set(fault, ERR_USAGE,
                         "--by %s: a transform leads to one scene; expected one, not %zu", o->by,
                         o->scenes);
    return OK;
}

/* Reject two scenes with the same journal. */
static enum err check_names(struct applying *a, struct fault *fault)
{
    const struct apply_options *o = a->options;
    for (size_t i = 1; i < o->scenes; i++)
        for (size_t k = 0; k < i; k++) {
            OWNED(buf_release) struct buf name = {0}, other = {0};
            a->choice.scene = o->scene[i];
            subject_path(&name, &a->choice, SUBJECT_JOURNAL);
            a->choice.scene = o->scene[k];
            subject_path(&other, &a->choice, SUBJECT_JOURNAL);
            if (strcmp(buf_text(&name), buf_text(&other)) == 0)
                return fault_set(fault, ERR_USAGE,
                                 "%s and %s would both be written to %s; apply them one by one, "
                                 "each with its own --out DIR",
                                 o->scene[k], o->scene[i], buf_text(&name));
        }
    return OK;
}

/* Identity of a file, by its resolved path and by its inode. */
struct file_place {
    const char *name;
    struct buf *settled;
    bool is_there;
    struct stat status;
};

static struct file_place file_place(const char *name, struct arena *paths)
{
    struct file_place place = {.name = name, .settled = arena_buf(paths)};
    file_absolute(place.settled, name);
    place.is_there = stat(name, &place.status) == 0;
    return place;
}

static bool is_one(const struct file_place *a, const struct file_place *b)
{
    return strcmp(buf_text(a->settled), buf_text(b->settled)) == 0 ||
           (a->is_there && b->is_there && a->status.st_dev == b->status.st_dev &&
            a->status.st_ino == b->status.st_ino);
}

/* ERR_USAGE if an output file is an input, or is below an input folder. */
static enum err check_output(const struct applying *a, const char *path,
                             const struct file_place *input, size_t inputs, struct arena *paths,
                             struct fault *fault)
{
    struct buf *folder = arena_buf(paths);
    file_folder(folder, path);
    const struct file_place output = file_place(path, paths),
                            below = file_place(buf_text(folder), paths);
    for (size_t i = 0; i < inputs; i++) {
        const bool is_in = S_ISDIR(input[i].status.st_mode) && is_one(&below, &input[i]);
        if (is_in || is_one(&output, &input[i]))
            return fault_set(fault, ERR_USAGE,
                             "%s would be written to %s, which is %s%s that is read; nothing was "
                             "written; choose another folder by --out DIR",
                             a->choice.scene, path, is_in ? "in the folder " : "the file ",
                             input[i].name);
    }
    return OK;
}

/* Check that no output overwrites an input: procedure, its scene, landmarks, transform, any scene.
 */
static enum err check_inputs(struct applying *a, struct fault *fault)
{
    static const char *const output[] = {SUBJECT_JOURNAL, SUBJECT_SEEDS, SUBJECT_GOLDENS};
    const struct apply_options *o = a->options;
    const char *const other[] = {o->procedure.path, o->procedure.journal.scene_path, o->landmarks,
                                 a->choice.carry.way == CARRY_FILE ? o->by : NULL};
    enum { OTHERS = sizeof other / sizeof *other };
    OWNED(arena_release) struct arena paths = {0};
    OWNED(mem_release) struct file_place *input = calloc(o->scenes + OTHERS, sizeof *input);
    size_t inputs = 0;
    enum err err = input ? OK : fault_memory(fault, "paths");
    for (size_t i = 0; !err && i < o->scenes + OTHERS; i++) {
        const char *name = i < o->scenes ? o->scene[i] : other[i - o->scenes];
        if (name)
            input[inputs++] = file_place(name, &paths);
    }
    for (size_t i = 0; !err && i < o->scenes; i++)
        for (size_t k = 0; !err && k < sizeof output / sizeof *output; k++) {
            struct buf *path = arena_buf(&paths);
            a->choice.scene = o->scene[i];
            subject_path(path, &a->choice, output[k]);
            err = check_output(a, buf_text(path), input, inputs, &paths, fault);
        }
    return arena_failed(&paths) ? fault_memory(fault, "a path") : err;
}

/* A journal is replayed as the procedure's is. */
static enum err take_landmarks(struct applying *a, struct fault *fault)
{
    const struct apply_options *o = a->options;
    OWNED(procedure_release) struct procedure subject = {.has_place = false};
    if (!o->landmarks)
        return OK;
    if (!interpreter_is_journal(o->landmarks) && !file_begins_with(o->landmarks, PROCEDURE_BEGINS))
        return carry_read_landmarks(a->landmark, &a->choice.carry.landmarks, o->landmarks, fault);
    struct procedure_source source = o->procedure;
    source.path = o->landmarks;
    source.journal.scene_path = NULL;
    TRY(procedure_load(&subject, NULL, &source, fault));
    memcpy(a->landmark, subject.landmark, sizeof a->landmark);
    a->choice.carry.landmarks = subject.landmarks;
    return OK;
}

/* ---- results of a scene ---- */

static void print_text(struct applying *a, struct buf *text)
{
    a->printer->print(a->printer->context, buf_text(text));
    buf_release(text);
}

static const char *advice(const struct subject *s, unsigned l)
{
    bool has_bad = false;
    for (unsigned other = 1; other < 256; other++)
        has_bad |= s->label[other].is_bad;
    if (s->label[l].dropped == s->label[l].seeds)
        return "  no seed was planted";
    if (l == s->worst && (s->label[l].is_bad || !has_bad))
        return "  look here first";
    return s->label[l].is_bad ? "  look here" : "";
}

static void write_table(struct buf *out, const struct applying *a, const struct subject *s)
{
    buf_printf(out, "    %-22s %11s %9s %9s %8s %7s %7s\n", "label", "volume ml", "expected",
               "dropped", "depth mm", "doubt", "far ml");
    for (unsigned i = 1; i < 256; i++) {
        const unsigned l = a->order[i];
        const struct subject_label *label = &s->label[l];
        OWNED(buf_release) struct buf name = {0};
        if (!label->is_there)
            continue;
        buf_printf(&name, "%u ", a->number[l]);
        buf_add_safe_text(&name, a->procedure.label[l].name);
        buf_printf(out, "    %-22s %11.2f %7.0f %% %7.1f %% %8.1f %5.1f %% %7.2f%s\n",
                   buf_text(&name), label->mm3 / 1000, 100 * label->mm3 / label->expected_mm3,
                   label->seeds ? 100.0 * (double)label->dropped / (double)label->seeds : 0.0,
                   label->depth_mm, 100 * label->doubt, label->far_mm3 / 1000, advice(s, l));
    }
}

static void write_text(struct applying *a, const struct subject *s, enum err err,
                       const struct fault *fault)
{
    struct buf text = {0};
    buf_add_safe_text(&text, a->choice.scene);
    if (err && a->options->scenes == 1) {
        buf_clear(&text); /* printed by the caller */
    } else if (err) {
        buf_printf(&text, ": %s: %s\n", err == ERR_CHECK ? "refused" : "failed", fault->text);
    } else if (s->was_there) {
        buf_add_text(&text, ": done before: ");
        buf_add_safe_text(&text, buf_text(&s->journal));
        buf_add_char(&text, '\n');
    } else {
        buf_add_text(&text, ": ");
        buf_add_safe_text(&text, buf_text(&s->journal));
        buf_printf(&text, "%s%s\n", s->words.length ? ", " : "", buf_text(&s->words));
        write_table(&text, a, s);
    }
    print_text(a, &text);
}

static void write_json(struct applying *a, const struct subject *s, enum err err,
                       const struct fault *fault)
{
    struct json *json = &a->json;
    json_object(json, NULL);
    json_text(json, "scene", a->choice.scene);
    json_text(json, "state",
              err == ERR_CHECK ? "refused"
              : err            ? "failed"
              : s->was_there   ? "there"
                               : "made");
    if (err)
        json_text(json, "why", fault->text);
    else
        json_text(json, "journal", buf_text(&s->journal));
    if (!err && !s->was_there) {
        json_array(json, "pull");
        for (int i = 0; i < 12; i++)
            json_real(json, NULL, s->pull.m[i / 4][i % 4], 17);
        json_end(json);
        if (a->choice.carry.way == CARRY_LANDMARKS)
            json_fixed(json, "rms_mm", s->rms_mm, 4);
        json_text(json, "found", buf_text(&s->words));
        json_count(json, "worst", a->number[s->worst]);
        json_array(json, "labels");
        for (unsigned i = 1; i < 256; i++) {
            const unsigned l = a->order[i];
            const struct subject_label *label = &s->label[l];
            if (!label->is_there)
                continue;
            json_object(json, NULL);
            json_count(json, "label", a->number[l]);
            json_text(json, "name", a->procedure.label[l].name);
            json_count(json, "voxels", label->voxels);
            json_fixed(json, "volume_mm3", label->mm3, 3);
            json_fixed(json, "expected_mm3", label->expected_mm3, 3);
            json_count(json, "seeds", label->seeds);
            json_count(json, "dropped", label->dropped);
            json_fixed(json, "depth_mm", label->depth_mm, 3);
            json_fixed(json, "doubt", label->doubt, 4);
            json_fixed(json, "far_mm3", label->far_mm3, 3);
            json_boolean(json, "bad", label->is_bad);
            json_end(json);
        }
        json_end(json);
    }
    json_end(json);
}

/* ---- all scenes ---- */

static enum err apply_all(struct applying *a, struct fault *fault)
{
    const struct apply_options *o = a->options;
    enum err worst = OK;
    json_array(&a->json, NULL);
    for (size_t i = 0; i < o->scenes && worst != ERR_CANCELLED; i++) {
        OWNED(subject_release) struct subject subject = {.was_there = false};
        struct fault words = {.text = ""};
        a->choice.scene = o->scene[i];
        a->choice.volume = o->volume ? scan_list_number(o->volume, i) : -1;
        const enum err err = subject_make(&subject, &a->procedure, &a->choice, &words);
        if (err != ERR_CANCELLED && o->json)
            write_json(a, &subject, err, &words);
        else if (err != ERR_CANCELLED)
            write_text(a, &subject, err, &words);
        a->made += !err && !subject.was_there;
        a->there += subject.was_there;
        a->refused += err == ERR_CHECK;
        a->failed += err && err != ERR_CHECK;
        if (err_exit_status(err) > err_exit_status(worst)) {
            worst = err;
            *fault = words;
        }
    }
    json_end(&a->json);
    if (worst == ERR_CANCELLED)
        return worst;
    if (o->json)
        print_text(a, &a->text);
    else if (o->scenes > 1) {
        struct buf sum = {0};
        buf_printf(&sum, "# %zu made, %zu done before, %zu refused, %zu failed\n", a->made,
                   a->there, a->refused, a->failed);
        print_text(a, &sum);
    }
    return worst && o->scenes > 1
               ? fault_set(fault, worst, "%zu of %zu scenes failed or were refused",
                           a->failed + a->refused, o->scenes)
               : worst;
}

enum err apply_procedure(const struct apply_options *options, const struct printer *printer,
                         struct fault *fault)
{
    OWNED(mem_release) struct applying *a = mem_new(sizeof *a);
    if (!a)
        return fault_memory(fault, "a procedure");
    a->options = options;
    a->printer = printer;
    a->json.out = &a->text;
    const bool makes_folder = options->out && !file_exists(options->out);
    enum err err = take_options(a, fault);
    if (!err)
        err = check_names(a, fault);
    if (!err)
        err = check_inputs(a, fault);
    if (!err && options->out)
        err = file_make_folder(options->out, fault);
    if (!err)
        err = take_landmarks(a, fault);
    if (!err)
        err = procedure_load(&a->procedure, a->choice.carry.way == CARRY_AFFINE ? &a->image : NULL,
                             &options->procedure, fault);
    a->choice.carry.intensity = (const uint16_t *)(const void *)a->image.data;
    procedure_numbers(a->number, &a->procedure);
    numbering_order(a->order, a->number);
    if (!err)
        err = apply_all(a, fault);
    if (err && makes_folder)
        rmdir(options->out); /* fails if it has files */
    procedure_release(&a->procedure);
    buf_release(&a->image);
    buf_release(&a->text);
    return err;
}
