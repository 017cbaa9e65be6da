/* SPDX-License-Identifier: MIT */
/* What the parts of iftty-register share; the protocol is in registration.h. */
#ifndef REGISTER_REGISTER_PARTS_HH
#define REGISTER_REGISTER_PARTS_HH

#include <cstdint>
#include <string>
#include <vector>

namespace registering
{

/* What cannot be done; the words are for the user, and ours alone. */
struct Refusal {
    std::string words;
};

/* A scene as it comes: intensities, x fastest, and the rows of the matrix to its world. */
struct Volume {
    uint32_t size[3] = {0, 0, 0};
    double to_mm[3][4] = {};
    std::vector<uint16_t> voxels;
};

/* What is answered, as it goes over the socket. */
struct Found {
    double map[12]; /* three rows: from the fixed scene's world to the moving one's */
    double metric, identity_metric, mirrored_metric;
    double fixed_overlap, moving_overlap; /* of the content of either, what lies in the other */
    double agreement_mm, length_mm;
};

/* `volume` are the fixed scene and the moving one. */
Found find(Volume volume[2]);

/* A transform file of ITK: the rows of its map, in LPS+, and the name of its kind. */
struct TransformFile {
    double map[12];
    std::string kind;
};
TransformFile read_transform(const std::string &bytes);

/* How far it is. */
void progress(unsigned done, unsigned total);

} // namespace registering

#endif
