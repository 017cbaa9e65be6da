#include "confine/confine.h"

#include <fcntl.h>
#include <stdint.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

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

struct beneath {
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

static uint64_t fs_handled(int version)
{
    return FS_VERSION_1 | (version >= 2 ? FS_REFER : 0u) | (version >= 3 ? FS_TRUNCATE : 0u) |
           (version >= 5 ? FS_IOCTL_DEV : 0u);
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

/* A place that cannot be opened cannot be reached either. */
static void allow(int set, const struct confine_place *place, uint64_t handled)
{
    struct stat status;
    const int fd = open(place->path, O_PATH | O_CLOEXEC);
    if (fd < 0)
        return;
    struct beneath rule = {fs_rights(place->rights) & handled, fd};
    if (fstat(fd, &status) == 0 && !S_ISDIR(status.st_mode))
        rule.allowed &= FS_OF_FILES;
    if (rule.allowed)
        syscall(SYS_landlock_add_rule, set, RULE_PATH_BENEATH, &rule, 0);
    close(fd);
}

bool confine_to(const struct confine_place *place, size_t places)
{
    const int version = confine_version();
    const struct ruleset ruleset = {fs_handled(version), NET_BIND_AND_CONNECT,
                                    SCOPE_SOCKETS_AND_SIGNALS};
    const size_t words = version >= 6 ? 3 : version >= 4 ? 2 : 1;
    const int set = version ? create(&ruleset, words * sizeof ruleset.fs, 0) : -1;
    if (set < 0)
        return false;
    for (size_t i = 0; i < places; i++)
        allow(set, &place[i], ruleset.fs);
    const bool is_confined = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
                             syscall(SYS_landlock_restrict_self, set, 0) == 0;
    close(set);
    return is_confined;
}
