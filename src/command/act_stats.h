/* Counts of labels (act_stats.c). */
#ifndef COMMAND_ACT_STATS_H
#define COMMAND_ACT_STATS_H

#include "command/act.h"

/* A line for each label that has voxels: its seeds, voxels and volume. */
enum err act_write_counts(const struct act *act);

#endif
