#!/bin/sh
# SPDX-License-Identifier: MIT
# The outlines of letters equal those of the font, and the table is the output of its script.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

begin "the table of outlines equals its script's output for the font"
if ! "$PYTHON" -c 'import fontTools' 2>/dev/null; then
    skip "python3-fonttools is not installed"
elif "$top/tests/face_table.py" >"$work/face_table.h" 2>"$work/err"; then
    cmp "$work/face_table.h" "$top/render/face_table.h" ||
        fail "tests/face_table.py >render/face_table.h"
    grep -q 'Bitstream.*All Rights Reserved' "$top/render/face_table.h" || fail "no notice"
else
    fail "$(tail -n 1 "$work/err")"
fi

finish
