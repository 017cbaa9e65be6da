#include "session/session_inside.h"

#include <stdlib.h>

#include "base/mem.h"
#include "engine/margin.h"

void hinting_release(struct hinting *hinting)
{
    hints_release(&hinting->hints);
    free(hinting->heat);
    *hinting = (struct hinting){0};
}

size_t hinting_memory(const struct hinting *hinting)
{
    return (hinting->heat ? hinting->cells : 0) +
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

static enum err make(struct session *session, bool with_heat, struct fault *fault)
{
    struct hinting *h = &session->hinting;
    uint16_t *margin;
    enum err err = margin_new(&margin, session->forest, fault);
    if (!err && with_heat && !(h->heat = mem_new(h->cells)))
        err = fault_memory(fault, "the heat");
    if (!err)
        err = hints_find(&h->hints, session->forest, margin, h->heat, fault);
    free(margin);
    h->has_hints = err == OK;
    if (err)
        hinting_release(h);
    return err;
}

enum err session_find_hints(struct session *session, const struct hint_list **hints,
                            const uint8_t **heat, struct fault *fault)
{
    struct hinting *h = &session->hinting;
    keep_up(session);
    const bool is_made = h->has_hints && (!heat || h->heat);
    const enum err err = is_made ? OK : make(session, heat != NULL, fault);
    *hints = &h->hints;
    if (heat)
        *heat = h->heat;
    return err;
}
