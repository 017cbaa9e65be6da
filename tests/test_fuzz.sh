#!/bin/sh
# The fuzz targets over their corpora: each file whole, cut, and changed in a few bytes.
. "$(dirname "$0")/lib.sh"

for folder in tests/fuzz/corpus/*; do
    name=${folder##*/}
    begin "bytes for the reader of: $name"
    changes=20000
    case $name in exr) changes=3000 ;; surface) changes=500 ;; esac
    expect 0 "$build/tests/fuzz/fuzz_$name" $changes "$folder"/* </dev/null
    out_has "$(find "$folder" -type f | wc -l | tr -d ' ') files"
    close_story
done

begin "every target has a corpus"
for target in tests/fuzz/fuzz_*.c; do
    name=${target#tests/fuzz/fuzz_}
    [ -d "tests/fuzz/corpus/${name%.c}" ] || fail "no corpus for $target"
done
close_story

finish
