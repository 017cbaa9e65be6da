/*
 * The words that a golden image carries beside its pixels (show/export_picture.c): from semantics 9
 * on they are those that the picture drawn now would carry, and none is missing. Which journal it
 * was of, at which record, and which version drew it, is of the time at which it was made: of those
 * only the form is looked at.
 */
#ifndef COMMAND_GOLDEN_NOTES_H
#define COMMAND_GOLDEN_NOTES_H

#include "image/picture.h"

/* Whether it is one of those, and of their form. */
bool golden_note_is_of_its_time(const struct attribute *note);

/* OK, or ERR_CHECK with the first that differs. Of a scene that was opened in place of another the
 * name counts for nothing (!names_scene). */
enum err golden_compare_notes(const struct picture *kept, const struct picture *drawn,
                              bool names_scene, struct fault *fault);

#endif
