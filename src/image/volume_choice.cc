/*
 * DICOM: which of the series of a folder is read.
 *
 * They are told apart by what their files say of them. A description is shown to the user who
 * chooses (Request.lists), and to nobody else: who names a series by a piece of its description is
 * answered with its number, which is what is recorded. One that holds a name or number of the
 * patient is not shown at all.
 */
#include "image/volume_dicom.hh"

#include <algorithm>
#include <cmath>

namespace volume
{

constexpr size_t description_most = 64; /* of a long string in DICOM */
constexpr size_t private_least = 3;     /* letters of a name that are looked for */
constexpr size_t more_most = 18;        /* of "; and 100000 more" */

static const gdcm::Tag description_tag(0x0008, 0x103e), name_tag(0x0010, 0x0010),
    id_tag(0x0010, 0x0020), birth_tag(0x0010, 0x0030), type_tag(0x0008, 0x0008),
    echo_tag(0x0018, 0x0081), weighting_tag(0x0018, 0x9087);

/* ---- what files say ---- */

/* Whether a text has a part of another, which ends at any of `ends`. */
bool has_part(const std::string &text, const std::string &of, const char *ends)
{
    for (size_t from = 0; from < of.size();) {
        const size_t to = std::min(of.find_first_of(ends, from), of.size());
        if (to - from >= private_least &&
            text.find(of.substr(from, to - from)) != std::string::npos)
            return true;
        from = to + 1;
    }
    return false;
}

/* As it is said, between quotes. */
std::string description_of(const std::string &said)
{
    std::string text = printable(said, description_most);
    std::replace(text.begin(), text.end(), '"', '?');
    return text;
}

/* "phase" and the like, by the words that DICOM has for it. */
std::string kind_of(const gdcm::DataSet &set)
{
    static const std::pair<const char *, const char *> kinds[] = {
        {"\\P\\", "phase"},     {"\\PHASE\\", "phase"},         {"\\R\\", "real"},
        {"\\REAL\\", "real"},   {"\\I\\", "imaginary"},         {"\\IMAGINARY\\", "imaginary"},
        {"\\M\\", "magnitude"}, {"\\MAGNITUDE\\", "magnitude"}, {"\\LOCALIZER\\", "localizer"}};
    const std::string type = "\\" + text_of(set, type_tag) + "\\";
    for (const auto &kind : kinds)
        if (type.find(kind.first) != std::string::npos)
            return kind.second;
    return "";
}

void take_words(Slice &slice, const gdcm::DataSet &set)
{
    const std::string said = text_of(set, description_tag), small = in_small_letters(said);
    slice.description = description_of(said);
    slice.names_patient = has_part(small, in_small_letters(text_of(set, name_tag)), "^=\\ ,.-") ||
                          has_part(small, in_small_letters(text_of(set, id_tag)), "\\") ||
                          has_part(small, text_of(set, birth_tag), "\\");
    slice.kind = kind_of(set);
    take_decimal(slice.echo_ms, set, echo_tag);
    take_decimal(slice.weighting, set, find_private(set, 0x0019, 0x0c, "SIEMENS MR HEADER"));
    take_bytes(&slice.weighting, sizeof slice.weighting, set, weighting_tag);
}

/* ---- what is said of a series ---- */

/* The modality by its code; nothing else that may stand there is said. */
std::string modality_of(const Slice &slice)
{
    static const std::set<std::string> known = {"CT", "MR", "PT", "NM", "US",  "CR",     "DX", "MG",
                                                "XA", "RF", "OT", "SC", "OCT", "RTDOSE", "SEG"};
    return known.count(slice.modality) ? slice.modality : "of another modality";
}

/* "TE 4.9 ms", "b 0 to 1000"; nothing where it is not said. */
std::string range_of(const Series &series, double Slice::*number, const char *name,
                     const char *unit)
{
    const auto is_less = [number](const Slice &a, const Slice &b) { return a.*number < b.*number; };
    const double least = *std::min_element(series.begin(), series.end(), is_less).*number;
    const double most = *std::max_element(series.begin(), series.end(), is_less).*number;
    if (!std::isfinite(most) || most < 0)
        return "";
    return least < most ? words_of("%s %.4g to %.4g%s", name, std::max(least, 0.0), most, unit)
                        : words_of("%s %.4g%s", name, most, unit);
}

/* What one can tell it by. */
struct Entry {
    std::string description, rest; /* "18 slices of 56x64, MR, 4x4x5 mm" */
    std::string apart[3];          /* said where it differs from another that is alike else */
};

/* How far its slices are apart, the usual distance, and how many lie in one place. */
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
    const Slice &slice = series[0];
    Entry entry;
    size_t volumes = 1;
    const double step = step_of(series, volumes);
    if (lists)
        entry.description = slice.names_patient ? "" : slice.description;
    entry.rest = words_of("%s of %ux%u, %s", plural_of(series.size() / volumes, "slice").c_str(),
                          slice.columns, slice.rows, modality_of(slice).c_str());
    if (volumes > 1)
        entry.rest += words_of(", %zu volumes", volumes);
    if (slice.spacing[0] > 0 && step > 0)
        entry.rest += words_of(", %.4gx%.4gx%.4g mm", slice.spacing[1], slice.spacing[0], step);
    if (!slice.fault.empty())
        entry.rest += ", cannot be read";
    entry.apart[0] = range_of(series, &Slice::echo_ms, "TE", " ms");
    entry.apart[1] = range_of(series, &Slice::weighting, "b", "");
    entry.apart[2] = slice.kind;
    return entry;
}

/* Entries as they are shown: `1: "t1_mprage", 18 slices of ..`. */
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

/* ---- choosing ---- */

/* Those whose description is that piece, or else has it, whatever the size of its letters. */
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

/* Refuses, with those that there are: in one line where they fit, in lines of their own where those
 * are wanted, else as many as fit, and how many more there are. */
[[noreturn]] void refuse_series(const std::string &words, const std::vector<std::string> &entries,
                                const Request &request)
{
    size_t room = words_room(request), said = 0;
    std::string line = words + ": ", lines;
    for (const std::string &entry : entries)
        lines += entry + "\n";
    const bool fits = line.size() + lines.size() + entries.size() <= room;
    if (!fits && request.lists) {
        answer_list(lines);
        throw Refusal{words + "; they are listed"};
    }
    room -= fits ? 0 : std::min(room, more_most);
    for (; said < entries.size() && line.size() + entries[said].size() + 2 <= room; said++)
        line += (said ? "; " : "") + entries[said];
    if (said < entries.size())
        line += words_of("%sand %zu more", said ? "; " : "", entries.size() - said);
    throw Refusal{line};
}

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
    refuse_series(words, entries_of(all, found.empty() ? every : found, request.lists), request);
}

} // namespace volume
