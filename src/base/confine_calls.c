#include "base/confine_calls.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__x86_64__)
#define OWN_ARCHITECTURE AUDIT_ARCH_X86_64
#elif defined(__aarch64__)
#define OWN_ARCHITECTURE AUDIT_ARCH_AARCH64
#endif

#ifdef OWN_ARCHITECTURE

/* ---- the list ---- */

/* When a call of the list is let through. */
enum when { ALWAYS, IF_EQUAL, IF_OWN, IF_LESS, IF_BITS, UNLESS_BITS };

/* An argument, of which the lower half counts, and what it is compared with: all that is compared
 * here are numbers of 32 bits and flags. IF_OWN: with the number of this process. */
struct call {
    uint32_t number;
    unsigned kind; /* enum confine_calls; 0: for every decoder */
    enum when when;
    unsigned argument;
    uint32_t value;
};

/* What is missing on purpose, of what decoders try: ioctl (isatty; a terminal would take lines from
 * it), and F_SETFL, F_SETOWN and the like of fcntl, which can send signals. */
static const struct call list[] = {
    {SYS_read, 0, ALWAYS, 0, 0},
    {SYS_readv, 0, ALWAYS, 0, 0},
    {SYS_pread64, 0, ALWAYS, 0, 0},
    {SYS_write, 0, ALWAYS, 0, 0},
    {SYS_writev, 0, ALWAYS, 0, 0},
    {SYS_pwrite64, 0, ALWAYS, 0, 0},
    {SYS_lseek, 0, ALWAYS, 0, 0},
    {SYS_close, 0, ALWAYS, 0, 0},
    {SYS_dup, 0, ALWAYS, 0, 0},
    {SYS_fcntl, 0, IF_LESS, 1, F_GETFL + 1},
    {SYS_fstat, 0, ALWAYS, 0, 0},
    {SYS_fadvise64, 0, ALWAYS, 0, 0},
    {SYS_flock, 0, ALWAYS, 0, 0},

    {SYS_brk, 0, ALWAYS, 0, 0},
    {SYS_mmap, 0, UNLESS_BITS, 2, PROT_EXEC},
    {SYS_mprotect, 0, UNLESS_BITS, 2, PROT_EXEC},
    {SYS_mremap, 0, ALWAYS, 0, 0},
    {SYS_munmap, 0, ALWAYS, 0, 0},
    {SYS_madvise, 0, ALWAYS, 0, 0},

    {SYS_futex, 0, ALWAYS, 0, 0},
    {SYS_rt_sigaction, 0, ALWAYS, 0, 0},
    {SYS_rt_sigprocmask, 0, ALWAYS, 0, 0},
    {SYS_rt_sigreturn, 0, ALWAYS, 0, 0},
    {SYS_sigaltstack, 0, ALWAYS, 0, 0},
    {SYS_tgkill, 0, IF_OWN, 0, 0}, /* abort */
    {SYS_restart_syscall, 0, ALWAYS, 0, 0},
    {SYS_exit, 0, ALWAYS, 0, 0},
    {SYS_exit_group, 0, ALWAYS, 0, 0},

    {SYS_clock_gettime, 0, ALWAYS, 0, 0},
    {SYS_clock_getres, 0, ALWAYS, 0, 0},
    {SYS_clock_nanosleep, 0, ALWAYS, 0, 0},
    {SYS_nanosleep, 0, ALWAYS, 0, 0},
    {SYS_gettimeofday, 0, ALWAYS, 0, 0},
    {SYS_getrandom, 0, ALWAYS, 0, 0},
    {SYS_getrusage, 0, ALWAYS, 0, 0},
    {SYS_prlimit64, 0, IF_EQUAL, 0, 0}, /* its own */
    {SYS_getpid, 0, ALWAYS, 0, 0},
    {SYS_gettid, 0, ALWAYS, 0, 0},
    {SYS_getuid, 0, ALWAYS, 0, 0},
    {SYS_geteuid, 0, ALWAYS, 0, 0},
    {SYS_getgid, 0, ALWAYS, 0, 0},
    {SYS_getegid, 0, ALWAYS, 0, 0},
    {SYS_uname, 0, ALWAYS, 0, 0},
    {SYS_sysinfo, 0, ALWAYS, 0, 0},
    {SYS_sched_getaffinity, 0, ALWAYS, 0, 0},
    {SYS_sched_yield, 0, ALWAYS, 0, 0},

    {SYS_openat, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_newfstatat, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_statx, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_faccessat, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_faccessat2, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_readlinkat, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_getdents64, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_getcwd, CONFINE_OPEN, ALWAYS, 0, 0},

    {SYS_ftruncate, CONFINE_CHANGE, ALWAYS, 0, 0},
    {SYS_fsync, CONFINE_CHANGE, ALWAYS, 0, 0},
    {SYS_renameat, CONFINE_CHANGE, ALWAYS, 0, 0},
    {SYS_unlinkat, CONFINE_CHANGE, ALWAYS, 0, 0},
    {SYS_mkdirat, CONFINE_CHANGE, ALWAYS, 0, 0},

    {SYS_clone, CONFINE_THREADS, IF_BITS, 0, CLONE_THREAD},
    {SYS_set_robust_list, CONFINE_THREADS, ALWAYS, 0, 0},
    {SYS_rseq, CONFINE_THREADS, ALWAYS, 0, 0},
    {SYS_prctl, CONFINE_THREADS, IF_EQUAL, 0, PR_SET_NAME},

#ifdef SYS_open /* on older processors the same has two names */
    {SYS_open, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_stat, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_lstat, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_access, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_readlink, CONFINE_OPEN, ALWAYS, 0, 0},
    {SYS_rename, CONFINE_CHANGE, ALWAYS, 0, 0},
    {SYS_unlink, CONFINE_CHANGE, ALWAYS, 0, 0},
    {SYS_mkdir, CONFINE_CHANGE, ALWAYS, 0, 0},
    {SYS_rmdir, CONFINE_CHANGE, ALWAYS, 0, 0},
#endif
};
enum { LISTED = sizeof list / sizeof list[0], STEPS_EACH = 5 };

/* ---- the kernel's program ---- */

enum { ANOTHER_ABI = 0x40000000 }; /* x32, whose calls have other numbers */

struct filter {
    struct sock_filter step[STEPS_EACH * LISTED + 16];
    unsigned short steps;
};

static void add(struct filter *filter, unsigned code, uint32_t value, unsigned if_so,
                unsigned if_not)
{
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

/* Lets the call through, or refuses it; another one goes on after these steps. */
static void add_call(struct filter *filter, const struct call *call)
{
    const uint32_t value = call->when == IF_OWN ? (uint32_t)getpid() : call->value;
    add(filter, BPF_JMP | BPF_JEQ | BPF_K, call->number, 0, call->when == ALWAYS ? 1 : 4);
    if (call->when != ALWAYS) {
        const bool is_reverse = call->when == IF_LESS || call->when == UNLESS_BITS;
        const bool is_of_bits = call->when == IF_BITS || call->when == UNLESS_BITS;
        const unsigned test = is_of_bits ? BPF_JSET : call->when == IF_LESS ? BPF_JGE : BPF_JEQ;
        /* little-endian machines, both of them */
        load(filter, offsetof(struct seccomp_data, args) + 8 * call->argument);
        add(filter, BPF_JMP | test | BPF_K, value, is_reverse, !is_reverse);
    }
    answer(filter, SECCOMP_RET_ALLOW);
    if (call->when != ALWAYS)
        answer(filter, REFUSE);
}

/* clone3, whose flags cannot be seen, is as if it were not there: then the library takes clone. */
static void make_filter(struct filter *filter, unsigned kinds)
{
    load(filter, offsetof(struct seccomp_data, arch));
    add(filter, BPF_JMP | BPF_JEQ | BPF_K, OWN_ARCHITECTURE, 1, 0);
    answer(filter, REFUSE);
    load(filter, offsetof(struct seccomp_data, nr));
    add(filter, BPF_JMP | BPF_JGE | BPF_K, ANOTHER_ABI, 0, 1);
    answer(filter, REFUSE);
    for (unsigned i = 0; i < LISTED; i++)
        if ((list[i].kind & kinds) == list[i].kind)
            add_call(filter, &list[i]);
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
