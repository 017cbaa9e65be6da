#include "verify/diff.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/process.h"
#include "verify/difference_picture.h"
#include "verify/first_difference.h"
#include "verify/replay_file.h"
#include "journal/journal.h"
#include "session/export.h"

enum { SIDE_MOST = 16384, /* of a picture */ FRAME_MOST = 4 * SIDE_MOST * SIDE_MOST };

/* ---- one side, in its process ---- */

/* What a journal has come to; followed, where it went well, by its labels [z][y][x] and the pixels
 * of the picture. It goes from one process of this program to another, so it is sent as it is. */
struct facts {
    enum err err;
    char why[sizeof((struct fault *)0)->text];
    uint32_t size[3], picture_width, picture_height; /* 0, 0: none */
    uint64_t scene_digest;
    char proof[SCENE_PROOF_HEX];
    size_t voxels, pending;
    bool is_edited, is_torn;
    char label_name[256][LABEL_NAME_BYTES];
    struct palette palette;
};

struct side {
    const struct diff_options *options;
    int which;                 /* 0: A */
    const struct facts *other; /* of B, for A's picture; or NULL */
    const uint8_t *other_label;
};

static void copy_labels(uint8_t *label, const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++)
                *label++ = scene->cell[c].label;
        }
}

/* A journal that was edited by hand, and gives what it says it gives, is told of and taken. */
static enum err carry_out(struct interpreter *interp, const struct side *side, struct facts *facts,
                          struct fault *fault)
{
    const struct diff_options *o = side->options;
    struct replay_report report = {0};
    enum err err = replay_file(interp, o->path[side->which], 0, o->last, NULL, &report, fault);
    facts->is_edited = !report.is_intact;
    facts->is_torn = report.is_torn;
    if (err == ERR_CHECK && report.outcome == REPLAY_SAME)
        err = OK;
    if (err == ERR_CHECK)
        err = fault_prefix(fault, ERR_CHECK, "it does not give what it says, see iftty verify");
    if (!err && !interp->session.has_scene)
        err = fault_set(fault, ERR_INPUT, "it opens no scene");
    replay_report_release(&report);
    return err;
}

static void note_facts(struct facts *facts, const struct session *session)
{
    memcpy(facts->size, session->scene->grid.size, sizeof facts->size);
    memcpy(facts->proof, session->proof, sizeof facts->proof);
    memcpy(facts->label_name, session->now.kept.label_name, sizeof facts->label_name);
    facts->palette = session->now.kept.palette;
    facts->scene_digest = session->scene_digest;
    facts->voxels = session->scene->grid.voxels;
    facts->pending = session_pendings(session);
}

/* Names and colours of labels that A has none of are B's. */
static void borrow(struct kept *kept, const struct facts *other, const struct overlap *overlap)
{
    for (int label = 1; label < 256; label++) {
        if (overlap->a[label])
            continue;
        memcpy(kept->palette.rgb[label], other->palette.rgb[label], 3);
        if (!kept->label_name[label][0])
            memcpy(kept->label_name[label], other->label_name[label], LABEL_NAME_BYTES);
    }
}

static enum err draw(struct picture *picture, struct session *session, const struct side *side,
                     const uint8_t *label, struct fault *fault)
{
    struct overlap *overlap = mem_new(sizeof *overlap);
    if (!overlap)
        return fault_memory(fault, "a picture");
    overlap_count(overlap, label, side->other_label, session->scene->grid.voxels);
    const struct difference_picture difference_picture = {
        .name = {file_name(side->options->path[0]), file_name(side->options->path[1])},
        .label = {label, side->other_label},
        .overlap = overlap};
    borrow(&session->now.kept, side->other, overlap);
    const enum err err = difference_picture_draw(picture, session, &difference_picture, fault);
    free(overlap);
    return err;
}

/* Labels and picture to `out`, behind the facts. */
static enum err hand_back(struct buf *out, struct session *session, const struct side *side,
                          struct facts *facts, struct fault *fault)
{
    const size_t voxels = session->scene->grid.voxels;
    struct picture picture = {0};
    uint8_t *label = buf_reserve(out, voxels);
    if (!label)
        return fault_memory(fault, "labels");
    copy_labels(label, session->scene);
    out->length += voxels;
    note_facts(facts, session);
    if (!side->other || memcmp(side->other->size, facts->size, sizeof facts->size) != 0)
        return OK;
    const enum err err = draw(&picture, session, side, label, fault);
    if (!err) {
        facts->picture_width = picture.width;
        facts->picture_height = picture.height;
        buf_add(out, picture.rgba, (size_t)4 * picture.width * picture.height);
    }
    picture_release(&picture);
    return err;
}

static void work(void *context, size_t number, struct buf *out)
{
    (void)number;
    const struct side *side = context;
    const struct diff_options *o = side->options;
    struct interpreter interp;
    struct fault fault = {0};
    struct facts *facts = mem_new(sizeof *facts);
    if (!facts)
        return;
    buf_add(out, facts, sizeof *facts);
    facts->err = interpreter_init(&interp, &fault);
    interp.scene_path = o->scene_path;
    if (!facts->err && o->begin)
        facts->err = o->begin(o->context, o->path[side->which], &fault);
    if (!facts->err)
        facts->err = carry_out(&interp, side, facts, &fault);
    if (!facts->err)
        facts->err = hand_back(out, &interp.session, side, facts, &fault);
    memcpy(facts->why, fault.text, sizeof facts->why);
    if (!out->failed)
        memcpy(out->data, facts, sizeof *facts);
    free(facts);
    interpreter_release(&interp);
}

/* ---- both, seen from here ---- */

struct journals {
    const struct diff_options *options;
    struct buf bytes[2]; /* as they came back */
    struct facts *facts[2];
    struct first_difference first_difference;
    struct overlap *overlap;
};

static const uint8_t *labels_of(const struct journals *j, int which)
{
    return (const uint8_t *)j->bytes[which].data + sizeof(struct facts);
}

/* What came back is of the form it should be, whoever has talked the process into what. */
static bool is_whole(const struct facts *f, size_t length)
{
    const uint64_t pixels = (uint64_t)f->picture_width * f->picture_height;
    const uint64_t voxels = (uint64_t)f->size[0] * f->size[1] * f->size[2];
    return f->picture_width <= SIDE_MOST && f->picture_height <= SIDE_MOST &&
           f->size[0] <= UINT16_MAX && f->size[1] <= UINT16_MAX && f->size[2] <= UINT16_MAX &&
           voxels == f->voxels && voxels <= UINT32_MAX && length - sizeof *f == voxels + 4 * pixels;
}

static void end_texts(struct facts *f)
{
    f->why[sizeof f->why - 1] = f->proof[sizeof f->proof - 1] = '\0';
    for (int label = 0; label < 256; label++)
        f->label_name[label][LABEL_NAME_BYTES - 1] = '\0';
}

static enum err take_facts(struct journals *j, int which, struct fault *fault)
{
    const struct buf *bytes = j->bytes + which;
    struct facts *f = j->facts[which];
    if (bytes->length < sizeof *f)
        return fault_memory(fault, "labels");
    memcpy(f, bytes->data, sizeof *f);
    end_texts(f);
    if (f->err > OK && f->err <= ERR_CANCELLED) {
        /* Only a difference between the two is told by status 1. */
        return fault_set(fault, f->err == ERR_CHECK ? ERR_INPUT : f->err, "%s", f->why);
    }
    return f->err || !is_whole(f, bytes->length)
               ? fault_set(fault, ERR_INPUT, "its process hands back what makes no sense")
               : OK;
}

static enum err send_for(struct journals *j, int which, struct fault *fault)
{
    const struct diff_options *o = j->options;
    const bool draws = o->picture && which == 0;
    struct side side = {.options = o,
                        .which = which,
                        .other = draws ? j->facts[1] : NULL,
                        .other_label = draws ? labels_of(j, 1) : NULL};
    const struct processes how = {.work = work,
                                  .context = &side,
                                  .most = (uint64_t)sizeof(struct facts) + UINT32_MAX + FRAME_MOST,
                                  .watch = o->watch};
    enum err err = process_run(j->bytes + which, &how, fault);
    if (!err)
        err = take_facts(j, which, fault);
    return err && err != ERR_CANCELLED ? fault_prefix(fault, err, "%s", o->path[which]) : err;
}

static enum err compare_labels(struct journals *j, struct fault *fault)
{
    const struct facts *a = j->facts[0], *b = j->facts[1];
    if (memcmp(a->size, b->size, sizeof a->size) != 0)
        return fault_set(fault, ERR_INPUT,
                         "scenes of %ux%ux%u and %ux%ux%u voxels: expected two of one size, whose "
                         "labels can be compared",
                         a->size[0], a->size[1], a->size[2], b->size[0], b->size[1], b->size[2]);
    overlap_count(j->overlap, labels_of(j, 0), labels_of(j, 1), a->voxels);
    return OK;
}

static enum err find_first_difference(struct journals *j, struct fault *fault)
{
    const struct diff_options *o = j->options;
    struct buf bytes[2] = {{0}, {0}};
    enum err err = file_read(bytes, o->path[0], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = file_read(bytes + 1, o->path[1], JOURNAL_BYTES_MAX, fault);
    if (!err)
        err = first_difference_find(&j->first_difference, o->path, bytes, o->last, fault);
    buf_release(bytes);
    buf_release(bytes + 1);
    return err;
}

/* ---- the picture ---- */

/* Asked before anything is carried out, which may take long. */
static enum err check_picture(const char *path, struct fault *fault)
{
    struct buf draft = {0};
    if (!path)
        return OK;
    if (!file_is_named(path, ".png"))
        return fault_set(fault, ERR_USAGE, "--picture: expected a name that ends in .png, not %s",
                         path);
    const enum err err = file_draft(&draft, path, FILE_KEEP, fault);
    buf_release(&draft);
    return err;
}

static enum err note_picture(struct picture *picture, const struct journals *j, struct fault *fault)
{
    struct buf words = {0};
    buf_printf(&words, "%" PRIu64 " of %" PRIu64 " voxels", j->overlap->differing,
               j->overlap->voxels);
    enum err err = picture_note(picture, "Software", "iftty " PROGRAM_VERSION, fault);
    if (!err)
        err = picture_note(picture, "iftty:differ", buf_text(&words), fault);
    buf_release(&words);
    return err;
}

static enum err write_picture(const struct journals *j, struct fault *fault)
{
    const struct facts *a = j->facts[0];
    struct picture picture = {0};
    struct image_helper *helper = NULL;
    struct buf program = {0};
    if (!j->options->picture)
        return OK;
    enum err err = picture_init(&picture, a->picture_width, a->picture_height, false, fault);
    if (!err) {
        memcpy(picture.rgba, labels_of(j, 0) + a->voxels,
               (size_t)4 * picture.width * picture.height);
        err = note_picture(&picture, j, fault);
    }
    if (!err)
        err = image_helper_default_program(&program, fault);
    if (!err)
        err = image_helper_new(&helper, buf_text(&program), fault);
    if (!err)
        err = image_write(helper, j->options->picture, FILE_KEEP, &picture, fault);
    image_helper_free(helper);
    buf_release(&program);
    picture_release(&picture);
    return err;
}

/* ---- telling ---- */

static void add_safe(struct buf *out, const char *text)
{
    buf_add_safe(out, text, strlen(text));
}

static bool scenes_are_same(const struct journals *j)
{
    return strcmp(j->facts[0]->proof, j->facts[1]->proof) == 0 &&
           j->facts[0]->scene_digest == j->facts[1]->scene_digest;
}

static const char *name_of(const struct journals *j, int label)
{
    const char *name = j->facts[0]->label_name[label];
    return *name ? name : j->facts[1]->label_name[label];
}

static bool is_told(const struct overlap *overlap, int label)
{
    return overlap->a[label] || overlap->b[label];
}

static void tell_first_difference(struct buf *out, const struct journals *j)
{
    const struct first_difference *p = &j->first_difference;
    if (!p->parts) {
        buf_printf(out, "commands  the same %zu\n", p->same);
        return;
    }
    buf_printf(out, "commands  part after %zu that are the same\n", p->same);
    for (int i = 0; i < 2; i++) {
        buf_printf(out, "    %s  ", i ? "B" : "A");
        add_safe(out, j->options->path[i]);
        if (p->side[i].goes_on) {
            buf_printf(out, ", command %zu, line %zu: ", p->side[i].number, p->side[i].line);
            buf_add_safe(out, buf_text(&p->side[i].command), p->side[i].command.length);
        } else {
            buf_add_text(out, " ends there");
        }
        buf_add_char(out, '\n');
    }
}

static void tell_scenes(struct buf *out, const struct journals *j)
{
    const struct facts *f = j->facts[0];
    if (scenes_are_same(j))
        buf_printf(out, "scenes    the same: %ux%ux%u voxels, SHA-256 %s\n", f->size[0], f->size[1],
                   f->size[2], f->proof);
    else
        buf_printf(out, "scenes    other ones, of the same %ux%ux%u voxels\n", f->size[0],
                   f->size[1], f->size[2]);
}

static void tell_labels(struct buf *out, const struct journals *j)
{
    const struct overlap *o = j->overlap;
    buf_printf(out, "%-22s %7s %12s %12s %12s\n", "labels", "Dice", "in A", "in B", "in both");
    for (int label = 1; label < 256; label++) {
        struct buf name = {0};
        const unsigned dice = overlap_dice(o, (uint8_t)label);
        if (!is_told(o, label))
            continue;
        buf_printf(&name, "%d ", label);
        add_safe(&name, name_of(j, label));
        buf_printf(out, "%-22s %2u.%04u %12" PRIu64 " %12" PRIu64 " %12" PRIu64 "\n",
                   buf_text(&name), dice / DICE_ONE, dice % DICE_ONE, o->a[label], o->b[label],
                   o->both[label]);
        buf_release(&name);
    }
    buf_printf(out, "voxels    %" PRIu64 " of %" PRIu64 " differ\n", o->differing, o->voxels);
}

/* What the user is to know besides. */
static void warn(struct buf *out, const struct journals *j)
{
    for (int i = 0; i < 2; i++) {
        const struct facts *f = j->facts[i];
        const struct {
            bool holds;
            const char *words;
        } warning[] = {
            {f->is_edited, "was edited by hand, and gives what it says all the same"},
            {f->is_torn, "ends with an unfinished record, which was left alone"},
            {f->pending > 0, "ends with edits that wait for a run, and count for nothing"},
        };
        for (size_t k = 0; k < sizeof warning / sizeof warning[0]; k++)
            if (warning[k].holds) {
                buf_add_text(out, "# ");
                add_safe(out, j->options->path[i]);
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
    json_text(json, "scene", j->facts[which]->proof);
    json_end(json);
}

static void add_json_label(struct json *json, const struct journals *j, uint8_t label)
{
    const struct overlap *o = j->overlap;
    json_object(json, NULL);
    json_count(json, "label", label);
    json_text(json, "name", name_of(j, label));
    json_count(json, "dice_ten_thousandths", overlap_dice(o, label));
    json_count(json, "a", o->a[label]);
    json_count(json, "b", o->b[label]);
    json_count(json, "both", o->both[label]);
    json_end(json);
}

static void tell_json(struct buf *out, const struct journals *j)
{
    struct json json = {.out = out};
    json_object(&json, NULL);
    json_count(&json, "same_commands", j->first_difference.same);
    json_boolean(&json, "parts", j->first_difference.parts);
    add_json_side(&json, j, 0);
    add_json_side(&json, j, 1);
    json_boolean(&json, "same_scene", scenes_are_same(j));
    json_array(&json, "size");
    for (int a = 0; a < 3; a++)
        json_count(&json, NULL, j->facts[0]->size[a]);
    json_end(&json);
    json_count(&json, "voxels", j->overlap->voxels);
    json_count(&json, "differing", j->overlap->differing);
    json_array(&json, "labels");
    for (int label = 1; label < 256; label++)
        if (is_told(j->overlap, label))
            add_json_label(&json, j, (uint8_t)label);
    json_end(&json);
    json_end(&json);
}

static enum err say(struct buf *text, void (*to)(void *context, const char *text),
                    const struct teller *teller, struct fault *fault)
{
    const enum err err = text->failed ? fault_memory(fault, "a report") : OK;
    if (!err && text->length)
        to(teller->context, buf_text(text));
    buf_release(text);
    return err;
}

static enum err tell_all(const struct journals *j, const struct teller *teller, struct fault *fault)
{
    struct buf text = {0}, warnings = {0};
    warn(&warnings, j);
    enum err err = say(&warnings, teller->complain, teller, fault);
    if (j->options->json) {
        tell_json(&text, j);
    } else {
        tell_scenes(&text, j);
        tell_labels(&text, j);
    }
    const enum err said = say(&text, teller->say, teller, fault);
    return err ? err : said;
}

/* ---- all of it ---- */

static enum err compare(struct journals *j, const struct teller *teller, struct fault *fault)
{
    struct buf text = {0};
    enum err err = check_picture(j->options->picture, fault);
    if (!err)
        err = find_first_difference(j, fault);
    if (!err && !j->options->json) {
        tell_first_difference(&text, j);
        err = say(&text, teller->say, teller, fault);
    }
    if (!err)
        err = send_for(j, 1, fault);
    if (!err)
        err = send_for(j, 0, fault);
    if (!err)
        err = compare_labels(j, fault);
    if (!err)
        err = tell_all(j, teller, fault);
    if (!err)
        err = write_picture(j, fault);
    if (!err && j->overlap->differing)
        err = fault_set(fault, ERR_CHECK, "%" PRIu64 " of %" PRIu64 " voxels have another label",
                        j->overlap->differing, j->overlap->voxels);
    return err;
}

enum err diff_journals(const struct diff_options *options, const struct teller *teller,
                       struct fault *fault)
{
    struct journals j = {.options = options,
                         .facts = {mem_new(sizeof(struct facts)), mem_new(sizeof(struct facts))},
                         .overlap = mem_new(sizeof(struct overlap))};
    enum err err = j.facts[0] && j.facts[1] && j.overlap ? compare(&j, teller, fault)
                                                         : fault_memory(fault, "a comparison");
    for (int i = 0; i < 2; i++) {
        buf_release(j.bytes + i);
        free(j.facts[i]);
    }
    first_difference_release(&j.first_difference);
    free(j.overlap);
    return err;
}
