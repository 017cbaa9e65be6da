/* SPDX-License-Identifier: MIT */
#include "tests/bench/growcut.h"

#include <stdbool.h>
#include <stdlib.h>

#include "base/mem.h"

struct automaton {
    const uint8_t *image;
    uint8_t *label;
    float *strength;
    size_t size[3], step[3];
    float through[256]; /* g */
};

/* Whether the neighbour conquers the cell. */
static bool attack(const struct automaton *a, size_t p, size_t q)
{
    const int d = a->image[p] - a->image[q];
    const float strength = a->strength[p] * a->through[d < 0 ? -d : d];
    if (!(strength > a->strength[q]))
        return false;
    a->strength[q] = strength;
    a->label[q] = a->label[p];
    return true;
}

static bool visit(const struct automaton *a, size_t q)
{
    bool changed = false;
    for (int axis = 0; axis < 3; axis++) {
        const size_t i = q / a->step[axis] % a->size[axis];
        if (i > 0)
            changed |= attack(a, q - a->step[axis], q);
        if (i + 1 < a->size[axis])
            changed |= attack(a, q + a->step[axis], q);
    }
    return changed;
}

enum err growcut(uint8_t *label, const uint8_t *image, const uint8_t *marker,
                 const uint32_t size[3], struct fault *fault)
{
    struct automaton a = {.image = image,
                          .label = label,
                          .size = {size[0], size[1], size[2]},
                          .step = {1, size[0], (size_t)size[0] * size[1]}};
    const size_t voxels = a.step[2] * size[2];
    a.strength = mem_array(voxels, sizeof *a.strength);
    if (!a.strength)
        return fault_memory(fault, "GrowCut");
    for (int d = 0; d < 256; d++)
        a.through[d] = 1 - (float)d / 255;
    for (size_t i = 0; i < voxels; i++) {
        a.strength[i] = marker[i] ? 1 : 0;
        label[i] = marker[i] ? (uint8_t)(marker[i] - 1) : 0;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t i = 0; i < voxels; i++)
            changed |= visit(&a, i);
        for (size_t i = voxels; changed && i-- > 0;)
            visit(&a, i);
    }
    free(a.strength);
    return OK;
}
