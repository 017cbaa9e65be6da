/* SPDX-License-Identifier: MIT */
/*
 * `iftty agree`: the label maps of several raters, their consensus, and how far each is from it.
 *
 * All lie on one grid, that of the first, or are resampled to it. A rater may be a journal or a
 * script, which is carried out by the rules for those of others, for the labels that it ends with.
 */
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"
#include "command/interpreter.h"
#include "image/regrid.h"
#include "program/begin.h"
#include "program/console.h"
#include "program/programs.h"
#include "register/staple.h"
#include "render/look.h"
#include "render/palette.h"
#include "report/agreement.h"
#include "session/map.h"
#include "session/state.h"
#include "verify/side.h"

struct raters {
    const struct options *options;
    uint16_t *as; /* the labels that the values of all become (session/map.h) */
    struct grid grid;
    struct geometry geometry;
    unsigned count;
    uint8_t *label[RATERS_MOST], *consensus;
    char name_room[256][LABEL_NAME_BYTES];
    const char *label_name[256];
    struct staple_rater *staple; /* [count] */
    struct agreement agreement;
};

/* ---- reading ---- */

static bool is_journal(const char *path)
{
    const char *ending = strrchr(path, '.');
    return interpreter_is_journal(path) || (ending && strcmp(ending, ".iftty") == 0);
}

/* What was done to bring a map to the grid of the first. */
static void warn(const char *path, const char *notes)
{
    struct buf text = {0};
    for (const char *end; *notes; notes = end) {
        end = notes + strcspn(notes, "\n");
        end += *end == '\n';
        buf_add_safe_text(&text, path);
        buf_add_text(&text, ": ");
        buf_add(&text, notes, (size_t)(end - notes));
    }
    console_warn(NULL, buf_text(&text));
    buf_release(&text);
}

/* Names of labels: the first journal that names one decides. */
static void take_names(struct raters *raters, const struct side *side)
{
    for (unsigned l = 1; l < 256; l++) {
        const uint16_t as = raters->as[l];
        const char *name = side->facts->label_name[l];
        if (as <= UINT8_MAX && !*raters->name_room[as] && *safe_end(name) == '\0')
            memcpy(raters->name_room[as], name, LABEL_NAME_BYTES);
    }
}

/* The grid is that of the first; the labels of others are brought to it, as a map is. */
static enum err take_labels(struct raters *raters, unsigned which, struct volume *map,
                            struct fault *fault)
{
    const struct map_labels choice = {raters->as, LABEL_OWN};
    enum err err = OK;
    if (which == 0) {
        raters->geometry = map->geometry;
        err = grid_init(&raters->grid, map->size, fault);
    }
    if (!err)
        err = map_to_labels(&raters->label[which], map, &choice, console_watch(), fault);
    return err ? fault_prefix(fault, err, "%s", raters->options->word[which]) : OK;
}

/* The labels that a journal ends with, as a map on its scene's grid. */
static enum err make_map(struct volume *map, const struct side *side, struct fault *fault)
{
    memcpy(map->size, side->facts->size, sizeof map->size);
    const enum err err = side_geometry(&map->geometry, side, fault);
    map->geometry.slope = 1;
    map->geometry.intercept = 0;
    map->intensity = err ? NULL : mem_array(side->facts->voxels, sizeof *map->intensity);
    for (size_t i = 0; map->intensity && i < side->facts->voxels; i++)
        map->intensity[i] = side->labels[i];
    return err || map->intensity ? err : fault_memory(fault, "labels");
}

static enum regrid_how how_of(const struct options *o)
{
    return o->resample ? REGRID_RESAMPLE : REGRID_AS_IT_IS_FOR_PROGRAM;
}

/* `label`'s room is the caller's to free, as below. */
static enum err read_journal(struct raters *raters, unsigned which, struct fault *fault)
{
    const struct options *o = raters->options;
    const struct side_options how = {
        .begin = begin_one, .context = (void *)(uintptr_t)o, .watch = console_watch()};
    const char *path = o->word[which];
    struct side side = {.facts = NULL};
    struct volume map = {0};
    struct buf warnings = {0};
    enum err err = side_carry_out(&side, path, &how, NULL, fault);
    if (err)
        goto end;
    side_write_warnings(&warnings, &side, path);
    console_warn(NULL, buf_text(&warnings));
    err = make_map(&map, &side, fault);
    if (!err && which)
        err = regrid(&map, raters->grid.size, &raters->geometry, how_of(o), console_watch(), fault);
    if (err)
        fault_prefix(fault, err, "%s", path);
    else
        warn(path, map.notes);
    if (!err)
        err = take_labels(raters, which, &map, fault);
    if (!err)
        take_names(raters, &side);
end:
    buf_release(&warnings);
    volume_release(&map);
    side_release(&side);
    return err;
}

static enum err read_map(struct raters *raters, unsigned which, struct fault *fault)
{
    const char *path = raters->options->word[which];
    const struct map_place place = {.grid = &raters->grid,
                                    .geometry = &raters->geometry,
                                    .choice = begin_volume(raters->options, which),
                                    .resample = how_of(raters->options)};
    struct volume map = {0};
    enum err err = which ? map_read(&map, path, &place, console_watch(), fault)
                         : volume_read(&map, path, &place.choice, console_watch(), fault);
    if (err)
        fault_prefix(fault, err, "%s", path);
    else if (which)
        warn(path, map.notes);
    if (!err)
        err = take_labels(raters, which, &map, fault);
    volume_release(&map);
    return err;
}

/* ---- the consensus ---- */

static enum err find_consensus(struct raters *raters, struct fault *fault)
{
    struct agreement *g = &raters->agreement;
    const char *by = raters->options->by ? raters->options->by : "majority";
    g->raters = raters->count;
    g->voxels = raters->grid.voxels;
    g->by = by;
    g->label_name = raters->label_name;
    g->geometry = &raters->geometry;
    for (unsigned r = 0; r < raters->count; r++) {
        g->name[r] = raters->options->word[r];
        g->label[r] = raters->label[r];
    }
    for (unsigned l = 0; l < 256; l++)
        raters->label_name[l] = raters->name_room[l];
    g->consensus = raters->consensus = mem_new(g->voxels);
    if (!raters->consensus)
        return fault_memory(fault, "a consensus");
    g->has_ties = strcmp(by, "majority") == 0;
    if (g->has_ties)
        return agreement_majority(raters->consensus, &g->ties, g->label, g->raters, g->voxels,
                                  console_watch(), fault);
    raters->staple = mem_array(raters->count, sizeof *raters->staple);
    if (!raters->staple)
        return fault_memory(fault, "a consensus");
    for (unsigned r = 0; r < raters->count; r++)
        g->estimate[r] =
            (struct rater_estimate){raters->staple[r].sensitivity, raters->staple[r].specificity};
    return staple_find(raters->consensus, raters->staple, g->raters, g->label, raters->grid.size,
                       console_watch(), fault);
}

static void copy_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const struct raters *raters = context;
    const uint32_t *size = raters->grid.size;
    memcpy(values, raters->consensus + ((size_t)z * size[1] + y) * size[0], size[0]);
}

static enum err save(struct raters *raters, struct fault *fault)
{
    struct volume_label label[256];
    struct palette palette;
    struct buf description = {0};
    palette_default(&palette);
    for (unsigned l = 0; l < 256; l++) {
        label[l] = (struct volume_label){.name = raters->label_name[l], .number = (uint16_t)l};
        memcpy(label[l].rgb, palette.rgb[l], sizeof label[l].rgb);
    }
    buf_printf(&description, "iftty consensus by %s of %u raters", raters->agreement.by,
               raters->count);
    const struct volume_map map = {.size = raters->grid.size,
                                   .geometry = &raters->geometry,
                                   .type = VOXEL_UINT8,
                                   .description = buf_text(&description),
                                   .row = copy_row,
                                   .context = raters,
                                   .label = label};
    const enum err err =
        volume_write(raters->options->save, FILE_KEEP, &map, console_watch(), fault);
    buf_release(&description);
    return err;
}

/* ---- all of it ---- */

static enum err print(const struct raters *raters, struct fault *fault)
{
    const struct options *o = raters->options;
    struct buf text = {0};
    (o->json  ? agreement_write_json
     : o->csv ? agreement_write_csv
              : agreement_write_text)(&text, &raters->agreement);
    const enum err err = text.failed ? fault_memory(fault, "a report") : OK;
    if (!err)
        console_print(NULL, buf_text(&text));
    buf_release(&text);
    return err;
}

static enum err agree(struct raters *raters, struct fault *fault)
{
    const struct options *o = raters->options;
    if (o->save && !volume_ending(o->save))
        return fault_set(fault, ERR_USAGE,
                         "--save: expected the name of a volume, as consensus.nii.gz, not %s",
                         o->save);
    enum err err = o->save ? file_may_write(o->save, FILE_KEEP, fault) : OK;
    if (!err)
        err = regions_new(&raters->as, o->regions, o->as, fault);
    for (unsigned r = 0; r < raters->count && !err; r++)
        err = (is_journal(o->word[r]) ? read_journal : read_map)(raters, r, fault);
    if (!err)
        err = find_consensus(raters, fault);
    if (!err)
        err = agreement_count(&raters->agreement, console_watch(), fault);
    if (!err && o->save)
        err = save(raters, fault);
    return err ? err : print(raters, fault);
}

enum err run_agree(const struct options *o, struct fault *fault)
{
    struct raters *raters = mem_new(sizeof *raters);
    if (!raters)
        return fault_memory(fault, "how far raters agree");
    raters->options = o;
    raters->count = (unsigned)o->words;
    console_handle_interrupts();
    const enum err err = agree(raters, fault);
    agreement_release(&raters->agreement);
    for (unsigned r = 0; r < raters->count; r++)
        free(raters->label[r]);
    free(raters->consensus);
    free(raters->staple);
    free(raters->as);
    free(raters);
    return err;
}
