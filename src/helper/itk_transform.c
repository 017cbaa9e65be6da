/* SPDX-License-Identifier: MIT */
#include "helper/itk_transform.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "base/scan.h"
#include "image/volume_format.h"

enum {
    NUMBERS_MOST = 16, /* parameters */
    NAME_MOST = 80,
    PARTS_MOST = 64 /* parts of a composite */
};

/* ---- parameters ---- */

struct part {
    char name[NAME_MOST];
    double number[NUMBERS_MOST], fixed[NUMBERS_MOST];
    unsigned numbers, fixeds;
};

/* Compute the linear part of the map from the parameters; false if they are invalid. */
typedef bool linear_part(struct affine *out, const struct part *part);

static bool linear_matrix(struct affine *out, const struct part *part)
{
    for (int i = 0; i < 9; i++)
        out->m[i / 3][i % 3] = part->number[i];
    return true;
}

static bool linear_euler(struct affine *out, const struct part *part)
{
    double c[3], s[3];
    for (int a = 0; a < 3; a++) {
        c[a] = cos(part->number[a]);
        s[a] = sin(part->number[a]);
    }
    const struct affine x = {{{1, 0, 0}, {0, c[0], -s[0]}, {0, s[0], c[0]}}};
    const struct affine y = {{{c[1], 0, s[1]}, {0, 1, 0}, {-s[1], 0, c[1]}}};
    const struct affine z = {{{c[2], -s[2], 0}, {s[2], c[2], 0}, {0, 0, 1}}};
    const bool is_zyx = part->fixeds > 3 && part->fixed[3] != 0;
    affine_compose(out, &z, is_zyx ? &y : &x);
    affine_compose(out, out, is_zyx ? &x : &y);
    return true;
}

static bool linear_versor(struct affine *out, const struct part *part)
{
    const double x = part->number[0], y = part->number[1], z = part->number[2];
    const double squares = x * x + y * y + z * z, w = sqrt(fmax(1 - squares, 0));
    *out = (struct affine){{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
                            {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
                            {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}}};
    return squares <= 1 + 1e-9;
}

static bool linear_similarity(struct affine *out, const struct part *part)
{
    const bool is_versor = linear_versor(out, part);
    for (int i = 0; i < 9; i++)
        out->m[i / 3][i % 3] *= part->number[6];
    return is_versor;
}

/* `t` is the index of the translation; the number of fixed parameters is `fixeds` to `fixeds_most`.
 */
static const struct kind {
    const char *name;
    unsigned numbers, t, fixeds, fixeds_most;
    linear_part *linear; /* NULL: the identity */
} kinds[] = {
    {"AffineTransform", 12, 9, 3, 3, linear_matrix},
    {"MatrixOffsetTransformBase", 12, 9, 3, 3, linear_matrix},
    {"Euler3DTransform", 6, 3, 3, 4, linear_euler},
    {"VersorRigid3DTransform", 6, 3, 3, 3, linear_versor},
    {"Similarity3DTransform", 7, 3, 3, 3, linear_similarity},
    {"TranslationTransform", 3, 0, 0, 0, NULL},
};
static const char COMPOSITE[] = "CompositeTransform";

/* Length of the name before "_double_3_3" or "_float_3_3"; 0 without such an ending. */
static size_t name_length(const char *name)
{
    static const char *const endings[] = {"_double_3_3", "_float_3_3"};
    const size_t length = strlen(name);
    for (int i = 0; i < 2; i++) {
        const size_t ending = strlen(endings[i]);
        if (length > ending && strcmp(name + length - ending, endings[i]) == 0)
            return length - ending;
    }
    return 0;
}

static bool is_named(const struct part *part, const char *name)
{
    const size_t length = name_length(part->name);
    return length == strlen(name) && memcmp(part->name, name, length) == 0;
}

static enum err take_part(struct affine *out, const struct part *part, struct fault *fault)
{
    const struct kind *kind = NULL;
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        kind = is_named(part, kinds[i].name) ? &kinds[i] : kind;
    if (!kind)
        return fault_set(fault, ERR_INPUT,
                         "it holds a \"%s\"; supported are affine transforms of three "
                         "dimensions (AffineTransform, MatrixOffsetTransformBase, Euler3D, "
                         "VersorRigid3D, Similarity3D, Translation)",
                         part->name);
    if (part->numbers != kind->numbers || part->fixeds < kind->fixeds ||
        part->fixeds > kind->fixeds_most)
        return fault_set(fault, ERR_INPUT,
                         "its %s has %u parameters and %u fixed ones; expected %u and %u",
                         kind->name, part->numbers, part->fixeds, kind->numbers, kind->fixeds);
    affine_identity(out);
    if (kind->linear && !kind->linear(out, part))
        return fault_set(fault, ERR_INPUT, "its %s holds no turn: a vector longer than 1",
                         kind->name);
    for (int i = 0; i < 3; i++) {
        const double centre = kind->fixeds ? part->fixed[i] : 0;
        out->m[i][3] = part->number[kind->t + (unsigned)i] + centre;
        for (int j = 0; j < 3; j++)
            out->m[i][3] -= out->m[i][j] * (kind->fixeds ? part->fixed[j] : 0);
    }
    return OK;
}

/* ---- composites ---- */

struct reading {
    struct affine *out;
    struct buf *kind;
    unsigned parts;
    bool is_composite;
};

/* Each part is applied before the earlier ones. */
static enum err add_part(struct reading *r, const struct part *part, struct fault *fault)
{
    struct affine one;
    if (is_named(part, COMPOSITE) && !r->is_composite && r->parts == 0) {
        r->is_composite = true;
        buf_add_text(r->kind, COMPOSITE);
        return OK;
    }
    if (r->parts > 0 && !r->is_composite)
        return fault_set(fault, ERR_INPUT,
                         "it holds more than one transform, and nothing says which comes first; "
                         "expected one, or a CompositeTransform");
    if (r->parts >= PARTS_MOST)
        return fault_set(fault, ERR_LIMIT, "its composite has more than %d transforms", PARTS_MOST);
    TRY(take_part(&one, part, fault));
    if (!r->is_composite)
        buf_printf(r->kind, "%.*s", (int)name_length(part->name), part->name);
    affine_compose(r->out, r->out, &one);
    r->parts++;
    return OK;
}

/* ---- text ---- */

static bool is_line_end(char c)
{
    return c == '\n' || c == '\r' || c == '\0';
}

static bool scan_numbers(const char **at, double number[NUMBERS_MOST], unsigned *count)
{
    for (*count = 0;;) {
        struct decimal decimal;
        scan_blanks(at);
        if (is_line_end(**at))
            return true;
        if (*count == NUMBERS_MOST || !decimal_scan(at, &decimal) ||
            !(is_line_end(**at) || **at == ' ' || **at == '\t'))
            return false;
        number[(*count)++] = decimal_value(&decimal);
    }
}

static void scan_name(const char **at, char name[NAME_MOST])
{
    size_t n = 0;
    scan_blanks(at);
    for (; !is_line_end(**at) && **at != ' '; ++*at)
        if (n + 1 < NAME_MOST)
            name[n++] = **at;
    name[n] = '\0';
    scan_blanks(at);
}

static enum err read_text(struct reading *r, const char *text, struct fault *fault)
{
    struct part part = {.name = ""};
    enum err err = OK;
    unsigned line = 1;
    for (const char *at = text; !err; line++) {
        bool is_fine = true;
        if (!*at || scan_text(&at, "Transform:")) {
            if (*part.name)
                err = add_part(r, &part, fault);
            if (err || !*at)
                break;
            part = (struct part){.name = ""};
            scan_name(&at, part.name);
        } else if (scan_text(&at, "Parameters:")) {
            is_fine = scan_numbers(&at, part.number, &part.numbers);
        } else if (scan_text(&at, "FixedParameters:")) {
            is_fine = scan_numbers(&at, part.fixed, &part.fixeds);
        } else if (*at == '#') {
            at += strcspn(at, "\r\n");
        }
        scan_blanks(&at);
        if (!is_fine || !is_line_end(*at))
            return fault_set(fault, ERR_INPUT,
                             "line %u is not a line of an affine transform of ITK", line);
        at += *at == '\r';
        at += *at == '\n';
    }
    return err;
}

/* ---- MATLAB ---- */

enum { HEADER = 20, BIG_ENDIAN_TYPE = 1000, SINGLE_TYPE = 10, ROWS_TYPE = 100 };

/* Parse the next matrix, a row or a column, and return its length; 0 on failure. */
static size_t take_matrix(char name[NAME_MOST], double number[NUMBERS_MOST], unsigned *numbers,
                          const char *bytes, size_t length)
{
    if (length < HEADER)
        return 0;
    const bool is_big = bits_get(bytes, 4, false) > UINT16_MAX;
    const uint64_t type = bits_get(bytes, 4, is_big), little = type % BIG_ENDIAN_TYPE;
    const uint64_t rows = bits_get(bytes + 4, 4, is_big), columns = bits_get(bytes + 8, 4, is_big);
    const uint64_t letters = bits_get(bytes + 16, 4, is_big);
    const unsigned width = little % ROWS_TYPE == SINGLE_TYPE ? 4 : 8;
    const uint8_t *at = (const uint8_t *)bytes + HEADER + letters;
    if (type != little + (is_big ? BIG_ENDIAN_TYPE : 0) ||
        (little != 0 && little != SINGLE_TYPE && little != ROWS_TYPE &&
         little != ROWS_TYPE + SINGLE_TYPE) ||
        bits_get(bytes + 12, 4, is_big) != 0 || letters < 2 || letters > NAME_MOST)
        return 0;
    if (rows > NUMBERS_MOST || columns > NUMBERS_MOST || (rows > 1 && columns > 1))
        return 0;
    *numbers = (unsigned)(rows * columns);
    if (length < HEADER + letters + width * *numbers ||
        memchr(bytes + HEADER, '\0', letters) != bytes + HEADER + letters - 1)
        return 0;
    memcpy(name, bytes + HEADER, letters);
    for (unsigned i = 0; i < *numbers; i++) {
        number[i] = real_of_bits(bits_get(at + width * i, width, is_big), width);
        if (!isfinite(number[i]))
            return 0;
    }
    return HEADER + letters + width * *numbers;
}

static enum err read_matrices(struct reading *r, const char *bytes, size_t length,
                              struct fault *fault)
{
    for (size_t at = 0, n; at < length; at += n) {
        struct part part;
        char fixed[NAME_MOST];
        const size_t first =
            take_matrix(part.name, part.number, &part.numbers, bytes + at, length - at);
        const size_t second = first ? take_matrix(fixed, part.fixed, &part.fixeds,
                                                  bytes + at + first, length - at - first)
                                    : 0;
        n = first + second;
        if (!second || strcmp(fixed, "fixed") != 0)
            return fault_set(fault, ERR_INPUT,
                             "it is damaged, or no affine transform, from byte %zu on", at);
        TRY(add_part(r, &part, fault));
    }
    return OK;
}

enum err itk_transform_read(struct affine *out, struct buf *kind, const char *bytes, size_t length,
                            struct fault *fault)
{
    struct affine found;
    struct reading reading = {.out = &found, .kind = kind};
    struct part part;
    const char *text = bytes;
    affine_identity(&found);
    if (strlen(bytes) == length && scan_text(&text, "#Insight Transform File V1.0"))
        TRY(read_text(&reading, bytes, fault));
    else if (take_matrix(part.name, part.number, &part.numbers, bytes, length) > 0 &&
             name_length(part.name) > 0)
        TRY(read_matrices(&reading, bytes, length, fault));
    else
        return fault_set(fault, ERR_INPUT,
                         "it is no affine transform that is known here: ITK's as text or .mat, or "
                         "\"fsl:FILE\" for a matrix of FLIRT");
    if (reading.parts == 0)
        return fault_set(fault, ERR_INPUT, "it holds no transform");
    if (kind->failed)
        return fault_memory(fault, "the name of a transform");
    *out = found;
    return OK;
}
