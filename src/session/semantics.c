/* SPDX-License-Identifier: MIT */
#include "session/semantics.h"

#include <string.h>

#include "base/choice.h"
#include "base/hash.h"

static const struct meaning_row {
    unsigned since;        /* the first number that has the new meaning */
    const char *was, *now; /* what means what */
    const char *lost;      /* "a|b": the words that are lost before; NULL where it can be had */
} meaning_table[MEANINGS] = {
    [MEANING_LABEL_SUM] = {2, "`labels` was a sum of mixes of place and label",
                           "`labels` is a sum of mixed places times labels", NULL},
    [MEANING_MARKERS] = {4, "`remove` removed single trees",
                         "`remove` removes markers, unless of=tree", NULL},
    [MEANING_BRANCH_TIPS] = {4, "`goto` moved the branch that it went to",
                             "a branch stays where its last command or undo left it", NULL},
    [MEANING_STROKES] = {4, "`pending` counts a voxel that balls of a stroke share more than once",
                         "`pending` counts it once", NULL},
    [MEANING_QUOTES] = {4, "' is a letter like any other",
                        "a word may stand between ' and ' as between \" and \"", NULL},
    [MEANING_ORIENTATION] = {5,
                             "what a file does not say of its voxels was taken to be axes towards "
                             "right, front and head, 1 mm apart, and the sform to hold against the "
                             "qform",
                             "it is unknown until `orient` tells it", NULL},
    [MEANING_PLACES] = {5,
                        "a map of the scene's size, with axes along the same sides, was taken "
                        "wherever it lies",
                        "a map lies where the scene does, or is resampled", NULL},
    [MEANING_OPEN_WEIGHT] = {5, "`open` meant `weight morph`",
                             "`open` records its weight, and means morph without one", NULL},
    [MEANING_FIT] = {6, "`zoom fit` shows the whole scene",
                     "it shows what is shown, and is recorded as the zoom it comes to", NULL},
    [MEANING_APPLIED] = {9, "slices and mosaics showed labels without edits that wait",
                         "they apply them first, as renditions do", NULL},
    [MEANING_SHEAR] = {9, "volumes are products of the spacings",
                       "volumes are what voxels take in the world, less where axes are sheared",
                       NULL},
    [MEANING_LEVELS] = {9,
                        "the scale of real and of wide whole numbers reached from the least to the "
                        "greatest, and ranges compared what levels stand for",
                        "it is cut where a few far values would take the levels of the others, "
                        "whole numbers that fit are exact, and ranges compare the file's values",
                        NULL},
    [MEANING_WHOLE_LABELS] =
        {9,
         "`labels` eroded by 2 rounds unless told, left out what was not "
         "chosen, and stayed where it was corrected; an empty map was saved",
         "`labels` records its rounds, none unless told, plants the background "
         "wherever nothing else is chosen, and gives way to what is planted in "
         "it; an empty map is refused",
         NULL},
    [MEANING_SLICE_NUMBERS] = {9, "slices were counted from the patient's feet, back and left",
                               "the number of a slice is the index of its voxels along its axis",
                               NULL},
    [MEANING_FOLDERS] = {9,
                         "a mosaic of DICOM is one slice; damaged files of a folder are left out",
                         "a mosaic is the volume that it holds; a damaged file is refused, unless "
                         "`skip` leaves it out",
                         NULL},
    [MEANING_SURFACE] = {10, "pictures had other surfaces, letters and colours of labels",
                         "pictures show the surface that is measured and saved",
                         "picture|spin|names"},
    [MEANING_SIDES] = {11,
                       "of NRRD in left-anterior-superior left was taken for right, and front for "
                       "back",
                       "sides are those that the file names", NULL},
};

bool semantics_has(unsigned semantics, enum meaning meaning)
{
    return semantics >= meaning_table[meaning].since;
}

bool semantics_lost(unsigned semantics, const char *word, size_t length)
{
    struct choice lost;
    for (int m = 0; m < MEANINGS; m++)
        for (const char *at = meaning_table[m].lost; at && choice_next(&lost, &at);)
            if (semantics < meaning_table[m].since && lost.length == length &&
                memcmp(lost.word, word, length) == 0)
                return true;
    return false;
}

void semantics_tell_lost(struct buf *out, unsigned semantics)
{
    for (int m = 0; m < MEANINGS; m++) {
        const struct meaning_row *row = &meaning_table[m];
        if (row->lost && semantics < row->since)
            buf_printf(out,
                       "semantics %u: %s, and are neither compared nor recorded (`iftty log "
                       "--reseal --accept WHY FILE` draws them anew)\n",
                       semantics, row->was);
    }
}

/* Counted from every voxel, each time. */
static uint64_t sum_of_mixes(const struct scene *scene)
{
    const struct grid *grid = &scene->grid;
    struct task task = task_begin(scene->watch, "digest of the labels", grid->voxels);
    uint64_t sum = 0;
    for (uint32_t z = 0; z < grid->size[2]; z++)
        for (uint32_t y = 0; y < grid->size[1]; y++) {
            const struct span row = grid_row(grid, y, z);
            for (uint32_t c = row.first; c < row.end; c++) {
                const uint8_t label = scene->cell[c].label;
                if (label && cell_is_reached(scene->cell + c))
                    sum += hash_mix_at(c, label);
            }
            if (!task_advance(&task, grid->size[0]))
                return 0;
        }
    return sum;
}

uint64_t semantics_label_digest(unsigned semantics, const struct forest *forest)
{
    return semantics_has(semantics, MEANING_LABEL_SUM) ? forest_label_digest(forest)
                                                       : sum_of_mixes(forest_scene(forest));
}
