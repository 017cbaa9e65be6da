/* SPDX-License-Identifier: MIT */
/* What regions of an atlas become, and what they are called (act_names.c). */
#ifndef COMMAND_ACT_NAMES_H
#define COMMAND_ACT_NAMES_H

#include "command/act.h"
#include "show/label_table.h"

/* regions_new of `regions` and `as`, by the own numbers of labels (session/map.h); ERR_USAGE
 * where a label for all is given too, which may be NULL. */
enum err act_choose_regions(uint16_t **as, const struct act *act, const struct value *label);

/*
 * The table that lies beside an atlas, "aal.nii.txt" beside "aal.nii.gz": what its regions are
 * called. It is looked at for advice alone, and not where a journal of somebody else is replayed.
 */

/* Empty where there is none that can be read; the caller releases it. */
struct label_table atlas_table(const struct act *act, const char *path);

/* After labels were planted out of FILE, of `regions` and `as`: a line with the command that names
 * them, where one of them (`has`, but for the background) has no name, and the table is there. */
void atlas_advise_names(const struct act *act, const bool has[256]);

#endif
