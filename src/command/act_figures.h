/* SPDX-License-Identifier: MIT */
/* Counts of labels (act_figures.c). */
#ifndef COMMAND_ACT_FIGURES_H
#define COMMAND_ACT_FIGURES_H

#include "command/act.h"

/* A line for each label that has voxels: its seeds, voxels and volume. */
enum err act_write_counts(const struct act *act);

#endif
