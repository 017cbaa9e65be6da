/* SPDX-License-Identifier: MIT */
/*
 * A format of volumes, and the parts that readers and writers share: the volume in memory, its
 * header, the user's choice from a file, and voxels as plain numbers, one after another, the layout
 * of most formats.
 */
#ifndef IMAGE_VOLUME_FORMAT_H
#define IMAGE_VOLUME_FORMAT_H

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "base/buf.h"
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

/* Find the type by its name; false for other names. */
bool voxel_type_named(enum voxel_type *out, const char *name);

size_t voxels_in(const uint32_t size[3]);

/* The number of a voxel in a row of uint8, uint16 or uint32. */
static inline uint32_t voxel_number(const void *row, enum voxel_type type, uint32_t x)
{
    return type == VOXEL_UINT32   ? ((const uint32_t *)row)[x]
           : type == VOXEL_UINT16 ? ((const uint16_t *)row)[x]
                                  : ((const uint8_t *)row)[x];
}

/* Convert between the byte order of this machine and that of a file, in place. */
void voxels_reorder(void *value, size_t count, enum voxel_type type, bool big_endian);

/* The real number of these bits, and the reverse: single precision for a width of 4, otherwise
 * double. */
static inline double real_of_bits(uint64_t bits, unsigned width)
{
    const uint32_t narrow = (uint32_t)bits;
    float single;
    double real;
    memcpy(&single, &narrow, sizeof single);
    memcpy(&real, &bits, sizeof real);
    return width == sizeof single ? (double)single : real;
}

static inline uint64_t bits_of_real(double real, unsigned width)
{
    const float single = (float)real;
    uint32_t narrow;
    uint64_t bits;
    memcpy(&narrow, &single, sizeof narrow);
    memcpy(&bits, &real, sizeof bits);
    return width == sizeof single ? narrow : bits;
}

/* ---- volumes ---- */

/* Append a line for the user about missing or unusual content of a file. A line that does not fit
 * is dropped. */
enum { VOLUME_NOTES_BYTES = 1536, VOLUME_WORD_BYTES = 33, VOLUME_CONTENTS_BYTES = 256 };
void volume_note(char notes[VOLUME_NOTES_BYTES], const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* The user's choice from a file. All zero: the one volume of the file. Strings are not owned. */
enum { REDUCE_MOST = 16 };
struct raw_layout {
    uint32_t size[3]; /* 0: no layout */
    unsigned type;    /* enum voxel_type */
    bool big_endian;
    uint64_t offset; /* bytes before the voxels */
};
struct volume_choice {
    bool has_volume; /* this one of a series, counted from 0: */
    uint32_t volume;
    const char *command; /* the command that chooses it, for the message of a refusal; NULL: a
                            program, by its option --volume */
    bool has_crop;       /* this part of a volume (image/image_inside.h): */
    uint32_t first[3], last[3];
    uint32_t reduce;         /* 0 and 1: all voxels */
    bool nearest;            /* reduce: use the middle voxel of each block, for labels */
    bool straightens;        /* resample sheared axes to a straight grid (image/image_inside.h) */
    uint32_t series;         /* this DICOM series in a folder, counted from 1; 0: the only one */
    const char *series_name; /* or a piece of its description; NULL: none */
    const char *skip;        /* files of a folder to leave out, NAME,NAME; NULL: none */
    bool fills_gaps;         /* blank slices replace missing ones */
    const char *data;        /* the name of a data set of HDF5; NULL: the only one */
    const char *segments;    /* labels of DICOM SEG, "3,5-7"; NULL: all */
    uint32_t threshold;      /* thousandths, for fractional segments; 0: none */
    uint32_t step_nm;        /* distance of the scene's slices, if the file does not say it; or 0 */
    struct buf *names;       /* receives the names of its segments (image/names.h); or NULL */
    struct buf *references;  /* receives UIDs of a DICOM series (volume_helper.h); or NULL */
    bool keeps_identity;     /* with its patient and study */
    struct raw_layout raw;   /* layout of voxels without a header */
    uint32_t spacing_nm[3];  /* spacing of a file without one; 0: none */
    const char *proof; /* the expected digest of the scene (engine/scene.h), otherwise the file
                          counts as missing; NULL: any */
    bool huge;         /* the user accepts a file that may be a bomb (image/reader_common.h) */
    struct buf *list;  /* receives the contents of a folder, with words of its files, when one of
                          several series is to be chosen: for the screen, stored nowhere; NULL: no
                          words of files are printed */
    bool by_extremes;  /* for maps: scales of reals and of wide whole numbers are never cut */
    bool as_recorded;  /* ignore series, fills_gaps and data, with a note, for formats without
                          them; otherwise they are refused */
};

struct volume {
    uint32_t size[3];
    uint16_t *intensity; /* [z][y][x], x fastest */
    struct geometry geometry;
    struct volume_choice choice; /* the choice by which it was read, */
    uint32_t whole[3];           /* and the size of the file */
    uint32_t series;             /* number of the DICOM series, from 1; 0: no DICOM */
    bool is_coarse;              /* several whole numbers of the file are one intensity */
    struct levels *levels;       /* set if intensities are not exact, unless by_extremes; or NULL */
    double *value;               /* [values], the real value of each intensity, rising, if the scale
                                    is not linear (image/image_inside.h); or NULL */
    uint32_t values;
    uint32_t *number; /* [65536], the number of each region (session/map.h); NULL: itself */
    bool has_regions; /* intensities have become regions */
    char notes[VOLUME_NOTES_BYTES];
};

void volume_release(struct volume *volume);

/* The header of a file. */
struct volume_header {
    uint32_t size[3];
    struct geometry geometry;          /* slope and intercept apply to the numbers in the file */
    char format[VOLUME_WORD_BYTES];    /* "nifti-1" */
    char type_name[VOLUME_WORD_BYTES]; /* "int16", the type of voxels */
    bool big_endian;
    uint32_t volumes;                     /* length of the series; 1 for a scene */
    uint32_t series;                      /* number of the DICOM series, from 1; 0: no DICOM */
    char contents[VOLUME_CONTENTS_BYTES]; /* "the segments liver (1)" of the chosen volume, or a
                          list of all volumes if none is chosen; "" if the file has no names */
    bool is_segments;                     /* DICOM SEG: voxels outside the file are background */
    uint64_t overlaps;                    /* voxels in several segments */
    char refusal[160];                    /* reason why voxels are unreadable; "" if readable: */
    enum voxel_type type;
    uint64_t offset; /* bytes before the voxels of all volumes */
    uint64_t bytes;  /* size of the file on disk; 2^64 - 1 if its voxels are in other files */
    char notes[VOLUME_NOTES_BYTES];
    struct volume_choice choice; /* the user's choice, and its consequences: */
    uint32_t whole[3];           /* the size in the file; `size` is that of the part */
    uint32_t begin[3], step[3];  /* start and step of the part, in voxels of the file */
    uint32_t made[3];            /* the size of the result of volume_take */
};

/* Name, code and colour of a label of a map. */
struct volume_label {
    const char *name, *code; /* "" for none; a code is "SCHEME:VALUE[:MEANING]" */
    uint8_t rgb[3];
    uint32_t number; /* value of its voxels in the map; 0 for the background, and for none */
    bool used;       /* a voxel has it */
};

/* The DICOM series of a scene, to which DICOM SEG refers. */
struct dicom_source {
    struct buf words; /* lines (volume_helper.h), after an empty one */
    bool has_slices;  /* the scene's slices are those of the series, from `first` on */
    uint32_t first;
    char date[9], time[7];
};

/* A map to be written. `row` is called for each row in file order, y faster than z, and fills
 * size[0] values of the type. */
struct volume_map {
    const uint32_t *size; /* [3] */
    const struct geometry *geometry;
    enum voxel_type type;    /* uint8, uint16 or uint32; float32 for NIfTI alone */
    const char *description; /* cut to the length that the format holds */
    void (*row)(void *context, uint32_t y, uint32_t z, void *values);
    void *context;
    const struct volume_label *label;  /* [256], for a map of labels; else NULL */
    const struct dicom_source *source; /* or NULL */
    const struct buf *tail;            /* bytes after the voxels, from a format; or NULL */
};

enum volume_taking { TAKES_FOLDERS = 1, TAKES_LAYOUTS = 2 };

struct volume_format {
    const char *name;    /* "NIfTI" */
    const char *endings; /* ".nii|.nii.gz", of file names */
    unsigned takes;      /* enum volume_taking: other input than files */
    /* Functions that read; NULL if the format is only written. */
    bool (*recognises)(const uint8_t *begin, size_t length);
    enum err (*read_header)(struct volume_header *header, struct volume_source *source,
                            struct fault *fault);
    /* Called before the voxels are read from the same source, at header->offset; or NULL. */
    enum err (*begin_voxels)(const struct volume_header *header, struct volume_source *source,
                             struct fault *fault);
    /* Append the names and colours of the labels in the chosen volume (image/names.h). The source
     * is at its first byte. `held_by`: endings of the files in which `write` keeps them. Both NULL
     * if the format holds none. */
    enum err (*read_names)(struct buf *names, const struct volume_header *header,
                           struct volume_source *source, struct fault *fault);
    const char *held_by;
    /* NULL if the format is only read. */
    enum err (*write)(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault);
};

/* ---- for formats ---- */

/* Check that a file of this size can hold the voxels that its header claims, before anything large
 * is allocated. */
enum err voxels_check(const struct volume_header *header, const struct volume_source *source,
                      struct fault *fault);

/* Set the geometry by the matrix of a header. Distances or orientation are unknown if the header
 * does not state them, or if its matrix is unusable. */
void header_place(struct volume_header *header, const double to_mm[3][4], bool knows_spacing,
                  bool knows_place);

/* Note the number of bytes after the last voxel of a file that is not packed, which is unusual,
 * with this advice. */
void voxels_note_rest(struct volume_header *header, const struct volume_source *source,
                      const char *advice);

/* The part of a file that is gzip. */
enum packing { PACKED_NOT, PACKED_VOXELS, PACKED_WHOLE };

/* For volume_format.write: write `header`, which is released, then the voxels, little-endian. */
enum err voxels_write(const char *path, enum file_mode mode, struct buf *header,
                      enum packing packing, const struct volume_map *map, struct watch *watch,
                      struct fault *fault);

#endif
