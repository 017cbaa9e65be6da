#include "tests/fuzz/fuzz.h"

#include <fcntl.h>
#include <sys/mman.h>

#include "tests/folder.h"

static void fill(int descriptor, const uint8_t *bytes, size_t length)
{
    HOLDS(descriptor >= 0 && ftruncate(descriptor, 0) == 0);
    HOLDS(length == 0 || pwrite(descriptor, bytes, length, 0) == (ssize_t)length);
}

const char *fuzz_file(const uint8_t *bytes, size_t length)
{
    static char path[32];
    static int descriptor = -1;
    if (descriptor < 0) {
        descriptor = memfd_create("fuzz", 0);
        snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    }
    fill(descriptor, bytes, length);
    return path;
}

/* Readers go by the names of a pair. */
static char folder[FOLDER_LENGTH];

static void clean_up(void)
{
    remove_folder(folder);
}

static int make(const char *name)
{
    return open(file_in(folder, name), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
}

const char *fuzz_pair(const uint8_t *header, size_t header_length, const uint8_t *voxels,
                      size_t voxels_length)
{
    static int descriptor[2] = {-1, -1};
    if (descriptor[0] < 0) {
        HOLDS(make_folder(folder, "fuzz") && atexit(clean_up) == 0);
        descriptor[0] = make("A.hdr");
        descriptor[1] = make("A.img");
    }
    fill(descriptor[0], header, header_length);
    fill(descriptor[1], voxels, voxels_length);
    return file_in(folder, "A.hdr");
}
