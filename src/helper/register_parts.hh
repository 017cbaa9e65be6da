/* SPDX-License-Identifier: MIT */
/* Shared by the parts of iftty-register; the protocol is in registration.h. */
#ifndef REGISTER_REGISTER_PARTS_HH
#define REGISTER_REGISTER_PARTS_HH

#include <cstdint>
#include <string>
#include <vector>

namespace registering
{

/* Thrown if a request fails. The words are for the user. */
struct Refusal {
    std::string words;
};

/* A scene of a request: intensities, x fastest, and the rows of the matrix to its world. */
struct Volume {
    uint32_t size[3] = {0, 0, 0};
    double to_mm[3][4] = {};
    std::vector<uint16_t> voxels;
};

/* The answer, as it is sent. */
struct Found {
    double map[12]; /* three rows: from the fixed scene's world to the moving one's */
    double metric, identity_metric, mirrored_metric;
    double fixed_overlap, moving_overlap; /* share of either content inside the other */
    double agreement_mm, length_mm;
};

/* Register volume[0], the fixed scene, to volume[1]. */
Found register_volumes(Volume volume[2]);

/* A transform file of ITK: the rows of its map, in LPS+, and its kind. */
struct TransformFile {
    double map[12];
    std::string kind;
};
TransformFile read_transform(const std::string &bytes);

/* Report progress. */
void progress(unsigned done, unsigned total);

} // namespace registering

#endif
