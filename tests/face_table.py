#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Makes render/face_table.h, the outlines of letters, out of a font: run by hand when letters are
added. tests/test_face.sh compares what it makes with what is there.

    tests/face_table.py >render/face_table.h       Debian's python3-fonttools, fonts-dejavu-extra

What the table is written in is told in its head, and render/glyph.c reads it."""
import sys
from fontTools.pens.recordingPen import DecomposingRecordingPen
from fontTools.ttLib import TTFont

FONT = "/usr/share/fonts/truetype/dejavu/DejaVuSansCondensed.ttf"
NOTICE = "/usr/share/doc/fonts-dejavu-extra/copyright"
DIGITS = "".join(chr(c) for c in range(35, 127) if chr(c) not in "?\\")  # a string of C is plain
BASE, SMALL, WIDTH = len(DIGITS), 45, 96  # a pair of letters is three digits of one row
SERIF = 62  # so much wider on either side is what has serifs

# What European names need, Greek, and signs that stand in names and figures.
WANTED = [(0x20, 0x7E), (0xA0, 0xAC), (0xAE, 0x17F), (0x18F, 0x18F), (0x1CD, 0x1D4),
          (0x1E6, 0x1E7), (0x1FA, 0x1FF), (0x218, 0x21B), (0x259, 0x259), (0x2C6, 0x2C7),
          (0x2D8, 0x2DD), (0x384, 0x386), (0x388, 0x38A), (0x38C, 0x38C), (0x38E, 0x3A1),
          (0x3A3, 0x3CE), (0x3D1, 0x3D1), (0x3D5, 0x3D6), (0x3F1, 0x3F1), (0x3F5, 0x3F5),
          (0x400, 0x45F), (0x490, 0x491), (0x1E80, 0x1E85), (0x1E9E, 0x1E9E), (0x1EF2, 0x1EF3),
          (0x2010, 0x2015), (0x2018, 0x201E), (0x2020, 0x2022), (0x2026, 0x2026),
          (0x2030, 0x2030), (0x2032, 0x2033), (0x2039, 0x203A), (0x2044, 0x2044),
          (0x2070, 0x2071), (0x2074, 0x208E), (0x20AC, 0x20AC), (0x2103, 0x2103),
          (0x2116, 0x2116), (0x2122, 0x2122), (0x2126, 0x2126), (0x212B, 0x212B),
          (0x2153, 0x2154), (0x215B, 0x215E), (0x2190, 0x2195), (0x2202, 0x2202),
          (0x2205, 0x2206), (0x2208, 0x2208), (0x220F, 0x220F), (0x2211, 0x2212),
          (0x2215, 0x2215), (0x2218, 0x221A), (0x221E, 0x221E), (0x222B, 0x222B),
          (0x2248, 0x2248), (0x2260, 0x2260), (0x2264, 0x2265), (0x25A0, 0x25A1),
          (0x25B2, 0x25B2), (0x25BC, 0x25BC), (0x25CF, 0x25CF), (0x2640, 0x2640),
          (0x2642, 0x2642)]

font = TTFont(FONT)
names, shapes, advances = font.getBestCmap(), font["glyf"], font["hmtx"]


def half(n):
    """Units of the font are 2048 to its size, those of the table 1024."""
    return (n + 1) >> 1


def small(n):
    return DIGITS[n + SMALL]


def large(n):
    assert -BASE * BASE // 2 <= n < BASE * BASE // 2, n
    n += BASE * BASE // 2
    return DIGITS[n // BASE] + DIGITS[n % BASE]


def contours_of(name):
    """Lists of (x, y, is on the curve), the first of which is on it."""
    glyph, end = shapes[name], 0
    if not glyph.numberOfContours:
        return
    points, ends, flags = glyph.getCoordinates(shapes)
    for last in ends:
        contour = [(half(x), half(y), bool(on)) for (x, y), on
                   in zip(points[end:last + 1], flags[end:last + 1])]
        end = last + 1
        first = next(i for i, p in enumerate(contour) if p[2])
        yield contour[first:] + contour[:first]


def has_parts(name):
    """Whether it is others, which are moved, and not turned or enlarged; an IJ has no serifs."""
    glyph = shapes[name]
    return name != "IJ" and glyph.isComposite() and not any(
        hasattr(part, "transform") or hasattr(part, "firstPt") for part in glyph.components)


def has_serifs(name):
    return name == "I" or (name not in ("", "IJ") and shapes[name].isComposite() and
                           any(has_serifs(part.glyphName) for part in shapes[name].components))


def parts_of(name, x=0, y=0):
    """Names of plain outlines, and where they lie; what is wider moves what is above it."""
    if not has_parts(name):
        yield name, x, y
        return
    for part in shapes[name].components:
        is_moved = has_serifs(name) and not has_serifs(part.glyphName) and part.glyphName != "tonos"
        yield from parts_of(part.glyphName, x + half(part.x) + SERIF * is_moved, y + half(part.y))


def write_contours(contours):
    text, at = "", (0, 0)
    for contour in contours:
        for i, (x, y, on) in enumerate(contour):
            kind, steps = 9 * (2 if i == 0 else int(on)), ""
            for step, times in ((x - at[0], 3), (y - at[1], 1)):
                if step:
                    is_small = -SMALL <= step < SMALL
                    kind += times if is_small else 2 * times
                    steps += small(step) if is_small else large(step)
            text += DIGITS[2 + kind] + steps
            at = (x, y)
    return text + DIGITS[0]


def box():
    """What stands for a letter that the face lacks: as tall as a capital, hollow."""
    outer, inner = (60, 0, 460, 747), (120, 60, 400, 687)
    for (left, low, right, high), back in ((outer, 1), (inner, -1)):
        yield [(left, low, True), (left, high, True), (right, high, True),
               (right, low, True)][::back]


def barred():
    """An I, which is a bar in the font and stands for a side of the patient alone: with serifs."""
    (x, _, _), *_ = outline = next(contours_of("I"))
    left, right = min(p[0] for p in outline) + SERIF, max(p[0] for p in outline) + SERIF
    high, thick = max(p[1] for p in outline), 66
    out, end = left - 96, right + 96
    yield [(x, y, True) for x, y in (
        (out, 0), (out, thick), (left, thick), (left, high - thick), (out, high - thick),
        (out, high), (end, high), (end, high - thick), (right, high - thick), (right, thick),
        (end, thick), (end, 0))]


points = [p for first, last in WANTED for p in range(first, last + 1) if p in names]
order, number = ["", *(names[p] for p in points)], {}
for i, name in enumerate(order):
    number.setdefault(name, i)
records, i = [write_contours(box())], 1
while i < len(order):  # parts come last, as they are met
    name, i = order[i], i + 1
    if name == "I":
        records.append(write_contours(barred()))
        continue
    if not has_parts(name) and number[name] == i - 1:
        records.append(write_contours(contours_of(name)))
        continue
    text = ""
    for part, x, y in parts_of(name):
        if part not in number:
            number[part] = len(order)
            order.append(part)
        text += DIGITS[1] + large(number[part]) + large(x) + large(y)
    records.append(text + DIGITS[0])

index, data = "", ""
for name, record in zip(order, records):
    offset = len(data)
    advance = half(advances[name][0]) + 2 * SERIF * has_serifs(name) if name else 520
    index += DIGITS[offset // BASE ** 2] + DIGITS[offset // BASE % BASE] + DIGITS[offset % BASE]
    index += large(advance)
    data += record

runs = []
for i, point in enumerate(points):
    if not runs or runs[-1][0] + runs[-1][1] != point:
        runs.append([point, 0, i + 1])
    runs[-1][1] += 1

letter = {names[p]: chr(p) for p in range(ord("z"), ord("A") - 1, -1) if chr(p).isalpha()}
kerns = "".join(sorted(letter[a] + letter[b] + small(max(-SMALL, half(by)))
                       for (a, b), by in font["kern"].kernTables[0].kernTable.items()
                       if a in letter and b in letter and abs(by) > 30))


def write_sheet(what, name, text):
    rows = [text[at:at + WIDTH].ljust(WIDTH, DIGITS[0]) for at in range(0, len(text), WIDTH)]
    print(f"\n/* {what} */\nstatic const char {name}[{len(rows)}][FACE_ROW + 1] = {{")
    for row in rows:
        print(f'"{row}",')
    print("};")


def notice():
    lines = open(NOTICE, encoding="utf-8").read().split("\n\n")[1].split("\n")
    for line in lines:
        line = " ".join(line.split())
        line = line.removeprefix("Copyright: ").removeprefix("License: bitstream-vera")
        if not line.startswith("Files:"):
            yield "" if line == "." else line


def wrap(lines):
    paragraph = ""
    for line in [*lines, ""]:
        if line:
            paragraph += " " + line
            continue
        row = " *"
        for word in paragraph.split():
            if len(row) + 1 + len(word) > 100:
                print(row)
                row = " *"
            row += " " + word
        print(row + ("\n *" if line == "" and paragraph else ""))
        paragraph = ""


assert not any(len(r) > BASE ** 3 for r in (data,)) and len(order) < BASE * BASE // 2
version = font["name"].getDebugName(5)
print(f"""/* SPDX-License-Identifier: Bitstream-Vera */
/*
 * The outlines of letters: generated by tests/face_table.py from the font DejaVu Sans Condensed,
 * {version}, which is free under the licence below. The letter I has serifs here, since it
 * denotes a side of the patient. {len(points)} characters, {len(order)} outlines.
 *
 *     tests/face_table.py >render/face_table.h
 *
 * Units are 1024 to the size of the font; a capital is {half(1493)} high. All but the runs is text
 * whose characters are digits 0 to {BASE - 1}: those from '#' to '~' but for '?' and '\\'. A small
 * number is a digit less {SMALL}, a large one two less {BASE * BASE // 2}. An outline is a list of
 *     0                          its end
 *     1 NUMBER X Y               another outline, without parts, moved by X, Y; three large numbers
 *     2 + 9 WHICH + 3 SX + SY    a point, relative to the one before: WHICH is 0 off the curve, 1
 *                                on it, 2 at the begin of a contour, which is on it too. SX and SY
 *                                are the kinds of x and y: 0 nothing, 1 small numbers, 2 large ones
 *
 * Licence of the font
 *""")
wrap(notice())
print(f""" */
#ifndef RENDER_FACE_TABLE_H
#define RENDER_FACE_TABLE_H

#include <stdint.h>

enum {{
    FACE_ROW = {WIDTH},
    FACE_BASE = {BASE},
    FACE_KERNS = {len(kerns) // 3},
    FACE_RUNS = {len(runs)},
}};

/* Runs of characters: the first, their number, and the first's outline. */
/* clang-format off */
static const uint16_t face_run[FACE_RUNS][3] = {{""")
row = "   "
for first, count, at in runs:
    word = f" {{{first:#x}, {count}, {at}}},"
    if len(row + word) > 99:
        print(row)
        row = "   "
    row += word
print(row + "\n};")
write_sheet("For each outline: its begin, in three digits, and its advance, a large number.",
            "face_index", index)
write_sheet("Pairs of letters in order, and their kerning, a small number.",
            "face_kern", kerns)
write_sheet("Outlines; the first is the box for missing characters.", "face_outline", data)
print("/* clang-format on */\n\n#endif")
print(f"{len(points)} characters, {len(order)} outlines, {len(data)} digits", file=sys.stderr)
