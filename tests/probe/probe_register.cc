/* SPDX-License-Identifier: MIT */
/* iftty-register with what a library that was taken over would try in place of its work. */
#include "helper/register_parts.hh"
#include "tests/probe/attempts.hh"

namespace registering
{

Found register_volumes(Volume[2])
{
    throw Refusal{"registering: " + attempts("./probed", false, false)};
}

TransformFile read_transform(const std::string &)
{
    throw Refusal{"reading: " + attempts("./probed", false, false)};
}

} // namespace registering
