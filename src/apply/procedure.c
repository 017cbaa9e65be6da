/* SPDX-License-Identifier: MIT */
#include "apply/procedure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/safe.h"
#include "base/scan.h"
#include "command/act.h"
#include "command/command.h"
#include "engine/finish.h"
#include "engine/grid.h"
#include "engine/scene.h"
#include "image/levels.h"
#include "session/map.h"
#include "session/markers.h"
#include "session/setting.h"

enum { INTENSITIES = UINT16_MAX + 1 };

double percentiles_value(const struct session *session, uint32_t cell)
{
    return levels_value(&session->geometry, session->levels, session->scene->cell[cell].intensity);
}

/* Lowest intensity that at most a tenth of `tenths` of the voxels exceed. */
static uint16_t intensity_at_tenth(const uint32_t *count, uint64_t voxels, unsigned tenths)
{
    uint64_t below = 0;
    unsigned at = 0;
    while (at < UINT16_MAX && (below += count[at]) * 10 < voxels * tenths)
        at++;
    return (uint16_t)at;
}

static bool count_all(uint32_t *count[256], struct percentiles *out, const struct session *session,
                      const uint16_t *label)
{
    const struct scene *scene = session->scene;
    for (struct grid_walk w = grid_rows(&scene->grid, NULL, NULL); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++, label++) {
            if (*label > 255)
                continue;
            if (!count[*label] && !(count[*label] = mem_new(INTENSITIES * sizeof **count)))
                return false;
            count[*label][scene->cell[c].intensity]++;
            out->voxels[*label]++;
        }
    return true;
}

enum err percentiles_find(struct percentiles *out, const struct session *session,
                          const uint16_t *label, struct fault *fault)
{
    uint32_t *count[256] = {NULL};
    *out = (struct percentiles){.voxels = {0}};
    const bool fine = count_all(count, out, session, label);
    for (unsigned l = 0; l < 256; l++) {
        if (fine && count[l]) {
            const double low = levels_value(&session->geometry, session->levels,
                                            intensity_at_tenth(count[l], out->voxels[l], 1)),
                         high = levels_value(&session->geometry, session->levels,
                                             intensity_at_tenth(count[l], out->voxels[l], 9));
            out->low[l] = low < high ? low : high; /* the slope may be negative */
            out->high[l] = low < high ? high : low;
        }
        free(count[l]);
    }
    return fine ? OK : fault_memory(fault, "the intensities of labels");
}

_Static_assert((int)PROCEDURE_NAME == (int)LABEL_NAME_BYTES &&
                   (int)PROCEDURE_NAME == (int)LANDMARK_NAME_BYTES &&
                   (int)PROCEDURE_LANDMARKS == (int)LANDMARKS,
               "names and landmarks of a session fit");

/* ---- markers of each command ---- */

struct planted {
    size_t record, first, last; /* markers, counted from 1 */
};

struct noting {
    struct planted *planted;
    size_t count, capacity, seen;
    bool failed, with_image;
};

static void note_markers(void *context, const struct interpreter *interp, const struct reply *reply)
{
    (void)reply;
    struct noting *n = context;
    const size_t now = interp->session->markers.count;
    if (now == n->seen)
        return;
    n->failed |= !mem_grow(&n->planted, &n->capacity, n->count + 1, sizeof *n->planted);
    if (!n->failed)
        n->planted[n->count++] = (struct planted){interp->history.records, n->seen + 1, now};
    n->seen = now;
}

/* ---- gestures ---- */

/* Test whether at least half of a marker's seeds are still in effect; another marker may cover it.
 */
static bool is_still_valid(const struct markers *markers, const struct marker *marker)
{
    uint32_t own = 0;
    for (uint32_t i = 0; i < marker->voxels; i++)
        own += markers_seed(markers, markers->cover[marker->first + i].cell) == marker->label;
    return marker->is_valid && marker->label >= 0 && 2 * own >= marker->voxels && own > 0;
}

static double length_mm(const struct value *value, double voxel_mm)
{
    return value->in_mm ? (double)value->number / 1e6 : (double)value->number * voxel_mm;
}

static enum err add_gesture(struct procedure *p, const struct session *session,
                            const struct call *call, struct fault *fault)
{
    const struct geometry *geometry = &session->geometry;
    const struct value *to = call_value(call, "to"), *place = call_value(call, "PLACE"),
                       *within = call_value(call, "within");
    const double voxel_mm = cbrt(procedure_voxel_mm3(p));
    const uint32_t(*corner)[3] =
        (const uint32_t(*)[3])(to->given ? to->line->corner[0] : place->place);
    const uint32_t first =
        grid_cell(&session->scene->grid, corner[0][0], corner[0][1], corner[0][2]);
    const struct procedure_gesture gesture = {
        .label = (uint8_t)call_value(call, "LABEL")->number,
        .radius_mm = length_mm(call_value(call, "radius"), voxel_mm),
        .within_mm = within->given && !within->number ? GESTURE_EXACT : length_mm(within, voxel_mm),
        .has_over = call_has(call, "over|keep"),
        .over = call_takes(call),
        .intensity = percentiles_value(session, first)};
    TRY(procedure_add_gesture(p, &gesture, fault));
    for (size_t i = 0; i < (to->given ? to->line->count : 1); i++) {
        double mm[3];
        geometry_point(geometry, corner[i], mm);
        TRY(procedure_add_corner(p, mm, fault));
    }
    return OK;
}

/* Only balls and strokes are kept; other gestures are kept by the labels. */
static enum err take_gestures(struct procedure *p, const struct noting *noting,
                              const struct interpreter *interp, struct fault *fault)
{
    const struct markers *markers = &interp->session->markers;
    const struct history *history = &interp->history;
    enum err err = OK;
    for (size_t i = 0; !err && i < noting->count; i++) {
        const struct planted *planted = &noting->planted[i];
        const char *line = NULL;
        OWNED(call_release) struct call call = {.command = NULL};
        bool is_valid = false;
        for (size_t k = 1; !line && k < history->points; k++)
            if (history->point[k].record == planted->record)
                line = history->point[k].command;
        for (size_t m = planted->first; line && !is_valid && m <= planted->last; m++)
            is_valid = is_still_valid(markers, &markers->marker[m - 1]);
        if (!is_valid)
            continue;
        if (!command_parse(&call, line, interp->session, NULL) && call.command &&
            call.command->flags & COMMAND_CARRIED && !call_has(&call, "shell") &&
            (planted->first == planted->last || call_has(&call, "over|keep")))
            err = add_gesture(p, interp->session, &call, fault);
        else
            p->left[LEFT_GESTURES]++;
    }
    return noting->failed ? fault_memory(fault, "gestures") : err;
}

/* ---- settings ---- */

static void write_settings(struct buf *out, const struct kept *kept, const struct state *state)
{
    OWNED(buf_release) struct buf text = {0};
    if (kept->weight.kind != WEIGHT_FILE) { /* a map belongs to its scene: use the default */
        act_write_weight(&text, kept);
        buf_add_text(out, "weight ");
        buf_add(out, buf_text(&text),
                kept->weight.kind == WEIGHT_POLARITY ? strcspn(buf_text(&text), " ") : text.length);
        buf_add_char(out, '\n');
    }
    for (unsigned label = 0; kept->weight.kind == WEIGHT_POLARITY && label < 256; label++)
        if (kept->polarity[label])
            buf_printf(out, "polarity %u %d\n", numbering_of(kept, label), kept->polarity[label]);
    for (const struct command *setting = setting_table; setting->name; setting++)
        if (setting->flags & COMMAND_CARRIED) {
            setting_write(out, setting, state);
            buf_add_char(out, '\n');
        }
    buf_clear(&text);
    numbering_write_finish(&text, kept);
    for (const char *at = buf_text(&text); kept->finish.count && *at;) {
        const char *next = strstr(at, ", ");
        buf_printf(out, "finish %.*s\n", next ? (int)(next - at) : (int)strlen(at), at);
        at = next ? next + 2 : "";
    }
    out->failed |= text.failed;
}

/* ---- from a session ---- */

static enum err take_labels(struct procedure *p, const struct session *session, struct fault *fault)
{
    const struct kept *kept = &session->now.kept;
    const struct scene *scene = session->scene;
    const struct grid *grid = &scene->grid;
    OWNED(mem_release) struct percentiles *found = mem_new(sizeof *found);
    OWNED(mem_release) uint16_t *label = mem_array(grid->voxels, sizeof *label);
    p->voxel = mem_array(grid->voxels, 1);
    if (!found || !label || !p->voxel)
        return fault_memory(fault, "labels");
    size_t i = 0;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++, i++)
            label[i] = p->voxel[i] = scene->cell[c].label;
    TRY(percentiles_find(found, session, label, fault));
    for (unsigned l = 0; l < 256; l++) {
        struct procedure_label *to = &p->label[l];
        to->is_there = found->voxels[l] || kept->label_number[l];
        to->voxels = found->voxels[l];
        to->low = found->low[l];
        to->high = found->high[l];
        to->number = kept->label_number[l];
        memcpy(to->name, kept->label_name[l], sizeof to->name);
        memcpy(to->code, kept->label_code[l], sizeof to->code);
        memcpy(to->rgb, kept->palette.rgb[l], sizeof to->rgb);
    }
    return OK;
}

static enum err take_all(struct procedure *p, const struct noting *noting,
                         const struct interpreter *interp, struct fault *fault)
{
    struct session *session = interp->session;
    const struct geometry *geometry = &session->geometry;
    TRY(session_complete(session, fault));
    if (session_pendings(session))
        TRY(session_run(session, fault));
    if (!geometry_has_sides(geometry))
        return fault_set(fault, ERR_INPUT,
                         "the file of its scene does not say %s, and iftty does not guess it; add "
                         "`orient` and `open ... spacing=` to a journal of that scene",
                         geometry->spacing_unknown ? "how far apart voxels are"
                                                   : "to which sides of the patient its axes run");
    if (kept_channels(&session->now.kept))
        return fault_set(fault, ERR_INPUT,
                         "its scene has several channels, and `apply` has no files for those of "
                         "other scenes; `channel 2 remove=yes` in a copy of it leaves channel 1");
    p->has_place = geometry_has_place(geometry);
    memcpy(p->to_mm.m, geometry->to_mm, sizeof p->to_mm.m);
    memcpy(p->size, session->scene->grid.size, sizeof p->size);
    memcpy(p->scene, session->proof, sizeof p->scene);
    const struct kept *kept = &session->now.kept;
    TRY(take_labels(p, session, fault));
    TRY(take_gestures(p, noting, interp, fault));
    for (size_t i = 0; i < LANDMARKS && *kept->landmark[i].name; i++) {
        struct procedure_landmark *mark = &p->landmark[p->landmarks++];
        memcpy(mark->name, kept->landmark[i].name, sizeof mark->name);
        geometry_point(geometry, kept->landmark[i].place, mark->mm);
    }
    write_settings(&p->settings, kept, &session->now);
    p->left[LEFT_WEIGHTS] = kept->weight.kind == WEIGHT_FILE;
    p->left[LEFT_MASK] = *kept->mask_file != '\0';
    p->left[LEFT_RANGE] = kept->has_range != 0;
    return p->settings.failed ? fault_memory(fault, "a procedure") : OK;
}

/* ---- from the replaying process ---- */

/* Return the length of the text, the text, and the intensities. */
static enum err hand_back(void *context, const struct interpreter *interp,
                          const struct side_facts *facts, const uint8_t *label, struct buf *out,
                          struct fault *fault)
{
    (void)label;
    const struct noting *noting = context;
    const struct scene *scene = interp->session->scene;
    const struct grid *grid = &scene->grid;
    OWNED(procedure_release) struct procedure procedure = {.chain = facts->chain};
    OWNED(buf_release) struct buf text = {0};
    const enum err err = take_all(&procedure, noting, interp, fault);
    if (!err)
        procedure_write(&text, &procedure);
    const uint64_t length = text.length;
    buf_add(out, &length, sizeof length);
    buf_add(out, buf_text(&text), text.length);
    out->failed |= text.failed;
    uint16_t *to = !err && noting->with_image ? buf_reserve(out, grid->voxels * sizeof *to) : NULL;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); to && grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++, out->length += sizeof *to)
            memcpy(out->data + out->length, &scene->cell[c].intensity, sizeof *to);
    return err;
}

/* The process may be compromised: its text is parsed like a stranger's. */
static enum err take_back(struct buf *text, struct buf *image, const struct side *side,
                          const char *path, struct fault *fault)
{
    const char *at = side->more;
    uint64_t length, left = side->facts->more;
    if (left >= sizeof length)
        memcpy(&length, at, sizeof length);
    if (left < sizeof length || length > left - sizeof length)
        return fault_set(fault, ERR_INPUT, "%s: the answer of its process makes no sense", path);
    at += sizeof length, left -= sizeof length;
    buf_add(text, at, length);
    if (image)
        buf_add(image, at + length, left - length);
    return text->failed || (image && image->failed) ? fault_memory(fault, "a procedure") : OK;
}

/* ---- from a file ---- */

enum err procedure_text(struct buf *text, struct buf *image, const struct procedure_source *source,
                        struct fault *fault)
{
    struct noting noting = {.with_image = image};
    const struct side_work work = {
        .context = &noting, .hear = note_markers, .add = hand_back, .most = UINT32_MAX};
    struct side_options how = source->journal;
    OWNED(side_release) struct side side = {.facts = NULL};
    if (file_begins_with(source->path, PROCEDURE_BEGINS))
        return file_read(text, source->path, PROCEDURE_BYTES, fault);
    how.is_strict = true;
    TRY(side_carry_out(&side, source->path, &how, &work, fault));
    return take_back(text, image, &side, source->path, fault);
}

enum err procedure_load(struct procedure *p, struct buf *image,
                        const struct procedure_source *source, struct fault *fault)
{
    OWNED(buf_release) struct buf text = {0};
    TRY(procedure_text(&text, image, source, fault));
    enum err err = procedure_read(p, buf_text(&text), text.length, fault);
    if (!err && image && image->length &&
        image->length != (size_t)2 * p->size[0] * p->size[1] * p->size[2])
        err = fault_set(fault, ERR_INPUT, "the answer of its process makes no sense");
    return fault_prefix(fault, err, "%s", source->path);
}

enum { RUNS_LINE = 90 };

void procedure_release(struct procedure *p)
{
    buf_release(&p->settings);
    free(p->gesture);
    free(p->corner);
    free(p->voxel);
    *p = (struct procedure){0};
}

void procedure_numbers(uint32_t number[256], const struct procedure *p)
{
    bool is_used = false;
    for (unsigned l = 0; l < 256; l++)
        is_used |= p->label[l].number > 0;
    for (unsigned l = 0; l < 256; l++)
        number[l] = is_used ? p->label[l].number : l;
}

double procedure_voxel_mm3(const struct procedure *p)
{
    return fabs(affine_determinant(&p->to_mm));
}

enum err procedure_add_gesture(struct procedure *p, const struct procedure_gesture *gesture,
                               struct fault *fault)
{
    if (p->gestures == PROCEDURE_GESTURES)
        return fault_set(fault, ERR_LIMIT, "it has more than %d gestures", PROCEDURE_GESTURES);
    if (!mem_grow(&p->gesture, &p->gesture_capacity, p->gestures + 1, sizeof *p->gesture))
        return fault_memory(fault, "gestures");
    p->gesture[p->gestures] = *gesture;
    p->gesture[p->gestures].corner = p->corners;
    p->gesture[p->gestures++].corners = 0;
    return OK;
}

enum err procedure_add_corner(struct procedure *p, const double mm[3], struct fault *fault)
{
    if (p->corners == PROCEDURE_CORNERS)
        return fault_set(fault, ERR_LIMIT, "its gestures have more than %d corners",
                         PROCEDURE_CORNERS);
    if (!mem_grow(&p->corner, &p->corner_capacity, p->corners + 1, sizeof *p->corner))
        return fault_memory(fault, "gestures");
    memcpy(p->corner[p->corners++], mm, sizeof *p->corner);
    p->gesture[p->gestures - 1].corners++;
    return OK;
}

/* ---- writing ---- */

static void write_reals(struct buf *out, const double *value, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const struct decimal decimal = decimal_near(value[i], 17);
        buf_add_char(out, ' ');
        decimal_write(out, &decimal);
    }
}

static void write_voxels(struct buf *out, const struct procedure *p)
{
    const size_t voxels = (size_t)p->size[0] * p->size[1] * p->size[2];
    size_t begin = out->length;
    for (size_t i = 0, next; i < voxels; i = next) {
        for (next = i + 1; next < voxels && p->voxel[next] == p->voxel[i];)
            next++;
        buf_printf(out, "%u*%zu", p->voxel[i], next - i);
        const bool ends = next == voxels || out->length - begin > RUNS_LINE;
        buf_add_char(out, ends ? '\n' : ' ');
        begin = ends ? out->length : begin;
    }
}

void procedure_write(struct buf *out, const struct procedure *p)
{
    const size_t begin = out->length;
    char digest[SHA256_HEX];
    buf_printf(out, PROCEDURE_BEGINS "%d\nchain %s\nscene %s\nworld %s\nsize %u %u %u\nto_mm",
               PROCEDURE_VERSION, p->chain.hex, p->scene, p->has_place ? "place" : "sides",
               p->size[0], p->size[1], p->size[2]);
    write_reals(out, p->to_mm.m[0], 12);
    buf_add_char(out, '\n');
    if (p->left[LEFT_WEIGHTS] | p->left[LEFT_MASK] | p->left[LEFT_RANGE] | p->left[LEFT_GESTURES])
        buf_printf(out, "left %u %u %u %u\n", p->left[LEFT_WEIGHTS], p->left[LEFT_MASK],
                   p->left[LEFT_RANGE], p->left[LEFT_GESTURES]);
    for (const char *at = buf_text(&p->settings); *at;) {
        const size_t n = strcspn(at, "\n");
        buf_printf(out, "setting %.*s\n", (int)n, at);
        at += n + (at[n] == '\n');
    }
    for (unsigned label = 0; label < 256; label++) {
        const struct procedure_label *l = &p->label[label];
        if (!l->is_there)
            continue;
        buf_printf(out, "label %u #%02x%02x%02x %u", label, l->rgb[0], l->rgb[1], l->rgb[2],
                   l->number);
        write_reals(out, (const double[]){l->low, l->high}, 2);
        buf_printf(out, *l->code ? " %s\ncode %s\n" : " %s\n", l->name, l->code);
    }
    for (size_t i = 0; i < p->landmarks; i++) {
        buf_printf(out, "landmark %s", p->landmark[i].name);
        write_reals(out, p->landmark[i].mm, 3);
        buf_add_char(out, '\n');
    }
    uint32_t index[256];
    for (unsigned label = 0; label < 256; label++)
        index[label] = label;
    for (size_t i = 0; i < p->gestures; i++) {
        const struct procedure_gesture *g = &p->gesture[i];
        buf_printf(out, "gesture %u", g->label);
        write_reals(out, (const double[]){g->radius_mm, g->within_mm, g->intensity}, 3);
        if (g->has_over) {
            buf_add_text(out, " over=");
            numbering_write_set(out, index, &g->over);
        }
        write_reals(out, p->corner[g->corner], 3 * g->corners);
        buf_add_char(out, '\n');
    }
    buf_add_text(out, "voxels\n");
    write_voxels(out, p);
    if (out->failed)
        return;
    sha256_bytes_hex(digest, out->data + begin, out->length - begin);
    buf_printf(out, "digest %s\n", digest);
}

/* ---- reading ---- */

struct reader {
    const char *at, *end; /* the text; ends with a NUL */
    const char *line;     /* current line */
    size_t number;
    struct fault *fault;
};

static enum err refuse_line(const struct reader *r, const char *expected)
{
    return fault_set(r->fault, ERR_INPUT, "line %zu of the procedure: expected %s", r->number,
                     expected);
}

/* Start the next line if it begins with this word. */
static bool begins(struct reader *r, const char *word)
{
    const char *at = r->at;
    if (!scan_text(&at, word) || (*at != ' ' && *at != '\n'))
        return false;
    r->number++;
    r->at = at;
    return true;
}

static bool ends_line(struct reader *r)
{
    return scan_text(&r->at, "\n");
}

static bool take_digits(struct reader *r, char *out, size_t digits)
{
    if (!scan_text(&r->at, " ") || strspn(r->at, "0123456789abcdef") != digits)
        return false;
    memcpy(out, r->at, digits);
    out[digits] = '\0';
    r->at += digits;
    return true;
}

static bool take_real(struct reader *r, double *out)
{
    const double most = 1e30;
    struct decimal decimal;
    if (!scan_text(&r->at, " ") || !decimal_scan(&r->at, &decimal))
        return false;
    *out = decimal_value(&decimal);
    return *out >= -most && *out <= most;
}

static bool take_reals(struct reader *r, double *out, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!take_real(r, &out[i]))
            return false;
    return true;
}

static bool take_number(struct reader *r, int64_t least, int64_t most, int64_t *out)
{
    return scan_text(&r->at, " ") && scan_integer(&r->at, least, most, out);
}

/* Read a text up to a character of `until`; it may be empty. */
static bool take_text(struct reader *r, char *out, size_t room, const char *until)
{
    const size_t n = scan_text(&r->at, " ") ? strcspn(r->at, until) : room;
    if (n >= room)
        return false;
    memcpy(out, r->at, n);
    memset(out + n, 0, room - n);
    r->at += n;
    return *safe_end(out) == '\0';
}

static bool take_name(struct reader *r, char *out, size_t room, const char *until)
{
    return take_text(r, out, room, until) && !strpbrk(out, "=\"\\");
}

static enum err read_head(struct reader *r, struct procedure *p)
{
    int64_t size[3], version;
    char world[8];
    if (!begins(r, "iftty") || !scan_text(&r->at, " procedure") ||
        !take_number(r, 1, 999999999, &version) || !ends_line(r))
        return refuse_line(r, "`" PROCEDURE_BEGINS "1` on the first line");
    if (version > PROCEDURE_VERSION)
        return fault_set(r->fault, ERR_INPUT,
                         "it is a procedure of version %lld, and this program knows %d",
                         (long long)version, PROCEDURE_VERSION);
    if (!begins(r, "chain") || !take_digits(r, p->chain.hex, RECORD_CHAIN_DIGITS) || !ends_line(r))
        return refuse_line(r, "chain and 32 digits");
    if (!begins(r, "scene") || !take_digits(r, p->scene, SHA256_HEX - 1) || !ends_line(r))
        return refuse_line(r, "scene and 64 digits");
    if (!begins(r, "world") || !take_name(r, world, sizeof world, " \n") || !ends_line(r) ||
        (strcmp(world, "place") != 0 && strcmp(world, "sides") != 0))
        return refuse_line(r, "world place, or world sides");
    p->has_place = *world == 'p';
    if (!begins(r, "size") || !take_number(r, 1, GRID_SIDE_MOST, &size[0]) ||
        !take_number(r, 1, GRID_SIDE_MOST, &size[1]) ||
        !take_number(r, 1, GRID_SIDE_MOST, &size[2]) || !ends_line(r))
        return refuse_line(r, "size and three numbers");
    for (int a = 0; a < 3; a++)
        p->size[a] = (uint32_t)size[a];
    if ((uint64_t)size[0] * (uint64_t)size[1] > PROCEDURE_VOXELS / (uint64_t)size[2])
        return fault_set(r->fault, ERR_LIMIT, "it has more than %d voxels", PROCEDURE_VOXELS);
    struct affine inverse;
    if (!begins(r, "to_mm") || !take_reals(r, p->to_mm.m[0], 12) || !ends_line(r) ||
        !affine_invert(&inverse, &p->to_mm))
        return refuse_line(r, "to_mm and twelve numbers that can be inverted");
    return OK;
}

static enum err read_left(struct reader *r, struct procedure *p)
{
    int64_t left[LEFT_KINDS];
    for (int i = 0; i < LEFT_KINDS; i++) {
        if (!take_number(r, 0, i == LEFT_GESTURES ? UINT32_MAX : 1, &left[i]))
            return refuse_line(r, "left, 0 or 1 three times, and a number");
        p->left[i] = (uint32_t)left[i];
    }
    return ends_line(r) ? OK : refuse_line(r, "the end of the line");
}

static enum err read_labels(struct reader *r, struct procedure *p)
{
    int64_t number, label, before = -1;
    uint64_t colour;
    while (begins(r, "label")) {
        if (!take_number(r, before + 1, 255, &label))
            return refuse_line(r, "labels 0..255, in rising order");
        struct procedure_label *l = &p->label[label];
        if (!scan_text(&r->at, " #") || !scan_hex(&r->at, 6, &colour) ||
            !take_number(r, 0, UINT32_MAX, &number) || !take_real(r, &l->low) ||
            !take_real(r, &l->high) || l->low > l->high ||
            !take_name(r, l->name, sizeof l->name, "\n") || !ends_line(r))
            return refuse_line(r, "label N #rrggbb NUMBER LOW HIGH NAME");
        if (begins(r, "code") &&
            !(label && take_text(r, l->code, sizeof l->code, "\n") && *l->code && ends_line(r)))
            return refuse_line(r, "code SCHEME:VALUE or SCHEME:VALUE:MEANING");
        for (int k = 0; k < 3; k++)
            l->rgb[k] = (uint8_t)(colour >> (16 - 8 * k));
        l->number = (uint32_t)number;
        l->is_there = true;
        before = label;
    }
    return OK;
}

static enum err read_landmarks(struct reader *r, struct procedure *p)
{
    while (begins(r, "landmark")) {
        struct procedure_landmark *mark = &p->landmark[p->landmarks];
        if (p->landmarks == PROCEDURE_LANDMARKS)
            return refuse_line(r, "no more than 64 landmarks");
        if (!take_name(r, mark->name, sizeof mark->name, " \n") || !*mark->name ||
            !take_reals(r, mark->mm, 3) || !ends_line(r))
            return refuse_line(r, "landmark NAME X Y Z");
        for (size_t i = 0; i < p->landmarks; i++)
            if (strcmp(p->landmark[i].name, mark->name) == 0)
                return refuse_line(r, "each landmark once");
        p->landmarks++;
    }
    return OK;
}

/* Read "0,3-7". */
static bool take_set(struct reader *r, struct label_set *set)
{
    int64_t first, last;
    do {
        if (!scan_range(&r->at, 0, 255, &first, &last))
            return false;
        for (; first <= last; first++)
            label_set_add(set, (uint8_t)first);
    } while (scan_text(&r->at, ","));
    return true;
}

static enum err read_gestures(struct reader *r, struct procedure *p)
{
    int64_t label;
    while (begins(r, "gesture")) {
        struct procedure_gesture g = {0};
        double mm[3];
        if (!take_number(r, 0, 255, &label) || !take_real(r, &g.radius_mm) ||
            !take_real(r, &g.within_mm) || !take_real(r, &g.intensity) || g.radius_mm < 0 ||
            (g.within_mm < 0 && g.within_mm != GESTURE_EXACT))
            return refuse_line(r, "gesture LABEL RADIUS REACH INTENSITY X Y Z ...");
        g.label = (uint8_t)label;
        g.has_over = scan_text(&r->at, " over=");
        if (g.has_over && !take_set(r, &g.over))
            return refuse_line(r, "over=, and labels as in 0,3-7");
        TRY(procedure_add_gesture(p, &g, r->fault));
        while (*r->at == ' ')
            TRY(take_reals(r, mm, 3) ? procedure_add_corner(p, mm, r->fault)
                                     : refuse_line(r, "corners of three numbers each"));
        if (g.within_mm > 0 && p->gesture[p->gestures - 1].corners > 1)
            return refuse_line(r, "a reach for a ball alone, and not for a stroke");
        if (!p->gesture[p->gestures - 1].corners || !ends_line(r))
            return refuse_line(r, "a corner of three numbers, and the end of the line");
    }
    return OK;
}

static enum err read_voxels(struct reader *r, struct procedure *p)
{
    const size_t voxels = (size_t)p->size[0] * p->size[1] * p->size[2];
    int64_t label, count;
    size_t done = 0;
    if (!begins(r, "voxels") || !ends_line(r))
        return refuse_line(r, "voxels, or lines in the order of the format");
    p->voxel = mem_array(voxels, 1);
    if (!p->voxel)
        return fault_memory(r->fault, "the labels of a procedure");
    r->number++;
    while (done < voxels) {
        if (!scan_integer(&r->at, 0, 255, &label) || !scan_text(&r->at, "*") ||
            !scan_integer(&r->at, 1, (int64_t)(voxels - done), &count) ||
            (label && !p->label[label].is_there))
            return refuse_line(r, "runs LABEL*COUNT of labels with a line, one for each voxel");
        memset(p->voxel + done, (int)label, (size_t)count);
        p->label[label].voxels += (uint64_t)count;
        done += (size_t)count;
        if (scan_text(&r->at, "\n"))
            r->number++;
        else if (!scan_text(&r->at, " "))
            return refuse_line(r, "a blank or the end of the line after a run");
    }
    r->number--;
    return OK;
}

enum err procedure_read(struct procedure *p, const char *bytes, size_t length, struct fault *fault)
{
    struct reader reader = {.at = bytes, .end = bytes + length, .fault = fault}, *r = &reader;
    char now[SHA256_HEX];
    if (length > PROCEDURE_BYTES || memchr(bytes, '\0', length))
        return fault_set(fault, ERR_INPUT,
                         "it is no procedure: it is too long, or has a zero byte");
    TRY(read_head(r, p));
    if (begins(r, "left"))
        TRY(read_left(r, p));
    while (begins(r, "setting")) {
        const size_t n = strcspn(r->at, "\n");
        if (n < 2 || r->at[n] != '\n')
            return refuse_line(r, "a command");
        buf_add(&p->settings, r->at + 1, n);
        r->at += n + 1;
    }
    if (p->settings.failed)
        return fault_memory(r->fault, "a procedure");
    TRY(read_labels(r, p));
    TRY(read_landmarks(r, p));
    TRY(read_gestures(r, p));
    TRY(read_voxels(r, p));
    sha256_bytes_hex(now, bytes, (size_t)(r->at - bytes));
    if (!begins(r, "digest") || !take_digits(r, p->digest, SHA256_HEX - 1) || !ends_line(r) ||
        r->at != r->end)
        return refuse_line(r, "digest and 64 digits, and the end of the file");
    return strcmp(now, p->digest) == 0
               ? OK
               : fault_set(fault, ERR_INPUT, "it was changed: its digest does not match");
}
