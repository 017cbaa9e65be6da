#include "image/helper.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/scan.h"
#include "image/exr.h"

enum {
    PATH_MOST = 4096,
    NAME_MOST = 4096,
    VALUE_MOST = 1 << 20,
    NOTES_MOST = 1024,
    WORDS_MOST = 4096, /* bytes of a word on what a file is */
    LINE_MOST = 96,
    SEND_PIECE = 1 << 20,
};

int image_helper_patience_ms = 60000;
uint64_t image_helper_memory_most;

struct image_helper {
    char *program;
    pid_t process;                                    /* 0: none runs */
    int fd;                                           /* our end of the socket pair, -1: none */
    enum trouble { FINE, SILENT, GONE, ODD } trouble; /* why the current request failed */
};

enum err image_helper_new(struct image_helper **out, const char *program, struct fault *fault)
{
    struct buf beside = {0};
    *out = NULL;
    enum err err = program ? OK : image_helper_default_program(&beside, fault);
    struct image_helper *helper = err ? NULL : calloc(1, sizeof *helper);
    if (helper) {
        helper->fd = -1;
        helper->program = strdup(program ? program : buf_text(&beside));
    }
    buf_release(&beside);
    if (helper && helper->program)
        *out = helper;
    else
        free(helper);
    return err || *out ? err : fault_memory(fault, "the image helper");
}

/* Ends the helper and returns how it ended, as waitpid does; -1 where that is not known. Closing
 * our end makes a helper exit; one in the middle of a request is killed. */
static int stop(struct image_helper *helper, bool may_finish)
{
    int status = -1;
    pid_t ended;
    if (helper->fd >= 0)
        close(helper->fd);
    helper->fd = -1;
    if (helper->process <= 0)
        return status;
    if (!may_finish)
        kill(helper->process, SIGKILL);
    do
        ended = waitpid(helper->process, &status, 0);
    while (ended < 0 && errno == EINTR);
    helper->process = 0;
    return ended < 0 ? -1 : status;
}

void image_helper_free(struct image_helper *helper)
{
    if (!helper)
        return;
    stop(helper, false); /* between requests it holds nothing that could be lost */
    free(helper->program);
    free(helper);
}

/* Standard input and output are the socket, errors go nowhere. A process group of its own, so that
 * an interrupt from the keyboard is not meant for it. */
static int spawn(pid_t *process, const char *program, int fd)
{
    char *const arguments[] = {(char *)(uintptr_t)program, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawn_file_actions_init(&actions); /* neither fails: they clear what they are given */
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, fd, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fd, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK |
                                              POSIX_SPAWN_SETSIGDEF);
    const int number = posix_spawn(process, program, &actions, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return number;
}

/* Before it is asked anything; only ever less than it may hold already. False, with errno, where
 * that cannot be had. */
static bool limit_memory(pid_t process)
{
    const uint64_t most = image_helper_memory_most;
    struct rlimit limit;
    if (!most)
        return true;
    if (prlimit(process, RLIMIT_DATA, NULL, &limit) != 0)
        return false;
    if (limit.rlim_max > most)
        limit.rlim_max = (rlim_t)most;
    if (limit.rlim_cur > limit.rlim_max)
        limit.rlim_cur = limit.rlim_max;
    return prlimit(process, RLIMIT_DATA, &limit, NULL) == 0;
}

/* Makes sure that a helper runs. One that has ended while nothing was asked of it costs nothing and
 * is replaced. */
static enum err start(struct image_helper *helper, struct fault *fault)
{
    int pair[2];
    if (helper->process > 0 && waitpid(helper->process, NULL, WNOHANG) != 0) {
        helper->process = 0;
        stop(helper, true);
    }
    helper->trouble = FINE;
    if (helper->process > 0)
        return OK;
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
        return fault_errno(fault, "reach the image helper", helper->program);
    const struct timeval patience = {image_helper_patience_ms / 1000,
                                     image_helper_patience_ms % 1000 * 1000};
    setsockopt(pair[0], SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    setsockopt(pair[0], SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    int number = spawn(&helper->process, helper->program, pair[1]);
    close(pair[1]);
    if (number) {
        helper->process = 0;
        close(pair[0]);
        return fault_set(fault, ERR_IO,
                         "cannot start the image helper %s: %s (.exr works without it)",
                         helper->program, strerror(number));
    }
    helper->fd = pair[0];
    if (!limit_memory(helper->process)) {
        const enum err err = fault_errno(fault, "limit the memory of", helper->program);
        stop(helper, false);
        return err;
    }
    return OK;
}

/* After trouble on the wire: ends the helper and says what it did, and with which file. */
static enum err trouble_fault(struct image_helper *helper, const char *doing, const char *path,
                              struct fault *fault)
{
    const enum trouble trouble = helper->trouble;
    const int status = stop(helper, trouble == GONE);
    char end[128] = "ended early";
    if (trouble == SILENT)
        snprintf(end, sizeof end, "did not answer for %d s and was ended",
                 (image_helper_patience_ms + 999) / 1000);
    else if (trouble == ODD)
        snprintf(end, sizeof end, "gave an answer that makes no sense and was ended");
    else if (status != -1 && WIFSIGNALED(status))
        snprintf(end, sizeof end, "died (%s)", strsignal(WTERMSIG(status)));
    else if (status != -1 && WIFEXITED(status))
        snprintf(end, sizeof end, "ended with status %d", WEXITSTATUS(status));
    return fault_set(fault, ERR_IO, "cannot %s %s: the image helper %s %s", doing, path,
                     helper->program, end);
}

/* ---- bytes to and from the helper; false sets helper->trouble ---- */

static bool transmit(struct image_helper *helper, const void *bytes, size_t length)
{
    const char *at = bytes;
    while (length > 0) {
        ssize_t n = send(helper->fd, at, length, MSG_NOSIGNAL);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            helper->trouble = errno == EAGAIN ? SILENT : GONE;
            return false;
        }
        at += n;
        length -= (size_t)n;
    }
    return true;
}

static bool receive(struct image_helper *helper, void *bytes, size_t length)
{
    char *at = bytes;
    bool reset = false;
    while (length > 0) {
        ssize_t n = recv(helper->fd, at, length, 0);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0 && errno == ECONNRESET &&
            !reset) { /* reported once; what it sent comes after that */
            reset = true;
            continue;
        }
        if (n <= 0) {
            helper->trouble = n < 0 && errno == EAGAIN ? SILENT : GONE;
            return false;
        }
        at += n;
        length -= (size_t)n;
    }
    return true;
}

static bool odd(struct image_helper *helper)
{
    helper->trouble = ODD;
    return false;
}

/* A line without its line feed. Byte by byte: lines are few and short, and nothing that follows
 * may be taken along. */
static bool receive_line(struct image_helper *helper, char line[LINE_MOST])
{
    for (size_t i = 0; i < LINE_MOST; i++) {
        if (!receive(helper, &line[i], 1))
            return false;
        if (line[i] == '\n') {
            line[i] = '\0';
            return true;
        }
    }
    return odd(helper);
}

/* `count` numbers, each after a blank but the first, up to the end of the line. */
static bool scan_numbers(const char *line, unsigned count, const int64_t most[], int64_t out[])
{
    for (unsigned i = 0; i < count; i++)
        if ((i > 0 && !scan_text(&line, " ")) || !scan_integer(&line, 0, most[i], &out[i]))
            return false;
    return *line == '\0';
}

/* ---- writing ---- */

static bool transmit_notes(struct image_helper *helper, const struct picture *picture)
{
    char line[LINE_MOST];
    for (size_t i = 0; i < picture->attributes; i++) {
        const struct attribute *note = &picture->attribute[i];
        size_t name = strlen(note->name), value = strlen(note->value);
        int length = snprintf(line, sizeof line, "%zu %zu\n", name, value);
        if (!transmit(helper, line, (size_t)length) || !transmit(helper, note->name, name) ||
            !transmit(helper, note->value, value))
            return false;
    }
    return true;
}

/* RGB over black: what is transparent fades. */
static bool transmit_pixels(struct image_helper *helper, const struct picture *picture,
                            uint8_t *piece)
{
    const size_t pixels = (size_t)picture->width * picture->height;
    for (size_t done = 0; done < pixels;) {
        size_t n = pixels - done < SEND_PIECE / 3 ? pixels - done : SEND_PIECE / 3;
        const uint8_t *rgba = picture->rgba + 4 * done;
        for (size_t i = 0; i < n; i++)
            for (size_t c = 0; c < 3; c++)
                piece[3 * i + c] = (uint8_t)((rgba[4 * i + c] * rgba[4 * i + 3] + 127) / 255);
        if (!transmit(helper, piece, 3 * n))
            return false;
        done += n;
    }
    return true;
}

/* Takes an answer of words, or leaves the line of another answer in `line`. */
static enum err receive_answer(struct image_helper *helper, char line[LINE_MOST], const char *doing,
                               const char *path, struct fault *fault)
{
    char words[400];
    int64_t length;
    if (!receive_line(helper, line))
        return trouble_fault(helper, doing, path, fault);
    const char *at = line;
    if (!scan_text(&at, "error "))
        return OK;
    const int64_t most = sizeof words - 1;
    if (!scan_numbers(at, 1, &most, &length))
        odd(helper);
    else if (receive(helper, words, (size_t)length)) {
        words[length] = '\0';
        return fault_set(fault, ERR_INPUT, "cannot %s %s: %s", doing, path, words);
    }
    return trouble_fault(helper, doing, path, fault);
}

/* Counts that the protocol cannot carry are refused before anything is sent. */
static enum err check_request(const char *doing, const char *path, const struct picture *picture,
                              struct fault *fault)
{
    size_t length = strlen(path);
    if (length == 0 || length > PATH_MOST)
        return fault_set(fault, ERR_INPUT, "a path of %zu bytes; expected 1 to %d", length,
                         PATH_MOST);
    if (picture && picture->attributes > NOTES_MOST)
        return fault_set(fault, ERR_LIMIT, "cannot %s %s: more than %d notes", doing, path,
                         NOTES_MOST);
    for (size_t i = 0; picture && i < picture->attributes; i++)
        if (strlen(picture->attribute[i].name) > NAME_MOST ||
            strlen(picture->attribute[i].value) > VALUE_MOST)
            return fault_set(fault, ERR_LIMIT, "cannot %s %s: the note \"%.40s\" is too long",
                             doing, path, picture->attribute[i].name);
    return OK;
}

bool image_movie_is_named(const char *path)
{
    return file_is_named(path, ".gif|.tif|.tiff");
}

static void forget(struct image_movie *movie)
{
    if (movie->draft.length)
        file_discard(buf_text(&movie->draft));
    buf_release(&movie->draft);
    *movie = (struct image_movie){0};
}

static enum err request_writing(const struct image_movie *movie, const struct picture *like,
                                unsigned frames, unsigned delay_ms, struct fault *fault)
{
    struct image_helper *helper = movie->helper;
    const char *path = buf_text(&movie->draft);
    char line[LINE_MOST];
    enum err err = check_request("write", path, like, fault);
    if (!err)
        err = start(helper, fault);
    if (err)
        return err;
    int length = snprintf(line, sizeof line, "write %zu %u %u %zu %u %u\n", strlen(path),
                          like->width, like->height, like->attributes, frames, delay_ms);
    if (!transmit(helper, line, (size_t)length) || !transmit(helper, path, strlen(path)) ||
        !transmit_notes(helper, like))
        return trouble_fault(helper, "write", movie->path, fault);
    return OK;
}

enum err image_movie_begin(struct image_movie *movie, struct image_helper *helper, const char *path,
                           enum file_mode mode, const struct picture *like, unsigned frames,
                           unsigned delay_ms, struct fault *fault)
{
    *movie = (struct image_movie){.helper = helper, .path = path, .mode = mode};
    enum err err = file_draft(&movie->draft, path, mode, fault);
    if (!err)
        err = request_writing(movie, like, frames, delay_ms, fault);
    if (err)
        forget(movie);
    return err;
}

enum err image_movie_add(struct image_movie *movie, const struct picture *picture,
                         struct fault *fault)
{
    uint8_t *piece = mem_array(SEND_PIECE, 1);
    enum err err = piece ? OK : fault_memory(fault, movie->path);
    if (!err && !transmit_pixels(movie->helper, picture, piece))
        err = trouble_fault(movie->helper, "write", movie->path, fault);
    free(piece);
    if (err)
        image_movie_abandon(movie);
    return err;
}

enum err image_movie_end(struct image_movie *movie, struct fault *fault)
{
    char line[LINE_MOST];
    enum err err = receive_answer(movie->helper, line, "write", movie->path, fault);
    if (!err && strcmp(line, "ok") != 0) {
        odd(movie->helper);
        err = trouble_fault(movie->helper, "write", movie->path, fault);
    }
    if (!err) {
        err = file_publish(buf_text(&movie->draft), movie->path, movie->mode, fault);
        buf_clear(&movie->draft); /* it has another name now, or is gone */
    }
    forget(movie);
    return err;
}

void image_movie_abandon(struct image_movie *movie)
{
    if (movie->helper)
        stop(movie->helper, false); /* it may be waiting for the rest of a frame */
    forget(movie);
}

enum err image_write(struct image_helper *helper, const char *path, enum file_mode mode,
                     const struct picture *picture, struct fault *fault)
{
    const char *dot = strrchr(file_name(path), '.');
    struct image_movie movie;
    if (exr_is_named(path))
        return exr_write(path, mode, picture, fault);
    if (!dot || dot == file_name(path) || dot[1] == '\0')
        return fault_set(fault, ERR_USAGE,
                         "cannot write %s: its name says no format; expected for instance .png, "
                         ".exr, .tif or .jpg",
                         path);
    enum err err = image_movie_begin(&movie, helper, path, mode, picture, 1, 0, fault);
    if (!err)
        err = image_movie_add(&movie, picture, fault);
    return err ? err : image_movie_end(&movie, fault);
}

/* ---- reading ---- */

static enum err receive_note(struct image_helper *helper, struct picture *out, struct fault *fault)
{
    static const int64_t most[2] = {NAME_MOST, VALUE_MOST};
    char line[LINE_MOST];
    int64_t length[2];
    if (!receive_line(helper, line))
        return ERR_IO;
    if (!scan_numbers(line, 2, most, length)) {
        odd(helper);
        return ERR_IO;
    }
    const size_t name = (size_t)length[0], value = (size_t)length[1];
    char *text = calloc(name + value + 2, 1); /* two strings, each with its NUL */
    if (!text)
        return fault_memory(fault, "a note on a picture");
    enum err err = ERR_IO;
    if (receive(helper, text, name) && receive(helper, text + name + 1, value))
        err = picture_note(out, text, text + name + 1, fault);
    free(text);
    return err;
}

/* Takes the rest of an answer into `out`. ERR_IO with helper->trouble set, or what `fault` says. */
typedef enum err take_answer(struct image_helper *helper, const char *line, void *out,
                             struct fault *fault);

static enum err receive_picture(struct image_helper *helper, const char *line, void *picture,
                                struct fault *fault)
{
    struct picture *out = picture;
    static const int64_t most[3] = {PICTURE_SIDE_MOST, PICTURE_SIDE_MOST, NOTES_MOST};
    int64_t number[3];
    if (!scan_text(&line, "picture ") || !scan_numbers(line, 3, most, number) || number[0] < 1 ||
        number[1] < 1) {
        odd(helper);
        return ERR_IO;
    }
    enum err err = picture_init(out, (uint32_t)number[0], (uint32_t)number[1], false, fault);
    for (int64_t i = 0; i < number[2] && !err; i++)
        err = receive_note(helper, out, fault);
    if (!err && !receive(helper, out->rgba, 4 * (size_t)out->width * out->height))
        err = ERR_IO;
    return err;
}

/* Asks `request` of a path and takes the answer. */
static enum err ask(struct image_helper *helper, const char *request, const char *path,
                    take_answer *take, void *out, struct fault *fault)
{
    char line[LINE_MOST];
    enum err err = check_request("read", path, NULL, fault);
    if (!err)
        err = start(helper, fault);
    if (err)
        return err;
    int length = snprintf(line, LINE_MOST, "%s %zu\n", request, strlen(path));
    if (!transmit(helper, line, (size_t)length) || !transmit(helper, path, strlen(path)))
        return trouble_fault(helper, "read", path, fault);
    err = receive_answer(helper, line, "read", path, fault);
    if (err)
        return err;
    err = take(helper, line, out, fault);
    if (err && helper->trouble != FINE)
        return trouble_fault(helper, "read", path, fault);
    if (err)
        stop(helper, false); /* the rest of its answer is of no use */
    return err;
}

enum err image_helper_read(struct image_helper *helper, const char *path, struct picture *out,
                           struct fault *fault)
{
    *out = (struct picture){0};
    const enum err err = ask(helper, "read", path, receive_picture, out, fault);
    if (err)
        picture_release(out);
    return err;
}

static enum err receive_word(struct image_helper *helper, char **out, size_t length,
                             struct fault *fault)
{
    *out = calloc(length + 1, 1);
    if (!*out)
        return fault_memory(fault, "what a picture is");
    return receive(helper, *out, length) ? OK : ERR_IO;
}

static enum err receive_facts(struct image_helper *helper, const char *line, void *facts,
                              struct fault *fault)
{
    struct image_facts *out = facts;
    static const int64_t most[7] = {PICTURE_SIDE_MOST, PICTURE_SIDE_MOST, INT32_MAX, NOTES_MOST,
                                    WORDS_MOST,        WORDS_MOST,        WORDS_MOST};
    int64_t number[7];
    if (!scan_text(&line, "about ") || !scan_numbers(line, 7, most, number) || number[0] < 1 ||
        number[1] < 1) {
        odd(helper);
        return ERR_IO;
    }
    out->picture.width = (uint32_t)number[0];
    out->picture.height = (uint32_t)number[1];
    out->frames = (unsigned)number[2];
    char **const word[3] = {&out->format, &out->type, &out->channels};
    enum err err = OK;
    for (int i = 0; i < 3 && !err; i++)
        err = receive_word(helper, word[i], (size_t)number[4 + i], fault);
    for (int64_t i = 0; i < number[3] && !err; i++)
        err = receive_note(helper, &out->picture, fault);
    return err;
}

enum err image_helper_about(struct image_helper *helper, const char *path, struct image_facts *out,
                            struct fault *fault)
{
    *out = (struct image_facts){0};
    const enum err err = ask(helper, "about", path, receive_facts, out, fault);
    if (err)
        image_facts_release(out);
    return err;
}

void image_facts_release(struct image_facts *facts)
{
    picture_release(&facts->picture);
    free(facts->format);
    free(facts->type);
    free(facts->channels);
    *facts = (struct image_facts){0};
}

enum err image_helper_default_program(struct buf *out, struct fault *fault)
{
    const enum err err = file_program_folder(out, fault);
    if (err)
        return err;
    buf_add_text(out, "/iftty-image");
    return out->failed ? fault_memory(fault, "a file name") : OK;
}
