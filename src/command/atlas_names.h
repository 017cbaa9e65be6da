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

/* After labels were planted out of the file that the first parameter names: a line with the command
 * that names them, where one of them (`has`, but for the background) has no name, and the table is
 * there. `regions` and `as` are the parameters of these names. */
void atlas_advise_names(const struct act *act, const bool has[256], const struct value *regions,
                        const struct value *as);

#endif
