#!/bin/sh
# SPDX-License-Identifier: MIT
# The fuzz targets over their corpora: each file whole, cut, and changed in a few bytes.
# IFTTY_TEST_SCALE above 1, as in `make test-long`, has as many times the changes.
. "$(dirname "$0")/lib.sh"

for folder in tests/fuzz/corpus/*; do
    name=${folder##*/}
    begin "bytes for the reader of: $name"
    changes=6000 # and fewer where a change takes longest
    case $name in
    helper | mgh | nrrd | raw | procedure) changes=3000 ;;
    nifti | exr) changes=2000 ;;
    surface) changes=300 ;;
    esac
    changes=$((changes * ${IFTTY_TEST_SCALE:-1}))
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
