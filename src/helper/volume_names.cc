/* SPDX-License-Identifier: MIT */
/* Headers in text, NRRD and MetaImage: their fields, the files that they name for the voxels, and
 * units of length and scales of values, which ITK ignores. Malformed numbers are refused; ITK would
 * use their first digits. */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

extern "C" {
#include "base/confine.h"
#include "image/reader_common.h"
}

namespace volume
{

constexpr size_t header_most = 1 << 20; /* bytes, with lists of names */
constexpr uint64_t files_most = 100000;
constexpr size_t fields_most = 1000;

/* ---- fields ---- */

std::string Header::value(const char *name) const
{
    const auto found = field.find(name);
    return found == field.end() ? "" : found->second;
}

std::string trimmed(const std::string &text)
{
    const size_t first = text.find_first_not_of(" \t\r"), last = text.find_last_not_of(" \t\r");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

/* A MetaImage has lines "NAME = VALUE" and ends with the field that names its voxels; a NRRD has
 * lines "NAME: VALUE" and ends with an empty line. */
Header header_of(const std::string &kind, const std::string &path)
{
    const bool is_meta = kind == "meta";
    Header header;
    std::ifstream file(path, std::ios::binary);
    std::string line;
    for (uint64_t at = 0; header.end == 0 && std::getline(file, line);) {
        at += line.size() + (file.eof() ? 0 : 1);
        const size_t between = line.find(is_meta ? '=' : ':');
        const std::string name = in_small_letters(trimmed(line.substr(0, between)));
        const bool is_key = !is_meta && between + 1 < line.size() && line[between + 1] == '=';
        if (between != std::string::npos && line[0] != '#' && !is_key &&
            header.field.size() < fields_most)
            header.field[name] = trimmed(line.substr(between + 1));
        if (is_meta ? name == "elementdatafile" : trimmed(line).empty())
            header.end = at;
    }
    return header;
}

/* ---- one name ---- */

std::string folder_of(const std::string &path)
{
    const size_t slash = path.find_last_of('/');
    return slash == std::string::npos ? "./" : path.substr(0, slash + 1);
}

std::string last_name(const std::string &path)
{
    return shown(path.substr(path.find_last_of('/') + 1));
}

std::string wrong_with(const std::string &header, const std::string &name)
{
    const enum path_kind look = path_kind_below(folder_of(header).c_str(), name.c_str());
    if (look == PATH_IS_FILE)
        return "";
    const char *is = look == PATH_IS_MISSING   ? "which is not there"
                     : look == PATH_IS_OUTSIDE ? "which is not below the folder of the header"
                                               : "which is not a regular file";
    return words_of("voxels of it are in %s, %s; nothing else is read in its place",
                    shown(name).c_str(), is);
}

/* ---- lines ---- */

struct Text {
    std::string bytes;
    bool is_whole;
};

Text begin_of(const std::string &path)
{
    Text text = {std::string(header_most, '\0'), false};
    std::ifstream file(path, std::ios::binary);
    file.read(&text.bytes[0], header_most);
    text.bytes.resize(static_cast<size_t>(file.gcount()));
    text.is_whole = text.bytes.size() < header_most;
    return text;
}

[[noreturn]] void refuse_header()
{
    refuse("its header says in no way that is read here which files its voxels are in");
}

std::vector<std::string> words_in(const std::string &text)
{
    std::istringstream stream(text);
    std::vector<std::string> words;
    for (std::string word; stream >> word;)
        words.push_back(word);
    return words;
}

/* Parse a number of at most nine digits. */
long number_of(const std::string &word)
{
    const size_t sign = word[0] == '-';
    if (word.size() == sign || word.size() > 9 ||
        word.find_first_not_of("0123456789", sign) != std::string::npos)
        refuse_header();
    return std::stol(word);
}

/* Expand a pattern such as "slice%03d.raw", from the first number to the last in steps. */
std::vector<std::string> count_names(const std::string &pattern, long first, long last, long step)
{
    std::vector<std::string> names;
    /* Allow only this conversion: others could harm the reader. */
    const size_t begin = pattern.find('%');
    const size_t letter = pattern.find_first_not_of("0123456789", begin + 1), end = letter + 1;
    if (letter == std::string::npos || pattern[letter] != 'd' || letter - begin > 4 ||
        pattern.find('%', letter) != std::string::npos)
        refuse_header();
    const std::string digits = pattern.substr(begin + 1, letter - begin - 1);
    const size_t width = digits.empty() ? 0 : static_cast<size_t>(number_of(digits));
    const char fill = digits[0] == '0' ? '0' : ' ';
    if (step == 0 || first < 0 || (last - first) / step < 0)
        refuse_header();
    for (long i = first; step > 0 ? i <= last : i >= last; i += step) {
        std::string number = std::to_string(i);
        if (names.size() >= files_most || i < 0)
            refuse_header();
        if (number.size() < width)
            number.insert(0, width - number.size(), fill);
        names.push_back(pattern.substr(0, begin) + number + pattern.substr(end));
    }
    return names;
}

/* Line at `at` without its end; advance `at` past it. */
std::string next_line(const std::string &text, size_t &at)
{
    const size_t end = std::min(text.find('\n', at), text.size());
    std::string line = text.substr(at, end - at);
    at = std::min(end + 1, text.size());
    if (!line.empty() && line.back() == '\r')
        line.pop_back();
    if (line.find('\r') != std::string::npos || line.find('\0') != std::string::npos)
        refuse_header();
    return line;
}

bool is_list(const std::string &value)
{
    return value.compare(0, 4, "LIST") == 0;
}

/* ---- NRRD ---- */

/* Test whether teem treats the value as a pattern: a % that is not doubled. */
bool is_pattern(const std::string &value)
{
    size_t at = value.find('%');
    while (at != std::string::npos && at + 1 < value.size() && value[at + 1] == '%')
        at = value.find('%', at + 2);
    if (at == std::string::npos)
        return false;
    at = value.find_first_not_of("0123456789", at + 1);
    return at != std::string::npos && (value[at] == 'd' || value[at] == 'u');
}

std::vector<std::string> names_in_nrrd(const Text &text)
{
    std::vector<std::string> names;
    bool named = false;
    for (size_t at = 0; at < text.bytes.size();) {
        const std::string line = next_line(text.bytes, at);
        const size_t colon = line.find(": ");
        if (line.empty())
            return names;
        const std::string field = in_small_letters(line.substr(0, colon));
        if (colon == std::string::npos || line[0] == '#' ||
            (field != "data file" && field != "datafile"))
            continue;
        const size_t begin = line.find_first_not_of(" \t", colon + 2);
        const std::string value = begin == std::string::npos ? "" : line.substr(begin);
        if (named)
            refuse_header();
        named = true;
        if (is_list(value)) { /* up to the end of the header */
            for (std::string name; at < text.bytes.size();) {
                name = next_line(text.bytes, at);
                if (name.empty())
                    return names;
                names.push_back(name);
            }
        } else if (is_pattern(value)) {
            const std::vector<std::string> word = words_in(value);
            if (word.size() < 4)
                refuse_header();
            names =
                count_names(word[0], number_of(word[1]), number_of(word[2]), number_of(word[3]));
        } else {
            names.push_back(value);
        }
    }
    if (!text.is_whole) /* the rest was not checked */
        refuse_header();
    return names;
}

/* ---- MetaImage ---- */

const char meta_field[] = "ElementDataFile";

/* Value of the field at `at`; advance `at` past its line. */
std::string meta_value(const std::string &text, size_t &at)
{
    const std::string line = next_line(text, at);
    const size_t begin = line.find_first_not_of(" \t=:", line.find_first_of("=:"));
    const size_t end = line.find_last_not_of(" \t");
    return begin == std::string::npos ? "" : line.substr(begin, end + 1 - begin);
}

/* Sizes in the header, the fastest axis first. */
std::vector<long> meta_sides(const std::string &text)
{
    std::vector<long> sides;
    for (size_t at = 0; at < text.size();) {
        if (text.compare(at, 7, "DimSize") == 0) {
            for (const std::string &word : words_in(meta_value(text, at)))
                sides.push_back(number_of(word));
            break;
        }
        at = std::min(text.find('\n', at), text.size() - 1) + 1;
    }
    return sides;
}

/* Require one file for each piece of `dimensions` axes: a list that is too short would leave zeros.
 */
void check_number(size_t files, const std::vector<long> &sides, size_t dimensions)
{
    uint64_t pieces = 1;
    for (size_t a = dimensions; a < sides.size(); a++)
        if (sides[a] < 1 || (pieces *= static_cast<uint64_t>(sides[a])) > files_most)
            refuse_header();
    if (files != pieces)
        refuse("its header names %s, and says that it has %s", plural_of(files, "file").c_str(),
               plural_of(pieces, "piece").c_str());
}

/* MetaIO ends a header at this field, wherever it is in a line; require it at the begin of one. */
std::string meta_says(const Text &text, size_t &at)
{
    at = text.bytes.find(meta_field);
    if (at == std::string::npos) {
        if (!text.is_whole)
            refuse_header();
        return "";
    }
    const size_t begin = text.bytes.find_last_not_of(" \t", at ? at - 1 : 0);
    if (at > 0 && begin != std::string::npos && text.bytes[begin] != '\n')
        refuse_header();
    return meta_value(text.bytes, at);
}

std::vector<std::string> names_in_meta(const Text &text, const std::string &path)
{
    size_t at;
    const std::string value = meta_says(text, at);
    if (at == std::string::npos || value == "LOCAL" || value == "Local" || value == "local")
        return {};
    if (!text.is_whole || value.empty() || text.bytes.find(meta_field, at) != std::string::npos)
        refuse_header();
    const std::vector<long> sides = meta_sides(text.bytes);
    const std::vector<std::string> word = words_in(value);
    if (is_list(value)) {
        const size_t given = word.size() > 1 ? static_cast<size_t>(number_of(word[1])) : 0;
        std::vector<std::string> names;
        while (at < text.bytes.size()) {
            names.push_back(next_line(text.bytes, at));
            names.back().erase(names.back().find_last_not_of(" \t") + 1);
        }
        while (!names.empty() && names.back().empty())
            names.pop_back();
        check_number(names.size(), sides,
                     given < 1 || given > sides.size() ? sides.size() - 1 : given);
        return names;
    }
    if (value.find('%') != std::string::npos) {
        if (word.size() != 4 || sides.empty())
            refuse_header();
        const std::vector<std::string> names =
            count_names(word[0], number_of(word[1]), number_of(word[2]), number_of(word[3]));
        check_number(names.size(), sides, sides.size() - 1);
        return names;
    }
    for (const char *ending : {"", ".gz"}) /* both are tried by MetaIO */
        if (path_kind_below(folder_of(path).c_str(), (value + ending).c_str()) != PATH_IS_MISSING)
            return {value + ending};
    return {value};
}

/* ---- all names ---- */

std::vector<std::string> named_files(const Request &request)
{
    std::vector<std::string> names, paths;
    if (request.kind == "nrrd")
        names = names_in_nrrd(begin_of(request.path));
    else if (request.kind == "meta")
        names = names_in_meta(begin_of(request.path), request.path);
    for (const std::string &name : names) {
        refuse_for(wrong_with(request.path, name));
        paths.push_back(folder_of(request.path) + name);
    }
    return paths;
}

void check_meta(const Request &request, const std::string &name, const std::vector<long> &sides)
{
    size_t at;
    const Text text = begin_of(request.path);
    if (meta_says(text, at) != name ||
        ((is_list(name) || name.find('%') != std::string::npos) && meta_sides(text.bytes) != sides))
        refuse_header();
}

/* ---- units of length, and scales of values ---- */

/* Texts between quotes. */
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

/* An empty word counts as a missing field: millimetres. */
void take_unit(Units &units, int axis, const std::string &word)
{
    units.mm[axis] = word.empty() ? 1 : length_mm(word.c_str());
    if (units.mm[axis] > 0)
        return;
    units.mm[axis] = 1;
    units.are_known = false;
}

/* Numbers of the first three axes that ITK uses as axes of space. It moves an axis of values, such
 * as a list, to the front, and keeps the order of the others. */
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
        refuse(
            "it has %zu axes of lists or vectors; expected one at most: `unu slice` extracts one "
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

void check_nrrd(const Header &header)
{
    const std::string encoding = in_small_letters(header.value("encoding"));
    const bool is_bzip2 = encoding == "bzip2" || encoding == "bz2";
    if (is_bzip2 || encoding == "zrl")
        refuse("its voxels are packed %s, which is not read; `unu save -f nrrd -e gzip -i FILE -o "
               "OUT` packs them by gzip",
               is_bzip2 ? "by bzip2" : "as zrl");
    if (in_small_letters(header.value("type")) == "block")
        refuse("its voxels are blocks of bytes; expected integers or floats");
    check_numbers(header, "spacings");
}

Units units_of_nrrd(const Header &header)
{
    Units units;
    const std::vector<size_t> axes = axes_of_space(header);
    const std::vector<std::string> of_axes = quoted_in(header.value("units"));
    units.are_of_space = header.has("space directions");
    units.field = units.are_of_space ? "space units" : "units";
    const std::vector<std::string> words = quoted_in(header.value(units.field));
    for (size_t a = 0; a < 3 && header.has(units.field); a++) {
        const size_t which = units.are_of_space ? a : a < axes.size() ? axes[a] : words.size();
        if (units.are_of_space || a < axes.size())
            take_unit(units, static_cast<int>(a), which < words.size() ? words[which] : "?");
    }
    if (units.are_of_space)
        for (const std::string &word : of_axes)
            if (!word.empty()) /* ambiguous */
                units.are_known = false;
    return units;
}

Units units_of(const std::string &kind, const Header &header)
{
    Units units;
    if (kind == "nrrd") {
        check_nrrd(header);
        return units_of_nrrd(header);
    }
    for (const char *name :
         {"elementspacing", "elementsize", "offset", "position", "origin", "transformmatrix",
          "rotation", "orientation", "centerofrotation", "dimsize",
          "elementtointensityfunctionslope", "elementtointensityfunctionoffset"})
        check_numbers(header, name);
    const std::string word = header.value("distanceunits");
    units.field = "DistanceUnits";
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
