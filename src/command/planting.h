/* SPDX-License-Identifier: MIT */
/* Planting, as all commands that plant do it (planting.c). */
#ifndef COMMAND_PLANTING_H
#define COMMAND_PLANTING_H

#include "command/act.h"
#include "image/levels.h"
#include "session/paint.h"

/* What a command plants: how many voxels it was, and how many not, for being outside the region of
 * interest, or beyond the intensities `within`, or, for a shell, of an object that is neither the
 * one inside nor the shell's own label. */
struct planting {
    struct interval within;
    uint16_t reach; /* of the seeds (forest_add_reach), or 0 */
    bool is_shell;
    uint8_t inside; /* the label of the object inside a shell */
    bool yields;    /* it is the piece of a segmentation (session_plant_piece), of these runs: */
    const struct marker_run *run;
    size_t runs;
    size_t planted, outside, beyond, others;
    size_t unsure; /* taken or not, of levels that the range splits */
};

/* `range` is the parameter of that name, given or not, or NULL. */
struct planting act_begin_planting(const struct session *session, const struct value *range);

/* Plants one more marker, of those of the cells that may be planted, which come to the front. */
enum err act_plant(const struct act *act, struct planting *planting, uint32_t *cell, size_t count,
                   int16_t label);

/* Says what was left out; ERR_INPUT where that was all. */
enum err act_write_planting(const struct act *act, const struct planting *planting);

/* Of so many voxels, the level stands for values on both sides of an end of a range: says so, and
 * how large a level is; nothing of none. */
void act_write_unsure(const struct act *act, size_t voxels);

/* The voxels of a ball of `radius` at PLACE, or, where `to` is not NULL and given, of a stroke. */
enum err act_find_voxels(const struct act *act, const struct value *to, struct voxels *voxels);

/* The word of a record that says what a command found in the forest, so that a session which
 * continues the journal needs none to know it. */
struct record_word;
bool act_find_recorded(const struct act *act, const char *key, struct record_word *word);

/* Adds to the words of the record the numbers of the markers that the command has put up. */
void act_add_markers(const struct act *act);

#endif
