/* SPDX-License-Identifier: MIT */
/* Functions of the commands: act_NAME executes NAME (command/act.h). */
#ifndef COMMAND_TABLE_H
#define COMMAND_TABLE_H

#include "base/err.h"

struct act;
typedef enum err act_function(const struct act *act);

/* Voxel types of `open raw:FILE type=`. */
#define OPEN_TYPES "int8|uint8|int16|uint16|int32|uint32|int64|uint64|float32|float64"

/* Values of `origin by=` and `as=`: transfer of a procedure, and its seeds. */
#define ORIGIN_WAYS   "world|landmarks|affine|file"
#define ORIGIN_PLANTS "labels|seeds"

/* act.c */
act_function act_label, act_label_file;
/* act_open.c */
act_function act_open, act_interpolate, act_orient;
/* act_ask.c */
act_function act_landmark, act_origin, act_pick, act_measure, act_profile, act_why, act_hints,
    act_hint;
/* planting.c */
act_function act_seed, act_box, act_fill, act_outline, act_between, act_object;
/* act_seed_file.c */
act_function act_seed_file;
/* act_labels.c */
act_function act_labels, act_remove, act_run;
/* act_history.c */
act_function act_undo, act_redo, act_goto, act_branch, act_history, act_journal, act_sync;
/* act_view.c; act_set executes all settings (session/setting.h) */
act_function act_weight, act_channel, act_show_channel, act_polarity, act_mask, act_range, act_view,
    act_turn, act_zoom, act_pan, act_focus, act_hide, act_show, act_opacity, act_clip, act_plane,
    act_cut, act_set;
/* act_picture.c */
act_function act_render, act_spin, act_cross, act_window, act_magnify, act_slice, act_mosaic;
/* act_save.c */
act_function act_golden, act_finish, act_save;
/* act_figures.c */
act_function act_stats, act_compare;
/* answers.c */
act_function act_info, act_help, act_pilot, act_quit;

#endif
