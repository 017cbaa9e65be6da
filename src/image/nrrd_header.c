/* SPDX-License-Identifier: MIT */
#include "image/image_inside.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/choice.h"
#include "base/scan.h"
#include "engine/grid.h"
#include "image/units.h"

/* In the first lines iftty-volume looks for what ITK does not say; rarely are there more. */
enum { FIELDS_MOST = 1000, SKIP_MOST = 1000000000 };

/* By their numbers in the table. */
enum name {
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
    CENTERINGS
};

struct reading {
    struct nrrd_header *out;
    uint64_t seen; /* a bit for each row of the table */
    double direction[3][3], origin[3], spacing[3];
    double sign[3]; /* of steps along its space: to the right, the front and the head */
    double space_mm[3], axis_mm[3]; /* units: of the axes of its space, and of voxels */
};

static bool has(const struct reading *r, enum name name)
{
    return r->seen >> name & 1;
}

/* ---- values ---- */

static void make_small(char *text)
{
    for (; *text; text++)
        *text = *text >= 'A' && *text <= 'Z' ? (char)(*text - 'A' + 'a') : *text;
}

/* A number that nobody reads in two ways, as near as a double comes; 0 keeps its sign. */
static bool take_number(const char **cursor, double *out)
{
    const bool is_negative = **cursor == '-';
    struct decimal decimal;
    if (!decimal_scan(cursor, &decimal))
        return false;
    *out = decimal.digits ? decimal_value(&decimal) : is_negative ? -0.0 : 0.0;
    return true;
}

/* "(-1,0,0)" */
static bool take_vector(const char **cursor, double out[3])
{
    scan_blanks(cursor);
    for (int w = 0; w < 3; w++) {
        if (!scan_text(cursor, w ? "," : "("))
            return false;
        scan_blanks(cursor);
        if (!take_number(cursor, &out[w]))
            return false;
        scan_blanks(cursor);
    }
    return scan_text(cursor, ")");
}

static bool take_vectors(const char *value, int count, double out[][3])
{
    for (int a = 0; a < count; a++)
        if (!take_vector(&value, out[a]))
            return false;
    scan_blanks(&value);
    return *value == '\0';
}

/* Whether these are three words of the choices. */
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

/* The text between the next two quotes, cut to the size of `out`; false where there are none. */
static bool take_quoted(const char **cursor, char *out, size_t size)
{
    scan_blanks(cursor);
    if (!scan_text(cursor, "\""))
        return false;
    const size_t length = strcspn(*cursor, "\"\\");
    snprintf(out, size, "%.*s", (int)(length < size ? length : size), *cursor);
    *cursor += length;
    return scan_text(cursor, "\"");
}

/* "" "a" "b" */
static bool are_quoted(const char *value)
{
    char text[2];
    for (int a = 0; a < 3; a++)
        if (!take_quoted(&value, text, sizeof text))
            return false;
    scan_blanks(&value);
    return *value == '\0';
}

/* "um" "um" "mm" as millimetres. An empty one is 1, as if there were no field: lengths are in
 * millimetres then. False where one is not known. */
static bool take_units(const char *value, double mm[3])
{
    char unit[32];
    for (int a = 0; a < 3; a++) {
        if (!take_quoted(&value, unit, sizeof unit))
            return false;
        mm[a] = *unit ? length_mm(unit) : 1;
        if (mm[a] == 0)
            return false;
    }
    scan_blanks(&value);
    return *value == '\0';
}

/* ---- fields ---- */

static bool read_any(struct reading *r, char *value)
{
    (void)r, (void)value;
    return true;
}

static bool read_type(struct reading *r, char *value)
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
    make_small(value);
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++)
        if (choice_find(row[i].names, value) >= 0) {
            r->out->type = row[i].type;
            return true;
        }
    return false;
}

static bool read_three(struct reading *r, char *value)
{
    (void)r;
    return strcmp(value, "3") == 0;
}

static bool read_sizes(struct reading *r, char *value)
{
    const char *at = value;
    for (int a = 0; a < 3; a++) {
        int64_t side;
        if (!scan_integer(&at, 1, GRID_SIDE_MOST, &side) || (*at && !strchr(" \t", *at)))
            return false;
        scan_blanks(&at);
        r->out->size[a] = (uint32_t)side;
    }
    return *at == '\0' && has(r, DIMENSION);
}

static bool read_encoding(struct reading *r, char *value)
{
    make_small(value);
    const int which = choice_find("raw|gz|gzip", value);
    r->out->is_packed = which > 0;
    return which >= 0;
}

static bool read_endian(struct reading *r, char *value)
{
    make_small(value);
    r->out->big_endian = strcmp(value, "big") == 0;
    return r->out->big_endian || strcmp(value, "little") == 0;
}

static bool read_byte_skip(struct reading *r, char *value)
{
    const char *at = value;
    int64_t bytes;
    if (!scan_integer(&at, 0, SKIP_MOST, &bytes) || *at)
        return false;
    r->out->offset += (uint64_t)bytes;
    return true;
}

/* Of three dimensions all, and three that are the patient's. */
static bool read_space(struct reading *r, char *value)
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
    make_small(value);
    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        if (choice_find(row[i].names, value) < 0)
            continue;
        r->out->knows_place = row[i].is_of_patient;
        memcpy(r->sign, row[i].sign, sizeof r->sign);
        return !has(r, SPACE_DIMENSION);
    }
    return false;
}

static bool has_space(const struct reading *r)
{
    return has(r, SPACE) || has(r, SPACE_DIMENSION);
}

static bool read_space_dimension(struct reading *r, char *value)
{
    return read_three(r, value) && !has(r, SPACE);
}

static bool read_directions(struct reading *r, char *value)
{
    return has(r, DIMENSION) && has_space(r) && take_vectors(value, 3, r->direction);
}

static bool read_origin(struct reading *r, char *value)
{
    return has_space(r) && take_vectors(value, 1, &r->origin);
}

/* Of vectors in voxels, which are none here. */
static bool read_frame(struct reading *r, char *value)
{
    double frame[3][3];
    return has_space(r) && take_vectors(value, 3, frame);
}

static bool read_spacings(struct reading *r, char *value)
{
    const char *at = value;
    for (int a = 0; a < 3; a++) {
        if (!take_number(&at, &r->spacing[a]) || !(r->spacing[a] > 0) ||
            (*at && !strchr(" \t", *at)))
            return false;
        scan_blanks(&at);
    }
    return *at == '\0' && has(r, DIMENSION);
}

static bool read_kinds(struct reading *r, char *value)
{
    return has(r, DIMENSION) && are_words(value, "domain|space|none");
}

static bool read_centers(struct reading *r, char *value)
{
    const bool is_second = has(r, CENTERS) || has(r, CENTERINGS); /* its other name */
    return !is_second && has(r, DIMENSION) && are_words(value, "cell|node|none");
}

static bool read_quoted(struct reading *r, char *value)
{
    return has(r, DIMENSION) && are_quoted(value);
}

static bool read_space_units(struct reading *r, char *value)
{
    return has_space(r) && take_units(value, r->space_mm);
}

static bool read_units(struct reading *r, char *value)
{
    return has(r, DIMENSION) && take_units(value, r->axis_mm);
}

static const struct field {
    const char *name;
    bool (*read)(struct reading *r, char *value);
} fields[] = {
    [TYPE] = {"type", read_type},
    [DIMENSION] = {"dimension", read_three},
    [SIZES] = {"sizes", read_sizes},
    [ENCODING] = {"encoding", read_encoding},
    [ENDIAN] = {"endian", read_endian},
    [BYTE_SKIP] = {"byte skip", read_byte_skip},
    [SPACE] = {"space", read_space},
    [SPACE_DIMENSION] = {"space dimension", read_space_dimension},
    [DIRECTIONS] = {"space directions", read_directions},
    [ORIGIN] = {"space origin", read_origin},
    [FRAME] = {"measurement frame", read_frame},
    [SPACE_UNITS] = {"space units", read_space_units},
    [SPACINGS] = {"spacings", read_spacings},
    [UNITS] = {"units", read_units},
    [CENTERS] = {"centers", read_centers},
    [CENTERINGS] = {"centerings", read_centers},
    {"kinds", read_kinds},
    {"labels", read_quoted},
    {"content", read_any},
    {"number", read_any},
    {"min", read_any},
    {"max", read_any},
    {"sample units", read_any},
};
enum { FIELDS = sizeof fields / sizeof fields[0] };

/* -1 for none. */
static int field_named(const char *name)
{
    for (int i = 0; i < FIELDS; i++)
        if (strcmp(fields[i].name, name) == 0)
            return i;
    return -1;
}

/* ---- lines ---- */

/* "NAME: VALUE" */
static bool read_field(struct reading *r, char *name, char *value, unsigned line)
{
    make_small(name);
    const int which = field_named(name);
    if (which < 0 || r->seen >> which & 1 || line > FIELDS_MOST)
        return false;
    value += strspn(value, " \t");
    if (!fields[which].read(r, value))
        return false;
    r->seen |= UINT64_C(1) << which;
    return true;
}

/* "KEY:=VALUE", of any words; but iftty-volume looks for some fields by what comes before the first
 * colon, and would take such a key for one. */
static bool is_free_key(char *key)
{
    static const char others[] = "line skip|lineskip|byteskip|data file|datafile";
    key += strspn(key, " \t");
    size_t length = strcspn(key, ":");
    while (length > 0 && strchr(" \t", key[length - 1]))
        length--;
    key[length] = '\0';
    make_small(key);
    return field_named(key) < 0 && choice_find(others, key) < 0;
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
    return read_field(r, text, colon + 2, line);
}

/* The line at *at, without its end, and *at after it; NULL where it has in it what ends lines for
 * some. */
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

/* ITK's spacing and direction, multiplied again, in the same order: its world runs to the left and
 * to the back. */
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
    const double *mm = r->space_mm; /* without a place a row is of no axis of the space */
    return out->knows_place || (mm[0] == mm[1] && mm[1] == mm[2]);
}

static bool place(struct reading *r)
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
    bytes[length - 1] = '\0'; /* of the line that is empty */
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
    return is_whole && !(out->is_packed && has(&r, BYTE_SKIP)) && place(&r);
}
