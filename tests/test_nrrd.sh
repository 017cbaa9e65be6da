#!/bin/sh
# SPDX-License-Identifier: MIT
# NRRD that iftty reads itself: the same words, voxels and place, to the last digit, as ITK says of
# the same header; and that all other headers go on to ITK (volumes/nrrd.py).
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"

begin "headers are made, each with its voxels after it, and in another file"
made_by nrrd.py
mkdir "$work/alone"
cp "$iftty" "$work/alone/iftty" # which has no helpers
alone=$work/alone/iftty

# told PROGRAM FILE: all that it says of it, with the digest of the scene and the place of a map,
# into $work/told
told() {
    rm -f "$work"/map.* "$work/j.iftty"
    {
        "$1" info "$2"
        "$1" -c "open $2; info; save labels $work/map.nrrd empty=yes; save labels $work/map.nii \
            empty=yes" --journal "$work/j.iftty"
    } >"$work/out" 2>"$work/err" </dev/null
    status=$?
    [ ! -s "$work/map.nrrd" ] || sed '/^$/q' "$work/map.nrrd" >>"$work/out"
    [ ! -s "$work/map.nii" ] || od -An -v -tx1 -N348 "$work/map.nii" >>"$work/out"
    [ $status != 0 ] || last_word sha256 "$work/j.iftty" >>"$work/out"
    sed "s|${2%.*}.[a-z]*|FILE|g" "$work/out" "$work/err" | grep -v '^ok\|^    memory' >"$work/told"
}

begin "read without a helper, a file is what ITK says of it"
count=0
for file in ours/*.nrrd; do
    told "$iftty" "${file%.nrrd}.nhdr"
    mv "$work/told" "$work/itk"
    [ $status = 0 ] || fail "$file: $(cat "$work/itk")"
    told "$alone" "$file"
    cmp -s "$work/itk" "$work/told" || fail "$file: $(diff "$work/itk" "$work/told")"
    count=$((count + 1))
done
[ "$count" -gt 90 ] || fail "$count files"
close_story

begin "what is not certain goes on to ITK, and is read or refused as before"
for file in left/*.nrrd; do
    "$alone" info "$file" >"$work/out" 2>"$work/err" </dev/null
    err_has "cannot start the volume helper" || fail "$file"
done
close_story

finish
