/* SPDX-License-Identifier: MIT */
/*
 * TIFF: shared by volume_tiff.cc, which reads pages by libtiff, and volume_tiff_stack.cc, which
 * assigns pages to slices and volumes.
 *
 * The pages of a TIFF have no axes. Programs write them into the description of the first page:
 *
 *     ImageJ    lines: images=10 channels=2 slices=5 frames=1 unit=um spacing=2; channels fastest
 *     OME       XML: SizeZ, SizeC, SizeT, DimensionOrder, and in TiffData the page of each plane
 *     tifffile  JSON: {"shape": [2, 5, 7, 11], "axes": "CZYX"}
 *     LSM       a tag of its own, CZ_LSMINFO
 *
 * Without a description every page is a slice. A description that contradicts the pages is refused.
 */
#ifndef IMAGE_VOLUME_TIFF_HH
#define IMAGE_VOLUME_TIFF_HH

#include <cstdint>
#include <string>
#include <vector>

namespace volume
{

/* The directory of a page. */
struct TiffPage {
    uint64_t at = 0; /* its offset in the file */
    uint32_t width = 0, height = 0;
    unsigned samples = 1, alphas = 0; /* per pixel; the last ones are alpha */
    unsigned bits = 1, format = 1, photometric = 1, orientation = 1, compression = 1;
    uint32_t depth = 1;                       /* slices; only 1 is supported */
    bool is_reduced = false, is_mask = false; /* NewSubfileType */
};

struct TiffAxis {
    char letter; /* Z slices, C channels, T frames; others as tifffile names them */
    uint64_t size;
};

/* Page of slice z of volume v: page[v * slices + z], an index of the file's pages. */
struct TiffStack {
    std::string by = "its resolution"; /* source of the voxel size */
    uint64_t slices = 0, volumes = 1;
    std::vector<TiffAxis> axes; /* axes of volumes, the fastest first; samples count as channels */
    std::vector<size_t> page;
    bool is_run = false;           /* page[] counts contiguous planes after the only page */
    double step[3] = {0, 0, 0};    /* voxel size in `unit`; 0: unknown */
    std::string unit = "mm";       /* as written; "" for none */
    std::vector<std::string> note; /* lines */
};

/* Indices of the pages that are images. */
std::vector<size_t> images_of(const std::vector<TiffPage> &page);

/* Arrange the pages by the description and the tag CZ_LSMINFO ("" for none). `samples` of a page
 * exclude alpha. `resolution` has only step[0] and step[1]. */
TiffStack stack_of(const std::vector<TiffPage> &page, unsigned samples, const std::string &path,
                   const std::string &description, const std::string &lsm,
                   const TiffStack &resolution, const std::string &type);

} // namespace volume

#endif
