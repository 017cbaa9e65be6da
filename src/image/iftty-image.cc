/*
 * iftty-image: reads and writes images by OpenImageIO for the program that started it.
 *
 * Requests come on standard input, answers go to standard output; helper.h has the protocol byte
 * for byte. The end of input, or a request that breaks the protocol, ends the program. Whatever
 * OpenImageIO cannot do is an answer "error". A decoder that crashes takes only this process along.
 */
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "image/wire.hh"

namespace
{

using namespace wire;

/* The HEIC writer of OpenImageIO 2.4 copies rows of libheif's length, which is that of 64 pixels or
 * more, and a multiple of 16: of the last row it reads what lies after the picture. */
constexpr uint64_t kReadBeyond = 256;

constexpr uint64_t kSideMost = 16384;
constexpr uint64_t kPathMost = 4096;
constexpr uint64_t kNameMost = 4096;
constexpr uint64_t kValueMost = 1 << 20;
constexpr uint64_t kNotesMost = 1024;
constexpr uint64_t kFramesMost = 1000;
constexpr uint64_t kDelayMost = 60000;
constexpr size_t kFactMost = 4096;
constexpr rlim_t kMemoryMost = rlim_t{8} << 30;

struct Note {
    std::string name, value;
};

/* ---- requests ---- */

std::vector<Note> receive_notes(uint64_t count)
{
    std::vector<Note> notes;
    for (uint64_t i = 0; i < count; i++) {
        std::string line = receive_line();
        size_t at = 0;
        uint64_t name = take_number(line, at, kNameMost);
        uint64_t value = take_number(line, at, kValueMost);
        Note note;
        note.name = receive_text(name);
        note.value = receive_text(value);
        notes.push_back(std::move(note));
    }
    return notes;
}

/* ---- writing ---- */

/* Formats that draw on a terminal or write nothing at all. */
bool is_no_file(const std::string &format)
{
    return format == "term" || format == "null";
}

std::string extension_of(const std::string &path)
{
    size_t dot = path.find_last_of('.');
    return dot == std::string::npos ? std::string() : path.substr(dot);
}

/* Notes as the format has them; nothing that differs from one run to the next. */
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

struct WriteRequest {
    std::string path;
    uint64_t width, height, frames, delay_ms;
    std::vector<Note> notes;
};

WriteRequest receive_write_request(const std::string &line)
{
    WriteRequest request;
    size_t at = 6; /* past "write " */
    uint64_t length = take_number(line, at, kPathMost);
    request.width = take_number(line, at, kSideMost);
    request.height = take_number(line, at, kSideMost);
    uint64_t count = take_number(line, at, kNotesMost);
    request.frames = take_number(line, at, kFramesMost);
    request.delay_ms = take_number(line, at, kDelayMost);
    if (request.width == 0 || request.height == 0 || request.frames == 0)
        leave(2);
    request.path = receive_text(length);
    request.notes = receive_notes(count);
    return request;
}

OIIO::ImageSpec spec_of(const WriteRequest &request, const std::string &format)
{
    OIIO::ImageSpec spec(static_cast<int>(request.width), static_cast<int>(request.height), 3,
                         OIIO::TypeUInt8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (format == "hdr") { /* this one holds linear light */
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
    /* These put the time of writing in where none is given. PNG leaves out what is no time; the
     * others, which would store even that, get the beginning of all of them. */
    if (format == "png")
        spec.attribute("DateTime", "none");
    if (format == "tiff" || format == "dpx" || format == "rla")
        spec.attribute("DateTime", "1970:01:01 00:00:00");
    if (request.frames > 1 && request.delay_ms > 0) {
        const int rate[2] = {1000, static_cast<int>(request.delay_ms)};
        spec.attribute("FramesPerSecond", OIIO::TypeRational, rate);
    }
    add_notes(spec, format, request.notes);
    return spec;
}

/* Linear light of the levels of sRGB (IEC 61966-2-1). */
float linear_of(uint8_t level)
{
    const float v = static_cast<float>(level) / 255.0f;
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

bool write_frame(OIIO::ImageOutput &out, const std::vector<uint8_t> &pixels)
{
    if (out.spec().format != OIIO::TypeFloat)
        return out.write_image(OIIO::TypeUInt8, pixels.data());
    std::vector<float> light(pixels.size());
    std::transform(pixels.begin(), pixels.end(), light.begin(), linear_of);
    return out.write_image(OIIO::TypeFloat, light.data());
}

/* Opens for the frame `number`; some formats need to know all of them first. */
bool open_frame(OIIO::ImageOutput &out, const WriteRequest &request, const OIIO::ImageSpec &spec,
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
    return words.empty() ? "OpenImageIO gives no reason" : words;
}

/* Writes what the request asks for as its frames arrive; the words of a failure, or none. Whatever
 * happens, all frames are received. */
std::string write_frames(const WriteRequest &request, OIIO::ImageOutput *out, std::string words)
{
    std::vector<uint8_t> pixels;
    pixels.reserve(3 * request.width * request.height + kReadBeyond);
    pixels.resize(3 * request.width * request.height);
    OIIO::ImageSpec spec;
    if (words.empty())
        spec = spec_of(request, out->format_name());
    for (uint64_t i = 0; i < request.frames; i++) {
        receive(pixels.data(), pixels.size());
        if (!words.empty())
            continue;
        try {
            if (!open_frame(*out, request, spec, i) || !write_frame(*out, pixels))
                words = reason(*out);
        } catch (const std::bad_alloc &) {
            throw;
        } catch (const std::exception &error) {
            words = *error.what() ? error.what() : "OpenImageIO gives no reason";
        }
    }
    if (out && !out->close() && words.empty())
        words = reason(*out);
    return words;
}

void write_image(const std::string &line)
{
    const WriteRequest request = receive_write_request(line);
    std::string words;
    std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(request.path);
    if (!out || is_no_file(out->format_name())) {
        OIIO::geterror();
        out.reset();
        words = "no known format writes " + extension_of(request.path) +
                "; expected for instance .png, .exr, .tif or .jpg";
    } else if (request.frames > 1 && !out->supports("multiimage")) {
        words =
            extension_of(request.path) + " holds one picture; expected for instance .gif or .tif";
        out.reset();
    }
    /* The library does not check what closing a file returns, and so would not see that the disk
     * was full; where it lets us hold the file, we check. (Its TIFF writer reports the failure by
     * itself, and loses its directory when held.) */
    std::unique_ptr<OIIO::Filesystem::IOFile> file;
    if (out && std::strcmp(out->format_name(), "tiff") != 0 && out->supports("ioproxy")) {
        file = std::make_unique<OIIO::Filesystem::IOFile>(request.path,
                                                          OIIO::Filesystem::IOProxy::Write);
        out->set_ioproxy(file.get());
    }
    words = write_frames(request, out.get(), words);
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
        if (text && note.name.size() <= kNameMost && note.value.size() <= kValueMost &&
            notes.size() < kNotesMost)
            notes.push_back(std::move(note));
    }
    return notes;
}

/* Grey or colour, with or without alpha, to four channels, in place from the back. */
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

/* Colours as the file holds them, not multiplied by alpha; an error is answered for what is none,
 * or too large. */
std::unique_ptr<OIIO::ImageInput> open_image(const std::string &path)
{
    OIIO::ImageSpec wish;
    wish.attribute("oiio:UnassociatedAlpha", 1);
    std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &wish);
    if (!in) {
        answer_error(OIIO::geterror());
        return in;
    }
    const OIIO::ImageSpec &spec = in->spec();
    if (spec.width < 1 || spec.height < 1 || spec.width > static_cast<int>(kSideMost) ||
        spec.height > static_cast<int>(kSideMost) || spec.depth > 1 || spec.deep ||
        spec.nchannels < 1 || is_no_file(in->format_name())) {
        answer_error("it is " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                     " pixels, deep or of no file; expected a flat image of 1 to 16384 a side");
        in.reset();
    }
    return in;
}

/* The first four channels at most; nothing, and an answer "error", where they cannot be had. */
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

void transmit_notes(const std::vector<Note> &notes)
{
    for (const Note &note : notes)
        transmit(std::to_string(note.name.size()) + " " + std::to_string(note.value.size()) + "\n" +
                 note.name + note.value);
}

std::string receive_path(const std::string &line, size_t at)
{
    return receive_text(take_number(line, at, kPathMost));
}

void read_image(const std::string &line)
{
    std::unique_ptr<OIIO::ImageInput> in = open_image(receive_path(line, 5)); /* past "read " */
    if (!in)
        return;
    const std::vector<uint8_t> pixels = pixels_of(*in);
    if (pixels.empty())
        return;
    const OIIO::ImageSpec &spec = in->spec();
    const std::vector<Note> notes = notes_of(spec);
    transmit("picture " + std::to_string(spec.width) + " " + std::to_string(spec.height) + " " +
             std::to_string(notes.size()) + "\n");
    transmit_notes(notes);
    transmit(pixels.data(), pixels.size());
}

/* "R,G,B", cut where it is too long. */
std::string channels_of(const OIIO::ImageSpec &spec)
{
    std::string names;
    for (int c = 0; c < spec.nchannels; c++)
        names += (c ? "," : "") + std::string(spec.channel_name(c));
    return names.substr(0, kFactMost);
}

void about_image(const std::string &line)
{
    std::unique_ptr<OIIO::ImageInput> in = open_image(receive_path(line, 6)); /* past "about " */
    if (!in || pixels_of(*in).empty())
        return;
    const OIIO::ImageSpec spec = in->spec();
    const std::vector<Note> notes = notes_of(spec);
    const std::string format = in->format_name(), type = spec.format.c_str();
    const std::string channels = channels_of(spec);
    uint64_t frames = 1;
    while (frames < kFramesMost && in->seek_subimage(static_cast<int>(frames), 0))
        frames++;
    transmit("about " + std::to_string(spec.width) + " " + std::to_string(spec.height) + " " +
             std::to_string(frames) + " " + std::to_string(notes.size()) + " " +
             std::to_string(format.size()) + " " + std::to_string(type.size()) + " " +
             std::to_string(channels.size()) + "\n" + format + type + channels);
    transmit_notes(notes);
}

/* ---- */

void prepare_library()
{
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", 1);
    OIIO::attribute("limits:imagesize_MB", 4096);
    OIIO::attribute("limits:channels", 64);
}

/* One request. What is thrown before the first byte of the answer becomes an error; a request must
 * have been received by then, so only libraries may throw. */
void serve()
{
    std::string line = receive_line();
    try {
        if (line.compare(0, 6, "write ") == 0)
            write_image(line);
        else if (line.compare(0, 5, "read ") == 0)
            read_image(line);
        else if (line.compare(0, 6, "about ") == 0)
            about_image(line);
        else
            leave(2);
    } catch (const std::bad_alloc &) {
        leave(3); /* perhaps in the middle of a request: the client sees it from the status */
    } catch (const std::exception &error) {
        answer_error(error.what());
    }
}

} // namespace

int main()
{
    prepare(kMemoryMost);
    prepare_library();
    for (;;)
        serve();
}
