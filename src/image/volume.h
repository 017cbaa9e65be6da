/*
 * Volumes: scenes and maps in files, whatever their format.
 *
 * A format is one file, which defines a `struct volume_format`, and one row of VOLUME_FORMATS. A
 * file belongs to the format that recognises its first bytes (of a gzip file, those inside it), or
 * else to the format whose ending its name has, which then says what is wrong with it.
 *
 * Intensities are held as 16 bits whatever a file holds; geometry.slope and .intercept lead back
 * to real values (image/intensities.h).
 *
 * Nothing a file claims is believed before it is checked: no more is allocated than the size of
 * the file can account for, and no more is inflated than the header and the voxels (and 64 kB
 * after them, to reach the checksum of a gzip).
 */
#ifndef IMAGE_VOLUME_H
#define IMAGE_VOLUME_H

#include <stdbool.h>
#include <stdint.h>

#include "base/err.h"
#include "base/file.h"
#include "base/watch.h"
#include "image/geometry.h"
#include "image/levels.h"
#include "image/raw.h"
#include "image/source.h"

#define HELPED_NOTE                                                                                \
    "DICOM (a folder, with its subfolders; mosaics of Siemens), NRRD, MetaImage, MINC, HDF5, "     \
    "MRC, TIFF stacks, folders of TIFF or PNG slices, VTK and GIPL are read by iftty-volume, a "   \
    "program beside iftty; so are LSM, GE, Siemens Vision, Bruker and Stimulate, untested for "    \
    "want of files. "                                                                              \
    "What a file does not say of orientation and spacing stays unknown. "

/* The formats, and a sentence about each for the help. */
#define VOLUME_FORMATS(ROW)                                                                        \
    ROW(nifti_format, "NIfTI is .nii or .nii.gz of any whole or real numbers. ")                   \
    ROW(pair_format,                                                                               \
        "ANALYZE and NIfTI in two files, .hdr and .img or .gz, are named by either. ")             \
    ROW(mgh_format, "FreeSurfer's .mgh and .mgz are read and written, too. ")                      \
    ROW(nrrd_format, "")                                                                           \
    ROW(metaimage_format, "")                                                                      \
    ROW(raw_format, "")                                                                            \
    ROW(helped_format, HELPED_NOTE)

/* Lines for the user, on what a file leaves open, or holds and is not as it should be; each ends
 * with a line feed. What does not fit any more is left out. */
enum { VOLUME_NOTES_BYTES = 1536, VOLUME_WORD_BYTES = 33 };
void volume_note(char notes[VOLUME_NOTES_BYTES], const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* What of a file is to be read, where there is a choice. All zero: the one volume that it holds. */
enum { REDUCE_MOST = 16 };
struct buf;
struct volume_choice {
    bool has_volume; /* of a series, this one, counted from 0: */
    uint32_t volume;
    bool has_crop; /* of a volume, this part (image/part.h): */
    uint32_t first[3], last[3];
    uint32_t reduce;  /* 0 and 1: voxels as they are */
    bool nearest;     /* reduce: take the middle of each block, for labels */
    bool straightens; /* of sheared axes, the part on a straight grid (image/straighten.h) */
    uint32_t series;  /* of the series of DICOM in a folder, counted from 1; 0: the only one */
    const char *series_name; /* or a piece of its description; NULL: not said. Not owned */
    const char *skip;        /* files of a folder to leave out, NAME,NAME; NULL: none. Not owned */
    bool fills_gaps;         /* blank slices take the place of those that are missing */
    const char *data;        /* the name of a data set of HDF5; NULL: the only one. Not owned */
    struct raw_layout raw;   /* of voxels without a header */
    uint32_t spacing_nm[3];  /* of a file that does not say it; 0: none */
    const char *proof; /* the digest that the scene is to have (engine/scene.h), or there is none;
                                NULL: any. Not owned */
    bool huge;         /* the user knows that the file swells as no scene does */
    struct buf *list;  /* where what a folder holds is said in lines, with words of its files, when
                          one of several series is to be chosen: for the screen, and kept nowhere;
                          NULL: no such word comes out. Not owned */
    bool folders_as_before; /* mosaics of DICOM are one slice, and damaged files are left out */
    bool by_extremes;       /* scales of reals and of wide whole numbers reach from the least to the
                          greatest, as before MEANING_LEVELS (session/semantics.h) */
    bool whole_are_exact;   /* and yet real numbers that are whole, and fit 16 bits, are exact */
    bool as_recorded; /* series, fills_gaps and data are left out, and this is noted, where the
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

/* What the header of a file says. */
struct volume_header {
    uint32_t size[3];
    struct geometry geometry;       /* slope and intercept are those of the numbers in the file */
    char format[VOLUME_WORD_BYTES]; /* "nifti-1" */
    char type_name[VOLUME_WORD_BYTES]; /* of voxels, "int16" */
    bool big_endian;
    uint32_t volumes;  /* of a series; 1 for a scene */
    uint32_t series;   /* of DICOM that it is, counted from 1; 0: the format has none */
    char refusal[160]; /* why its voxels cannot be read; "" where they can: */
    enum voxel_type type;
    uint64_t offset; /* bytes before the voxels, of all volumes */
    uint64_t bytes;  /* of the file on disk; 2^64 - 1 where its voxels lie in others */
    char notes[VOLUME_NOTES_BYTES];
    struct volume_choice choice; /* for read_voxels: of what there is; and what follows from it: */
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
    enum voxel_type type;    /* uint8, uint16 or uint32 */
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
    /* The three that read; NULL where the format is only written. */
    bool (*recognises)(const uint8_t *begin, size_t length);
    enum err (*read_header)(struct volume_header *header, struct volume_source *source,
                            struct fault *fault);
    /* The voxels after read_header on the same source; voxels_read serves plain ones. */
    enum err (*read_voxels)(struct volume *volume, const struct volume_header *header,
                            struct volume_source *source, struct watch *watch, struct fault *fault);
    /* NULL where the format is only read. */
    enum err (*write)(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault);
};

/* The part of a name by which some format knows its files, ".nii.gz"; NULL where there is none. */
const char *volume_ending(const char *path);

/* Whether it is a file whose notes are about a patient (DICOM): a reader of pictures would show
 * them, and none of volumes does. */
bool volume_may_name_a_patient(const char *path);

/* Whether its first bytes are those of a volume and of no slice, or of a format that is refused
 * with what converts it: then volume_about has more to say of it than a reader of pictures. */
bool volume_is_known(const char *path);

/* What the header of `path` says, of voxels that cannot be read too (as those of the root map that
 * `save` writes). Others are refused where volume_read would refuse the header. */
enum err volume_about(struct volume_header *out, const char *path, struct fault *fault);

/* A file that is open to be read: its header is known and was found good, of its voxels nothing is
 * held. So a caller can see how large it is before. */
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
void volume_release(struct volume *volume);

/* Writes a map as `path`, in the format that the name says; whole or not at all, as where the watch
 * (or NULL) stops it. The same values give the same bytes: a gzip file has no time and no name. */
enum err volume_write(const char *path, enum file_mode mode, const struct volume_map *map,
                      struct watch *watch, struct fault *fault);

#endif
