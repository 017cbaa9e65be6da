/* SPDX-License-Identifier: MIT */
/* Fitting: the shown objects fill the picture, at the angles of one view or of a turntable. */

#include "image/exr.h"
#include "render/fit.h"
#include "render/projection.h"
#define RUN_IN_FOLDER
#include "tests/folder_main.h"
#include "tests/interpreting.h"

/* ---- any scene, by itself ---- */

struct world {
    struct scene *scene;
    struct border border;
    struct view view;
};

/* Axes and spacings of any kind, and an object of some voxels. */
static void begin_world(struct world *w, uint64_t *random)
{
    static const int8_t order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2},
                                       {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const int8_t *axis = order[check_below(random, 6)];
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 1 + check_below(random, check_below(random, 3) ? 90 : 4);
    CHECK(scene_new(&w->scene, size, NULL, NULL, NULL) == OK &&
          border_init(&w->border, w->scene, NULL) == OK);
    for (int a = 0; a < 3; a++) {
        w->scene->spacing_nm[a] =
            check_below(random, 2) ? 1000000 : 300000 + check_below(random, 2000000);
        w->scene->world_sign[a] = check_below(random, 2) ? 1 : -1;
        w->scene->world_axis[a] = axis[a];
    }
    for (int voxels = 1 + (int)check_below(random, 40); voxels > 0; voxels--)
        w->scene
            ->cell[grid_cell(&w->scene->grid, check_below(random, size[0]),
                             check_below(random, size[1]), check_below(random, size[2]))]
            .label = 1;
    border_recount(&w->border);
    w->view = view_default(w->scene);
    w->view.width = 40 + check_below(random, 300);
    w->view.height = 40 + check_below(random, 300);
    for (int i = 0; i < 3; i++)
        w->view.angle[i] = (int32_t)(check_below(random, 2) ? check_below(random, 8) * 45000
                                                            : check_below(random, 360000));
}

static void end_world(struct world *w)
{
    border_release(&w->border);
    scene_free(w->scene);
}

/* First and last column and row that show something. */
static void find_box(uint32_t box[2][2], const struct rendition *r)
{
    for (int k = 0; k < 2; k++)
        box[k][0] = UINT32_MAX, box[k][1] = 0;
    for (uint32_t i = 0; i < r->width * r->height; i++)
        if (r->cell[i] != CELL_NONE) {
            const uint32_t at[2] = {i % r->width, i / r->width};
            for (int k = 0; k < 2; k++) {
                box[k][0] = at[k] < box[k][0] ? at[k] : box[k][0];
                box[k][1] = at[k] > box[k][1] ? at[k] : box[k][1];
            }
        }
}

/* In a larger picture, nothing visible would lie in the margin or outside. The free border is at
 * most the margin plus the offset of the nearest voxel from the exact middle. */
static void check_fit(const struct world *w, const struct view *view)
{
    struct view wide = *view;
    struct camera camera;
    OWNED(mesh_release) struct mesh mesh = {0};
    OWNED(rendition_release) struct rendition r = {0};
    uint32_t box[2][2];
    const uint32_t size[2] = {view->width, view->height}, beyond = 60;
    const uint32_t margin = (size[0] < size[1] ? size[0] : size[1]) / FIT_MARGIN;
    wide.width += 2 * beyond;
    wide.height += 2 * beyond;
    if (!CHECK(camera_init(&camera, w->scene, &wide, NULL) == OK))
        return;
    CHECK(rendition_init(&r, wide.width, wide.height, NULL) == OK);
    CHECK(mesh_update(&mesh, &w->border, MESH_CUBES, NULL, NULL, NULL) == OK);
    project_border(&r, &camera, &mesh);
    find_box(box, &r);
    uint64_t most = 0, voxel = 0; /* pixels of the largest */
    for (int a = 0; a < 3; a++) {
        const uint64_t side = (uint64_t)w->scene->spacing_nm[a] * view->zoom / 1000;
        voxel = side / view_unit(w->scene) > voxel ? side / view_unit(w->scene) : voxel;
    }
    /* A direction cosine of 0 is a 4096th (render/view.h). */
    const uint64_t all =
        (uint64_t)w->scene->grid.size[0] + w->scene->grid.size[1] + w->scene->grid.size[2];
    const uint64_t oblique = all * voxel / 4096;
    const bool is_seen = box[0][0] != UINT32_MAX; /* or all of it falls between pixels */
    for (int k = 0; k < 2 && is_seen; k++) {
        CHECK(box[k][0] + 1 + oblique >= beyond + margin);
        CHECK(box[k][1] <= beyond + size[k] - margin + oblique);
        const uint64_t taken = (uint64_t)(box[k][1] - box[k][0] + 1) + 2 * voxel + 4;
        most = taken * 1000 / (size[k] - 2 * margin) > most ? taken * 1000 / (size[k] - 2 * margin)
                                                            : most;
    }
    /* Or a voxel is as large as a picture allows, or nearly, or falls between pixels. The middle of
     * an oblique sheet may lie outside the scene, and its nearest voxel off the sheet. */
    CHECK(most >= 850 || view->zoom > VIEW_ZOOM_MOST * 7 / 8 || voxel > 256 / 4 * 7 / 8 ||
          view->zoom < 2 * VIEW_ZOOM_ONE);
}

STORY(what_is_shown_fills_the_picture_from_everywhere)
{
    uint64_t random = 11;
    for (int round = 0; round < 1500 && check_failures == 0; round++) {
        struct world w;
        OWNED(fit_release) struct fit fit = {0};
        uint32_t place[3];
        begin_world(&w, &random);
        CHECK_INT(fit_init(&fit, &w.border, NULL), OK);
        CHECK(!fit.is_scene);
        fit_place(&fit, &w.view, place);
        for (int a = 0; a < 3; a++)
            CHECK(place[a] < w.scene->grid.size[a]);
        w.view.zoom = fit_zoom(&fit, &w.view, place, 1 + check_below(&random, 4));
        view_focus_on(&w.view, w.scene, place);
        check_fit(&w, &w.view);
        end_world(&w);
    }
}

STORY(where_nothing_is_shown_the_scene_fits)
{
    uint64_t random = 12;
    for (int round = 0; round < 100 && check_failures == 0; round++) {
        struct world w;
        OWNED(fit_release) struct fit fit = {0};
        uint32_t place[3];
        begin_world(&w, &random);
        memset(w.border.visible, 0, sizeof w.border.visible);
        border_recount(&w.border);
        CHECK_INT(fit_init(&fit, &w.border, NULL), OK);
        CHECK(fit.is_scene);
        fit_place(&fit, &w.view, place);
        w.view.zoom = fit_zoom(&fit, &w.view, place, 1);
        view_focus_on(&w.view, w.scene, place);
        w.border.visible[1] = true;
        for (size_t i = 0; i < w.scene->grid.cells; i++)
            w.scene->cell[i].label = !(w.scene->cell[i].flags & CELL_RIM);
        border_recount(&w.border);
        check_fit(&w, &w.view);
        end_world(&w);
    }
}

/* ---- the commands ---- */

static void begin_with_object(struct interpreter *interp)
{
    begin_interpreter(interp);
    must(interp, "open synth:geom:60x50x40; seed 12,12,10 1 radius=4; size 90 70; view 30 20");
}

BEGUN_STORY(fit_is_recorded_as_what_it_comes_to, begin_with_object)
{
    must(interp, "zoom fit"); /* the seed waits: no object yet */
    CHECK_TEXT(buf_text(&reply.text), "no object is shown: the scene fits\n"
                                      "not included: the 257 pending edits (`run` applies them)\n");
    const uint32_t whole = interp->session->now.outlook.view.zoom;
    must(interp, "run; clip axial 5-12; cut 20,0,0 59,49,39; zoom fit");
    const struct view fitted = interp->session->now.outlook.view;
    CHECK(fitted.zoom > whole + whole / 4);
    CHECK_TEXT(buf_text(&reply.text), "");
    CHECK_HAS(buf_text(&reply.canonical), "zoom ");
    CHECK_HAS(buf_text(&reply.canonical), " at=");
    char line[64];
    snprintf(line, sizeof line, "%s", buf_text(&reply.canonical));
    must(interp, "zoom 1 at=0,0,0");
    must(interp, line);
    CHECK_TEXT(buf_text(&reply.canonical), line);
    CHECK(memcmp(&interp->session->now.outlook.view, &fitted, sizeof fitted) == 0);
    CHECK_INT(execute(interp, "zoom fit at=1,1,1"), ERR_USAGE);
    CHECK_HAS(fault.text, "fit finds the place");
    MUST_MENTION(interp, "hide 1; zoom fit", "no object is shown: the scene fits");
}

/* ---- turntables ---- */

static bool same_picture(const char *a, const char *b)
{
    OWNED(picture_release) struct picture p = {0}, q = {0};
    const bool read = CHECK(exr_read(&p, a, NULL) == OK) && CHECK(exr_read(&q, b, NULL) == OK);
    return read && memcmp(p.rgba, q.rgba, (size_t)4 * p.width * p.height) == 0;
}

/* Each turn begins with the view, and turns one of its angles. */
BEGUN_STORY(a_turntable_turns_about_one_axis_after_the_other, begin_with_object)
{
    static const char *const turned[] = {"view 30 20",     "view 210 20", "view 30 20",
                                         "view 30 20 180", "view 30 20",  "view 30 200"};
    char line[64];
    must(interp, "run");
    MUST_ANSWER(interp, "spin 2 turn%d.exr axis=yaw,roll,pitch", "wrote turn0.exr to turn5.exr\n");
    CHECK_TEXT(buf_text(&reply.canonical), "spin 2 turn%d.exr axis=yaw,roll,pitch");
    for (unsigned i = 0; i < sizeof turned / sizeof turned[0]; i++) {
        must(interp, turned[i]);
        must(interp, "render one.exr replace=yes");
        snprintf(line, sizeof line, "turn%u.exr", i);
        CHECK(same_picture(line, "one.exr"));
    }
    must(interp, "view 30 20; spin 2 yaw%d.exr axis=yaw; spin 2 plain%d.exr");
    CHECK(same_picture("yaw1.exr", "plain1.exr"));
}

BEGUN_STORY(axes_are_each_named_once, begin_with_object)
{
    static const char *const bad[] = {
        "yaw,yaw", "yaw,", ",yaw", "yaw,,roll", "spin", "yaw pitch", "yaw,pitch,roll,yaw",
        "yawpitch"};
    char line[64];
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(line, sizeof line, "spin 2 no%%d.exr \"axis=%s\"", bad[i]);
        CHECK_INT(execute(interp, line), ERR_USAGE);
        CHECK_HAS(fault.text, "axis: expected yaw, pitch or roll");
    }
    CHECK_INT(execute(interp, "spin 400 no%d.exr axis=yaw,pitch,roll"), ERR_USAGE);
    CHECK_HAS(fault.text, "3 turns of 400 pictures: at most 1000 pictures in all");
}

/* No picture of the turn is cut off, one of them is filled, and the view is as it was. */
BEGUN_STORY(a_turntable_that_fits_fits_all_its_pictures, begin_with_object)
{
    char name[32];
    uint32_t most = 0, least[2] = {90, 70};
    must(interp, "run; cut 30,0,0 59,49,39; zoom 7");
    const struct view before = interp->session->now.outlook.view;
    must(interp, "spin 12 fit%d.exr fit=yes axis=yaw,pitch");
    CHECK(memcmp(&interp->session->now.outlook.view, &before, sizeof before) == 0);
    for (unsigned i = 0; i < 24; i++) {
        OWNED(picture_release) struct picture p = {0};
        snprintf(name, sizeof name, "fit%u.exr", i);
        CHECK_INT(exr_read(&p, name, NULL), OK);
        for (uint32_t k = 0; p.label && k < 90 * 70; k++) {
            const uint32_t at[2] = {k % 90, k / 90};
            if (!p.label[k])
                continue;
            CHECK(at[0] > 0 && at[0] < 89 && at[1] > 0 && at[1] < 69);
            least[1] = at[1] < least[1] ? at[1] : least[1];
            most = at[1] > most ? at[1] : most;
        }
    }
    CHECK(least[1] <= 5 || most >= 64);
}
