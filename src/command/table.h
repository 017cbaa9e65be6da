/* SPDX-License-Identifier: MIT */
/* What the commands of the table do: act_NAME carries NAME out (command/act.h). */
#ifndef COMMAND_TABLE_H
#define COMMAND_TABLE_H

#include "base/err.h"

struct act;

/* What `open raw:FILE type=` takes. */
#define OPEN_TYPES "int8|uint8|int16|uint16|int32|uint32|int64|uint64|float32|float64"

/* What `origin by=` and `as=` take: how a procedure was carried over, and what was planted. */
#define ORIGIN_WAYS   "world|landmarks|affine|file"
#define ORIGIN_PLANTS "labels|seeds"

/* act_open.c */
enum err act_open(const struct act *act);
enum err act_interpolate(const struct act *act);
enum err act_orient(const struct act *act);
/* act_view.c */
enum err act_weight(const struct act *act);
enum err act_polarity(const struct act *act);
enum err act_mask(const struct act *act);
enum err act_range(const struct act *act);
/* act.c */
enum err act_label(const struct act *act);
enum err act_label_file(const struct act *act);
/* planting.c */
enum err act_seed(const struct act *act);
enum err act_box(const struct act *act);
enum err act_fill(const struct act *act);
enum err act_outline(const struct act *act);
enum err act_object(const struct act *act);
/* act_labels.c */
enum err act_remove(const struct act *act);
enum err act_run(const struct act *act);
/* act_seed_file.c */
enum err act_seed_file(const struct act *act);
/* act_labels.c */
enum err act_labels(const struct act *act);
/* act_ask.c */
enum err act_landmark(const struct act *act);
enum err act_origin(const struct act *act);
/* act_history.c */
enum err act_undo(const struct act *act);
enum err act_redo(const struct act *act);
enum err act_goto(const struct act *act);
enum err act_branch(const struct act *act);
enum err act_history(const struct act *act);
enum err act_journal(const struct act *act);
enum err act_sync(const struct act *act);
/* act_view.c */
enum err act_view(const struct act *act);
enum err act_turn(const struct act *act);
enum err act_zoom(const struct act *act);
enum err act_pan(const struct act *act);
enum err act_focus(const struct act *act);
enum err act_hide(const struct act *act);
enum err act_show(const struct act *act);
enum err act_opacity(const struct act *act);
enum err act_clip(const struct act *act);
enum err act_plane(const struct act *act);
enum err act_cut(const struct act *act);
enum err act_set(const struct act *act); /* all settings (session/setting.h) */

/* act_picture.c */
enum err act_render(const struct act *act);
enum err act_cross(const struct act *act);
enum err act_window(const struct act *act);
enum err act_magnify(const struct act *act);
enum err act_slice(const struct act *act);
enum err act_mosaic(const struct act *act);
/* act_picture.c */
enum err act_spin(const struct act *act);
/* act_save.c */
enum err act_golden(const struct act *act);
/* act_save.c */
enum err act_finish(const struct act *act);
enum err act_save(const struct act *act);
/* act_ask.c */
enum err act_pick(const struct act *act);
enum err act_measure(const struct act *act);
enum err act_profile(const struct act *act);
enum err act_why(const struct act *act);
enum err act_hints(const struct act *act);
enum err act_hint(const struct act *act);
/* act_figures.c */
enum err act_stats(const struct act *act);
enum err act_compare(const struct act *act);
/* answers.c */
enum err act_info(const struct act *act);
enum err act_help(const struct act *act);
enum err act_pilot(const struct act *act);
enum err act_quit(const struct act *act);

#endif
