/* SPDX-License-Identifier: MIT */
/*
 * Volumes: scenes and maps in files, whatever their format.
 *
 * A format is one file, which defines a `struct volume_format` (image/volume_format.h), and one row
 * of VOLUME_FORMATS. A file belongs to the format that recognises its first bytes (of a gzip file,
 * those inside it), or else to the format whose ending its name has, which then says what is wrong
 * with it.
 *
 * Intensities are held as 16 bits whatever a file holds; geometry.slope and .intercept lead back
 * to real values (image/quantise.h).
 *
 * Nothing a file claims is believed before it is checked: no more is allocated than the size of
 * the file can account for, and no more is inflated than the header and the voxels (and 64 kB
 * after them, to reach the checksum of a gzip).
 */
#ifndef IMAGE_VOLUME_H
#define IMAGE_VOLUME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "image/volume_format.h"

#define HELPED_NOTE                                                                                \
    "DICOM (a folder, with its subfolders; mosaics of Siemens), other NRRD, MetaImage, MINC, "     \
    "HDF5, MRC, TIFF stacks, folders of TIFF, PNG or BMP slices, VTK and GIPL are read by "        \
    "iftty-volume, a program beside iftty. "                                                       \
    "What a file does not say of orientation and spacing stays unknown. "

/* The formats, and a sentence about each for the help. */
#define VOLUME_FORMATS(ROW)                                                                        \
    ROW(nifti_format, "NIfTI is .nii or .nii.gz of any whole or real numbers. ")                   \
    ROW(pair_format,                                                                               \
        "ANALYZE and NIfTI in two files, .hdr and .img or .gz, are named by either. ")             \
    ROW(mgh_format, "FreeSurfer's .mgh and .mgz are read and written, too. ")                      \
    ROW(nrrd_format,                                                                               \
        "NRRD is read and written with its voxels after its header, plain or as gzip. ")           \
    ROW(metaimage_format, "")                                                                      \
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
 * packed as `path` is. If there is none, false, and `other` is the path that it would have; "" for
 * a name that belongs to no pair. */
bool pair_other(struct buf *other, const char *path);

/* An open file whose header was read and accepted; no voxels are held yet. So a caller can look at
 * its size first. */
struct volume_reader {
    const char *path; /* the caller's */
    const struct volume_format *format;
    struct volume_header header;
    struct volume_source source;
};

/* Takes the choice (or NULL), and works under the watch (or NULL) until it is closed, which is to
 * be done in any case. Refuses what volume_take would refuse before it reads a voxel. */
enum err volume_open(struct volume_reader *reader, const char *path,
                     const struct volume_choice *choice, struct watch *watch, struct fault *fault);

/* The same in two steps, for callers whose choice depends on the header: its size and geometry are
 * those of the whole file until something is chosen, by another choice than at the beginning, or
 * by that (NULL). */
enum err volume_begin(struct volume_reader *reader, const char *path,
                      const struct volume_choice *choice, struct watch *watch, struct fault *fault);
enum err volume_choose(struct volume_reader *reader, const struct volume_choice *choice,
                       struct fault *fault);

enum err volume_take(struct volume *out, struct volume_reader *reader, struct fault *fault);
void volume_close(struct volume_reader *reader);

/* All three: the scene in `path` by that choice (or NULL), under a watch (or NULL). It takes two
 * bytes a voxel, four or eight while such numbers are read, and as much as the file where a gzip is
 * inflated whole. On failure *out is empty and the words say what was wrong and what was expected:
 * ERR_INPUT for content, ERR_LIMIT, ERR_IO, ERR_MEMORY, ERR_CANCELLED. */
enum err volume_read(struct volume *out, const char *path, const struct volume_choice *choice,
                     struct watch *watch, struct fault *fault);

/* Writes a map as `path`, in the format that the name says; whole or not at all, as where the watch
 * (or NULL) stops it. The same values give the same bytes: a gzip file has no time and no name. */
enum err volume_write(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault);

/* Formats that nobody here reads, known by their first bytes or their names, and what converts
 * them. */

/* By its bytes; a name alone where there are none. */
struct foreign {
    const char *endings; /* or the whole name */
    unsigned at, length;
    const char *bytes, *advice;
};

/* Up to one without advice. What a format reads that there is now, has no place here
 * (tests/test_foreign.c). */
extern const struct foreign foreign_formats[];

#endif
