/* SPDX-License-Identifier: MIT */
/* Units of length and scales of values in headers of text, NRRD and MetaImage, which ITK leaves
 * out; and the numbers there, of which ITK takes the beginning where the rest is no number. */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cmath>
#include <cstdlib>

extern "C" {
#include "image/reader_common.h"
}

namespace volume
{

/* ---- values of fields ---- */

/* The texts between quotes. */
std::vector<std::string> quoted_in(const std::string &value)
{
    std::vector<std::string> texts;
    for (size_t at = value.find('"'); at != std::string::npos; at = value.find('"', at)) {
        const size_t end = value.find('"', at + 1);
        if (end == std::string::npos)
            break;
        texts.push_back(value.substr(at + 1, end - at - 1));
        at = end + 1;
    }
    return texts;
}

void check_numbers(const Header &header, const char *name)
{
    for (const std::string &word : words_in(header.value(name))) {
        char *end;
        std::strtod(word.c_str(), &end);
        if (*end == '\0')
            continue;
        refuse(word.find(',') != std::string::npos
                   ? "its field %s has a decimal comma; write its numbers with a decimal point"
                   : "its field %s has words that are no numbers",
               name);
    }
}

/* ---- units ---- */

bool Units::are_alike() const
{
    return mm[0] == mm[1] && mm[1] == mm[2];
}

/* An empty word says nothing, as a field that is not there: lengths are in millimetres then. */
void take_unit(Units &units, int axis, const std::string &word)
{
    units.mm[axis] = word.empty() ? 1 : length_mm(word.c_str());
    if (units.mm[axis] > 0)
        return;
    units.mm[axis] = 1;
    units.are_known = false;
}

/* ---- NRRD ---- */

/* Numbers of the first three axes that ITK takes for those of space. It moves an axis of values,
 * such as a list, to the front, and keeps the order of all others. */
std::vector<size_t> axes_of_space(const Header &header)
{
    const std::string directions = header.value("space directions");
    const std::vector<std::string> kinds = words_in(in_small_letters(header.value("kinds")));
    const size_t rank = std::strtoul(header.value("dimension").c_str(), nullptr, 10);
    std::vector<bool> has_none;
    for (size_t at = 0; at < directions.size(); at++)
        if (directions[at] == '(' || directions[at] == 'n') {
            has_none.push_back(directions[at] == 'n');
            at = directions.find_first_of(directions[at] == 'n' ? " \t" : ")", at);
            if (at == std::string::npos)
                break;
        }
    std::vector<size_t> axes;
    size_t lists = 0;
    for (size_t a = 0; a < std::min(rank, size_t{16}); a++) {
        const std::string kind = a < kinds.size() ? kinds[a] : "none";
        const bool is_time = kind == "time";
        if (!is_time && kind != "domain" && kind != "space" && kind != "none" && kind != "???" &&
            kind != "unknown") {
            lists++;
        } else if (axes.size() < 3) {
            if (is_time || (a < has_none.size() && has_none[a]))
                refuse("its axis %zu is not one of space, and comes before three of those; `unu "
                       "permute -p 1 2 3 0 -i FILE -o OUT` puts the first axis last",
                       a + 1);
            axes.push_back(a);
        }
    }
    if (lists > 1)
        refuse("it has %zu axes of lists or vectors; expected one at most: `unu slice` takes one "
               "place along an axis",
               lists);
    return axes;
}

bool nrrd_has_spacings(const Header &header)
{
    const std::vector<std::string> words = words_in(header.value("spacings"));
    for (const size_t axis : axes_of_space(header))
        if (axis >= words.size() || std::isnan(std::strtod(words[axis].c_str(), nullptr)))
            return false;
    return true;
}

Units units_of_nrrd(const Header &header)
{
    Units units;
    const std::vector<size_t> axes = axes_of_space(header);
    const std::vector<std::string> of_space = quoted_in(header.value("space units"));
    const std::vector<std::string> of_axes = quoted_in(header.value("units"));
    check_numbers(header, "spacings");
    units.are_of_space = header.field.count("space directions") > 0;
    for (size_t a = 0; a < 3; a++) {
        const bool is_said = header.field.count(units.are_of_space ? "space units" : "units") > 0;
        const std::vector<std::string> &words = units.are_of_space ? of_space : of_axes;
        const size_t which = units.are_of_space ? a : a < axes.size() ? axes[a] : words.size();
        if (is_said && (units.are_of_space || a < axes.size()))
            take_unit(units, static_cast<int>(a), which < words.size() ? words[which] : "?");
    }
    if (units.are_of_space)
        for (const std::string &word : of_axes)
            if (!word.empty()) /* two answers for the same lengths */
                units.are_known = false;
    return units;
}

void check_nrrd(const Header &header)
{
    const std::string encoding = in_small_letters(header.value("encoding"));
    if (encoding == "bzip2" || encoding == "bz2")
        refuse("its voxels are packed by bzip2, which is not read; `unu save -f nrrd -e gzip -i "
               "FILE -o OUT` packs them by gzip");
    if (encoding == "zrl")
        refuse("its voxels are packed as zrl, which is not read; `unu save -f nrrd -e gzip -i FILE "
               "-o OUT` packs them by gzip");
    if (in_small_letters(header.value("type")) == "block")
        refuse("its voxels are blocks of bytes; expected integers or floats");
}

/* ---- MetaImage ---- */

void check_meta_numbers(const Header &header)
{
    for (const char *name :
         {"elementspacing", "elementsize", "offset", "position", "origin", "transformmatrix",
          "rotation", "orientation", "centerofrotation", "dimsize",
          "elementtointensityfunctionslope", "elementtointensityfunctionoffset"})
        check_numbers(header, name);
}

Units units_of_meta(const Header &header)
{
    const std::string word = header.value("distanceunits");
    Units units;
    for (int a = 0; a < 3; a++)
        take_unit(units, a, word == "?" ? "" : word);
    return units;
}

void scale_meta(Volume &volume, const Header &header)
{
    const std::string slope = header.value("elementtointensityfunctionslope");
    const std::string offset = header.value("elementtointensityfunctionoffset");
    volume.slope = slope.empty() ? 1 : std::strtod(slope.c_str(), nullptr);
    volume.intercept = offset.empty() ? 0 : std::strtod(offset.c_str(), nullptr);
    if (volume.slope != 0 && std::isfinite(volume.slope) && std::isfinite(volume.intercept))
        return;
    note(volume, words_of("its ElementToIntensityFunction is %g * number + %g, which is no scale: "
                          "numbers are taken as they are",
                          volume.slope, volume.intercept));
    volume.slope = 1;
    volume.intercept = 0;
}

} // namespace volume
