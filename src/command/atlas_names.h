/*
 * The table that lies beside an atlas, "aal.nii.txt" beside "aal.nii.gz": what its regions are
 * called. It is looked at for advice alone, and not where a journal of somebody else is replayed.
 */
#ifndef COMMAND_ATLAS_NAMES_H
#define COMMAND_ATLAS_NAMES_H

#include "command/act.h"
#include "report/label_table.h"

/* Empty where there is none that can be read; the caller releases it. */
struct label_table atlas_table(const struct act *act, const char *path);

/* After labels were planted out of FILE, of `regions` and `as`: a line with the command that names
 * them, where one of them (`has`, but for the background) has no name, and the table is there. */
void atlas_advise_names(const struct act *act, const bool has[256]);

#endif
