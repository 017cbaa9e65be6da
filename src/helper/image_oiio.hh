/* SPDX-License-Identifier: MIT */
/* Requests of iftty-image, and the answers, made by OpenImageIO (image_oiio.cc). */
#ifndef IMAGE_IMAGE_OIIO_HH
#define IMAGE_IMAGE_OIIO_HH

#include <cstdint>
#include <string>

namespace image
{

constexpr uint64_t side_most = 16384;
constexpr uint64_t name_most = 4096;
constexpr uint64_t value_most = 1 << 20;
constexpr uint64_t notes_most = 1024;
constexpr uint64_t frames_most = 1000;

struct Request {
    enum { WRITE, READ, ABOUT } kind = READ;
    std::string path;
    uint64_t width = 0, height = 0, notes = 0, frames = 0, delay_ms = 0,
             channels = 0; /* for WRITE */
    std::string refusal;   /* reason against writing; "" if there is no reason */
};

/* Text in a picture; at most name_most and value_most bytes. */
struct Note {
    std::string name, value;
};

/* Send the answer. Libraries may throw before its first byte. */
void write_image(const Request &request); /* receives notes and frames first */
void read_image(const Request &request);  /* READ and ABOUT */

/* Formats that draw on a terminal or write nothing at all. */
inline bool is_no_file(const std::string &format)
{
    return format == "term" || format == "null";
}

} // namespace image

#endif
