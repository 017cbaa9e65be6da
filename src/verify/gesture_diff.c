#include "verify/gesture_diff.h"

#include <stdlib.h>

#include "image/image_helper.h"
#include "verify/gesture_picture.h"
#include "verify/gesture_report.h"

static enum err draw(const struct diff_options *options, const struct gesture_report *report,
                     struct fault *fault)
{
    struct picture picture = {0};
    enum err err = gesture_picture_draw(&picture, report, fault);
    if (!err)
        err = image_write_png(options->picture, &picture, fault);
    picture_release(&picture);
    return err;
}

static enum err print(const struct diff_options *options, const struct gesture_report *report,
                      const struct printer *printer, struct fault *fault)
{
    struct buf text = {0}, warnings = {0};
    for (int i = 0; i < 2; i++)
        side_write_warnings(&warnings, report->side[i], report->path[i]);
    if (!side_scene_is_same(report->side[0], report->side[1]))
        buf_add_text(&warnings,
                     "# the scenes are not the same: voxels were compared place by place\n");
    (options->json ? gesture_report_write_json : gesture_report_write_text)(&text, report);
    const enum err err = text.failed || warnings.failed ? fault_memory(fault, "a report") : OK;
    if (!err && warnings.length)
        printer->warn(printer->context, buf_text(&warnings));
    if (!err)
        printer->print(printer->context, buf_text(&text));
    buf_release(&text);
    buf_release(&warnings);
    return err;
}

enum err gesture_diff(const struct diff_options *options, const struct printer *printer,
                      struct fault *fault)
{
    const struct side_options *o = &options->side;
    struct side expert = {0}, side[2] = {{.facts = NULL}};
    struct gestures gestures[2] = {{0}};
    struct gesture_match match = {0};
    const struct gesture_report report = {.path = {options->path[0], options->path[1]},
                                          .side = {&side[0], &side[1]},
                                          .gestures = {&gestures[0], &gestures[1]},
                                          .match = &match};
    enum err err = image_check_png(options->picture, fault);
    if (err)
        return fault_prefix(fault, err, "--picture");
    err = side_carry_out(&expert, options->path[0], o, NULL, fault);
    for (int i = 0; i < 2 && !err; i++)
        err = gestures_carry_out(&gestures[i], &side[i], options->path[i], o, &expert, fault);
    if (!err)
        err = gesture_match_make(&match, &gestures[0], &gestures[1], expert.facts->size,
                                 expert.facts->spacing_nm, o->watch, fault);
    if (!err)
        err = print(options, &report, printer, fault);
    if (!err && options->picture)
        err = draw(options, &report, fault);
    side_release(&expert);
    side_release(&side[0]);
    side_release(&side[1]);
    free(match.pair);
    return err;
}
