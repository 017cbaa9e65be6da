/* SPDX-License-Identifier: MIT */
/*
 * Names and colours of labels in files of maps: a table as text, with a line for each label that
 * label_table_read (show/label_table.h) reads, and as the LabelTable of Connectome Workbench, XML
 * in an extension of NIfTI, as TotalSegmentator writes it too. A code is our own attribute:
 *
 *     <Label Key="300" Red="0.0627" Green="0.125" Blue="0.188" Alpha="1"
 *            Code="SCT:10200004"><![CDATA[big]]></Label>
 *
 * The XML comes from files of others: no entities are defined, nothing is expanded but the five of
 * XML and numbers of ASCII, and the time is linear in its length.
 */
#ifndef IMAGE_NAMES_H
#define IMAGE_NAMES_H

#include "base/buf.h"
#include "image/volume_format.h"

/* Append a line of the table: "300 16 32 48 1 1 1 "big"", without colour if rgb is NULL, and after
 * a tab in the quotes a code and further cells (label_table.h), unless it is "". */
void names_add(struct buf *names, uint32_t number, const uint8_t rgb[3], const char *name,
               size_t length, const char *code);

/* Split a code, "SCHEME:VALUE[:MEANING]"; without a meaning, the name of the label is one. */
#define CODE_EXCLUDES "\\\"^~|<>&" /* characters that formats use */
enum { CODE_PART_BYTES = 65 };
void names_split_code(char part[3][CODE_PART_BYTES], const struct volume_label *label);

/* Read a part of a colour, 0 to 1, as 0..255; greater numbers are 255. */
bool names_scan_part(const char **at, uint8_t *part);

/* Append the labels of LabelTable number `table`, from 0, in `length` bytes of XML, with a NUL
 * after them; of the last one if there are fewer. Labels below 0 or above 2^32 - 1, and 0 "???" of
 * Workbench, are left out. */
void names_read_xml(struct buf *names, const char *xml, size_t length, uint32_t table);

/* Find the label with the least number above *last that has a name or is used, for a table, and
 * set *last to its number. 0 for none. */
unsigned names_next(const struct volume_label label[256], uint32_t *last);

/* Append such XML of these labels. */
void names_write_xml(struct buf *out, const struct volume_label label[256]);

#endif
