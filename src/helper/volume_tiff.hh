/* SPDX-License-Identifier: MIT */
/*
 * TIFF: the parts that volume_tiff.cc, which reads pages by libtiff, and volume_tiff_stack.cc,
 * which assigns pages to slices and volumes, share.
 *
 * The pages of a TIFF have no axes. Programs write theirs into the description of the first page:
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
    unsigned samples = 1, alphas = 0; /* of a pixel; the last ones are alpha */
    unsigned bits = 1, format = 1, photometric = 1, orientation = 1, compression = 1;
    uint32_t depth = 1;                       /* slices, of which only 1 is read */
    bool is_reduced = false, is_mask = false; /* NewSubfileType */
};

struct TiffAxis {
    char letter; /* Z slices, C channels, T frames; others as tifffile names them */
    uint64_t size;
};

/* Which page is slice z of volume v: page[v * slices + z], an index of the pages of the file. */
struct TiffStack {
    std::string by = "its resolution"; /* where the size of a voxel is from */
    uint64_t slices = 0, volumes = 1;
    std::vector<TiffAxis> axes; /* along the volumes, the fastest first; with samples as channels */
    std::vector<size_t> page;
    bool is_run = false;        /* page[] counts planes that follow the only page without a gap */
    double step[3] = {0, 0, 0}; /* from voxel to voxel in `unit`; 0: not said */
    std::string unit = "mm";    /* as it is written; "" for none */
    std::vector<std::string> note; /* lines */
};

/* The file as its description and its tag CZ_LSMINFO ("" for none) describe it. `samples` are those
 * of a page, without alpha. Of resolution only step[0] and step[1] are set. */
TiffStack stack_of(const std::vector<TiffPage> &page, unsigned samples, const std::string &path,
                   const std::string &description, const std::string &lsm,
                   const TiffStack &resolution, const std::string &type);

} // namespace volume

#endif
