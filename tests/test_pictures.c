/* Pictures as commands make them: what they hold, and how they come to the disk. */
#include <limits.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "command/drive.h"
#include "image/exr.h"
#include "session/export.h"
#include "tests/check.h"

static char folder[] = "/tmp/iftty-pictures-XXXXXX";
static struct reply reply;
static struct fault fault;

static enum err execute(struct desk *desk, const char *line)
{
    fault = (struct fault){.text = ""};
    return desk_execute(desk, line, &reply, &fault);
}

static void must(struct desk *desk, const char *line)
{
    if (!CHECK(execute(desk, line) == OK))
        printf("#   %s: %s\n", line, fault.text);
}

static void is_refused(struct desk *desk, const char *line, enum err code, const char *words)
{
    CHECK_INT(execute(desk, line), code);
    CHECK_HAS(fault.text, words);
}

/* The helper lies above the folder of the test programs. */
static void begin_desk(struct desk *desk)
{
    char program[PATH_MAX];
    ssize_t n = readlink("/proc/self/exe", program, sizeof program - 32);
    CHECK(desk_init(desk, NULL) == OK && n > 0);
    program[n > 0 ? n : 0] = '\0';
    for (int up = 0; up < 2 && strrchr(program, '/'); up++)
        *strrchr(program, '/') = '\0';
    strcat(program, "/iftty-image");
    image_helper_free(desk->helper);
    CHECK(image_helper_new(&desk->helper, program, NULL) == OK);
}

static void begin_with_object(struct desk *desk)
{
    begin_desk(desk);
    must(desk, "open synth:geom:40x40x20");
    must(desk, "seed 20,20,10 1 radius=3");
    must(desk, "seed 1,1,1 0");
    must(desk, "size 90 70");
    must(desk, "run");
    must(desk, "render");
}

/* ---- what a picture holds ---- */

STORY(normals_are_turned_to_the_world)
{
    /* voxel x runs Superior, y Left, z Posterior */
    static const struct scene scene = {.world_axis = {2, 0, 1}, .world_sign = {1, -1, -1}};
    static const int16_t normal[2][4] = {{16384, 0, 0, 7}, {0, 8192, -3, 7}};
    float out[2][3];
    export_normals_to_world(out[0], normal[0], 2, &scene);
    CHECK(out[0][0] == 0 && out[0][1] == 0 && out[0][2] == 1);
    CHECK(out[1][0] == -0.5f && out[1][1] == 3 / 16384.0f && out[1][2] == 0);
}

STORY(an_exr_in_tiles_holds_what_one_in_lines_holds)
{
    struct desk desk;
    struct picture lines, tiles;
    begin_with_object(&desk);
    must(&desk, "render lines.exr");
    must(&desk, "render same.exr layout=lines");
    must(&desk, "render tiles.exr layout=tiled");
    CHECK_INT(exr_read(&lines, "lines.exr", NULL), OK);
    CHECK_INT(exr_read(&tiles, "tiles.exr", NULL), OK);
    CHECK(!lines.tiled && tiles.tiled);
    const size_t bytes = (size_t)4 * 90 * 70;
    CHECK(memcmp(lines.rgba, tiles.rgba, bytes) == 0);
    CHECK(memcmp(lines.depth_mm, tiles.depth_mm, bytes) == 0);
    CHECK(memcmp(lines.label, tiles.label, bytes) == 0);
    CHECK(memcmp(lines.voxel, tiles.voxel, bytes) == 0);
    CHECK(memcmp(lines.normal, tiles.normal, 3 * bytes) == 0);
    is_refused(&desk, "render a.png layout=tiled", ERR_USAGE, "only an .exr has lines or tiles");
    is_refused(&desk, "render layout=tiled", ERR_USAGE, "only an .exr has lines or tiles");
    CHECK(!file_exists("a.png"));
    picture_release(&lines);
    picture_release(&tiles);
    desk_release(&desk);
}

STORY(normals_are_unit_vectors_that_face_the_viewer)
{
    static const struct {
        const char *view;
        int axis, sign;
    } side[] = {{"view front", 1, 1}, {"view left", 0, -1}, {"view top", 2, 1}};
    struct desk desk;
    struct picture p;
    begin_with_object(&desk);
    for (size_t k = 0; k < 3; k++) {
        double towards = 0;
        size_t seen = 0, odd = 0;
        must(&desk, side[k].view);
        must(&desk, "render normals.exr replace=yes");
        CHECK_INT(exr_read(&p, "normals.exr", NULL), OK);
        for (size_t i = 0; i < (size_t)p.width * p.height; i++) {
            const float *n = p.normal + 3 * i;
            const double square = (double)(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
            const bool shows = p.label[i] != 0;
            odd += shows ? square < 0.998 || square > 1.002 : square > 0;
            seen += shows;
            towards += (double)n[side[k].axis] * side[k].sign;
        }
        CHECK(seen > 100);
        CHECK_INT(odd, 0);
        CHECK(towards > 0.5 * (double)seen);
        picture_release(&p);
    }
    desk_release(&desk);
}

STORY(a_picture_says_what_it_is_of)
{
    struct desk desk;
    struct picture p;
    begin_desk(&desk);
    CHECK_INT(desk_create_journal(&desk, "notes.iftty", &fault), OK);
    must(&desk, "open synth:geom:40x40x20");
    must(&desk, "view 30 20 10");
    char chain[64], scene[32];
    snprintf(chain, sizeof chain, "%s", journal_chain(desk.journal));
    snprintf(scene, sizeof scene, "%016llx", (unsigned long long)desk.session.scene_digest);
    must(&desk, "render notes.exr");
    CHECK_INT(exr_read(&p, "notes.exr", NULL), OK);
    const struct {
        const char *name, *value;
    } note[] = {{"Software", "iftty " PROGRAM_VERSION},
                {"iftty:scene-name", "synth:geom:40x40x20"},
                {"iftty:scene", scene},
                {"iftty:journal", "notes.iftty"},
                {"iftty:chain", chain}};
    for (size_t i = 0; i < sizeof note / sizeof note[0]; i++) {
        const char *value = picture_find(&p, note[i].name);
        CHECK_TEXT(value ? value : note[i].name, note[i].value);
    }
    const char *view = picture_find(&p, "iftty:view");
    CHECK_HAS(view ? view : "", "30000 20000 10000 zoom ");
    const char *look = picture_find(&p, "iftty:look");
    CHECK_HAS(look ? look : "", "surface light ");
    picture_release(&p);
    desk_release(&desk);
}

int main(void)
{
    if (!mkdtemp(folder) || chdir(folder) != 0)
        return 1;
    int status = RUN_STORIES(
        TELL(normals_are_turned_to_the_world), TELL(an_exr_in_tiles_holds_what_one_in_lines_holds),
        TELL(normals_are_unit_vectors_that_face_the_viewer), TELL(a_picture_says_what_it_is_of));
    reply_release(&reply);
    char command[PATH_MAX];
    snprintf(command, sizeof command, "rm -rf '%s'", folder);
    return status | (system(command) != 0);
}
