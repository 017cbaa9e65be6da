/*
 * Regions: which numbers of a map or a table are chosen, and which labels they become.
 *
 * Atlases number their regions up to 65533, and labels are 1..255 (0 for the background), so a user
 * chooses: regions "2001,2002,2101-2110" as "1,2,11-20", the first region the first label and so
 * on.
 */
#ifndef SESSION_REGIONS_H
#define SESSION_REGIONS_H

#include <stddef.h>
#include <stdint.h>

#include "base/err.h"

enum { REGION_MOST = 65533, REGION_NONE = 65535 };

/* The label that each region becomes, [REGION_MOST + 1], freed by free(); REGION_NONE for one that
 * is not chosen. `regions` NULL chooses 1..REGION_MOST. `labels` NULL gives each its own number,
 * which may be none of a label. Both are lists as the parser takes them. ERR_USAGE where they are
 * not of one length, or choose a region twice. */
enum err regions_new(uint16_t **as, const char *regions, const char *labels, struct fault *fault);

#endif
