/* SPDX-License-Identifier: MIT */
/* ITK's MorphologicalWatershedFromMarkersImageFilter as a worker: 6 neighbours, no watershed line,
 * one thread. Timed is Update() alone, of a filter new for each run. */
#include <itkImage.h>
#include <itkMorphologicalWatershedFromMarkersImageFilter.h>
#include <itkMultiThreaderBase.h>

#include <algorithm>

#include "tests/peers/worker.h"

template <class Pixel> static auto image_of(const struct worker *worker, const Pixel *map)
{
    auto image = itk::Image<Pixel, 3>::New();
    image->SetRegions(itk::Size<3>{{worker->size[0], worker->size[1], worker->size[2]}});
    image->Allocate();
    std::copy(map, map + worker->voxels, image->GetBufferPointer());
    return image;
}

template <class Pixel> static void segment(struct worker *worker, const Pixel *gradient)
{
    auto watershed =
        itk::MorphologicalWatershedFromMarkersImageFilter<itk::Image<Pixel, 3>,
                                                          itk::Image<unsigned char, 3>>::New();
    watershed->SetInput1(image_of(worker, gradient));
    watershed->SetInput2(image_of(worker, worker->marker));
    watershed->SetMarkWatershedLine(false);
    watershed->SetFullyConnected(false);
    worker_stage(worker, NULL);
    watershed->Update();
    worker_stage(worker, "run");
    const unsigned char *label = watershed->GetOutput()->GetBufferPointer();
    std::copy(label, label + worker->voxels, worker->label);
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
    itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(1);
    if (!worker_begin(&worker, argv[1]))
        return 3;
    worker_serve(&worker, run);
    return 0;
}
