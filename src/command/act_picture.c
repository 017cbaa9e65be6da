/* Commands that bring pictures, golden images and maps out. */
#include "command/act.h"

#include <string.h>

#include "base/file.h"
#include "command/accepting.h"
#include "command/verdict.h"
#include "image/exr.h"
#include "journal/golden.h"
#include "session/export.h"

/* ---- pictures ---- */

enum err act_note_picture(struct desk *desk, struct picture *picture, struct fault *fault)
{
    if (!desk->journal)
        return OK;
    const char *name = file_name(journal_path(desk->journal));
    enum err err = picture_note(picture, "iftty:journal", name, fault);
    return err ? err : picture_note(picture, "iftty:chain", journal_chain(desk->journal), fault);
}

enum err act_take_picture(struct desk *desk, const char *name, struct picture *picture,
                          struct fault *fault)
{
    enum err err = export_picture(picture, &desk->session, fault);
    if (!err && name && exr_is_named(name))
        err = export_normals(picture, &desk->session, fault);
    if (!err)
        err = act_note_picture(desk, picture, fault);
    if (err)
        picture_release(picture);
    return err;
}

static void add_picture_digest(struct desk *desk, struct reply *reply)
{
    buf_printf(&reply->words, "picture=%016llx",
               (unsigned long long)rendition_digest(session_frame(&desk->session)));
}

enum file_mode act_file_mode(const struct value *replace)
{
    return replace->given && replace->number == 0 ? FILE_REPLACE : FILE_KEEP;
}

static void tell_file(const char *doing, const char *path, struct reply *reply)
{
    buf_add_text(&reply->text, doing);
    buf_add_safe(&reply->text, path, strlen(path));
    buf_add_char(&reply->text, '\n');
}

static void tell_seen(const struct rendition *r, struct reply *reply)
{
    size_t seen = 0, pixels = (size_t)r->width * r->height;
    for (size_t i = 0; i < pixels; i++)
        seen += r->cell[i] != CELL_NONE;
    buf_printf(&reply->text, "%ux%u pixels, of which %zu show an object\n", r->width, r->height,
               seen);
}

/* An order for the press, which gets it once the command is recorded. */
static enum err order_picture(struct desk *desk, const char *path, enum file_mode mode,
                              struct picture *picture, struct reply *reply, struct fault *fault)
{
    if (press_holds(desk->press, path))
        press_wait(desk->press, NULL, NULL); /* for what it finds there */
    enum err err = press_order(&desk->order, path, mode, picture, fault);
    if (!err)
        tell_file("writing ", path, reply);
    return err;
}

enum err act_write_picture(struct desk *desk, const char *path, enum file_mode mode,
                           struct picture *picture, struct reply *reply, struct fault *fault)
{
    enum err err;
    if (desk->press && !desk->replays && press_takes(path)) {
        err = order_picture(desk, path, mode, picture, reply, fault);
    } else {
        err = desk_will_write(desk, path, mode, fault);
        if (!err)
            err = image_write(desk->helper, path, mode, picture, fault);
        if (!err)
            tell_file("wrote ", path, reply);
    }
    picture_release(picture);
    return err;
}

static enum err render_file(struct desk *desk, const struct value *value, struct reply *reply,
                            struct fault *fault)
{
    struct picture picture;
    struct buf path = {0};
    enum err err = desk_output_path(desk, value[0].text, &path, fault);
    if (!err && path.length) {
        err = act_take_picture(desk, value[0].text, &picture, fault);
        if (!err) {
            picture.tiled = value[3].given && value[3].number == 1;
            err = act_write_picture(desk, buf_text(&path), act_file_mode(&value[2]), &picture,
                                    reply, fault);
        }
    }
    buf_release(&path);
    return err;
}

ACT(render)
{
    static const enum render_mode mode[] = {RENDER_SCENE, RENDER_BORDER, RENDER_INCREMENTAL,
                                            RENDER_RAY};
    if (value[3].given && !(value[0].given && exr_is_named(value[0].text)))
        return fault_set(fault, ERR_USAGE, "layout: only an .exr has lines or tiles");
    enum err err = session_render(&desk->session,
                                  value[1].given ? mode[value[1].number] : RENDER_AS_KEPT, fault);
    if (err || desk->skims)
        return err;
    add_picture_digest(desk, reply);
    if (value[0].given)
        return render_file(desk, value, reply, fault);
    desk->shows_picture = true;
    tell_seen(session_frame(&desk->session), reply);
    return OK;
}

/* ---- golden images ---- */

static struct golden_planes planes_of(const struct picture *p)
{
    return (struct golden_planes){p->width, p->height, p->rgba, p->depth_mm, p->label, p->voxel};
}

/* Expected, actual and difference beside each other, for whoever looks into a failure. */
static void leave_evidence(struct desk *desk, const char *name, const struct picture *actual,
                           const struct golden_difference *difference)
{
    struct buf path = {0};
    struct picture image = {
        .width = difference->width, .height = difference->height, .rgba = difference->image};
    if (!desk->evidence_folder || file_make_folder(desk->evidence_folder, NULL))
        return;
    const char *journal = file_name(buf_text(&desk->home));
    buf_printf(&path, "%s/%s.%s.actual.exr", desk->evidence_folder, journal, name);
    image_write(desk->helper, buf_text(&path), FILE_REPLACE, actual, NULL);
    if (difference->image) {
        buf_clear(&path);
        buf_printf(&path, "%s/%s.%s.difference.png", desk->evidence_folder, journal, name);
        image_write(desk->helper, buf_text(&path), FILE_REPLACE, &image, NULL);
    }
    buf_release(&path);
}

/* The same for a report; colours lie over black, as they are seen. */
static void keep_for_report(struct desk *desk, const char *name, const struct picture *expected,
                            const struct picture *actual,
                            const struct golden_difference *difference)
{
    struct gallery *gallery = desk->gallery;
    struct buf words = {0};
    if (!gallery)
        return;
    buf_printf(&words, "expected: golden image %s", name);
    gallery_add(gallery, buf_text(&words), expected->width, expected->height, expected->rgba);
    gallery_add(gallery, "actual", actual->width, actual->height, actual->rgba);
    if (difference->image)
        gallery_add(gallery, "difference, in red", difference->width, difference->height,
                    difference->image);
    buf_release(&words);
}

static enum err compare_golden(struct desk *desk, const char *name, const char *path,
                               const struct picture *actual, struct fault *fault)
{
    struct picture expected = {0};
    struct golden_difference difference = {0};
    struct buf words = {0};
    if (!file_exists(path)) {
        if (desk->gallery)
            gallery_add(desk->gallery, "actual; there is no golden image", actual->width,
                        actual->height, actual->rgba);
        return fault_set(fault, ERR_CHECK, "golden image %s is missing: there is no %s", name,
                         path);
    }
    enum err err = desk_may_read(desk, path, fault);
    if (!err)
        err = exr_read(&expected, path, fault);
    if (err) {
        fault_prefix(fault, err, "golden image %s", name);
        return fault ? fault_set(fault, ERR_CHECK, "%s", fault->text) : ERR_CHECK;
    }
    struct golden_planes e = planes_of(&expected), a = planes_of(actual);
    err = golden_compare(&e, &a, &difference, fault);
    if (!err && !difference.is_same) {
        golden_tell(&words, &difference);
        err = fault_set(fault, ERR_CHECK, "golden image %s: %s", name, buf_text(&words));
        leave_evidence(desk, name, actual, &difference);
        keep_for_report(desk, name, &expected, actual, &difference);
    }
    golden_difference_release(&difference);
    picture_release(&expected);
    buf_release(&words);
    return err;
}

/* The same for one that is drawn up anew where it differs. */
static enum err accept_golden(struct desk *desk, const char *name, const char *path,
                              struct picture *picture, struct fault *fault)
{
    const enum err err =
        compare_golden(desk, name, accepting_source(desk->accepting, path), picture, fault);
    if (err != ERR_CHECK)
        return err;
    return accepting_take(desk->accepting, desk, name, path, picture, fault);
}

/* Writes one file of a golden image, which must not be there. */
static enum err write_new(struct desk *desk, const char *path, const struct picture *picture,
                          struct fault *fault)
{
    enum err err = desk_will_write(desk, path, FILE_KEEP, fault);
    return err ? err : image_write(desk->helper, path, FILE_KEEP, picture, fault);
}

/* The EXR is the golden image; the PNG beside it is for people. */
static enum err write_golden(struct desk *desk, const char *name, const char *path,
                             const struct picture *picture, struct fault *fault)
{
    struct buf other = {0};
    enum err err = golden_folder(&other, buf_text(&desk->home), fault);
    if (!err)
        err = file_make_folder(buf_text(&other), fault);
    if (!err && file_exists(path)) {
        err = compare_golden(desk, name, path, picture, fault);
        if (err)
            fault_prefix(fault, err, "it exists already and was left alone");
    } else if (!err) {
        buf_printf(&other, "/%s.png", name);
        err = write_new(desk, path, picture, fault);
        if (!err)
            err = write_new(desk, buf_text(&other), picture, fault);
    }
    buf_release(&other);
    return err;
}

/* The rendition, which takes in the edits that wait, or a slice or mosaic; and its digest. */
static enum err take_golden(struct desk *desk, const struct value *of, struct picture *picture,
                            struct reply *reply, struct fault *fault)
{
    const bool is_sight = of->given && of->number > 0;
    if (desk->skims)
        return is_sight ? OK : session_run(&desk->session, fault);
    if (is_sight)
        return act_take_sight(desk, (enum sight)(of->number - 1), picture, reply, fault);
    enum err err = session_render(&desk->session, RENDER_AS_KEPT, fault);
    if (err)
        return err;
    add_picture_digest(desk, reply);
    return act_take_picture(desk, NULL, picture, fault);
}

/* For orphan_check. A name that there was no memory for leaves room for the next. */
static enum err note_name(struct desk *desk, const char *name, struct fault *fault)
{
    buf_add(&desk->goldens, name, strlen(name) + 1);
    if (!desk->goldens.failed)
        return OK;
    desk->goldens.failed = false;
    return fault_memory(fault, "a name");
}

ACT(golden)
{
    struct picture picture = {0};
    struct buf path = {0};
    const char *name = value[0].text;
    if (!golden_name_is_valid(name))
        return fault_set(fault, ERR_USAGE,
                         "NAME: expected small letters, digits, - and _ (at most 64), not %s",
                         name);
    if (desk->looks && desk->journal && journal_only_looks(desk->journal))
        return fault_set(fault, ERR_USAGE,
                         "the journal is only looked at, and its golden images with it; `journal "
                         "FILE` goes on in a file of your own");
    enum err err = note_name(desk, name, fault);
    if (!err)
        err = take_golden(desk, &value[1], &picture, reply, fault);
    if (err)
        return err;
    if (!desk->home.length && !desk->replays)
        buf_add_text(&reply->text, "not kept: there is no journal that it could belong to\n");
    else if (!desk->replays || desk->compares_goldens)
        err = golden_path(&path, buf_text(&desk->home), name, fault);
    if (!err && path.length && desk->accepting)
        err = accept_golden(desk, name, buf_text(&path), &picture, fault);
    else if (!err && path.length && desk->replays)
        err = compare_golden(desk, name, buf_text(&path), &picture, fault);
    else if (!err && path.length)
        err = write_golden(desk, name, buf_text(&path), &picture, fault);
    if (!err && path.length && !desk->replays)
        tell_file("kept as ", buf_text(&path), reply);
    picture_release(&picture);
    buf_release(&path);
    return err;
}

/* ---- maps ---- */

ACT(save)
{
    static const enum map map[] = {MAP_LABELS, MAP_COST, MAP_ROOT, MAP_BORDER};
    struct buf path = {0};
    enum err err = session_run(&desk->session, fault);
    if (!err)
        err = desk_output_path(desk, value[1].text, &path, fault);
    if (!err && path.length) {
        const enum file_mode how = act_file_mode(&value[2]);
        err = desk_will_write(desk, buf_text(&path), how, fault);
        if (!err)
            err = export_map(&desk->session, map[value[0].number], buf_text(&path), how, fault);
        if (!err)
            tell_file("wrote ", buf_text(&path), reply);
    }
    buf_release(&path);
    return err;
}
