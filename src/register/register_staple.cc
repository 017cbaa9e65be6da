/* SPDX-License-Identifier: MIT */
/* The consensus of label maps, by ITK's STAPLE of several labels. */
#include "register/register_parts.hh"

#include <algorithm>
#include <cmath>

#include <itkImage.h>
#include <itkMultiLabelSTAPLEImageFilter.h>

namespace registering
{

/* It counts labels, one more for itself, in a number of the maps' type. */
using Labels = itk::Image<uint16_t, 1>;
using Staple = itk::MultiLabelSTAPLEImageFilter<Labels, Labels, double>;

constexpr unsigned iterations_most = 100;

static Labels::Pointer image_of(const std::vector<uint8_t> &map)
{
    auto image = Labels::New();
    image->SetRegions(Labels::SizeType{{map.size()}});
    image->Allocate();
    std::copy(map.begin(), map.end(), image->GetBufferPointer());
    return image;
}

/* Of a rater: by label, how much of what has it he gives it, and of what has it not, he does not.
 * A confusion matrix holds P(he says j | it is i) in row j and column i. */
static void add_rates(std::vector<double> &rates, const Staple::ConfusionMatrixType &confusion,
                      const std::vector<double> &share)
{
    for (unsigned label = 0; label < share.size(); label++) {
        double said_wrongly = 0, others = 0;
        for (unsigned is = 0; is < share.size(); is++)
            if (is != label) {
                said_wrongly += share[is] * confusion[label][is];
                others += share[is];
            }
        rates.push_back(std::clamp(confusion[label][label], 0.0, 1.0));
        rates.push_back(others > 0 ? std::clamp(1 - said_wrongly / others, 0.0, 1.0) : 1);
    }
}

Consensus agree(const std::vector<std::vector<uint8_t>> &maps, unsigned labels)
{
    Consensus out;
    auto filter = Staple::New();
    unsigned iteration = 0;
    for (unsigned rater = 0; rater < maps.size(); rater++)
        filter->SetInput(rater, image_of(maps[rater]));
    filter->SetLabelForUndecidedPixels(static_cast<uint16_t>(labels));
    filter->SetMaximumNumberOfIterations(iterations_most);
    filter->SetTerminationUpdateThreshold(1e-5);
    filter->AddObserver(itk::IterationEvent(), [&](const itk::EventObject &) {
        progress(std::min(++iteration, iterations_most - 1), iterations_most);
    });
    filter->Update();
    const uint16_t *at = filter->GetOutput()->GetBufferPointer();
    std::vector<double> share(labels);
    for (size_t voxel = 0; voxel < maps[0].size(); voxel++) {
        uint16_t label = *at++;
        if (label >= labels) { /* some are equally likely */
            label = static_cast<uint16_t>(labels);
            for (const std::vector<uint8_t> &map : maps)
                label = std::min<uint16_t>(label, map[voxel]);
        }
        out.map.push_back(static_cast<uint8_t>(label));
        share[label] += 1 / static_cast<double>(maps[0].size());
    }
    for (unsigned rater = 0; rater < maps.size(); rater++)
        add_rates(out.rates, filter->GetConfusionMatrix(rater), share);
    return out;
}

} // namespace registering
