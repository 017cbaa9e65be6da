/* SPDX-License-Identifier: MIT */
/* Readers of volumes: NIfTI, FreeSurfer, NRRD, plain voxels, and the private header of a Siemens
 * picture. */
#include "tests/fuzz/fuzz.h"

#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>

#include "helper/csa.h"
#include "image/image_inside.h"
#include "image/regrid.h"
#include "image/volume.h"
#include "image/volume_helper.h"
#include "show/label_table.h"
#include "tests/folder.h"

/* ---- files in memory ---- */

enum { VOXELS_MOST = 1 << 20 }; /* more are valid, but too slow here */

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

/* The names of labels in any file are lines that the reader of tables accepts. */
static void read_names(const char *path, const struct volume_choice *choice)
{
    OWNED(volume_close) struct volume_reader reader = {0};
    OWNED(buf_release) struct buf names = {0};
    OWNED(label_table_release) struct label_table table = {0};
    char notes[VOLUME_NOTES_BYTES] = "";
    if (volume_open(&reader, path, choice, NULL, NULL) == OK) {
        HOLDS(volume_read_names(&names, &reader, notes, NULL) == OK);
        HOLDS(!*notes || names.length == 0);
        HOLDS(!names.length || !memchr(names.data, '\0', names.length));
        HOLDS(!names.length ||
              label_table_read(&table, buf_text(&names), names.length, true, NULL) != ERR_INPUT);
    }
}

void fuzz_volume(const char *path)
{
    struct volume_header facts;
    struct volume volume;
    struct fault fault = {.text = ""};
    struct volume_reader reader;
    enum err err = volume_begin(&reader, path, NULL, NULL, &fault);
    facts = reader.header;
    volume_close(&reader);
    HOLDS(!err || (fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
    if (err || (uint64_t)facts.size[0] * facts.size[1] * facts.size[2] > VOXELS_MOST)
        return;
    const struct volume_choice last = {.has_volume = facts.volumes > 1,
                                       .volume = facts.volumes - 1};
    err = volume_read(&volume, path, &last, NULL, &fault);
    if (!err)
        read_names(path, &last);
    HOLDS(!err == (volume.intensity != NULL));
    HOLDS(err || memcmp(volume.size, facts.size, sizeof volume.size) == 0);
    if (!err) {
        const uint32_t size[3] = {5, 4, 3};
        struct geometry place = {.slope = 1};
        geometry_place_plain(&place, (const double[3]){1, 1, 1});
        geometry_orient(&place, "LPS");
        place.orientation = ORIENTATION_FILE;
        const enum err placed = regrid(&volume, size, &place, true, NULL, NULL, &fault);
        HOLDS(placed || memcmp(volume.size, size, sizeof size) == 0);
    }
    volume_release(&volume);
    err = volume_read(&volume, path, &(struct volume_choice){.reduce = 2}, NULL, &fault);
    HOLDS(!err == (volume.intensity != NULL));
    volume_release(&volume);
}

/* Bytes as a scene, in one file or as a pair: the header alone, what is said of it, and its
 * voxels. */

static void decode(const uint8_t *bytes, size_t length)
{
    struct nifti_header header;
    struct geometry geometry;
    uint8_t again[NIFTI_MOST_BYTES];
    char notes[VOLUME_NOTES_BYTES] = "";
    struct fault fault = {.text = ""};
    if (length < NIFTI_LEAST_BYTES || nifti_header_recognise(&header, bytes, &fault))
        return;
    HOLDS(header.bytes == NIFTI_LEAST_BYTES || header.bytes == NIFTI_MOST_BYTES);
    if (length < header.bytes)
        return;
    nifti_header_decode(&header, bytes);
    nifti_header_geometry(&geometry, notes, &header, (const uint32_t[]){9, 8, 7});
    HOLDS(geometry.world_axis[0] + geometry.world_axis[1] + geometry.world_axis[2] == 3);
    nifti_header_place(&header, &geometry);
    nifti_header_encode(&header, again);
}

/* The bytes as a pair, where their header is that of one: the rest is in another file. */
static void read_pair(const uint8_t *bytes, size_t length)
{
    struct nifti_header header;
    if (length < NIFTI_LEAST_BYTES || nifti_header_recognise(&header, bytes, NULL) ||
        header.kind == NIFTI_SINGLE || length < header.bytes)
        return;
    fuzz_volume(fuzz_pair(bytes, header.bytes, bytes + header.bytes, length - header.bytes));
}

void fuzz_nifti(const uint8_t *bytes, size_t length)
{
    decode(bytes, length);
    fuzz_volume(fuzz_file(bytes, length));
    read_pair(bytes, length);
}

/* Bytes as a scene of FreeSurfer: its header, what is said of it, and its voxels. */

void fuzz_mgh(const uint8_t *bytes, size_t length)
{
    fuzz_volume(fuzz_file(bytes, length));
}

/* Bytes as a scene of NRRD: its header, its voxels, plain and as gzip. What is left to ITK goes to
 * a helper that is not there, which is refused in one line. */

void fuzz_nrrd(const uint8_t *bytes, size_t length)
{
    volume_helper_program = "/nonexistent/iftty-volume";
    fuzz_volume(fuzz_file(bytes, length));
}

/* Bytes as voxels without a header: the first bytes select the layout and the part to read. */

enum { LAYOUT = 16 };

static uint32_t side(const uint8_t *byte)
{
    return byte[1] < 250 ? byte[0] % 32u : (uint32_t)byte[0] << 24 | byte[1];
}

void fuzz_raw(const uint8_t *bytes, size_t length)
{
    struct volume_choice choice = {.raw.type = VOXEL_INT8};
    OWNED(volume_release) struct volume volume = {0};
    struct fault fault = {.text = ""};
    uint64_t voxels = 1;
    if (length < LAYOUT)
        return;
    for (int a = 0; a < 3; a++) {
        choice.raw.size[a] = side(bytes + 2 * a);
        voxels = voxels > VOXELS_MOST ? voxels : voxels * choice.raw.size[a];
        choice.first[a] = bytes[6 + a];
        choice.last[a] = bytes[9 + a];
    }
    choice.raw.type = bytes[12] % (VOXEL_FLOAT64 + 1u);
    choice.raw.big_endian = bytes[13] & 1;
    choice.has_crop = bytes[13] & 2;
    choice.nearest = bytes[13] & 4;
    choice.reduce = bytes[14] % (REDUCE_MOST + 1u);
    choice.raw.offset = bytes[15] == 255 ? UINT64_MAX - bytes[14] : bytes[15];
    if (choice.raw.size[0] == 0) /* that is: no layout */
        choice.raw.size[0] = 1;
    const enum err err =
        volume_read(&volume, fuzz_file(bytes + LAYOUT, length - LAYOUT), &choice, NULL, &fault);
    HOLDS(!err == (volume.intensity != NULL));
    HOLDS(!err || (fault.text[0] && !strpbrk(fault.text, "\n\r\033")));
    HOLDS(err || voxels <= VOXELS_MOST || length > VOXELS_MOST / 1100);
    for (int a = 0; a < 3; a++)
        HOLDS(err || (volume.size[a] >= 1 && volume.size[a] <= choice.raw.size[a]));
}

/* The private header of a Siemens picture: its values are finite numbers, as many as asked for or
 * fewer, and nothing after its last byte is looked at. */

enum { NUMBERS_MOST = 3 };

static void ask(const uint8_t *bytes, size_t length, const char *name)
{
    double number[NUMBERS_MOST + 1] = {0, 0, 0, -1};
    const int count = csa_numbers(number, NUMBERS_MOST, bytes, length, name);
    HOLDS(count >= -1 && count <= NUMBERS_MOST && number[NUMBERS_MOST] == -1);
    for (int i = 0; i < count; i++)
        HOLDS(isfinite(number[i]));
    HOLDS(count < 0 || length >= 16);
}

void fuzz_csa(const uint8_t *bytes, size_t length)
{
    OWNED(mem_release) uint8_t *own = malloc(length + 1); /* a byte too many read is seen */
    HOLDS(own);
    memcpy(own + 1, bytes, length);
    ask(own + 1, length, "NumberOfImagesInMosaic");
    ask(own + 1, length, "SliceNormalVector");
    ask(own + 1, length, "");
}
