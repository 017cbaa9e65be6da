/*
 * What is written over slices where pixels are too few for letters: the patient's sides and a scale
 * bar, as characters in cells of the screen.
 *
 * Sides are named only where the scene's file says how it lies in the patient.
 */
#ifndef PROGRAM_PILOT_NOTES_H
#define PROGRAM_PILOT_NOTES_H

#include "show/slicing.h"
#include "tui/picture/image_view.h"

enum { PILOT_NOTES_MOST = 64 };

/* Draws the bar into the canvas, on which the panel is, and fills in the notes. Returns how
 * many. */
size_t pilot_notes_add(struct image_note note[PILOT_NOTES_MOST], const struct canvas *canvas,
                       const struct session *session, const struct slicing_panel *panel);

#endif
