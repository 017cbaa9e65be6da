/* SPDX-License-Identifier: MIT */
/* The measures of a comparison as ITK has them, for tests/test_compare.sh:
 *
 *     itk_compare NX NY NZ SX SY SZ A B LABELS
 *
 * A and B are files of NX * NY * NZ bytes, x fastest; SX, SY, SZ the spacing in mm. For each label
 * from 1 to LABELS, and then for all of them, a line: label, Dice, Jaccard, volume similarity,
 * Hausdorff distance, larger directed mean distance of contours. "-" where a set is empty. */
#include <itkContourMeanDistanceImageFilter.h>
#include <itkHausdorffDistanceImageFilter.h>
#include <itkImage.h>
#include <itkLabelOverlapMeasuresImageFilter.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>

using Image = itk::Image<unsigned char, 3>;
using Overlap = itk::LabelOverlapMeasuresImageFilter<Image>;
using Hausdorff = itk::HausdorffDistanceImageFilter<Image, Image>;
using Contours = itk::ContourMeanDistanceImageFilter<Image, Image>;

static Image::Pointer new_image(char **number)
{
    auto image = Image::New();
    Image::SizeType size;
    Image::SpacingType spacing;
    for (unsigned a = 0; a < 3; a++) {
        size[a] = std::strtoul(number[a], nullptr, 10);
        spacing[a] = std::strtod(number[3 + a], nullptr);
    }
    image->SetRegions(size);
    image->SetSpacing(spacing);
    image->Allocate();
    return image;
}

static size_t voxels_of(const Image *image)
{
    return image->GetLargestPossibleRegion().GetNumberOfPixels();
}

static Image::Pointer read(char **number, const char *path)
{
    auto image = new_image(number);
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char *>(image->GetBufferPointer()),
              static_cast<std::streamsize>(voxels_of(image)));
    if (!file)
        std::exit(3);
    return image;
}

/* The voxels of a label, or for 0 of all. */
static Image::Pointer object_of(char **number, const Image *image, unsigned label, bool *is_there)
{
    auto object = new_image(number);
    const unsigned char *from = image->GetBufferPointer();
    unsigned char *to = object->GetBufferPointer();
    *is_there = false;
    for (size_t i = 0; i < voxels_of(image); i++) {
        to[i] = label ? from[i] == label : from[i] > 0;
        *is_there = *is_there || to[i];
    }
    return object;
}

static void print_distances(char **number, const Image *a, const Image *b, unsigned label)
{
    bool has_a, has_b;
    const auto object_a = object_of(number, a, label, &has_a);
    const auto object_b = object_of(number, b, label, &has_b);
    if (!has_a || !has_b) {
        std::printf(" - -\n");
        return;
    }
    auto hausdorff = Hausdorff::New();
    hausdorff->SetInput1(object_a);
    hausdorff->SetInput2(object_b);
    hausdorff->Update();
    auto contours = Contours::New();
    contours->SetInput1(object_a);
    contours->SetInput2(object_b);
    contours->Update();
    std::printf(" %.9g %.9g\n", hausdorff->GetHausdorffDistance(), contours->GetMeanDistance());
}

int main(int count, char **word)
{
    if (count != 10)
        return 2;
    char **number = word + 1;
    const auto a = read(number, word[7]), b = read(number, word[8]);
    const auto labels = static_cast<unsigned>(std::strtoul(word[9], nullptr, 10));
    auto overlap = Overlap::New();
    overlap->SetSourceImage(a);
    overlap->SetTargetImage(b);
    overlap->Update();
    for (unsigned i = 1; i <= labels + 1; i++) {
        const unsigned label = i % (labels + 1);
        const auto l = static_cast<unsigned char>(label);
        std::printf("%u %.9g %.9g %.9g", label,
                    label ? overlap->GetDiceCoefficient(l) : overlap->GetDiceCoefficient(),
                    label ? overlap->GetJaccardCoefficient(l) : overlap->GetJaccardCoefficient(),
                    label ? overlap->GetVolumeSimilarity(l) : overlap->GetVolumeSimilarity());
        print_distances(number, a, b, label);
    }
    return 0;
}
