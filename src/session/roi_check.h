/*
 * What a region of interest must fulfil before a session takes it on, and what a range of real
 * values is in intensities. Nothing is changed here.
 */
#ifndef SESSION_ROI_CHECK_H
#define SESSION_ROI_CHECK_H

#include "engine/roi.h"
#include "engine/forest.h"
#include "image/levels.h"

/* ERR_INPUT where nothing would be inside, or where seeds would be outside: those planted in the
 * scene, and those that a run of the pending edits, in their order, would plant. */
enum err roi_check(const struct roi *roi, const struct scene *scene, const struct edit *pending,
                   size_t pendings, struct fault *fault);

/* Makes roi->low..high the intensities whose real values lie in a range (image/levels.h); low is
 * above high where there are none. */
struct interval roi_range(struct roi *roi, const struct geometry *geometry,
                          const struct levels *levels, const struct decimal range[2]);

#endif
