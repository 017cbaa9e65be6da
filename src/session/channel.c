/* SPDX-License-Identifier: MIT */
/* Channels of a session's scene: their intensities, and which of them is in the cells. */
#include "session/session.h"
#include "session/session_inside.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/safe.h"
#include "image/levels.h"
#include "image/volume_format.h"

/* The intensities are another channel's while this one is in the cells, as are the scales. */
struct channel_values {
    unsigned holders;
    size_t cells;
    uint64_t digest;
    double slope, intercept;
    struct levels *levels;
    uint16_t *intensity; /* [cells], 0 in the rim */
};

struct channel_values *channel_values_hold(struct channel_values *values)
{
    if (values)
        values->holders++;
    return values;
}

void channel_values_release(struct channel_values **values)
{
    struct channel_values *v = *values;
    *values = NULL;
    if (!v || --v->holders)
        return;
    mem_pages_free(v->intensity, v->cells * sizeof *v->intensity);
    free(v->levels);
    free(v);
}

enum err channel_values_new(struct channel_values **out, const struct session *session,
                            struct volume *volume, struct fault *fault)
{
    const struct grid *grid = &session->scene->grid;
    OWNED(channel_values_release) struct channel_values *v = mem_new(sizeof *v);
    *out = NULL;
    if (!v)
        return fault_memory(fault, "a channel");
    v->holders = 1;
    v->cells = grid->cells;
    v->slope = volume->geometry.slope;
    v->intercept = volume->geometry.intercept;
    v->intensity = mem_pages(v->cells * sizeof *v->intensity);
    if (!v->intensity)
        return fault_memory(fault, "a channel");
    struct grid_walk walk = scene_walk(session->scene, "voxels of the channel", NULL, 0);
    for (const uint16_t *from = volume->intensity; grid_walk_next(&walk);)
        for (uint32_t c = walk.row.first; c < walk.row.end; c++, from++) {
            v->intensity[c] = *from;
            v->digest += hash_mix((uint64_t)(from - volume->intensity) << 16 | *from);
        }
    TRY(watch_fault(session->watch, fault));
    uint64_t scale[2];
    memcpy(scale, (const double[]){v->slope, v->intercept}, sizeof scale);
    v->digest += hash_mix_at(scale[0], scale[1]);
    v->levels = volume->levels;
    volume->levels = NULL;
    *out = channel_values_hold(v);
    return OK;
}

uint64_t channel_values_digest(const struct channel_values *values)
{
    return values->digest;
}

size_t channel_values_memory(const struct channel_values *values)
{
    return values ? values->cells * sizeof *values->intensity / values->holders : 0;
}

unsigned kept_channels(const struct kept *kept)
{
    unsigned count = 0;
    while (count < CHANNELS_MOST && kept->channel[count].values)
        count++;
    return count;
}

enum err kept_has_channel(const struct kept *kept, unsigned channel, struct fault *fault)
{
    const unsigned count = kept_channels(kept) + 1;
    return channel < count
               ? OK
               : fault_set(fault, ERR_USAGE,
                           "there is no channel %u: the scene has %u; nothing has changed",
                           channel + 1, count);
}

unsigned session_shown_channel(const struct session *session)
{
    const struct kept *kept = &session->now.kept;
    for (unsigned i = 0; i < kept_channels(kept); i++)
        if (kept->channel[i].slot == session->now.outlook.slices.channel)
            return i + 1;
    return 0;
}

uint64_t session_shown_digest(const struct session *session)
{
    const unsigned shown = session_shown_channel(session);
    return shown ? channel_values_digest(session->now.kept.channel[shown - 1].values) | 1 : 1;
}

unsigned session_shown_slot(const struct session *session)
{
    return session_shown_channel(session) ? session->now.outlook.slices.channel : 0;
}

const struct levels *session_scale(struct geometry *geometry, const struct session *session,
                                   unsigned channel)
{
    const unsigned shown = session->scene->shown;
    if (channel == shown)
        return session->levels;
    const struct channel_values *v = session->inside->channel[(channel ? channel : shown) - 1];
    geometry->slope = v->slope;
    geometry->intercept = v->intercept;
    return v->levels;
}

struct interval session_within(const struct session *session, unsigned channel,
                               const struct decimal range[2])
{
    struct geometry geometry = session->geometry;
    const struct levels *levels = session_scale(&geometry, session, channel);
    return levels_within(&geometry, levels, range);
}

void channel_write(struct buf *out, const struct session *session)
{
    const unsigned shown = session_shown_channel(session);
    buf_printf(out, "channel %u", shown + 1);
    if (shown && *session->now.kept.channel[shown - 1].name) {
        buf_add_char(out, ' ');
        buf_add_safe_text(out, session->now.kept.channel[shown - 1].name);
    }
}

void channel_write_in(struct buf *out, const struct session *session)
{
    if (!kept_channels(&session->now.kept))
        return;
    buf_add_text(out, "in ");
    channel_write(out, session);
    buf_add_text(out, ": ");
}

/* Exchange the intensities in the cells, and their scale, with a channel, numbered from 1. */
static void exchange(struct session *session, unsigned channel)
{
    struct channel_values *v = session->inside->channel[channel - 1];
    const double slope = session->said.slope, intercept = session->said.intercept;
    struct levels *const levels = session->levels;
    scene_swap_channel(session->scene, channel - 1, session->team);
    session->said.slope = session->geometry.slope = v->slope;
    session->said.intercept = session->geometry.intercept = v->intercept;
    session->levels = v->levels;
    v->slope = slope;
    v->intercept = intercept;
    v->levels = levels;
}

void session_take_channels_out(struct session *session)
{
    struct session_inside *inside = session->inside;
    if (session->scene->shown)
        exchange(session, session->scene->shown);
    session->scene->shown = 0;
    for (unsigned i = 0; i < session->scene->channels; i++)
        channel_values_release(&inside->channel[i]);
    session->scene->channels = 0;
}

void session_put_channels_in(struct session *session)
{
    struct session_inside *inside = session->inside;
    const struct kept *kept = &session->now.kept;
    struct scene *scene = session->scene;
    scene->channels = kept_channels(kept);
    scene->percent = kept->percent;
    for (unsigned i = 0; i < scene->channels; i++) {
        inside->channel[i] = channel_values_hold(kept->channel[i].values);
        scene->channel[i] =
            (struct channel){inside->channel[i]->intensity, kept->channel[i].percent};
    }
    scene->shown = session_shown_channel(session);
    if (scene->shown)
        exchange(session, scene->shown);
    inside->knows_window = false;
    label_measures_release(&inside->measures);
    relax_kept_release(&inside->relaxed);
    if (!session->pictures)
        return;
    inside->follower->forget_labels(session->pictures);
    session_forget_pictures(session);
}

enum err session_reserve_channels(struct session *session, const struct kept *kept,
                                  struct fault *fault)
{
    struct weight_work *work = &session->inside->weight_work;
    if (!work->best && kept_channels(kept))
        work->best = mem_array(session->scene->grid.cells, sizeof *work->best);
    return work->best || !kept_channels(kept) ? OK : fault_memory(fault, "weights of channels");
}
