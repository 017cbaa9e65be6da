#include "session/session.h"

#include <stdlib.h>

#include "engine/margin.h"

void hinting_release(struct hinting *hinting)
{
    hints_release(&hinting->hints);
    free(hinting->margin);
    *hinting = (struct hinting){0};
}

size_t hinting_memory(const struct hinting *hinting)
{
    return (hinting->margin ? hinting->cells * sizeof *hinting->margin : 0) +
           hinting->hints.capacity * sizeof *hinting->hints.item;
}

/* Lets go of what is of another forest. */
static void keep_up(struct session *session)
{
    struct hinting *h = &session->hinting;
    const struct hinting now = {.cells = session->scene->grid.cells,
                                .forest = forest_digest(session->forest),
                                .labels = forest_label_digest(session->forest),
                                .weights = session->weight_digest,
                                .adjacency = session->now.kept.adjacency};
    if (h->cells == now.cells && h->forest == now.forest && h->labels == now.labels &&
        h->weights == now.weights && h->adjacency == now.adjacency)
        return;
    hinting_release(h);
    *h = now;
}

enum err session_find_margins(struct session *session, const uint16_t **margin, struct fault *fault)
{
    struct hinting *h = &session->hinting;
    keep_up(session);
    const enum err err = h->margin ? OK : margin_new(&h->margin, session->forest, fault);
    *margin = h->margin;
    return err;
}

enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            struct fault *fault)
{
    struct hinting *h = &session->hinting;
    const uint16_t *margin;
    keep_up(session);
    *hints = &h->hints;
    if (h->has_hints)
        return OK;
    enum err err = session_find_margins(session, &margin, fault);
    if (!err)
        err = hints_find(&h->hints, session->forest, margin, fault);
    h->has_hints = err == OK;
    return err;
}
