/* SPDX-License-Identifier: MIT */
#include "tui/tmux.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/choice.h"
#include "base/clock.h"

#define FORMAT "#{client_termtype}|#{client_termfeatures}|#{allow-passthrough}"

enum { ANSWER_MOST = 1024, LIMIT_MS = 500 };

void tmux_read(struct tmux_client *client, const char *answer)
{
    struct choice field = {0};
    *client = (struct tmux_client){0};
    if (!choice_next(&field, &answer))
        return;
    if (field.length < sizeof client->name)
        memcpy(client->name, field.word, field.length);
    if (!choice_next(&field, &answer))
        return;
    for (const char *at = field.word, *end = at + field.length; at < end;) {
        const size_t length = strcspn(at, ",|");
        client->has_sixel |= length == 5 && memcmp(at, "sixel", 5) == 0;
        at += length + 1;
    }
    /* "0" and "1" in versions before 3.4 */
    static const enum tmux_passing passing[] = {TMUX_PASSES_NOTHING, TMUX_PASSES_NOTHING,
                                                TMUX_PASSES, TMUX_PASSES, TMUX_PASSES};
    char word[8] = {0};
    const size_t length = strcspn(answer, "\r\n");
    memcpy(word, answer, length < sizeof word ? length : 0);
    const int found = choice_find("off|0|on|1|all", word);
    client->passing = found < 0 ? TMUX_PASSING_UNKNOWN : passing[found];
}

/* Read until the end of the file; return the number of bytes. */
static size_t read_answer(int from, char answer[ANSWER_MOST])
{
    const uint64_t end_ns = clock_ns() + LIMIT_MS * UINT64_C(1000000);
    size_t length = 0;
    for (;;) {
        struct pollfd ready = {.fd = from, .events = POLLIN};
        const uint64_t now_ns = clock_ns();
        if (now_ns >= end_ns || length + 1 == ANSWER_MOST)
            return length;
        if (poll(&ready, 1, (int)((end_ns - now_ns) / 1000000) + 1) <= 0)
            continue; /* an interruption, or the end of the time */
        const ssize_t n = read(from, answer + length, ANSWER_MOST - 1 - length);
        if (n == 0 || (n < 0 && errno != EINTR))
            return length;
        length += n > 0 ? (size_t)n : 0;
    }
}

bool tmux_ask(struct tmux_client *client)
{
    char *const word[] = {(char[]){"tmux"}, (char[]){"display-message"}, (char[]){"-p"},
                          (char[]){FORMAT}, NULL};
    char answer[ANSWER_MOST];
    posix_spawn_file_actions_t files;
    pid_t process;
    int end[2];
    size_t length = 0;
    *client = (struct tmux_client){0};
    if (!getenv("TMUX") || pipe2(end, O_CLOEXEC) != 0)
        return false;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&files, end[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    const int number = posix_spawnp(&process, word[0], &files, NULL, word, environ);
    posix_spawn_file_actions_destroy(&files);
    close(end[1]);
    if (number == 0) {
        length = read_answer(end[0], answer);
        kill(process, SIGKILL); /* it has ended, or does not answer */
        while (waitpid(process, NULL, 0) < 0 && errno == EINTR)
            ;
    }
    close(end[0]);
    answer[length] = '\0';
    tmux_read(client, answer);
    return length > 0;
}
