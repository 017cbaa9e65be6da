#include "tui/picture/colour_table.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { CELLS = 1 << 18 };

struct sample {
    uint8_t channel[3];
    uint32_t cell;
    uint32_t weight; /* pixels */
};

struct box {
    size_t first, count; /* its part of the samples */
    uint64_t error;      /* the largest squared error along one axis */
    unsigned axis;       /* that axis */
    uint8_t mean[3];
};

static void measure_box(struct box *box, const struct sample *sample)
{
    uint64_t weight = 0, sum[3] = {0}, square[3] = {0};
    for (size_t i = box->first; i < box->first + box->count; i++) {
        uint64_t w = sample[i].weight;
        weight += w;
        for (unsigned k = 0; k < 3; k++) {
            sum[k] += w * sample[i].channel[k];
            square[k] += w * sample[i].channel[k] * sample[i].channel[k];
        }
    }
    box->error = 0;
    box->axis = 0;
    for (unsigned k = 0; k < 3; k++) {
        uint64_t mean = (sum[k] + weight / 2) / weight;
        /* sum w (c - mean)^2, which is never negative, without a fraction */
        uint64_t error = square[k] + weight * mean * mean - 2 * mean * sum[k];
        box->mean[k] = (uint8_t)mean;
        if (error > box->error) {
            box->error = error;
            box->axis = k;
        }
    }
}

/* Parts the samples of `box` at its mean; those above go into `above`. A box with an error has
 * samples on both sides, except where the rounded mean equals the largest value. */
static void cut_box(struct box *box, struct box *above, struct sample *sample)
{
    unsigned axis = box->axis;
    uint8_t most = 0;
    for (size_t i = box->first; i < box->first + box->count; i++)
        if (sample[i].channel[axis] > most)
            most = sample[i].channel[axis];
    unsigned limit = box->mean[axis] < most ? box->mean[axis] : most - 1u;
    size_t low = box->first, high = box->first + box->count;
    while (low < high) {
        if (sample[low].channel[axis] <= limit) {
            low++;
        } else {
            struct sample moved = sample[--high];
            sample[high] = sample[low];
            sample[low] = moved;
        }
    }
    above->first = low;
    above->count = box->first + box->count - low;
    box->count = low - box->first;
    measure_box(box, sample);
    measure_box(above, sample);
}

static unsigned cut_boxes(struct box *box, unsigned most, struct sample *sample, size_t samples)
{
    unsigned count = 1;
    box[0] = (struct box){.first = 0, .count = samples};
    measure_box(&box[0], sample);
    while (count < most) {
        unsigned worst = 0;
        for (unsigned i = 1; i < count; i++)
            if (box[i].error > box[worst].error)
                worst = i;
        if (box[worst].error == 0)
            break;
        cut_box(&box[worst], &box[count], sample);
        count++;
    }
    return count;
}

/* Counts the pixels of each cell in `weight` and lists the cells that have any, each with the
 * first colour seen in it. Returns how many, or 0 without memory. */
static size_t gather(const struct image_view *view, uint32_t *weight, struct sample **sample)
{
    size_t pixels = (size_t)view->width * view->height, count = 0, capacity = 0;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t colour = image_view_colour(view, i), cell = colour_cell(colour);
        if (weight[cell]++ > 0)
            continue;
        if (!mem_grow(sample, &capacity, count + 1, sizeof **sample))
            return 0;
        (*sample)[count++] = (struct sample){
            .channel = {(uint8_t)(colour >> 16), (uint8_t)(colour >> 8), (uint8_t)colour},
            .cell = cell};
    }
    for (size_t i = 0; i < count; i++)
        (*sample)[i].weight = weight[(*sample)[i].cell];
    return count;
}

bool colour_table_reduce(struct colour_table *table, const struct image_view *view, unsigned most)
{
    struct box box[COLOUR_TABLE_MOST];
    struct sample *sample = NULL;
    uint32_t *weight = calloc(CELLS, sizeof *weight);
    const size_t samples = weight ? gather(view, weight, &sample) : 0;
    table->count = samples ? cut_boxes(box, most, sample, samples) : 0;
    for (unsigned b = 0; b < table->count; b++) {
        const uint8_t *mean = box[b].mean;
        table->colour[b] = (uint32_t)mean[0] << 16 | (uint32_t)mean[1] << 8 | mean[2];
    }
    free(weight);
    free(sample);
    return samples > 0 || (size_t)view->width * view->height == 0;
}
