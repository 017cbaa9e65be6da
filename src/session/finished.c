#include "session/session.h"

#include <string.h>

#include "base/mem.h"

void finished_release(struct finished *finished)
{
    mem_pages_free(finished->label, finished->cells);
    *finished = (struct finished){0};
}

/* Whether they are those of the present labels and steps. */
static bool is_made(const struct session *session)
{
    const struct finished *f = &session->finished;
    return f->label && f->forest == forest_label_digest(session->forest) &&
           (!finish_heeds_seeds(&f->by) ||
            (f->keys == forest_digest(session->forest) && f->roi == session->roi_tally.digest)) &&
           memcmp(f->size, session->scene->grid.size, sizeof f->size) == 0 &&
           memcmp(&f->by, &session->now.kept.finish, sizeof f->by) == 0;
}

static enum err make(struct session *session, struct fault *fault)
{
    const struct grid *grid = &session->scene->grid;
    struct finished made = {.cells = grid->cells,
                            .size = {grid->size[0], grid->size[1], grid->size[2]},
                            .forest = forest_label_digest(session->forest),
                            .keys = forest_digest(session->forest),
                            .roi = session->roi_tally.digest,
                            .by = session->now.kept.finish};
    enum err err = finish_make(&made.label, &made.by, session->scene, session->team, fault);
    if (err)
        return err;
    made.digest = labels_digest(&(struct labels){session->scene, made.label}, session->team);
    err = watch_fault(session->watch, fault);
    if (err) {
        finished_release(&made);
        return err;
    }
    finished_release(&session->finished);
    session->finished = made;
    return OK;
}

enum err session_labels(struct session *session, bool finished, struct labels *labels,
                        struct fault *fault)
{
    *labels = labels_of_forest(session->scene);
    if (!finished || !session->now.kept.finish.count)
        return OK;
    const enum err err = is_made(session) ? OK : make(session, fault);
    labels->finished = session->finished.label;
    return err;
}

uint64_t session_finished_digest(const struct session *session)
{
    return session->now.kept.finish.count ? session->finished.digest
                                          : forest_label_digest(session->forest);
}
