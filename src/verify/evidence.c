#include "verify/evidence.h"

#include "base/file.h"
#include "command/interpreter.h"
#include "image/helper.h"
#include "image/png.h"
#include "verify/golden_png.h"

void evidence_add(struct evidence *evidence, const char *caption, uint32_t width, uint32_t height,
                  const uint8_t *rgba)
{
    if (evidence->pictures == EVIDENCE_MOST)
        return;
    struct buf png = {0}, words = {0};
    buf_add_text(&words, caption);
    if (png_encode(&png, width, height, rgba, NULL) || words.failed) {
        buf_release(&png);
        buf_release(&words);
        return;
    }
    evidence->picture[evidence->pictures].caption = words;
    evidence->picture[evidence->pictures++].png = png;
}

void evidence_release(struct evidence *evidence)
{
    for (size_t i = 0; i < EVIDENCE_MOST; i++) {
        buf_release(&evidence->picture[i].caption);
        buf_release(&evidence->picture[i].png);
    }
    evidence->pictures = 0;
}

/* ---- of a golden image ---- */

/* FOLDER/JOURNAL.NAME.ENDING */
static void write_file(const struct evidence_collector *collector, struct interpreter *interp,
                       const char *name, const char *ending, const struct picture *picture)
{
    struct buf path = {0};
    buf_printf(&path, "%s/%s.%s.%s", collector->folder, file_name(buf_text(&interp->home)), name,
               ending);
    if (!path.failed)
        image_write(interp->helper, buf_text(&path), FILE_REPLACE, picture, NULL);
    buf_release(&path);
}

static void write_files(const struct evidence_collector *collector, struct interpreter *interp,
                        const struct golden_finding *finding)
{
    const struct golden_difference *difference = finding->difference;
    const struct picture image = {
        .width = difference->width, .height = difference->height, .rgba = difference->image};
    if (file_make_folder(collector->folder, NULL))
        return;
    write_file(collector, interp, finding->name, "actual.exr", finding->actual);
    if (difference->image)
        write_file(collector, interp, finding->name, "difference.png", &image);
}

static void add_pictures(struct evidence *evidence, const struct golden_finding *finding)
{
    const struct picture *actual = finding->actual, *expected = finding->expected;
    const struct golden_difference *difference = finding->difference;
    struct buf caption = {0};
    buf_printf(&caption, "expected: golden image %s", finding->name);
    if (expected)
        evidence_add(evidence, buf_text(&caption), expected->width, expected->height,
                     picture_colours(expected));
    evidence_add(evidence, expected ? "actual" : "actual; there is no golden image", actual->width,
                 actual->height, picture_colours(actual));
    if (expected && difference->image)
        evidence_add(evidence, "difference, in red", difference->width, difference->height,
                     difference->image);
    buf_release(&caption);
}

static enum err collect(void *context, struct interpreter *interp,
                        const struct golden_finding *finding, struct fault *fault)
{
    const struct evidence_collector *collector = context;
    (void)fault; /* says what is wrong already */
    if (collector->folder && finding->difference)
        write_files(collector, interp, finding);
    if (collector->evidence)
        add_pictures(collector->evidence, finding);
    return ERR_CHECK;
}

static enum err count(void *context, struct interpreter *interp,
                      const struct golden_finding *finding, struct fault *fault)
{
    struct evidence_collector *collector = context;
    const struct picture *actual = finding->actual;
    collector->goldens++;
    collector->pixels += (uint64_t)actual->width * actual->height;
    return golden_png_check(interp, finding, fault);
}

struct golden_judge evidence_judge(struct evidence_collector *collector)
{
    return (struct golden_judge){.context = collector, .is_same = count, .differs = collect};
}
