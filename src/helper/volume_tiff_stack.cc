/* SPDX-License-Identifier: MIT */
/* TIFF: assign pages to slices and volumes, by the descriptions that programs write. */
#include "helper/volume_tiff.hh"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <new>

#include <expat.h>

#include "helper/volume_parts.hh"

extern "C" {
#include "image/reader_common.h"
}

namespace volume
{

constexpr uint64_t planes_most = 1000000;
constexpr size_t none = SIZE_MAX;
/* Before the sides of a shape, by tifffile; before 2017 (2, 5, 7, 11). */
constexpr char shape_name[] = "\"shape\": [", old_shape_name[] = "shape=(";

/* ---- axes ---- */

uint64_t planes_in(const std::vector<TiffAxis> &axes)
{
    uint64_t planes = 1;
    for (const TiffAxis &axis : axes)
        planes = product_of(planes, axis.size);
    return planes;
}

/* Arrange consecutive planes along the axes, the fastest first: planes[i] is the page of plane i.
 * Channels are the fastest axis of volumes. */
void arrange(TiffStack &stack, const std::vector<TiffAxis> &axes, const std::vector<size_t> &planes)
{
    std::vector<TiffAxis> along;    /* axes of volumes */
    std::vector<uint64_t> step;     /* in planes */
    uint64_t stride = 1, slice = 0; /* from slice to slice */
    stack.slices = 1;
    for (const TiffAxis &axis : axes) {
        const auto at = axis.letter == 'C' ? 0 : static_cast<std::ptrdiff_t>(along.size());
        if (axis.letter == 'Z') {
            stack.slices = axis.size;
            slice = stride;
        } else {
            along.insert(along.begin() + at, axis);
            step.insert(step.begin() + at, stride);
        }
        stride *= axis.size;
    }
    stack.axes = along;
    stack.volumes = planes.size() / stack.slices;
    for (uint64_t v = 0; v < stack.volumes; v++) {
        uint64_t first = 0, rest = v;
        for (size_t a = 0; a < along.size(); rest /= along[a++].size)
            first += rest % along[a].size * step[a];
        for (uint64_t z = 0; z < stack.slices; z++)
            stack.page.push_back(planes[first + z * slice]);
    }
}

std::vector<size_t> images_of(const std::vector<TiffPage> &page)
{
    std::vector<size_t> images;
    for (size_t i = 0; i < page.size(); i++)
        if (!page[i].is_reduced && !page[i].is_mask)
            images.push_back(i);
    return images;
}

/* Pages for `planes`: one for each, or contiguous planes after the only page. Empty if the number
 * of pages differs. */
std::vector<size_t> pages_for(TiffStack &stack, const std::vector<TiffPage> &page, uint64_t planes)
{
    std::vector<size_t> images = images_of(page);
    if (images.size() == planes)
        return images;
    if (images.size() != 1 || planes > planes_most || page[images[0]].samples != 1)
        return {};
    stack.is_run = true;
    images.resize(planes);
    for (size_t i = 0; i < planes; i++)
        images[i] = i;
    return images;
}

/* ---- ImageJ ---- */

/* Value of "name=" at the begin of a line; "" for none. */
std::string value_in(const std::string &lines, const std::string &name)
{
    const std::string text = "\n" + lines, key = "\n" + name + "=";
    const size_t at = text.find(key);
    if (at == std::string::npos)
        return "";
    const size_t from = at + key.size(), to = text.find_first_of("\r\n", from);
    return text.substr(from, to == std::string::npos ? to : to - from);
}

uint64_t count_in(const std::string &lines, const std::string &name, uint64_t usual)
{
    const std::string value = value_in(lines, name);
    char *end;
    if (value.empty())
        return usual;
    const unsigned long long count = std::strtoull(value.c_str(), &end, 10);
    if (*end || value[0] == '-' || count < 1)
        refuse("its ImageJ description has %s=%s; expected a number", name.c_str(),
               printable(value, 20).c_str());
    return count;
}

void arrange_imagej(TiffStack &stack, const std::vector<TiffPage> &page, const std::string &text)
{
    const size_t pages = images_of(page).size();
    const uint64_t channels = count_in(text, "channels", 1), frames = count_in(text, "frames", 1);
    const uint64_t images = count_in(text, "images", pages);
    uint64_t slices = count_in(text, "slices", 1);
    if (slices == 1 && channels == 1 && frames == 1)
        slices = images; /* a plain stack */
    const std::vector<TiffAxis> axes = {{'C', channels}, {'Z', slices}, {'T', frames}};
    std::vector<size_t> planes;
    if (planes_in(axes) == images)
        planes = pages_for(stack, page, images);
    if (planes.empty())
        refuse("its ImageJ description says images=%llu, of %llu channels, %llu slices and %llu "
               "frames, and it has %s; in a copy, `tiffset -u 270 COPY` removes the description: "
               "then each page is a slice",
               wide(images), wide(channels), wide(slices), wide(frames),
               plural_of(pages, "page").c_str());
    arrange(stack, axes, planes);
    stack.by = "its ImageJ description";
    if (!value_in(text, "unit").empty()) /* otherwise the unit of the resolution */
        stack.unit = value_in(text, "unit");
    stack.step[2] = std::strtod(value_in(text, "spacing").c_str(), nullptr);
}

/* ---- tifffile ---- */

/* {"shape": [2, 5, 7, 11], "axes": "CZYX"}; the last sides are of a page. A file written in several
 * parts has a description of each, so it counts only if it covers all pages. */
void arrange_shaped(TiffStack &stack, const std::vector<TiffPage> &page, const std::string &text)
{
    static const char names[] = "\"axes\": \"";
    std::vector<uint64_t> side;
    const size_t samples = page[0].samples > 1;
    const bool is_old = text[0] != '{';
    const char *const name = is_old ? old_shape_name : shape_name;
    const char close = is_old ? ')' : ']';
    const char *at = text.c_str() + text.find(name) + std::strlen(name);
    for (char *end; side.size() < 32; at = end + (*end == ',')) {
        side.push_back(std::strtoull(at, &end, 10));
        if (end == at || (*end != ',' && *end != close))
            return;
        if (*end == close)
            break;
    }
    if (side.size() < 2 + samples)
        return;
    std::string letters;
    const size_t named = text.find(names);
    if (named != std::string::npos)
        letters = text.substr(named + std::strlen(names), side.size());
    if (letters.size() != side.size() || letters.find('"') != std::string::npos)
        letters.assign(side.size(), 'Q');
    const bool has_slices = letters.find('Z') != std::string::npos;
    std::vector<TiffAxis> axes;
    for (size_t a = side.size() - 2 - samples; a-- > 0;) {
        const bool is_slices = letters[a] == 'Z' || (!has_slices && axes.empty() &&
                                                     letters[a] != 'C' && letters[a] != 'T');
        axes.push_back({is_slices ? 'Z' : letters[a], side[a]});
    }
    const uint64_t count = planes_in(axes);
    const bool is_run = text.find("\"truncated\": true") != std::string::npos;
    if (count < 1 || (count != images_of(page).size() && !is_run))
        return;
    stack.by = "its description";
    const std::vector<size_t> planes = pages_for(stack, page, count);
    if (planes.empty())
        refuse("its description says %llu slices that follow each other, and it has %s",
               wide(count), plural_of(images_of(page).size(), "page").c_str());
    arrange(stack, axes, planes);
}

/* ---- OME ---- */

using Attributes = std::map<std::string, std::string>;

struct OmePlanes { /* a TiffData */
    Attributes attribute;
    std::string file, uuid; /* file of its planes; "" for this one */
};

struct Ome {
    std::string uuid, metadata_file;
    Attributes pixels; /* the first image */
    std::vector<OmePlanes> planes;
    size_t images = 0, pixel_sets = 0;
    bool in_uuid = false;
    XML_Parser parser = nullptr;
};

uint64_t number_of(Attributes &attribute, const std::string &name, uint64_t usual)
{
    char *end;
    const std::string &value = attribute[name];
    const unsigned long long number = std::strtoull(value.c_str(), &end, 10);
    if (value.empty())
        return usual;
    if (*end || value[0] < '0' || value[0] > '9')
        refuse("its OME description has %s=%s; expected a number", name.c_str(),
               printable(value, 20).c_str());
    return number;
}

void begin_element(void *context, const char *name, const char **pair)
{
    Ome &ome = *static_cast<Ome *>(context);
    const char *colon = std::strrchr(name, ':');
    const std::string local = colon ? colon + 1 : name;
    Attributes attribute;
    for (; pair[0]; pair += 2)
        attribute[pair[0]] = pair[1];
    if (local == "OME")
        ome.uuid = attribute["UUID"];
    if (local == "BinaryOnly")
        ome.metadata_file = attribute["MetadataFile"];
    ome.images += local == "Image";
    if (local == "Pixels" && ome.pixel_sets++ == 0)
        ome.pixels = attribute;
    if (local == "TiffData" && ome.pixel_sets == 1)
        ome.planes.push_back({attribute, "", ""});
    ome.in_uuid = local == "UUID" && !ome.planes.empty();
    if (ome.in_uuid)
        ome.planes.back().file = attribute["FileName"];
}

void end_element(void *context, const char *)
{
    static_cast<Ome *>(context)->in_uuid = false;
}

void take_text(void *context, const char *text, int length)
{
    Ome &ome = *static_cast<Ome *>(context);
    if (ome.in_uuid)
        ome.planes.back().uuid.append(text, static_cast<size_t>(length));
}

/* Stop at declarations of entities: they are hostile and may expand to gigabytes. */
void stop_at_doctype(void *context, const char *, const char *, const char *, int)
{
    XML_StopParser(static_cast<Ome *>(context)->parser, XML_FALSE);
}

Ome ome_of(const std::string &text)
{
    Ome ome;
    const std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(nullptr),
                                                                         XML_ParserFree);
    if (!parser)
        throw std::bad_alloc();
    XML_SetUserData(parser.get(), &ome);
    XML_SetElementHandler(parser.get(), begin_element, end_element);
    XML_SetCharacterDataHandler(parser.get(), take_text);
    XML_SetStartDoctypeDeclHandler(parser.get(), stop_at_doctype);
    ome.parser = parser.get();
    if (text.size() > INT32_MAX ||
        XML_Parse(parser.get(), text.data(), static_cast<int>(text.size()), 1) != XML_STATUS_OK)
        refuse("its OME description is damaged: it is no XML; in a copy, `tiffset -u 270 COPY` "
               "removes it: then each page is a slice");
    return ome;
}

/* Refuse an image with parts in other files, and name the first one. */
void check_files(const Ome &ome, const std::string &path)
{
    const std::string own = path.substr(path.find_last_of('/') + 1);
    std::string other = ome.metadata_file;
    for (const OmePlanes &planes : ome.planes) {
        const bool is_own = planes.file == own || (planes.uuid.empty() && planes.file.empty()) ||
                            (!ome.uuid.empty() && planes.uuid == ome.uuid);
        if (!is_own && other.empty())
            other = planes.file.empty() ? planes.uuid : planes.file;
    }
    if (!other.empty())
        refuse("a part of it is in another file, %s, says its OME description; `bfconvert FILE "
               "A.ome.tif` (Bio-Formats) makes one file of all",
               shown(other).c_str());
}

/* Refuse a description that does not match the pages. */
void check_pixels(Ome &ome, const TiffPage &page, const std::string &type)
{
    static const std::map<std::string, std::string> types = {
        {"float", "float32"}, {"double", "float64"}, {"bit", "uint8"}};
    const auto other = types.find(ome.pixels["Type"]);
    const std::string said = other == types.end() ? ome.pixels["Type"] : other->second;
    const uint64_t width = number_of(ome.pixels, "SizeX", 0);
    const uint64_t height = number_of(ome.pixels, "SizeY", 0);
    if (width != page.width || height != page.height || (!said.empty() && said != type))
        refuse("its OME description is of an image of %llux%llu %s, and its pages are %ux%u %s; in "
               "a copy, `tiffset -u 270 COPY` removes the description: then each page is a slice",
               wide(width), wide(height), printable(said, 20).c_str(), page.width, page.height,
               type.c_str());
}

/* Voxel size in millimetres. */
void step_ome(TiffStack &stack, Ome &ome)
{
    static const char *const name[] = {"PhysicalSizeX", "PhysicalSizeY", "PhysicalSizeZ"};
    stack.by = "its OME description";
    stack.unit = "mm";
    for (int a = 0; a < 3; a++) {
        const std::string said = ome.pixels[std::string(name[a]) + "Unit"];
        const std::string unit = said.empty() ? "um" : said;
        const double size = std::strtod(ome.pixels[name[a]].c_str(), nullptr);
        const double mm = length_mm(unit.c_str());
        stack.step[a] = mm > 0 ? size * mm : 0;
        if (size > 0 && mm <= 0)
            stack.note.push_back(words_of("its OME description has %s %g, and its unit is %s: "
                                          "spacing=X,Y,Z sets it in millimetres",
                                          name[a], size, printable(unit, 20).c_str()));
    }
}

/* Page of each plane, in the order of the axes. A TiffData without a page covers all pages. */
std::vector<size_t> planes_of(const Ome &ome, const std::vector<TiffAxis> &axes, size_t pages)
{
    const uint64_t all = planes_in(axes);
    std::vector<size_t> planes(static_cast<size_t>(all), none);
    std::vector<OmePlanes> given = ome.planes;
    if (given.empty())
        given.emplace_back();
    for (OmePlanes &part : given) {
        uint64_t at = 0, stride = 1;
        for (const TiffAxis &axis : axes) {
            const uint64_t first = number_of(part.attribute, std::string("First") + axis.letter, 0);
            at += first < axis.size ? first * stride : all;
            stride *= axis.size;
        }
        const uint64_t page = number_of(part.attribute, "IFD", 0);
        const bool is_one = !part.attribute["IFD"].empty();
        const uint64_t count = number_of(part.attribute, "PlaneCount",
                                         is_one ? 1 : std::min<uint64_t>(all - at, pages));
        if (at >= all || page >= pages || count > std::min<uint64_t>(all - at, pages - page))
            refuse("its OME description has %llu planes from page %llu, and it has %s for %llu "
                   "planes",
                   wide(count), wide(page), plural_of(pages, "page").c_str(), wide(all));
        for (uint64_t i = 0; i < count; i++) {
            if (planes[at + i] != none)
                refuse("its OME description has two pages for plane %llu", wide(at + i + 1));
            planes[at + i] = static_cast<size_t>(page + i);
        }
    }
    return planes;
}

void arrange_ome(TiffStack &stack, const std::vector<TiffPage> &page, unsigned samples,
                 const std::string &path, const std::string &text, const std::string &type)
{
    Ome ome = ome_of(text);
    check_files(ome, path);
    if (ome.images != 1 || ome.pixel_sets != 1)
        refuse(
            "it holds %zu images, says its OME description; `bfconvert -series 0 FILE A.ome.tif` "
            "(Bio-Formats) extracts one",
            ome.images);
    check_pixels(ome, page[images_of(page)[0]], type);
    const uint64_t channels = number_of(ome.pixels, "SizeC", 1);
    std::vector<TiffAxis> axes;
    for (const char letter : ome.pixels["DimensionOrder"])
        if (letter != 'X' && letter != 'Y' && axes.size() < 3)
            axes.push_back({letter, number_of(ome.pixels, std::string("Size") + letter, 1)});
    std::string letters;
    for (TiffAxis &axis : axes) {
        letters += axis.letter;
        if (axis.letter == 'C')
            axis.size /= samples;
    }
    std::sort(letters.begin(), letters.end());
    const uint64_t planes = planes_in(axes);
    if (letters != "CTZ" || channels % samples != 0)
        refuse("its OME description has DimensionOrder %s and %llu channels, in pages of %u",
               printable(ome.pixels["DimensionOrder"], 10).c_str(), wide(channels), samples);
    if (planes < 1 || planes > page.size())
        refuse("its OME description says %llu planes, and it has %s", wide(planes),
               plural_of(page.size(), "page").c_str());
    const std::vector<size_t> pages = planes_of(ome, axes, page.size());
    const auto lacking = std::find(pages.begin(), pages.end(), none);
    if (lacking != pages.end())
        refuse("its OME description has no page for plane %zu of %zu",
               static_cast<size_t>(lacking - pages.begin()) + 1, pages.size());
    arrange(stack, axes, pages);
    step_ome(stack, ome);
    std::vector<size_t> used = pages;
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const std::vector<size_t> images = images_of(page);
    const auto others = std::count_if(images.begin(), images.end(), [&](size_t number) {
        return !std::binary_search(used.begin(), used.end(), number);
    });
    if (others)
        stack.note.push_back(plural_of(static_cast<size_t>(others), "page") +
                             " without an OME description left out");
}

/* ---- LSM ---- */

/* The header CZ_LSMINFO: little-endian numbers, lengths in metres. */
void arrange_lsm(TiffStack &stack, const std::vector<TiffPage> &page, unsigned samples,
                 const std::string &lsm)
{
    enum { SIZE_Z = 16, CHANNELS = 20, FRAMES = 24, VOXEL = 40, SCAN = 88, BYTES = 90 };
    const auto number = [&](size_t at) { return number_in(&lsm[at], 4, false); };
    if (lsm.size() < BYTES)
        refuse("cut short: its CZ_LSMINFO has %zu bytes; expected %d", lsm.size(), BYTES);
    const uint64_t slices = number(SIZE_Z), frames = number(FRAMES), channels = number(CHANNELS);
    const std::vector<TiffAxis> axes = {{'Z', slices}, {'T', frames}};
    const std::vector<size_t> images = images_of(page);
    if (planes_in(axes) != images.size() || channels != samples)
        refuse(
            "its CZ_LSMINFO says %llu slices, %llu channels and %llu frames, and it has %s of %u "
            "channels; `bfconvert FILE A.ome.tif` (Bio-Formats) makes an OME-TIFF of it",
            wide(slices), wide(channels), wide(frames), plural_of(images.size(), "page").c_str(),
            samples);
    arrange(stack, axes, images);
    stack.by = "its CZ_LSMINFO";
    stack.unit = "m";
    const uint64_t scan = number_in(&lsm[SCAN], 2, false);
    for (size_t a = 0; a < 3; a++) {
        const uint64_t bits = number_in(&lsm[VOXEL + 8 * a], 8, false);
        stack.step[a] = load<double>(&bits);
        if (scan != 0 && scan != 3 && scan != 6) /* other axes than x and y */
            stack.step[a] = 0;
    }
}

/* ---- all programs ---- */

/* Refuse microscope stacks with unsupported descriptions of axes. */
void refuse_foreign(const std::string &description, size_t pages)
{
    static const char *const begin[] = {"state.", "SI.", "scanimage."};
    for (const char *word : begin)
        if (pages > 1 && description.compare(0, std::strlen(word), word) == 0)
            refuse("a stack of ScanImage, whose channels and frames are not read; `bfconvert FILE "
                   "A.ome.tif` (Bio-Formats) makes an OME-TIFF of it");
}

TiffStack stack_of(const std::vector<TiffPage> &page, unsigned samples, const std::string &path,
                   const std::string &description, const std::string &lsm,
                   const TiffStack &resolution, const std::string &type)
{
    TiffStack stack = resolution;
    const size_t pages = images_of(page).size();
    const bool is_ome = description.find("<OME") != std::string::npos ||
                        description.find(":OME ") != std::string::npos;
    refuse_foreign(description, pages);
    if (!lsm.empty())
        arrange_lsm(stack, page, samples, lsm);
    else if (description.compare(0, 7, "ImageJ=") == 0)
        arrange_imagej(stack, page, description);
    else if (is_ome && description.find("</") != std::string::npos)
        arrange_ome(stack, page, samples, path, description, type);
    else if (description.compare(0, std::strlen(old_shape_name), old_shape_name) == 0 ||
             (description[0] == '{' && description.find(shape_name) != std::string::npos))
        arrange_shaped(stack, page, description);
    if (stack.page.empty())
        arrange(stack, {{'Z', pages}}, images_of(page));
    if (samples > 1) { /* samples are channels, the fastest axis */
        stack.axes.insert(stack.axes.begin(), {'C', samples});
        stack.volumes = product_of(stack.volumes, samples);
    }
    if (stack.volumes > number_most)
        refuse("it holds more than a million volumes; expected one");
    return stack;
}

} // namespace volume
