/* SPDX-License-Identifier: MIT */
/*
 * `iftty compare`: compare two label maps without a session.
 *
 * Both are on one grid, that of A. A scene is opened only for a picture of slices: the named one,
 * or A itself.
 */
#include <stdlib.h>

#include "base/mem.h"
#include "image/image_helper.h"
#include "program/programs.h"
#include "render/decoration.h"
#include "show/comparison_picture.h"
#include "session/map.h"
#include "session/session.h"
#include "session/state.h"

enum { PICTURE_SIDE = 1024 };

/* Both maps, and their grid. */
struct pair {
    const struct options *options;
    struct regions regions;  /* regions of both maps (session/map.h) */
    struct kept kept;        /* the numbers of their labels */
    struct session *session; /* for pictures */
    struct grid grid;
    struct geometry geometry;
    struct compared compared;
    struct comparison comparison;
};

/* ---- maps ---- */

/* Convert a map; labels that no map before it has are made. */
static enum err take_labels(struct pair *pair, int side, struct volume *map, struct fault *fault)
{
    const struct options *o = pair->options;
    struct map_labels choice = {.label = o->binary ? 1 : LABEL_OWN};
    OWNED(mem_release) uint16_t *as = NULL;
    enum err err = map_to_regions(map, 0, UINT32_MAX, console_watch(), fault);
    if (!err && !o->binary)
        err = numbering_admit(&pair->kept, map, &pair->regions, NULL, fault);
    if (!err)
        err = regions_table(&as, &pair->regions, map, &pair->kept, fault);
    choice.as = as;
    if (!err)
        err = map_to_labels(&pair->compared.label[side], map, &choice, console_watch(), fault);
    return fault_prefix(fault, err, "%s", o->word[side]);
}

static enum err read_map(struct pair *pair, int side, struct fault *fault)
{
    const struct map_place place = {
        .grid = &pair->grid,
        .geometry = &pair->geometry,
        .choice = begin_volume(pair->options, (size_t)side),
        .resample = pair->options->resample ? REGRID_RESAMPLE : REGRID_AS_IT_IS_FOR_PROGRAM};
    OWNED(volume_release) struct volume map = {0};
    TRY(map_read(&map, pair->options->word[side], &place, console_watch(), fault));
    if (*map.notes)
        console_warn(NULL, map.notes);
    return take_labels(pair, side, &map, fault);
}

/* Read A, which defines the grid. */
static enum err read_first(struct pair *pair, struct fault *fault)
{
    struct volume_choice choice = begin_volume(pair->options, 0);
    OWNED(volume_release) struct volume map = {0};
    choice.by_extremes = true; /* as a map */
    TRY(volume_read(&map, pair->options->word[0], &choice, console_watch(), fault));
    TRY(grid_init(&pair->grid, map.size, fault));
    pair->geometry = map.geometry;
    return take_labels(pair, 0, &map, fault);
}

/* Open the scene of the picture, which defines the grid. */
static enum err open_scene(struct pair *pair, struct fault *fault)
{
    const struct options *o = pair->options;
    TRY(session_new(&pair->session, fault));
    session_set_watch(pair->session, console_watch());
    const struct volume_choice choice = begin_volume(o, o->scene ? 2 : 0);
    TRY(session_open(pair->session, o->scene ? o->scene : o->word[0], &choice, fault));
    struct state next = pair->session->now;
    next.outlook.view.width = next.outlook.view.height = PICTURE_SIDE;
    next.outlook.view.angle[0] = 30000; /* from the left, above and in front */
    next.outlook.view.angle[1] = 20000;
    next.outlook.decorations = DECORATE_LETTERS | DECORATE_SCALE; /* over the surface */
    TRY(session_go(pair->session, &next, NULL, 0, fault));
    pair->grid = pair->session->scene->grid;
    pair->geometry = pair->session->geometry;
    return read_map(pair, 0, fault);
}

/* ---- output ---- */

static enum err write_picture(struct pair *pair, const struct comparison_report *report,
                              bool of_surface, struct fault *fault)
{
    struct session *session = pair->session;
    OWNED(picture_release) struct picture picture = {0};
    const uint32_t *place =
        comparison_farthest(&pair->comparison, session->now.outlook.slices.cross);
    TRY(of_surface ? distance_picture_draw(&picture, session, report, true, fault)
                   : comparison_picture_draw(&picture, session, report, place, fault));
    return image_write_png(of_surface ? pair->options->surface : pair->options->picture, &picture,
                           fault);
}

static enum err compare_pair(struct pair *pair, struct team *team, struct fault *fault)
{
    const struct options *o = pair->options;
    OWNED(buf_release) struct buf text = {0};
    bool listed[256] = {false};
    const struct comparison_report report = {
        &pair->comparison, {o->word[0], o->word[1]}, &pair->kept, &pair->geometry, listed};
    TRY(o->picture || o->surface ? open_scene(pair, fault) : read_first(pair, fault));
    TRY(read_map(pair, 1, fault));
    if (o->regions && !o->binary) /* requested labels have a row */
        regions_list(listed, &pair->regions, &pair->kept);
    for (int a = 0; a < 3; a++) {
        pair->compared.size[a] = pair->grid.size[a];
        pair->compared.spacing_nm[a] = pair->geometry.spacing_nm[a];
    }
    TRY(comparison_make(&pair->comparison, &pair->compared, team, console_watch(), fault));
    if (o->picture)
        TRY(write_picture(pair, &report, false, fault));
    if (o->surface)
        TRY(write_picture(pair, &report, true, fault));
    (o->json  ? comparison_write_json
     : o->csv ? comparison_write_csv
              : comparison_write_text)(&text, &report);
    if (text.failed)
        return fault_memory(fault, "a report");
    console_print(NULL, buf_text(&text));
    return OK;
}

enum err run_compare(const struct options *o, struct fault *fault)
{
    struct team *team = NULL;
    if (o->scene && !o->picture)
        return fault_set(fault, ERR_USAGE,
                         "--scene: the slices of a picture come from it; expected --picture too");
    if (o->as && o->binary)
        return fault_set(fault, ERR_USAGE,
                         "--as and --binary are mutually exclusive; give one of them");
    TRY(fault_prefix(fault, image_check_png(o->picture, fault), "--picture"));
    TRY(fault_prefix(fault, image_check_png(o->surface, fault), "--surface"));
    OWNED(mem_release) struct pair *pair = mem_new(sizeof *pair);
    if (!pair)
        return fault_memory(fault, "a comparison");
    pair->options = o;
    console_handle_interrupts();
    enum err err = regions_read(&pair->regions, o->regions, o->as, fault);
    if (!err)
        err = team_new(&team, team_size_wanted(), fault);
    if (!err)
        err = compare_pair(pair, team, fault);
    session_free(pair->session);
    free(pair->compared.label[0]);
    free(pair->compared.label[1]);
    regions_release(&pair->regions);
    team_free(team);
    return err;
}
