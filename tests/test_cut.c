/* SPDX-License-Identifier: MIT */
/* Cuts: borders compared with a slow count, four ways to one picture through cuts, edits and hidden
 * labels, and commands. */
#include "command/execute.h"
#include "interpreting.h"

#include <math.h>

#include "image/exr.h"
#include "show/pictures.h"
#include "tests/border_check.h"
#include "tests/folder_main.h"
#include "tests/stage.h"

/* ---- by hand ---- */

static struct scene *hand_scene(struct border *border)
{
    struct scene *scene = NULL;
    CHECK(scene_new(&scene, (uint32_t[]){10, 8, 6}, NULL, NULL, NULL) == OK);
    CHECK(border_init(border, scene, NULL) == OK);
    for (uint32_t z = 0; z < 6; z++)
        for (uint32_t y = 0; y < 8; y++)
            for (uint32_t x = 0; x < 10; x++)
                scene->cell[grid_cell(&scene->grid, x, y, z)].label = (uint8_t)(x < 5 ? 1 : 2);
    return scene;
}

static bool shows(const struct border *border, uint32_t x, uint32_t y, uint32_t z)
{
    return border_shows(border, grid_cell(&border->scene->grid, x, y, z));
}

static size_t shown(const struct border *border)
{
    size_t count = 0;
    for (size_t w = 0; w < border->words; w++)
        count += (size_t)__builtin_popcountll(border->shown[w]);
    return count;
}

static void cut_as(struct border *border, const struct cut *cut)
{
    border->cut = *cut;
    border_recount(border);
    CHECK(border_check(border, NULL));
}

STORY(slabs_boxes_and_planes_take_what_they_say)
{
    OWNED(scene_drop) struct scene *scene = NULL;
    OWNED(border_release) struct border border;
    scene = hand_scene(&border);
    const struct grid *grid = &scene->grid;
    struct cut cut = cut_none();
    CHECK(cut_is_none(&cut));
    cut_as(&border, &cut);
    CHECK_INT(shown(&border), 480);

    cut.first[1] = 2, cut.last[1] = 4;
    CHECK(!cut_is_none(&cut));
    cut_as(&border, &cut);
    CHECK_INT(shown(&border), 180);
    CHECK(!shows(&border, 3, 1, 3) && shows(&border, 3, 2, 3) && shows(&border, 3, 4, 3) &&
          !shows(&border, 3, 5, 3));

    /* A box at a corner: voxels that it uncovers are border; voxels that it removes differ from
     * those that never existed. */
    cut = cut_none();
    cut.box[cut.boxes++] = (struct cut_box){{6, 4, 3}, {9, 7, 5}};
    cut_as(&border, &cut);
    CHECK_INT(shown(&border), 480 - 4 * 4 * 3);
    CHECK(border_holds(&border, grid_cell(grid, 5, 5, 4)));
    CHECK(!border_holds(&border, grid_cell(grid, 4, 5, 4)));
    CHECK(border_is_cut(&border, grid_cell(grid, 6, 4, 3)));
    CHECK(!border_is_cut(&border, grid_cell(grid, 5, 4, 3)));
    border.visible[2] = false;
    border_recount(&border);
    CHECK(!border_is_cut(&border, grid_cell(grid, 6, 4, 3)));
    CHECK(!border_is_cut(&border, 0)); /* the rim has nothing to cut */
    border.visible[2] = true;

    /* Across the diagonal of x and y, through 3,3,0: kept where x + y >= 6. */
    cut = cut_none();
    cut.plane[cut.planes++] =
        stage_plane_through(scene, (uint32_t[]){3, 3, 0}, (int32_t[]){1 << 29, 1 << 29, 0});
    cut_as(&border, &cut);
    CHECK(shows(&border, 3, 3, 0) && shows(&border, 6, 0, 5) && shows(&border, 0, 6, 2));
    CHECK(!shows(&border, 3, 2, 0) && !shows(&border, 5, 0, 5) && !shows(&border, 0, 5, 2));

    /* The same direction where voxels are twice as high as wide: kept where x + 2 y >= 9. */
    scene->spacing_nm[1] = 2000000;
    cut.plane[0] =
        stage_plane_through(scene, (uint32_t[]){3, 3, 0}, (int32_t[]){1 << 29, 1 << 29, 0});
    cut_as(&border, &cut);
    CHECK(shows(&border, 3, 3, 0) && shows(&border, 5, 2, 0) && shows(&border, 9, 0, 0));
    CHECK(!shows(&border, 2, 3, 0) && !shows(&border, 4, 2, 0) && !shows(&border, 8, 0, 0));

    /* If bits are dropped, a plane that is less than one of them deeper lies behind its voxel. */
    const int64_t far[3] = {INT64_C(1) << 45, 0, 0};
    cut.plane[0] = cut_plane_at(far, (uint32_t[]){3, 3, 0}, -1);
    cut_as(&border, &cut);
    CHECK(!shows(&border, 3, 3, 0) && shows(&border, 4, 3, 0));

    /* Seen the other way, the rest, and the voxels on the plane both times. */
    cut.plane[0] =
        stage_plane_through(scene, (uint32_t[]){3, 3, 0}, (int32_t[]){-(1 << 29), -(1 << 29), 0});
    cut_as(&border, &cut);
    CHECK(shows(&border, 3, 3, 0) && shows(&border, 2, 3, 0) && !shows(&border, 4, 3, 0));
}

STORY(planes_of_any_spacing_keep_their_voxel_and_fit_64_bits)
{
    uint64_t random = 7;
    OWNED(scene_drop) struct scene *scene = NULL;
    CHECK(scene_new(&scene, (uint32_t[]){2, 2, 2}, NULL, NULL, NULL) == OK);
    for (int round = 0; round < 20000 && check_failures == 0; round++) {
        uint32_t place[3];
        int32_t ahead[3];
        int64_t along = 0;
        for (int a = 0; a < 3; a++) {
            place[a] = check_below(&random, 65534);
            ahead[a] = (int32_t)(check_below(&random, 1u << 31) - (1u << 30));
            scene->spacing_nm[a] = 1 + (uint32_t)(check_random(&random) >> (32 + round % 32));
        }
        const struct cut_plane plane = stage_plane_through(scene, place, ahead);
        for (int a = 0; a < 3; a++) {
            CHECK(llabs(plane.normal[a]) < INT64_C(1) << CUT_NORMAL_BITS);
            CHECK((plane.normal[a] < 0) <= (ahead[a] < 0));
            along += plane.normal[a] * place[a];
        }
        CHECK(along == plane.least);
    }
}

/* ---- at random ---- */

static void stage_at_random(struct stage *s, uint64_t *random)
{
    uint32_t size[3];
    for (int a = 0; a < 3; a++)
        size[a] = 1 + check_below(random, check_below(random, 3) ? 24 : 4);
    CHECK(stage_init(s, size, 6, NULL) == OK);
    s->look.mode = check_below(random, 4) == 1 ? SHADE_CUBES : SHADE_SURFACE;
    s->look.edges = check_below(random, 2);
    s->look.ao_percent = stage_occlusion(random);
    s->look.creases = check_below(random, 2);
    random_values(s->scene, 1000, random);
    s->shader.window[0] = (int32_t)check_below(random, 500);
    s->shader.window[1] = 501 + (int32_t)check_below(random, 500);
    for (int a = 0; a < 3; a++) {
        s->scene->world_sign[a] = check_below(random, 2) ? 1 : -1;
        s->scene->spacing_nm[a] =
            check_below(random, 2) ? 1000000 : 300000 + check_below(random, 2000000);
    }
}

static void random_view(struct stage *s, uint64_t *random)
{
    s->view = view_default(s->scene);
    for (int i = 0; i < 3; i++)
        s->view.angle[i] = (int32_t)(check_below(random, 2) ? check_below(random, 8) * 45000
                                                            : check_below(random, 360000));
    s->view.width = 1 + check_below(random, 70);
    s->view.height = 1 + check_below(random, 70);
    s->view.zoom = 500 + check_below(random, 4000);
    CHECK(camera_init(&s->camera, s->scene, &s->view, NULL) == OK);
}

static void random_cut(struct stage *s, uint64_t *random)
{
    struct cut cut = cut_none();
    uint32_t a[3], b[3];
    for (uint32_t i = check_below(random, 3); i > 0; i--) {
        random_place(&s->scene->grid, random, a);
        random_place(&s->scene->grid, random, b);
        const uint32_t axis = check_below(random, 3);
        cut.first[axis] = a[axis] < b[axis] ? a[axis] : b[axis];
        cut.last[axis] = a[axis] < b[axis] ? b[axis] : a[axis];
    }
    for (uint32_t i = check_below(random, 3); i > 0; i--) {
        random_place(&s->scene->grid, random, a);
        cut.plane[cut.planes++] = stage_plane_through(s->scene, a, s->camera.ahead);
        random_view(s, random);
    }
    for (uint32_t i = check_below(random, 3); i > 0; i--, cut.boxes++) {
        random_place(&s->scene->grid, random, a);
        random_place(&s->scene->grid, random, b);
        for (int k = 0; k < 3; k++) {
            cut.box[cut.boxes].first[k] = a[k] < b[k] ? a[k] : b[k];
            cut.box[cut.boxes].last[k] = a[k] < b[k] ? b[k] : a[k];
        }
    }
    s->border.cut = cut;
    s->border.visible[1 + check_below(random, 3)] = check_below(random, 3) > 0;
    border_recount(&s->border);
}

/* After another cut, what the shader kept of the previous one has no effect. */
static void a_new_shader_sees_the_same(struct stage *s, uint64_t *random)
{
    OWNED(rendition_release) struct rendition kept, anew;
    random_cut(s, random);
    CHECK(border_check(&s->border, NULL));
    CHECK(rendition_init(&kept, s->view.width, s->view.height, NULL) == OK);
    CHECK(rendition_init(&anew, s->view.width, s->view.height, NULL) == OK);
    stage_render(s, &kept, project_border);
    shader_release(&s->shader);
    mesh_release(&s->mesh);
    stage_render(s, &anew, project_border);
    CHECK(stage_same_pixels(&kept, &anew, "what a shader kept"));
}

/* A slab of two objects whose front half is cut away: the cut face shows the scene, the former
 * surface is shaded. */
STORY(faces_that_are_cut_open_show_the_scene)
{
    OWNED(stage_release) struct stage s = {0};
    OWNED(rendition_release) struct rendition r;
    struct cut cut = cut_none();
    CHECK(scene_new(&s.scene, (uint32_t[]){20, 20, 20}, NULL, NULL, NULL) == OK);
    CHECK(forest_new(&s.forest, s.scene, 6, NULL) == OK);
    CHECK(border_init(&s.border, s.scene, NULL) == OK);
    palette_default(&s.palette);
    s.look = look_default();
    s.look.cue_percent = 0;
    s.shader.window[0] = 100, s.shader.window[1] = 355;
    for (uint32_t x = 0; x < 20; x++)
        for (uint32_t y = 0; y < 18; y++)
            for (uint32_t z = 0; z < 20; z++) {
                const uint32_t c = grid_cell(&s.scene->grid, x, y, z);
                s.scene->cell[c].label = y < 8 || x < 10; /* the right half ends at y 7 */
                s.scene->cell[c].intensity = (uint16_t)(100 + 10 * z);
            }
    cut.last[1] = 9;
    s.border.cut = cut;
    border_recount(&s.border);
    s.view = (struct view){.zoom = 1000, .width = 20, .height = 20};
    CHECK(camera_init(&s.camera, s.scene, &s.view, NULL) == OK);
    CHECK(rendition_init(&r, 20, 20, NULL) == OK);
    stage_render(&s, &r, project_border);
    /* From the front the patient's left, where x is small, is on the right; row 19 - z is z. */
    for (uint32_t z = 0; z < 20; z++) {
        const uint8_t *open = r.rgba + 4 * ((19 - z) * 20 + 15), *closed = open - 4 * 10;
        CHECK_INT(open[0], (3 * 10 * z + s.palette.rgb[1][0] + 2) / 4);
        CHECK_INT(open[2], (3 * 10 * z + s.palette.rgb[1][2] + 2) / 4);
        CHECK(z < 4 || z > 15 || closed[0] > 100);
    }
}

STORY(borders_and_pictures_follow_cuts_edits_and_hidden_labels)
{
    uint64_t random = 11;
    unsigned open = 0;
    for (int sitting = 0; sitting < (int)check_scaled(250) && check_failures == 0; sitting++) {
        struct stage s;
        OWNED(rendition_release) struct rendition kept = {0};
        stage_at_random(&s, &random);
        random_view(&s, &random);
        for (int i = 0; i < 4; i++)
            stage_edit_at_random(&s, &random);
        random_cut(&s, &random);
        CHECK(border_check(&s.border, NULL));
        CHECK(rendition_init(&kept, s.view.width, s.view.height, NULL) == OK);
        stage_render(&s, &kept, project_border);
        for (int step = 0; step < 4 && check_failures == 0; step++) {
            const struct changes changes = stage_edit_at_random(&s, &random);
            CHECK(border_check(&s.border, NULL));
            stage_follow(&s, &kept, &changes);
            stage_shade(&s, &kept);
            /* `kept` has followed the edits as an incremental image. */
            static projection *const way[] = {project_border, project_scene, project_rays};
            static const char *const name[] = {"border projection", "scene projection", "ray walk"};
            OWNED(rendition_release) struct rendition r;
            CHECK(rendition_init(&r, s.view.width, s.view.height, NULL) == OK);
            for (int i = 0; i < 3; i++) {
                stage_render(&s, &r, way[i]);
                CHECK(stage_same_pixels(&r, &kept, name[i]));
            }
        }
        for (uint32_t c = 0; c < s.scene->grid.cells; c++)
            open += border_is_cut(&s.border, c);
        a_new_shader_sees_the_same(&s, &random);
        stage_release(&s);
        if (check_failures)
            printf("# sitting %d\n", sitting);
    }
    CHECK(open > 10000); /* or nothing was cut */
}

/* ---- commands ---- */

static void begin(struct interpreter *interp)
{
    CHECK(interpreter_init(interp, NULL) == OK);
    must(interp, "open synth:geom:40x30x20; size 64 64; zoom 1.5; seed 20,15,10 1; run");
}

static uint64_t picture(struct interpreter *interp)
{
    must(interp, "render mode=bp");
    return rendition_digest(&interp->session->pictures->rendition);
}

static bool is_shown(const struct interpreter *interp, uint32_t x, uint32_t y, uint32_t z)
{
    return shows(&interp->session->border, x, y, z);
}

BEGUN_STORY(slabs_are_counted_as_slices_are, begin)
{
    must(interp, "clip axial 3-7");
    CHECK(!is_shown(interp, 5, 5, 2) && is_shown(interp, 5, 5, 3) && is_shown(interp, 5, 5, 7) &&
          !is_shown(interp, 5, 5, 8));
    must(interp, "clip coronal 10");
    CHECK(is_shown(interp, 5, 10, 5) && !is_shown(interp, 5, 11, 5) && !is_shown(interp, 5, 10, 8));
    MUST_MENTION(interp, "info",
                 "cut away  all but axial slices 3-7, all but coronal slices 10-10\n");
    must(interp, "clip axial 0-19");
    CHECK(is_shown(interp, 5, 10, 19));
    MUST_MENTION(interp, "info", "cut away  all but coronal slices 10-10\n");
    /* If an axis is reversed, slice 0 is its first voxel, which used to be the last. */
    must(interp, "clip none");
    interp->session->scene->world_sign[0] = -1;
    must(interp, "clip sagittal 0-1");
    CHECK(is_shown(interp, 0, 5, 5) && is_shown(interp, 1, 5, 5) && !is_shown(interp, 2, 5, 5));
    MUST_MENTION(interp, "info", "all but sagittal slices 0-1");
    MUST_FAIL(interp, "clip sagittal 0-40", ERR_INPUT,
              "there are sagittal slices 0-39, right to left, not 40");
    must(interp, "clip none; info");
    CHECK(!strstr(buf_text(&reply.text), "cut away"));
}

BEGUN_STORY(a_plane_cuts_what_lies_before_a_voxel_and_stays_with_the_patient, begin)
{
    const uint64_t whole = picture(interp);
    must(interp, "view front"); /* from anterior: y counts towards us */
    must(interp, "plane 20,15,10");
    CHECK(is_shown(interp, 3, 15, 3) && !is_shown(interp, 3, 16, 3));
    must(interp, "view left");
    CHECK(is_shown(interp, 3, 15, 3) && !is_shown(interp, 3, 16, 3));
    must(interp, "plane 10,15,10"); /* from his left: x counts away from us */
    CHECK(is_shown(interp, 10, 15, 3) && !is_shown(interp, 9, 15, 3) &&
          !is_shown(interp, 10, 16, 3));
    for (int more = 2; more < CUT_PLANES_MOST; more++)
        must(interp, "plane 10,15,10");
    MUST_FAIL(interp, "plane 1,1,1", ERR_LIMIT,
              "there are 8 planes already, the most; `plane none` removes them");
    MUST_MENTION(interp, "info", "cut away  8 planes\n");
    must(interp, "plane none; view front");
    CHECK(picture(interp) == whole);
}

/* Voxels that are shown of those with x + 2 y of this much. */
static unsigned shown_at(const struct interpreter *interp, uint32_t sum)
{
    unsigned count = 0;
    for (uint32_t y = 0; y < 30; y++)
        for (uint32_t x = 0; x < 40; x++)
            for (uint32_t z = 0; z < 20; z++)
                count += x + 2 * y == sum && is_shown(interp, x, y, z);
    return count;
}

BEGUN_STORY(a_plane_with_a_normal_is_the_same_from_everywhere, begin)
{
    must(interp, "view 33 20; plane 20,15,10 normal=right"); /* x counts to the right */
    CHECK(is_shown(interp, 20, 3, 3) && !is_shown(interp, 21, 3, 3));
    must(interp, "plane none; plane 20,15,10 normal=bottom offset=2.5");
    CHECK(is_shown(interp, 20, 3, 8) && !is_shown(interp, 20, 3, 7));
    must(interp, "plane none");
    must(interp, "plane 20,15,10 normal=back offset=-3"); /* the plane's own voxels stay */
    CHECK(is_shown(interp, 20, 18, 8) && !is_shown(interp, 20, 17, 7));
    must(interp, "plane none");

    /* All on the plane stay, and none beyond: 20 + 2 * 15 is 50. */
    static const char *const same[] = {"plane 20,15,10 normal=1,2,0", "plane 20,15,10 normal=1,2,0",
                                       "plane 20,15,10 normal=0.000001,0.000002,0",
                                       "plane 20,15,10 normal=-500,-1000,0"};
    struct cut cut[4];
    for (int i = 0; i < 4; i++) {
        must(interp, "turn 31 17");
        must(interp, same[i]);
        cut[i] = interp->session->now.kept.cut;
        CHECK_INT(shown_at(interp, 50), 20 * 20);
        CHECK_INT(shown_at(interp, i < 3 ? 49 : 51), 20 * 20);
        CHECK_INT(shown_at(interp, i < 3 ? 51 : 49), 0);
        must(interp, "plane none");
    }
    CHECK(memcmp(&cut[0], &cut[1], sizeof cut[0]) == 0);

    /* Seen from the left of the subject, the voxels to the left are in front. */
    must(interp, "view left; plane 20,15,10 offset=1");
    const struct cut seen = interp->session->now.kept.cut;
    must(interp, "view top; plane none; plane 20,15,10 normal=left offset=1");
    for (uint32_t x = 0; x < 40; x++) {
        const uint32_t cell = grid_cell(&interp->session->scene->grid, x, 3, 3);
        CHECK(cut_removes(&seen, &interp->session->scene->grid, cell) ==
              !is_shown(interp, x, 3, 3));
        CHECK(is_shown(interp, x, 3, 3) == (x >= 19));
    }
    CHECK(execute(interp, "plane none normal=left") == ERR_USAGE);
    CHECK(execute(interp, "plane 1,1,1 normal=0,0,0") == ERR_USAGE);
    CHECK(execute(interp, "plane 1,1,1 normal=1,2") == ERR_USAGE);
    CHECK(execute(interp, "plane 1,1,1 normal=1,2,3,") == ERR_USAGE);
    MUST_FAIL(interp, "plane 1,1,1 normal=1,2,1001", ERR_USAGE,
              "expected front|back|left|right|top|bottom or A,B,C, not all 0");
    CHECK_INT(interp->session->now.kept.cut.planes, 1);
    interp->session->scene->sides_unknown = true;
    MUST_FAIL(interp, "plane 1,1,1 normal=left", ERR_INPUT,
              "orientation is unknown; expected A,B,C");
    must(interp, "plane 1,1,1 normal=1,0,0");
    interp->session->scene->spacing_unknown = true;
    MUST_FAIL(interp, "plane 1,1,1 normal=1,0,0 offset=1", ERR_INPUT, "there are no millimetres");
}

/* A turned grid of any spacing, mirrored or not; sheared by a little every other time. */
static void place_at_random(struct interpreter *interp, uint64_t *random)
{
    struct geometry *geometry = &interp->session->geometry;
    double to_mm[3][4] = {{0}}, turn[3];
    for (int i = 0; i < 3; i++)
        turn[i] = check_below(random, 6284) / 1000.0;
    for (int a = 0; a < 3; a++) {
        double v[3] = {a == 0, a == 1, a == 2};
        v[0] += a == 1 && check_below(random, 2) ? 0.3 : 0;
        for (int i = 0; i < 3; i++) { /* around each axis in turn */
            const double p = v[(i + 1) % 3], q = v[(i + 2) % 3];
            v[(i + 1) % 3] = p * cos(turn[i]) - q * sin(turn[i]);
            v[(i + 2) % 3] = p * sin(turn[i]) + q * cos(turn[i]);
        }
        const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        geometry->spacing_nm[a] = 200000 + check_below(random, 3000000);
        for (int w = 0; w < 3; w++)
            to_mm[w][a] = v[w] / length * geometry->spacing_nm[a] / 1e6;
    }
    CHECK(geometry_place(geometry, (const double(*)[4])to_mm, ORIENTATION_SFORM));
}

BEGUN_STORY(in_oblique_scenes_a_plane_cuts_what_lies_that_way_in_the_world, begin)
{
    uint64_t random = 31;
    unsigned cut = 0, left = 0;
    for (int round = 0; round < 60 && check_failures == 0; round++) {
        const double(*to_mm)[4] = (const double(*)[4])interp->session->geometry.to_mm;
        const uint32_t at[3] = {check_below(&random, 40), check_below(&random, 30),
                                check_below(&random, 20)};
        const int digits = (int)check_below(&random, 4);
        double normal[3], length = 0;
        char line[96];
        place_at_random(interp, &random);
        for (int w = 0; w < 3; w++) {
            normal[w] = ((int)check_below(&random, 2001) - 1000) / pow(10, digits);
            length += normal[w] * normal[w];
        }
        const double offset = ((int)check_below(&random, 12001) - 6000) / 1000.0;
        snprintf(line, sizeof line, "plane %u,%u,%u normal=%.3f,%.3f,%.3f offset=%.3f", at[0],
                 at[1], at[2], normal[0], normal[1], normal[2], offset);
        must(interp, line);
        for (uint32_t c = 0; c < interp->session->scene->grid.cells; c++) {
            if (interp->session->scene->cell[c].flags & CELL_RIM)
                continue;
            const struct place p = grid_place(&interp->session->scene->grid, c);
            const double step[3] = {(double)p.x - at[0], (double)p.y - at[1], (double)p.z - at[2]};
            double beyond = -offset; /* in millimetres */
            for (int w = 0; w < 3; w++)
                for (int a = 0; a < 3; a++)
                    beyond += normal[w] * to_mm[w][a] * step[a] / sqrt(length);
            if (fabs(beyond) > 1e-4) { /* steps are rounded to nanometres */
                CHECK(border_shows(&interp->session->border, c) == (beyond < 0));
                cut += beyond > 0;
                left += beyond < 0;
            }
        }
        must(interp, "plane none");
    }
    CHECK(cut > 100000 && left > 100000);
}

BEGUN_STORY(boxes_are_taken_out_and_put_back, begin)
{
    must(interp, "view 30 40");
    const uint64_t whole = picture(interp);
    must(interp, "cut 30,20,19 10,10,5"); /* any two corners */
    CHECK(!is_shown(interp, 10, 10, 5) && !is_shown(interp, 30, 20, 19) &&
          is_shown(interp, 31, 20, 19));
    CHECK(picture(interp) != whole);
    for (int more = 1; more < CUT_BOXES_MOST; more++)
        must(interp, "cut 0,0,0 1,1,1");
    CHECK_INT(execute(interp, "cut 0,0,0 1,1,1"), ERR_LIMIT);
    MUST_MENTION(interp, "info", "cut away  8 boxes\n");
    must(interp, "cut none");
    CHECK(picture(interp) == whole);
}

STORY(a_cut_scene_is_not_interpolated)
{
    OWNED(interpreter_release) struct interpreter interp;
    CHECK(interpreter_init(&interp, NULL) == OK);
    must(&interp, "open synth:geom:20x20x20; clip axial 3-7");
    MUST_FAIL(&interp, "interpolate 2 2 2", ERR_USAGE, "a cut belongs to the present grid");
    must(&interp, "clip none; focus 3,4,5; interpolate 2 1 2");
    CHECK_INT(interp.session->now.outlook.view.focus[0], (2 * 6 - 38) * (1 << 15));
    CHECK_INT(interp.session->now.outlook.view.focus[1], (2 * 4 - 19) * (1 << 15));
}

BEGUN_STORY(a_picture_notes_what_is_cut_away_and_in_focus, begin)
{
    struct picture p;
    char line[PATH_MAX + 16], path[PATH_MAX];
    snprintf(path, sizeof path, "%s/whole.exr", folder);
    snprintf(line, sizeof line, "render %s", path);
    must(interp, line);
    CHECK(exr_read(&p, path, NULL) == OK && !picture_find(&p, "iftty:cut"));
    const char *note = picture_find(&p, "iftty:view");
    CHECK_TEXT(
        note ? note : "",
        "yaw 0 pitch 0 roll 0 degrees, zoom 1.5, 64x64 pixels, voxel 19.5,14.5,9.5 in the middle");
    picture_release(&p);
    must(interp, "view right; focus 0,0,0; clip axial 3-7; plane 20,15,10; cut 1,2,3 6,5,4");
    snprintf(path, sizeof path, "%s/open.exr", folder);
    snprintf(line, sizeof line, "render %s", path);
    must(interp, line);
    CHECK(exr_read(&p, path, NULL) == OK);
    note = picture_find(&p, "iftty:cut");
    CHECK_TEXT(note ? note : "", "kept x 0-39 y 0-29 z 3-7 plane -1048576000000 0 0 from "
                                 "-20971520000000 box 1,2,3 6,5,4");
    note = picture_find(&p, "iftty:view");
    CHECK_TEXT(note ? note : "",
               "yaw 270 pitch 0 roll 0 degrees, zoom 1.5, 64x64 pixels, voxel 0,0,0 in the middle");
    picture_release(&p);
}
