/* SPDX-License-Identifier: MIT */
/*
 * Volumes: scenes and maps in files, whatever their format.
 *
 * A format is a `struct volume_format` (image/volume_format.h), and one row of VOLUME_FORMATS. A
 * file belongs to the format that recognises its first bytes (inflated, for a gzip file); otherwise
 * to the format of the ending of its name, which then reports the error.
 *
 * Intensities have 16 bits, whatever the type in the file; geometry.slope and .intercept convert
 * them to real values (image/image_inside.h).
 *
 * Every claim of a file is checked first: no more is allocated than the size of the file can
 * account for, and no more is inflated than the header and the voxels (and 64 kB after them, to
 * reach the checksum of a gzip).
 */
#ifndef IMAGE_VOLUME_H
#define IMAGE_VOLUME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/volume_format.h"

#define HELPED_NOTE                                                                                \
    "The helper iftty-volume reads DICOM (folders with subfolders, Siemens mosaics, SEG), "        \
    "other NRRD, MetaImage, MINC, HDF5, MRC, TIFF stacks, folders of TIFF, PNG or BMP slices, "    \
    "VTK and GIPL. Orientation or spacing that is not in a file remains unknown. "

/* The formats, and a sentence about each for the help. */
#define VOLUME_FORMATS(ROW)                                                                        \
    ROW(nifti_format, "NIfTI is .nii or .nii.gz, with integers or real numbers. ")                 \
    ROW(pair_format,                                                                               \
        "For ANALYZE and NIfTI in two files, .hdr and .img, plain or .gz, name one of them. ")     \
    ROW(mgh_format, "FreeSurfer's .mgh and .mgz are read and written. ")                           \
    ROW(nrrd_format,                                                                               \
        "NRRD with header and voxels in one file, plain or gzip, is read and written. ")           \
    ROW(metaimage_format, "")                                                                      \
    ROW(seg_format, "")                                                                            \
    ROW(raw_format, "")                                                                            \
    ROW(helped_format, HELPED_NOTE)

/* The ending of a name that belongs to some format, ".nii.gz"; NULL if there is no such format. */
const char *volume_ending(const char *path);

/* Guess by the first bytes of a file whether it is a volume or a picture. */
enum volume_guess {
    GUESS_UNKNOWN,
    GUESS_PATIENT, /* DICOM, whose metadata name a patient: readers of pictures would print them */
    GUESS_TIFF,    /* a volume, a slice or a picture */
    GUESS_VOLUME,  /* a volume, or a format that volume_begin refuses with advice */
};
enum volume_guess volume_guess(const char *path);

/* Pairs of NIfTI and ANALYZE: a header in one file and its voxels in another next to it, A.hdr and
 * A.img. Either may be gzip, as A.hdr.gz and A.img.gz, and either path opens the pair. */
#define PAIR_HEADERS ".hdr|.hdr.gz"
#define PAIR_VOXELS  ".img|.img.gz"

/* `other` is the path of the other file of the pair of `path`; if there are two, the one that is
 * packed as `path` is. Otherwise false, and `other` is the expected path; "" for a name that
 * belongs to no pair. */
bool pair_other(struct buf *other, const char *path);

/* An open file whose header was read and accepted; no voxels are held yet. So a caller can look at
 * its size first. */
struct volume_reader {
    const char *path; /* not owned */
    const struct volume_format *format;
    struct volume_header header;
    struct volume_source source;
};

/* Open a volume; choice and watch may be NULL. Always call volume_close. Refuses every file that
 * volume_take would refuse before it reads a voxel. */
enum err volume_open(struct volume_reader *reader, const char *path,
                     const struct volume_choice *choice, struct watch *watch, struct fault *fault);

/* The same in two steps, for callers whose choice depends on the header: its size and geometry are
 * those of the whole file until volume_choose, with another choice, or NULL for the first one. */
enum err volume_begin(struct volume_reader *reader, const char *path,
                      const struct volume_choice *choice, struct watch *watch, struct fault *fault);
enum err volume_choose(struct volume_reader *reader, const struct volume_choice *choice,
                       struct fault *fault);

/* Read the voxels of an open volume, and convert them to intensities. On failure *out is empty. */
enum err volume_take(struct volume *out, struct volume_reader *reader, struct fault *fault);
void volume_close(struct volume_reader *reader);

/* Append the names and colours of the labels in the file of a volume that was taken, as lines of a
 * table (image/names.h); nothing for a file without. A damaged table is described in a note. */
enum err volume_read_names(struct buf *names, const struct volume_reader *reader,
                           char notes[VOLUME_NOTES_BYTES], struct fault *fault);

/* True if maps of this name hold names and colours of labels. */
bool volume_holds_names(const char *path);

/* Open, read and close a volume; choice and watch may be NULL. Needs two bytes a voxel, four or
 * eight while wider numbers are read. On failure *out is empty, and the message has the error and
 * the expected value: ERR_INPUT for content, ERR_LIMIT, ERR_IO, ERR_MEMORY, ERR_CANCELLED. */
enum err volume_read(struct volume *out, const char *path, const struct volume_choice *choice,
                     struct watch *watch, struct fault *fault);

/* Write a map as `path`, in the format of its name, atomically; the watch may be NULL. The same
 * values yield the same bytes: a gzip file has no time and no name. */
enum err volume_write(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault);

/* Formats that are not read, by their first bytes or their names, with advice how to convert them.
 * A row without bytes is recognised by its name. */
struct foreign {
    const char *endings; /* or the whole name */
    unsigned at, length;
    const char *bytes, *advice;
};

/* The last row has no advice. A format that is read must not have a row (tests/test_foreign.c). */
extern const struct foreign foreign_formats[];

#endif
