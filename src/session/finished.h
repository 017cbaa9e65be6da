/*
 * Labels that leave the session: the forest's, or finished ones (engine/finish.h), which are made
 * when somebody asks for them, and stored until the labels of the forest or the steps are others.
 * An edit does nothing for them, nor do they do anything to what is edited.
 */
#ifndef SESSION_FINISHED_H
#define SESSION_FINISHED_H

#include "engine/finish.h"
#include "engine/labels.h"

struct session;

/* What finished labels are made of. {0} is of nothing. */
struct finish_source {
    uint32_t size[3];      /* of the scene, */
    uint64_t forest;       /* the digest of the forest's labels, */
    uint64_t keys;         /* that of its keys, which tell seeds, */
    uint64_t roi;          /* that of the region of interest, */
    struct finish_list by; /* and the steps */
};

/* Whether the session would make the same labels now. */
bool finish_source_is_present(const struct finish_source *source, const struct session *session);

/* The finished labels that were made last. {0} is none. */
struct finished {
    uint8_t *label; /* [cells] */
    size_t cells;
    struct finish_source of;
    uint64_t digest; /* of what came of it (labels_digest) */
};
void finished_release(struct finished *finished);

/*
 * Labels as they are to be handed out: the forest's, or, where `finished`, what the steps of
 * the state's kept.finish make of them. Borrowed: of use until the next command. The session has a
 * scene and does not skim; edits that wait count for nothing, so session_run comes before.
 * ERR_LIMIT where a step reaches too far for the scene (finish_check), ERR_MEMORY, ERR_CANCELLED.
 */
enum err session_labels(struct session *session, bool finished, struct labels *labels,
                        struct fault *fault);

/* Those that session_labels made last, be they still of the present state or not. */
const struct finished *session_finished(const struct session *session);

/* The digest of the finished labels that session_labels gave last. */
uint64_t session_finished_digest(const struct session *session);

#endif
