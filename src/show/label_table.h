/* SPDX-License-Identifier: MIT */
/*
 * Label tables: numbers, names and colours of labels in files of other programs.
 *
 *     ITK-SNAP              1  255 0 0  1  1 1  "left hippocampus"      R G B, opacity, two flags
 *     FreeSurfer, Slicer    17  Left-Hippocampus  220 216 20 0          R G B A
 *     mricron               37  Hippocampus_L  4101                     a number of its own
 *     BIDS, dseg.tsv        17  left hippocampus  #dcd814               columns that it names
 *     mricron, .lut         768 bytes: 256 of red, then of green, then of blue
 *
 * One reader accepts all of them, line by line; it skips empty lines and comments (#). In .lut,
 * number 0 has no meaning.
 *
 * A valid name (label_name_fits) is kept. Between double quotes, \" is a quote. In other names an
 * invalid character becomes _, a number gets "label-" before it, and a name that is too long loses
 * its middle, since sides are at the end: "Superior_fronto-occ~al_capsule)_R". Changed names are
 * counted.
 *
 * A name in our own tables (image/names.h, `has_codes`) may have further cells in its quotes, with
 * tabs between them: a code (label_code_fits), the value of its category, and a last one if the
 * file has more. The code alone is kept. Tissue and anatomical structures are the usual categories.
 * Programs write tissue as the code of a label without one; it is dropped.
 *
 * The functions convert memory; the caller finds, reads and writes files.
 */
#ifndef SHOW_LABEL_TABLE_H
#define SHOW_LABEL_TABLE_H

#include "base/buf.h"
#include "session/map.h"
#include "session/state.h"

/* True for a valid name: printable UTF-8 of 1 to LABEL_NAME_BYTES - 1 bytes, without = and \, no
 * blank at its ends, no # at its beginning, and not a number. */
bool label_name_fits(const char *name);

/* True for a code "SCHEME:VALUE[:MEANING]": both of 1 to 16 letters, digits and ._+/-, the meaning
 * of 1 to 64 bytes of printable UTF-8 without CODE_EXCLUDES, no blank at its ends. */
bool label_code_fits(const char *code);
size_t label_code_value(const char *code); /* bytes up to the meaning; 0 if it does not fit */

struct label_entry {
    uint32_t number;
    bool has_colour, changed; /* changed: its name differs from the file */
    uint8_t rgb[3];
    char name[LABEL_NAME_BYTES]; /* "": no name */
    char code[LABEL_CODE_BYTES]; /* "": no code */
    bool is_partial;             /* the file has more than the code */
};

struct label_table {
    struct label_entry *entry; /* in the order of the file */
    size_t count, capacity;
};
void label_table_release(struct label_table *table);

/* Read a table of text: `length` bytes at `text`, and a NUL after them. ERR_LIMIT for more than
 * REGION_MOST + 1 labels, ERR_INPUT for the first invalid line. On errors *table is empty. */
enum err label_table_read(struct label_table *table, const char *text, size_t length,
                          bool has_codes, struct fault *fault);

/* Read a .lut of labels 1 to 255. */
enum err label_table_read_lut(struct label_table *table, const uint8_t *bytes, size_t length,
                              struct fault *fault);

/* Result of applying a table. */
struct label_tally {
    unsigned names, colours, codes; /* that were set */
    unsigned beyond;                /* entries whose label does not exist, or was not chosen */
    unsigned changed;               /* names that were changed; the first: */
    uint8_t first_changed;
};

/* Set names and colours of labels from the entries: entry n is for the label of region n
 * (session/map.h), but 0. A name that another label has gets the number of the label at its end.
 * ERR_INPUT, with nothing changed, if two entries are for one label, or no entry is for any. */
enum err label_table_apply(struct kept *kept, struct label_tally *tally,
                           const struct label_table *table, const struct regions *regions,
                           struct fault *fault);

/* Set the names and codes of labels that have none, and the colours of labels that have those of
 * palette_default; the number of each entry is its label. A label with a name of its own gets only
 * the code of this name. */
void label_table_fill(struct kept *kept, struct label_tally *tally,
                      const struct label_table *table);

/* Digest of names, codes and colours of labels 1..255: a sum mod 2^64. */
uint64_t label_table_digest(const struct kept *kept);

enum label_table_format {
    TABLE_ITKSNAP,
    TABLE_SLICER,
    TABLE_FREESURFER,
    TABLE_MRICRON,
    TABLE_BIDS,
    TABLE_LUT,
};

/* The ending of a file name, and its format: .nii.txt mricron, other .txt and .label ITK-SNAP,
 * .ctbl 3D Slicer, .ctab FreeSurfer, .tsv BIDS, .lut. NULL for other names. */
const char *label_table_ending(const char *path, enum label_table_format *format);

/* Names that had to be changed for a format. */
struct label_writing {
    unsigned changed; /* the first: */
    unsigned first_changed;
    char first_written[LABEL_NAME_BYTES]; /* "" in a .lut, which has no names */
};

/* Write labels 1..255 that have a name or are `used`; a .lut has all of them. Blanks become _ in
 * formats without blanks, and a double quote becomes ' for ITK-SNAP. */
void label_table_write(struct buf *out, struct label_writing *writing,
                       enum label_table_format format, const struct kept *kept,
                       const bool used[256]);

#endif
