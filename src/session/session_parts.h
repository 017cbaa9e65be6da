/* What the files of a session share: session.c (its life), go.c (the one way to change it), open.c
 * (scenes), measures.c (of labels), seeds.c (seeds and markers), draw.c (pictures), finished.c and
 * live_finish.c (finished labels). */
#ifndef SESSION_SESSION_PARTS_H
#define SESSION_SESSION_PARTS_H

#include "session/session.h"

/* Back to no scene, whatever there is of one. */
void session_close_scene(struct session *session);

/* Has the geometry and the scene's axes follow from what the file says, and `orient`. */
void session_place(struct session *session, const struct kept *kept);

/* Whether the cells of a plain scene may wait, since all that opening it has to say can be said
 * without them; and says it: `weight_digest`. */
bool session_may_wait(const struct session *session);
enum err session_foretell(struct session *session, struct fault *fault);

/* Before the next command: what the tally was before the last one that edited. */
void session_note_edit(struct session *session);

void session_release_rendition(struct session *session);

/* The camera of an outlook; ERR_LIMIT where there is none. */
enum err session_aim(const struct session *session, const struct outlook *outlook,
                     struct camera *camera, struct fault *fault);
void session_take_camera(struct session *session, const struct camera *camera);

/* The seeds that some voxels belong to: the voxel itself where one waits to be planted there, else
 * the root of its tree. One that several belong to is there as often. An array that the caller
 * frees, after errors too; it may be empty. */
enum err session_find_seeds(const struct session *session, const uint32_t *cell, size_t count,
                            uint32_t **seed, size_t *seeds, struct fault *fault);

/* The rendition after such a change of the labels that it shows, whose border is up to date. What
 * cannot be coloured is drawn when it is asked for. */
void session_follow_rendition(struct session *session, enum rendered as,
                              const struct changes *changes);

/* Colours of what the maps of the rendition show, and the picture at the size of the view. */
enum err session_colour(struct session *session, const struct border *border, struct fault *fault);

#endif
