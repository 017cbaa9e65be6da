/* Reading a picture, and what its file is, by OpenImageIO. */
#include "image/image_parts.hh"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include <sys/stat.h>

#include <OpenImageIO/imageio.h>

#include "image/swelling.h"
#include "image/wire.hh"

namespace image
{

using namespace wire;

constexpr size_t fact_most = 4096;

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

/* By the size of its file: a megabyte may hold a gigabyte of pixels. */
bool swells(const std::string &path, const OIIO::ImageSpec &spec)
{
    struct stat status;
    const uint64_t pixels = spec.image_pixels();
    return stat(path.c_str(), &status) != 0 ||
           swelling_needs_yes(4 * pixels, pixels, static_cast<uint64_t>(status.st_size));
}

/* Colours as the file holds them, not multiplied by alpha; an error is answered for what is none,
 * or too large. */
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
    if (spec.width < 1 || spec.height < 1 || spec.width > static_cast<int>(side_most) ||
        spec.height > static_cast<int>(side_most) || spec.depth > 1 || spec.deep ||
        spec.nchannels < 1 || is_no_file(in->format_name())) {
        answer_error("it is " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                     " pixels, deep or of no file; expected a flat image of 1 to 16384 a side");
        in.reset();
    } else if (swells(path, spec)) {
        answer_error("it claims " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                     " pixels; so large a picture takes a byte for "
                     "each " +
                     std::to_string(SWELLING_MOST) + " of them");
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

void read_image(const Request &request)
{
    std::unique_ptr<OIIO::ImageInput> in = open_image(request.path);
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
    return names.substr(0, fact_most);
}

void about_image(const Request &request)
{
    std::unique_ptr<OIIO::ImageInput> in = open_image(request.path);
    if (!in || pixels_of(*in).empty())
        return;
    const OIIO::ImageSpec spec = in->spec();
    const std::vector<Note> notes = notes_of(spec);
    const std::string format = in->format_name(), type = spec.format.c_str();
    const std::string channels = channels_of(spec);
    uint64_t frames = 1;
    while (frames < frames_most && in->seek_subimage(static_cast<int>(frames), 0))
        frames++;
    transmit("about " + std::to_string(spec.width) + " " + std::to_string(spec.height) + " " +
             std::to_string(frames) + " " + std::to_string(notes.size()) + " " +
             std::to_string(format.size()) + " " + std::to_string(type.size()) + " " +
             std::to_string(channels.size()) + "\n" + format + type + channels);
    transmit_notes(notes);
}

} // namespace image
