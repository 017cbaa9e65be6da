/* SPDX-License-Identifier: MIT */
/* vigra's watershedsMultiArray as a worker: region growing over 6 neighbours, which for gradients
 * of 8 bits orders voxels by a queue of 256 buckets (its "turbo" algorithm). It works in place: the
 * labels hold the markers at first, and copying them there is not timed. */
#include <iostream> // which vigra uses and does not include

#include <vigra/multi_array.hxx>
#include <vigra/multi_watersheds.hxx>

#include <algorithm>

#include "tests/peers/worker.h"

static bool run(struct worker *worker)
try {
    const vigra::Shape3 shape(worker->size[0], worker->size[1], worker->size[2]);
    const vigra::MultiArrayView<3, unsigned char> gradient(shape, worker->gradient);
    vigra::MultiArrayView<3, unsigned char> label(shape, worker->label);
    std::copy(worker->marker, worker->marker + worker->voxels, worker->label);
    const auto options = vigra::WatershedOptions().turboAlgorithm(256);
    const double begin = worker_clock_ms();
    vigra::watershedsMultiArray(gradient, label, vigra::DirectNeighborhood, options);
    worker->ms = worker_clock_ms() - begin;
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
