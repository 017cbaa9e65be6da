#include "image/analyze.h"

#include <math.h>
#include <string.h>

enum { UNIT_AT = 56, UNIT_BYTES = 4, ORIENT_AT = 252 };

/* Types of voxels that SPM has added, and what they are in NIfTI. */
static int64_t datatype_of(int64_t code)
{
    switch (code) {
    case 130:
        return 256; /* int8 */
    case 132:
        return 512; /* uint16 */
    case 136:
        return 768; /* uint32 */
    default:
        return code;
    }
}

/* Millimetres in its unit; 0 where that is not known. */
static double unit_mm(const uint8_t *bytes)
{
    static const struct {
        const char *name;
        double mm;
    } unit[] = {{"mm", 1}, {"cm", 10}, {"um", 0.001}, {"m", 1000}};
    char name[UNIT_BYTES + 1] = "";
    memcpy(name, bytes + UNIT_AT, UNIT_BYTES);
    name[strcspn(name, " ")] = '\0';
    for (size_t i = 0; i < sizeof unit / sizeof unit[0]; i++)
        if (strcmp(name, unit[i].name) == 0)
            return unit[i].mm;
    return *name ? 0 : 1;
}

/* In single precision, as a map that is saved has it. */
static void take_spacing(struct nifti_header *header, const uint8_t *bytes, char *notes)
{
    const double mm = unit_mm(bytes);
    if (mm == 0)
        volume_note(notes, "its unit of length is none that is known (mm, cm, um, m)");
    header->xyzt_units = 2; /* millimetres */
    header->pixdim[0] = 1;
    for (int a = 1; a <= 3; a++)
        header->pixdim[a] = (double)(float)(header->pixdim[a] * mm);
}

static void forget_place(struct nifti_header *header)
{
    header->qform_code = header->sform_code = 0;
    memset(header->quatern, 0, sizeof header->quatern);
    memset(header->qoffset, 0, sizeof header->qoffset);
    memset(header->srow, 0, sizeof header->srow);
}

void analyze_take(struct nifti_header *header, const uint8_t *bytes, char notes[VOLUME_NOTES_BYTES])
{
    header->datatype = datatype_of(header->datatype);
    take_spacing(header, bytes, notes);
    forget_place(header);
    volume_note(notes,
                "it is ANALYZE, which does not say which side is left: its orient byte, %u, is not "
                "to be relied on",
                bytes[ORIENT_AT]);
    const bool is_scaled =
        isfinite(header->scl_slope) && isfinite(header->scl_inter) && header->scl_slope != 0;
    if (is_scaled && (header->scl_slope != 1 || header->scl_inter != 0))
        volume_note(notes, "its values are multiplied by %g, then %g is added, as SPM writes it",
                    header->scl_slope, header->scl_inter);
}
