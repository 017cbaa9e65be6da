/* SPDX-License-Identifier: MIT */
/* DICOM SEG, read by GDCM and parts of iftty-volume in this process. A segmentation that is
 * accepted has planes, its voxels can be sent, and its names are a table of labels or rejected by
 * its reader. Each file is read twice, the second time with a threshold and chosen segments.
 *
 * GDCM asserts what a file may break; in iftty-volume that ends the process, and the client says
 * so. Here such a file ends its reading by a jump, which leaks what GDCM holds. */
#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>

#include <fcntl.h>
#include <unistd.h>

#include <gdcmTrace.h>

#include "helper/volume_parts.hh"
#include "helper/wire.hh"

extern "C" {
const char *fuzz_file(const uint8_t *bytes, size_t length);
void fuzz_labels(const uint8_t *bytes, size_t length);
void fuzz_seg(const uint8_t *bytes, size_t length);
}

/* ---- assertions of GDCM ---- */

static jmp_buf after_reading;
static bool is_reading;

extern "C" {
void __lsan_disable() __attribute__((weak));
void __lsan_enable() __attribute__((weak));

void __assert_fail(const char *words, const char *file, unsigned line,
                   const char *function) noexcept
{
    if (is_reading && std::strstr(file, "gdcm"))
        longjmp(after_reading, 1);
    fprintf(stderr, "%s:%u: %s: %s\n", file, line, function, words);
    abort();
}
}

/* GDCM allocates what a length says; iftty-volume has a limit of memory. */
constexpr size_t memory_most = 16 << 20;

void *operator new(size_t bytes)
{
    void *memory = is_reading && bytes > memory_most ? nullptr : malloc(bytes ? bytes : 1);
    if (!memory)
        throw std::bad_alloc();
    return memory;
}

void *operator new(size_t bytes, const std::nothrow_t &) noexcept
{
    return malloc(bytes ? bytes : 1);
}

void operator delete(void *memory) noexcept
{
    free(memory);
}

void operator delete(void *memory, size_t) noexcept
{
    free(memory);
}

/* The open files below 32, as bits; and close those that are not in a set. */
static uint32_t files_open()
{
    uint32_t open = 0;
    for (int file = 0; file < 32; file++)
        open |= fcntl(file, F_GETFD) >= 0 ? UINT32_C(1) << file : 0;
    return open;
}

static void close_others(uint32_t open)
{
    for (int file = 0; file < 32; file++)
        if (!(open >> file & 1))
            close(file);
}

/* ---- reading ---- */

static void holds(bool condition)
{
    if (!condition)
        abort();
}

static void read_once(const char *path, bool is_other)
{
    constexpr uint64_t sent_most = 1 << 22;
    volume::Volume volume;
    volume::Request request;
    request.path = path;
    if (is_other) {
        request.threshold = 500;
        request.segments = "1,3-4";
        request.step_nm = 1000000;
    }
    try {
        if (!volume::open_segments(volume, request))
            return;
        uint64_t voxels = 1;
        for (const uint64_t side : volume.size)
            voxels = volume::product_of(voxels, side);
        holds(voxels > 0 && volume.is_segments);
        if (voxels <= sent_most)
            volume.send();
    } catch (const volume::Refusal &refusal) {
        holds(!refusal.words.empty());
    } catch (const std::exception &) { /* of GDCM or the library */
    }
    fuzz_labels(reinterpret_cast<const uint8_t *>(volume.names.c_str()), volume.names.size());
}

void fuzz_seg(const uint8_t *bytes, size_t length)
{
    if (wire::fd < 0) {
        wire::fd = open("/dev/null", O_WRONLY | O_CLOEXEC);
        gdcm::Trace::SetWarning(false);
        gdcm::Trace::SetError(false);
    }
    const char *path = fuzz_file(bytes, length);
    const volatile uint32_t files = files_open();
    if (__lsan_disable)
        __lsan_disable();
    is_reading = true;
    if (setjmp(after_reading) == 0) {
        read_once(path, false);
        read_once(path, true);
    } else {
        close_others(files);
    }
    is_reading = false;
    if (__lsan_enable)
        __lsan_enable();
}
