/* SPDX-License-Identifier: MIT */
/*
 * Registration, and files of transforms (itk_transform.h).
 *
 * Registration is rigid, then affine, by Mattes' mutual information; D. Mattes et al., "PET-CT
 * image registration in the chest using free-form deformations", IEEE Trans. Med. Imaging 22 (2003)
 * 120-128.
 *
 * Both scenes are moved to one world in which the fixed scene's content has its middle at 0 and
 * half its length is 1. There a unit of rotation, stretch and translation has a similar effect, so
 * that an optimiser with normalised steps needs no scales.
 *
 * Samples are on a fixed lattice that shares its steps with no grid: sampled at voxel centres,
 * mutual information of two coinciding grids is too high.
 */
#include "helper/register_parts.hh"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <itkAffineTransform.h>
#include <itkBinShrinkImageFilter.h>
#include <itkImage.h>
#include <itkLinearInterpolateImageFunction.h>
#include <itkMattesMutualInformationImageToImageMetricv4.h>
#include <itkRegularStepGradientDescentOptimizerv4.h>
#include <itkVersorRigid3DTransform.h>

extern "C" {
#include "helper/itk_transform.h"
}

namespace registering
{

using Image = itk::Image<float, 3>;
using Metric = itk::MattesMutualInformationImageToImageMetricv4<Image, Image>;
using Transform = itk::MatrixOffsetTransformBase<double, 3, 3>;
using Rigid = itk::VersorRigid3DTransform<double>;
using Affine = itk::AffineTransform<double, 3>;
using Optimizer = itk::RegularStepGradientDescentOptimizerv4<double>;
using Point = Image::PointType;

constexpr unsigned bins = 40;
constexpr double part_sampled = 0.02;
constexpr size_t shrunk_least = 400000; /* voxels */
constexpr size_t samples_least = 16000; /* small levels are sampled more densely */

/* Three rows of a matrix. */
using Map = std::array<std::array<double, 4>, 3>;

/* ---- scenes ---- */

/* A scene to register. */
struct Scene {
    Image::Pointer level[3]; /* full; halved; quartered along each axis, unless too small */
    Point low, high, mass;   /* box and mean of its content, in the common world */
    std::vector<Point> content;
};

/* Range of intensities without the lowest and highest thousandth; others are clamped to it. */
void take_range(float range[2], const std::vector<uint16_t> &voxels)
{
    std::vector<size_t> count(65536);
    for (const uint16_t voxel : voxels)
        count[voxel]++;
    size_t below = 0, above = 0, low = 0, high = 65535;
    const size_t least = voxels.size() / 1000;
    while (low < 65535 && (below += count[low]) <= least)
        low++;
    while (high > 0 && (above += count[high]) <= least)
        high--;
    range[0] = static_cast<float>(low);
    range[1] = static_cast<float>(high);
}

/* Otsu's threshold: N. Otsu, IEEE Trans. Syst. Man Cybern. 9 (1979). */
float threshold_of(const Image *image, const float range[2])
{
    constexpr size_t parts = 256;
    std::array<double, parts> count = {};
    const float *at = image->GetBufferPointer();
    const size_t voxels = image->GetBufferedRegion().GetNumberOfPixels();
    for (size_t i = 0; i < voxels; i++)
        count[static_cast<size_t>((at[i] - range[0]) / (range[1] - range[0]) * (parts - 1))]++;
    double all = 0, sum = 0, best = -1, below = 0, below_sum = 0;
    size_t part = 0;
    for (size_t i = 0; i < parts; i++) {
        all += count[i];
        sum += static_cast<double>(i) * count[i];
    }
    for (size_t i = 0; i + 1 < parts; i++) {
        below += count[i];
        below_sum += static_cast<double>(i) * count[i];
        if (below == 0 || below == all)
            continue;
        const double apart = below_sum / below - (sum - below_sum) / (all - below);
        if (below * (all - below) * apart * apart > best) {
            best = below * (all - below) * apart * apart;
            part = i;
        }
    }
    return range[0] + (range[1] - range[0]) * static_cast<float>(part + 1) / parts;
}

/* Collect the voxels of the smallest level above its background. */
void take_content(Scene &scene, const float range[2])
{
    const Image *image = scene.level[2];
    const float least = threshold_of(image, range);
    const float *at = image->GetBufferPointer();
    const size_t voxels = image->GetBufferedRegion().GetNumberOfPixels();
    scene.mass.Fill(0);
    for (size_t i = 0; i < voxels; i++) {
        Point point;
        if (at[i] < least)
            continue;
        image->TransformIndexToPhysicalPoint(
            image->ComputeIndex(static_cast<itk::OffsetValueType>(i)), point);
        for (unsigned w = 0; w < 3; w++) {
            const bool is_first = scene.content.empty();
            scene.low[w] = is_first ? point[w] : std::min(scene.low[w], point[w]);
            scene.high[w] = is_first ? point[w] : std::max(scene.high[w], point[w]);
            scene.mass[w] += point[w];
        }
        scene.content.push_back(point);
    }
    for (unsigned w = 0; w < 3; w++)
        scene.mass[w] /= static_cast<double>(scene.content.size());
}

void place_image(Image *image, const Map &to_world)
{
    Image::DirectionType direction;
    Image::SpacingType spacing;
    Image::PointType origin;
    for (unsigned a = 0; a < 3; a++)
        spacing[a] = std::hypot(to_world[0][a], to_world[1][a], to_world[2][a]);
    for (unsigned w = 0; w < 3; w++) {
        origin[w] = to_world[w][3];
        for (unsigned a = 0; a < 3; a++)
            direction[w][a] = to_world[w][a] / spacing[a];
    }
    image->SetOrigin(origin);
    image->SetSpacing(spacing);
    image->SetDirection(direction);
}

/* Halve the image along its finer axes, unless it is small. */
Image::Pointer shrunk(Image *image)
{
    auto filter = itk::BinShrinkImageFilter<Image, Image>::New();
    const Image::SpacingType spacing = image->GetSpacing();
    const double least = std::min({spacing[0], spacing[1], spacing[2]});
    if (image->GetBufferedRegion().GetNumberOfPixels() < shrunk_least)
        return image;
    filter->SetInput(image);
    for (unsigned a = 0; a < 3; a++)
        filter->SetShrinkFactor(a, spacing[a] < 1.5 * least ? 2 : 1);
    filter->Update();
    return filter->GetOutput();
}

Scene scene_of(Volume &volume, const char *which)
{
    Scene scene;
    float range[2];
    take_range(range, volume.voxels);
    if (!(range[1] > range[0]))
        throw Refusal{std::string("the ") + which + " scene has no contrast: one intensity alone"};
    auto image = Image::New();
    image->SetRegions(Image::SizeType{{volume.size[0], volume.size[1], volume.size[2]}});
    image->Allocate();
    float *to = image->GetBufferPointer();
    for (const uint16_t voxel : volume.voxels)
        *to++ = std::clamp(static_cast<float>(voxel), range[0], range[1]);
    volume.voxels = {};
    Map to_mm;
    for (size_t w = 0; w < 3; w++)
        std::copy(volume.to_mm[w], volume.to_mm[w] + 4, to_mm[w].begin());
    place_image(image, to_mm);
    scene.level[0] = image;
    scene.level[1] = shrunk(image);
    scene.level[2] = shrunk(scene.level[1]);
    take_content(scene, range);
    return scene;
}

/* The common world: point' = (point - middle) / length. */
struct Common {
    Point middle;
    double length;
};

void move_into(const Common &common, Scene &scene)
{
    const auto moved = [&](Point point) {
        for (unsigned w = 0; w < 3; w++)
            point[w] = (point[w] - common.middle[w]) / common.length;
        return point;
    };
    for (unsigned i = 0; i < 3; i++) {
        Image *image = scene.level[i];
        if (i > 0 && image == scene.level[i - 1])
            continue;
        image->SetOrigin(moved(image->GetOrigin()));
        image->SetSpacing(image->GetSpacing() / common.length);
    }
    for (Point *point : {&scene.low, &scene.high, &scene.mass})
        *point = moved(*point);
    for (Point &point : scene.content)
        point = moved(point);
}

/* ---- metric ---- */

/* M. Roberts' sequence in three dimensions: the powers of 1/g, g the root of x^4 = x + 1, which is
 * least correlated with any grid. */
Metric::FixedSampledPointSetPointer samples_of(const Image *image)
{
    constexpr double step[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
    const Image::SizeType size = image->GetBufferedRegion().GetSize();
    const size_t voxels = image->GetBufferedRegion().GetNumberOfPixels();
    const size_t wanted = static_cast<size_t>(part_sampled * static_cast<double>(voxels));
    const size_t count = std::max(wanted, std::min(voxels / 8, samples_least));
    auto samples = Metric::FixedSampledPointSetType::New();
    for (size_t i = 0; i < count; i++) {
        itk::ContinuousIndex<double, 3> at;
        Point point;
        for (unsigned a = 0; a < 3; a++) {
            const double whole = static_cast<double>(i + 1) * step[a];
            at[a] = (whole - std::floor(whole)) * static_cast<double>(size[a] - 1);
        }
        image->TransformContinuousIndexToPhysicalPoint(at, point);
        samples->SetPoint(i, point);
    }
    return samples;
}

Metric::Pointer metric_of(const Scene &fixed, const Scene &moving, unsigned level)
{
    auto metric = Metric::New();
    metric->SetNumberOfHistogramBins(bins);
    metric->SetFixedImage(fixed.level[level]);
    metric->SetMovingImage(moving.level[level]);
    metric->SetFixedSampledPointSet(samples_of(fixed.level[level]));
    metric->SetUseSampledPointSet(true);
    metric->SetUseFixedImageGradientFilter(false); /* three doubles a voxel */
    metric->SetUseMovingImageGradientFilter(false);
    metric->SetMaximumNumberOfWorkUnits(1);
    return metric;
}

/* Mutual information in nats; 0 if the scenes hardly overlap. */
double information(Metric *metric, Transform *transform)
{
    metric->SetMovingTransform(transform);
    metric->Initialize();
    const double value = metric->GetValue();
    return value < 0 && std::isfinite(value) ? -value : 0;
}

/* ---- search ---- */

unsigned steps_done, steps_total;

/* First and last step in millimetres, half a head off the middle. */
struct Pace {
    unsigned level, iterations;
    double first_mm, last_mm;
};

void search_map(const Scene &fixed, const Scene &moving, Transform *transform, const Pace &pace,
                double length)
{
    const unsigned before = steps_done;
    const bool is_new =
        pace.level > 0 || fixed.level[0] != fixed.level[1] || moving.level[0] != moving.level[1];
    if (!is_new) /* the level is the finer one: already done */
        return;
    auto metric = metric_of(fixed, moving, pace.level);
    auto optimizer = Optimizer::New();
    Optimizer::ScalesType scales(transform->GetNumberOfParameters());
    scales.Fill(1);
    metric->SetMovingTransform(transform);
    metric->Initialize();
    optimizer->SetMetric(metric);
    optimizer->SetScales(scales);
    optimizer->SetDoEstimateLearningRateOnce(false);
    optimizer->SetLearningRate(pace.first_mm / length);
    optimizer->SetMinimumStepLength(pace.last_mm / length);
    optimizer->SetRelaxationFactor(0.6);
    optimizer->SetNumberOfIterations(pace.iterations);
    optimizer->SetNumberOfWorkUnits(1);
    optimizer->SetReturnBestParametersAndValue(true);
    optimizer->AddObserver(itk::IterationEvent(), [](const itk::EventObject &) {
        progress(std::min(++steps_done, steps_total - 1), steps_total);
    });
    optimizer->StartOptimization();
    steps_done = before + pace.iterations;
}

constexpr Pace rigid_pace[] = {{2, 60, 6, 0.2}, {1, 25, 1, 0.05}};
constexpr Pace affine_pace[] = {{2, 80, 3, 0.1}, {1, 60, 1, 0.03}, {0, 30, 0.3, 0.02}};
constexpr unsigned starts = 3;

Rigid::Pointer start_of(const Scene &fixed, const Scene &moving, unsigned start)
{
    auto rigid = Rigid::New();
    Rigid::OutputVectorType way;
    way.Fill(0);
    for (unsigned w = 0; w < 3; w++)
        way[w] = start == 0   ? 0
                 : start == 1 ? moving.mass[w] - fixed.mass[w]
                              : (moving.low[w] + moving.high[w] - fixed.low[w] - fixed.high[w]) / 2;
    rigid->SetIdentity();
    rigid->SetTranslation(way);
    return rigid;
}

Affine::Pointer affine_of(const Transform *transform)
{
    auto affine = Affine::New();
    affine->SetMatrix(transform->GetMatrix());
    affine->SetOffset(transform->GetOffset());
    return affine;
}

/* Search from the identity and from two other starts, down to level `finest`. */
Affine::Pointer search_all(const Scene &fixed, const Scene &moving, unsigned finest, double length)
{
    Rigid::Pointer best;
    double most = -1;
    auto metric = metric_of(fixed, moving, 2);
    for (unsigned start = 0; start < starts; start++) {
        auto rigid = start_of(fixed, moving, start);
        search_map(fixed, moving, rigid, rigid_pace[0], length);
        const double value = information(metric, rigid);
        if (value > most) {
            most = value;
            best = rigid;
        }
    }
    search_map(fixed, moving, best, rigid_pace[1], length);
    auto affine = affine_of(best);
    for (const Pace &pace : affine_pace)
        if (pace.level >= finest)
            search_map(fixed, moving, affine, pace, length);
    return affine;
}

/* Metric of the fixed scene's mirror image, searched from the same map. */
double mirrored_information(const Scene &fixed, const Scene &moving, const Affine *affine,
                            double length)
{
    auto mirrored = affine_of(affine);
    Affine::OutputVectorType scale;
    scale.Fill(1);
    scale[0] = -1; /* x is the patient's left and right; 0 is the middle of the content */
    mirrored->Scale(scale, true);
    search_map(fixed, moving, mirrored, affine_pace[0], length);
    search_map(fixed, moving, mirrored, affine_pace[1], length);
    return information(metric_of(fixed, moving, 1), mirrored);
}

/* ---- quality ---- */

double overlap(const Scene &of, const Scene &in, const Transform *transform)
{
    const Image *image = in.level[2];
    size_t inside = 0;
    for (const Point &point : of.content) {
        itk::ContinuousIndex<double, 3> at;
        inside +=
            image->TransformPhysicalPointToContinuousIndex(transform->TransformPoint(point), at);
    }
    return static_cast<double>(inside) / static_cast<double>(of.content.size());
}

/* Largest error of going there and back, at the corners of the content. */
double round_trip_error(const Scene &fixed, const Transform *there, const Transform *back)
{
    double most = 0;
    for (unsigned corner = 0; corner < 8; corner++) {
        Point from;
        for (unsigned w = 0; w < 3; w++)
            from[w] = corner >> w & 1 ? fixed.high[w] : fixed.low[w];
        most = std::max(
            most, from.EuclideanDistanceTo(back->TransformPoint(there->TransformPoint(from))));
    }
    return most;
}

Found register_volumes(Volume volume[2])
{
    Found found = {};
    steps_total = 2 * starts * rigid_pace[0].iterations + 2 * rigid_pace[1].iterations +
                  3 * (affine_pace[0].iterations + affine_pace[1].iterations) +
                  affine_pace[2].iterations;
    Scene fixed = scene_of(volume[0], "subject's"), moving = scene_of(volume[1], "procedure's");
    Common common = {fixed.mass, 0};
    for (unsigned w = 0; w < 3; w++) {
        common.middle[w] = (fixed.low[w] + fixed.high[w]) / 2;
        common.length = std::max(common.length, (fixed.high[w] - fixed.low[w]) / 2);
    }
    if (!(common.length > 0))
        throw Refusal{"the subject's scene has nothing in it but a plane"};
    move_into(common, fixed);
    move_into(common, moving);
    auto there = search_all(fixed, moving, 0, common.length);
    auto back = search_all(moving, fixed, 1, common.length);
    auto metric = metric_of(fixed, moving, 1);
    auto identity = Affine::New();
    found.metric = information(metric, there);
    found.identity_metric = information(metric, identity);
    found.mirrored_metric = mirrored_information(fixed, moving, there, common.length);
    found.agreement_mm = round_trip_error(fixed, there, back) * common.length;
    found.length_mm = 2 * common.length;
    found.fixed_overlap = overlap(fixed, moving, there);
    auto inverse = Affine::New();
    if (there->GetInverse(inverse))
        found.moving_overlap = overlap(moving, fixed, inverse);
    for (unsigned w = 0; w < 3; w++) {
        double *row = &found.map[4 * w];
        row[3] = there->GetOffset()[w] * common.length + common.middle[w];
        for (unsigned a = 0; a < 3; a++) {
            row[a] = there->GetMatrix()[w][a];
            row[3] -= row[a] * common.middle[a];
        }
    }
    return found;
}

/* ---- files of transforms ---- */

TransformFile read_transform(const std::string &bytes)
{
    TransformFile out;
    struct affine map;
    struct fault fault = {};
    struct buf kind = {};
    if (itk_transform_read(&map, &kind, bytes.c_str(), bytes.size(), &fault))
        throw Refusal{fault.text};
    std::memcpy(out.map, map.m, sizeof out.map);
    out.kind = buf_text(&kind);
    buf_release(&kind);
    return out;
}

} // namespace registering
