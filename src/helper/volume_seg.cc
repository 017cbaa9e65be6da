/* SPDX-License-Identifier: MIT */
/*
 * DICOM SEG: read segments as a map of their numbers.
 *
 * A frame holds one segment in one plane (BINARY, FRACTIONAL), or the numbers of all segments in it
 * (LABELMAP). Its own groups say which segment and where; their order means nothing. Planes without
 * a frame are blank. Where segments overlap, the one with the highest number is in the map, and
 * these voxels are counted.
 *
 * The distance of the planes is SpacingBetweenSlices; if that does not fit the frames, that of the
 * scene (Request.step_nm), the least one, or SliceThickness. Frames of 1 bit follow each other
 * without padding, and the lowest bit comes first.
 */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <istream>

#include <gdcmDataSet.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>

namespace volume
{

constexpr double off_most = 0.1;   /* distance of a frame from the grid, in voxels */
constexpr double place_most = 1e6; /* mm */
constexpr uint64_t planes_most = 65534;
constexpr size_t label_most = 256;

static const gdcm::Tag class_tag(0x0008, 0x0016), charset_tag(0x0008, 0x0005),
    shared_tag(0x5200, 0x9229), each_tag(0x5200, 0x9230), segments_tag(0x0062, 0x0002),
    number_tag(0x0062, 0x0004), label_tag(0x0062, 0x0005), description_tag(0x0062, 0x0006),
    colour_tag(0x0062, 0x000d), identity_tag(0x0062, 0x000a), referenced_tag(0x0062, 0x000b),
    category_tag(0x0062, 0x0003), property_tag(0x0062, 0x000f), modifier_tag(0x0062, 0x0011),
    region_tag(0x0008, 0x2218), type_tag(0x0062, 0x0001), most_tag(0x0062, 0x000e),
    pixels_tag(0x7fe0, 0x0010);

struct Frame {
    uint64_t plane;
    unsigned number; /* its label; 0 in a LABELMAP, and if it is not chosen */
    uint64_t at;     /* in the file */
};

struct Segments {
    Slice whole; /* size, pixels and place of all frames */
    std::vector<Frame> frames;
    std::map<unsigned, uint32_t> numbers; /* the label of each segment */
    std::unique_ptr<std::istream> in;
    std::vector<char> unpacked; /* all frames, if they are packed; */
    std::vector<char> bytes;    /* otherwise those of one */
    uint64_t least = 1;         /* pixels of this value and above are in the segment */
    bool is_map = false;        /* LABELMAP */
    std::vector<uint32_t> plane;
    std::vector<bool> is_twice;
    uint64_t overlaps = 0;
};

/* ---- names and colours ---- */

/* Convert Latin 1 to UTF-8; "?" for other character sets. */
std::string in_utf8(const std::string &text, const std::string &charset)
{
    std::string out;
    if (charset.find("192") != std::string::npos)
        return text;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80)
            out += c;
        else if (charset == "ISO_IR 100")
            out += {static_cast<char>(0xc0 | byte >> 6), static_cast<char>(0x80 | (byte & 0x3f))};
        else
            out += '?';
    }
    return out;
}

/* Convert a colour of CIELab, relative to D50, to sRGB, as " R G B 1 1 1"; "" for none. */
static std::string colour_of(const gdcm::DataSet &segment)
{
    /* XYZ of D50 to linear sRGB, by Bradford's adaptation to D65 */
    static const double matrix[3][3] = {{3.1338561, -1.6168667, -0.4906146},
                                        {-0.9787684, 1.9161415, 0.0334540},
                                        {0.0719453, -0.2289914, 1.4052427}};
    static const double white[3] = {0.9642, 1.0, 0.8251};
    uint16_t lab[3];
    std::string words;
    if (!take_bytes(lab, sizeof lab, segment, colour_tag))
        return "";
    const double l = (lab[0] / 655.35 + 16) / 116, a = lab[1] / 257.0 - 128,
                 b = lab[2] / 257.0 - 128, f[3] = {l + a / 500, l, l - b / 200};
    double xyz[3];
    for (int i = 0; i < 3; i++)
        xyz[i] = white[i] * (f[i] > 6 / 29.0 ? f[i] * f[i] * f[i]
                                             : 3 * (6 / 29.0) * (6 / 29.0) * (f[i] - 4 / 29.0));
    for (const auto &row : matrix) {
        const double linear = row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2];
        const double value =
            linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
        words += " " + std::to_string(std::lround(255 * std::clamp(value, 0.0, 1.0)));
    }
    return words + " 1 1 1";
}

/* Text of an element in UTF-8, on one line. */
static std::string line_of(const gdcm::DataSet &set, const gdcm::Tag &tag,
                           const std::string &charset)
{
    std::string line = in_utf8(text_of(set, tag), charset);
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
    return line;
}

/* Read the cells of a segment's code (show/label_table.h). Without a scheme or a value, or with a
 * colon in them, it begins with a colon, and is no code. */
static std::string code_of(const gdcm::DataSet &segment, const std::string &charset)
{
    const gdcm::DataSet type = item_of(segment, property_tag, 0);
    const std::string scheme = line_of(type, gdcm::Tag(0x0008, 0x0102), charset),
                      value = line_of(type, gdcm::Tag(0x0008, 0x0100), charset),
                      meaning = line_of(type, gdcm::Tag(0x0008, 0x0104), charset);
    const bool is_code =
        !scheme.empty() && !value.empty() && (scheme + value).find(':') == std::string::npos;
    return "\t" +
           (is_code                ? scheme + ":" + value
            : scheme + value == "" ? ""
                                   : ":") +
           (meaning.empty() ? "" : ":" + meaning) + "\t" +
           line_of(item_of(segment, category_tag, 0), gdcm::Tag(0x0008, 0x0100), charset) +
           (type.FindDataElement(modifier_tag) || segment.FindDataElement(region_tag) ? "\tm" : "");
}

/* Read the segments: their numbers, and lines of names. In our files, a description "label N" is
 * the number of a label that has another one than its segment. */
static void take_segments(Segments &segments, Volume &volume, const gdcm::DataSet &set)
{
    const std::string charset = text_of(set, charset_tag);
    const bool is_ours = text_of(set, gdcm::Tag(0x0008, 0x0070)) == "iftty";
    gdcm::SmartPointer<gdcm::SequenceOfItems> items;
    if (set.FindDataElement(segments_tag))
        items = set.GetDataElement(segments_tag).GetValueAsSQ();
    for (size_t i = 1; items && i <= items->GetNumberOfItems(); i++) {
        const gdcm::DataSet &segment = items->GetItem(i).GetNestedDataSet();
        unsigned number = 0;
        take_binary(number, segment, number_tag);
        const std::string description = text_of(segment, description_tag);
        std::string label = line_of(segment, label_tag, charset);
        uint32_t of = number;
        if (is_ours && description.compare(0, 6, "label ") == 0 && description.size() <= 16 &&
            description.find_first_not_of("0123456789", 6) == std::string::npos) {
            const unsigned long said = std::strtoul(description.c_str() + 6, nullptr, 10);
            of = said > 0 && said <= UINT32_MAX ? static_cast<uint32_t>(said) : of;
        }
        if (number == 0 && segments.is_map)
            continue; /* the background */
        if (number == 0 || number > UINT16_MAX || !segments.numbers.emplace(number, of).second)
            refuse("its segments are not numbered from 1, each by its own number");
        label.resize(std::min(label.size(), label_most));
        if (label == "label " + std::to_string(of))
            label.clear();
        label += code_of(segment, charset);
        std::string quoted;
        for (const char c : label)
            quoted += c == '"' ? std::string("\\\"") : std::string(1, c);
        volume.names += std::to_string(of) + colour_of(segment) + " \"" + quoted + "\"\n";
    }
    if (segments.numbers.empty())
        refuse("a segmentation (DICOM SEG) without segments");
}

/* ---- frames ---- */

/* Read the place and the segment of a frame, or of all frames. */
static void take_groups(Slice &slice, unsigned &number, const gdcm::DataSet &group)
{
    for (const gdcm::Tag &tag :
         {gdcm::Tag(0x0020, 0x9113), gdcm::Tag(0x0020, 0x9116), gdcm::Tag(0x0028, 0x9110)})
        take_place(slice, item_of(group, tag, 0));
    if (!item_of(group, identity_tag, 1).IsEmpty())
        refuse("damaged: a frame is of several segments; expected one segment for each frame");
    take_binary(number, item_of(group, identity_tag, 0), referenced_tag);
}

/* Find the distance of planes at these sorted places along their normal: the first candidate that
 * divides all distances; or 0. */
static double step_of(const std::vector<double> &along, const Slice &whole, uint32_t step_nm)
{
    double least = 0;
    for (size_t i = 1; i < along.size(); i++)
        least = least > 0 ? std::min(least, along[i] - along[i - 1]) : along[i] - along[i - 1];
    for (const double step : {whole.between, step_nm / 1e6, least, whole.thickness}) {
        bool fits = step > 0;
        for (size_t i = 1; fits && i < along.size(); i++) {
            const double steps = (along[i] - along[0]) / step;
            fits = steps < planes_most && std::fabs(steps - std::round(steps)) <= off_most &&
                   std::round(steps) > std::round((along[i - 1] - along[0]) / step);
        }
        if (fits)
            return step;
    }
    return 0;
}

/* Place the frames, whose slices have their positions: set their planes, and the matrix. */
static void place_frames(Segments &segments, Volume &volume, const std::vector<Slice> &slice,
                         uint32_t step_nm)
{
    const Slice &whole = segments.whole;
    double normal[3];
    std::vector<double> place, along;
    normal_of(normal, whole.axis);
    for (const Slice &s : slice)
        place.push_back(s.position[0] * normal[0] + s.position[1] * normal[1] +
                        s.position[2] * normal[2]);
    along = place;
    std::sort(along.begin(), along.end());
    const double same = off_most * (whole.between > 0     ? whole.between
                                    : whole.thickness > 0 ? whole.thickness
                                                          : 1);
    along.erase(std::unique(along.begin(), along.end(),
                            [same](double a, double b) { return b - a <= same; }),
                along.end());
    const double step = step_of(along, whole, step_nm);
    if (step <= 0 && along.size() > 1)
        refuse("its frames are not evenly spaced, or too far apart for a volume");
    const auto first = static_cast<size_t>(std::min_element(place.begin(), place.end()) -
                                           place.begin()),
               last = static_cast<size_t>(std::max_element(place.begin(), place.end()) -
                                          place.begin());
    const double mm = step > 0 ? step : 1, steps = std::round((place[last] - place[first]) / mm);
    std::vector<Slice> ends(steps > 0 ? 2 : 1, slice[first]);
    ends.back() = slice[last];
    ends[0].between = mm;
    place_series(volume, ends);
    for (auto &row : volume.to_mm)
        row[2] /= std::max(steps, 1.0);
    for (size_t f = 0; f < slice.size(); f++) {
        const double plane = std::round((place[f] - place[first]) / mm);
        double apart = 0;
        for (int w = 0; w < 3; w++) {
            const double on_grid = volume.to_mm[w][3] + plane * volume.to_mm[w][2];
            apart = std::max(apart, std::fabs(slice[f].position[w] - (w < 2 ? -1 : 1) * on_grid));
        }
        if (!(apart <= off_most * std::min({whole.spacing[0], whole.spacing[1], mm})))
            refuse("its frames are not on one grid: frame %zu is up to %.3g mm off that of the "
                   "others",
                   f + 1, apart);
        segments.frames[f].plane = static_cast<uint64_t>(plane);
    }
    volume.size[2] = static_cast<uint64_t>(steps) + 1;
    volume.known = ORIENTATION | CLOSELY_PACKED | (step > 0 ? SPACING : 0u);
}

/* True for a number in a list, "3,5-7", or without a list. */
static bool is_listed(const std::string &list, uint32_t number)
{
    bool is_in = list.empty();
    char *end;
    for (const char *at = list.c_str(); *at; at = *end ? end + 1 : end) {
        const unsigned long first = std::strtoul(at, &end, 10),
                            last = *end == '-' ? std::strtoul(end + 1, &end, 10) : first;
        is_in |= number >= first && number <= last;
    }
    return is_in;
}

/* Read the groups of each frame. */
static void take_frames(Segments &segments, Volume &volume, const gdcm::DataSet &set,
                        const Request &request)
{
    Slice &whole = segments.whole;
    gdcm::SmartPointer<gdcm::SequenceOfItems> items;
    double frames = 0;
    std::vector<Slice> slice;
    if (set.FindDataElement(each_tag))
        items = set.GetDataElement(each_tag).GetValueAsSQ();
    const size_t count = items ? items->GetNumberOfItems() : 0;
    if (decimals_of(whole.fault, set, gdcm::Tag(0x0028, 0x0008), &frames, 1) != 1 || count == 0 ||
        frames != static_cast<double>(count))
        refuse("damaged: it says that it has %.0f frames, and describes %zu", frames, count);
    const gdcm::DataSet shared = item_of(set, shared_tag, 0);
    unsigned common = 0;
    take_groups(whole, common, shared);
    whole.frames = static_cast<unsigned>(count);
    for (size_t f = 0; f < count; f++) {
        const gdcm::DataSet &group = items->GetItem(f + 1).GetNestedDataSet();
        Slice own = whole;
        unsigned number = common;
        take_groups(own, number, group);
        if (!own.fault.empty())
            throw Refusal{own.fault};
        const auto of = segments.numbers.find(number);
        if (!segments.is_map && of == segments.numbers.end())
            refuse("damaged: frame %zu is of segment %u, which it does not describe", f + 1,
                   number);
        if (!own.has_position || !own.has_axes || own.spacing[0] <= 0)
            refuse("frame %zu of its segments holds no place in the patient, or no spacing", f + 1);
        for (const double mm : own.position)
            if (std::fabs(mm) > place_most)
                refuse("frame %zu of its segments is more than a kilometre away", f + 1);
        for (int i = 0; i < 6 && f > 0; i++)
            if (std::fabs(own.axis[i] - slice[0].axis[i]) > 1e-3 ||
                std::fabs(own.spacing[i % 2] - slice[0].spacing[i % 2]) > 1e-3 * own.spacing[i % 2])
                refuse("frame %zu of its segments has other axes or another spacing than the first",
                       f + 1);
        const bool is_chosen = !segments.is_map && is_listed(request.segments, of->second);
        segments.frames.push_back({0, is_chosen ? of->second : 0, f});
        slice.push_back(own);
    }
    whole = slice[0];
    place_frames(segments, volume, slice, static_cast<uint32_t>(request.step_nm));
    std::stable_sort(segments.frames.begin(), segments.frames.end(),
                     [](const Frame &a, const Frame &b) {
                         return a.plane != b.plane ? a.plane < b.plane : a.number < b.number;
                     });
    for (size_t f = 1; f < count; f++) {
        const Frame &a = segments.frames[f - 1], &b = segments.frames[f];
        if (a.plane == b.plane && a.number == b.number && (a.number || segments.is_map))
            refuse("frames %llu and %llu hold the same segment in one plane, as of several times; "
                   "expected one frame",
                   wide(a.at + 1), wide(b.at + 1));
    }
}

/* ---- pixels ---- */

/* Read a frame; `shift` is the first bit of its first byte. */
static const char *read_frame(Segments &segments, uint64_t frame, unsigned &shift)
{
    const Slice &whole = segments.whole;
    const uint64_t bits = uint64_t{whole.columns} * whole.rows * whole.bits, from = bits * frame;
    shift = static_cast<unsigned>(from % 8);
    if (whole.is_packed)
        return segments.unpacked.data() + from / 8;
    segments.bytes.resize((bits + shift + 7) / 8);
    segments.in->clear();
    segments.in->seekg(static_cast<std::streamoff>(whole.pixels_at + from / 8));
    segments.in->read(segments.bytes.data(), static_cast<std::streamsize>(segments.bytes.size()));
    if (static_cast<size_t>(segments.in->gcount()) < segments.bytes.size())
        refuse("cut short: frame %llu of its segments is missing", wide(frame + 1));
    if (whole.bits == 16 && is_big_machine)
        reverse_each(segments.bytes, 2);
    return segments.bytes.data();
}

static void put(Segments &segments, size_t at, uint32_t number)
{
    uint32_t &held = segments.plane[at];
    if (number && held && held != number && !segments.is_twice[at]) {
        segments.overlaps++;
        segments.is_twice[at] = true;
    }
    held = number ? number : held;
}

/* Add a frame to the plane. */
static void add_frame(Segments &segments, const Frame &frame)
{
    const size_t pixels = segments.plane.size();
    unsigned shift;
    if (!frame.number && !segments.is_map)
        return;
    const char *bytes = read_frame(segments, frame.at, shift);
    if (segments.whole.bits == 1) {
        for (size_t at = 0; at < pixels;) {
            const size_t bit = at + shift;
            const auto byte = static_cast<unsigned char>(bytes[bit / 8]);
            if (byte == 0) {
                at += 8 - bit % 8;
                continue;
            }
            if (byte >> bit % 8 & 1)
                put(segments, at, frame.number);
            at++;
        }
        return;
    }
    for (size_t at = 0; at < pixels; at++) {
        const unsigned value = segments.whole.bits == 16 ? load<uint16_t>(bytes + 2 * at)
                                                         : static_cast<unsigned char>(bytes[at]);
        if (!segments.is_map && value >= segments.least)
            put(segments, at, frame.number);
        if (!segments.is_map || value == 0)
            continue;
        const auto of = segments.numbers.find(value);
        if (of == segments.numbers.end())
            refuse("damaged: a voxel is of segment %u, which it does not describe", value);
        put(segments, at, of->second);
    }
}

/* Make each plane, and send it, or only count its overlaps. */
static void make_planes(Segments &segments, const Volume &volume, bool sends)
{
    const size_t width = bytes_of(volume.type);
    segments.overlaps = 0;
    auto frame = segments.frames.begin();
    std::vector<char> out(segments.plane.size() * width);
    for (uint64_t z = 0; z < (sends ? volume.size[2] : UINT64_MAX); z++) {
        if (!sends && frame == segments.frames.end())
            return;
        std::fill(segments.plane.begin(), segments.plane.end(), 0);
        std::fill(segments.is_twice.begin(), segments.is_twice.end(), false);
        z = sends ? z : frame->plane;
        for (; frame != segments.frames.end() && frame->plane == z; ++frame)
            add_frame(segments, *frame);
        for (size_t i = 0; sends && i < segments.plane.size(); i++) {
            const uint32_t number = segments.plane[i];
            const auto byte = static_cast<uint8_t>(number);
            std::memcpy(&out[width * i], width == 1 ? static_cast<const void *>(&byte) : &number,
                        width);
        }
        if (sends)
            send_piece(out.data(), out.size());
    }
}

/* ---- references to a series ---- */

std::string references_of(const std::vector<Slice> &slices, bool identifies)
{
    static const gdcm::Tag class_and_instance[] = {class_tag, gdcm::Tag(0x0008, 0x0018)};
    static const std::vector<gdcm::Tag> uids = {
        {0x0020, 0x000d}, {0x0020, 0x000e}, {0x0020, 0x0052}};
    static const std::vector<gdcm::Tag> identity = {
        {0x0008, 0x0020}, {0x0008, 0x0030}, {0x0008, 0x0050}, {0x0008, 0x0090}, {0x0010, 0x0010},
        {0x0010, 0x0020}, {0x0010, 0x0030}, {0x0010, 0x0040}, {0x0020, 0x0010}};
    std::string lines, path, words;
    for (const Slice &slice : slices) {
        if (slice.frame == blank) {
            lines += "slice   0\n";
            continue;
        }
        if (slice.path != path) {
            const auto in = open_bytes(slice.path);
            gdcm::Reader reader;
            if (in)
                reader.SetStream(*in);
            if (!in || !reader.ReadUpToTag(gdcm::Tag(0x0020, 0x0052), {}))
                refuse("a slice whose header is damaged");
            const gdcm::DataSet &set = reader.GetFile().GetDataSet();
            const std::string charset = text_of(set, charset_tag);
            std::vector<gdcm::Tag> tags(path.empty() ? uids : std::vector<gdcm::Tag>());
            if (path.empty() && identifies)
                tags.insert(tags.end(), identity.begin(), identity.end());
            for (const gdcm::Tag &tag : tags) {
                const std::string value = in_utf8(text_of(set, tag), charset);
                lines += words_of("%04x%04x ", tag.GetGroup(), tag.GetElement()) +
                         value.substr(0, label_most / 2) + "\n";
            }
            words = "slice";
            for (const gdcm::Tag &tag : class_and_instance) {
                const std::string uid = text_of(set, tag);
                if (uid.empty() || uid.size() > 64 ||
                    uid.find_first_not_of("0123456789.") != std::string::npos)
                    refuse("a slice without a valid SOPInstanceUID, to which nothing can refer");
                words += " " + uid;
            }
            path = slice.path;
        }
        const bool is_frame = slice.frames > 1 && slice.tiles == 1;
        lines += words + " " + std::to_string(is_frame ? slice.frame + 1 : 0) + "\n";
    }
    return lines;
}

/* ---- the file ---- */

/* Check the type of segmentation, and its pixels. */
static void take_type(Segments &segments, const gdcm::DataSet &set, const Request &request)
{
    const std::string type = text_of(set, type_tag);
    Slice &whole = segments.whole;
    unsigned most = 0;
    take_binary(most, set, most_tag);
    const bool is_fractional = type == "FRACTIONAL";
    segments.is_map = type == "LABELMAP";
    take_pixels(whole, set);
    if (whole.rows == 0 || whole.columns == 0 || whole.samples != 1 || whole.is_signed ||
        !(type == "BINARY"  ? whole.bits == 1
          : is_fractional   ? whole.bits == 8 && most > 0
          : segments.is_map ? whole.bits == 8 || whole.bits == 16
                            : false))
        refuse("a segmentation (DICOM SEG) whose pixels are not those of a binary, fractional or "
               "label map one");
    if (is_fractional && !request.threshold)
        refuse("a segmentation (DICOM SEG) of fractions, 0 to 1; `labels FILE threshold=0.5` uses "
               "the voxels of at least 0.5");
    if (!is_fractional && request.threshold)
        refuse("threshold= is for fractional segments, and these are %s: leave it out",
               segments.is_map ? "a label map" : "binary");
    segments.least = is_fractional ? (request.threshold * uint64_t{most} + 999) / 1000 : 1;
}

bool open_segments(Volume &volume, const Request &request)
{
    const auto segments = std::make_shared<Segments>();
    segments->in = open_bytes(request.path);
    gdcm::Reader reader;
    if (!segments->in)
        return false;
    reader.SetStream(*segments->in);
    if (!reader.ReadUpToTag(gdcm::Tag(0x0008, 0x0018), {}))
        return false;
    const std::string kind = text_of(reader.GetFile().GetDataSet(), class_tag);
    if (kind != "1.2.840.10008.5.1.4.1.1.66.4" && kind != "1.2.840.10008.5.1.4.1.1.66.7")
        return false;
    segments->in = open_bytes(request.path);
    gdcm::Reader whole;
    whole.SetStream(*segments->in);
    if (!whole.ReadUpToTag(pixels_tag, {pixels_tag}))
        refuse("a segmentation (DICOM SEG) whose header is damaged");
    const gdcm::DataSet &set = whole.GetFile().GetDataSet();
    segments->whole.path = request.path;
    take_type(*segments, set, request);
    take_segments(*segments, volume, set);
    take_frames(*segments, volume, set, request);
    find_pixels(segments->whole, *segments->in,
                whole.GetFile().GetHeader().GetDataSetTransferSyntax());
    Slice &pixels = segments->whole;
    if (!pixels.lack.empty())
        throw Refusal{about_file("", pixels.lack)};
    if (pixels.rest)
        refuse("a segmentation (DICOM SEG) with %llu bytes more than its frames of %ux%u have",
               wide(pixels.rest), pixels.columns, pixels.rows);
    if (pixels.is_big || (pixels.is_packed && pixels.bits == 1))
        refuse("a segmentation (DICOM SEG) whose pixels are packed or big-endian; `dcmconv +te "
               "FILE PLAIN` or gdcmconv --raw makes them plain");
    if (pixels.is_packed && !read_pixels(segments->unpacked, pixels))
        refuse("a segmentation (DICOM SEG) whose pixels cannot be unpacked");
    uint32_t most = 0;
    for (const auto &number : segments->numbers)
        most = std::max(most, number.second);
    volume.type = most <= UINT8_MAX ? "uint8" : "uint32";
    volume.format = "DICOM SEG";
    volume.is_segments = true;
    volume.size[0] = pixels.columns;
    volume.size[1] = pixels.rows;
    segments->plane.resize(size_t{pixels.columns} * pixels.rows);
    segments->is_twice.resize(segments->plane.size());
    make_planes(*segments, volume, false);
    volume.overlaps = segments->overlaps;
    volume.send = [&volume, segments]() { make_planes(*segments, volume, true); };
    return true;
}

} // namespace volume
