/* SPDX-License-Identifier: MIT */
/*
 * DICOM: divide a series with several images at each place into volumes.
 *
 * Tags distinguish the images: echo, b-value, kind of image, time. A tag counts only if it differs
 * between images of one place. Its grade says how far it is trusted:
 *
 *     KIND     A volume has one value. The images of a value fill every place the same number of
 *              times; otherwise the series is refused.
 *     MOMENT   A time, which may differ between slices of a volume: the earliest image of each
 *              place belongs to the first volume, the next one to the second.
 *     NUMBER   As MOMENT, if either all numbers of a volume are less than those of the next, or all
 *              numbers of a place less than those of another; otherwise it divides nothing.
 *     LAST     As NUMBER, for images between which no other tag differs, if no two files have the
 *              same number.
 *
 * Each row divides the groups left by the rows before it. So volumes are sorted by the rows in
 * turn, ascending, a missing value first.
 */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <iterator>
#include <map>
#include <set>

#include <gdcmDataSet.h>

namespace volume
{

enum Grade { KIND, MOMENT, NUMBER, LAST };
enum Form { DECIMALS, INTEGERS, DOUBLES, LONGS, SHORTS, CLOCK, WORDS };

struct Source {
    uint16_t group, element;
    Form form;
};

/* The last present tag is used: those of functional groups come after others. */
struct Row {
    const char *name, *unit;
    Grade grade;
    std::vector<Source> sources;
};

/* In the order of enum Tagged. */
static const std::vector<Row> rows = {
    {"temporal position", "", KIND, {{0x0020, 0x0100, INTEGERS}, {0x0020, 0x9128, LONGS}}},
    {"echo", " ms", KIND, {{0x0018, 0x0081, DECIMALS}, {0x0018, 0x9082, DOUBLES}}},
    {"echo number", "", KIND, {{0x0018, 0x0086, INTEGERS}}},
    {"inversion time", " ms", KIND, {{0x0018, 0x0082, DECIMALS}, {0x0018, 0x9079, DOUBLES}}},
    {"flip angle", " degrees", KIND, {{0x0018, 0x1314, DECIMALS}}},
    {"tube voltage", " kV", KIND, {{0x0018, 0x0060, DECIMALS}}},
    {"b", "", KIND, {{0x0018, 0x9087, DOUBLES}}},
    {"gradient", "", KIND, {{0x0018, 0x9089, DOUBLES}}},
    {"image type", "", KIND, {{0x0008, 0x0008, WORDS}, {0x0008, 0x9007, WORDS}}},
    {"complex component", "", KIND, {{0x0008, 0x9208, WORDS}}},
    {"trigger time",
     " ms",
     MOMENT,
     {{0x0018, 0x1060, DECIMALS}, {0x0020, 0x9153, DOUBLES}, {0x0020, 0x9252, DOUBLES}}},
    {"time offset", " s", MOMENT, {{0x0020, 0x930d, DOUBLES}}},
    {"dimension index", "", NUMBER, {{0x0020, 0x9157, LONGS}}},
    {"acquisition number", "", NUMBER, {{0x0020, 0x0012, INTEGERS}, {0x0020, 0x9156, SHORTS}}},
    {"acquisition time",
     " s",
     MOMENT,
     {{0x0008, 0x0032, CLOCK},
      {0x0008, 0x002a, CLOCK},
      {0x0018, 0x9151, CLOCK},
      {0x0018, 0x9074, CLOCK}}},
    {"content time", " s", NUMBER, {{0x0008, 0x0033, CLOCK}}},
    {"instance number", "", LAST, {{0x0020, 0x0013, INTEGERS}}},
};

constexpr size_t numbers_most = 16;
constexpr unsigned components = 16; /* per row: each dimension index is a separate tag */
constexpr double half_a_day_s = 43200;

static const Row &row_of(unsigned id)
{
    return rows[id / components];
}

/* ---- values ---- */

/* Seconds of a date and time, or of a time; NaN for other texts. */
static double clock_of(std::string text)
{
    text.erase(std::remove(text.begin(), text.end(), ':'), text.end());
    text = text.substr(0, text.find_first_of("+-&"));
    const size_t digits = std::min(text.find('.'), text.size());
    const size_t day = digits > 6 ? 8 : 0;
    if (digits < day || digits - day > 6 || digits == 0 ||
        text.find_first_not_of("0123456789") < digits)
        return NAN;
    const auto number = [&](size_t from, size_t length) {
        return from < digits ? std::atoi(text.substr(from, length).c_str()) : 0;
    };
    struct tm date = {};
    date.tm_year = day ? number(0, 4) - 1900 : 70;
    date.tm_mon = day ? number(4, 2) - 1 : 0;
    date.tm_mday = day ? number(6, 2) : 1;
    date.tm_hour = number(day, 2);
    date.tm_min = number(day + 2, 2);
    date.tm_sec = number(day + 4, 2);
    return static_cast<double>(timegm(&date)) + std::atof(("0" + text.substr(digits)).c_str());
}

/* Add the date, if there is one: for a time of day it is in the tag 0x10 before. */
static double clock_of(const gdcm::DataSet &set, const Source &source)
{
    const std::string text = text_of(set, {source.group, source.element});
    std::string day;
    if (source.element >= 0x0032 && source.element <= 0x0033)
        day = text_of(set, {source.group, static_cast<uint16_t>(source.element - 0x10)});
    day.erase(std::remove(day.begin(), day.end(), '.'), day.end());
    return text.empty() ? NAN : clock_of(day.size() == 8 ? day + text : text);
}

/* Ignore differences beyond the sixth digit. */
static double rounded(double number)
{
    return std::atof(words_of("%.6g", number).c_str()) + 0.0;
}

template <typename Number>
static void take_numbers(std::vector<double> &out, const std::string &bytes)
{
    for (size_t at = 0; at + sizeof(Number) <= bytes.size(); at += sizeof(Number))
        out.push_back(static_cast<double>(load<Number>(&bytes[at])));
}

static std::vector<double> numbers_of(Slice &slice, const gdcm::DataSet &set, const Source &source)
{
    const gdcm::Tag tag(source.group, source.element);
    std::vector<double> numbers;
    std::string none;
    if (source.form == DECIMALS || source.form == INTEGERS) {
        numbers.resize(numbers_most);
        numbers.resize(decimals_of(source.form == DECIMALS ? slice.fault : none, set, tag,
                                   numbers.data(), numbers_most));
    } else if (source.form == CLOCK) {
        numbers = {clock_of(set, source)};
    } else if (source.form == DOUBLES) {
        take_numbers<double>(numbers, raw_of(set, tag));
    } else if (source.form == LONGS) {
        take_numbers<uint32_t>(numbers, raw_of(set, tag));
    } else {
        take_numbers<uint16_t>(numbers, raw_of(set, tag));
    }
    if (numbers.size() > numbers_most ||
        !std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::isfinite(n); }))
        return {};
    if (source.form != CLOCK)
        std::transform(numbers.begin(), numbers.end(), numbers.begin(), rounded);
    return numbers;
}

/* Sort words: original, derived; magnitude, phase, real, imaginary; then by letters. */
static Value words_value(const std::string &text)
{
    static const std::vector<std::string> kinds = {"magnitude", "phase", "real", "imaginary"};
    const auto at = std::find(kinds.begin(), kinds.end(), kind_of(text)) - kinds.begin();
    return {{text.compare(0, 7, "DERIVED") == 0 ? 1.0 : 0.0, static_cast<double>(at)}, text};
}

void take_tags(Slice &slice, const gdcm::DataSet &set)
{
    for (unsigned r = 0; r < rows.size(); r++)
        for (const Source &source : rows[r].sources) {
            if (!set.FindDataElement(gdcm::Tag(source.group, source.element)))
                continue;
            if (source.form == WORDS) {
                const std::string text = text_of(set, {source.group, source.element});
                if (!text.empty())
                    slice.tags[r * components] = words_value(text);
                continue;
            }
            const std::vector<double> numbers = numbers_of(slice, set, source);
            const bool is_split = r == DIMENSION_INDEX;
            for (unsigned i = 0; is_split && i < numbers.size() && i < components; i++)
                slice.tags[r * components + i] = {{numbers[i]}, ""};
            if (!is_split && !numbers.empty())
                slice.tags[r * components] = {numbers, ""};
        }
    const gdcm::Tag siemens = find_private(set, 0x0019, 0x0c, "SIEMENS MR HEADER");
    const unsigned b = B_VALUE * components;
    double number;
    if (siemens.GetGroup() && slice.tags.count(b) == 0 &&
        decimals_of(slice.fault, set, siemens, &number, 1) == 1)
        slice.tags[b] = {{rounded(number)}, ""};
}

static const Value &value_at(const Slice &slice, unsigned id)
{
    static const Value missing;
    const auto at = slice.tags.find(id);
    return at == slice.tags.end() ? missing : at->second;
}

const Value &value_of(const Slice &slice, Tagged row)
{
    return value_at(slice, row * components);
}

/* ---- volumes ---- */

/* Images by place, as indices of the series; a volume if each place has one. */
using Group = std::vector<std::vector<size_t>>;

struct Part {
    Group at;
    std::string label;
};

static bool differs(const std::vector<Slice> &series, const Group &group, unsigned id)
{
    for (const std::vector<size_t> &images : group)
        for (const size_t i : images)
            if (value_at(series[i], id) != value_at(series[images[0]], id))
                return true;
    return false;
}

static std::set<Value> values_of(const std::vector<Slice> &series, const Group &group, unsigned id)
{
    std::set<Value> values;
    for (const std::vector<size_t> &images : group)
        for (const size_t i : images)
            values.insert(value_at(series[i], id));
    return values;
}

/* Least and greatest value of images. */
using Range = std::pair<Value, Value>;

static Range range_of(const std::vector<Slice> &series, const Group &group, unsigned id)
{
    const std::set<Value> values = values_of(series, group, id);
    return {*values.begin(), *values.rbegin()};
}

/* Test whether the ranges, sorted, do not overlap. */
static bool are_apart(std::vector<Range> ranges)
{
    std::sort(ranges.begin(), ranges.end());
    for (size_t i = 1; i < ranges.size(); i++)
        if (!(ranges[i - 1].second < ranges[i].first))
            return false;
    return true;
}

static bool are_in_blocks(const std::vector<Slice> &series, const Group &whole,
                          const std::map<Value, Group> &parts, unsigned id)
{
    std::vector<Range> volumes, places;
    for (const auto &part : parts)
        volumes.push_back(range_of(series, part.second, id));
    for (const std::vector<size_t> &images : whole)
        places.push_back(range_of(series, {images}, id));
    return are_apart(volumes) || are_apart(places);
}

/* "4.92", "0.6,0,0.8" */
static std::string listed(const Value &value, double before)
{
    std::string list;
    for (const double number : value.first)
        list += words_of("%s%.6g", list.empty() ? "" : ",",
                         before ? std::round((number - before) * 1000) / 1000 : number);
    return list;
}

/* Text for a value: ", echo 4.92 ms". Words from the file are replaced by our own, or by their
 * rank. */
static std::string label_of(const Row &row, unsigned id, const Range &range, size_t which,
                            size_t parts, const Range &whole)
{
    std::string name = std::string(", ") + row.name;
    if (id % components || id / components == DIMENSION_INDEX)
        name += words_of(" %u:", id % components + 1);
    const std::string kind = kind_of(range.first.second);
    if (range.first.first.empty())
        return name + " not said";
    if (row.sources[0].form == WORDS)
        return name + words_of(" %zu of %zu", which + 1, parts) +
               (kind.empty() ? "" : " (" + kind + ")");
    const bool is_clock =
        row.sources[0].form == CLOCK; /* relative to the first: no date is shown */
    const double before = is_clock ? whole.first.first[0] : 0;
    const std::string least = listed(range.first, before), most = listed(range.second, before);
    return name + (is_clock ? " +" : " ") + least + (least == most ? "" : " to " + most) + row.unit;
}

/* LAST: test whether no other tag differs, and each file has its own number. */
static bool may_decide(const std::vector<Slice> &series, const Group &group, unsigned id,
                       const std::vector<unsigned> &differing)
{
    std::set<std::string> files;
    for (const std::vector<size_t> &images : group)
        for (const size_t i : images)
            files.insert(series[i].path);
    return files.size() == values_of(series, group, id).size() &&
           std::none_of(differing.begin(), differing.end(), [&](unsigned other) {
               return other != id && differs(series, group, other);
           });
}

/* Divide a part by a tag; false if values of a KIND are mixed. */
static bool divide(std::vector<Part> &out, const Part &part, const std::vector<Slice> &series,
                   unsigned id, const std::vector<unsigned> &differing)
{
    const Row &row = row_of(id);
    const bool is_kind = row.grade == KIND;
    if (!is_kind && part.at[0].size() == 1) {
        out.push_back(part);
        return true;
    }
    std::map<Value, Group> parts;
    for (size_t place = 0; place < part.at.size(); place++) {
        std::map<Value, std::vector<size_t>> here;
        double rank = 0;
        for (const size_t i : part.at[place])
            here[value_at(series[i], id)].push_back(i);
        for (const auto &images : here) {
            Group &group = parts[is_kind ? images.first : Value{{rank++}, ""}];
            group.resize(part.at.size());
            group[place] = images.second;
        }
    }
    const Range whole = range_of(series, part.at, id);
    bool is_whole = true;
    for (const auto &each : parts)
        for (const std::vector<size_t> &images : each.second)
            is_whole &= !images.empty() && images.size() == each.second[0].size();
    /* Times of day more than half a day apart may span midnight. */
    const bool is_too_long =
        row.sources[0].form == CLOCK &&
        (whole.first.first.empty() || whole.second.first[0] - whole.first.first[0] > half_a_day_s);
    const bool is_sound =
        is_kind ||
        (!is_too_long && (row.grade == MOMENT || are_in_blocks(series, part.at, parts, id)) &&
         (row.grade != LAST || may_decide(series, part.at, id, differing)));
    if (!is_whole || !is_sound || parts.size() == 1) {
        out.push_back(part);
        return is_whole || !is_kind;
    }
    size_t which = 0;
    for (const auto &each : parts)
        out.push_back(
            {each.second, part.label + label_of(row, id, range_of(series, each.second, id), which++,
                                                parts.size(), whole)});
    return true;
}

/* "echo (2 values), image type (2 values)" */
static std::string list_differing(const std::vector<Slice> &series,
                                  const std::vector<unsigned> &differing)
{
    std::string list;
    for (const unsigned id : differing) {
        std::set<Value> values;
        for (const Slice &slice : series)
            values.insert(value_at(slice, id));
        list +=
            words_of("%s%s (%zu values)", list.empty() ? "" : ", ", row_of(id).name, values.size());
    }
    return list.empty() ? "no tag" : list;
}

std::vector<std::string> divide_volumes(std::vector<Slice> &series,
                                        const std::vector<size_t> &count, bool &by_instance)
{
    Part all;
    std::vector<unsigned> differing;
    for (size_t place = 0, i = 0; place < count.size(); place++) {
        all.at.emplace_back();
        for (size_t n = 0; n < count[place]; n++)
            all.at.back().push_back(i++);
    }
    std::set<unsigned> ids;
    for (const Slice &slice : series)
        for (const auto &tag : slice.tags)
            ids.insert(tag.first);
    std::copy_if(ids.begin(), ids.end(), std::back_inserter(differing),
                 [&](unsigned id) { return differs(series, all.at, id); });
    std::vector<Part> parts = {all};
    const auto most = std::max_element(count.begin(), count.end());
    const auto least = std::min_element(count.begin(), count.end());
    if (*most != *least)
        refuse("slices are doubled or missing: place %td of %zu along the series holds %zu slices "
               "and place %td holds %zu; those of one place differ in %s; put those of one volume "
               "into a folder of their own",
               most - count.begin() + 1, count.size(), *most, least - count.begin() + 1, *least,
               list_differing(series, differing).c_str());
    bool are_kinds = true;
    by_instance = false;
    for (const unsigned id : differing) {
        std::vector<Part> next;
        for (const Part &part : parts)
            are_kinds &= divide(next, part, series, id, differing);
        by_instance |= row_of(id).grade == LAST && next.size() > parts.size();
        parts = next;
    }
    if (!are_kinds || parts.size() != *most)
        refuse("each place along the series holds %zu slices, and no tag divides them into whole "
               "volumes; those of one place differ in %s; put those of one volume into a folder of "
               "their own",
               *most, list_differing(series, differing).c_str());
    std::vector<Slice> in_order;
    std::vector<std::string> labels;
    for (size_t place = 0; place < count.size(); place++)
        for (const Part &part : parts)
            in_order.push_back(series[part.at[place][0]]);
    series.swap(in_order);
    for (const Part &part : parts)
        labels.push_back(part.label.substr(2) + ", " + plural_of(count.size(), "slice"));
    return labels;
}

} // namespace volume
