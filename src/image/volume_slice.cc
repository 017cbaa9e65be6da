/* DICOM: what the header of a file says of its slices. GDCM reads it. */
#include "image/volume_dicom.hh"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <istream>

#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>
#include <gdcmUIDs.h>

namespace volume
{

static const gdcm::Tag frames_tag(0x0028, 0x0008), shared_tag(0x5200, 0x9229),
    each_tag(0x5200, 0x9230), detector_tag(0x0054, 0x0022), offsets_tag(0x3004, 0x000c);

const gdcm::ByteValue *value_of(const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    return set.FindDataElement(tag) ? set.GetDataElement(tag).GetByteValue() : nullptr;
}

bool take_bytes(void *out, size_t length, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    const gdcm::ByteValue *value = value_of(set, tag);
    if (!value || value->GetLength() != length)
        return false;
    std::memcpy(out, value->GetPointer(), length);
    return true;
}

std::string text_of(const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    const gdcm::ByteValue *value = value_of(set, tag);
    std::string text = value ? std::string(value->GetPointer(), value->GetLength()) : "";
    while (!text.empty() && (text.back() == ' ' || text.back() == '\0'))
        text.pop_back();
    return text;
}

/* Takes up to `most` decimal numbers; how many there were, of those that are finite. */
size_t decimals_of(const gdcm::DataSet &set, const gdcm::Tag &tag, double *out, size_t most)
{
    const std::string text = text_of(set, tag);
    const char *at = text.c_str();
    size_t count = 0;
    for (char *end; count < most && *at; at = *end == '\\' ? end + 1 : "") {
        const double number = std::strtod(at, &end);
        if (end == at || !std::isfinite(number))
            break;
        out[count++] = number;
        while (*end == ' ')
            end++;
    }
    return count;
}

void take_decimal(double &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    double number;
    if (decimals_of(set, tag, &number, 1) == 1)
        out = number;
}

void take_integer(int &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    double number;
    if (decimals_of(set, tag, &number, 1) == 1 && std::fabs(number) < 1e9)
        out = static_cast<int>(number);
}

void take_binary(unsigned &out, const gdcm::DataSet &set, const gdcm::Tag &tag)
{
    uint16_t half;
    uint32_t whole;
    if (take_bytes(&half, sizeof half, set, tag))
        out = half;
    else if (take_bytes(&whole, sizeof whole, set, tag))
        out = whole;
}

/* Six numbers that are two unit vectors at right angles, within what decimals lose. */
bool are_axes(const double axis[6])
{
    double one = 0, two = 0, dot = 0;
    for (int w = 0; w < 3; w++) {
        one += axis[w] * axis[w];
        two += axis[w + 3] * axis[w + 3];
        dot += axis[w] * axis[w + 3];
    }
    return std::fabs(one - 1) < 0.01 && std::fabs(two - 1) < 0.01 && std::fabs(dot) < 0.01;
}

/* What a data set says of a slice; of an enhanced image, one of its groups of functions. */
void take_place(Slice &slice, const gdcm::DataSet &set)
{
    double number[6];
    if (decimals_of(set, gdcm::Tag(0x0020, 0x0032), number, 3) == 3) {
        std::copy(number, number + 3, slice.position);
        slice.has_position = true;
    }
    if (decimals_of(set, gdcm::Tag(0x0020, 0x0037), number, 6) == 6 && are_axes(number)) {
        std::copy(number, number + 6, slice.axis);
        slice.has_axes = true;
    }
    if (decimals_of(set, gdcm::Tag(0x0028, 0x0030), number, 2) == 2 && number[0] > 0 &&
        number[1] > 0)
        std::copy(number, number + 2, slice.spacing);
    take_decimal(slice.between, set, gdcm::Tag(0x0018, 0x0088));
    take_decimal(slice.thickness, set, gdcm::Tag(0x0018, 0x0050));
    take_decimal(slice.slope, set, gdcm::Tag(0x0028, 0x1053));
    take_decimal(slice.intercept, set, gdcm::Tag(0x0028, 0x1052));
    take_decimal(slice.slope, set, gdcm::Tag(0x3004, 0x000e)); /* of a dose */
    take_integer(slice.time, set, gdcm::Tag(0x0020, 0x0100));
    unsigned time = 0;
    take_binary(time, set, gdcm::Tag(0x0020, 0x9128));
    if (time)
        slice.time = static_cast<int>(time);
}

/* The first item of a sequence, or item `number`; empty where there is none. */
gdcm::DataSet item_of(const gdcm::DataSet &set, const gdcm::Tag &tag, size_t number)
{
    gdcm::SmartPointer<gdcm::SequenceOfItems> items;
    if (set.FindDataElement(tag))
        items = set.GetDataElement(tag).GetValueAsSQ();
    if (!items || number >= items->GetNumberOfItems())
        return {};
    return items->GetItem(number + 1).GetNestedDataSet();
}

void take_functions(Slice &slice, const gdcm::DataSet &group)
{
    for (const gdcm::Tag &tag :
         {gdcm::Tag(0x0020, 0x9113), gdcm::Tag(0x0020, 0x9116), gdcm::Tag(0x0028, 0x9110),
          gdcm::Tag(0x0028, 0x9145), gdcm::Tag(0x0020, 0x9111)})
        take_place(slice, item_of(group, tag, 0));
}

void take_pixels(Slice &slice, const gdcm::DataSet &set)
{
    unsigned is_signed = 0;
    take_binary(slice.rows, set, gdcm::Tag(0x0028, 0x0010));
    take_binary(slice.columns, set, gdcm::Tag(0x0028, 0x0011));
    take_binary(slice.samples, set, gdcm::Tag(0x0028, 0x0002));
    take_binary(slice.bits, set, gdcm::Tag(0x0028, 0x0100));
    take_binary(is_signed, set, gdcm::Tag(0x0028, 0x0103));
    take_binary(slice.stored, set, gdcm::Tag(0x0028, 0x0101));
    take_binary(slice.high, set, gdcm::Tag(0x0028, 0x0102));
    slice.is_signed = is_signed == 1;
    int frames = 1;
    take_integer(frames, set, frames_tag);
    slice.frames = static_cast<unsigned>(std::min(std::max(frames, 1), 65535));
    const std::string colours = text_of(set, gdcm::Tag(0x0028, 0x0004));
    slice.is_inverse = colours == "MONOCHROME1";
    if (!colours.empty() && colours.compare(0, 10, "MONOCHROME") != 0)
        slice.samples = 3; /* a palette */
}

/* The order in which those of one place, or without a place, come. */
void take_order(Slice &slice, const gdcm::DataSet &set)
{
    slice.series = text_of(set, gdcm::Tag(0x0020, 0x000e));
    slice.object = text_of(set, gdcm::Tag(0x0008, 0x0018));
    slice.modality = text_of(set, gdcm::Tag(0x0008, 0x0060));
    take_integer(slice.series_number, set, gdcm::Tag(0x0020, 0x0011));
    take_integer(slice.acquisition, set, gdcm::Tag(0x0020, 0x0012));
    take_integer(slice.instance, set, gdcm::Tag(0x0020, 0x0013));
    take_integer(slice.echo, set, gdcm::Tag(0x0018, 0x0086));
}

void normal_of(double normal[3], const double axis[6])
{
    for (int w = 0; w < 3; w++) {
        const int u = (w + 1) % 3, v = (w + 2) % 3;
        normal[w] = axis[u] * axis[3 + v] - axis[v] * axis[3 + u];
    }
}

/* The frames of a file that holds several. Without a place of their own they have none. */
void add_frames(std::vector<Slice> &slices, const Slice &first, const gdcm::DataSet &set)
{
    Slice common = first;
    take_functions(common, item_of(set, shared_tag, 0));
    std::vector<double> offsets(common.frames + size_t{1}); /* one more, which would be too many */
    const bool has_offsets =
        common.has_position && common.has_axes &&
        decimals_of(set, offsets_tag, offsets.data(), offsets.size()) == common.frames;
    double normal[3];
    normal_of(normal, common.axis);
    common.has_position = false;
    for (unsigned f = 0; f < first.frames; f++) {
        Slice slice = common;
        slice.frame = f;
        take_functions(slice, item_of(set, each_tag, f));
        for (int w = 0; w < 3 && has_offsets; w++)
            slice.position[w] += normal[w] * (offsets[f] - offsets[0]);
        slice.has_position |= has_offsets;
        slices.push_back(slice);
    }
}

bool scan(std::vector<Slice> &slices, const std::string &path, bool splits_mosaics)
{
    static const gdcm::Tag pixels(0x7fe0, 0x0010);
    const auto in = open_bytes(path);
    gdcm::Reader reader;
    if (!in)
        return false;
    reader.SetStream(*in);
    if (!reader.ReadUpToTag(pixels, {pixels}))
        return false;
    const gdcm::DataSet &set = reader.GetFile().GetDataSet();
    Slice slice;
    slice.path = path;
    take_pixels(slice, set);
    if (slice.rows == 0 || slice.columns == 0)
        return true;
    take_order(slice, set);
    take_words(slice, set);
    take_place(slice, set);
    take_place(slice, item_of(set, detector_tag, 0));
    find_pixels(slice, *in, reader.GetFile().GetHeader().GetDataSetTransferSyntax());
    if (splits_mosaics && slice.frames == 1 && add_mosaic(slices, slice, set))
        return true;
    if (slice.frames > 1 || set.FindDataElement(each_tag))
        add_frames(slices, slice, set);
    else
        slices.push_back(slice);
    return true;
}

bool is_of_images(const std::string &path)
{
    static const gdcm::Tag class_tag(0x0002, 0x0002), end_tag(0x0008, 0x0000);
    const auto in = open_bytes(path);
    gdcm::Reader reader;
    gdcm::UIDs uid;
    if (!in)
        return false;
    reader.SetStream(*in);
    return reader.ReadUpToTag(end_tag, {}) &&
           uid.SetFromUID(text_of(reader.GetFile().GetHeader(), class_tag).c_str()) &&
           std::strstr(uid.GetName(), "Image Storage");
}

} // namespace volume
