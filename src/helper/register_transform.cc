/* SPDX-License-Identifier: MIT */
/* Transform files of ITK, out of bytes (itk_transform.h). */
#include <cstring>

extern "C" {
#include "helper/itk_transform.h"
}
#include "helper/register_parts.hh"

namespace registering
{

TransformFile read_transform(const std::string &bytes)
{
    TransformFile out;
    struct affine map;
    struct fault fault = {};
    struct buf kind = {};
    const char *text = bytes.c_str();
    enum err err;
    if (std::strlen(text) == bytes.size() && itk_transform_is_text(text, bytes.size()))
        err = itk_transform_scan(&map, &kind, text, &fault);
    else if (itk_transform_is_matlab(text, bytes.size()))
        err = itk_transform_decode(&map, &kind, text, bytes.size(), &fault);
    else
        throw Refusal{"it is no affine transform that is known here: ITK's as text or .mat, or "
                      "\"fsl:FILE\" for a matrix of FLIRT"};
    if (err)
        throw Refusal{fault.text};
    std::memcpy(out.map, map.m, sizeof out.map);
    out.kind = buf_text(&kind);
    buf_release(&kind);
    return out;
}

} // namespace registering
