/* SPDX-License-Identifier: MIT */
/*
 * The volume helper: all volumes that no reader of this process accepts, by ITK, GDCM and HDF5 in a
 * separate process.
 *
 * The program iftty-volume is started for one file or folder, confines itself to reading that one
 * and the files below its folder that the header names (Landlock, seccomp, limits), and then ends.
 * Its answers are trusted no more than the file: sizes are checked before anything is allocated,
 * and numbers before they are used. Its texts never quote the file (a patient's name, a date),
 * except names of data sets and of segments, names of unreadable files in a header, and
 * descriptions of series when the user has to choose one. Damaged files of a folder are named.
 *
 * The protocol, as in coprocess.h:
 *
 *     request   open KIND FLAGS SERIES VOLUME THRESHOLD STEP WORD_LENGTH SKIP_LENGTH DATA_LENGTH
 *                 SEGMENTS_LENGTH ROOM_LENGTH PATH_LENGTH\n
 *                 word  skip  data  segments  room  path
 *     answer    any number of
 *                 progress DONE TOTAL\n
 *               and then any of these, once
 *                 series NUMBER\n
 *                 list LENGTH\n  lines
 *                 segments OVERLAPS LENGTH\n  names
 *                 references LENGTH\n  lines
 *                 contents LENGTH\n  words
 *               and then
 *                 volume NX NY NZ VOLUMES KNOWN FORMAT_LENGTH TYPE_LENGTH NOTES_LENGTH\n
 *                   format  type  notes  14 numbers
 *               or
 *                 error LENGTH\n  words
 *     request   voxels\n
 *     answer    any number of
 *                 piece LENGTH\n  bytes
 *               up to the last voxel, or an error
 *
 * KIND is a word of the table in volume_helper.c. FLAGS: 1 follow links in a folder, 2 replace
 * missing slices by blank ones, 4 send a list of series or of volumes with words of their files, 8
 * refuse voxels in other files and a choice of data sets, 16 VOLUME was chosen, 32 send references
 * to the series, 64 with its patient and study. SERIES counts from 1; 0 is the only one, or the one
 * whose description contains the word; the answer has its NUMBER. Skip: names of files to leave
 * out, separated by commas. VOLUME counts from 0. Data: the name of a data set. Segments: those of
 * DICOM SEG to read, as "3,5-7"; THRESHOLD: that of its fractions, in thousandths, and 0 for none;
 * STEP: the distance of the scene's slices in nanometres, or 0. OVERLAPS: voxels in several
 * segments; their names are lines of a table (image/names.h). References: attributes of the series,
 * "TAG VALUE", and a line "slice CLASS INSTANCE FRAME" for each slice, FRAME from 1, or 0 for a
 * file of one; without UIDs for a missing slice. Room: a folder in which the helper may write, if
 * any; the client removes it. KNOWN: 1 the spacing, 2 the place, 4 its voxels may be compressed
 * better than by gzip. The numbers are doubles of this machine: the three rows of the matrix to the
 * world (right, anterior, superior; millimetres), slope and intercept. Voxels are of the type, in
 * the order of this machine, x fastest.
 */
#ifndef IMAGE_VOLUME_HELPER_H
#define IMAGE_VOLUME_HELPER_H

#include <stdbool.h>
#include <stdint.h>

#include "image/volume_format.h"

#define VOLUME_HELPER "iftty-volume" /* the program (coprocess_find) */

/* Two functions of volume_format, for formats that pass some files to the helper. */
enum err volume_helper_read_header(struct volume_header *out, struct volume_source *source,
                                   struct fault *fault);
enum err volume_helper_begin_voxels(const struct volume_header *header,
                                    struct volume_source *source, struct fault *fault);

/* For tests: another program, NULL for iftty-volume (coprocess_find); and the time limit of a
 * silent helper, without a second for each 20 MB of voxels. */
extern const char *volume_helper_program;
extern int volume_helper_patience_ms;

/* For the journals of strangers: limit of its memory in bytes (0: the free memory), and whether to
 * ignore links in a folder. */
extern uint64_t volume_helper_memory_most;
extern bool volume_helper_is_wary;

/* Read nothing if the kernel does not confine the helper. */
extern bool volume_helper_needs_landlock;

#endif
