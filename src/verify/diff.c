#include "verify/diff.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/version.h"
#include "engine/labels.h"
#include "engine/overlap.h"
#include "image/image_helper.h"
#include "verify/difference_picture.h"
#include "verify/first_difference.h"
#include "verify/process.h"
#include "verify/replay_file.h"

/* ---- one side, in its process ---- */

/*
 * What a journal comes to, which a process of its own carries out and hands back as bytes: the
 * facts, then, where it went well, a label for each voxel, then the pixels of the picture, if there
 * is one.
 */

/* From one process of this program to another, so they are sent as they are. */
struct diff_facts {
    enum err err;
    char why[sizeof((struct fault *)0)->text];
    uint32_t size[3], picture_width, picture_height; /* 0, 0: none */
    uint64_t scene_digest;
    char proof[SHA256_HEX];
    size_t voxels, pending;
    uint8_t is_edited, is_torn; /* booleans */
    char label_name[256][LABEL_NAME_BYTES];
    struct palette palette;
};

struct diff_side {
    struct buf bytes;
    /* Places in them, once it was carried out well. */
    const struct diff_facts *facts;
    const uint8_t *labels; /* [z][y][x] */
    const uint8_t *pixels; /* [height][width][4] */
};

enum { SIDE_MOST = 16384, /* of a picture */ FRAME_MOST = 4 * SIDE_MOST * SIDE_MOST };

struct work {
    const struct diff_options *options;
    int which;                     /* 0: A */
    const struct diff_side *other; /* B, for A's picture; or NULL */
};

/* A journal that was edited by hand, and gives the results it records, is taken with a warning. */
static enum err carry_out(struct interpreter *interp, const struct work *work,
                          struct diff_facts *facts, struct fault *fault)
{
    const struct diff_options *o = work->options;
    struct replay_report report = {0};
    enum err err =
        replay_file(interp, o->path[work->which], 0, o->last, NULL, NULL, &report, fault);
    facts->is_edited = !report.is_intact;
    facts->is_torn = report.is_torn;
    if (err == ERR_CHECK && report.outcome == REPLAY_SAME)
        err = OK;
    if (err == ERR_CHECK)
        err = fault_prefix(fault, ERR_CHECK,
                           "it gives other results than it records; see iftty verify");
    if (!err && !session_has_scene(interp->session))
        err = fault_set(fault, ERR_INPUT, "it opens no scene");
    replay_report_release(&report);
    return err;
}

static enum err draw(struct picture *picture, struct session *session, const struct work *work,
                     const uint8_t *label, struct fault *fault)
{
    struct overlap overlap;
    overlap_count(&overlap, label, work->other->labels, session_scene(session)->grid.voxels);
    const struct difference_picture difference_picture = {
        .name = {file_name(work->options->path[0]), file_name(work->options->path[1])},
        .label = {label, work->other->labels},
        .overlap = &overlap};
    const struct diff_facts *other = work->other->facts;
    struct state next = *session_state(session);
    for (int l = 1; l < 256; l++) { /* names and colours that A has none of are B's */
        if (overlap.a[l])
            continue;
        memcpy(next.kept.palette.rgb[l], other->palette.rgb[l], 3);
        if (!next.kept.label_name[l][0])
            memcpy(next.kept.label_name[l], other->label_name[l], LABEL_NAME_BYTES);
    }
    const enum err err = session_go(session, &next, NULL, 0, fault);
    return err ? err : difference_picture_draw(picture, session, &difference_picture, fault);
}

/* Notes the facts, and adds labels and picture to `out`, after them. */
static enum err hand_back(struct buf *out, struct session *session, const struct work *work,
                          struct diff_facts *facts, struct fault *fault)
{
    const struct kept *kept = session_kept(session);
    const size_t voxels = session_scene(session)->grid.voxels;
    struct picture picture = {0};
    uint8_t *label = buf_reserve(out, voxels);
    if (!label)
        return fault_memory(fault, "labels");
    const struct labels labels = labels_of_forest(session_scene(session));
    const struct grid *grid = &labels.scene->grid;
    uint8_t *to = label;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++, to += grid->size[0])
            labels_copy_row(&labels, grid_row(grid, y, z), to);
    out->length += voxels;
    memcpy(facts->size, session_scene(session)->grid.size, sizeof facts->size);
    memcpy(facts->proof, session_proof(session), sizeof facts->proof);
    memcpy(facts->label_name, kept->label_name, sizeof facts->label_name);
    facts->palette = kept->palette;
    facts->scene_digest = session_scene_digest(session);
    facts->voxels = voxels;
    facts->pending = session_pendings(session);
    if (!work->other || memcmp(work->other->facts->size, facts->size, sizeof facts->size) != 0)
        return OK;
    const enum err err = draw(&picture, session, work, label, fault);
    if (!err) {
        facts->picture_width = picture.width;
        facts->picture_height = picture.height;
        buf_add(out, picture.rgba, (size_t)4 * picture.width * picture.height);
    }
    picture_release(&picture);
    return err;
}

static void carry_out_one(void *context, size_t number, struct buf *out)
{
    (void)number;
    const struct work *work = context;
    const struct diff_options *o = work->options;
    struct interpreter interp;
    struct fault fault = {0};
    struct diff_facts *facts = mem_new(sizeof *facts);
    if (!facts)
        return;
    buf_add(out, facts, sizeof *facts);
    facts->err = interpreter_init(&interp, &fault);
    interp.scene_path = o->scene_path;
    if (!facts->err && o->begin)
        facts->err = o->begin(o->context, o->path[work->which], &fault);
    if (!facts->err)
        facts->err = carry_out(&interp, work, facts, &fault);
    if (!facts->err)
        facts->err = hand_back(out, interp.session, work, facts, &fault);
    memcpy(facts->why, fault.text, sizeof facts->why);
    if (!out->failed)
        memcpy(out->data, facts, sizeof *facts);
    free(facts);
    interpreter_release(&interp);
}

/* ---- one side, from outside ---- */

/* What came back is of the form it should be, whatever has become of the process. */
static bool is_whole(const struct diff_facts *f, size_t length)
{
    const uint64_t pixels = (uint64_t)f->picture_width * f->picture_height;
    const uint64_t voxels = (uint64_t)f->size[0] * f->size[1] * f->size[2];
    return f->picture_width <= SIDE_MOST && f->picture_height <= SIDE_MOST &&
           f->size[0] <= UINT16_MAX && f->size[1] <= UINT16_MAX && f->size[2] <= UINT16_MAX &&
           voxels == f->voxels && voxels <= UINT32_MAX && length - sizeof *f == voxels + 4 * pixels;
}

static enum err judge(struct diff_side *side, struct fault *fault)
{
    struct diff_facts *f = (struct diff_facts *)(void *)side->bytes.data;
    if (side->bytes.length < sizeof *f)
        return fault_memory(fault, "labels");
    f->why[sizeof f->why - 1] = f->proof[sizeof f->proof - 1] = '\0';
    for (int label = 0; label < 256; label++)
        f->label_name[label][LABEL_NAME_BYTES - 1] = '\0';
    /* Status 1 stands for a difference between the two, and for nothing else. */
    if (f->err > OK && f->err <= ERR_CANCELLED)
        return fault_set(fault, f->err == ERR_CHECK ? ERR_INPUT : f->err, "%s", f->why);
    if (f->err || !is_whole(f, side->bytes.length))
        return fault_set(fault, ERR_INPUT, "its process hands back what makes no sense");
    side->facts = f;
    side->labels = (const uint8_t *)(f + 1);
    side->pixels = side->labels + f->voxels;
    return OK;
}

/* Carries out options->path[which]; with `other`, the side of B, draws the picture of both. */
static enum err carry_out_side(struct diff_side *side, const struct diff_options *options,
                               int which, const struct diff_side *other, struct fault *fault)
{
    struct work work = {options, which, other};
    const struct processes how = {.work = carry_out_one,
                                  .context = &work,
                                  .most =
                                      (uint64_t)sizeof(struct diff_facts) + UINT32_MAX + FRAME_MOST,
                                  .watch = options->watch};
    enum err err = process_run(&side->bytes, &how, fault);
    if (!err)
        err = judge(side, fault);
    return err && err != ERR_CANCELLED ? fault_prefix(fault, err, "%s", options->path[which]) : err;
}

/* ---- both ---- */

struct journals {
    const struct diff_options *options;
    struct diff_side side[2]; /* A, B */
    struct first_difference first_difference;
    struct overlap overlap;
};

/* ---- the picture ---- */

static enum err write_picture(const struct journals *j, struct fault *fault)
{
    const struct diff_facts *a = j->side[0].facts;
    struct picture picture = {0};
    struct buf words = {0};
    if (!j->options->picture)
        return OK;
    enum err err = picture_init(&picture, a->picture_width, a->picture_height, false, fault);
    if (!err) {
        memcpy(picture.rgba, j->side[0].pixels, (size_t)4 * picture.width * picture.height);
        err = picture_note(&picture, "Software", "iftty " PROGRAM_VERSION, fault);
    }
    buf_printf(&words, "%" PRIu64 " of %" PRIu64 " voxels", j->overlap.differing,
               j->overlap.voxels);
    if (!err)
        err = picture_note(&picture, "iftty:differ", buf_text(&words), fault);
    if (!err)
        err = image_write_png(j->options->picture, &picture, fault);
    buf_release(&words);
    picture_release(&picture);
    return err;
}

/* ---- the report ---- */

static bool scenes_are_same(const struct journals *j)
{
    return strcmp(j->side[0].facts->proof, j->side[1].facts->proof) == 0 &&
           j->side[0].facts->scene_digest == j->side[1].facts->scene_digest;
}

static const char *name_of(const struct journals *j, int label)
{
    const char *name = j->side[0].facts->label_name[label];
    return *name ? name : j->side[1].facts->label_name[label];
}

static bool is_listed(const struct overlap *overlap, int label)
{
    return overlap->a[label] || overlap->b[label];
}

static void write_first_difference(struct buf *out, const struct journals *j)
{
    const struct first_difference *p = &j->first_difference;
    if (!p->is_there) {
        buf_printf(out, "commands  %zu, all the same\n", p->same);
        return;
    }
    buf_printf(out, "commands  %zu the same, then they differ\n", p->same);
    for (int i = 0; i < 2; i++) {
        buf_printf(out, "    %s  ", i ? "B" : "A");
        buf_add_safe_text(out, j->options->path[i]);
        if (p->side[i].goes_on) {
            buf_printf(out, ", command %zu, line %zu: ", p->side[i].number, p->side[i].line);
            buf_add_safe(out, buf_text(&p->side[i].command), p->side[i].command.length);
        } else {
            buf_add_text(out, " ends there");
        }
        buf_add_char(out, '\n');
    }
}

static void write_labels(struct buf *out, const struct journals *j)
{
    const struct overlap *o = &j->overlap;
    buf_printf(out, "%-22s %7s %12s %12s %12s\n", "labels", "Dice", "in A", "in B", "in both");
    for (int label = 1; label < 256; label++) {
        struct buf name = {0};
        const unsigned dice = overlap_dice(o, (uint8_t)label);
        if (!is_listed(o, label))
            continue;
        buf_printf(&name, "%d ", label);
        buf_add_safe_text(&name, name_of(j, label));
        buf_printf(out, "%-22s %2u.%04u %12" PRIu64 " %12" PRIu64 " %12" PRIu64 "\n",
                   buf_text(&name), dice / DICE_ONE, dice % DICE_ONE, o->a[label], o->b[label],
                   o->both[label]);
        buf_release(&name);
    }
    buf_printf(out, "voxels    %" PRIu64 " of %" PRIu64 " differ\n", o->differing, o->voxels);
}

static void write_warnings(struct buf *out, const struct journals *j)
{
    for (int i = 0; i < 2; i++) {
        const struct diff_facts *f = j->side[i].facts;
        const struct {
            bool holds;
            const char *words;
        } warning[] = {
            {f->is_edited, "was edited by hand; it gives the results that it records"},
            {f->is_torn, "ends with an unfinished record, which was left alone"},
            {f->pending > 0, "ends with edits that wait for a run; they are not compared"},
        };
        for (size_t k = 0; k < sizeof warning / sizeof warning[0]; k++)
            if (warning[k].holds) {
                buf_add_text(out, "# ");
                buf_add_safe_text(out, j->options->path[i]);
                buf_printf(out, " %s\n", warning[k].words);
            }
    }
    if (!scenes_are_same(j))
        buf_add_text(out, "# the scenes are not the same: voxels were compared place by place\n");
}

static void add_json_side(struct json *json, const struct journals *j, int which)
{
    const struct first_difference *p = &j->first_difference;
    json_object(json, which ? "b" : "a");
    json_text(json, "file", j->options->path[which]);
    if (p->side[which].goes_on) {
        const struct buf *command = &p->side[which].command;
        json_count(json, "number", p->side[which].number);
        json_count(json, "line", p->side[which].line);
        json_bytes(json, "command", buf_text(command), command->length);
    }
    json_text(json, "scene", j->side[which].facts->proof);
    json_end(json);
}

static void write_json(struct buf *out, const struct journals *j)
{
    const struct overlap *o = &j->overlap;
    struct json json = {.out = out};
    json_object(&json, NULL);
    json_count(&json, "same_commands", j->first_difference.same);
    json_boolean(&json, "parts", j->first_difference.is_there);
    add_json_side(&json, j, 0);
    add_json_side(&json, j, 1);
    json_boolean(&json, "same_scene", scenes_are_same(j));
    json_array(&json, "size");
    for (int a = 0; a < 3; a++)
        json_count(&json, NULL, j->side[0].facts->size[a]);
    json_end(&json);
    json_count(&json, "voxels", o->voxels);
    json_count(&json, "differing", o->differing);
    json_array(&json, "labels");
    for (int label = 1; label < 256; label++) {
        if (!is_listed(o, label))
            continue;
        json_object(&json, NULL);
        json_count(&json, "label", (uint64_t)label);
        json_text(&json, "name", name_of(j, label));
        json_count(&json, "dice_ten_thousandths", overlap_dice(o, (uint8_t)label));
        json_count(&json, "a", o->a[label]);
        json_count(&json, "b", o->b[label]);
        json_count(&json, "both", o->both[label]);
        json_end(&json);
    }
    json_end(&json);
    json_end(&json);
}

/* To standard output or standard error; releases it. */
static enum err give(struct buf *text, void (*to)(void *context, const char *text),
                     const struct printer *printer, struct fault *fault)
{
    const enum err err = text->failed ? fault_memory(fault, "a report") : OK;
    if (!err && text->length)
        to(printer->context, buf_text(text));
    buf_release(text);
    return err;
}

static enum err report(const struct journals *j, const struct printer *printer, struct fault *fault)
{
    struct buf text = {0}, warnings = {0};
    write_warnings(&warnings, j);
    enum err err = give(&warnings, printer->warn, printer, fault);
    if (j->options->json) {
        write_json(&text, j);
    } else {
        const struct diff_facts *f = j->side[0].facts;
        if (scenes_are_same(j))
            buf_printf(&text, "scenes    the same: %ux%ux%u voxels, SHA-256 %s\n", f->size[0],
                       f->size[1], f->size[2], f->proof);
        else
            buf_printf(&text, "scenes    not the same; both have %ux%ux%u voxels\n", f->size[0],
                       f->size[1], f->size[2]);
        write_labels(&text, j);
    }
    const enum err said = give(&text, printer->print, printer, fault);
    return err ? err : said;
}

/* ---- all of it ---- */

static enum err compare(struct journals *j, const struct printer *printer, struct fault *fault)
{
    const struct diff_options *o = j->options;
    struct buf text = {0};
    enum err err = image_check_png(o->picture, fault);
    if (err)
        fault_prefix(fault, err, "--picture");
    else
        err = first_difference_of_files(&j->first_difference, FIRST_COMMAND, o->path, o->path,
                                        o->last, fault);
    if (!err && !o->json) {
        write_first_difference(&text, j);
        err = give(&text, printer->print, printer, fault);
    }
    if (!err)
        err = carry_out_side(j->side + 1, o, 1, NULL, fault);
    if (!err)
        err = carry_out_side(j->side, o, 0, o->picture ? j->side + 1 : NULL, fault);
    const struct diff_facts *a = j->side[0].facts, *b = j->side[1].facts;
    if (!err && memcmp(a->size, b->size, sizeof a->size) != 0)
        err = fault_set(fault, ERR_INPUT,
                        "scenes of %ux%ux%u and %ux%ux%u voxels: expected two of one size, whose "
                        "labels can be compared",
                        a->size[0], a->size[1], a->size[2], b->size[0], b->size[1], b->size[2]);
    if (!err)
        overlap_count(&j->overlap, j->side[0].labels, j->side[1].labels, a->voxels);
    if (!err)
        err = report(j, printer, fault);
    if (!err)
        err = write_picture(j, fault);
    if (!err && j->overlap.differing)
        err = fault_set(fault, ERR_CHECK, "%" PRIu64 " of %" PRIu64 " voxels %s another label",
                        j->overlap.differing, j->overlap.voxels,
                        j->overlap.differing == 1 ? "has" : "have");
    return err;
}

enum err diff_journals(const struct diff_options *options, const struct printer *printer,
                       struct fault *fault)
{
    struct journals j = {.options = options};
    const enum err err = compare(&j, printer, fault);
    buf_release(&j.side[0].bytes);
    buf_release(&j.side[1].bytes);
    first_difference_release(&j.first_difference);
    return err;
}
