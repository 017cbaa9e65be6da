/*
 * iftty-image: reads and writes images by OpenImageIO for the program that started it.
 *
 * Requests come on standard input, answers go to standard output; helper.h tells the protocol byte
 * for byte. The end of input, or a request that breaks the protocol, ends the program. Whatever
 * OpenImageIO cannot do is an answer "error". A decoder that crashes takes only this process along.
 */
#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

namespace
{

/* The address sanitiser reserves terabytes, so no limit can be put on it; gcc and clang say
 * differently that it is there. */
#if defined(__SANITIZE_ADDRESS__)
constexpr bool kLimitMemory = false;
#elif defined(__has_feature)
constexpr bool kLimitMemory = !__has_feature(address_sanitizer);
#else
constexpr bool kLimitMemory = true;
#endif

constexpr uint64_t kSideMost = 16384;
constexpr uint64_t kPathMost = 4096;
constexpr uint64_t kNameMost = 4096;
constexpr uint64_t kValueMost = 1 << 20;
constexpr uint64_t kNotesMost = 1024;
constexpr size_t kLineMost = 64;
constexpr size_t kWordsMost = 390;
constexpr rlim_t kMemoryMost = rlim_t{8} << 30;

struct Note {
    std::string name, value;
};

/* ---- bytes ---- */

/* The socket, moved away from standard input and output, where a library may read or print. */
int wire = -1;

[[noreturn]] void leave(int status)
{
    _exit(status); /* no destructors: plugins have been seen to hang in theirs */
}

void hear(void *bytes, size_t length)
{
    auto *at = static_cast<char *>(bytes);
    while (length > 0) {
        ssize_t n = read(wire, at, length);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            leave(0);
        at += n;
        length -= static_cast<size_t>(n);
    }
}

void tell(const void *bytes, size_t length)
{
    auto *at = static_cast<const char *>(bytes);
    while (length > 0) {
        ssize_t n = write(wire, at, length);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            leave(0);
        at += n;
        length -= static_cast<size_t>(n);
    }
}

void tell(const std::string &text)
{
    tell(text.data(), text.size());
}

std::string hear_line()
{
    std::string line;
    for (char c = 0;;) {
        hear(&c, 1);
        if (c == '\n')
            return line;
        line += c;
        if (line.size() > kLineMost)
            leave(2);
    }
}

std::string hear_text(uint64_t length)
{
    std::string text(length, '\0');
    hear(&text[0], length);
    return text;
}

/* The next number of `line`, which begins at `at`; moves `at` past it and a blank. */
uint64_t take_number(const std::string &line, size_t &at, uint64_t most)
{
    uint64_t value = 0;
    size_t from = at;
    for (; at < line.size() && line[at] >= '0' && line[at] <= '9'; at++) {
        value = 10 * value + static_cast<uint64_t>(line[at] - '0');
        if (value > most)
            leave(2);
    }
    if (at == from)
        leave(2);
    if (at < line.size() && line[at++] != ' ')
        leave(2);
    return value;
}

std::vector<Note> hear_notes(uint64_t count)
{
    std::vector<Note> notes;
    for (uint64_t i = 0; i < count; i++) {
        std::string line = hear_line();
        size_t at = 0;
        uint64_t name = take_number(line, at, kNameMost);
        uint64_t value = take_number(line, at, kValueMost);
        Note note;
        note.name = hear_text(name);
        note.value = hear_text(value);
        notes.push_back(std::move(note));
    }
    return notes;
}

/* An answer "error": one line, of what fits the client's. */
void tell_error(std::string words)
{
    std::replace(words.begin(), words.end(), '\n', ' ');
    if (words.empty())
        words = "OpenImageIO gives no reason";
    words.resize(std::min(words.size(), kWordsMost));
    tell("error " + std::to_string(words.size()) + "\n" + words);
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

/* Notes as the format keeps them; nothing that differs from one run to the next. */
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

void write_image(const std::string &line)
{
    size_t at = 6; /* past "write " */
    uint64_t length = take_number(line, at, kPathMost);
    uint64_t width = take_number(line, at, kSideMost);
    uint64_t height = take_number(line, at, kSideMost);
    uint64_t count = take_number(line, at, kNotesMost);
    if (width == 0 || height == 0)
        leave(2);
    std::string path = hear_text(length);
    std::vector<Note> notes = hear_notes(count);
    std::vector<uint8_t> pixels(3 * width * height);
    hear(pixels.data(), pixels.size());

    std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    if (!out || is_no_file(out->format_name())) {
        OIIO::geterror();
        tell_error("no known format writes " + extension_of(path) +
                   "; expected for instance .png, .exr, .tif or .jpg");
        return;
    }
    std::string format = out->format_name();
    OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeUInt8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (format == "jpeg")
        spec.attribute("Compression", "jpeg:95");
    if (format == "webp")
        spec.attribute("Compression", "lossless");
    /* These two put the time of writing in where none is given. PNG leaves out what is no time;
     * TIFF, which would keep even that, gets the beginning of all of them. */
    if (format == "png")
        spec.attribute("DateTime", "none");
    if (format == "tiff")
        spec.attribute("DateTime", "1970:01:01 00:00:00");
    add_notes(spec, format, notes);
    /* The library does not look at what closing a file says, and so would not see that the disk was
     * full; where it lets us hold the file, we look. (Its TIFF writer reports the failure by itself, and
     * loses its directory when held.) */
    std::unique_ptr<OIIO::Filesystem::IOFile> file;
    if (format != "tiff" && out->supports("ioproxy")) {
        file = std::make_unique<OIIO::Filesystem::IOFile>(path,
                                                          OIIO::Filesystem::IOProxy::Write);
        out->set_ioproxy(file.get());
    }
    bool fine = out->open(path, spec) && out->write_image(OIIO::TypeUInt8, pixels.data());
    std::string words = fine ? std::string() : out->geterror();
    if (!out->close() && fine) {
        fine = false;
        words = out->geterror();
    }
    if (fine && file && (std::fflush(file->handle()) != 0 || std::ferror(file->handle()))) {
        fine = false;
        words = std::strerror(errno);
    }
    if (fine)
        tell("ok\n");
    else
        tell_error(words);
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

void read_image(const std::string &line)
{
    size_t at = 5; /* past "read " */
    std::string path = hear_text(take_number(line, at, kPathMost));
    OIIO::ImageSpec wish; /* colours as the file holds them, not multiplied by alpha */
    wish.attribute("oiio:UnassociatedAlpha", 1);
    std::unique_ptr<OIIO::ImageInput> in = OIIO::ImageInput::open(path, &wish);
    if (!in) {
        tell_error(OIIO::geterror());
        return;
    }
    const OIIO::ImageSpec &spec = in->spec();
    if (spec.width < 1 || spec.height < 1 || spec.width > static_cast<int>(kSideMost) ||
        spec.height > static_cast<int>(kSideMost) || spec.depth > 1 || spec.deep ||
        spec.nchannels < 1 || is_no_file(in->format_name())) {
        tell_error("it is " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                   " pixels, deep or of no file; expected a flat image of 1 to 16384 a side");
        return;
    }
    size_t count = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
    int channels = std::min(spec.nchannels, 4);
    std::vector<uint8_t> pixels(4 * count);
    if (!in->read_image(0, 0, 0, channels, OIIO::TypeUInt8, pixels.data())) {
        tell_error(in->geterror());
        return;
    }
    widen(pixels, static_cast<size_t>(channels), count);
    std::vector<Note> notes = notes_of(spec);
    tell("picture " + std::to_string(spec.width) + " " + std::to_string(spec.height) + " " +
         std::to_string(notes.size()) + "\n");
    for (const Note &note : notes)
        tell(std::to_string(note.name.size()) + " " + std::to_string(note.value.size()) + "\n" +
             note.name + note.value);
    tell(pixels.data(), pixels.size());
}

/* ---- */

void prepare()
{
    wire = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3);
    int nowhere = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (wire < 0 || nowhere < 0 || dup2(nowhere, STDIN_FILENO) < 0 ||
        dup2(nowhere, STDOUT_FILENO) < 0)
        leave(3);
    struct rlimit memory = {kMemoryMost, kMemoryMost};
    if (kLimitMemory)
        setrlimit(RLIMIT_AS, &memory);
    struct rlimit core = {0, 0};
    setrlimit(RLIMIT_CORE, &core);
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", 1);
    OIIO::attribute("limits:imagesize_MB", 4096);
    OIIO::attribute("limits:channels", 64);
}

/* One request. What is thrown before the first byte of the answer becomes an error; a request must
 * have been heard out by then, so only libraries may throw. */
void serve()
{
    std::string line = hear_line();
    try {
        if (line.compare(0, 6, "write ") == 0)
            write_image(line);
        else if (line.compare(0, 5, "read ") == 0)
            read_image(line);
        else
            leave(2);
    } catch (const std::bad_alloc &) {
        leave(3); /* perhaps in the middle of a request: the client tells it from the status */
    } catch (const std::exception &error) {
        tell_error(error.what());
    }
}

} // namespace

int main()
{
    prepare();
    for (;;)
        serve();
}
