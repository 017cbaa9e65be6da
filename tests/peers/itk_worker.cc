/* SPDX-License-Identifier: MIT */
/* ITK's MorphologicalWatershedFromMarkersImageFilter as a worker: 6 neighbours, no watershed line,
 * one thread. Timed is Update() alone, of a filter new for each run. */
#include <itkImage.h>
#include <itkMorphologicalWatershedFromMarkersImageFilter.h>
#include <itkMultiThreaderBase.h>

#include <algorithm>

#include "tests/peers/worker.h"

using Image = itk::Image<unsigned char, 3>;
using Watershed = itk::MorphologicalWatershedFromMarkersImageFilter<Image, Image>;

static Image::Pointer image_of(const struct worker *worker, const uint8_t *map)
{
    auto image = Image::New();
    image->SetRegions(Image::SizeType{{worker->size[0], worker->size[1], worker->size[2]}});
    image->Allocate();
    std::copy(map, map + worker->voxels, image->GetBufferPointer());
    return image;
}

static bool run(struct worker *worker)
try {
    auto watershed = Watershed::New();
    watershed->SetInput1(image_of(worker, worker->gradient));
    watershed->SetInput2(image_of(worker, worker->marker));
    watershed->SetMarkWatershedLine(false);
    watershed->SetFullyConnected(false);
    const double begin = worker_clock_ms();
    watershed->Update();
    worker->ms = worker_clock_ms() - begin;
    const unsigned char *label = watershed->GetOutput()->GetBufferPointer();
    std::copy(label, label + worker->voxels, worker->label);
    return true;
} catch (const std::exception &error) {
    snprintf(worker->note, sizeof worker->note, "%s", error.what());
    return false;
}

int main(int, char **argv)
{
    struct worker worker = {};
    itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(1);
    if (!worker_begin(&worker, argv[1]))
        return 3;
    worker_serve(&worker, run);
    return 0;
}
