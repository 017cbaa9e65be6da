
#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

#include "base/file.h"
#include "tui/term.h"

enum { NOT_FOUND = 127, NOT_RUNNABLE = 126 }; /* the shell's exit status */

static const char *name_of_editor(void)
{
    const char *visual = getenv("VISUAL"), *editor = getenv("EDITOR");
    return visual && *visual ? visual : editor && *editor ? editor : NULL;
}

/* Signals are as a program expects to find them. */
static int spawn(pid_t *process, char *const *word)
{
    posix_spawnattr_t attributes;
    sigset_t none, all;
    sigemptyset(&none);
    sigfillset(&all);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    const int number = posix_spawn(process, "/bin/sh", NULL, &attributes, word, environ);
    posix_spawnattr_destroy(&attributes);
    return number;
}

static enum err judge(const char *editor, int status, struct fault *fault)
{
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 0;
    if (status == 0)
        return OK;
    if (code == NOT_FOUND || code == NOT_RUNNABLE)
        return fault_set(fault, ERR_INPUT,
                         "there is no editor %s; set VISUAL or EDITOR to one before iftty", editor);
    return fault_set(fault, ERR_INPUT, "%s ended with %s %d; the line is as it was", editor,
                     WIFEXITED(status) ? "status" : "signal",
                     WIFEXITED(status) ? code : WTERMSIG(status));
}

/* Runs the editor, which has the terminal, and waits for its end. */
static enum err run(const char *editor, const char *path, struct fault *fault)
{
    struct buf command = {0};
    struct sigaction ignore = {.sa_handler = SIG_IGN}, interrupt, quit;
    pid_t process;
    int status = 0;
    buf_printf(&command, "%s \"$@\"", editor);
    if (command.failed)
        return fault_memory(fault, "the editor's name");
    char *const word[] = {(char[]){"sh"}, (char[]){"-c"},          command.data,
                          (char[]){"sh"}, (char *)(uintptr_t)path, NULL};
    sigaction(SIGINT, &ignore, &interrupt);
    sigaction(SIGQUIT, &ignore, &quit);
    errno = spawn(&process, word);
    enum err err = errno ? fault_errno(fault, "start", editor) : OK;
    while (!err && waitpid(process, &status, 0) < 0)
        if (errno != EINTR)
            err = fault_errno(fault, "wait for", editor);
    sigaction(SIGINT, &interrupt, NULL);
    sigaction(SIGQUIT, &quit, NULL);
    buf_release(&command);
    return err ? err : judge(editor, status, fault);
}

/* One line: what ends lines is a blank, but for the last; the rest has no control characters. */
static void flatten(struct buf *text)
{
    size_t kept = 0;
    while (text->length > 0 && strchr("\r\n \t", text->data[text->length - 1]))
        text->length--;
    for (size_t i = 0; i < text->length; i++) {
        const char c = strchr("\n\t", text->data[i]) && text->data[i] ? ' ' : text->data[i];
        if ((unsigned char)c >= ' ' && c != 127)
            text->data[kept++] = c;
    }
    text->length = kept;
    if (text->data)
        text->data[kept] = '\0';
}

static enum err edit_file(struct buf *text, const char *editor, const char *path,
                          struct fault *fault)
{
    struct buf written = {0};
    buf_printf(&written, "%s\n", buf_text(text));
    enum err err = file_write(path, buf_text(&written), written.length, FILE_KEEP, fault);
    if (!err)
        err = term_set_mode(TERM_AS_FOUND, fault);
    if (!err)
        err = run(editor, path, fault);
    const enum err ours = term_set_mode(TERM_RAW, err ? NULL : fault);
    if (!err && !ours)
        err = file_read(&written, path, OTHER_EDITOR_BYTES_MOST, fault);
    if (!err && !ours) {
        flatten(&written);
        buf_clear(text);
        buf_add(text, buf_text(&written), written.length);
    }
    buf_release(&written);
    return err ? err : ours;
}

enum err edit_elsewhere(struct buf *text, struct fault *fault)
{
    struct buf folder = {0}, path = {0};
    const char *editor = name_of_editor();
    if (!editor)
        return fault_set(fault, ERR_USAGE,
                         "neither VISUAL nor EDITOR names an editor; `export EDITOR=nano` before "
                         "iftty, say");
    enum err err = folder_fresh(&folder, NULL, fault);
    if (err)
        return err;
    buf_printf(&path, "%s/line", buf_text(&folder));
    err = path.failed ? fault_memory(fault, "a path")
                      : edit_file(text, editor, buf_text(&path), fault);
    folder_remove(buf_text(&folder));
    buf_release(&path);
    buf_release(&folder);
    return err;
}
