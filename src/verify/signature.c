#include "verify/signature.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file_draft.h"
#include "base/process.h"

enum {
    SAID_MOST = 1 << 16,    /* bytes that ssh-keygen prints */
    PRINCIPALS_MOST = 64,   /* that one key may be allowed for */
    STATUS_NOT_FOUND = 127, /* as a shell has it */
    STATUS_NO_FILE = 126
};

/* One run of ssh-keygen. */
struct keygen {
    const char *const *argument; /* ended by NULL */
    int input;                   /* a descriptor that it reads */
    const char *output;          /* a file that it writes; NULL: what it prints is handed back */
};

static void become(void *context, size_t number, struct buf *out)
{
    const struct keygen *k = context;
    const int output =
        k->output ? open(k->output, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666) : STDERR_FILENO;
    (void)number, (void)out;
    if (output < 0 || lseek(k->input, 0, SEEK_SET) != 0 || dup2(k->input, STDIN_FILENO) < 0 ||
        dup2(output, STDOUT_FILENO) < 0)
        _exit(STATUS_NO_FILE);
    execvp("ssh-keygen", (char *const *)(uintptr_t)k->argument);
    _exit(STATUS_NOT_FOUND);
}

/* Its exit status in *status; what it printed in `said`, unless that goes to a file. */
static enum err run(const struct keygen *keygen, int *status, struct buf *said, struct watch *watch,
                    struct fault *fault)
{
    struct process_end end = {0};
    const struct processes how = {.count = 1,
                                  .at_once = 1,
                                  .most = SAID_MOST,
                                  .takes_errors = !keygen->output,
                                  .context = (void *)(uintptr_t)keygen,
                                  .work = become,
                                  .end = &end,
                                  .watch = watch};
    enum err err = processes_run(&how, fault);
    *status = WIFEXITED(end.status) ? WEXITSTATUS(end.status) : -1;
    buf_release(said);
    *said = end.bytes;
    if (!err && *status == STATUS_NOT_FOUND)
        err = fault_set(fault, ERR_IO,
                        "ssh-keygen, which makes and checks signatures, is not installed: it comes "
                        "with OpenSSH, on Debian by apt-get install openssh-client");
    return err;
}

/* A file in memory with the bytes that are signed. */
static enum err open_bytes(int *descriptor, const struct buf *bytes, struct fault *fault)
{
    *descriptor = memfd_create("journal", MFD_CLOEXEC);
    if (*descriptor >= 0 &&
        file_step_write(*descriptor, "a file in memory", buf_text(bytes), bytes->length))
        return OK;
    return fault_errno(fault, "write", "a file in memory");
}

static void close_bytes(int descriptor)
{
    if (descriptor >= 0)
        close(descriptor);
}

void signature_path(struct buf *path, const char *journal)
{
    buf_printf(path, "%s.sig", journal);
}

/* ---- making ---- */

static enum err sign_into(const char *draft, int input, const char *key, struct watch *watch,
                          struct fault *fault)
{
    const char *const argument[] = {"ssh-keygen",        "-q", "-Y", "sign", "-n",
                                    SIGNATURE_NAMESPACE, "-f", key,  NULL};
    const struct keygen keygen = {argument, input, draft};
    struct buf said = {0};
    int status;
    enum err err = run(&keygen, &status, &said, watch, fault);
    if (!err && status)
        err = fault_set(fault, ERR_IO,
                        "ssh-keygen could not sign with the key %s; nothing was "
                        "written",
                        key);
    buf_release(&said);
    return err;
}

enum err signature_make(const char *journal, const struct buf *bytes, const char *key,
                        struct watch *watch, struct fault *fault)
{
    struct buf path = {0}, draft = {0};
    int input = -1;
    signature_path(&path, journal);
    enum err err = path.failed ? fault_memory(fault, "a path")
                               : file_draft(&draft, buf_text(&path), FILE_KEEP, fault);
    if (!err)
        err = open_bytes(&input, bytes, fault);
    if (!err)
        err = sign_into(buf_text(&draft), input, key, watch, fault);
    if (!err)
        err = file_publish(buf_text(&draft), buf_text(&path), FILE_KEEP, fault);
    else if (draft.length)
        file_discard(buf_text(&draft));
    close_bytes(input);
    buf_release(&path);
    buf_release(&draft);
    return err;
}

/* ---- checking ---- */

/* The last line that it printed, which says what is wrong. */
static const char *last_line(struct buf *said)
{
    while (said->length && said->data[said->length - 1] == '\n')
        said->data[--said->length] = '\0';
    const char *feed = said->length ? strrchr(said->data, '\n') : NULL;
    return feed ? feed + 1 : buf_text(said);
}

/* Whom the key of the signature is allowed for: lines. */
static enum err find_principals(struct buf *principals, const char *path, const char *allowed,
                                int input, struct watch *watch, struct fault *fault)
{
    const char *const argument[] = {"ssh-keygen", "-Y", "find-principals", "-s",
                                    path,         "-f", allowed,           NULL};
    const struct keygen keygen = {argument, input, NULL};
    int status;
    enum err err = run(&keygen, &status, principals, watch, fault);
    if (!err && (status || !principals->length))
        err = fault_set(fault, ERR_CHECK,
                        "its signature is by nobody whom %s names, or is none: ssh-keygen: %s",
                        allowed, last_line(principals));
    return err;
}

/* Takes what ssh-keygen says of a good signature apart. */
static void tell_who(struct buf *who, const struct buf *said, const char *principal)
{
    static const char before[] = " signature for ";
    const char *at = strstr(buf_text(said), before);
    if (at)
        buf_add_safe(who, at + sizeof before - 1, strcspn(at + sizeof before - 1, "\n"));
    else
        buf_add_safe_text(who, principal);
}

static enum err check_as(struct buf *who, const char *principal, const char *path,
                         const char *allowed, int input, struct watch *watch, struct fault *fault)
{
    const char *const argument[] = {"ssh-keygen",        "-Y", "verify", "-n",
                                    SIGNATURE_NAMESPACE, "-f", allowed,  "-I",
                                    principal,           "-s", path,     NULL};
    const struct keygen keygen = {argument, input, NULL};
    struct buf said = {0};
    int status;
    enum err err = run(&keygen, &status, &said, watch, fault);
    if (!err && status)
        err = fault_set(fault, ERR_CHECK, "its signature does not hold for %s: ssh-keygen: %s",
                        principal, last_line(&said));
    else if (!err)
        tell_who(who, &said, principal);
    buf_release(&said);
    return err;
}

/* By the first of them for whom it holds. */
static enum err check_all(struct buf *who, struct buf *principals, const char *path,
                          const char *allowed, int input, struct watch *watch, struct fault *fault)
{
    enum err err = ERR_CHECK;
    char *rest, *principal = strtok_r(principals->data, "\n", &rest);
    for (int i = 0; err == ERR_CHECK && principal && i < PRINCIPALS_MOST; i++) {
        err = check_as(who, principal, path, allowed, input, watch, fault);
        principal = strtok_r(NULL, "\n", &rest);
    }
    return err;
}

enum err signature_check(struct buf *who, const char *journal, const struct buf *bytes,
                         const char *allowed, struct watch *watch, struct fault *fault)
{
    struct buf path = {0}, principals = {0};
    int input = -1;
    signature_path(&path, journal);
    enum err err = path.failed ? fault_memory(fault, "a path") : OK;
    if (!err && !file_exists(allowed))
        err = fault_set(fault, ERR_IO, "there is no file of allowed signers %s", allowed);
    if (!err && !file_exists(buf_text(&path)))
        err = fault_set(fault, ERR_CHECK,
                        "it is not signed: there is no %s, which iftty log --sign KEY makes",
                        buf_text(&path));
    if (!err)
        err = open_bytes(&input, bytes, fault);
    if (!err)
        err = find_principals(&principals, buf_text(&path), allowed, input, watch, fault);
    if (!err)
        err = check_all(who, &principals, buf_text(&path), allowed, input, watch, fault);
    close_bytes(input);
    buf_release(&principals);
    buf_release(&path);
    return err;
}
