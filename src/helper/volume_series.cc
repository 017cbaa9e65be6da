/* SPDX-License-Identifier: MIT */
/* DICOM: sort the slices of a series. ITK sorts them too, but does not report gaps, doubled slices
 * and uneven distances. */
#include "helper/volume_parts.hh"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <tuple>
#include <utility>

namespace volume
{

using Series = std::vector<Slice>;

/* ---- grouping and sorting ---- */

bool are_alike(const Slice &a, const Slice &b)
{
    if (!a.fault.empty() || !b.fault.empty()) /* their geometry is unknown */
        return a.series == b.series;
    return a.series == b.series && a.columns == b.columns && a.rows == b.rows &&
           a.samples == b.samples && a.has_axes == b.has_axes && a.has_position == b.has_position &&
           std::equal(a.axis, a.axis + 6, b.axis,
                      [](double p, double q) { return std::fabs(p - q) <= 1e-3; }) &&
           std::fabs(a.spacing[0] - b.spacing[0]) <= 1e-4 * a.spacing[0] &&
           std::fabs(a.spacing[1] - b.spacing[1]) <= 1e-4 * a.spacing[1];
}

/* Group slices by series, direction and size, and sort the groups by series number. */
std::vector<Series> series_of(std::vector<Slice> slices)
{
    std::vector<Series> all;
    for (Slice &slice : slices) {
        const auto at = std::find_if(all.begin(), all.end(), [&](const Series &series) {
            return are_alike(series[0], slice);
        });
        if (at == all.end())
            all.push_back({slice});
        else
            at->push_back(slice);
    }
    std::stable_sort(all.begin(), all.end(), [](const Series &a, const Series &b) {
        return std::tie(a[0].series_number, a[0].series) <
               std::tie(b[0].series_number, b[0].series);
    });
    return all;
}

bool have_places(const Series &series)
{
    return series[0].has_position && series[0].has_axes;
}

/* Sort key of slices without a place. */
std::vector<Value> order_of(const Slice &slice)
{
    return {value_of(slice, TEMPORAL_POSITION), value_of(slice, ECHO_NUMBER),
            value_of(slice, ACQUISITION_NUMBER), value_of(slice, INSTANCE_NUMBER)};
}

/* Test whether the files have distinct numbers. */
bool have_numbers(const Series &series)
{
    std::map<std::vector<Value>, std::string> file;
    return std::all_of(series.begin(), series.end(), [&](const Slice &slice) {
        return file.emplace(order_of(slice), slice.path).first->second == slice.path;
    });
}

/* Test whether all slices have a SliceLocation, and at least two differ. */
bool have_locations(const Series &series)
{
    bool differ = false;
    for (const Slice &slice : series) {
        if (!std::isfinite(slice.location))
            return false;
        differ |= slice.location != series[0].location;
    }
    return differ;
}

bool are_along(const Series &series)
{
    return have_places(series) || have_locations(series);
}

/* Sort by position along the normal of the first slice; otherwise by SliceLocation, in the
 * direction of the numbers; otherwise by numbers and frames. */
void sort_slices(Series &series)
{
    double normal[3];
    normal_of(normal, series[0].axis);
    std::stable_sort(series.begin(), series.end(), [](const Slice &a, const Slice &b) {
        return std::make_pair(order_of(a), a.frame) < std::make_pair(order_of(b), b.frame);
    });
    const bool is_located = !have_places(series) && have_locations(series);
    const auto is_above = [](const Slice &a, const Slice &b) { return a.location > b.location; };
    const bool is_turned = is_located && have_numbers(series) &&
                           std::is_sorted(series.begin(), series.end(), is_above);
    for (Slice &slice : series) {
        slice.along = is_turned ? -slice.location : is_located ? slice.location : 0;
        for (int w = 0; w < 3 && have_places(series); w++)
            slice.along += normal[w] * slice.position[w];
    }
    std::stable_sort(series.begin(), series.end(), [](const Slice &a, const Slice &b) {
        /* nearer slices are in one place */
        return std::floor(a.along * 200 + 0.5) < std::floor(b.along * 200 + 0.5);
    });
}

bool is_same_place(const Slice &a, const Slice &b)
{
    return std::fabs(a.along - b.along) < 0.0075;
}

/* ---- choosing a series ----
 *
 * Series are distinguished by facts of their files. A description is shown only to the user who
 * chooses (Request.lists). If a series is named by a piece of its description, the answer is its
 * number, which is recorded. A description with a name or number of the patient is never shown. */

constexpr size_t more_most = 18; /* length of "; and 100000 more" */

/* "TE 4.9 ms", "b 0 to 1000"; "" if unknown. */
std::string range_of(const Series &series, Tagged row, const char *name, const char *unit)
{
    double least = INFINITY, most = -1;
    for (const Slice &slice : series) {
        const std::vector<double> &numbers = value_of(slice, row).first;
        least = std::min(least, numbers.empty() ? 0 : numbers[0]);
        most = std::max(most, numbers.empty() ? -1 : numbers[0]);
    }
    if (most < 0)
        return "";
    return least < most ? words_of("%s %.4g to %.4g%s", name, least, most, unit)
                        : words_of("%s %.4g%s", name, most, unit);
}

/* Description of a series to choose by. */
struct Entry {
    std::string description, rest; /* "18 slices of 56x64, MR, 4x4x5 mm" */
    std::string apart[3];          /* shown if it differs from another similar entry */
};

/* Median distance of slices, and the number of volumes. */
double step_of(Series series, size_t &volumes)
{
    std::vector<double> steps;
    sort_slices(series);
    for (size_t i = 1; i < series.size(); i++)
        if (!is_same_place(series[i - 1], series[i]))
            steps.push_back(series[i].along - series[i - 1].along);
    const size_t places = steps.size() + 1;
    volumes = have_places(series) && series.size() % places == 0 ? series.size() / places : 1;
    if (steps.empty())
        return series[0].between > 0 ? series[0].between : series[0].thickness;
    std::nth_element(steps.begin(), steps.begin() + static_cast<long>(steps.size() / 2),
                     steps.end());
    return steps[steps.size() / 2];
}

Entry entry_of(const Series &series, bool lists)
{
    static const std::set<std::string> known = {"CT", "MR", "PT", "NM", "US",  "CR",     "DX", "MG",
                                                "XA", "RF", "OT", "SC", "OCT", "RTDOSE", "SEG"};
    const Slice &slice = series[0]; /* only known modalities are shown */
    const char *modality =
        known.count(slice.modality) ? slice.modality.c_str() : "of another modality";
    Entry entry;
    size_t volumes = 1;
    const double step = step_of(series, volumes);
    if (lists)
        entry.description = slice.names_patient ? "" : slice.description;
    entry.rest = words_of("%s of %ux%u, %s", plural_of(series.size() / volumes, "slice").c_str(),
                          slice.columns, slice.rows, modality);
    if (volumes > 1)
        entry.rest += words_of(", %zu volumes", volumes);
    if (slice.spacing[0] > 0 && step > 0)
        entry.rest += words_of(", %.4gx%.4gx%.4g mm", slice.spacing[1], slice.spacing[0], step);
    if (!slice.fault.empty())
        entry.rest += ", cannot be read";
    entry.apart[0] = range_of(series, ECHO_TIME, "TE", " ms");
    entry.apart[1] = range_of(series, B_VALUE, "b", "");
    entry.apart[2] = kind_of(value_of(slice, IMAGE_TYPE).second);
    return entry;
}

/* Entries for the user: `1: "t1_mprage", 18 slices of ..`. */
std::vector<std::string> entries_of(const std::vector<Series> &all,
                                    const std::vector<size_t> &wanted, bool lists)
{
    std::vector<Entry> entries;
    std::vector<std::string> texts;
    for (const size_t i : wanted)
        entries.push_back(entry_of(all[i], lists));
    for (size_t i = 0; i < entries.size(); i++) {
        const Entry &entry = entries[i];
        std::string text = std::to_string(wanted[i] + 1) + ": ";
        if (!entry.description.empty())
            text += "\"" + entry.description + "\", ";
        text += entry.rest;
        for (size_t k = 0; k < 3; k++)
            if (!entry.apart[k].empty() &&
                std::any_of(entries.begin(), entries.end(), [&](const Entry &other) {
                    return other.description == entry.description &&
                           other.apart[k] != entry.apart[k];
                }))
                text += ", " + entry.apart[k];
        texts.push_back(text);
    }
    return texts;
}

/* Find the series whose description equals a piece, otherwise series that contain it; letter case
 * is ignored. */
std::vector<size_t> find_series(const std::vector<Series> &all, const std::string &piece)
{
    const std::string small = in_small_letters(description_of(piece));
    std::vector<size_t> same, having;
    for (size_t i = 0; i < all.size(); i++) {
        const std::string description = in_small_letters(all[i][0].description);
        if (description == small)
            same.push_back(i);
        if (description.find(small) != std::string::npos)
            having.push_back(i);
    }
    return same.empty() ? having : same;
}

/* Append the entries that fit into `room` letters, and the number of the others. If not all fit and
 * the client shows lists, send them in lines, append nothing and return false. */
bool add_entries(std::string &line, const std::vector<std::string> &entries, size_t room,
                 bool lists)
{
    std::string lines;
    for (const std::string &entry : entries)
        lines += entry + "\n";
    const bool fits = line.size() + lines.size() + entries.size() <= room;
    if (!fits && lists) {
        answer_list(lines);
        return false;
    }
    room -= fits ? 0 : std::min(room, more_most);
    size_t said = 0;
    for (; said < entries.size() && line.size() + entries[said].size() + 2 <= room; said++)
        line += (said ? "; " : "") + entries[said];
    if (said < entries.size())
        line += words_of("%sand %zu more", said ? "; " : "", entries.size() - said);
    return true;
}

/* Index of the requested series. Refuse an ambiguous or wrong request, and list the series. */
size_t choose_series(const std::vector<Series> &all, const Request &request)
{
    std::vector<size_t> every(all.size());
    for (size_t i = 0; i < all.size(); i++)
        every[i] = i;
    const bool is_named = !request.wanted.empty();
    const std::vector<size_t> found = is_named ? find_series(all, request.wanted) : every;
    if (request.series > 0 && request.series <= all.size())
        return request.series - 1;
    if (request.series == 0 && found.size() == 1)
        return found[0];
    std::string words;
    if (request.series > 0)
        words = words_of("there is no series %llu; it holds %zu series", wide(request.series),
                         all.size());
    else if (found.empty())
        words = words_of("no series has that in its description; it holds %zu; choose one with "
                         "series=N",
                         all.size());
    else if (is_named)
        words = words_of("%zu of its %zu series have that in their description; choose one with "
                         "series=N",
                         found.size(), all.size());
    else
        words = words_of("it holds %zu series; choose one with series=N%s", all.size(),
                         request.lists ? ", or with a piece of its description" : "");
    std::string line = words + ": ";
    const bool fits =
        add_entries(line, entries_of(all, found.empty() ? every : found, request.lists),
                    words_room(request), request.lists);
    throw Refusal{fits ? line : words + "; they are listed"};
}

/* ---- places and gaps ---- */

/* Sort a series by place and volume. Return a label for each volume; none for a single volume. */
std::vector<std::string> find_volumes(Volume &volume, Series &series)
{
    std::vector<size_t> count;
    bool by_instance;
    if (!are_along(series))
        return {};
    for (size_t i = 0; i < series.size(); i++)
        if (i > 0 && is_same_place(series[i - 1], series[i]))
            count.back()++;
        else
            count.push_back(1);
    if (count.size() == series.size())
        return {};
    const std::vector<std::string> labels = divide_volumes(series, count, by_instance);
    if (by_instance)
        note(volume, "its images of one place differ in nothing but InstanceNumber, which divides "
                     "them into volumes");
    return labels;
}

/* Describe the chosen volume, otherwise all volumes. */
void describe_volumes(Volume &volume, const std::vector<std::string> &labels,
                      const Request &request)
{
    constexpr size_t contents_most = 255; /* limit of the client */
    std::vector<std::string> entries;
    for (size_t v = 0; v < labels.size(); v++)
        entries.push_back(words_of("volume %zu: ", v) + labels[v]);
    if (request.chooses) {
        volume.contents = labels[request.volume];
        note(volume, entries[request.volume]);
        return;
    }
    if (!add_entries(volume.contents, entries, contents_most, request.lists)) {
        volume.contents = "they are listed";
        return;
    }
    for (const std::string &entry : entries)
        note(volume, entry);
}

/* Gaps between slices, in steps. */
struct Gaps {
    double step = 0;             /* median distance */
    double least = 0, most = 0;  /* least and greatest distance */
    std::vector<size_t> missing; /* after slice i */
    size_t all = 0;              /* missing slices */
    bool is_irregular = false;
};

Gaps gaps_of(const std::vector<double> &along)
{
    Gaps gaps;
    std::vector<double> steps;
    for (size_t i = 1; i < along.size(); i++)
        steps.push_back(along[i] - along[i - 1]);
    gaps.missing.resize(steps.size());
    if (steps.empty())
        return gaps;
    std::vector<double> sorted = steps;
    std::sort(sorted.begin(), sorted.end());
    gaps.step = sorted[(sorted.size() - 1) / 2];
    gaps.least = sorted.front();
    gaps.most = sorted.back();
    bool are_multiples = true;
    for (size_t i = 0; i < steps.size(); i++) {
        const double times = std::floor(steps[i] / gaps.step + 0.5);
        const double off = std::fabs(steps[i] - times * gaps.step);
        are_multiples &= times >= 1 && times < 1000 && off <= 0.02 * gaps.step + 0.005;
        gaps.missing[i] = are_multiples ? static_cast<size_t>(times) - 1 : 0;
        gaps.all += gaps.missing[i];
    }
    if (!are_multiples) {
        gaps.missing.assign(steps.size(), 0);
        gaps.all = 0;
        gaps.is_irregular = true;
    }
    return gaps;
}

std::string listed(const Gaps &gaps)
{
    std::string list;
    size_t count = 0;
    for (size_t i = 0; i < gaps.missing.size(); i++)
        if (gaps.missing[i] && count++ < 8)
            list +=
                words_of("%s%zu after slice %zu", list.empty() ? "" : ", ", gaps.missing[i], i + 1);
    return list + (count > 8 ? words_of(", and in %zu more places", count - 8) : "");
}

/* A series to read: `slice[z]` of the requested volume; frame `blank` for a missing one. */
struct Stack {
    std::vector<Slice> slice;
    bool is_real = false; /* slices have different scales or types: float32 */
    double slope = 1, intercept = 0;
};

void note_unevenness(Volume &volume, const Gaps &gaps, const std::vector<Slice> &slice)
{
    const size_t last = slice.size() - 1;
    if (gaps.is_irregular) {
        const double mean = (slice[last].along - slice[0].along) / static_cast<double>(last);
        double off = 0;
        for (size_t i = 0; i <= last; i++)
            off = std::max(
                off, std::fabs(slice[i].along - slice[0].along - mean * static_cast<double>(i)));
        note(volume, words_of("slices are not evenly spaced: %g to %g mm apart; taken as %g mm, "
                              "which puts a slice up to %.2g mm off its place",
                              gaps.least, gaps.most, mean, off));
    }
    double sideways = 0;
    for (size_t i = 1; i < last; i++) {
        const double part =
            (slice[i].along - slice[0].along) / (slice[last].along - slice[0].along);
        for (int w = 0; w < 3; w++) {
            const double line =
                slice[0].position[w] + part * (slice[last].position[w] - slice[0].position[w]);
            sideways = std::max(sideways, std::fabs(slice[i].position[w] - line));
        }
    }
    if (sideways > 0.1)
        note(volume, words_of("slices are not in one line: up to %.2g mm to the side", sideways));
}

/* Insert blank slices for missing ones, if the user allows it. */
void close_gaps(std::vector<Slice> &slice, const Gaps &gaps, bool fills_gaps, Volume &volume)
{
    if (gaps.all == 0)
        return;
    if (!fills_gaps)
        refuse("%s missing (%s) of %zu; `open FOLDER missing=blank` puts blank ones in their "
               "places",
               gaps.all == 1 ? "a slice is" : (std::to_string(gaps.all) + " slices are").c_str(),
               listed(gaps).c_str(), slice.size() + gaps.all);
    std::vector<Slice> filled;
    for (size_t i = 0; i < slice.size(); i++) {
        filled.push_back(slice[i]);
        for (size_t n = 0; i + 1 < slice.size() && n < gaps.missing[i]; n++) {
            filled.push_back(slice[i]);
            filled.back().frame = blank;
        }
    }
    slice = filled;
    note(volume, words_of("%s: blank in their places", listed(gaps).c_str()));
}

void place_series(Volume &volume, const std::vector<Slice> &slice)
{
    const Slice &first = slice.front(), &last = slice.back();
    const size_t steps = slice.size() - 1;
    double column[3][3], normal[3];
    volume.frame = first.reference;
    normal_of(normal, first.axis);
    const bool is_placed = have_places(slice), is_located = !is_placed && have_locations(slice);
    const double depth = is_located ? (last.along - first.along) / static_cast<double>(steps)
                         : first.between > 0 ? first.between
                                             : first.thickness;
    for (int w = 0; w < 3; w++) {
        column[0][w] = first.axis[w] * (first.spacing[1] > 0 ? first.spacing[1] : 1);
        column[1][w] = first.axis[3 + w] * (first.spacing[0] > 0 ? first.spacing[0] : 1);
        column[2][w] = steps > 0 && is_placed
                           ? (last.position[w] - first.position[w]) / static_cast<double>(steps)
                           : normal[w] * (depth > 0 ? depth : 1);
        const double sign = is_placed && w < 2 ? -1 : 1;
        for (int a = 0; a < 3; a++)
            volume.to_mm[w][a] = sign * column[a][w];
        volume.to_mm[w][3] = is_placed ? sign * first.position[w] : 0;
    }
    if (first.spacing[0] > 0 && (steps > 0 && is_placed ? true : depth > 0))
        volume.known |= SPACING;
    if (is_placed)
        volume.known |= ORIENTATION;
    else if (steps == 0)
        note(volume, "it holds no place in the patient");
    else
        note(volume, words_of("its slices hold no place in the patient: they are in the order of "
                              "their %s",
                              is_located                ? "SliceLocation"
                              : first.path == last.path ? "frames"
                                                        : "numbers"));
}

/* A slope of 0 means no scale, as in NIfTI. */
void check_slopes(Volume &volume, std::vector<Slice> &slice)
{
    const Slice first = slice[0];
    for (Slice &each : slice) {
        if ((each.slope == 0) != (first.slope == 0))
            throw Refusal{about_file((each.slope == 0 ? each : first).name,
                                     "is scaled by a slope of 0, and other slices are not")};
        if (each.slope == 0)
            each.slope = 1, each.intercept = 0;
    }
    if (first.slope == 0)
        note(volume, words_of("its slope is 0 and its intercept %g: values are not scaled",
                              first.intercept));
}

/* Choose the type of voxels and their scale. */
void choose_type(Volume &volume, Stack &stack)
{
    const Slice &first = stack.slice[0];
    stack.slope = first.slope;
    stack.intercept = first.intercept;
    for (const Slice &slice : stack.slice)
        stack.is_real |= slice.slope != first.slope || slice.intercept != first.intercept ||
                         slice.bits != first.bits || slice.is_signed != first.is_signed ||
                         slice.lookup;
    if (first.samples != 1)
        refuse("its pixels have colours; expected one value each");
    if (first.bits != 8 && first.bits != 16 && first.bits != 32)
        refuse("its pixels have %u bits; expected 8, 16 or 32", first.bits);
    volume.type =
        stack.is_real ? "float32" : (first.is_signed ? "int" : "uint") + std::to_string(first.bits);
    if (!stack.is_real) {
        volume.slope = stack.slope;
        volume.intercept = stack.intercept;
    }
    if (first.lookup)
        note(volume, "its values are those of its Modality LUT");
    if (first.is_inverse)
        note(volume, "its values are for display with bright and dark exchanged (MONOCHROME1)");
}

/* ---- pixels ---- */

/* Decode a stored number. */
int64_t number_at(const char *at, unsigned bits, bool is_signed)
{
    const uint64_t value = bits == 8    ? static_cast<uint8_t>(*at)
                           : bits == 16 ? load<uint16_t>(at)
                                        : load<uint32_t>(at);
    const uint64_t sign = uint64_t{1} << (bits - 1);
    return is_signed ? static_cast<int64_t>(value ^ sign) - static_cast<int64_t>(sign)
                     : static_cast<int64_t>(value);
}

/* Decodes files; the frames of one file that follow each other only once. */
class Decoder
{
  public:
    /* Pixels of a slice; null on failure. */
    const char *decode(const Slice &slice)
    {
        const size_t frame = size_t{slice.columns} * slice.rows * (slice.bits / 8);
        if (slice.path != path_) {
            path_.clear();
            if (!read_pixels(bytes_, slice))
                return nullptr;
            path_ = slice.path;
        }
        return &bytes_[frame * slice.frame];
    }

  private:
    std::string path_;
    std::vector<char> bytes_;
};

/* Leave out copies of files, and return their number. Images with the same SOPInstanceUID are
 * copies if place, tags and pixels are equal: programs that anonymise may give all files the same
 * one. */
size_t leave_out_copies(Volume &volume, Series &series)
{
    using Identity =
        std::tuple<std::string, unsigned, std::vector<double>, double, std::map<unsigned, Value>>;
    std::set<std::pair<std::string, unsigned>> objects;
    std::map<Identity, Series> seen;
    Decoder one, other;
    Series kept;
    size_t named = 0;
    for (const Slice &slice : series) {
        const size_t bytes = size_t{slice.columns} * slice.rows * (slice.bits / 8);
        const auto is_copy = [&](const Slice &before) {
            const char *a = one.decode(before), *b = other.decode(slice);
            return before.bits == slice.bits && (!a || !b ? a == b : !std::memcmp(a, b, bytes));
        };
        if (slice.object.empty()) {
            kept.push_back(slice);
            continue;
        }
        Series &same = seen[{slice.object, slice.frame,
                             std::vector<double>(slice.position, slice.position + 3),
                             std::isfinite(slice.location) ? slice.location : 0, slice.tags}];
        if (std::any_of(same.begin(), same.end(), is_copy))
            continue;
        named += !objects.insert({slice.object, slice.frame}).second;
        same.push_back(slice);
        kept.push_back(slice);
    }
    const size_t copies = series.size() - kept.size();
    series.swap(kept);
    if (named)
        note(volume, plural_of(named, "image") + (named == 1 ? " has" : " have") +
                         " the SOPInstanceUID of another, but not its place or pixels: kept");
    return copies;
}

/* Send a blank slice: air in a CT, otherwise 0. */
void send_blank(const Volume &volume, const Stack &stack, const Slice &slice)
{
    const size_t pixels = size_t{slice.columns} * slice.rows;
    const double real = slice.modality == "CT" ? -1024 : 0;
    std::vector<char> bytes(pixels * bytes_of(volume.type));
    const double stored = (real - stack.intercept) / stack.slope;
    for (size_t i = 0; i < pixels; i++)
        if (stack.is_real) {
            const auto value = static_cast<float>(real);
            std::memcpy(&bytes[4 * i], &value, sizeof value);
        } else if (volume.type == "int16" && stored >= -32768 && stored <= 32767) {
            const int16_t value = static_cast<int16_t>(stored);
            std::memcpy(&bytes[2 * i], &value, sizeof value);
        }
    send_piece(bytes.data(), bytes.size());
}

float look_up(const Lookup &lookup, int64_t number)
{
    const auto last = static_cast<int64_t>(lookup.value.size()) - 1;
    return lookup.value[static_cast<size_t>(std::clamp<int64_t>(number - lookup.first, 0, last))];
}

void send_stack(const Volume &volume, const Stack &stack)
{
    Decoder decoder;
    for (size_t z = 0; z < stack.slice.size(); z++) {
        const Slice &slice = stack.slice[z];
        if (slice.frame == blank) {
            send_blank(volume, stack, slice);
            continue;
        }
        const std::string words = about_file(
            slice.name, words_of("is slice %zu of %zu, which cannot be decoded: it is damaged, or "
                                 "packed in a way that is not known here",
                                 z + 1, stack.slice.size()));
        expect_end(words);
        const char *bytes = decoder.decode(slice);
        if (!bytes)
            throw Refusal{words};
        const size_t pixels = size_t{slice.columns} * slice.rows, width = slice.bits / 8;
        if (!stack.is_real) {
            send_piece(bytes, pixels * width);
            continue;
        }
        std::vector<float> real(pixels);
        for (size_t i = 0; i < pixels; i++) {
            const int64_t number = number_at(bytes + i * width, slice.bits, slice.is_signed);
            real[i] = slice.lookup ? look_up(*slice.lookup, number)
                                   : static_cast<float>(static_cast<double>(number) * slice.slope +
                                                        slice.intercept);
        }
        send_piece(real.data(), pixels * sizeof(float));
    }
}

void stack_slices(Volume &volume, const std::vector<Slice> &slices, const Request &request)
{
    const std::vector<Series> all = series_of(slices);
    const size_t number = choose_series(all, request);
    Series series = all[number];
    volume.series = number + 1;
    for (const Slice &slice : series)
        if (!slice.fault.empty())
            throw Refusal{about_file(slice.name, "is " + slice.fault)};
    const size_t copies = leave_out_copies(volume, series);
    sort_slices(series);
    if (!are_along(series) && !have_numbers(series))
        refuse("its slices hold no place in the patient, no SliceLocation, and no InstanceNumber "
               "that differs from file to file: nothing says their order");
    const std::vector<std::string> labels = find_volumes(volume, series);
    volume.volumes = std::max<size_t>(labels.size(), 1);
    if (request.volume >= volume.volumes)
        refuse("there is no volume %llu; it holds %s, counted from 0", wide(request.volume),
               plural_of(volume.volumes, "volume").c_str());
    if (!labels.empty())
        describe_volumes(volume, labels, request);
    const std::shared_ptr<Stack> stack = std::make_shared<Stack>();
    std::vector<double> along;
    for (size_t i = request.volume; i < series.size(); i += volume.volumes) {
        stack->slice.push_back(series[i]);
        along.push_back(series[i].along);
    }
    check_slopes(volume, stack->slice);
    place_series(volume, stack->slice);
    if (are_along(series)) {
        const Gaps gaps = gaps_of(along);
        note_unevenness(volume, gaps, stack->slice);
        const size_t found = stack->slice.size();
        close_gaps(stack->slice, gaps, request.fills_gaps, volume);
        for (auto &row : volume.to_mm)
            row[2] *= stack->slice.size() > 1 ? static_cast<double>(found - 1) /
                                                    static_cast<double>(stack->slice.size() - 1)
                                              : 1;
    }
    if (series[0].tiles > 1 && series[0].between <= 0)
        note(volume, words_of("it says how thick its slices are, %g mm, and not how far apart: "
                              "taken as the same",
                              series[0].thickness));
    if (copies)
        note(volume, plural_of(copies, "file") + (copies == 1 ? " is a copy" : " are copies") +
                         " of others, and left out");
    if (request.refers)
        volume.references = references_of(stack->slice, request.identifies);
    choose_type(volume, *stack);
    check_pixels(volume, stack->slice);
    volume.format = "DICOM";
    volume.size[0] = stack->slice[0].columns;
    volume.size[1] = stack->slice[0].rows;
    volume.size[2] = stack->slice.size();
    volume.send = [&volume, stack]() { send_stack(volume, *stack); };
}

void open_dicom(Volume &volume, const Request &request)
{
    std::vector<Slice> slices;
    if (!request.skip.empty())
        refuse("skip=NAME leaves out files of a folder, and this is one file");
    if (open_segments(volume, request))
        return;
    if (!scan(slices, request.path))
        refuse(
            "it is no DICOM file, or its header is damaged; an image of Siemens Vision (.ima) is "
            "not read: convert it by a program that reads it, such as `c3d FILE -o A.nii`");
    if (slices.empty()) {
        std::string words;
        is_of_images(words, request.path);
        throw Refusal{words.empty() ? "a DICOM file without pixels (a report or a plan); open the "
                                      "folder with the slices"
                                    : words};
    }
    stack_slices(volume, slices, request);
    if (volume.size[2] == 1)
        note(volume, "it is one slice: `open FOLDER` reads a whole series");
}

} // namespace volume
