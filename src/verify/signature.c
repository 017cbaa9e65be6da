/* SPDX-License-Identifier: MIT */
#include "verify/signature.h"

#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/file.h"
#include "verify/process.h"

enum {
    SAID_MOST = 1 << 16, /* bytes that ssh-keygen prints */
    ALLOWED_BYTES_MAX = 1 << 24,
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

/* ---- making ---- */

enum err signature_make(const char *journal, const struct buf *bytes, const char *key,
                        struct watch *watch, struct fault *fault)
{
    const char *const argument[] = {"ssh-keygen",        "-q", "-Y", "sign", "-n",
                                    SIGNATURE_NAMESPACE, "-f", key,  NULL};
    struct buf path = {0}, draft = {0}, said = {0};
    int input = -1, status = 0;
    buf_printf(&path, "%s.sig", journal);
    enum err err = path.failed ? fault_memory(fault, "a path")
                               : file_draft(&draft, buf_text(&path), FILE_KEEP, fault);
    if (!err)
        err = open_bytes(&input, bytes, fault);
    if (!err)
        err =
            run(&(struct keygen){argument, input, buf_text(&draft)}, &status, &said, watch, fault);
    if (!err && status)
        err = fault_set(fault, ERR_IO,
                        "ssh-keygen could not sign with the key %s; nothing was written", key);
    if (!err)
        err = file_publish(buf_text(&draft), buf_text(&path), FILE_KEEP, fault);
    else if (draft.length)
        file_discard(buf_text(&draft));
    close_bytes(input);
    buf_release(&said);
    buf_release(&path);
    buf_release(&draft);
    return err;
}

/* ---- checking ---- */

/* A question about a signature. */
struct checking {
    const struct signature_rules *rules;
    const char *path; /* of the signature */
    int input;        /* what is signed */
    struct watch *watch;
};

/* Runs ssh-keygen with these words, to which what all questions have in common is added. */
static enum err ask(const struct checking *c, const char *const *word, int *status,
                    struct buf *said, struct fault *fault)
{
    enum { WORDS = 24 };
    const char *argument[WORDS] = {"ssh-keygen", "-Y"};
    struct buf time = {0};
    size_t n = 2;
    for (; *word; word++)
        argument[n++] = *word;
    argument[n++] = "-s";
    argument[n++] = c->path;
    argument[n++] = "-f";
    argument[n++] = c->rules->allowed;
    if (c->rules->signed_at) {
        buf_printf(&time, "-Overify-time=%s", c->rules->signed_at);
        argument[n++] = buf_text(&time);
    }
    const struct keygen keygen = {argument, c->input, NULL};
    const enum err err =
        time.failed ? fault_memory(fault, "a time") : run(&keygen, status, said, c->watch, fault);
    buf_release(&time);
    return err;
}

/* Whom the key of the signature is allowed for: lines. */
static enum err find_principals(struct buf *principals, const struct checking *c,
                                struct fault *fault)
{
    static const char *const word[] = {"find-principals", NULL};
    int status;
    enum err err = ask(c, word, &status, principals, fault);
    if (!err && (status || !principals->length))
        err = fault_set(fault, ERR_CHECK,
                        "its signature is by nobody whom %s names, or is none: ssh-keygen: %.*s",
                        c->rules->allowed, (int)strcspn(buf_text(principals), "\n"),
                        buf_text(principals));
    return err;
}

/* ---- who it was ---- */

/* Where the key of a line of allowed signers begins: "principals [options] type key comment". */
static const char *find_key(const char *line)
{
    static const char *const type[] = {" ssh-", " ecdsa-", " sk-"};
    bool is_quoted = false;
    for (const char *at = line; *at && *at != '\n'; at++) {
        is_quoted ^= *at == '"';
        for (size_t i = 0; !is_quoted && i < sizeof type / sizeof *type; i++)
            if ((*at == ' ' || *at == '\t') &&
                strncmp(at + 1, type[i] + 1, strlen(type[i]) - 1) == 0)
                return at + 1;
    }
    return NULL;
}

/* The keys of all lines, as a file of public keys has them. */
static enum err open_keys(int *keys, const char *allowed, struct fault *fault)
{
    struct buf text = {0}, key = {0};
    enum err err = file_read(&text, allowed, ALLOWED_BYTES_MAX, fault);
    for (const char *at = buf_text(&text); !err && *at;
         at += strcspn(at, "\n"), at += *at == '\n') {
        const char *from = *at == '#' ? NULL : find_key(at);
        if (from) {
            buf_add(&key, from, strcspn(from, "\r\n"));
            buf_add_char(&key, '\n');
        }
    }
    if (!err)
        err = key.failed ? fault_memory(fault, "keys") : open_bytes(keys, &key, fault);
    buf_release(&text);
    buf_release(&key);
    return err;
}

/* ", COMMENT" of the key with that fingerprint: of the first line "256 SHA256:... comment (TYPE)"
 * that has it. */
static void add_comment(struct buf *who, const char *fingerprint, const struct buf *listed)
{
    const size_t length = strcspn(fingerprint, " \n");
    for (const char *at = buf_text(listed); *at; at += strcspn(at, "\n"), at += *at == '\n') {
        const char *print = at + strcspn(at, " \n"), *end = at + strcspn(at, "\n");
        print += *print == ' ';
        if (strncmp(print, fingerprint, length) != 0 || print[length] != ' ')
            continue;
        while (end > print && *end != '(')
            end--;
        if (end > print + length + 2) {
            buf_add_text(who, ", ");
            buf_add_safe(who, print + length + 1, (size_t)(end - print) - length - 2);
        }
        return;
    }
}

/* Of a signer that is a pattern nothing is known but the key: "ED25519 key SHA256:..., COMMENT, one
 * that ALLOWED has for *". */
static enum err add_key(struct buf *who, const char *key, const char *principal,
                        const struct checking *c, struct fault *fault)
{
    static const char *const argument[] = {"ssh-keygen", "-l", "-f", "-", NULL};
    struct keygen keygen = {argument, -1, NULL};
    struct buf listed = {0};
    int status;
    const char *fingerprint = strstr(key, " key ");
    enum err err = open_keys(&keygen.input, c->rules->allowed, fault);
    if (!err)
        err = run(&keygen, &status, &listed, c->watch, fault);
    buf_add_safe(who, key, strcspn(key, "\n"));
    if (!err && fingerprint)
        add_comment(who, fingerprint + strlen(" key "), &listed);
    buf_add_text(who, ", one that ");
    buf_add_safe_text(who, c->rules->allowed);
    buf_add_text(who, " has for ");
    buf_add_safe_text(who, principal);
    close_bytes(keygen.input);
    buf_release(&listed);
    return err;
}

/* Takes what ssh-keygen says of a good signature apart: "... signature for WHO with KEY". */
static enum err take_who(struct buf *who, const struct buf *said, const char *principal,
                         const struct checking *c, struct fault *fault)
{
    static const char before[] = " signature for ";
    const char *at = strstr(buf_text(said), before);
    const char *name = at ? at + sizeof before - 1 : principal;
    const size_t length = strlen(principal);
    if (at && strpbrk(principal, "*?!") && strncmp(name, principal, length) == 0 &&
        strncmp(name + length, " with ", 6) == 0)
        return add_key(who, name + length + 6, principal, c, fault);
    buf_add_safe(who, name, strcspn(name, "\n"));
    return OK;
}

/* ---- whether it holds ---- */

static enum err ask_of(const struct checking *c, const char *principal, bool minds_revoked,
                       int *status, struct buf *said, struct fault *fault)
{
    const bool is_asked = minds_revoked && c->rules->revoked;
    const char *const word[] = {
        "verify",          "-n", SIGNATURE_NAMESPACE, "-I", principal, is_asked ? "-r" : NULL,
        c->rules->revoked, NULL};
    return ask(c, word, status, said, fault);
}

/* Why it does not: ssh-keygen has no words for a key that is revoked. */
static enum err refuse(const struct checking *c, const char *principal, struct buf *said,
                       struct fault *fault)
{
    struct buf again = {0};
    int status = 1;
    enum err err = c->rules->revoked ? ask_of(c, principal, false, &status, &again, fault) : OK;
    while (said->length && said->data[said->length - 1] == '\n')
        said->data[--said->length] = '\0';
    const char *feed = strrchr(buf_text(said), '\n'); /* the last line says what is wrong */
    if (!err)
        err = status ? fault_set(fault, ERR_CHECK,
                                 "its signature does not hold for %s: ssh-keygen: %s", principal,
                                 feed ? feed + 1 : buf_text(said))
                     : fault_set(fault, ERR_CHECK,
                                 "its signature is by a key that %s revokes, or that is no list "
                                 "of keys which ssh-keygen reads",
                                 c->rules->revoked);
    buf_release(&again);
    return err;
}

enum err signature_check(struct buf *who, const char *journal, const struct buf *bytes,
                         const struct signature_rules *rules, struct watch *watch,
                         struct fault *fault)
{
    struct buf path = {0}, principals = {0}, said = {0};
    int status;
    struct checking c = {.rules = rules, .input = -1, .watch = watch};
    buf_printf(&path, "%s.sig", journal);
    c.path = buf_text(&path);
    enum err err = OK;
    if (path.failed)
        err = fault_memory(fault, "a path");
    else if (!file_exists(rules->allowed))
        err = fault_set(fault, ERR_IO, "there is no file of allowed signers %s", rules->allowed);
    else if (rules->revoked && !file_exists(rules->revoked))
        err = fault_set(fault, ERR_IO, "there is no file of revoked keys %s", rules->revoked);
    else if (!file_exists(c.path))
        err =
            fault_set(fault, ERR_CHECK,
                      "it is not signed: there is no %s, which iftty log --sign KEY makes", c.path);
    if (!err)
        err = open_bytes(&c.input, bytes, fault);
    if (!err)
        err = find_principals(&principals, &c, fault);
    if (!err) { /* by the first of them for whom it holds */
        char *rest, *principal = strtok_r(principals.data, "\n", &rest);
        err = ERR_CHECK;
        for (int i = 0; err == ERR_CHECK && principal && i < PRINCIPALS_MOST; i++) {
            err = ask_of(&c, principal, true, &status, &said, fault);
            if (!err)
                err = status ? refuse(&c, principal, &said, fault)
                             : take_who(who, &said, principal, &c, fault);
            principal = strtok_r(NULL, "\n", &rest);
        }
    }
    close_bytes(c.input);
    buf_release(&said);
    buf_release(&principals);
    buf_release(&path);
    return err;
}

bool signature_is_time(const char *text)
{
    const size_t digits = strspn(text, "0123456789");
    return (digits == 8 || digits == 12 || digits == 14) &&
           (!text[digits] || strcmp(text + digits, "Z") == 0);
}
