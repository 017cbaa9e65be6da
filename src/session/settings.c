/* Settings that take more than a change of the state. A copy of it borrows what it shares with the
 * present state; what is new in it is released once the session holds it. */
#include "session/session_inside.h"

#include <string.h>

#include "session/roi_check.h"

static void set_words(char words[FILE_WORDS_BYTES], const char *name)
{
    memset(words, 0, FILE_WORDS_BYTES);
    memcpy(words, name, strnlen(name, FILE_WORDS_BYTES - 1));
}

static enum err go(struct session *session, const struct state *state, struct fault *fault)
{
    return session_go(session, state, NULL, 0, fault);
}

/* ---- weights ---- */

enum err session_set_weight_map(struct session *session, const char *name, const uint16_t *weight,
                                struct fault *fault)
{
    struct state next = session->now;
    struct packed *map;
    enum err err = packed_new(&map, weight, session->scene->grid.voxels * sizeof *weight,
                              session->watch, fault);
    if (err)
        return err;
    next.kept.weight = (struct weight_choice){.kind = WEIGHT_FILE};
    next.kept.weight_map = map;
    set_words(next.kept.weight_file, name);
    err = go(session, &next, fault);
    packed_release(map);
    return err;
}

/* ---- the region of interest ---- */

static enum err check(const struct session *session, const struct roi *roi, struct fault *fault)
{
    return roi_check(roi, session->scene, edits_first(&session->now.lists.pending),
                     session_pendings(session), fault);
}

enum err session_set_mask(struct session *session, const uint64_t *mask, const char *name,
                          const uint32_t regions[2], struct fault *fault)
{
    const struct roi roi = {mask, session->roi.low, session->roi.high};
    struct state next = session->now;
    struct packed *packed = NULL;
    enum err err = check(session, &roi, fault);
    if (!err && mask)
        err = packed_new(&packed, mask, mask_bytes(&session->scene->grid), session->watch, fault);
    if (err)
        return err;
    next.kept.mask = packed;
    set_words(next.kept.mask_file, mask ? name : "");
    for (int i = 0; i < 2; i++)
        next.kept.mask_regions[i] = mask ? regions[i] : 0;
    err = go(session, &next, fault);
    packed_release(packed);
    return err;
}

enum err session_set_range(struct session *session, const struct decimal range[2],
                           struct fault *fault)
{
    struct roi roi = {session->roi.mask, 0, UINT16_MAX};
    struct state next = session->now;
    if (range)
        roi_range(&roi, &session->geometry, session->levels, range);
    enum err err = check(session, &roi, fault);
    if (err)
        return err;
    next.kept.has_range = range != NULL;
    for (int i = 0; i < 2; i++)
        next.kept.range[i] = range ? range[i] : (struct decimal){0, 0, 0};
    return go(session, &next, fault);
}

/* ---- what is seen ---- */

enum err session_set_view(struct session *session, const struct view *view, struct fault *fault)
{
    struct state next = session->now;
    next.outlook.view = *view;
    return go(session, &next, fault);
}
