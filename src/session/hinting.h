/*
 * Hints of a session (engine/hints.h), and their heat: made when somebody asks for them, in about
 * the time of a run, and stored until forest or weights are others. An edit does nothing for them.
 */
#ifndef SESSION_HINTING_H
#define SESSION_HINTING_H

#include "engine/hints.h"

struct session;

/* Those that were made last, and what of. {0} is none. */
struct hinting {
    bool has_hints;
    struct hint_list hints;
    uint8_t *heat; /* [cells], or NULL */
    size_t cells;
    uint64_t forest, labels, weights; /* digests */
    unsigned adjacency;
};
void hinting_release(struct hinting *hinting);
size_t hinting_memory(const struct hinting *hinting);

/* Borrowed: of use until the next command. The session has a scene and does not skim; edits that
 * wait count for nothing. The heat, where it is asked for, takes a byte a voxel until the next
 * edit. ERR_USAGE under `weight polarity`, ERR_MEMORY, ERR_CANCELLED. */
enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            const uint8_t **heat, struct fault *fault);

#endif
