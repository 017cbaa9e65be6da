/* SPDX-License-Identifier: MIT */
/* What stories about a small scene share: the scene, maps on its grid, and snapshots of a session
 * to compare. All files are in `folder`, which main creates and removes (begin_folder,
 * end_folder). */
#ifndef TESTS_SMALL_SCENE_H
#define TESTS_SMALL_SCENE_H

#include "journal/journal.h"
#include "base/file.h"
#include "base/safe.h"
#include "image/volume.h"
#include "show/pictures.h"
#include "tests/border_check.h"
#include "tests/interpreting.h"
#include "tests/folder.h"

static char folder[FOLDER_LENGTH];
static const uint32_t size[3] = {12, 11, 10};
static const double to_mm[3][4] = {{-1, 0, 0, 5.5}, {0, 1.5, 0, -20}, {0, 0.25, 2, 7}};

static inline const char *place(const char *name)
{
    return file_in(folder, name);
}

/* Three blocks on a slope, so that trees have something to climb. */
static inline void scene_row(void *context, uint32_t y, uint32_t z, void *values)
{
    uint8_t *at = values;
    (void)context;
    for (uint32_t x = 0; x < size[0]; x++)
        *at++ = (uint8_t)(3 * x + 2 * y + z + (x > 5 ? 60 : 0) + (y > 6 && z > 4 ? 90 : 0));
}

/* Writes a map with the position of the scene. */
static inline void write_map(const char *name, const uint32_t sides[3], enum voxel_type type,
                             void (*row)(void *context, uint32_t y, uint32_t z, void *values),
                             void *context)
{
    struct geometry geometry = {.slope = 1, .spacing_nm = {1000000, 1500000, 2000000}};
    CHECK(geometry_place(&geometry, to_mm, ORIENTATION_SFORM));
    const struct volume_map map = {sides, &geometry, type, "test", row, context, NULL, NULL, NULL};
    CHECK(volume_write(place(name), FILE_REPLACE, &map, NULL, NULL) == OK);
}

static inline void make_scene(void)
{
    write_map("scene.nii", size, VOXEL_UINT8, scene_row, NULL);
}

static inline void open_scene(struct interpreter *interp, const char *name)
{
    char line[PATH_MAX + 8];
    snprintf(line, sizeof line, "open %s", place(name));
    must(interp, line);
}

static inline void begin_with_scene(struct interpreter *interp)
{
    begin_interpreter(interp);
    open_scene(interp, "scene.nii");
    must(interp, "label 2 cerebellum #40c060");
    must(interp, "label 0 background");
}

/* Define a story whose `interp` begins with the scene. */
#define SCENE_STORY(told) BEGUN_STORY(told, begin_with_scene)

/* The scene alone, in a new journal. */
static inline void begin_with_journal(struct interpreter *interp, const char *name)
{
    begin_interpreter(interp);
    unlink(place(name));
    CHECK(interpreter_create_journal(interp, place(name), NULL) == OK);
    open_scene(interp, "scene.nii");
}

/* Define a story in which the file's `interp` begins with the scene in a new journal. */
#define JOURNAL_STORY(told, journal)                                                               \
    STORY_WITHIN(told, begin_with_journal(&interp, journal), interpreter_release(&interp))

/* Begin again, with the commands of a journal. */
static inline void resume_journal(struct interpreter *interp, const char *name)
{
    interpreter_release(interp);
    begin_interpreter(interp);
    if (!CHECK(interpreter_resume_journal(interp, place(name), NULL, &fault) == OK))
        printf("#   %s\n", fault.text);
}

/* Carrying every command of a journal out again gives the recorded results. */
static inline void verify_journal(const char *name)
{
    OWNED(replay_report_release) struct replay_report report = {0};
    OWNED(interpreter_release) struct interpreter interp;
    begin_interpreter(&interp);
    if (!CHECK(replay_file(&interp, place(name), 0, 0, NULL, NULL, &report, &fault) == OK))
        printf("#   %s\n", fault.text);
}

/* Execute lines, after which the forest has so many seeds. */
static inline void must_leave_seeds(struct interpreter *interp, const char *lines, size_t seeds)
{
    must(interp, lines);
    CHECK_INT(forest_seeds(interp->session->forest), seeds);
}

static inline void write_text(const char *name, const char *text)
{
    CHECK(file_write(place(name), text, strlen(text), FILE_REPLACE, NULL) == OK);
}

/* Two slabs, one of them of the value 2 + `other`; or of another size. */
static uint8_t other_region;
static inline void region_row(void *context, uint32_t y, uint32_t z, void *values)
{
    const uint32_t *sides = context;
    uint8_t *at = values;
    (void)y, (void)z;
    for (uint32_t x = 0; x < sides[0]; x++)
        *at++ = (uint8_t)(x < 4 ? 1 : x < 8 ? 0 : 2 + other_region);
}

static inline void make_regions(const char *name, uint32_t x, uint8_t other)
{
    uint32_t sides[3] = {x, size[1], size[2]};
    other_region = other;
    write_map(name, sides, VOXEL_UINT8, region_row, sides);
}

/* Weights 0..39, and `more`. */
static uint32_t more_weight;
static inline void weight_row(void *context, uint32_t y, uint32_t z, void *values)
{
    uint8_t *at = values;
    (void)context;
    for (uint32_t x = 0; x < size[0]; x++) {
        const uint32_t value = (7 * x + 5 * y + 3 * z) % 40 + more_weight;
        *at++ = (uint8_t)(value & 255);
        *at++ = (uint8_t)(value >> 8);
    }
}

static inline void make_weights(const char *name, uint32_t more)
{
    more_weight = more;
    write_map(name, size, VOXEL_UINT16, weight_row, NULL);
}

/* ---- snapshots ---- */

/* Everything in a session that commands can change; a rough rendition counts as none. */
struct snapshot {
    uint64_t forest, labels, scene, weights, roi, picture;
    size_t seeds, pendings, border, acknowledged, records;
    struct edit pending[64];
    uint32_t eliminator[64];
    size_t eliminators, waiting;
    struct kept kept; /* borrowed: what maps were is compared, not looked at */
    struct outlook outlook;
    bool has_scene, rendered;
    size_t points, branches, numbered;
    uint32_t present, on;
};

/* Voxels are outside exactly where the region of interest says so, and its tally is right. */
static inline void roi_stands(const struct session *session)
{
    const struct roi_tally tally = roi_tally(&session->roi, session->scene);
    const struct cell *cell = session->scene->cell;
    bool fits = true;
    for (uint32_t c = 0; c < session->scene->grid.cells; c++)
        fits &= cell[c].flags & CELL_RIM ||
                !(cell[c].flags & CELL_OUTSIDE) == roi_holds(&session->roi, session->scene, c);
    CHECK(fits);
    CHECK(tally.digest == session->roi_tally.digest && tally.seeds_outside == 0);
    CHECK_INT(tally.inside, session->roi_tally.inside);
}

/* What is derived from the state was derived from this state, not from an older one. */
static inline void fits_its_state(const struct session *session)
{
    const struct kept *kept = &session->now.kept;
    struct roi roi = roi_none();
    CHECK_INT(session->inside->stale, 0);
    for (int label = 0; label < 256; label++)
        CHECK(session->border.visible[label] == (kept->visible[label] && kept->opacity[label]));
    CHECK(memcmp(session->border.opacity, kept->opacity, sizeof kept->opacity) == 0);
    CHECK(memcmp(&session->border.cut, &kept->cut, sizeof kept->cut) == 0);
    CHECK_INT(forest_adjacency(session->forest)->count, kept->adjacency);
    CHECK(forest_arcs(session->forest)->kind == weight_arcs(kept->weight.kind));
    CHECK(!kept->weight_map == (kept->weight.kind != WEIGHT_FILE));
    if (kept->has_range)
        roi_range(&roi, session, kept->range_channel, kept->range);
    CHECK(session->roi.low == roi.low && session->roi.high == roi.high);
    CHECK_INT(session->roi.channel, roi.channel);
    CHECK(!session->roi.mask == !kept->mask);
    const size_t bytes = mask_bytes(&session->scene->grid);
    OWNED(mem_release) uint64_t *bits = kept->mask ? malloc(bytes) : NULL;
    if (bits) {
        CHECK(packed_take_out(kept->mask, bits, NULL, NULL) == OK);
        CHECK(memcmp(bits, session->roi.mask, bytes) == 0);
    }
}

/* S6: the seeds, changed by the pending edits, are those of the active markers. */
static inline void markers_stand(const struct session *session)
{
    const struct scene *scene = session->scene;
    const struct edit *pending = edits_first(&session->now.lists.pending);
    OWNED(mem_release) struct edit *seed = malloc(scene->grid.cells * sizeof *seed);
    bool same = true;
    for (uint32_t c = 0; c < scene->grid.cells; c++) {
        seed[c].label = scene->cell[c].flags & CELL_SEED ? scene->cell[c].label : EDIT_ERASE;
        seed[c].reach = forest_reach_number(session->forest, c);
    }
    for (size_t i = 0; i < session_pendings(session); i++)
        seed[pending[i].cell] = pending[i];
    for (uint32_t c = 0; c < scene->grid.cells; c++) {
        const struct edit edit = markers_edit(&session->markers, c);
        same &= seed[c].label == edit.label && seed[c].reach == edit.reach;
    }
    CHECK(same);
}

/* The kept counts of labels equal a new count. */
static inline void measures_stand(struct session *session)
{
    static struct label_stats kept[256], anew[256];
    const struct labels labels = labels_of_forest(session->scene);
    OWNED(label_measures_release) struct label_measures measures = {0};
    if (watch_stops(session->scene->watch))
        return;
    CHECK(session_find_stats(session, &labels, kept, NULL) == OK);
    CHECK(label_stats_find(anew, &measures, &labels, NULL, NULL) == OK);
    CHECK(memcmp(kept, anew, sizeof kept) == 0);
}

/* Y1 of session/tally.h: a tally that is not stale equals a recount. */
static inline bool tally_check(const struct tally *tally, const struct labels *labels)
{
    struct tally anew = {.stale = true};
    return tally->stale || (tally_refresh(&anew, labels, NULL) &&
                            memcmp(anew.voxels, tally->voxels, sizeof anew.voxels) == 0);
}

/* Digest of the rendition, if there is one; edits since it was drawn wait until it is wanted. */
static inline uint64_t updated_picture(struct session *session)
{
    struct pictures *p = session->pictures;
    struct labels labels;
    if ((p->waits.count || !p->waits.follows) && !watch_stops(session->scene->watch))
        CHECK(session_labels(session, p->rendered == RENDERED_FINISHED, &labels, NULL) == OK &&
              session_draw_labels(session, &labels, RENDER_AS_KEPT, NULL) == OK);
    return rendition_digest(&p->rendition);
}

static inline void take_snapshot(struct snapshot *s, struct interpreter *interp)
{
    struct session *session = interp->session;
    memset(s, 0, sizeof *s);
    s->has_scene = session->has_scene;
    s->rendered = session_rendered(session) && !session_is_rough(session);
    s->kept = session->now.kept;
    s->outlook = session->now.outlook;
    s->pendings = session_pendings(session);
    s->acknowledged = interp->acknowledged;
    s->records = interp->journal ? journal_count(interp->journal) : 0;
    s->points = interp->history.points;
    s->branches = interp->history.branches;
    s->numbered = interp->history.records;
    s->present = interp->history.present;
    s->on = interp->history.on;
    for (size_t i = 0; i < session_pendings(session) && i < 64; i++) {
        s->pending[i].cell = edits_first(&session->now.lists.pending)[i].cell;
        s->pending[i].label = edits_first(&session->now.lists.pending)[i].label;
    }
    const struct edits *e = &session->now.lists.eliminators;
    s->eliminators = edits_count(e);
    s->waiting = s->eliminators - session->now.lists.applied;
    for (size_t i = 0; i < s->eliminators && i < 64; i++)
        s->eliminator[i] = edits_first(e)[i].cell;
    if (!session->has_scene)
        return;
    s->scene = session->scene_digest;
    s->weights = session->weight_digest;
    s->roi = session->roi_tally.digest;
    CHECK(s->weights == weight_digest(session->scene, forest_arcs(session->forest), NULL));
    roi_stands(session);
    fits_its_state(session);
    markers_stand(session);
    const struct labels labels = labels_of_forest(session->scene);
    CHECK(tally_check(&session->tally, &labels));
    measures_stand(session);
    s->forest = forest_digest(session->forest);
    s->labels = forest_label_digest(session->forest);
    s->seeds = forest_seeds(session->forest);
    s->border = border_count(&session->border);
    s->picture = s->rendered ? updated_picture(session) : 0;
    CHECK(forest_check(session->forest, NULL));
    CHECK(border_check(&session->border, NULL));
}

/* Maps of two sessions are not one and the same; digests say whether they hold the same. */
static inline bool is_same_kept(const struct kept *a, const struct kept *b)
{
    struct kept x = *a, y = *b;
    if (!x.mask != !y.mask || !x.weight_map != !y.weight_map)
        return false;
    x.mask = y.mask = x.weight_map = y.weight_map = NULL;
    return kept_equals(&x, &y);
}

/* The segmentation is the same; where one looks from, and how one came, may be others. */
static inline void is_same_segmentation(const struct snapshot *a, const struct snapshot *b)
{
    CHECK(a->weights == b->weights);
    CHECK(a->roi == b->roi);
    CHECK(a->forest == b->forest);
    CHECK(a->labels == b->labels);
    CHECK(a->seeds == b->seeds);
    CHECK(a->border == b->border);
    CHECK(a->pendings == b->pendings);
    CHECK(memcmp(a->pending, b->pending, sizeof a->pending) == 0);
    CHECK(a->eliminators == b->eliminators && a->waiting == b->waiting);
    CHECK(memcmp(a->eliminator, b->eliminator, sizeof a->eliminator) == 0);
    CHECK(is_same_kept(&a->kept, &b->kept));
}

/* The session has this segmentation. */
static inline void is_segmented_as(const struct snapshot *expected, struct interpreter *interp)
{
    struct snapshot now;
    take_snapshot(&now, interp);
    is_same_segmentation(expected, &now);
}

static inline void is_as_before(const struct snapshot *before, struct interpreter *interp,
                                const char *line)
{
    struct snapshot now;
    unsigned failures = check_failures;
    take_snapshot(&now, interp);
    is_same_segmentation(before, &now);
    CHECK(now.has_scene == before->has_scene);
    CHECK(now.scene == before->scene);
    CHECK(now.rendered == before->rendered);
    CHECK(now.picture == before->picture);
    CHECK(now.acknowledged == before->acknowledged);
    CHECK(now.records == before->records);
    CHECK(outlook_equals(&now.outlook, &before->outlook));
    CHECK(now.points == before->points && now.present == before->present);
    CHECK(now.branches == before->branches && now.on == before->on);
    CHECK(now.numbered == before->numbered);
    if (check_failures > failures)
        printf("#   after %s\n", line);
}

/* One line, nothing that a terminal obeys. */
static inline bool is_plain(const char *text)
{
    size_t left = strlen(text);
    while (left) {
        size_t n = safe_character(text, left);
        if (n == 0)
            return false;
        text += n;
        left -= n;
    }
    return true;
}

/* An error in plain words, which leaves all as it was. */
static inline void is_refused(struct interpreter *interp, const char *line, const char *words)
{
    struct snapshot before;
    take_snapshot(&before, interp);
    enum err err = execute(interp, line);
    CHECK_WITH(err != OK, "%s", line);
    CHECK_HAS(fault.text, words);
    CHECK(fault.code == err);
    CHECK(err_exit_status(err) == 2 || err_exit_status(err) == 3);
    CHECK(is_plain(fault.text));
    is_as_before(&before, interp, line);
}

static inline bool begin_folder(void)
{
    return make_folder(folder, "story") && chdir(folder) == 0;
}

/* 1 where something is left of it. */
static inline int end_folder(void)
{
    reply_release(&reply);
    return remove_folder(folder);
}

#endif
