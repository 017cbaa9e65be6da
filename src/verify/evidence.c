/* SPDX-License-Identifier: MIT */
#include "verify/verify_inside.h"

#include <inttypes.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/safe.h"
#include "command/interpreter.h"
#include "image/image_helper.h"
#include "image/png.h"

void evidence_add(struct evidence *evidence, const char *caption, uint32_t width, uint32_t height,
                  const uint8_t *rgba)
{
    if (evidence->pictures == EVIDENCE_MOST)
        return;
    struct buf *words = &evidence->picture[evidence->pictures].caption,
               *png = &evidence->picture[evidence->pictures].png;
    buf_add_text(words, caption);
    evidence->pictures++;
    if (png_encode(png, width, height, rgba, NULL) || words->failed) {
        buf_release(words);
        buf_release(png);
        evidence->pictures--;
    }
}

void evidence_release(struct evidence *evidence)
{
    for (size_t i = 0; i < EVIDENCE_MOST; i++) {
        buf_release(&evidence->picture[i].caption);
        buf_release(&evidence->picture[i].png);
    }
    evidence->pictures = 0;
}

/* ---- a golden image that differs ---- */

/* FOLDER/JOURNAL.NAME.ENDING */
static void write_file(const struct evidence *evidence, struct interpreter *interp,
                       const char *name, const char *ending, const struct picture *picture)
{
    OWNED(buf_release) struct buf path = {0};
    buf_printf(&path, "%s/%s.%s.%s", evidence->folder, file_name(buf_text(&interp->home)), name,
               ending);
    if (!path.failed)
        image_write(interp->helper, buf_text(&path), FILE_REPLACE, picture, NULL);
}

static void add_pictures(struct evidence *evidence, const struct golden_finding *finding)
{
    const struct picture *actual = finding->actual, *expected = finding->expected;
    const struct golden_difference *difference = finding->difference;
    OWNED(buf_release) struct buf caption = {0};
    buf_printf(&caption, "expected: golden image %s", finding->name);
    if (expected)
        evidence_add(evidence, buf_text(&caption), expected->width, expected->height,
                     picture_colours(expected));
    evidence_add(evidence, expected ? "actual" : "actual; there is no golden image", actual->width,
                 actual->height, picture_colours(actual));
    if (expected && difference->image)
        evidence_add(evidence, "difference, in red", difference->width, difference->height,
                     difference->image);
}

static enum err collect(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault)
{
    struct evidence *evidence = context;
    const struct golden_difference *difference = finding->difference;
    (void)fault; /* says already what differs */
    if (evidence->folder && difference && !file_make_folder(evidence->folder, NULL)) {
        const struct picture image = {
            .width = difference->width, .height = difference->height, .rgba = difference->image};
        write_file(evidence, interp, finding->name, "actual.exr", finding->actual);
        if (difference->image)
            write_file(evidence, interp, finding->name, "difference.png", &image);
    }
    if (evidence->has_pictures)
        add_pictures(evidence, finding);
    return ERR_CHECK;
}

/* ---- a golden image that is the same: its PNG ---- */

/* True if the pixel of the file is that of the picture: blended over its background, or with its
 * alpha if the background is clear. */
static bool shows(const uint8_t *file, const uint8_t *rgba, bool is_clear)
{
    if (is_clear)
        return memcmp(file, rgba, 4) == 0;
    for (int c = 0; c < 3; c++)
        if (file[c] != (rgba[c] * rgba[3] + 127) / 255)
            return false;
    return file[3] == 255;
}

static enum err compare_pixels(const struct picture *file, const struct picture *picture,
                               struct fault *fault)
{
    uint64_t differ = 0;
    const size_t pixels = (size_t)picture->width * picture->height;
    for (size_t i = 0; i < pixels; i++)
        differ += !shows(file->rgba + 4 * i, picture_colours(picture) + 4 * i, picture->is_clear);
    return differ ? fault_set(fault, ERR_CHECK,
                              "it differs from its golden image in "
                              "%" PRIu64 " of %zu pixels",
                              differ, pixels)
                  : OK;
}

static enum err compare_texts(const struct picture *file, const struct picture *golden,
                              const struct interpreter *interp, struct fault *fault)
{
    OWNED(buf_release) struct buf journal = {0};
    golden_journal_name(&journal, buf_text(&interp->home));
    for (size_t i = 0; i < file->attributes; i++) {
        const struct attribute *text = &file->attribute[i];
        const char *note = picture_find(golden, text->name);
        /* A PNG that was drawn again has the present name of the journal. */
        if ((strcmp(text->name, "iftty:journal") == 0 ? strcmp(text->value, buf_text(&journal)) == 0
                                                      : golden_note_is_of_its_time(text)) ||
            (note && strcmp(note, text->value) == 0))
            continue;
        OWNED(buf_release) struct buf words = {0};
        buf_add_safe_text(&words, text->name);
        buf_add_text(&words, ": ");
        buf_add_safe(&words, text->value, strnlen(text->value, 200));
        return fault_set(fault, ERR_CHECK, "it has a text that its golden image lacks: %s",
                         buf_text(&words));
    }
    return OK;
}

/* Resolution in the unit of PNG: pixels per metre. */
static int64_t pixels_a_metre(const struct picture *picture)
{
    return picture->pixel_mm > 0 ? (int64_t)(1000 / picture->pixel_mm + 0.5) : 0;
}

static enum err check_png(struct interpreter *interp, const char *path,
                          const struct picture *golden, const struct picture *notes,
                          struct fault *fault)
{
    /* Reject a file with more bytes than pixels and notes can need. */
    const size_t most = (size_t)8 * golden->width * golden->height + (4 << 20);
    OWNED(buf_release) struct buf bytes = {0};
    OWNED(picture_release) struct picture file = {0};
    bool leads_out = false;
    enum err err = interpreter_may_read(interp, path, &leads_out, fault);
    if (!err)
        err = file_read(&bytes, path, most, fault);
    if (!err)
        err = png_read(&file, buf_text(&bytes), bytes.length, golden->width, golden->height, fault);
    if (!err)
        err = compare_pixels(&file, golden, fault);
    if (!err)
        err = compare_texts(&file, notes, interp, fault);
    if (!err && file.pixel_mm > 0 && pixels_a_metre(&file) != pixels_a_metre(golden))
        err = fault_set(fault, ERR_CHECK, "its pixel size differs from that of its golden image");
    return err && err != ERR_MEMORY && leads_out ? golden_refuse_link(path, fault) : err;
}

/* Count the golden image and compare its PNG, if that exists: its pixels with those of the drawn
 * picture over its background, its texts with the notes of the golden image. */
static enum err judge_same(void *context, struct interpreter *interp,
                           const struct golden_finding *finding, struct fault *fault)
{
    struct evidence *evidence = context;
    const struct picture *actual = finding->actual;
    OWNED(buf_release) struct buf path = {0};
    evidence->goldens++;
    evidence->pixels += (uint64_t)actual->width * actual->height;
    buf_add(&path, finding->path, strlen(finding->path) - strlen("exr"));
    buf_add_text(&path, "png");
    enum err err = path.failed ? fault_memory(fault, "a path") : OK;
    if (!err && file_exists(buf_text(&path)))
        err = check_png(interp, buf_text(&path), actual, finding->expected, fault);
    if (err && err != ERR_MEMORY) {
        fault_prefix(fault, err, "%s", buf_text(&path));
        err =
            fault_set(fault, ERR_CHECK, "%s; delete it, and `golden` draws it again", fault->text);
    }
    return err;
}

struct golden_judge evidence_judge(struct evidence *evidence)
{
    return (struct golden_judge){.context = evidence, .is_same = judge_same, .differs = collect};
}
