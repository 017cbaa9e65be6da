/* SPDX-License-Identifier: MIT */
/* Write one or more pictures of a file, read one, and describe a file, by OpenImageIO. */
#include "helper/image_oiio.hh"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include <sys/stat.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

extern "C" {
#include "image/linear.h"
}
#include "image/reader_common.h"
#include "helper/wire.hh"

namespace image
{

using namespace wire;

/* The HEIC writer of OpenImageIO 2.4 copies rows of libheif's length, a multiple of 16 and at least
 * 64 pixels: it reads beyond the last row. */
constexpr uint64_t read_beyond = 256;
constexpr size_t fact_most = 4096;

/* ---- writing ---- */

std::vector<Note> receive_notes(uint64_t count)
{
    std::vector<Note> notes;
    for (uint64_t i = 0; i < count; i++) {
        std::string line = receive_line();
        size_t at = 0;
        uint64_t name = take_number(line, at, name_most);
        uint64_t value = take_number(line, at, value_most);
        Note note;
        note.name = receive_text(name);
        note.value = receive_text(value);
        notes.push_back(std::move(note));
    }
    return notes;
}

std::string extension_of(const std::string &path)
{
    size_t dot = path.find_last_of('.');
    return dot == std::string::npos ? std::string() : path.substr(dot);
}

/* Store notes as the format allows; nothing may differ from run to run. */
void add_notes(OIIO::ImageSpec &spec, const std::string &format, const std::vector<Note> &notes)
{
    if (format == "png") {
        for (const Note &note : notes)
            spec.attribute(note.name, note.value);
        return;
    }
    std::string description;
    for (const Note &note : notes)
        description += note.name + ": " + note.value + "\n";
    if (!description.empty())
        spec.attribute("ImageDescription", description);
}

OIIO::ImageSpec spec_of(const Request &request, const std::vector<Note> &notes,
                        const std::string &format)
{
    OIIO::ImageSpec spec(static_cast<int>(request.width), static_cast<int>(request.height),
                         static_cast<int>(request.channels), OIIO::TypeUInt8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (request.channels == 4) /* straight alpha */
        spec.attribute("oiio:UnassociatedAlpha", 1);
    if (format == "hdr") { /* linear light */
        spec.set_format(OIIO::TypeFloat);
        spec.attribute("oiio:ColorSpace", "linear");
    }
    if (format == "jpeg") {
        spec.attribute("Compression", "jpeg:95");
        spec.attribute("jpeg:subsampling", "4:4:4");
    }
    if (format == "heif")
        spec.attribute("Compression", "heic:100");
    if (format == "webp")
        spec.attribute("Compression", "lossless");
    /* These formats store the current time if none is given. PNG omits an invalid time; the others
     * store it, so they get the epoch. */
    if (format == "png") {
        spec.attribute("DateTime", "none");
        /* Filter by the row above: it compresses as well in a third of the time of zlib's default.
         */
        spec.attribute("png:filter", 0x20);
        spec.attribute("png:compressionLevel", 4);
    }
    if (format == "tiff" || format == "dpx" || format == "rla")
        spec.attribute("DateTime", "1970:01:01 00:00:00");
    if (request.frames > 1 && request.delay_ms > 0) {
        const int rate[2] = {1000, static_cast<int>(request.delay_ms)};
        spec.attribute("FramesPerSecond", OIIO::TypeRational, rate);
    }
    add_notes(spec, format, notes);
    return spec;
}

/* Linear light of an sRGB level, from our table of half floats by bits, so that no library's power
 * function decides a file's bytes. */
float linear_of(uint8_t level)
{
    const uint32_t half = linear_half[level];
    const uint32_t bits = half ? (half << 13) + ((127 - 15) << 23) : 0; /* none is subnormal */
    float light;
    std::memcpy(&light, &bits, sizeof light);
    return light;
}

/* Open the file for frame `number`; some formats need all frames first. */
bool open_frame(OIIO::ImageOutput &out, const Request &request, const OIIO::ImageSpec &spec,
                uint64_t number)
{
    if (number > 0)
        return out.open(request.path, spec, OIIO::ImageOutput::AppendSubimage);
    if (request.frames > 1 && !out.supports("appendsubimage")) {
        const std::vector<OIIO::ImageSpec> all(request.frames, spec);
        return out.open(request.path, static_cast<int>(request.frames), all.data());
    }
    return out.open(request.path, spec);
}

std::string reason(OIIO::ImageOutput &out)
{
    const std::string words = out.geterror();
    return words.empty() ? "OpenImageIO reports no reason" : words;
}

/* Write the frames as they arrive; return the words of a failure, or none. All frames are received
 * in any case. */
std::string write_frames(const Request &request, const std::vector<Note> &notes,
                         OIIO::ImageOutput *out, std::string words)
{
    std::vector<uint8_t> pixels;
    pixels.reserve(request.channels * request.width * request.height + read_beyond);
    pixels.resize(request.channels * request.width * request.height);
    OIIO::ImageSpec spec;
    if (words.empty())
        spec = spec_of(request, notes, out->format_name());
    for (uint64_t i = 0; i < request.frames; i++) {
        receive(pixels.data(), pixels.size());
        if (!words.empty())
            continue;
        try {
            bool fine = open_frame(*out, request, spec, i);
            if (fine && out->spec().format == OIIO::TypeFloat) {
                std::vector<float> light(pixels.size());
                std::transform(pixels.begin(), pixels.end(), light.begin(), linear_of);
                fine = out->write_image(OIIO::TypeFloat, light.data());
            } else if (fine) {
                fine = out->write_image(OIIO::TypeUInt8, pixels.data());
            }
            if (!fine)
                words = reason(*out);
        } catch (const std::bad_alloc &) {
            throw;
        } catch (const std::exception &error) {
            words = *error.what() ? error.what() : "OpenImageIO reports no reason";
        }
    }
    if (out && !out->close() && words.empty())
        words = reason(*out);
    return words;
}

void write_image(const Request &request)
{
    const std::vector<Note> notes = receive_notes(request.notes);
    std::string words = request.refusal;
    std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(request.path);
    if (!words.empty()) {
        out.reset();
    } else if (!out || is_no_file(out->format_name())) {
        OIIO::geterror();
        out.reset();
        words = "no known format writes " + extension_of(request.path) +
                "; expected for instance .png, .exr, .tif or .jpg";
    } else if (request.frames > 1 && !out->supports("multiimage")) {
        words =
            extension_of(request.path) + " holds one picture; expected for instance .gif or .tif";
        out.reset();
    }
    /* The library ignores errors when it closes a file, such as a full disk. Hold the file and
     * check, if the format allows it. (The TIFF writer reports errors, and loses its directory if
     * its file is held.) */
    std::unique_ptr<OIIO::Filesystem::IOFile> file;
    if (out && std::strcmp(out->format_name(), "tiff") != 0 && out->supports("ioproxy")) {
        file = std::make_unique<OIIO::Filesystem::IOFile>(request.path,
                                                          OIIO::Filesystem::IOProxy::Write);
        out->set_ioproxy(file.get());
    }
    words = write_frames(request, notes, out.get(), words);
    if (words.empty() && file && (std::fflush(file->handle()) != 0 || std::ferror(file->handle())))
        words = std::strerror(errno);
    if (words.empty())
        transmit("ok\n");
    else
        answer_error(words);
}

/* ---- reading ---- */

std::vector<Note> notes_of(const OIIO::ImageSpec &spec)
{
    std::vector<Note> notes;
    for (const OIIO::ParamValue &value : spec.extra_attribs) {
        Note note{value.name().string(), value.get_string()};
        bool text = value.type() == OIIO::TypeString;
        if (text && note.name.size() <= name_most && note.value.size() <= value_most &&
            notes.size() < notes_most)
            notes.push_back(std::move(note));
    }
    return notes;
}

/* Convert grey or colour, with or without alpha, to four channels, in place from the end. */
void widen(std::vector<uint8_t> &pixels, size_t channels, size_t count)
{
    for (size_t i = count; i-- > 0;) {
        uint8_t from[4] = {0, 0, 0, 255};
        for (size_t c = 0; c < channels; c++)
            from[c] = pixels[channels * i + c];
        bool grey = channels < 3;
        pixels[4 * i] = from[0];
        pixels[4 * i + 1] = from[grey ? 0 : 1];
        pixels[4 * i + 2] = from[grey ? 0 : 2];
        pixels[4 * i + 3] = channels == 2 ? from[1] : from[3];
    }
}

/* Open a picture with straight alpha; answer an error if it is no picture or too large. */
std::unique_ptr<OIIO::ImageInput> open_image(const std::string &path)
{
    OIIO::ImageSpec wish;
    wish.attribute("oiio:UnassociatedAlpha", 1);
    std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &wish);
    if (!in) {
        const std::string words = OIIO::geterror();
        const bool is_known = OIIO::ImageInput::create(path) != nullptr;
        OIIO::geterror();
        answer_error(is_known ? words : "it is no picture of a format that is known here");
        return in;
    }
    const OIIO::ImageSpec &spec = in->spec();
    struct stat status;
    const uint64_t pixels = spec.image_pixels(); /* a megabyte may claim a gigabyte */
    const bool swells =
        stat(path.c_str(), &status) != 0 ||
        swelling_needs_yes(4 * pixels, pixels, static_cast<uint64_t>(status.st_size));
    if (spec.width < 1 || spec.height < 1 || spec.width > static_cast<int>(side_most) ||
        spec.height > static_cast<int>(side_most) || spec.depth > 1 || spec.deep ||
        spec.nchannels < 1 || is_no_file(in->format_name())) {
        answer_error("it is " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                     " pixels, deep or of no file; expected a flat image of 1 to 16384 a side");
        in.reset();
    } else if (swells) {
        answer_error("it claims " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                     " pixels; a picture of that size has a byte for "
                     "each " +
                     std::to_string(SWELLING_MOST) + " of them");
        in.reset();
    }
    return in;
}

/* Read the first four channels; answer an error and return nothing on failure. */
std::vector<uint8_t> pixels_of(OIIO::ImageInput &in)
{
    const OIIO::ImageSpec &spec = in.spec();
    const size_t count = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    const int channels = std::min(spec.nchannels, 4);
    std::vector<uint8_t> pixels(4 * count);
    if (!in.read_image(0, 0, 0, channels, OIIO::TypeUInt8, pixels.data())) {
        answer_error(in.geterror());
        pixels.clear();
        return pixels;
    }
    widen(pixels, static_cast<size_t>(channels), count);
    return pixels;
}

void read_image(const Request &request)
{
    const std::unique_ptr<OIIO::ImageInput> in = open_image(request.path);
    const std::vector<uint8_t> pixels = in ? pixels_of(*in) : std::vector<uint8_t>();
    if (pixels.empty())
        return;
    const OIIO::ImageSpec spec = in->spec();
    const std::vector<Note> notes = notes_of(spec);
    const std::string size = " " + std::to_string(spec.width) + " " + std::to_string(spec.height);
    const std::string format = in->format_name(), type = spec.format.c_str();
    if (request.kind == Request::READ) {
        transmit("picture" + size + " " + std::to_string(notes.size()) + "\n");
    } else {
        std::string channels; /* "R,G,B", cut if too long */
        for (int c = 0; c < spec.nchannels; c++)
            channels += (c ? "," : "") + std::string(spec.channel_name(c));
        channels.resize(std::min(channels.size(), fact_most));
        uint64_t frames = 1;
        while (frames < frames_most && in->seek_subimage(static_cast<int>(frames), 0))
            frames++;
        transmit("about" + size + " " + std::to_string(frames) + " " +
                 std::to_string(notes.size()) + " " + std::to_string(format.size()) + " " +
                 std::to_string(type.size()) + " " + std::to_string(channels.size()) + "\n" +
                 format + type + channels);
    }
    for (const Note &note : notes)
        transmit(std::to_string(note.name.size()) + " " + std::to_string(note.value.size()) + "\n" +
                 note.name + note.value);
    if (request.kind == Request::READ)
        transmit(pixels.data(), pixels.size());
}

} // namespace image
