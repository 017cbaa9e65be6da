/* SPDX-License-Identifier: MIT */
#include "tests/probe/attempts.hh"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <functional>
#include <pthread.h>
#include <signal.h>
#include <vector>

#include <linux/bpf.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include "helper/wire.hh"

namespace
{

struct Attempt {
    const char *name;
    std::function<bool()> succeeds;
};

bool opens(const std::string &path, int flags)
{
    const int fd = open(path.c_str(), flags | O_CLOEXEC, 0666);
    if (fd >= 0)
        close(fd);
    return fd >= 0;
}

std::string proc(pid_t process, const char *file)
{
    return "/proc/" + std::to_string(process) + "/" + file;
}

/* A process that could be made ends at once. */
bool is_process(long process)
{
    if (process == 0)
        _exit(0);
    return process > 0;
}

bool is_unlimited(__rlimit_resource_t resource)
{
    struct rlimit limit;
    return getrlimit(resource, &limit) != 0 || limit.rlim_max == RLIM_INFINITY;
}

bool holds_descriptors()
{
    for (int i = 4; i < 1024; i++)
        if (fcntl(i, F_GETFD) >= 0)
            return true;
    return false;
}

bool makes_executable()
{
    static char room[8192] __attribute__((aligned(4096)));
    return mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1,
                0) != MAP_FAILED ||
           mprotect(room, 4096, PROT_READ | PROT_EXEC) == 0;
}

bool sees(pid_t process)
{
    char byte = 0;
    struct iovec here = {&byte, 1}, there = {&byte, 1};
    return ptrace(PTRACE_ATTACH, process, nullptr, nullptr) == 0 ||
           process_vm_readv(process, &here, 1, &there, 1, 0) > 0 ||
           process_vm_writev(process, &here, 1, &there, 1, 0) > 0 ||
           opens(proc(process, "mem"), O_RDWR) || opens(proc(process, "maps"), O_RDONLY) ||
           opens(proc(process, "environ"), O_RDONLY) || opens(proc(process, "root/etc"), O_RDONLY);
}

bool signals(pid_t process)
{
    return kill(process, 0) == 0 || syscall(SYS_tgkill, process, process, 0) == 0 ||
           syscall(SYS_tkill, process, 0) == 0 || fcntl(wire::fd, F_SETOWN, process) == 0;
}

bool limits(pid_t process)
{
    struct rlimit limit;
    return prlimit(process, RLIMIT_NOFILE, nullptr, &limit) == 0;
}

void *nothing(void *)
{
    return nullptr;
}

bool starts_thread()
{
    pthread_t thread;
    return pthread_create(&thread, nullptr, nothing, nullptr) == 0;
}

/* The processes above: of the image helper, the one that takes requests, and the program itself. */
std::vector<pid_t> others()
{
    return {getppid(), getsid(0), 1};
}

std::vector<Attempt> all(const std::string &path, bool may_write, bool may_thread)
{
    const std::string folder = path.substr(0, path.find_last_of('/') + 1);
    std::vector<Attempt> list = {
        {"environment", [] { return environ && *environ; }},
        {"descriptors", holds_descriptors},
        {"open-file", [] { return opens("/etc/passwd", O_RDONLY); }},
        {"open-folder", [] { return opens("/", O_RDONLY | O_DIRECTORY); }},
        {"open-beside", [=] { return opens(folder + "s.nii", O_RDONLY); }},
        {"open-neighbour", [=] { return opens(folder + "n.txt", O_RDONLY); }},
        {"open-program", [] { return opens("/proc/self/exe", O_RDONLY); }},
        {"open-terminal", [] { return opens("/dev/tty", O_RDWR); }},
        {"make-file", [=] { return opens(folder + "made", O_WRONLY | O_CREAT); }},
        {"make-folder", [=] { return mkdir((folder + "made").c_str(), 0777) == 0; }},
        {"make-link", [=] { return symlink("/", (folder + "made").c_str()) == 0; }},
        {"make-name", [=] { return link(path.c_str(), (folder + "made").c_str()) == 0; }},
        {"rename", [=] { return rename(path.c_str(), (folder + "made").c_str()) == 0; }},
        {"remove", [=] { return unlink(path.c_str()) == 0; }},
        {"permissions", [=] { return chmod(path.c_str(), 0777) == 0; }},
        {"socket-inet", [] { return socket(AF_INET, SOCK_STREAM, 0) >= 0; }},
        {"socket-unix", [] { return socket(AF_UNIX, SOCK_STREAM, 0) >= 0; }},
        {"socket-netlink", [] { return socket(AF_NETLINK, SOCK_RAW, 0) >= 0; }},
        {"connect", [] { return syscall(SYS_connect, wire::fd, nullptr, 0), errno != EPERM; }},
        {"send-message", [] { return syscall(SYS_sendmsg, wire::fd, nullptr, 0), errno != EPERM; }},
        {"exec", [] { return execl("/bin/true", "true", nullptr), errno != EPERM; }},
        {"fork", [] { return is_process(fork()); }},
        {"clone", [] { return is_process(syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0)); }},
        {"clone3", [] { return syscall(SYS_clone3, nullptr, 0), errno != ENOSYS; }},
        {"executable-memory", makes_executable},
        {"privileges", [] { return setuid(0) == 0 || unshare(CLONE_NEWUSER) == 0; }},
        {"mount", [] { return mount("none", "/", "tmpfs", 0, nullptr) == 0; }},
        {"chdir", [] { return chdir("/") == 0 || chroot("/") == 0; }},
        {"bpf", [] { return syscall(SYS_bpf, 0, nullptr, 0), errno != EPERM; }},
        {"io_uring", [] { return syscall(SYS_io_uring_setup, 1, nullptr), errno != EPERM; }},
        {"userfaultfd", [] { return syscall(SYS_userfaultfd, 0), errno != EPERM; }},
        {"keys", [] { return syscall(SYS_keyctl, 0, -3, 0), errno != EPERM; }},
        {"perf",
         [] { return syscall(SYS_perf_event_open, nullptr, 0, -1, -1, 0), errno != EPERM; }},
        {"parent-death", [] { return prctl(PR_SET_PDEATHSIG, 0) == 0; }},
        {"dumpable", [] { return prctl(PR_SET_DUMPABLE, 1) == 0; }},
        {"terminal-input", [] { return ioctl(wire::fd, TIOCSTI, "x"), errno != EPERM; }},
        {"unlimited-cpu", [] { return is_unlimited(RLIMIT_CPU); }},
        {"unlimited-files", [] { return is_unlimited(RLIMIT_NOFILE); }},
        {"unlimited-data", [] { return MEM_MAY_BE_LIMITED && is_unlimited(RLIMIT_DATA); }},
    };
    for (const pid_t process : others()) {
        list.push_back({"see-process", [=] { return sees(process); }});
        list.push_back({"signal-process", [=] { return signals(process); }});
        list.push_back({"limit-process", [=] { return limits(process); }});
    }
    if (!may_write) {
        list.push_back({"write-file", [=] { return opens(path, O_WRONLY); }});
        list.push_back({"truncate", [=] { return truncate(path.c_str(), 0) == 0; }});
        list.push_back({"unlimited-output", [] { return is_unlimited(RLIMIT_FSIZE); }});
    }
    if (!may_thread)
        list.push_back({"thread", starts_thread});
    return list;
}

std::string hold_memory()
{
    constexpr size_t piece = 16 << 20;
    for (size_t held = 0;; held += piece) {
        char *room = static_cast<char *>(std::malloc(piece));
        if (!room)
            return "memory refused after " + std::to_string(held >> 20) + " MB";
        std::memset(room, 1, piece);
    }
}

/* As a decoder does that fills the room for its voxels, and says nothing meanwhile. */
std::string grow_slowly()
{
    constexpr size_t piece = 4 << 20;
    const struct timespec pause = {0, 300000000};
    for (int i = 0; i < 12; i++) {
        std::memset(std::malloc(piece), 1, piece);
        nanosleep(&pause, nullptr);
    }
    return "it has grown";
}

} // namespace

std::string attempts(const std::string &path, bool may_write, bool may_thread)
{
    std::string let_through;
    if (path.find("memory") != std::string::npos)
        return hold_memory();
    while (path.find("spin") != std::string::npos)
        ;
    if (path.find("slow") != std::string::npos)
        return grow_slowly();
    const std::vector<Attempt> list = all(path, may_write, may_thread);
    for (const Attempt &attempt : list) {
        errno = 0;
        if (attempt.succeeds())
            let_through += std::string(" ") + attempt.name;
    }
    return let_through.empty() ? std::to_string(list.size()) + " attempts, all refused"
                               : "let through:" + let_through;
}
