/* SPDX-License-Identifier: MIT */
/* Answers of the helpers, of any bytes: their words and numbers are trusted as little as the files.
 * The first byte selects the request; a rejected request has one line of message.
 *
 * No helper is started: what the C library would do for it is done here, with the bytes as its
 * answer. */
#include "tests/fuzz/fuzz.h"

#include <spawn.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "image/coprocess.h"
#include "image/image_helper.h"
#include "image/volume.h"
#include "image/volume_helper.h"

/* ---- the helper ---- */

enum { NOBODY = 1 << 22 }; /* a number that no process has */

static const uint8_t *answer;
static size_t answer_length;
static int socket_given = -1, socket_kept = -1;

int posix_spawn_file_actions_adddup2(posix_spawn_file_actions_t *actions, int fd, int as)
{
    (void)actions;
    if (as == STDIN_FILENO)
        socket_given = fd;
    return 0;
}

/* The request remains in the socket. */
int posix_spawn(pid_t *process, const char *path, const posix_spawn_file_actions_t *actions,
                const posix_spawnattr_t *attributes, char *const argv[], char *const envp[])
{
    (void)path, (void)actions, (void)attributes, (void)argv;
    HOLDS(!*envp);
    socket_kept = dup(socket_given);
    HOLDS(socket_kept >= 0);
    HOLDS(send(socket_kept, answer, answer_length, MSG_DONTWAIT) == (ssize_t)answer_length);
    HOLDS(shutdown(socket_kept, SHUT_WR) == 0);
    *process = NOBODY;
    return 0;
}

pid_t waitpid(pid_t process, int *status, int how)
{
    HOLDS(process == NOBODY);
    if (how & WNOHANG)
        return 0;
    close(socket_kept);
    *status = 0;
    return process;
}

int kill(pid_t process, int number)
{
    (void)number;
    HOLDS(process == -NOBODY);
    return 0;
}

int prlimit(__pid_t process, enum __rlimit_resource resource, const struct rlimit *limit,
            struct rlimit *before)
{
    (void)resource, (void)limit;
    HOLDS(process == NOBODY);
    if (before)
        *before = (struct rlimit){RLIM_INFINITY, RLIM_INFINITY};
    return 0;
}

/* ---- clients ---- */

static void check(enum err err, const struct fault *fault)
{
    HOLDS(!err || (fault->text[0] && !strpbrk(fault->text, "\n\r\033")));
}

static void check_notes(const struct picture *picture)
{
    for (size_t i = 0; i < picture->attributes; i++)
        HOLDS(picture->attribute[i].name && picture->attribute[i].value);
}

static void read_picture(struct image_helper *helper)
{
    OWNED(picture_release) struct picture picture = {0};
    struct fault fault = {.text = ""};
    const enum err err = image_helper_read(helper, "a.png", &picture, &fault);
    check(err, &fault);
    HOLDS(!err == (picture.rgba != NULL));
    check_notes(&picture);
}

static void ask_about(struct image_helper *helper)
{
    OWNED(image_facts_release) struct image_facts facts = {0};
    struct fault fault = {.text = ""};
    const enum err err = image_helper_about(helper, "a.png", &facts, &fault);
    check(err, &fault);
    HOLDS(!err == (facts.channels != NULL));
    check_notes(&facts.picture);
}

static void write_picture(struct image_helper *helper)
{
    OWNED(picture_release) struct picture picture = {0};
    struct fault fault = {.text = ""};
    HOLDS(picture_init(&picture, 3, 2, 0, NULL) == OK);
    const enum err err = image_write(helper, "/nowhere/a.png", FILE_REPLACE, &picture, &fault);
    check(err, &fault);
    HOLDS(err); /* no file was written, for any answer */
}

static void ask_image_helper(void (*ask)(struct image_helper *helper))
{
    OWNED(image_helper_drop) struct image_helper *helper = NULL;
    HOLDS(image_helper_new(&helper, "helper", NULL) == OK);
    ask(helper);
}

static void check_lines(const char *lines)
{
    for (; *lines; lines++)
        HOLDS(*lines == '\n' || (*lines >= ' ' && *lines <= '~'));
}

static void read_volume(void)
{
    static const uint8_t file[] = "NRRD0004\n";
    OWNED(volume_release) struct volume volume = {0};
    OWNED(buf_release) struct buf list = {0};
    struct fault fault = {.text = ""};
    const struct volume_choice choice = {.list = &list};
    const enum err err =
        volume_read(&volume, fuzz_file(file, sizeof file - 1), &choice, NULL, &fault);
    check(err, &fault);
    HOLDS(!err == (volume.intensity != NULL));
    HOLDS(err || (volume.size[0] && volume.size[1] && volume.size[2]));
    check_lines(volume.notes);
    check_lines(buf_text(&list));
}

void fuzz_helper(const uint8_t *bytes, size_t length)
{
    static void (*const asking[])(struct image_helper *) = {read_picture, ask_about, write_picture};
    if (length == 0 || length > 60000) /* the capacity of a socket */
        return;
    answer = bytes + 1;
    answer_length = length - 1;
    volume_helper_program = "helper";
    if (bytes[0] % 4 < 3)
        ask_image_helper(asking[bytes[0] % 4]);
    else
        read_volume();
}
