/* SPDX-License-Identifier: MIT */
#include "base/confine.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/openat2.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

bool path_without_openat2;

bool path_is_inside(const char *name)
{
    if (*name == '/' || *name == '\0')
        return false;
    for (const char *at = name; *at; at += strcspn(at, "/"), at += *at == '/')
        if (strncmp(at, "..", 2) == 0 && (at[2] == '/' || at[2] == '\0'))
            return false;
    return true;
}

/* Resolve a name without openat2: open each step by itself, without following links. */
static int open_stepwise(int folder, const char *name)
{
    struct stat status;
    char step[256];
    int at = dup(folder);
    while (at >= 0 && *name) {
        const size_t n = strcspn(name, "/");
        int next = -1;
        if (n >= sizeof step) {
            errno = ENAMETOOLONG;
        } else {
            memcpy(step, name, n);
            step[n] = '\0';
            next = openat(at, n ? step : ".", O_PATH | O_CLOEXEC | O_NOFOLLOW);
            if (name[n] && next >= 0 && fstat(next, &status) == 0 && S_ISLNK(status.st_mode)) {
                close(next);
                next = -1;
                errno = ELOOP;
            }
        }
        const int number = errno;
        close(at);
        errno = number;
        at = next;
        name += n + (name[n] == '/');
    }
    return at;
}

static enum path_kind judge(int fd)
{
    struct stat status;
    if (fd < 0)
        return errno == EXDEV || errno == ELOOP ? PATH_IS_OUTSIDE : PATH_IS_MISSING;
    if (fstat(fd, &status) != 0)
        return PATH_IS_MISSING;
    if (S_ISLNK(status.st_mode)) /* possible only if links are not followed */
        return PATH_IS_OUTSIDE;
    return S_ISREG(status.st_mode)   ? PATH_IS_FILE
           : S_ISDIR(status.st_mode) ? PATH_IS_FOLDER
                                     : PATH_IS_SPECIAL;
}

enum path_kind path_kind_below(const char *folder, const char *name)
{
    if (!path_is_inside(name))
        return PATH_IS_OUTSIDE;
    const int at = open(folder, O_PATH | O_DIRECTORY | O_CLOEXEC);
    if (at < 0)
        return PATH_IS_MISSING;
    /* Open without side effects: O_PATH touches no device and does not block on a pipe. */
    const struct open_how how = {.flags = O_PATH | O_CLOEXEC,
                                 .resolve = RESOLVE_BENEATH | RESOLVE_NO_MAGICLINKS};
    errno = ENOSYS;
    int fd = path_without_openat2 ? -1 : (int)syscall(SYS_openat2, at, name, &how, sizeof how);
    if (fd < 0 && (errno == ENOSYS || errno == EPERM || errno == EINVAL))
        fd = open_stepwise(at, name);
    const enum path_kind answer = judge(fd);
    if (fd >= 0)
        close(fd);
    close(at);
    return answer;
}

/* ---- files and network, by Landlock ---- */

/* Defined here, since Debian 12's linux/landlock.h has only the first two versions. */
enum fs_right {
    FS_EXECUTE = 1 << 0,
    FS_WRITE_FILE = 1 << 1,
    FS_READ_FILE = 1 << 2,
    FS_READ_DIR = 1 << 3,
    FS_REMOVE_DIR = 1 << 4,
    FS_REMOVE_FILE = 1 << 5,
    FS_MAKE_DIR = 1 << 7,
    FS_MAKE_REG = 1 << 8,
    FS_VERSION_1 = (1 << 13) - 1,
    FS_REFER = 1 << 13,     /* version 2: rename and link between folders */
    FS_TRUNCATE = 1 << 14,  /* 3 */
    FS_IOCTL_DEV = 1 << 15, /* 5 */
    FS_OF_FILES = FS_EXECUTE | FS_WRITE_FILE | FS_READ_FILE | FS_TRUNCATE | FS_IOCTL_DEV,
};
enum { NET_BIND_AND_CONNECT = 3 };      /* version 4 */
enum { SCOPE_SOCKETS_AND_SIGNALS = 3 }; /* version 6: none to processes outside */
enum { CREATE_VERSION = 1, RULE_PATH_BENEATH = 1 };

struct ruleset {
    uint64_t fs, net, scoped;
};

struct allowed_path {
    uint64_t allowed;
    int32_t fd;
} __attribute__((packed));

static int create(const struct ruleset *ruleset, size_t size, unsigned flags)
{
    return (int)syscall(SYS_landlock_create_ruleset, ruleset, size, flags);
}

int confine_version(void)
{
    const int version = create(NULL, 0, CREATE_VERSION);
    return version > 0 ? version : 0;
}

static uint64_t fs_rights(unsigned rights)
{
    uint64_t fs = 0;
    fs |= rights & CONFINE_READ ? FS_READ_FILE | FS_READ_DIR : 0u;
    fs |= rights & CONFINE_RUN ? FS_EXECUTE | FS_READ_FILE : 0u;
    fs |= rights & CONFINE_WRITE ? FS_WRITE_FILE | FS_READ_FILE | FS_READ_DIR | FS_REMOVE_FILE |
                                       FS_REMOVE_DIR | FS_MAKE_DIR | FS_MAKE_REG | FS_TRUNCATE
                                 : 0u;
    fs |= rights & CONFINE_EMPTY ? FS_REMOVE_DIR : 0u;
    fs |= rights & CONFINE_DEVICE ? FS_WRITE_FILE | FS_READ_FILE | FS_IOCTL_DEV : 0u;
    return fs;
}

bool confine_to(const struct confine_place *place, size_t places)
{
    const int version = confine_version();
    const struct ruleset ruleset = {FS_VERSION_1 | (version >= 2 ? FS_REFER : 0u) |
                                        (version >= 3 ? FS_TRUNCATE : 0u) |
                                        (version >= 5 ? FS_IOCTL_DEV : 0u),
                                    NET_BIND_AND_CONNECT, SCOPE_SOCKETS_AND_SIGNALS};
    const size_t words = version >= 6 ? 3 : version >= 4 ? 2 : 1;
    const int set = version ? create(&ruleset, words * sizeof ruleset.fs, 0) : -1;
    if (set < 0)
        return false;
    for (size_t i = 0; i < places; i++) {
        struct stat status;
        const int fd = open(place[i].path, O_PATH | O_CLOEXEC);
        if (fd < 0) /* a place that cannot be opened cannot be reached either */
            continue;
        struct allowed_path rule = {fs_rights(place[i].rights) & ruleset.fs, fd};
        if (fstat(fd, &status) == 0 && !S_ISDIR(status.st_mode))
            rule.allowed &= FS_OF_FILES;
        if (rule.allowed)
            syscall(SYS_landlock_add_rule, set, RULE_PATH_BENEATH, &rule, 0);
        close(fd);
    }
    const bool is_confined = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                             syscall(SYS_landlock_restrict_self, set, 0) == 0;
    close(set);
    return is_confined;
}

/* ---- calls of the kernel, by seccomp ---- */

#if defined(__x86_64__)
#define OWN_ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define OWN_ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

#ifdef OWN_ARCHITECTURE

/* Calls that are allowed with any arguments. Omitted on purpose, although decoders try it: ioctl,
 * for isatty; it could insert lines into a terminal's input. */
static const uint32_t for_all[] = {
    /* descriptors already open */
    SYS_read, SYS_readv, SYS_pread64, SYS_write, SYS_writev, SYS_pwrite64, SYS_lseek, SYS_close,
    SYS_dup, SYS_fstat, SYS_fadvise64, SYS_flock,
    /* memory */
    SYS_brk, SYS_mremap, SYS_munmap, SYS_madvise, SYS_futex,
    /* signals and exit */
    SYS_rt_sigaction, SYS_rt_sigprocmask, SYS_rt_sigreturn, SYS_sigaltstack, SYS_restart_syscall,
    SYS_exit, SYS_exit_group,
    /* time */
    SYS_clock_gettime, SYS_clock_getres, SYS_clock_nanosleep, SYS_nanosleep, SYS_gettimeofday,
    SYS_getrusage, SYS_sched_yield,
    /* facts about process and machine */
    SYS_getrandom, SYS_getpid, SYS_gettid, SYS_getuid, SYS_geteuid, SYS_getgid, SYS_getegid,
    SYS_uname, SYS_sysinfo, SYS_sched_getaffinity};
static const uint32_t to_open[] = {
#ifdef SYS_open /* older processors have two names for the same */
    SYS_open,       SYS_stat,       SYS_lstat,      SYS_access, SYS_readlink,
#endif
    SYS_openat,     SYS_openat2,    SYS_newfstatat, SYS_statx,  SYS_faccessat,
    SYS_faccessat2, SYS_readlinkat, SYS_getdents64, SYS_getcwd};
static const uint32_t to_change[] = {
#ifdef SYS_open
    SYS_rename,    SYS_unlink, SYS_mkdir,    SYS_rmdir,
#endif
    SYS_ftruncate, SYS_fsync,  SYS_renameat, SYS_unlinkat, SYS_mkdirat};
static const uint32_t to_thread[] = {SYS_set_robust_list, SYS_rseq};

#define LISTED(calls) calls, sizeof calls / sizeof calls[0]
static const struct list {
    unsigned kind; /* enum confine_calls; 0: for every decoder */
    const uint32_t *call;
    size_t count;
} list[] = {{0, LISTED(for_all)},
            {CONFINE_OPEN, LISTED(to_open)},
            {CONFINE_CHANGE, LISTED(to_change)},
            {CONFINE_THREADS, LISTED(to_thread)}};

/* Calls that depend on the lower half of one argument: all compared values are numbers of 32 bits
 * and flags. IF_OWN: equal to the number of this process. The allowed commands of fcntl cannot send
 * signals (F_SETFL, F_SETOWN). */
enum when { IF_EQUAL, IF_OWN, IF_LESS, IF_BITS, UNLESS_BITS };
static const struct call {
    uint32_t number;
    unsigned kind;
    enum when when;
    unsigned argument;
    uint32_t value;
} checked[] = {
    {SYS_fcntl, 0, IF_LESS, 1, F_GETFL + 1},
    {SYS_mmap, 0, UNLESS_BITS, 2, PROT_EXEC},
    {SYS_mprotect, 0, UNLESS_BITS, 2, PROT_EXEC},
    {SYS_tgkill, 0, IF_OWN, 0, 0},      /* for abort */
    {SYS_prlimit64, 0, IF_EQUAL, 0, 0}, /* its own limits */
    {SYS_clone, CONFINE_THREADS, IF_BITS, 0, CLONE_THREAD},
    {SYS_prctl, CONFINE_THREADS, IF_EQUAL, 0, PR_SET_NAME},
};
enum {
    LISTS = sizeof list / sizeof list[0],
    CHECKED = sizeof checked / sizeof checked[0],
    STEPS_MOST = 256
};

enum { ANOTHER_ABI = 0x40000000 }; /* x32, whose calls are numbered differently */

struct filter {
    struct sock_filter step[STEPS_MOST];
    unsigned short steps;
};

static void add(struct filter *filter, unsigned code, uint32_t value, unsigned if_so,
                unsigned if_not)
{
    assert(filter->steps < STEPS_MOST);
    filter->step[filter->steps++] =
        (struct sock_filter){(uint16_t)code, (uint8_t)if_so, (uint8_t)if_not, value};
}

static void load(struct filter *filter, size_t offset)
{
    add(filter, BPF_LD | BPF_W | BPF_ABS, (uint32_t)offset, 0, 0);
}

static void answer(struct filter *filter, uint32_t with)
{
    add(filter, BPF_RET | BPF_K, with, 0, 0);
}

static const uint32_t REFUSE = SECCOMP_RET_ERRNO | EPERM;

/* Allow or refuse this call; other calls continue after these steps. Both processors are
 * little-endian. */
static void add_checked(struct filter *filter, const struct call *call)
{
    const bool is_reverse = call->when == IF_LESS || call->when == UNLESS_BITS;
    const bool is_of_bits = call->when == IF_BITS || call->when == UNLESS_BITS;
    const unsigned test = is_of_bits ? BPF_JSET : call->when == IF_LESS ? BPF_JGE : BPF_JEQ;
    const uint32_t value = call->when == IF_OWN ? (uint32_t)getpid() : call->value;
    add(filter, BPF_JMP | BPF_JEQ | BPF_K, call->number, 0, 4);
    load(filter, offsetof(struct seccomp_data, args) + sizeof(uint64_t) * call->argument);
    add(filter, BPF_JMP | test | BPF_K, value, is_reverse, !is_reverse);
    answer(filter, SECCOMP_RET_ALLOW);
    answer(filter, REFUSE);
}

/* clone3 fails with ENOSYS, since its flags cannot be examined: the library then uses clone. */
static void make_filter(struct filter *filter, unsigned kinds)
{
    load(filter, offsetof(struct seccomp_data, arch));
    add(filter, BPF_JMP | BPF_JEQ | BPF_K, OWN_ARCHITECTURE, 1, 0);
    answer(filter, REFUSE);
    load(filter, offsetof(struct seccomp_data, nr));
    add(filter, BPF_JMP | BPF_JGE | BPF_K, ANOTHER_ABI, 0, 1);
    answer(filter, REFUSE);
    for (unsigned i = 0; i < LISTS; i++)
        for (size_t n = 0; n < list[i].count && (list[i].kind & kinds) == list[i].kind; n++) {
            add(filter, BPF_JMP | BPF_JEQ | BPF_K, list[i].call[n], 0, 1);
            answer(filter, SECCOMP_RET_ALLOW);
        }
    for (unsigned i = 0; i < CHECKED; i++)
        if ((checked[i].kind & kinds) == checked[i].kind)
            add_checked(filter, &checked[i]);
    add(filter, BPF_JMP | BPF_JEQ | BPF_K, SYS_clone3, 0, 1);
    answer(filter, SECCOMP_RET_ERRNO | ENOSYS);
    answer(filter, REFUSE);
}

bool confine_knows_calls(void)
{
    const uint32_t action = SECCOMP_RET_ERRNO;
    return syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

bool confine_calls(unsigned kinds)
{
    struct filter filter = {.steps = 0};
    make_filter(&filter, kinds);
    const struct sock_fprog program = {filter.steps, filter.step};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0, 0) == 0;
}

#else

bool confine_knows_calls(void)
{
    return false;
}

bool confine_calls(unsigned kinds)
{
    (void)kinds;
    return false;
}

#endif
