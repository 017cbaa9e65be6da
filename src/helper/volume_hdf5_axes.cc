/* SPDX-License-Identifier: MIT */
/*
 * HDF5: find the axes of a data set and the distances of voxels, by attributes that programs write.
 *
 *     axistags            ilastik (vigra): {"axes": [{"key": "z", "resolution": 0, ...}, ...]}
 *     axis_units          ilastik: {"z": "um", ...}, the units of those resolutions
 *     DIMENSION_LABELS    the library's own dimension scales: "z", "y", "x"
 *     axes                "zyx", or one text a dimension
 *     element_size_um     micrometres, the slowest dimension of space first
 *     resolution, voxel_size, spacing, pixel_size, scale; with _nm, _um or _mm, or `unit`, `units`
 *
 * Without names of axes the last three dimensions are z, y and x. Programs write attributes of the
 * last row in either order of axes: three equal numbers are used, others only noted.
 *
 * Imaris has the size of the image and its extent in attributes of texts, one letter each; data
 * sets are padded to whole blocks.
 */
#include "helper/volume_hdf5.hh"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>

#include "helper/volume_parts.hh"

extern "C" {
#include "image/reader_common.h"
}

namespace volume
{

constexpr size_t attribute_most = 1 << 20;

/* ---- attributes ---- */

std::vector<std::string> texts_of(hid_t object, const std::string &name)
{
    std::vector<std::string> texts;
    if (object < 0 || H5Aexists(object, name.c_str()) <= 0)
        return texts;
    Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
    Handle type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const size_t bytes = H5Tget_size(type);
    if (H5Tget_class(type) != H5T_STRING || count < 1 || bytes < 1 ||
        static_cast<size_t>(count) > attribute_most / bytes)
        return texts;
    if (H5Tis_variable_str(type) > 0) {
        std::vector<char *> text(static_cast<size_t>(count), nullptr);
        if (H5Aread(attribute, type, text.data()) >= 0)
            for (const char *one : text)
                texts.push_back(one ? std::string(one).substr(0, attribute_most) : "");
        H5Dvlen_reclaim(type, space, H5P_DEFAULT, text.data());
        return texts;
    }
    std::string all(static_cast<size_t>(count) * bytes, '\0');
    if (H5Aread(attribute, type, &all[0]) >= 0)
        for (size_t at = 0; at < all.size(); at += bytes)
            texts.push_back(std::string(all.substr(at, bytes).c_str()));
    return texts;
}

/* Concatenate texts of one letter each. */
std::string text_of(hid_t object, const std::string &name)
{
    std::string whole;
    for (const std::string &text : texts_of(object, name))
        whole += text;
    return whole;
}

std::vector<double> reals_of(hid_t object, const std::string &name)
{
    if (H5Aexists(object, name.c_str()) <= 0)
        return {};
    Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose);
    Handle type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    const H5T_class_t is = H5Tget_class(type);
    if ((is != H5T_INTEGER && is != H5T_FLOAT) || count < 1 || count > 32)
        return {};
    std::vector<double> numbers(static_cast<size_t>(count));
    if (H5Aread(attribute, H5T_NATIVE_DOUBLE, numbers.data()) < 0)
        return {};
    return numbers;
}

/* ---- JSON ---- */

/* Collect the members of objects at a depth of a JSON text, by name, without quotes. Malformed JSON
 * yields fewer members. */
std::vector<std::map<std::string, std::string>> objects_in(const std::string &text, int depth)
{
    std::vector<std::map<std::string, std::string>> objects;
    std::string name;
    int is_at = 0;
    bool has_name = false;
    for (size_t at = 0; at < text.size();) {
        const char c = text[at];
        size_t end = at + 1;
        if (std::strchr(" \t\r\n,:", c)) {
            at = end;
            continue;
        }
        if (c == '{' || c == '}' || c == '[' || c == ']') {
            is_at += c == '{' ? 1 : c == '}' ? -1 : 0;
            if (c == '{' && is_at == depth)
                objects.emplace_back();
            has_name = false;
            at = end;
            continue;
        }
        std::string word;
        if (c == '"') {
            for (; end < text.size() && text[end] != '"'; end++) {
                end += text[end] == '\\' && end + 1 < text.size() &&
                       (text[end + 1] == '"' || text[end + 1] == '\\');
                word += text[end];
            }
            end++;
        } else {
            end = std::min(text.find_first_of(" \t\r\n,:{}[]\"", at), text.size());
            word = text.substr(at, end - at);
        }
        at = end;
        if (!has_name)
            name = word;
        else if (is_at == depth && !objects.empty())
            objects.back()[name] = word;
        has_name = !has_name;
    }
    return objects;
}

/* ---- axes ---- */

/* Names of the dimensions; "" if unknown. */
std::vector<std::string> names_of_axes(hid_t set, size_t rank)
{
    std::vector<std::string> names;
    for (const auto &axis : objects_in(text_of(set, "axistags"), 2))
        names.push_back(axis.count("key") ? axis.at("key") : "");
    if (!names.empty() && names.size() != rank)
        refuse("its axistags name %s, and the data set has %zu",
               plural_of(names.size(), "axis").c_str(), rank);
    if (names.empty())
        names = texts_of(set, "DIMENSION_LABELS");
    if (names.size() != rank)
        names = texts_of(set, "axes");
    if (names.size() == 1 && names[0].size() == rank) {
        const std::string letters = names[0];
        names.clear();
        for (const char letter : letters)
            names.emplace_back(1, letter);
    }
    if (names.size() != rank)
        names.assign(rank, "");
    for (std::string &name : names)
        name = in_small_letters(name);
    return names;
}

Axes axes_of(Volume &volume, hid_t set, const std::vector<hsize_t> &side)
{
    static const std::string letter[3] = {"x", "y", "z"};
    const size_t rank = side.size();
    Axes axes;
    const std::vector<std::string> names = names_of_axes(set, rank);
    const auto has = [&](int a) { return std::count(names.begin(), names.end(), letter[a]); };
    for (int a = 0; a < 3; a++)
        if (has(a) > 1)
            refuse("two of its dimensions are named %s", letter[a].c_str());
    if (has(0) != has(1) || (has(2) && !has(0)))
        refuse("its dimensions are named, and of x and y one is missing: which is which is not "
               "known");
    if (!has(0)) {
        if (std::any_of(names.begin(), names.end(),
                        [](const std::string &n) { return !n.empty(); }))
            note(volume, "its dimensions have names, and none of x, y, z: the last three are taken "
                         "for z, y and x");
        for (size_t a = 0; a < 3; a++)
            axes.dimension[a] = rank - 1 - a;
        return axes;
    }
    for (size_t d = 0; d < rank; d++)
        for (size_t a = 0; a < 3; a++)
            if (names[d] == letter[a])
                axes.dimension[a] = d;
    return axes;
}

bool Axes::holds(size_t d) const
{
    return d == dimension[0] || d == dimension[1] || d == dimension[2];
}

bool Axes::is_in_order() const
{
    return dimension[1] < dimension[0] && (dimension[2] == none || dimension[2] < dimension[1]);
}

/* ---- distances ---- */

void note_no_unit(Volume &volume, const std::string &name, const std::string &why)
{
    note(volume, words_of("its attribute %s has numbers, %s: distances of voxels are unknown; "
                          "spacing=X,Y,Z says them in mm",
                          name.c_str(), why.c_str()));
}

/* Assign numbers, the slowest first, to the axes; false if their order is ambiguous. */
bool order_numbers(double of[3], const std::vector<double> &numbers, const Axes &axes, size_t rank)
{
    const bool is_one =
        std::all_of(numbers.begin(), numbers.end(), [&](double n) { return n == numbers[0]; });
    for (size_t a = 0; a < 3; a++) {
        const bool is_there = axes.dimension[a] != Axes::none;
        if (numbers.size() == rank && rank > 3)
            of[a] = is_there ? numbers[axes.dimension[a]] : 1;
        else if (numbers.size() == 3)
            of[a] = numbers[2 - a];
        else
            return false;
    }
    return is_one || axes.is_in_order();
}

void take_distances(Volume &volume, const double number[3], const double mm[3])
{
    volume.known = SPACING;
    for (int a = 0; a < 3; a++) {
        volume.to_mm[a][a] = number[a] * mm[a];
        if (!(number[a] > 0 && std::isfinite(number[a])))
            volume.known = NOTHING;
    }
    if (volume.known == NOTHING)
        for (int a = 0; a < 3; a++)
            volume.to_mm[a][a] = 1;
}

/* Use ilastik's resolutions; false if they are 0. */
bool place_by_tags(Volume &volume, hid_t set)
{
    static const char *const letter[3] = {"x", "y", "z"};
    std::map<std::string, std::string> units;
    for (const auto &object : objects_in(text_of(set, "axis_units"), 1))
        units = object;
    double number[3] = {0, 0, 1}, mm[3] = {1, 1, 1};
    bool is_said = false, has_units = true;
    for (const auto &axis : objects_in(text_of(set, "axistags"), 2))
        for (int a = 0; a < 3; a++) {
            if (!axis.count("key") || in_small_letters(axis.at("key")) != letter[a])
                continue;
            number[a] =
                axis.count("resolution") ? std::strtod(axis.at("resolution").c_str(), nullptr) : 0;
            mm[a] = units.count(letter[a]) ? length_mm(units[letter[a]].c_str()) : 0;
            is_said = is_said || number[a] > 0;
            has_units = has_units && mm[a] > 0;
        }
    if (!is_said)
        return false;
    if (has_units)
        take_distances(volume, number, mm);
    else
        note_no_unit(volume, "axistags", "and their unit is not known");
    return true;
}

/* Unit of length of the data set or its file; 0 if unknown. */
double unit_of(hid_t set)
{
    double mm = 0;
    for (const char *name : {"unit", "units"}) {
        const std::vector<std::string> texts = texts_of(set, name);
        for (const std::string &text : texts)
            if (mm == 0 || mm == length_mm(text.c_str()))
                mm = length_mm(text.c_str());
            else
                return 0;
    }
    return mm;
}

void place_set(Volume &volume, hid_t set, const Axes &axes, size_t rank)
{
    static const struct {
        const char *ending;
        double mm;
    } row[] = {{"", 0}, {"_nm", 1e-6}, {"_um", 1e-3}, {"_mm", 1}};
    double number[3];
    if (place_by_tags(volume, set))
        return;
    const std::vector<double> um = reals_of(set, "element_size_um");
    if (!um.empty()) {
        const double unit = unit_of(set), mm[3] = {1e-3, 1e-3, 1e-3};
        if (unit != 0 && unit != 1e-3)
            note_no_unit(volume, "element_size_um", "and another attribute has another unit");
        else if (order_numbers(number, um, axes, rank))
            take_distances(volume, number, mm);
        else
            note_no_unit(volume, "element_size_um", "whose order is unknown");
        return;
    }
    for (const char *base : {"resolution", "voxel_size", "voxelsize", "spacing", "pixel_size",
                             "pixelsize", "element_size", "scale"})
        for (const auto &kind : row) {
            const std::string name = std::string(base) + kind.ending;
            const std::vector<double> said = reals_of(set, name);
            const double unit = kind.mm > 0 ? kind.mm : unit_of(set);
            const double mm[3] = {unit, unit, unit};
            if (said.size() < 3)
                continue;
            if (unit == 0)
                note_no_unit(volume, name, "and their unit is not known");
            else if (order_numbers(number, said, axes, rank) && number[0] == number[1] &&
                     number[1] == number[2])
                take_distances(volume, number, mm);
            else
                note_no_unit(volume, name, "whose order is unknown");
            return;
        }
}

/* ---- Imaris ---- */

bool read_imaris(ImarisPlace &place, const std::string &name)
{
    int end = 0;
    return std::sscanf(name.c_str(), "DataSet/ResolutionLevel %u/TimePoint %u/Channel %u/Data%n",
                       &place.level, &place.time, &place.channel, &end) == 3 &&
           static_cast<size_t>(end) == name.size();
}

/* Set size and spacing of an image in a padded data set. */
void crop_imaris(Volume &volume, hid_t file, const std::string &name)
{
    ImarisPlace place;
    const std::string group = name.substr(0, name.find_last_of('/'));
    Handle channel(H5Gopen2(file, group.c_str(), H5P_DEFAULT), H5Gclose);
    Handle image(H5Lexists(file, "DataSetInfo", H5P_DEFAULT) > 0
                     ? H5Gopen2(file, "DataSetInfo/Image", H5P_DEFAULT)
                     : -1,
                 H5Gclose);
    read_imaris(place, name);
    std::string unit = text_of(image, "Unit");
    double number[3], mm[3];
    bool is_said = true;
    for (size_t a = 0; a < 3; a++) {
        const std::string letter(1, "XYZ"[a]), digit(1, "012"[a]);
        std::string size = text_of(channel, "ImageSize" + letter);
        if (size.empty() && place.level == 0)
            size = text_of(image, letter);
        const unsigned long long side = std::strtoull(size.c_str(), nullptr, 10);
        if (size.empty())
            note(volume, words_of("it does not say how much of %s is image: the blocks may be "
                                  "padded with zeros",
                                  in_small_letters(letter).c_str()));
        else if (side < 1 || side > volume.size[a])
            refuse("its image is %llu voxels long along %s, and its data set %llu", side,
                   in_small_letters(letter).c_str(), wide(volume.size[a]));
        else
            volume.size[a] = side;
        const std::string from = text_of(image, "ExtMin" + digit);
        const std::string to = text_of(image, "ExtMax" + digit);
        is_said = is_said && !from.empty() && !to.empty() && !size.empty();
        number[a] = (std::strtod(to.c_str(), nullptr) - std::strtod(from.c_str(), nullptr)) /
                    static_cast<double>(volume.size[a]);
        mm[a] = length_mm(unit.c_str());
    }
    if (is_said && mm[0] > 0)
        take_distances(volume, number, mm);
    else if (is_said)
        note_no_unit(volume, "ExtMax", "and their unit is not known");
}

} // namespace volume
