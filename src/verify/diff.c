#include "image/helper.h"
#include "verify/diff.h"

#include <inttypes.h>
#include <string.h>

#include "base/json.h"
#include "engine/overlap.h"
#include "verify/diff_side.h"
#include "verify/first_difference.h"

struct journals {
    const struct diff_options *options;
    struct diff_side side[2]; /* A, B */
    struct first_difference first_difference;
    struct overlap overlap;
};

static enum err compare_labels(struct journals *j, struct fault *fault)
{
    const struct diff_facts *a = j->side[0].facts, *b = j->side[1].facts;
    if (memcmp(a->size, b->size, sizeof a->size) != 0)
        return fault_set(fault, ERR_INPUT,
                         "scenes of %ux%ux%u and %ux%ux%u voxels: expected two of one size, whose "
                         "labels can be compared",
                         a->size[0], a->size[1], a->size[2], b->size[0], b->size[1], b->size[2]);
    overlap_count(&j->overlap, j->side[0].labels, j->side[1].labels, a->voxels);
    return OK;
}

/* ---- the picture ---- */

static enum err note_picture(struct picture *picture, const struct journals *j, struct fault *fault)
{
    struct buf words = {0};
    buf_printf(&words, "%" PRIu64 " of %" PRIu64 " voxels", j->overlap.differing,
               j->overlap.voxels);
    enum err err = picture_note(picture, "Software", "iftty " PROGRAM_VERSION, fault);
    if (!err)
        err = picture_note(picture, "iftty:differ", buf_text(&words), fault);
    buf_release(&words);
    return err;
}

static enum err write_picture(const struct journals *j, struct fault *fault)
{
    const struct diff_facts *a = j->side[0].facts;
    struct picture picture = {0};
    if (!j->options->picture)
        return OK;
    enum err err = picture_init(&picture, a->picture_width, a->picture_height, false, fault);
    if (!err) {
        memcpy(picture.rgba, j->side[0].pixels, (size_t)4 * picture.width * picture.height);
        err = note_picture(&picture, j, fault);
    }
    if (!err)
        err = image_write_png(j->options->picture, &picture, fault);
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

static void write_scenes(struct buf *out, const struct journals *j)
{
    const struct diff_facts *f = j->side[0].facts;
    if (scenes_are_same(j))
        buf_printf(out, "scenes    the same: %ux%ux%u voxels, SHA-256 %s\n", f->size[0], f->size[1],
                   f->size[2], f->proof);
    else
        buf_printf(out, "scenes    not the same; both have %ux%ux%u voxels\n", f->size[0],
                   f->size[1], f->size[2]);
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

static void add_json_label(struct json *json, const struct journals *j, uint8_t label)
{
    const struct overlap *o = &j->overlap;
    json_object(json, NULL);
    json_count(json, "label", label);
    json_text(json, "name", name_of(j, label));
    json_count(json, "dice_ten_thousandths", overlap_dice(o, label));
    json_count(json, "a", o->a[label]);
    json_count(json, "b", o->b[label]);
    json_count(json, "both", o->both[label]);
    json_end(json);
}

static void write_json(struct buf *out, const struct journals *j)
{
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
    json_count(&json, "voxels", j->overlap.voxels);
    json_count(&json, "differing", j->overlap.differing);
    json_array(&json, "labels");
    for (int label = 1; label < 256; label++)
        if (is_listed(&j->overlap, label))
            add_json_label(&json, j, (uint8_t)label);
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
        write_scenes(&text, j);
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
        err = diff_side_carry_out(j->side + 1, o, 1, NULL, fault);
    if (!err)
        err = diff_side_carry_out(j->side, o, 0, o->picture ? j->side + 1 : NULL, fault);
    if (!err)
        err = compare_labels(j, fault);
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
    diff_side_release(j.side);
    diff_side_release(j.side + 1);
    first_difference_release(&j.first_difference);
    return err;
}
