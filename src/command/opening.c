#include "command/opening.h"

#include <string.h>

#include "base/choice.h"
#include "base/scan.h"
#include "image/volume_format.h"

static const char RAW[] = "raw:";
enum { SERIES_MOST = 100000 };

/* "X,Y,Z": three numbers of at least one unit, which has so many decimals. */
static bool scan_three(uint32_t out[3], const char *text, unsigned places)
{
    for (int a = 0; a < 3; a++) {
        int64_t number;
        if ((a > 0 && !scan_text(&text, ",")) ||
            !scan_decimal(&text, places, 1, UINT32_MAX, &number))
            return false;
        out[a] = (uint32_t)number;
    }
    return *text == '\0';
}

/* "A-B,C-D,E-F" */
static enum err choose_box(struct volume_choice *choice, const char *list, struct fault *fault)
{
    int64_t first, last;
    int axis = 0;
    choice->has_crop = true;
    for (; scan_list_range(&list, 0, UINT32_MAX, &first, &last); axis++)
        if (axis < 3) {
            choice->first[axis] = (uint32_t)first;
            choice->last[axis] = (uint32_t)last;
        }
    return axis == 3 ? OK
                     : fault_set(fault, ERR_USAGE,
                                 "crop: expected A-B,C-D,E-F, the voxels along x, y and z, and not "
                                 "%d range%s; nothing was opened",
                                 axis, plural((uint64_t)axis));
}

static enum err choose_layout(struct raw_layout *raw, const struct value *value,
                              struct fault *fault)
{
    enum voxel_type type = VOXEL_UINT8;
    if (!value[OPEN_SIZE].given || !value[OPEN_TYPE].given)
        return fault_set(fault, ERR_USAGE,
                         "raw: expected its layout: size=X,Y,Z type=" OPEN_TYPES
                         ", and where it differs, endian=big offset=BYTES spacing=X,Y,Z in mm");
    if (!scan_three(raw->size, value[OPEN_SIZE].text, 0))
        return fault_set(fault, ERR_USAGE, "size: expected X,Y,Z in voxels, as 512,512,400");
    voxel_type_named(&type, value[OPEN_TYPE].text);
    raw->type = type;
    raw->big_endian = value[OPEN_ENDIAN].given && value[OPEN_ENDIAN].number == 1;
    raw->offset = value[OPEN_OFFSET].given ? (uint64_t)value[OPEN_OFFSET].number : 0;
    return OK;
}

/* "3", or a piece of a description. */
static enum err choose_series(struct volume_choice *choice, const char *text, struct fault *fault)
{
    int64_t number;
    const char *at = text;
    if (scan_integer(&at, 1, SERIES_MOST, &number) && !*at)
        choice->series = (uint32_t)number;
    else if (*text && text[strspn(text, "-0123456789")])
        choice->series_name = text;
    else
        return fault_set(fault, ERR_USAGE,
                         "series: expected 1..%d, or a piece of its description, not %s; nothing "
                         "was opened",
                         SERIES_MOST, *text ? text : "nothing");
    return OK;
}

enum err opening_choice(struct volume_choice *choice, const char **name, const struct value *value,
                        struct fault *fault)
{
    enum err err = OK;
    *name = value[OPEN_FILE].text;
    *choice = (struct volume_choice){
        .has_volume = value[OPEN_VOLUME].given,
        .volume = (uint32_t)value[OPEN_VOLUME].number,
        .data = value[OPEN_DATA].given ? value[OPEN_DATA].text : NULL,
        .skip = value[OPEN_SKIP].given ? value[OPEN_SKIP].text : NULL,
        .fills_gaps = value[OPEN_MISSING].given,
        .huge = value[OPEN_HUGE].given && value[OPEN_HUGE].number == 0,
        .straightens = value[OPEN_STRAIGHTEN].given && value[OPEN_STRAIGHTEN].number == 0,
    };
    if (value[OPEN_REDUCE].given)
        choice->reduce = (uint32_t)value[OPEN_REDUCE].number;
    if (value[OPEN_SERIES].given)
        err = choose_series(choice, value[OPEN_SERIES].text, fault);
    if (!err && value[OPEN_CROP].given)
        err = choose_box(choice, value[OPEN_CROP].text, fault);
    const bool is_raw = scan_text(name, RAW);
    if (!err && is_raw)
        err = choose_layout(&choice->raw, value, fault);
    for (int i = OPEN_SIZE; i <= OPEN_OFFSET && !is_raw; i++)
        if (value[i].given)
            return fault_set(fault, ERR_USAGE,
                             "size, type, endian and offset are for `open raw:FILE`, whose layout "
                             "nothing else says");
    if (!err && value[OPEN_SPACING].given &&
        !scan_three(choice->spacing_nm, value[OPEN_SPACING].text, 6))
        err =
            fault_set(fault, ERR_USAGE, "spacing: expected X,Y,Z in millimetres, as 0.5,0.5,1.25");
    return err;
}

void opening_write(struct buf *out, const struct command *open, const struct value *value,
                   uint32_t series)
{
    struct call call = {.command = open};
    memcpy(call.value, value, sizeof call.value);
    if (value[OPEN_SERIES].given && series) {
        call.value[OPEN_SERIES].text = NULL;
        call.value[OPEN_SERIES].number = series;
    }
    command_write(out, &call);
}

/* ---- weights ---- */

enum { PLACES_NUMBER = 0, PLACES_DECIMAL = 3 };
#define ARGUMENT_RANGE(name, type, least, most)                                                    \
    {                                                                                              \
        PLACES_##type, least, most                                                                 \
    }
static const struct {
    unsigned places;
    int64_t least, most;
} argument[] = {WEIGHT_ARGUMENTS(ARGUMENT_RANGE, ARGUMENT_RANGE)};

/* ":1.5" or nothing, for a weight of this row. */
static bool scan_argument(uint32_t *out, const char *text, const struct weight_row *row)
{
    int64_t number = row->usual;
    if (*text && (row->takes == WEIGHT_TAKES_NOTHING || !scan_text(&text, ":") ||
                  !scan_decimal(&text, argument[row->takes].places, argument[row->takes].least,
                                argument[row->takes].most, &number) ||
                  *text))
        return false;
    *out = (uint32_t)number;
    return number != 0 || row->takes == WEIGHT_TAKES_NOTHING;
}

enum err opening_weight(struct weight_choice *weight, const char *text, struct fault *fault)
{
    const size_t length = strcspn(text, ":");
    struct choice name;
    unsigned kind = 0;
    for (const char *at = WEIGHT_KINDS; choice_next(&name, &at); kind++)
        if (name.length == length && memcmp(name.word, text, length) == 0) {
            weight->kind = (enum weight_kind)kind;
            if (scan_argument(&weight->argument, text + length, &weight_table[kind]))
                return OK;
        }
    return fault_set(fault, ERR_USAGE,
                     "weight: expected " WEIGHT_KINDS ", with what it takes after a colon, as in "
                     "gauss:1.5, not %s; `weight FILE` takes a map once the scene is open; nothing "
                     "was opened",
                     text);
}

void opening_write_weight(struct buf *out, const struct weight_choice *weight)
{
    const struct weight_row *row = &weight_table[weight->kind];
    buf_add_text(out, row->name);
    if (weight->argument != row->usual)
        buf_printf(out, ":%g",
                   argument[row->takes].places ? weight->argument / 1000.0 : weight->argument);
}
