/* SPDX-License-Identifier: MIT */
/* vigra's watershedsMultiArray as a worker: region growing over 6 neighbours, with a queue
 * of 256 buckets, or of 65536 for gradients of 16 bits. It works in place: the labels hold the
 * markers at first, and copying them there is not timed. */
#include <iostream> // which vigra uses and does not include

#include <vigra/multi_array.hxx>
#include <vigra/multi_watersheds.hxx>

#include <algorithm>

#include "tests/peers/worker.h"

template <class Pixel> static void segment(struct worker *worker, Pixel *map)
{
    const vigra::Shape3 shape(worker->size[0], worker->size[1], worker->size[2]);
    const vigra::MultiArrayView<3, Pixel> gradient(shape, map);
    vigra::MultiArrayView<3, unsigned char> label(shape, worker->label);
    const auto options = vigra::WatershedOptions().regionGrowing();
    std::copy(worker->marker, worker->marker + worker->voxels, worker->label);
    worker_stage(worker, NULL);
    vigra::watershedsMultiArray(gradient, label, vigra::DirectNeighborhood, options);
    worker_stage(worker, "run");
}

static bool run(struct worker *worker)
try {
    worker->narrow ? segment(worker, worker->narrow) : segment(worker, worker->gradient);
    return true;
} catch (const std::exception &error) {
    snprintf(worker->note, sizeof worker->note, "%s", error.what());
    return false;
}

int main(int, char **argv)
{
    struct worker worker = {};
    if (!worker_begin(&worker, argv[1]))
        return 3;
    worker_serve(&worker, run);
    return 0;
}
