#include "verify/builds.h"

#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <limits.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/folder.h"
#include "base/mem.h"
#include "sandbox/limits.h"

enum { LOOK_MS = 20, ERRORS_MOST = 1 << 20 };

/* The path from the root, since each build works where the journal lies. */
static enum err whole_path(struct buf *out, const char *path, struct fault *fault)
{
    char whole[PATH_MAX];
    if (!realpath(path, whole))
        return fault_errno(fault, "find", path);
    buf_add_text(out, whole);
    return out->failed ? fault_memory(fault, "a path") : OK;
}

static enum err prepare(struct builds *b, struct side *side, const char *name, const char *program,
                        struct fault *fault)
{
    enum err err = whole_path(&side->program, program, fault);
    buf_printf(&side->folder, "%s/%s", buf_text(&b->folder), name);
    buf_printf(&side->journal, "%s/commands.iftty", buf_text(&side->folder));
    buf_printf(&side->errors, "%s/errors", buf_text(&side->folder));
    if (!err && (side->folder.failed || side->journal.failed || side->errors.failed))
        err = fault_memory(fault, "a path");
    return err ? err : file_make_folder(buf_text(&side->folder), fault);
}

/* In the process that becomes the program: nothing but what may be done there. */
static _Noreturn void become(const struct side *side, const char *place, char *const *argument)
{
    const int nothing = open("/dev/null", O_RDWR),
              errors = open(buf_text(&side->errors), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (nothing < 0 || errors < 0 || dup2(nothing, 0) < 0 || dup2(nothing, 1) < 0 ||
        dup2(errors, 2) < 0 || chdir(place) != 0)
        _exit(127);
    execv(argument[0], argument);
    _exit(127);
}

static enum err begin(struct side *side, const char *word, const char *commands, const char *scene,
                      struct fault *fault)
{
    struct buf place = {0};
    file_folder(&place, commands);
    const char *argument[] = {buf_text(&side->program),
                              word,
                              commands,
                              "--journal",
                              buf_text(&side->journal),
                              "--out",
                              buf_text(&side->folder),
                              scene ? "--scene" : NULL,
                              scene,
                              NULL};
    side->process = place.failed ? -1 : fork();
    if (side->process == 0)
        become(side, buf_text(&place), (char *const *)(uintptr_t)argument);
    buf_release(&place);
    if (side->process > 0)
        return OK;
    side->process = 0;
    return fault_errno(fault, "start", buf_text(&side->program));
}

/* Where whoever started us has nobody wait for processes, one that is gone left no status. */
static bool has_ended(struct side *side)
{
    const pid_t process = waitpid(side->process, &side->status, WNOHANG);
    return process == side->process || (process < 0 && errno == ECHILD);
}

static uint64_t written_bytes;

static int add_written(const char *path, const struct stat *status, int type, struct FTW *where)
{
    (void)path, (void)where;
    written_bytes += type == FTW_F ? (uint64_t)status->st_size : 0;
    return 0;
}

/* What the builds hold now, and have written by now. */
static void count(struct builds *b)
{
    uint64_t held = 0;
    for (int i = 0; i < 2; i++)
        held += b->side[i].process ? mem_held_by(b->side[i].process) : 0;
    written_bytes = 0;
    nftw(buf_text(&b->folder), add_written, 8, FTW_PHYS);
    limits_count(held, written_bytes);
}

/* Until both have ended; the watch ends them. */
static enum err wait_for_both(struct builds *b, struct watch *watch, struct fault *fault)
{
    while (b->side[0].process || b->side[1].process) {
        for (int i = 0; i < 2; i++)
            if (b->side[i].process && has_ended(b->side + i))
                b->side[i].process = 0;
        count(b);
        if (watch_fault(watch, NULL))
            return fault_set(fault, ERR_CANCELLED, "cancelled; the two builds were ended");
        poll(NULL, 0, LOOK_MS);
    }
    return OK;
}

/* What became of one that did not carry everything out. */
static enum err judge(struct side *side, const char *name, struct fault *fault)
{
    struct buf errors = {0};
    if (!file_exists(buf_text(&side->journal)))
        return fault_set(fault, ERR_IO, "%s could not be started, or wrote no journal", name);
    if (WIFEXITED(side->status) && WEXITSTATUS(side->status) == 0)
        return OK;
    buf_add_text(&side->words, "#   ended    ");
    buf_add_safe(&side->words, name, strlen(name));
    if (WIFSIGNALED(side->status))
        buf_printf(&side->words, " by signal %d (%s)", WTERMSIG(side->status),
                   strsignal(WTERMSIG(side->status)));
    else
        buf_printf(&side->words, " with status %d", WEXITSTATUS(side->status));
    if (!file_read(&errors, buf_text(&side->errors), ERRORS_MOST, NULL) && errors.length) {
        buf_add_text(&side->words, ": ");
        buf_add_safe(&side->words, buf_text(&errors), strcspn(buf_text(&errors), "\n"));
    }
    buf_add_char(&side->words, '\n');
    buf_release(&errors);
    return side->words.failed ? fault_memory(fault, "a report") : OK;
}

static enum err run_both(struct builds *b, const struct bisect_builds *how, const char *commands,
                         const char *scene, struct fault *fault)
{
    const struct buf nothing = {0};
    const char *const program[] = {buf_text(&b->side[0].program), buf_text(&b->side[1].program),
                                   NULL};
    enum err err = OK;
    if (how->begin)
        err = how->begin(how->context, buf_text(&b->folder), program, fault);
    if (err)
        return err;
    limits_will_write();
    for (int i = 0; !err && i < 2; i++)
        err = begin(b->side + i, how->word, commands, scene, fault);
    if (!err)
        err = wait_for_both(b, how->watch, fault);
    return limits_judge(err, &nothing, fault);
}

enum err builds_run(struct builds *b, const struct bisect_builds *how, struct fault *fault)
{
    struct buf commands = {0}, scene = {0};
    *b = (struct builds){0};
    enum err err = whole_path(&commands, how->journal, fault);
    if (!err && how->scene_path && file_exists(how->scene_path))
        err = whole_path(&scene, how->scene_path, fault);
    if (!err)
        err = folder_fresh(&b->folder, NULL, fault);
    if (!err)
        err = prepare(b, b->side, "this", "/proc/self/exe", fault);
    if (!err)
        err = prepare(b, b->side + 1, "other", how->other, fault);
    const char *at = scene.length ? buf_text(&scene) : how->scene_path;
    if (!err)
        err = run_both(b, how, buf_text(&commands), at, fault);
    if (!err)
        err = judge(b->side, "this build", fault);
    if (!err)
        err = judge(b->side + 1, how->other, fault);
    buf_release(&scene);
    buf_release(&commands);
    return err;
}

/* Walls that let an empty folder be removed let no file be tried there. */
static int remove_one(const char *path, const struct stat *status, int type, struct FTW *where)
{
    (void)status, (void)where;
    return type == FTW_DP ? rmdir(path) : unlink(path);
}

void builds_release(struct builds *b)
{
    for (int i = 0; i < 2; i++) {
        struct side *side = b->side + i;
        if (side->process) {
            kill(side->process, SIGKILL);
            while (waitpid(side->process, NULL, 0) < 0 && errno == EINTR)
                ;
        }
        buf_release(&side->program);
        buf_release(&side->folder);
        buf_release(&side->journal);
        buf_release(&side->errors);
        buf_release(&side->words);
    }
    if (b->folder.length)
        nftw(buf_text(&b->folder), remove_one, 8, FTW_DEPTH | FTW_PHYS);
    buf_release(&b->folder);
}
