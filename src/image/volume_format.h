/* SPDX-License-Identifier: MIT */
/*
 * What a format of volumes is, and what those who read and write one share: the volume in memory,
 * what its header says, what of it is chosen, and voxels as plain numbers, one after another, which
 * is how most formats hold them.
 */
#ifndef IMAGE_VOLUME_FORMAT_H
#define IMAGE_VOLUME_FORMAT_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "base/file.h"
#include "base/watch.h"
#include "image/geometry.h"
#include "image/levels.h"
#include "image/source.h"

/* ---- voxels ---- */

enum voxel_type {
    VOXEL_INT8,
    VOXEL_UINT8,
    VOXEL_INT16,
    VOXEL_UINT16,
    VOXEL_INT32,
    VOXEL_UINT32,
    VOXEL_INT64,
    VOXEL_UINT64,
    VOXEL_FLOAT32,
    VOXEL_FLOAT64
};

unsigned voxel_bytes(enum voxel_type type);
const char *voxel_type_name(enum voxel_type type); /* "int16" */

/* The type that is read, by its name; false where there is none. */
bool voxel_type_named(enum voxel_type *out, const char *name);

size_t voxels_in(const uint32_t size[3]);

/* Between the byte order of this machine and that of a file, in place. */
void voxels_reorder(void *value, size_t count, enum voxel_type type, bool big_endian);

/* ---- volumes ---- */

/* Lines for the user, on what a file leaves open, or holds and is not as it should be; each ends
 * with a line feed. What does not fit any more is left out. */
enum { VOLUME_NOTES_BYTES = 1536, VOLUME_WORD_BYTES = 33, VOLUME_CONTENTS_BYTES = 256 };
void volume_note(char notes[VOLUME_NOTES_BYTES], const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* What of a file is to be read, where there is a choice. All zero: the one volume that it holds. */
enum { REDUCE_MOST = 16 };
struct raw_layout {
    uint32_t size[3]; /* 0: no layout is given */
    unsigned type;    /* enum voxel_type */
    bool big_endian;
    uint64_t offset; /* bytes before the voxels */
};
struct buf;
struct volume_choice {
    bool has_volume; /* of a series, this one, counted from 0: */
    uint32_t volume;
    const char *command; /* the command by which the user chooses it, for the words of a refusal;
                            NULL: a program, by its option --volume. Not owned */
    bool has_crop;       /* of a volume, this part (image/image_inside.h): */
    uint32_t first[3], last[3];
    uint32_t reduce;  /* 0 and 1: voxels as they are */
    bool nearest;     /* reduce: take the middle of each block, for labels */
    bool straightens; /* of sheared axes, the part on a straight grid (image/image_inside.h) */
    uint32_t series;  /* of the series of DICOM in a folder, counted from 1; 0: the only one */
    const char *series_name; /* or a piece of its description; NULL: not said. Not owned */
    const char *skip;        /* files of a folder to leave out, NAME,NAME; NULL: none. Not owned */
    bool fills_gaps;         /* blank slices take the place of those that are missing */
    const char *data;        /* the name of a data set of HDF5; NULL: the only one. Not owned */
    struct raw_layout raw;   /* of voxels without a header, as the user says it */
    uint32_t spacing_nm[3];  /* of a file that does not say it; 0: none */
    const char *proof; /* the digest that the scene is to have (engine/scene.h), or there is none;
                                NULL: any. Not owned */
    bool huge;         /* the user knows that the file swells as no scene does */
    struct buf *list;  /* where what a folder holds is said in lines, with words of its files, when
                          one of several series is to be chosen: for the screen, and kept nowhere;
                          NULL: no such word comes out. Not owned */
    bool by_extremes;  /* of maps: scales of reals and of wide whole numbers are never cut */
    bool as_recorded;  /* series, fills_gaps and data are left out, and this is noted, where the
                         format has no such thing; else refused */
};

struct volume {
    uint32_t size[3];
    uint16_t *intensity; /* [z][y][x], x fastest */
    struct geometry geometry;
    struct volume_choice choice; /* by which it was read, */
    uint32_t whole[3];           /* of a file of this size */
    uint32_t series;             /* of DICOM that it is, counted from 1; 0: the format has none */
    bool is_coarse;              /* several whole numbers of the file are one intensity */
    struct levels *levels;       /* where intensities are not exact, unless by_extremes; or NULL */
    char notes[VOLUME_NOTES_BYTES];
};

void volume_release(struct volume *volume);

/* What the header of a file says. */
struct volume_header {
    uint32_t size[3];
    struct geometry geometry;       /* slope and intercept are those of the numbers in the file */
    char format[VOLUME_WORD_BYTES]; /* "nifti-1" */
    char type_name[VOLUME_WORD_BYTES]; /* of voxels, "int16" */
    bool big_endian;
    uint32_t volumes; /* of a series; 1 for a scene */
    uint32_t series;  /* of DICOM that it is, counted from 1; 0: the format has none */
    char contents[VOLUME_CONTENTS_BYTES]; /* "the segments liver (1)" of the volume that is chosen;
                          where none is, a list of all volumes; "" where the file does not say */
    char refusal[160];                    /* why its voxels cannot be read; "" where they can: */
    enum voxel_type type;
    uint64_t offset; /* bytes before the voxels, of all volumes */
    uint64_t bytes;  /* of the file on disk; 2^64 - 1 where its voxels lie in others */
    char notes[VOLUME_NOTES_BYTES];
    struct volume_choice choice; /* of what there is; and what follows from it: */
    uint32_t whole[3];           /* the size in the file; `size` is that of the part */
    uint32_t begin[3], step[3];  /* of the part, in voxels of the file */
    uint32_t made[3];            /* the size of what volume_take makes of it */
};

/* How a label of a map is called and shown. */
struct volume_label {
    const char *name; /* "" for none */
    uint8_t rgb[3];
    uint16_t number; /* of its voxels in the map; 0 for the background, and for none */
};

/* A map to be written. `row` is asked for the rows in file order, y faster than z, and fills
 * size[0] values of the type. */
struct volume_map {
    const uint32_t *size; /* [3] */
    const struct geometry *geometry;
    enum voxel_type type;    /* uint8, uint16 or uint32; float32 for NIfTI alone */
    const char *description; /* cut to what the format holds */
    void (*row)(void *context, uint32_t y, uint32_t z, void *values);
    void *context;
    const struct volume_label *label; /* [256], of a map of labels; else NULL */
};

enum volume_taking { TAKES_FOLDERS = 1, TAKES_LAYOUTS = 2 };

struct volume_format {
    const char *name;    /* "NIfTI" */
    const char *endings; /* of file names, ".nii|.nii.gz" */
    unsigned takes;      /* enum volume_taking: what it reads besides */
    /* Those that read; NULL where the format is only written. */
    bool (*recognises)(const uint8_t *begin, size_t length);
    enum err (*read_header)(struct volume_header *header, struct volume_source *source,
                            struct fault *fault);
    /* Before the voxels are read of the same source, from header->offset on; NULL: nothing. */
    enum err (*begin_voxels)(const struct volume_header *header, struct volume_source *source,
                             struct fault *fault);
    /* NULL where the format is only read. */
    enum err (*write)(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault);
};

/* ---- for formats ---- */

/* That a file of this size can hold the voxels that its header claims, before anything large is
 * allocated. */
enum err voxels_check(const struct volume_header *header, const struct volume_source *source,
                      struct fault *fault);

/* The way to the world that a header has, as far as it says it: where it does not, or where that
 * cannot be, distances or the orientation are unknown. */
void header_place(struct volume_header *header, const double to_mm[3][4], bool knows_spacing,
                  bool knows_place);

/* Of a file that is not packed, notes how many bytes come after the last voxel, which is odd, with
 * that advice. */
void voxels_note_rest(struct volume_header *header, const struct volume_source *source,
                      const char *advice);

/* What of a file is gzip. */
enum packing { PACKED_NOT, PACKED_VOXELS, PACKED_WHOLE };

/* For volume_format.write: `header`, which is released, then the voxels, little-endian. */
enum err voxels_write(const char *path, enum file_mode mode, struct buf *header,
                      enum packing packing, const struct volume_map *map, struct watch *watch,
                      struct fault *fault);

#endif
