#include "verify/builds.h"

#include <fcntl.h>
#include <ftw.h>
#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "base/folder.h"
#include "sandbox/limits.h"

enum { ERRORS_MOST = 1 << 20 };

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
    if (!err && (side->folder.failed || side->journal.failed))
        err = fault_memory(fault, "a path");
    return err ? err : file_make_folder(buf_text(&side->folder), fault);
}

/* ---- the two processes ---- */

/* What both are given. */
struct run {
    struct builds *builds;
    const char *word, *commands, *scene;
};

/* Where the journal lies, and with nothing to read. */
static bool enter(const char *commands)
{
    struct buf place = {0};
    const int nothing = open("/dev/null", O_RDWR);
    file_folder(&place, commands);
    return nothing >= 0 && dup2(nothing, 0) >= 0 && dup2(nothing, 1) >= 0 && !place.failed &&
           chdir(buf_text(&place)) == 0;
}

static void become(void *context, size_t number, struct buf *out)
{
    const struct run *run = context;
    const struct side *side = &run->builds->side[number];
    const char *argument[] = {buf_text(&side->program),
                              run->word,
                              run->commands,
                              "--journal",
                              buf_text(&side->journal),
                              "--out",
                              buf_text(&side->folder),
                              run->scene ? "--scene" : NULL,
                              run->scene,
                              NULL};
    (void)out; /* what it prints to standard error is handed back */
    if (enter(run->commands))
        execv(argument[0], (char *const *)(uintptr_t)argument);
    _exit(127);
}

static uint64_t written_bytes;

static int add_written(const char *path, const struct stat *status, int type, struct FTW *where)
{
    (void)path, (void)where;
    written_bytes += type == FTW_F ? (uint64_t)status->st_size : 0;
    return 0;
}

/* What the builds hold now, and have written so far. */
static void count(void *context, uint64_t held_bytes)
{
    const struct run *run = context;
    written_bytes = 0;
    nftw(buf_text(&run->builds->folder), add_written, 8, FTW_PHYS);
    limits_count(held_bytes, written_bytes);
}

/* ---- both ---- */

/* What became of one that did not carry everything out. */
static enum err judge(struct side *side, const struct process_end *end, const char *name,
                      struct fault *fault)
{
    if (!file_exists(buf_text(&side->journal)))
        return fault_set(fault, ERR_IO, "%s could not be started, or wrote no journal", name);
    if (WIFEXITED(end->status) && WEXITSTATUS(end->status) == 0)
        return OK;
    buf_add_text(&side->words, "#   ended    ");
    buf_add_safe_text(&side->words, name);
    if (WIFSIGNALED(end->status))
        buf_printf(&side->words, " by signal %d (%s)", WTERMSIG(end->status),
                   strsignal(WTERMSIG(end->status)));
    else
        buf_printf(&side->words, " with status %d", WEXITSTATUS(end->status));
    if (end->bytes.length) {
        buf_add_text(&side->words, ": ");
        buf_add_safe(&side->words, buf_text(&end->bytes), strcspn(buf_text(&end->bytes), "\n"));
    }
    buf_add_char(&side->words, '\n');
    return side->words.failed ? fault_memory(fault, "a report") : OK;
}

static enum err run_both(struct builds *b, const struct bisect_builds *how, const char *commands,
                         const char *scene, struct fault *fault)
{
    const struct buf nothing = {0};
    struct run run = {b, how->word, commands, scene};
    const struct processes both = {.count = 2,
                                   .at_once = 2,
                                   .most = ERRORS_MOST,
                                   .takes_errors = true,
                                   .context = &run,
                                   .work = become,
                                   .end = b->end,
                                   .tick = count,
                                   .watch = how->watch};
    const char *const program[] = {buf_text(&b->side[0].program), buf_text(&b->side[1].program),
                                   NULL};
    enum err err = OK;
    if (how->begin)
        err = how->begin(how->context, buf_text(&b->folder), program, fault);
    if (err)
        return err;
    limits_will_write();
    err = processes_run(&both, fault);
    if (err == ERR_CANCELLED)
        fault_set(fault, err, "cancelled; the two builds were ended");
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
        err = judge(b->side, b->end, "this build", fault);
    if (!err)
        err = judge(b->side + 1, b->end + 1, how->other, fault);
    buf_release(&scene);
    buf_release(&commands);
    return err;
}

/* Where this process may only remove empty folders, it may not even try to unlink one. */
static int remove_one(const char *path, const struct stat *status, int type, struct FTW *where)
{
    (void)status, (void)where;
    return type == FTW_DP ? rmdir(path) : unlink(path);
}

void builds_release(struct builds *b)
{
    for (int i = 0; i < 2; i++) {
        struct side *side = b->side + i;
        buf_release(&side->program);
        buf_release(&side->folder);
        buf_release(&side->journal);
        buf_release(&b->end[i].bytes);
        buf_release(&side->words);
    }
    if (b->folder.length)
        nftw(buf_text(&b->folder), remove_one, 8, FTW_DEPTH | FTW_PHYS);
    buf_release(&b->folder);
}
