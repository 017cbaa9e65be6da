#include "render/bands.h"

#include "render/layers.h"
#include "render/patch.h"
#include "render/projection.h"

/* More leave the caches. Of less, voxels and rows around that lie across two bands are drawn twice:
 * of voxels it takes 2 % more time to have half as many, which wide pictures spare memory by. */
enum { SAMPLES_HIGH = 64, SAMPLES_LEAST_HIGH = 32, SAMPLES_A_BAND = 1 << 18 };

static uint32_t round_up(uint32_t rows, uint32_t unit)
{
    return (rows + unit - 1) / unit * unit;
}

/* Rows of samples that are drawn on both sides of a band. */
static uint32_t reach_of(const struct bands *bands)
{
    return round_up((uint32_t)shade_reach(bands->look, bands->camera).pixels, TILE);
}

/* Of whole blocks of patches. */
static uint32_t rows_of(const struct bands *bands)
{
    const uint32_t reach = reach_of(bands);
    uint32_t high = reach > SAMPLES_HIGH ? reach : SAMPLES_HIGH;
    if (!reach && SAMPLES_A_BAND / bands->camera->view.width < high)
        high = SAMPLES_LEAST_HIGH;
    if (bands->rows)
        high = bands->rows * bands->look->samples;
    return round_up(high, PATCH_SIDE) / bands->look->samples;
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

struct drawing {
    const struct bands *bands;
    struct rendition *out; /* or NULL */
    struct team *team;
    struct rendition room[TEAM_MOST], pixels[TEAM_MOST]; /* for each thread */
    struct layers layers[TEAM_MOST];
};

/* Else pixels are what is drawn. */
static bool is_reduced(const struct drawing *d)
{
    return d->out || d->bands->look->samples > 1;
}

static void draw_band(const struct drawing *d, struct band band, unsigned thread)
{
    const struct bands *bands = d->bands;
    const struct rendition *room = &d->room[thread];
    const uint32_t samples = bands->look->samples, above = band.top - band.drawn_top;
    const struct camera camera = camera_rows(bands->camera, band.drawn_top, band.drawn_height);
    struct rendition drawn = rendition_rows(room, 0, band.drawn_height);
    struct rendition fine = rendition_rows(room, above, band.height);
    if (bands->project == splat_border)
        splat_border_quietly(&drawn, &camera, bands->border);
    else
        bands->project(&drawn, &camera, bands->border);
    shade_rows(&drawn, above / TILE, above / TILE + fine.tiles_y, &camera, bands->border,
               bands->palette, bands->look, bands->shader, thread);
    struct rendition pixels = fine;
    if (is_reduced(d)) {
        pixels = d->out ? rendition_rows(d->out, band.top / samples, band.height / samples)
                        : rendition_rows(&d->pixels[thread], 0, band.height / samples);
        rendition_reduce(&pixels, &fine, samples, NULL);
    }
    if (bands->take)
        bands->take(bands->context, &pixels, band.top / samples);
}

static void draw_share(void *context, unsigned thread)
{
    const struct drawing *d = context;
    const struct camera *camera = d->bands->camera;
    struct task task = task_begin_part(camera->scene->watch, "rendition",
                                       (uint64_t)camera->view.width * camera->view.height, thread);
    const uint32_t most = rows_of(d->bands) * d->bands->look->samples;
    for (uint32_t i = thread; i * most < camera->view.height; i += team_size(d->team)) {
        const struct band band = band_at(d->bands, i);
        draw_band(d, band, thread);
        if (!task_advance(&task, (uint64_t)band.height * camera->view.width))
            return;
    }
}

static enum err make_room(struct drawing *d, struct fault *fault)
{
    const struct bands *bands = d->bands;
    const uint32_t samples = bands->look->samples, width = bands->camera->view.width;
    const uint32_t most = rows_of(bands) * samples + 2 * reach_of(bands);
    const uint32_t all = bands->camera->view.height;
    const uint32_t height = most < all ? most : all;
    enum err err = shader_prepare(bands->shader, team_size(d->team), bands->camera, bands->border,
                                  bands->look, fault);
    for (unsigned i = 0; i < team_size(d->team) && !err; i++) {
        struct rendition *room = &d->room[i];
        err = rendition_init(room, width, height, fault);
        if (!err && !d->out && is_reduced(d))
            err = rendition_init(&d->pixels[i], width / samples, rows_of(bands), fault);
        if (!err)
            err = shade_take_layers(bands->shader, &d->layers[i], room, bands->camera,
                                    bands->border, bands->look, fault);
        if (!err)
            err = rendition_refined(room, shade_refines(bands->look, bands->camera, bands->border),
                                    fault);
    }
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
        rendition_release(&d.pixels[i]);
        layers_release(&d.layers[i]);
    }
    return err;
}
