/*
 * Hints of a session (engine/hints.h), and the margins that they come from: made when somebody asks
 * for them, in about the time of a run, and stored until forest or weights are others. An edit does
 * nothing for them. The margins take two bytes a voxel, and go with the next edit unless they are
 * asked for again.
 */
#ifndef SESSION_HINTING_H
#define SESSION_HINTING_H

#include "engine/hints.h"

struct session;

/* Those that were made last, and what of. {0} is none. */
struct hinting {
    bool has_hints;
    struct hint_list hints;
    uint16_t *margin; /* [cells], or NULL */
    size_t cells;
    uint64_t forest, labels, weights; /* digests */
    unsigned adjacency;
};
void hinting_release(struct hinting *hinting);
size_t hinting_memory(const struct hinting *hinting);

/* Borrowed: of use until the next command. The session has a scene and does not skim; edits that
 * wait count for nothing. ERR_USAGE under `weight polarity`, ERR_MEMORY, ERR_CANCELLED. */
enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            struct fault *fault);
enum err session_find_margins(struct session *session, const uint16_t **margin,
                              struct fault *fault);

#endif
