#include "session/session_inside.h"

#include <string.h>

#include "base/mem.h"

void finished_release(struct finished *finished)
{
    mem_pages_free(finished->label, finished->cells);
    *finished = (struct finished){0};
}

bool finish_source_is_present(const struct finish_source *source, const struct session *session)
{
    return memcmp(&source->by, &session->now.kept.finish, sizeof source->by) == 0 &&
           memcmp(source->size, session->scene->grid.size, sizeof source->size) == 0 &&
           source->forest == forest_label_digest(session->forest) &&
           (!finish_heeds_seeds(&source->by) || (source->keys == forest_digest(session->forest) &&
                                                 source->roi == session->roi_tally.digest));
}

static struct finish_source present_source(const struct session *session)
{
    const uint32_t *size = session->scene->grid.size;
    return (struct finish_source){.size = {size[0], size[1], size[2]},
                                  .forest = forest_label_digest(session->forest),
                                  .keys = forest_digest(session->forest),
                                  .roi = session->roi_tally.digest,
                                  .by = session->now.kept.finish};
}

static enum err make(struct session *session, struct fault *fault)
{
    struct finished made = {.cells = session->scene->grid.cells, .of = present_source(session)};
    enum err err = finish_make(&made.label, &made.of.by, session->scene, session->team, fault);
    if (err)
        return err;
    made.digest = labels_digest(&(struct labels){session->scene, made.label}, session->team);
    err = watch_fault(session->scene->watch, fault);
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
    const struct finished *made = &session->finished;
    *labels = labels_of_forest(session->scene);
    if (!finished || !session->now.kept.finish.count)
        return OK;
    const bool is_made = made->label && finish_source_is_present(&made->of, session);
    const enum err err = is_made ? OK : make(session, fault);
    labels->finished = made->label;
    return err;
}

uint64_t session_finished_digest(const struct session *session)
{
    return session->now.kept.finish.count ? session->finished.digest
                                          : forest_label_digest(session->forest);
}

const struct finished *session_finished(const struct session *session)
{
    return &session->finished;
}
