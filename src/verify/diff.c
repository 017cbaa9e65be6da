/* SPDX-License-Identifier: MIT */
#include "verify/verify.h"
#include "verify/verify_inside.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "base/least.h"
#include "base/mem.h"
#include "base/version.h"
#include "image/image_helper.h"
#include "render/border.h"
#include "render/canvas.h"
#include "render/notes.h"
#include "session/map.h"
#include "session/state.h"
#include "show/comparison_picture.h"
#include "show/decorating.h"
#include "show/draw.h"

/* ---- the picture of both journals ---- */

enum {
    SEAM = 2,   /* pixels between panes */
    BORDER = 4, /* pixels around words */
    ROWS = 3,   /* rows of words below the panes */
    NAME_MOST = 200,
};

/* Label of the right pane before the labels are replaced by kinds of difference. */
enum { SAME_OBJECT = AGREES };

static const uint8_t ghost_rgb[3] = {150, 150, 150};
static const uint8_t paper[3] = {24, 24, 24};

/* Picture in the making, with its layout. */
struct sheet {
    const struct difference_picture *of;
    struct session *session; /* session of A */
    bool visible[256];       /* labels that A's user sees */
    struct state state;      /* state of the session for the next rendition */
    uint8_t *label;          /* [grid.cells], labels for the next rendition */
    uint32_t width, height;  /* size of one pane */
    uint32_t tall;           /* height of letters */
    uint32_t top, bottom;    /* heights of the strips */
    struct canvas canvas;    /* pixels of the picture */
};

static uint32_t pane_left(const struct sheet *sheet, uint32_t pane)
{
    return pane * (sheet->width + SEAM);
}

static struct canvas pane_of(const struct sheet *sheet, uint32_t pane)
{
    return canvas_part(&sheet->canvas, pane_left(sheet, pane), sheet->top, sheet->width,
                       sheet->height);
}

/* ---- labels of B and differences ---- */

enum relabelled { AS_B, AS_OBJECT, AS_KIND };

static uint8_t new_label(const struct sheet *sheet, enum relabelled as, size_t voxel)
{
    const uint8_t whole_a = sheet->of->label[0][voxel], whole_b = sheet->of->label[1][voxel];
    const uint8_t a = sheet->visible[whole_a] ? whole_a : 0;
    const uint8_t b = sheet->visible[whole_b] ? whole_b : 0;
    if (as == AS_B)
        return whole_b;
    if (as == AS_OBJECT)
        return a || b ? SAME_OBJECT : 0;
    return a == b ? 0 : (uint8_t)difference_of(a, b);
}

/* Render these labels in the state of the sheet. */
static enum err render_as(const struct sheet *sheet, enum relabelled as, struct fault *fault)
{
    struct session *session = sheet->session;
    const struct grid *grid = &session->scene->grid;
    const struct labels labels = {session->scene, sheet->label};
    size_t voxel = 0;
    for (struct grid_walk w = grid_rows(grid, NULL, NULL); grid_walk_next(&w);)
        for (uint32_t c = w.row.first; c < w.row.end; c++)
            sheet->label[c] = new_label(sheet, as, voxel++);
    TRY(session_go(session, &sheet->state, NULL, 0, fault));
    return session_draw_labels(session, &labels, RENDER_BORDER, fault);
}

/* ---- panes ---- */

/* Copy the rendition, over its background, into a pane. */
static enum err put_frame(const struct sheet *sheet, uint32_t pane, struct fault *fault)
{
    OWNED(canvas_release) struct canvas frame = {0};
    const struct canvas canvas = pane_of(sheet, pane);
    TRY(session_show_frame(&frame, sheet->session, fault));
    for (size_t y = 0; y < frame.height; y++)
        memcpy(canvas_pixel(&canvas, 0, y), canvas_pixel(&frame, 0, y), (size_t)4 * frame.width);
    return OK;
}

/* Blend the differences over the grey shade of all objects, which the pane already shows with
 * these depths. */
static void put_kinds(const struct sheet *sheet, const int64_t *depth)
{
    const struct rendition *frame = session_frame(sheet->session);
    const struct canvas canvas = pane_of(sheet, 2);
    const size_t pixels = (size_t)frame->width * frame->height;
    for (size_t i = 0; i < pixels; i++) {
        const uint8_t *over = frame->rgba + 4 * i;
        uint8_t *to = canvas_pixel(&canvas, i % frame->width, i / frame->width);
        const bool is_seen = frame->depth[i] <= depth[i];
        const int weight = frame->cell[i] == CELL_NONE ? 0 : is_seen ? over[3] : over[3] * 5 / 8;
        for (int k = 0; k < 3; k++)
            to[k] = (uint8_t)((over[k] * weight + to[k] * 3 / 5 * (255 - weight) + 127) / 255);
    }
}

/* Show all labels: they are kinds of difference now, not those of the user. */
static enum err draw_difference(struct sheet *sheet, struct fault *fault)
{
    const size_t pixels = (size_t)sheet->width * sheet->height;
    OWNED(mem_release) int64_t *depth = mem_array(pixels, sizeof *depth);
    struct kept *kept = &sheet->state.kept;
    if (!depth)
        return fault_memory(fault, "a picture");
    memset(kept->visible + 1, true, 255 * sizeof *kept->visible);
    memset(kept->opacity + 1, BORDER_OPAQUE, 255);
    memcpy(kept->palette.rgb[SAME_OBJECT], ghost_rgb, 3);
    sheet->state.outlook.background = BACKGROUND_PLAIN; /* black, so that colours show
                                                           differences */
    TRY(render_as(sheet, AS_OBJECT, fault));
    memcpy(depth, session_frame(sheet->session)->depth, pixels * sizeof *depth);
    TRY(put_frame(sheet, 2, fault));
    for (int kind = A_ALONE; kind < DIFFERENCES; kind++)
        memcpy(kept->palette.rgb[kind], difference_rgb[kind], 3);
    TRY(render_as(sheet, AS_KIND, fault));
    put_kinds(sheet, depth);
    return OK;
}

/* ---- words ---- */

/* Distance from the top of a strip to its first capitals. */
static int64_t title_top(const struct sheet *sheet)
{
    return BORDER + (text_line(sheet->tall) - sheet->tall) / 2;
}

/* Draw as much of the title as fits. */
static void draw_title(const struct sheet *sheet, uint32_t pane, const char *letter,
                       const char *name)
{
    char words[NAME_MOST];
    const int64_t room = (int64_t)sheet->width - 2 * BORDER;
    snprintf(words, sizeof words, "%s%s%s", letter, *name ? "  " : "", name);
    text_cut(words, sizeof words, sheet->tall, room);
    text_draw(&sheet->canvas, (int64_t)pane_left(sheet, pane) + BORDER, title_top(sheet),
              sheet->tall, words, &notes_light);
}

/* Draw a row of the lower strip: a box of this colour, then words. Return where the words end.
 * */
static int64_t draw_entry(const struct sheet *sheet, int64_t left, uint32_t row,
                          const uint8_t rgb[3], const char *words)
{
    const int64_t tall = sheet->tall, indent = 3 * tall / 2;
    const int64_t top =
        sheet->top + sheet->height + title_top(sheet) + row * text_line(sheet->tall);
    canvas_box(&sheet->canvas, left, top, tall, tall, rgb);
    text_draw(&sheet->canvas, left + indent, top, sheet->tall, words, &notes_light);
    return left + indent + text_width(words, sheet->tall);
}

/* Draw the labels in columns, up to the width of the first two panes. */
static void draw_labels(const struct sheet *sheet)
{
    const struct kept *kept = &sheet->session->now.kept;
    const struct overlap *overlap = sheet->of->overlap;
    const int64_t end = (int64_t)pane_left(sheet, 2) - BORDER;
    int64_t left = BORDER, widest = 0;
    uint32_t row = 0;
    for (int label = 1; label < 256; label++) {
        char words[LABEL_NAME_BYTES + 32];
        const char *name = kept->label_name[label];
        const unsigned dice = overlap_dice(overlap, (uint8_t)label);
        if (!overlap->a[label] && !overlap->b[label])
            continue;
        snprintf(words, sizeof words, "%u%s%s  Dice %u.%04u", numbering_of(kept, (unsigned)label),
                 *name ? " " : "", name, dice / DICE_ONE, dice % DICE_ONE);
        if (left + 2 * (int64_t)sheet->tall + text_width(words, sheet->tall) > end)
            return;
        const int64_t right = draw_entry(sheet, left, row, kept->palette.rgb[label], words);
        widest = right > widest ? right : widest;
        if (++row == ROWS) {
            row = 0;
            left = widest + 2 * (int64_t)sheet->tall;
        }
    }
}

enum err difference_picture_draw(struct picture *picture, struct session *session,
                                 const struct difference_picture *of, struct fault *fault)
{
    const struct view *view = &session->now.outlook.view;
    const uint32_t tall = notes_tall(least(view->width, view->height));
    const uint32_t line = (uint32_t)text_line(tall);
    OWNED(mem_release) uint8_t *label = mem_new(session->scene->grid.cells);
    struct sheet sheet = {.of = of,
                          .session = session,
                          .state = session->now,
                          .label = label,
                          .width = view->width,
                          .height = view->height,
                          .tall = tall,
                          .top = line + 2 * BORDER,
                          .bottom = ROWS * line + 2 * BORDER};
    for (int l = 0; l < 256; l++)
        sheet.visible[l] = kept_shows(&sheet.state.kept, l);
    sheet.state.outlook.shows_finished = 0;
    const uint32_t width = pane_left(&sheet, 3) - SEAM;
    const uint32_t height = sheet.top + sheet.height + sheet.bottom;
    TRY(label ? picture_init(picture, width, height, 0, fault) : fault_memory(fault, "a picture"));
    sheet.canvas =
        (struct canvas){.width = width, .height = height, .stride = width, .rgba = picture->rgba};
    canvas_box(&sheet.canvas, 0, 0, width, height, paper);
    /* Draw the words first: the right pane replaces the colours of labels. */
    draw_title(&sheet, 0, "A", of->name[0]);
    draw_title(&sheet, 1, "B", of->name[1]);
    draw_title(&sheet, 2, "where they differ", "");
    draw_labels(&sheet);
    for (uint32_t kind = A_ALONE; kind < DIFFERENCES; kind++)
        draw_entry(&sheet, (int64_t)pane_left(&sheet, 2) + BORDER, kind - A_ALONE,
                   difference_rgb[kind], difference_words[kind]);
    TRY(session_draw(session, RENDER_AS_KEPT, fault));
    TRY(put_frame(&sheet, 0, fault));
    TRY(render_as(&sheet, AS_B, fault));
    TRY(put_frame(&sheet, 1, fault));
    return draw_difference(&sheet, fault);
}

/* ---- drawing in the process of A ---- */

/* Return the name of a journal for a picture: the last part of its path, "" if its scene is
 * private. */
static const char *shown_name(const struct side_facts *facts, const char *path)
{
    return facts->is_private ? "" : file_name(path);
}

struct journals {
    const struct diff_options *options;
    struct side side[2]; /* A, B */
    struct first_difference first_difference;
    struct overlap overlap;
};

/* Find the labels that some voxels have. */
static void find_used(bool used[256], const uint8_t *label, size_t voxels)
{
    memset(used, 0, 256 * sizeof *used);
    for (size_t i = 0; i < voxels; i++)
        used[label[i]] = true;
}

/* Unless both journals have the same numbers, give the labels of B the indices of the labels of A
 * with the same numbers, and free indices to others: in its voxels, names, colours and numbers.
 * ERR_LIMIT for more than 255 labels of both. */
static enum err align(struct side *side, const struct side_facts *a, const uint8_t *label_a,
                      struct fault *fault)
{
    struct side_facts *b = (struct side_facts *)(void *)side->bytes.data;
    OWNED(mem_release) struct side_facts *former = mem_new(sizeof *former);
    uint8_t *voxel = (uint8_t *)(b + 1), to[256] = {0};
    bool used[256], taken[256];
    if (memcmp(b->label_number, a->label_number, sizeof a->label_number) == 0)
        return OK;
    if (!former)
        return fault_memory(fault, "labels");
    *former = *b;
    find_used(used, voxel, b->voxels);
    find_used(taken, label_a, a->voxels);
    for (unsigned l = 1; l < 256; l++)
        for (unsigned i = 1; i < 256; i++)
            if (used[l] && former->label_number[l] &&
                a->label_number[i] == former->label_number[l]) {
                to[l] = (uint8_t)i;
                taken[i] = true;
            }
    memset(b->label_number, 0, sizeof b->label_number);
    memset(b->label_name[1], 0, 255 * sizeof b->label_name[1]);
    for (unsigned l = 1; l < 256; l++) {
        if (!used[l])
            continue;
        unsigned at = to[l] ? to[l] : l;
        if (!to[l] && taken[l])
            for (at = 1; at < 256 && taken[at];)
                at++;
        if (at == 256)
            return fault_set(fault, ERR_LIMIT, "the journals have more than 255 labels");
        to[l] = (uint8_t)at;
        taken[at] = true;
        b->label_number[at] = former->label_number[l];
        memcpy(b->palette.rgb[at], former->palette.rgb[l], 3);
        memcpy(b->label_name[at], former->label_name[l], LABEL_NAME_BYTES);
    }
    for (size_t i = 0; i < b->voxels; i++)
        voxel[i] = to[voxel[i]];
    return OK;
}

/* The number of a label of either journal, after align(). */
static uint32_t number_in(const struct journals *j, int label)
{
    return j->side[j->overlap.a[label] ? 0 : 1].facts->label_number[label];
}

/* Header before the pixels. */
struct drawn {
    uint32_t width, height;
};
enum { SIDE_MOST = 16384, /* limit of a picture side */ FRAME_MOST = 4 * SIDE_MOST * SIDE_MOST };

static enum err draw(struct picture *picture, struct session *session, const struct journals *j,
                     const struct side_facts *facts, const uint8_t *label, struct fault *fault)
{
    struct overlap overlap = {0};
    const uint8_t *label_b = j->side[1].labels;
    const struct side_facts *other = j->side[1].facts;
    const char *const *path = j->options->path;
    struct side b = j->side[1]; /* its bytes are those of this process */
    TRY(align(&b, facts, label, fault));
    overlap_add(&overlap, label, label_b, session->scene->grid.voxels);
    const struct difference_picture difference_picture = {
        .name = {shown_name(facts, path[0]), shown_name(other, path[1])},
        .label = {label, label_b},
        .overlap = &overlap};
    struct state next = session->now;
    memcpy(next.kept.label_number, facts->label_number, sizeof facts->label_number);
    for (int l = 1; l < 256; l++) { /* use the names and colours of B where A has no such label */
        if (overlap.a[l])
            continue;
        const bool is_other = overlap.b[l] && other->label_number[l] != facts->label_number[l];
        if (is_other)
            next.kept.label_number[l] = other->label_number[l];
        memcpy(next.kept.palette.rgb[l], other->palette.rgb[l], 3);
        if (is_other || !next.kept.label_name[l][0])
            memcpy(next.kept.label_name[l], other->label_name[l], LABEL_NAME_BYTES);
    }
    TRY(session_go(session, &next, NULL, 0, fault));
    return difference_picture_draw(picture, session, &difference_picture, fault);
}

/* Two scenes of different sizes have no picture. */
static enum err add_picture(void *context, const struct interpreter *interp,
                            const struct side_facts *facts, const uint8_t *label, struct buf *out,
                            struct fault *fault)
{
    const struct journals *j = context;
    OWNED(picture_release) struct picture picture = {0};
    if (!same_size(j->side[1].facts->size, facts->size))
        return OK;
    TRY(draw(&picture, interp->session, j, facts, label, fault));
    const struct drawn drawn = {picture.width, picture.height};
    buf_add(out, &drawn, sizeof drawn);
    buf_add(out, picture.rgba, (size_t)4 * picture.width * picture.height);
    return OK;
}

/* ---- the picture ---- */

static enum err write_picture(const struct journals *j, struct fault *fault)
{
    const struct drawn *drawn = j->side[0].more;
    const size_t bytes = j->side[0].facts->more;
    OWNED(picture_release) struct picture picture = {0};
    OWNED(buf_release) struct buf words = {0};
    if (!j->options->picture)
        return OK;
    /* A hostile journal may have made the bytes. */
    if (bytes < sizeof *drawn || drawn->width > SIDE_MOST || drawn->height > SIDE_MOST ||
        bytes - sizeof *drawn != (size_t)4 * drawn->width * drawn->height)
        return fault_set(fault, ERR_INPUT, "a process returned no picture");
    TRY(picture_init(&picture, drawn->width, drawn->height, 0, fault));
    memcpy(picture.rgba, drawn + 1, (size_t)4 * picture.width * picture.height);
    TRY(picture_note(&picture, "Software", "iftty " PROGRAM_VERSION, fault));
    buf_printf(&words, "%" PRIu64 " of %" PRIu64 " voxels", j->overlap.differing,
               j->overlap.voxels);
    TRY(picture_note(&picture, "iftty:differ", buf_text(&words), fault));
    return image_write_png(j->options->picture, &picture, fault);
}

/* ---- the report ---- */

static const char *name_of(const struct journals *j, int label)
{
    const struct side_facts *a = j->side[0].facts, *b = j->side[1].facts;
    const bool is_a = j->overlap.a[label] || a->label_number[label] == b->label_number[label];
    return is_a && *a->label_name[label] ? a->label_name[label] : b->label_name[label];
}

static void write_first_difference(struct buf *out, const struct journals *j)
{
    const struct first_difference *p = &j->first_difference;
    if (!p->is_there) {
        buf_printf(out, "commands  %zu, all equal\n", p->same);
        return;
    }
    buf_printf(out, "commands  %zu equal, then they differ\n", p->same);
    for (int i = 0; i < 2; i++) {
        buf_printf(out, "    %s  ", i ? "B" : "A");
        buf_add_safe_text(out, j->options->path[i]);
        if (p->side[i].has_command) {
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
        OWNED(buf_release) struct buf name = {0};
        const unsigned dice = overlap_dice(o, (uint8_t)label);
        if (!o->a[label] && !o->b[label])
            continue;
        buf_printf(&name, "%u ", number_in(j, label));
        buf_add_safe_text(&name, name_of(j, label));
        buf_printf(out, "%-22s %2u.%04u %12" PRIu64 " %12" PRIu64 " %12" PRIu64 "\n",
                   buf_text(&name), dice / DICE_ONE, dice % DICE_ONE, o->a[label], o->b[label],
                   o->both[label]);
    }
    buf_printf(out, "voxels    %" PRIu64 " of %" PRIu64 " differ\n", o->differing, o->voxels);
}

/* True if both have the identical scene. */
static bool scene_is_same(const struct side *a, const struct side *b)
{
    return strcmp(a->facts->proof, b->facts->proof) == 0 &&
           a->facts->scene_digest == b->facts->scene_digest;
}

/* Add a warning for each condition that a reader of the result should know. */
static void write_warnings(struct buf *out, const struct journals *j)
{
    static const char *const words[] = {"was edited by hand; it reproduces its recorded results",
                                        "ends with an unfinished record, which was ignored",
                                        "ends with pending edits, which are not compared"};
    for (int i = 0; i < 2; i++) {
        const struct side_facts *f = j->side[i].facts;
        const bool holds[] = {f->is_edited, f->is_torn, f->pending > 0};
        for (size_t k = 0; k < sizeof words / sizeof *words; k++)
            if (holds[k]) {
                buf_add_text(out, "# ");
                buf_add_safe_text(out, j->options->path[i]);
                buf_printf(out, " %s\n", words[k]);
            }
    }
    if (!scene_is_same(&j->side[0], &j->side[1]))
        buf_add_text(out, "# the scenes are not the same: voxels were compared place by place\n");
}

static void add_json_side(struct json *json, const struct journals *j, int which)
{
    const struct first_difference *p = &j->first_difference;
    json_object(json, which ? "b" : "a");
    json_text(json, "file", j->options->path[which]);
    if (p->side[which].has_command) {
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
    json_boolean(&json, "same_scene", scene_is_same(&j->side[0], &j->side[1]));
    json_counts(&json, "size", j->side[0].facts->size, 3);
    json_count(&json, "voxels", o->voxels);
    json_count(&json, "differing", o->differing);
    json_array(&json, "labels");
    for (int label = 1; label < 256; label++) {
        if (!o->a[label] && !o->b[label])
            continue;
        json_object(&json, NULL);
        json_count(&json, "label", number_in(j, label));
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

static enum err report(const struct journals *j, const struct printer *printer, struct fault *fault)
{
    struct buf text = {0}, warnings = {0};
    write_warnings(&warnings, j);
    enum err err = print_text(&warnings, printer->warn, printer, fault);
    if (j->options->json) {
        write_json(&text, j);
    } else {
        const struct side_facts *f = j->side[0].facts;
        if (scene_is_same(&j->side[0], &j->side[1]))
            buf_printf(&text, "scenes    the same: %ux%ux%u voxels, SHA-256 %s\n", f->size[0],
                       f->size[1], f->size[2], f->proof);
        else
            buf_printf(&text, "scenes    not the same; both have %ux%ux%u voxels\n", f->size[0],
                       f->size[1], f->size[2]);
        write_labels(&text, j);
    }
    const enum err said = print_text(&text, printer->print, printer, fault);
    return err ? err : said;
}

/* ---- the comparison ---- */

static enum err compare(struct journals *j, const struct printer *printer, struct fault *fault)
{
    const struct diff_options *o = j->options;
    const struct side_work to_draw = {.context = j, .add = add_picture, .most = FRAME_MOST};
    struct buf text = {0};
    TRY(fault_prefix(fault, image_check_png(o->picture, fault), "--picture"));
    TRY(first_difference_of_files(&j->first_difference, FIRST_COMMAND, o->path, o->path,
                                  o->side.last, fault));
    if (!o->json) {
        write_first_difference(&text, j);
        TRY(print_text(&text, printer->print, printer, fault));
    }
    TRY(side_carry_out(&j->side[1], o->path[1], &o->side, NULL, fault));
    TRY(side_carry_out(&j->side[0], o->path[0], &o->side, o->picture ? &to_draw : NULL, fault));
    const struct side_facts *a = j->side[0].facts, *b = j->side[1].facts;
    if (!same_size(a->size, b->size))
        return fault_set(fault, ERR_INPUT,
                         "scenes of %ux%ux%u and %ux%ux%u voxels: expected two of one size, whose "
                         "labels can be compared",
                         a->size[0], a->size[1], a->size[2], b->size[0], b->size[1], b->size[2]);
    TRY(align(&j->side[1], a, j->side[0].labels, fault));
    overlap_add(&j->overlap, j->side[0].labels, j->side[1].labels, a->voxels);
    TRY(report(j, printer, fault));
    TRY(write_picture(j, fault));
    if (j->overlap.differing)
        return fault_set(fault, ERR_CHECK, "%" PRIu64 " of %" PRIu64 " voxels %s another label",
                         j->overlap.differing, j->overlap.voxels,
                         j->overlap.differing == 1 ? "has" : "have");
    return OK;
}

enum err diff_journals(const struct diff_options *options, const struct printer *printer,
                       struct fault *fault)
{
    struct journals j = {.options = options};
    const enum err err = compare(&j, printer, fault);
    side_release(&j.side[0]);
    side_release(&j.side[1]);
    first_difference_release(&j.first_difference);
    return err;
}
