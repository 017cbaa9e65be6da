#!/bin/sh
# SPDX-License-Identifier: MIT
# The fuzz targets over their corpora: each file whole, cut, and changed in a few bytes.
# IFTTY_TEST_SCALE above 1, as in `make test-long`, has four times as many times the changes.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1
scale=${IFTTY_TEST_SCALE:-1}
[ "$scale" = 1 ] || scale=$((4 * scale))

for folder in tests/fuzz/corpus/*; do
    begin "bytes for the reader of: ${folder##*/}"
    expect 0 "$build/tests/fuzz/replay" "${folder##*/}" "$scale" "$folder"/* </dev/null
    out_has "$(find "$folder" -type f | wc -l) files"
done

begin "every target has a corpus"
expect 2 "$build/tests/fuzz/replay"
[ "$(cat "$work/out")" = "$(ls tests/fuzz/corpus)" ] || fail "targets are not the corpora"

finish
