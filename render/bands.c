#include "render/bands.h"

#include "render/layers.h"

enum { SAMPLES_HIGH = 64 }; /* at least: less of them are drawn twice, and more leave the caches */

static uint32_t round_up(uint32_t rows)
{
    return (rows + TILE - 1) / TILE * TILE;
}

/* Rows of samples that are drawn on both sides of a band. */
static uint32_t reach_of(const struct bands *bands)
{
    return round_up((uint32_t)shade_reach(bands->look, bands->camera).pixels);
}

static uint32_t rows_of(const struct bands *bands)
{
    const uint32_t reach = reach_of(bands);
    const uint32_t high = reach > SAMPLES_HIGH ? reach : SAMPLES_HIGH;
    return bands->rows ? bands->rows : round_up(high / bands->look->samples);
}

/* Rows of samples: those of a band, and what is drawn for it. */
struct band {
    uint32_t top, height, drawn_top, drawn_height;
};

static struct band band_at(const struct bands *bands, uint32_t number)
{
    const uint32_t samples = bands->look->samples, all = bands->camera->view.height;
    const uint32_t reach = reach_of(bands), most = rows_of(bands) * samples;
    struct band band = {.top = number * most};
    band.height = all - band.top < most ? all - band.top : most;
    band.drawn_top = band.top < reach ? 0 : band.top - reach;
    const uint32_t below = all - (band.top + band.height);
    const uint32_t drawn_end = band.top + band.height + (below < reach ? below : reach);
    band.drawn_height = drawn_end - band.drawn_top;
    return band;
}

static void draw_band(struct rendition *out, const struct bands *bands, struct band band,
                      const struct rendition *room, unsigned thread)
{
    const uint32_t samples = bands->look->samples, above = band.top - band.drawn_top;
    const struct camera camera = camera_rows(bands->camera, band.drawn_top, band.drawn_height);
    struct rendition drawn = rendition_rows(room, 0, band.drawn_height);
    struct rendition fine = rendition_rows(room, above, band.height);
    struct rendition pixels = rendition_rows(out, band.top / samples, band.height / samples);
    if (bands->project == splat_border)
        splat_border_quietly(&drawn, &camera, bands->border);
    else
        bands->project(&drawn, &camera, bands->border);
    shade_rows(&drawn, above / TILE, above / TILE + fine.tiles_y, &camera, bands->border,
               bands->palette, bands->look, bands->shader, thread);
    rendition_reduce(&pixels, &fine, samples);
}

struct drawing {
    const struct bands *bands;
    struct rendition *out;
    struct team *team;
    struct rendition room[TEAM_MOST]; /* for each thread */
    struct layers layers[TEAM_MOST];
};

static void draw_share(void *context, unsigned thread)
{
    const struct drawing *d = context;
    const struct camera *camera = d->bands->camera;
    struct task task = task_begin_part(camera->scene->watch, "rendition",
                                       (uint64_t)camera->view.width * camera->view.height, thread);
    const uint32_t most = rows_of(d->bands);
    for (uint32_t i = thread; i * most < d->out->height; i += team_size(d->team)) {
        const struct band band = band_at(d->bands, i);
        draw_band(d->out, d->bands, band, &d->room[thread], thread);
        if (!task_advance(&task, (uint64_t)band.height * camera->view.width))
            return;
    }
}

static enum err make_room(struct drawing *d, struct fault *fault)
{
    const struct bands *bands = d->bands;
    const uint32_t most = rows_of(bands) * bands->look->samples + 2 * reach_of(bands);
    const uint32_t all = bands->camera->view.height;
    enum err err =
        shader_prepare(bands->shader, team_size(d->team), bands->border, bands->look, fault);
    for (unsigned i = 0; i < team_size(d->team) && !err; i++)
        err =
            rendition_init(&d->room[i], bands->camera->view.width, most < all ? most : all, fault);
    for (unsigned i = 0; i < team_size(d->team) && !err; i++)
        err = layers_take(&d->layers[i], &d->room[i], bands->border, &bands->shader->seams, fault);
    for (unsigned i = 0; i < team_size(d->team) && !err; i++)
        err = rendition_refined(&d->room[i], shade_refines(bands->look, bands->border), fault);
    return err;
}

enum err bands_draw(struct rendition *out, const struct bands *bands, struct fault *fault)
{
    struct drawing d = {.bands = bands,
                        .out = out,
                        .team = bands->project == splat_border ? bands->shader->team : NULL};
    const enum err err = make_room(&d, fault);
    if (!err)
        team_run(d.team, draw_share, &d);
    for (int i = 0; i < TEAM_MOST; i++) {
        rendition_release(&d.room[i]);
        layers_release(&d.layers[i]);
    }
    return err;
}
