#include "session/session_parts.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "session/roi_check.h"
#include "session/slicing.h"

void session_init(struct session *session)
{
    *session = (struct session){0};
    palette_default(&session->settings.palette);
    session->settings.look = look_default();
    for (int label = 1; label < 256; label++)
        session->settings.visible[label] = true;
    session->settings.cut = cut_none();
    session->settings.adjacency = 6;
    session->settings.weight = (struct weight_choice){.kind = WEIGHT_MORPH, .radius = 1};
    session->settings.slices.overlay = SLICE_CONTOUR;
    session->settings.slices.crosses = true;
    session->settings.slices.marks = true;
    session->settings.slices.words = true;
    session->roi = roi_none();
    session_mark(session);
}

void session_settle(struct session *session)
{
    struct former_scene *former = &session->former;
    if (former->scene) {
        border_release(&former->border);
        forest_free(former->forest);
        scene_free(former->scene);
    }
    if (session->mark_roi.mask != session->roi.mask)
        free(session->mark_roi.mask);
    free(session->former_weights);
    session_settle_lists(session);
    session->mark_roi = session->roi;
    session->mark_roi_tally = session->roi_tally;
    session->former_weights = NULL;
    *former = (struct former_scene){0};
}

static void release_rendition(struct session *session)
{
    rendition_release(&session->rendition);
    rendition_release(&session->reduced);
    session->has_rendition = session->rendered = false;
}

void session_close_scene(struct session *session)
{
    session_settle(session);
    release_rendition(session);
    shader_release(&session->shader);
    border_release(&session->border);
    forest_free(session->forest);
    scene_free(session->scene);
    weight_work_release(&session->weight_work);
    free(session->roi.mask);
    session->roi = session->mark_roi = roi_none();
    session->forest = NULL;
    session->scene = NULL;
    session->has_scene = session->knows_window = false;
}

void session_release(struct session *session)
{
    session_close_scene(session);
    team_free(session->team);
    free(session->pending);
    eliminators_release(&session->eliminators);
    *session = (struct session){0};
}

/* By the choice, the polarities and the adjacency of the settings. */
enum err session_weigh(struct session *session, struct fault *fault)
{
    struct arc_rule arcs = {.kind = weight_arcs(session->settings.weight.kind)};
    memcpy(arcs.polarity, session->settings.polarity, sizeof arcs.polarity);
    forest_set_arcs(session->forest, &arcs);
    session->weighs_later = session->skims;
    if (session->skims)
        return OK;
    weight_compute(session->scene, forest_adjacency(session->forest), &session->settings.weight,
                   &session->weight_work);
    session->weight_digest = weight_digest(session->scene, &arcs, session->team);
    return watch_fault(session->watch, fault);
}

size_t session_memory(const struct session *session)
{
    size_t bytes = sizeof *session + session->pending_capacity * sizeof *session->pending;
    bytes += session->eliminators.capacity * sizeof *session->eliminators.cell;
    if (!session->has_scene)
        return bytes;
    bytes += session->scene->grid.cells * sizeof(struct cell);
    bytes += forest_memory(session->forest) + session->weight_work.capacity;
    bytes += session->border.words * (2 * sizeof(uint64_t) + sizeof(uint32_t));
    bytes += session->roi.mask ? mask_bytes(&session->scene->grid) : 0;
    bytes += rendition_bytes(&session->rendition) + rendition_bytes(&session->reduced);
    return bytes + shader_bytes(&session->shader);
}

/* ---- edits ---- */

static enum err wait_for_run(struct session *session, uint32_t cell, int16_t label,
                             struct fault *fault)
{
    if (!mem_grow(&session->pending, &session->pending_capacity, session->pendings + 1,
                  sizeof *session->pending))
        return fault_memory(fault, "a seed");
    session->pending[session->pendings++] = (struct edit){cell, label};
    return OK;
}

enum err session_plant(struct session *session, uint32_t cell, uint8_t label, struct fault *fault)
{
    return wait_for_run(session, cell, label, fault);
}

static int compare_cells(const void *a, const void *b)
{
    const uint32_t *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

/* The cells where seeds wait to be planted, in order, so that a ball of eliminators among a ball of
 * seeds takes no time worth mentioning. NULL when out of memory. */
static uint32_t *waiting_seeds(const struct session *session, size_t *count)
{
    uint32_t *cell = mem_array(session->pendings, sizeof *cell);
    *count = 0;
    for (size_t i = 0; cell && i < session->pendings; i++)
        if (session->pending[i].label != EDIT_ERASE)
            cell[(*count)++] = session->pending[i].cell;
    if (cell)
        qsort(cell, *count, sizeof *cell, compare_cells);
    return cell;
}

enum err session_eliminate(struct session *session, const uint32_t *cell, size_t count,
                           struct fault *fault)
{
    const size_t before = session->pendings;
    size_t seeds;
    uint32_t *seed = waiting_seeds(session, &seeds);
    enum err err = seed ? OK : fault_memory(fault, "eliminators");
    for (size_t i = 0; !err && i < count; i++) {
        const struct cell *at = session->scene->cell + cell[i];
        if (bsearch(&cell[i], seed, seeds, sizeof *seed, compare_cells))
            err = wait_for_run(session, cell[i], EDIT_ERASE, fault);
        else if (cell_is_reached(at))
            err = wait_for_run(session, key_root(at->key), EDIT_ERASE, fault);
    }
    free(seed);
    if (!err && session->pendings == before)
        err = fault_set(fault, ERR_INPUT,
                        "no tree holds this voxel: no seed reaches it; nothing has changed");
    return err;
}

enum err session_eliminate_seeds(struct session *session, const uint32_t *seed, size_t count,
                                 struct fault *fault)
{
    size_t waits;
    uint32_t *waiting = waiting_seeds(session, &waits);
    enum err err = waiting ? OK : fault_memory(fault, "eliminators");
    for (size_t i = 0; !err && i < count; i++) {
        const bool is_planted = session->scene->cell[seed[i]].flags & CELL_SEED;
        if (is_planted || bsearch(&seed[i], waiting, waits, sizeof *seed, compare_cells))
            err = wait_for_run(session, seed[i], EDIT_ERASE, fault);
        else
            err = fault_set(fault, ERR_CHECK, "no seed is planted where one was taken away");
    }
    free(waiting);
    return err;
}

/* ---- the forest ---- */

/* How the forest's passes are watched. */
struct progress {
    struct watch *watch;
    uint64_t voxels; /* to be served; 0 where nobody knows */
};

static bool poll_forest(void *context, uint64_t served)
{
    const struct progress *progress = context;
    return watch_poll(progress->watch, "forest", served, progress->voxels);
}

/* Colours of what the maps of the rendition show, and the picture at the size of the view. */
static enum err colour(struct session *session, struct fault *fault)
{
    const struct settings *settings = &session->settings;
    if (!cut_is_none(&settings->cut))
        slicing_window(session->shader.window, session);
    enum err err = shade(&session->rendition, &session->camera, &session->border,
                         &settings->palette, &settings->look, &session->shader, fault);
    if (!err && settings->look.samples > 1)
        rendition_reduce(&session->reduced, &session->rendition, settings->look.samples);
    return err;
}

/* Border and rendition after a change of the forest (S2). What cannot be coloured is drawn when it
 * is asked for. */
static void follow_forest(struct session *session)
{
    if (forest_is_suspended(session->forest)) {
        session->tally.stale = true;
        return;
    }
    struct changes changes = forest_changes(session->forest);
    tally_follow(&session->tally, &changes);
    border_update(&session->border, &changes);
    if (session->rendered) {
        incremental_image(&session->rendition, &session->camera, &session->border, &changes,
                          shade_reach(&session->settings.look, &session->camera));
        session->rendered = colour(session, NULL) == OK;
    }
}

enum err session_edit(struct session *session, const struct edit *edit, size_t count,
                      struct fault *fault)
{
    const bool scratch = forest_seeds(session->forest) == 0;
    struct progress progress = {session->watch, scratch ? session->scene->grid.voxels : 0};
    const struct forest_watch watch = {poll_forest, &progress};
    enum err err = forest_edit(session->forest, edit, count, &watch, fault);
    if (err)
        return err;
    session->edited_forest = true;
    follow_forest(session);
    return OK;
}

enum err session_run(struct session *session, struct fault *fault)
{
    if (session->pendings == 0)
        return OK;
    enum err err = session_edit(session, session->pending, session->pendings, fault);
    if (err)
        return err;
    session->applied = session->pendings;
    session->pendings = 0; /* the edits stay in memory behind the end, for session_rollback */
    eliminators_apply(&session->eliminators);
    return watch_fault(session->watch, fault);
}

enum err session_rebuild(struct session *session, bool catches_up, struct fault *fault)
{
    struct progress progress = {session->watch, session->scene->grid.voxels};
    const struct forest_watch watch = {poll_forest, &progress};
    if (forest_seeds(session->forest) == 0 && !catches_up)
        return OK; /* no voxel is reached, whatever the weights */
    session->rebuilt_forest = true;
    enum err err = catches_up ? forest_catch_up(session->forest, &watch, fault)
                              : forest_rebuild(session->forest, &watch, fault);
    follow_forest(session);
    return err ? err : watch_fault(session->watch, fault);
}

/* Weights and forest under the adjacency and the choice of weights of the settings. */
static enum err compute_again(struct session *session, struct fault *fault)
{
    session->weighed_again = true;
    forest_set_adjacency(session->forest, session->settings.adjacency);
    enum err err = session_weigh(session, fault);
    return err ? err : session_rebuild(session, false, fault);
}

enum err session_set_adjacency(struct session *session, unsigned count, struct fault *fault)
{
    if (count == session->settings.adjacency)
        return OK;
    session->settings.adjacency = count;
    return compute_again(session, fault);
}

enum err session_keep_weights(struct session *session, struct fault *fault)
{
    if (session->settings.weight.kind != WEIGHT_FILE || session->former_weights)
        return OK;
    session->former_weights =
        mem_array(session->scene->grid.voxels, sizeof *session->former_weights);
    if (!session->former_weights)
        return fault_memory(fault, "the former weights");
    weight_copy(session->former_weights, session->scene);
    return OK;
}

enum err session_set_weight(struct session *session, const struct weight_choice *choice,
                            struct fault *fault)
{
    if (weight_choice_equals(choice, &session->settings.weight))
        return OK;
    enum err err = weight_work_reserve(&session->weight_work, &session->scene->grid, choice, fault);
    if (!err && weight_is_gradient(choice->kind))
        err = session_keep_weights(session, fault);
    if (err)
        return err;
    session->settings.weight = *choice;
    return compute_again(session, fault);
}

static void set_words(char words[FILE_WORDS_BYTES], const char *name)
{
    memset(words, 0, FILE_WORDS_BYTES);
    memcpy(words, name, strnlen(name, FILE_WORDS_BYTES - 1));
}

enum err session_set_weight_map(struct session *session, const char *name, const uint16_t *weight,
                                struct fault *fault)
{
    enum err err = session_keep_weights(session, fault);
    if (err)
        return err;
    session->settings.weight = (struct weight_choice){.kind = WEIGHT_FILE};
    set_words(session->settings.weight_file, name);
    session->read_weights = true;
    weight_fill(session->scene, weight);
    return compute_again(session, fault);
}

enum err session_set_polarity(struct session *session, uint8_t label, int8_t percent,
                              struct fault *fault)
{
    if (session->settings.polarity[label] == percent)
        return OK;
    session->settings.polarity[label] = percent;
    return session->settings.weight.kind == WEIGHT_POLARITY ? compute_again(session, fault) : OK;
}

/* ---- what labels have ---- */

enum err session_count_labels(struct session *session, struct fault *fault)
{
    if (!tally_refresh(&session->tally, session->scene, session->team))
        return watch_fault(session->scene->watch, fault);
    if (!session->edited_forest && !session->rebuilt_forest)
        session->mark_tally = session->tally;
    return OK;
}

uint64_t session_label_voxels(const struct session *session, uint8_t label)
{
    return session->tally.voxels[label];
}

uint64_t session_label_former_voxels(const struct session *session, uint8_t label)
{
    return session->mark_tally.voxels[label];
}

/* ---- the region of interest ---- */

/* Takes the region of interest, which was checked. */
static enum err put_up(struct session *session, const struct roi *roi,
                       const struct roi_tally *tally, struct fault *fault)
{
    session->roi = *roi;
    session->roi_tally = *tally;
    session->roi_changed = true;
    roi_apply(roi, session->scene);
    return session_rebuild(session, false, fault);
}

enum err session_set_mask(struct session *session, uint64_t *mask, const char *name,
                          const uint32_t regions[2], struct fault *fault)
{
    const struct roi roi = {mask, session->roi.low, session->roi.high};
    struct roi_tally tally;
    enum err err =
        roi_check(&roi, session->scene, session->pending, session->pendings, &tally, fault);
    if (err) {
        free(mask);
        return err;
    }
    set_words(session->settings.mask_file, mask ? name : "");
    for (int i = 0; i < 2; i++)
        session->settings.mask_regions[i] = mask ? regions[i] : 0;
    return put_up(session, &roi, &tally, fault);
}

enum err session_set_range(struct session *session, const int64_t thousandths[2],
                           struct fault *fault)
{
    struct roi roi = {session->roi.mask, 0, UINT16_MAX};
    struct roi_tally tally;
    if (thousandths)
        roi_range(&roi, &session->geometry, thousandths);
    enum err err =
        roi_check(&roi, session->scene, session->pending, session->pendings, &tally, fault);
    if (err)
        return err;
    session->settings.has_range = thousandths != NULL;
    for (int i = 0; i < 2; i++)
        session->settings.range_thousandths[i] = thousandths ? thousandths[i] : 0;
    return put_up(session, &roi, &tally, fault);
}

/* ---- what is seen ---- */

/* The view with `samples` pixels for each of its own, along both sides. */
static struct view sampled(const struct view *view, uint32_t samples)
{
    struct view fine = *view;
    fine.width *= samples;
    fine.height *= samples;
    fine.zoom *= samples;
    return fine;
}

static enum err look_from(struct session *session, const struct view *view, const struct look *look,
                          struct fault *fault)
{
    struct camera camera;
    const struct view fine = sampled(view, look->samples);
    if (fine.width > VIEW_SIDE_MOST || fine.height > VIEW_SIDE_MOST)
        return fault_set(fault, ERR_LIMIT,
                         "a picture of %ux%u pixels of %ux%u samples: at most %d samples a side; "
                         "nothing has changed",
                         view->width, view->height, look->samples, look->samples, VIEW_SIDE_MOST);
    enum err err = camera_init(&camera, session->scene, &fine, fault);
    if (err)
        return err;
    const struct rendition *frame = session_frame(session);
    if (fine.width != session->rendition.width || fine.height != session->rendition.height ||
        view->width != frame->width || view->height != frame->height)
        release_rendition(session);
    session->settings.view = *view;
    session->settings.look = *look;
    session->camera = camera;
    session->rendered = false;
    return OK;
}

enum err session_set_view(struct session *session, const struct view *view, struct fault *fault)
{
    const struct look look = session->settings.look;
    return look_from(session, view, &look, fault);
}

enum err session_set_look(struct session *session, const struct look *look, struct fault *fault)
{
    const struct view view = session->settings.view;
    if (session->has_scene)
        return look_from(session, &view, look, fault);
    session->settings.look = *look;
    return OK;
}

void session_set_window(struct session *session, const int64_t thousandths[2])
{
    struct slice_settings *slices = &session->settings.slices;
    slices->has_window = thousandths != NULL;
    for (int i = 0; i < 2; i++)
        slices->window_thousandths[i] = thousandths ? thousandths[i] : 0;
    if (!cut_is_none(&session->settings.cut))
        session->rendered = false; /* faces that are cut open show the scene */
}

const struct rendition *session_frame(const struct session *session)
{
    return session->settings.look.samples > 1 ? &session->reduced : &session->rendition;
}

void session_recount(struct session *session)
{
    if (!session->skims)
        border_recount(&session->border);
    session->rendered = false;
}

void session_set_visible(struct session *session, uint8_t label, bool visible)
{
    session->settings.visible[label] = visible;
    session->border.visible[label] = visible;
    session_recount(session);
}

enum err session_set_cut(struct session *session, const struct cut *cut, struct fault *fault)
{
    session->settings.cut = session->border.cut = *cut;
    session_recount(session);
    return watch_fault(session->watch, fault);
}

/* Memory for the rendition, of camera.view's size. */
static enum err make_room(struct session *session, struct fault *fault)
{
    const struct view *view = &session->settings.view, *fine = &session->camera.view;
    if (session->has_rendition)
        return OK;
    session->rendered = false;
    enum err err = rendition_init(&session->rendition, fine->width, fine->height, fault);
    if (!err && fine->width != view->width)
        err = rendition_init(&session->reduced, view->width, view->height, fault);
    session->has_rendition = err == OK;
    if (err)
        release_rendition(session);
    return err;
}

enum err session_draw(struct session *session, enum render_mode mode, struct fault *fault)
{
    if (session->skims)
        return OK;
    enum err err = make_room(session, fault);
    if (err || (session->rendered && (mode == RENDER_AS_KEPT || mode == RENDER_INCREMENTAL)))
        return err;
    session->rendered = false;
    if (mode == RENDER_SCENE)
        splat_scene(&session->rendition, &session->camera, &session->border);
    else if (mode == RENDER_RAY)
        raycast(&session->rendition, &session->camera, &session->border);
    else
        splat_border(&session->rendition, &session->camera, &session->border);
    err = colour(session, fault);
    session->rendered = err == OK;
    return err ? err : watch_fault(session->watch, fault);
}

enum err session_render(struct session *session, enum render_mode mode, struct fault *fault)
{
    enum err err = session_run(session, fault);
    return err ? err : session_draw(session, mode, fault);
}

/* ---- all or nothing ---- */

void session_mark(struct session *session)
{
    session_settle(session);
    watch_begin(session->watch);
    if (session->has_scene)
        session->scene->watch = session->watch;
    session->mark = session->settings;
    session->mark_tally = session->tally;
    session->mark_pendings = session->pendings;
    eliminators_mark(&session->eliminators);
    session->mark_has_scene = session->has_scene;
    session->mark_rendered = session->rendered;
    session->edited_forest = session->rebuilt_forest = false;
    session->weighed_again = session->roi_changed = false;
    session->read_weights = session->replanted = false;
    session->applied = 0;
}

/* Weights, region of interest and forest as the settings and the mark have them; not to be cancelled again. What
 * session_restore did to the seeds is taken back while no region of interest is in the way. */
static void take_weights_and_roi_back(struct session *session)
{
    if (session->replanted) {
        const struct roi open = roi_none();
        forest_suspend(session->forest);
        roi_apply(&open, session->scene);
        if (session->edited_forest)
            forest_revert(session->forest, NULL);
        session->roi_changed = true;
    }
    if (session->roi_changed) {
        if (session->roi.mask != session->mark_roi.mask)
            free(session->roi.mask);
        session->roi = session->mark_roi;
        session->roi_tally = session->mark_roi_tally;
        roi_apply(&session->roi, session->scene);
    }
    if (session->former_weights)
        weight_fill(session->scene, session->former_weights);
    if (session->weighed_again) {
        forest_set_adjacency(session->forest, session->settings.adjacency);
        session_weigh(session, NULL);
    }
    if (session->rebuilt_forest || session->roi_changed)
        session_rebuild(session, session->replanted && !session->skims, NULL);
}

/*
 * A command either edits the forest or has it computed again, never both in a way that the order
 * matters: seeds are a set, so the inverse edit is right before or after the rebuild. What waited
 * for a run is still in `pending`, since session_run only sets the count to 0 and a command that
 * runs appends nothing afterwards.
 *
 * Where the watch stopped the command, border or rendition may be half done: these are made from
 * nothing. Weights that were cut short before the forest was touched leave its keys as they were.
 */
void session_rollback(struct session *session)
{
    if (session->has_scene && !session->mark_has_scene) {
        watch_begin(session->watch);
        session_close_scene(session);
        session->settings = session->mark;
        session->pendings = session->mark_pendings;
        return;
    }
    const bool cut_short = session->watch && session->watch->stopped;
    session_take_back_lists(session);
    eliminators_rollback(&session->eliminators);
    watch_ignore_stop(session->watch);
    bool is_other_scene = session->former.scene != NULL;
    if (is_other_scene)
        session_take_back_scene(session);
    bool redraws = is_other_scene ||
                   memcmp(&session->settings.view, &session->mark.view, sizeof(struct view)) != 0 ||
                   memcmp(&session->settings.look, &session->mark.look, sizeof(struct look)) != 0;
    bool shows_other =
        memcmp(session->settings.visible, session->mark.visible, sizeof session->mark.visible) !=
            0 ||
        memcmp(&session->settings.cut, &session->mark.cut, sizeof session->mark.cut) != 0;
    bool recolours =
        memcmp(&session->settings.palette, &session->mark.palette, sizeof(struct palette)) != 0 ||
        session->settings.slices.has_window != session->mark.slices.has_window ||
        memcmp(session->settings.slices.window_thousandths, session->mark.slices.window_thousandths,
               sizeof session->mark.slices.window_thousandths) != 0;
    session->settings = session->mark;
    session->pendings = session->mark_pendings;
    if (!session->has_scene) {
        watch_begin(session->watch);
        return;
    }
    if (cut_short)
        session->rendered = false;
    if (session->edited_forest && !session->replanted && forest_revert(session->forest, NULL) == OK)
        follow_forest(session);
    take_weights_and_roi_back(session);
    session->tally = session->mark_tally;
    if (shows_other) {
        memcpy(session->border.visible, session->mark.visible, sizeof session->border.visible);
        session->border.cut = session->mark.cut;
    }
    if (shows_other || (cut_short && session->edited_forest))
        session_recount(session);
    if (redraws)
        look_from(session, &session->mark.view, &session->mark.look, NULL);
    if (shows_other || recolours || !session->mark_rendered)
        session->rendered = false;
    if (session->mark_rendered)
        session_draw(session, RENDER_AS_KEPT, NULL);
    watch_begin(session->watch);
    session->scene->watch = NULL; /* until the next command */
}
