/* SPDX-License-Identifier: MIT */
/* Checks on a stranger's journal: SHA-256 and the proof of a scene, names below a folder, and
 * confinement by the kernel. */
#include <arpa/inet.h>
#include <errno.h>
#include <fcntl.h>
#include <nettle/sha2.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include "base/confine.h"
#include "base/file.h"
#include "base/hash.h"
#include "interpreting.h"
#include "tests/check_main.h"
#include "command/trust.h"
#include "engine/scene.h"
#include "image/image_helper.h"
#include "tests/folder.h"

/* ---- SHA-256 ---- */

STORY(the_digest_of_the_standard)
{
    char hex[SHA256_HEX];
    struct sha256_ctx sha;
    sha256_init(&sha);
    sha256_update(&sha, 3, (const uint8_t *)"abc");
    sha256_hex(hex, &sha, SHA256_DIGEST_SIZE);
    CHECK_TEXT(hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

/* ---- the proof of a scene ---- */

static struct scene *small_scene(void)
{
    static const uint32_t size[3] = {37, 5, 3};
    struct scene *scene = NULL;
    CHECK_INT(scene_new(&scene, size, NULL, NULL, NULL), OK);
    uint64_t random = 3;
    for (uint32_t z = 0; scene && z < size[2]; z++)
        for (uint32_t y = 0; y < size[1]; y++)
            for (uint32_t x = 0; x < size[0]; x++)
                scene->cell[grid_cell(&scene->grid, x, y, z)].intensity =
                    (uint16_t)check_random(&random);
    return scene;
}

/* Compute the proof byte by byte, as described in engine/scene.h. */
static void plain_proof(char hex[SHA256_HEX], const struct scene *scene)
{
    struct sha256_ctx sha;
    sha256_init(&sha);
    for (int i = 0; i < 24; i++) {
        const uint32_t of = i < 12 ? scene->grid.size[i / 4] : scene->spacing_nm[i / 4 - 3];
        sha256_update(&sha, 1, &(uint8_t){(uint8_t)(of >> 8 * (i % 4))});
    }
    for (int a = 0; a < 3; a++)
        sha256_update(&sha, 1,
                      &(uint8_t){(uint8_t)(2 * scene->world_axis[a] + (scene->world_sign[a] < 0))});
    sha256_update(&sha, 1, (const uint8_t *)"");
    for (uint32_t z = 0; z < scene->grid.size[2]; z++)
        for (uint32_t y = 0; y < scene->grid.size[1]; y++)
            for (uint32_t x = 0; x < scene->grid.size[0]; x++) {
                const uint16_t v = scene->cell[grid_cell(&scene->grid, x, y, z)].intensity;
                sha256_update(&sha, 2, (uint8_t[2]){(uint8_t)v, (uint8_t)(v >> 8)});
            }
    sha256_hex(hex, &sha, SHA256_DIGEST_SIZE);
}

STORY(the_proof_is_what_its_header_says)
{
    OWNED(scene_drop) struct scene *scene = small_scene();
    char proof[SHA256_HEX], expected[SHA256_HEX];
    if (!scene)
        return;
    scene->spacing_nm[1] = 1234567;
    scene->world_axis[0] = 2;
    scene->world_axis[2] = 0;
    scene->world_sign[1] = -1;
    scene_proof(proof, scene);
    plain_proof(expected, scene);
    CHECK_TEXT(proof, expected);
}

STORY(any_change_of_a_scene_changes_its_proof)
{
    OWNED(scene_drop) struct scene *scene = small_scene();
    char before[SHA256_HEX], after[SHA256_HEX];
    if (!scene)
        return;
    scene_proof(before, scene);
    for (uint32_t x = 0; x < 37; x++) {
        struct cell *cell = &scene->cell[grid_cell(&scene->grid, x, x % 5, x % 3)];
        cell->intensity ^= 1;
        scene_proof(after, scene);
        CHECK(strcmp(before, after) != 0);
        cell->intensity ^= 1;
    }
    scene->spacing_nm[2]++;
    scene_proof(after, scene);
    CHECK(strcmp(before, after) != 0);
    scene->spacing_nm[2]--;
    scene->world_sign[0] = -1;
    scene_proof(after, scene);
    CHECK(strcmp(before, after) != 0);
    scene->world_sign[0] = 1;
    scene->cell[grid_cell(&scene->grid, 1, 1, 1)].label = 7; /* not part of the scene */
    scene_proof(after, scene);
    CHECK_TEXT(after, before);
}

/* ---- names below a folder ---- */

static char top[FOLDER_LENGTH];

static const char *below_top(const char *name)
{
    static char path[4][200];
    static unsigned turn;
    char *at = path[turn++ % 4];
    snprintf(at, sizeof path[0], "%s/%s", top, name);
    return at;
}

static bool make_top(void)
{
    bool fine = make_folder(top, "trust") && mkdir(below_top("in"), 0777) == 0 &&
                mkdir(below_top("in/deep"), 0777) == 0 && mkdir(below_top("out"), 0777) == 0;
    fine = fine && mkdir(below_top("far"), 0777) == 0;
    static const char *const file[] = {"in/a",      "in/deep/b", "in/..c",    "out/secret",
                                       "far/a.hdr", "far/a.img", "far/b.img", "far/c.nii",
                                       "far/d.mhd", "in/q.hdr",  "in/r.hdr"};
    for (size_t i = 0; i < sizeof file / sizeof *file; i++)
        fine = fine && file_write(below_top(file[i]), "x", 1, FILE_KEEP, NULL) == OK;
    static const char *const link[][2] = {
        {"../out/secret", "in/up"},   {"../out", "in/folder"},       {"/dev/zero", "in/zero"},
        {"round", "in/round"},        {"../../in/a", "in/deep/c"},   {"nothing", "in/dangling"},
        {"../far/c.nii", "in/scene"}, {"../far/a.hdr", "in/p.hdr"},  {"../out/pipe", "in/p.img"},
        {"../far/d.mhd", "in/d"},     {"../out/secret", "in/q.img"}, {"../far/b.img", "in/r.img"},
        {"../far/a.hdr", "in/s.hdr"}, {"../far/a.img", "in/s.img"}};
    for (size_t i = 0; i < sizeof link / sizeof *link; i++)
        fine = fine && symlink(link[i][0], below_top(link[i][1])) == 0;
    return fine && symlink("deep/b", below_top("in/inner")) == 0 &&
           mkfifo(below_top("in/pipe"), 0666) == 0 && mkfifo(below_top("out/pipe"), 0666) == 0;
}

STORY(a_name_is_found_below_its_folder_and_nowhere_else)
{
    static const struct {
        const char *name;
        enum path_kind answer, stepwise;
    } expected[] = {
        {"a", PATH_IS_FILE, PATH_IS_FILE},
        {"./a", PATH_IS_FILE, PATH_IS_FILE},
        {"deep/b", PATH_IS_FILE, PATH_IS_FILE},
        {"deep//b", PATH_IS_FILE, PATH_IS_FILE},
        {"..c", PATH_IS_FILE, PATH_IS_FILE},
        {"inner", PATH_IS_FILE, PATH_IS_OUTSIDE}, /* without openat2 no link is followed */
        {"deep", PATH_IS_FOLDER, PATH_IS_FOLDER},
        {"pipe", PATH_IS_SPECIAL, PATH_IS_SPECIAL},
        {"none", PATH_IS_MISSING, PATH_IS_MISSING},
        {"a/b", PATH_IS_MISSING, PATH_IS_MISSING},
        {"dangling", PATH_IS_MISSING, PATH_IS_OUTSIDE},
        {"", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"/etc/passwd", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"..", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"../out/secret", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"deep/../../out/secret", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"deep/..", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"up", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"folder/secret", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"zero", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"round", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
        {"deep/c", PATH_IS_OUTSIDE, PATH_IS_OUTSIDE},
    };
    CHECK(make_top());
    char folder[200];
    snprintf(folder, sizeof folder, "%s", below_top("in"));
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        path_without_openat2 = false;
        const enum path_kind answer = path_kind_below(folder, expected[i].name);
        path_without_openat2 = true;
        const enum path_kind stepwise = path_kind_below(folder, expected[i].name);
        if (answer != expected[i].answer || stepwise != expected[i].stepwise)
            printf("# %s: %d and %d\n", expected[i].name, answer, stepwise);
        /* without openat2 the kernel answers like the stepwise search */
        CHECK(answer == expected[i].answer || answer == expected[i].stepwise);
        CHECK(stepwise == expected[i].stepwise);
    }
    path_without_openat2 = false;
    CHECK(remove_folder(top) == 0);
}

STORY(outside_only_regular_files_are_found)
{
    static const struct {
        const char *name;
        bool leads;
    } expected[] = {
        {"a", false}, /* below the folder */
        {"inner", false},
        {"none", false},
        {"deep", false},
        {"pipe", false},
        {"up", true},
        {"scene", true},
        {"folder/secret", true},
        {"../out/secret", true},
        {"../far/a.hdr", true}, /* a pair */
        {"p.hdr", false},       /* its other file is a pipe */
        {"q.hdr", false},       /* a stranger's header next to a link could choose bytes */
        {"q.img", false},
        {"r.img", false},
        {"s.hdr", true},
        {"../far/b.img", false},
        {"d", true},
        {"../far/d.mhd", false}, /* its voxels may be in other files */
        {"../out", false},
        {"../out/pipe", false},
        {"../out/none", false},
        {"folder", false},
        {"zero", false},
        {"/dev/zero", false},
        {"/", false},
        {"round", false},
        {"~/secret", true},
        {"~/none", false},
        {"", false},
    };
    CHECK(make_top());
    OWNED(buf_release) struct buf path = {0};
    char journal[200];
    snprintf(journal, sizeof journal, "%s", below_top("in/j.iftty"));
    setenv("HOME", below_top("out"), 1);
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        const bool leads = trust_find_outside(&path, journal, "/nowhere", expected[i].name);
        if (leads != expected[i].leads)
            printf("# %s: %d\n", expected[i].name, leads);
        CHECK(leads == expected[i].leads);
    }
    unsetenv("HOME");
    CHECK(remove_folder(top) == 0);
}

/* ---- what the kernel keeps out ---- */

static bool may_open(const char *path, int flags)
{
    const int fd = open(path, flags, 0666);
    if (fd >= 0)
        close(fd);
    return fd >= 0;
}

static bool may_connect(void)
{
    struct sockaddr_in there = {.sin_family = AF_INET, .sin_port = htons(9)};
    there.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int fd = socket(AF_INET, SOCK_STREAM, 0);
    const bool is_denied =
        fd >= 0 && connect(fd, (struct sockaddr *)&there, sizeof there) != 0 && errno == EACCES;
    if (fd >= 0)
        close(fd);
    return !is_denied;
}

/* Run in a child process, since confinement is final: a bit for each unexpected result. */
static int wrongs_while_confined(void)
{
    const char *written[] = {below_top("out"), NULL};
    char journal[200], scene[200], outside[200];
    snprintf(outside, sizeof outside, "%s", below_top("in/scene"));
    snprintf(journal, sizeof journal, "%s", below_top("in/j.iftty"));
    snprintf(scene, sizeof scene, "%s", below_top("far/a.hdr"));
    char *journals[] = {journal};
    const struct trust_places places = {.journal = journals,
                                        .journals = 1,
                                        .scenes = "/nowhere",
                                        .written = written,
                                        .given = (const char *[]){outside, scene, NULL}};
    const bool is_confined = trust_confine(&places);
    int wrong = !is_confined;
    wrong |= !may_open(below_top("in/a"), O_RDONLY) << 1;
    wrong |= !may_open(below_top("far/a.hdr"), O_RDONLY) << 1; /* the scene, a pair */
    wrong |= !may_open(below_top("far/a.img"), O_RDONLY) << 1;
    wrong |= !may_open(below_top("in/scene"), O_RDONLY) << 1; /* a scene with a proof */
    wrong |= may_open(below_top("in/d"), O_RDONLY) << 5;
    wrong |= may_open(below_top("in/a"), O_WRONLY) << 2;
    wrong |= may_open(below_top("in/new"), O_WRONLY | O_CREAT) << 3;
    wrong |= !may_open(below_top("out/new"), O_WRONLY | O_CREAT | O_TRUNC) << 4;
    wrong |= may_open("/etc/passwd", O_RDONLY) << 5;
    wrong |= may_open(below_top("far/b.img"), O_RDONLY) << 5;
    wrong |= (unlink(below_top("in/a")) == 0) << 6;
    wrong |= (confine_version() >= 4 && may_connect()) << 7;
    return wrong;
}

STORY(a_confined_process_reaches_only_its_places)
{
    int status = 0;
    if (!confine_version()) {
        SKIP("the kernel has no Landlock");
        return;
    }
    CHECK(make_top());
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0)
        _exit(wrongs_while_confined());
    CHECK(child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status));
    CHECK_INT(WEXITSTATUS(status), 0);
    CHECK(remove_folder(top) == 0);
}

/* The last story: limits hold until the process ends. */
STORY(limits_stop_commands_of_an_interpreter_that_was_there_before_them)
{
    OWNED(interpreter_release) struct interpreter interp;
    struct limits limits;
    OWNED(replay_report_release) struct replay_report report = {0};
    char folder[FOLDER_LENGTH], script[FILE_LENGTH];
    CHECK(make_folder(folder, "limits"));
    snprintf(script, sizeof script, "%s/script", folder);
    CHECK(file_write(script, "auto on\n", 8, FILE_KEEP, NULL) == OK);
    begin_interpreter(&interp);
    CHECK(limits_read(&limits, NULL, "1h", NULL, NULL) == OK && image_helper_memory_most == 0);
    limits_begin(&limits);
    CHECK(image_helper_memory_most >= 512000000);
    CHECK(replay_file(&interp, script, 0, 0, NULL, NULL, &report, &fault) == OK);
    CHECK_INT(report.executed, 1);
    CHECK(interp.session->watch && interp.session->watch == limits_watch());
    reply_release(&reply);
    CHECK(remove_folder(folder) == 0);
}
