/* SPDX-License-Identifier: MIT */
/* What is said of a session: the lines of `info`, and the words of them that other answers have
 * (answers.c). */
#ifndef COMMAND_ANSWERS_H
#define COMMAND_ANSWERS_H

#include "command/act.h"
#include "image/geometry.h"

/* A line: where a voxel is, its intensity, its label, and the seed of its tree. */
void act_write_voxel(struct buf *out, const struct session *session, uint32_t cell);

/* A line where edits wait for `run`: what was answered of the labels is without them. */
void act_write_waiting(const struct act *act);

/* A line where there is nothing to answer about. */
void act_write_no_seeds(const struct act *act);

/* Adds "1234 voxels changed, label 3 brain: 1.24 l (+12 ml), label 2: 142 ml, 12.3 ms": the voxels
 * that have another label; the volumes of the labels that became larger or smaller, the largest
 * first, at most six of them and never that of label 0; and the time. For a command that has edited
 * the forest, after session_count_before and session_count_labels. Where finished labels are shown,
 * "1234 voxels changed before finishing" since the volumes are those of the forest. */
void volumes_write(struct buf *out, const struct session *session, bool is_finished,
                   uint64_t took_ns);

/* After it, for a surprise (show/surprise.h): "this `seed` took 1.2 l of label 1 brain through
 * 93,40,61; undo takes it back". NULL: what waited has. */
void surprise_write(struct buf *out, struct session *session, const char *command);

/* A line about the seed that would take a voxel, but ends before it (`seed within=`). */
void act_write_refusal(struct buf *out, const struct session *session, uint32_t cell);

/* " of 1x1x1.5 mm" or " of unknown size"; "axes towards RAS". */
void act_write_spacing(struct buf *out, const struct session *session);
void act_write_axes(struct buf *out, const struct geometry *geometry);

/* "gauss 1.5", "polarity 1:50 2:-20", "of edges.nii" */
void act_write_weight(struct buf *out, const struct kept *kept);

/* A line: the region of interest, and how many voxels are inside; nothing where there is none. */
void act_write_region(struct buf *out, const struct session *session);

/* "finish    majority radius=1, largest" as a line, and whether pictures show it; nothing where
 * there are no steps. */
void act_write_finish(struct buf *out, const struct session *session);

/* What slices show: "through 90,108,90: axial 90, ...; window 0 142, overlay contour". */
void act_write_slices(struct buf *out, struct session *session);

#endif
