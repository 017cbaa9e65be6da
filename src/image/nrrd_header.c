/* SPDX-License-Identifier: MIT */
#include "image/image_inside.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/choice.h"
#include "base/scan.h"
#include "engine/grid.h"
#include "image/reader_common.h"

/* iftty-volume looks for fields that ITK does not report in the first lines only; few headers have
 * more. */
enum { FIELDS_MOST = 1000, SKIP_MOST = 1000000000 };

/* The fields that are read, by their number in FIELD_NAMES. FREE is the first one whose value is
 * not read. */
#define FIELD_NAMES                                                                                \
    "type|dimension|sizes|encoding|endian|byte skip|space|space dimension|space directions|"       \
    "space origin|measurement frame|space units|spacings|units|centers|centerings|kinds|labels|"   \
    "content|number|min|max|sample units"
enum field {
    TYPE,
    DIMENSION,
    SIZES,
    ENCODING,
    ENDIAN,
    BYTE_SKIP,
    SPACE,
    SPACE_DIMENSION,
    DIRECTIONS,
    ORIGIN,
    FRAME,
    SPACE_UNITS,
    SPACINGS,
    UNITS,
    CENTERS,
    CENTERINGS, /* another name of CENTERS */
    KINDS,
    LABELS,
    FREE
};

struct reading {
    struct nrrd_header *out;
    uint64_t seen; /* a bit for each field */
    double direction[3][3], origin[3], spacing[3];
    double sign[3]; /* sign of steps along its space: to the right, the front and the head */
    double space_mm[3], axis_mm[3]; /* units: along the axes of its space, and of voxels */
};

static bool has(const struct reading *r, enum field field)
{
    return r->seen >> field & 1;
}

static bool has_space(const struct reading *r)
{
    return has(r, SPACE) || has(r, SPACE_DIMENSION);
}

/* ---- values ---- */

static void make_small(char *text)
{
    for (; *text; text++)
        *text = *text >= 'A' && *text <= 'Z' ? (char)(*text - 'A' + 'a') : *text;
}

/* Read a number that has one meaning for every reader, as the nearest double; 0 keeps its sign. */
static bool take_number(const char **cursor, double *out)
{
    const bool is_negative = **cursor == '-';
    struct decimal decimal;
    if (!decimal_scan(cursor, &decimal))
        return false;
    *out = decimal.digits ? decimal_value(&decimal) : is_negative ? -0.0 : 0.0;
    return true;
}

/* Read vectors such as "(-1,0,0)", with blanks between them. */
static bool take_vectors(const char *value, int count, double out[][3])
{
    for (int a = 0; a < count; a++) {
        scan_blanks(&value);
        for (int w = 0; w < 3; w++) {
            if (!scan_text(&value, w ? "," : "("))
                return false;
            scan_blanks(&value);
            if (!take_number(&value, &out[a][w]))
                return false;
            scan_blanks(&value);
        }
        if (!scan_text(&value, ")"))
            return false;
    }
    scan_blanks(&value);
    return *value == '\0';
}

/* Read three numbers, sides or distances, with blanks between them. */
static bool take_sizes(const char *value, uint32_t out[3])
{
    for (int a = 0; a < 3; a++) {
        int64_t side;
        if (!scan_integer(&value, 1, GRID_SIDE_MOST, &side) || (*value && !strchr(" \t", *value)))
            return false;
        scan_blanks(&value);
        out[a] = (uint32_t)side;
    }
    return *value == '\0';
}

static bool take_spacings(const char *value, double out[3])
{
    for (int a = 0; a < 3; a++) {
        if (!take_number(&value, &out[a]) || !(out[a] > 0) || (*value && !strchr(" \t", *value)))
            return false;
        scan_blanks(&value);
    }
    return *value == '\0';
}

/* Return true for three words of the choices. */
static bool are_words(const char *value, const char *choices)
{
    for (int a = 0; a < 3; a++) {
        char word[16] = "";
        const size_t length = strcspn(value, " \t");
        if (length < sizeof word)
            memcpy(word, value, length);
        if (choice_find(choices, word) < 0)
            return false;
        value += length;
        scan_blanks(&value);
    }
    return *value == '\0';
}

/* Read three quoted texts, "um" "um" "mm". If `mm` is not NULL they are units of length, in
 * millimetres; an empty one is 1, as without the field: lengths are in millimetres then. False for
 * other values and unknown units. */
static bool take_quoted(const char *value, double mm[3])
{
    for (int a = 0; a < 3; a++) {
        char unit[32];
        scan_blanks(&value);
        if (!scan_text(&value, "\""))
            return false;
        const size_t length = strcspn(value, "\"\\");
        snprintf(unit, sizeof unit, "%.*s", (int)(length < sizeof unit ? length : sizeof unit),
                 value);
        value += length;
        if (!scan_text(&value, "\""))
            return false;
        if (mm)
            mm[a] = *unit ? length_mm(unit) : 1;
        if (mm && mm[a] == 0)
            return false;
    }
    scan_blanks(&value);
    return *value == '\0';
}

/* ---- fields ---- */

static bool read_type(enum voxel_type *type, const char *value)
{
    static const struct {
        const char *names;
        enum voxel_type type;
    } row[] = {
        {"signed char|int8|int8_t", VOXEL_INT8},
        {"uchar|unsigned char|uint8|uint8_t", VOXEL_UINT8},
        {"short|short int|signed short|signed short int|int16|int16_t", VOXEL_INT16},
        {"ushort|unsigned short|unsigned short int|uint16|uint16_t", VOXEL_UINT16},
        {"int|signed int|int32|int32_t", VOXEL_INT32},
        {"uint|unsigned int|uint32|uint32_t", VOXEL_UINT32},
        {"longlong|long long|long long int|signed long long|signed long long int|int64|int64_t",
         VOXEL_INT64},
        {"ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t", VOXEL_UINT64},
        {"float", VOXEL_FLOAT32},
        {"double", VOXEL_FLOAT64},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++)
        if (choice_find(row[i].names, value) >= 0) {
            *type = row[i].type;
            return true;
        }
    return false;
}

/* Spaces of three dimensions; three of them are the patient's. */
static bool read_space(struct reading *r, const char *value)
{
    static const struct {
        const char *names;
        bool is_of_patient;
        double sign[3];
    } row[] = {
        {"ras|right-anterior-superior", true, {1, 1, 1}},
        {"lps|left-posterior-superior", true, {-1, -1, 1}},
        {"las|left-anterior-superior", true, {-1, 1, 1}},
        {"scanner-xyz|3d-right-handed|3d-left-handed", false, {1, 1, 1}},
    };
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        if (choice_find(row[i].names, value) < 0)
            continue;
        r->out->knows_place = row[i].is_of_patient;
        memcpy(r->sign, row[i].sign, sizeof r->sign);
        return !has(r, SPACE_DIMENSION);
    }
    return false;
}

/* Read the value of a field; false if it is left to ITK, also because the field comes too early. */
static bool read_value(struct reading *r, int field, char *value)
{
    struct nrrd_header *out = r->out;
    double frame[3][3]; /* for vectors in voxels, which are not read */
    int64_t bytes;
    int which;
    const char *at = value;
    if (field == TYPE || (field >= ENCODING && field <= SPACE))
        make_small(value);
    const bool needs_space = (field >= DIRECTIONS && field <= FRAME) || field == SPACE_UNITS;
    const bool needs_dimension =
        field == SIZES || field == DIRECTIONS || (field >= SPACINGS && field < FREE);
    if ((needs_space && !has_space(r)) || (needs_dimension && !has(r, DIMENSION)))
        return false;
    switch (field) {
    case TYPE:
        return read_type(&out->type, value);
    case DIMENSION:
        return strcmp(value, "3") == 0;
    case SIZES:
        return take_sizes(value, out->size);
    case ENCODING:
        which = choice_find("raw|gz|gzip", value);
        out->is_packed = which > 0;
        return which >= 0;
    case ENDIAN:
        which = choice_find("little|big", value);
        out->big_endian = which > 0;
        return which >= 0;
    case BYTE_SKIP:
        if (!scan_integer(&at, 0, SKIP_MOST, &bytes) || *at)
            return false;
        out->offset += (uint64_t)bytes;
        return true;
    case SPACE:
        return read_space(r, value);
    case SPACE_DIMENSION:
        return strcmp(value, "3") == 0 && !has(r, SPACE);
    case DIRECTIONS:
        return take_vectors(value, 3, r->direction);
    case ORIGIN:
        return take_vectors(value, 1, &r->origin);
    case FRAME:
        return take_vectors(value, 3, frame);
    case SPACE_UNITS:
        return take_quoted(value, r->space_mm);
    case SPACINGS:
        return take_spacings(value, r->spacing);
    case UNITS:
        return take_quoted(value, r->axis_mm);
    case CENTERS:
    case CENTERINGS:
        return !has(r, CENTERS) && !has(r, CENTERINGS) && are_words(value, "cell|node|none");
    case KINDS:
        return are_words(value, "domain|space|none");
    case LABELS:
        return take_quoted(value, NULL);
    default:
        return true;
    }
}

/* ---- lines ---- */

/* "KEY:=VALUE", of any words; but iftty-volume looks for some fields by the text before the first
 * colon, and would mistake such a key for one. */
static bool is_free_key(char *key)
{
    static const char names[] = FIELD_NAMES "|line skip|lineskip|byteskip|data file|datafile";
    key += strspn(key, " \t");
    size_t length = strcspn(key, ":");
    while (length > 0 && strchr(" \t", key[length - 1]))
        length--;
    key[length] = '\0';
    make_small(key);
    return choice_find(names, key) < 0;
}

static bool read_line(struct reading *r, char *text, unsigned line)
{
    char *const colon = strstr(text, ": "), *const equals = strstr(text, ":=");
    if (*text == '#')
        return true;
    if (equals && (!colon || equals < colon))
        return is_free_key(text);
    if (!colon)
        return false;
    *colon = '\0';
    make_small(text);
    const int field = choice_find(FIELD_NAMES, text);
    char *value = colon + 2;
    value += strspn(value, " \t");
    if (field < 0 || r->seen >> field & 1 || line > FIELDS_MOST || !read_value(r, field, value))
        return false;
    r->seen |= UINT64_C(1) << field;
    return true;
}

/* Return the line at *at, without its end, and set *at after it; NULL for a line that has another
 * end for some readers. */
static char *next_line(char **at)
{
    char *const line = *at, *const end = strchr(line, '\n');
    if (!end)
        return NULL;
    *at = end + 1;
    end[end > line && end[-1] == '\r' ? -1 : 0] = '\0';
    return strchr(line, '\r') ? NULL : line;
}

/* ---- the whole ---- */

/* Multiply ITK's spacing and direction again, in the same order: its world runs to the left and to
 * the back. */
static bool place_directions(struct reading *r)
{
    struct nrrd_header *out = r->out;
    for (int a = 0; a < 3; a++) {
        const double *along = r->direction[a];
        double sum = 0;
        for (int w = 0; w < 3; w++)
            sum += along[w] * along[w];
        const double length = sqrt(sum), inverse = 1.0 / length;
        if (!(length > 1e-9 && length < 1e9))
            return false;
        for (int w = 0; w < 3; w++)
            out->to_mm[w][a] = out->knows_place ? r->sign[w] * (inverse * along[w]) * length
                               : a == w         ? length
                                                : 0;
    }
    for (int w = 0; w < 3; w++) {
        const double sign = has(r, ORIGIN) ? r->sign[w] : w < 2 ? -1 : 1;
        out->to_mm[w][3] = out->knows_place ? sign * r->origin[w] : 0;
        for (int i = 0; i < 4; i++)
            out->to_mm[w][i] *= r->space_mm[w];
    }
    const double *mm = r->space_mm; /* without a place the rows belong to no axis */
    return out->knows_place || (mm[0] == mm[1] && mm[1] == mm[2]);
}

static bool set_place(struct reading *r)
{
    struct nrrd_header *out = r->out;
    if (has(r, DIRECTIONS)) {
        out->knows_spacing = true;
        return !has(r, SPACINGS) && !has(r, UNITS) && place_directions(r);
    }
    out->knows_place = false;
    out->knows_spacing = has(r, SPACINGS);
    for (int a = 0; a < 3; a++)
        out->to_mm[a][a] = has(r, SPACINGS) ? r->spacing[a] * r->axis_mm[a] : 1;
    return !has(r, SPACINGS) || !has_space(r);
}

size_t nrrd_header_length(const char *bytes, size_t length)
{
    const char *at = bytes, *const end = bytes + length;
    while ((at = memchr(at, '\n', (size_t)(end - at)))) {
        at++;
        const size_t left = (size_t)(end - at);
        if (left > 0 && *at == '\n')
            return (size_t)(at + 1 - bytes);
        if (left > 1 && at[0] == '\r' && at[1] == '\n')
            return (size_t)(at + 2 - bytes);
    }
    return 0;
}

bool nrrd_header_read(struct nrrd_header *out, char *bytes, size_t length)
{
    struct reading r = {.out = out, .space_mm = {1, 1, 1}, .axis_mm = {1, 1, 1}};
    char *at = bytes, *line;
    *out = (struct nrrd_header){.offset = length};
    if (length < 2 || memchr(bytes, '\0', length))
        return false;
    bytes[length - 1] = '\0'; /* the end of the empty line */
    line = next_line(&at);
    if (!line || strncmp(line, NRRD_MAGIC, sizeof NRRD_MAGIC - 1) != 0 ||
        choice_find("1|2|3|4|5", line + sizeof NRRD_MAGIC - 1) < 0)
        return false;
    for (unsigned number = 2; *at && strcmp(at, "\r") != 0; number++) {
        line = next_line(&at);
        if (!line || !read_line(&r, line, number))
            return false;
    }
    const bool is_whole = has(&r, TYPE) && has(&r, SIZES) && has(&r, ENCODING) &&
                          (has(&r, ENDIAN) || voxel_bytes(out->type) == 1);
    return is_whole && !(out->is_packed && has(&r, BYTE_SKIP)) && set_place(&r);
}
