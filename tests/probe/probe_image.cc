/* SPDX-License-Identifier: MIT */
/* iftty-image with what a hostile picture would try in place of OpenImageIO. */
#include "helper/image_oiio.hh"
#include "helper/wire.hh"
#include "tests/probe/attempts.hh"

namespace image
{

void write_image(const Request &request)
{
    for (uint64_t i = 0; i < request.notes; i++) {
        const std::string line = wire::receive_line();
        size_t at = 0;
        const uint64_t name = wire::take_number(line, at, name_most);
        wire::receive_text(name + wire::take_number(line, at, value_most));
    }
    wire::receive_text(request.frames * request.width * request.height * 3);
    wire::answer_error("writing: " + attempts(request.path, true, true));
}

void read_image(const Request &request)
{
    wire::answer_error((request.kind == Request::READ ? "reading: " : "telling: ") +
                       attempts(request.path, false, true));
}

} // namespace image
