#!/bin/sh
# SPDX-License-Identifier: MIT
# NRRD that iftty reads itself: the same words, voxels and place, to the last digit, as ITK says of
# the same header; and that all other headers go on to ITK (volumes/nrrd.py). And that files in
# left-anterior-superior, whose wrong axis ITK 5.2 flips, have the right place either way.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"

begin "headers are made, each with its voxels after it, and in another file"
made_by nrrd.py
mkdir "$work/alone"
cp "$iftty" "$work/alone/iftty" # which has no helpers
alone=$work/alone/iftty

# told PROGRAM FILE: its complete output about it, with the digest of the scene and the place of a
# map, into $work/told; of every fourth file also what `info` prints
told() {
    rm -f "$work"/map.* "$work/j.iftty"
    {
        [ $((count % 4)) != 0 ] || "$1" info "$2"
        "$1" -c "open $2; info; save labels $work/map.nrrd empty=yes; save labels $work/map.nii \
            empty=yes" --journal "$work/j.iftty"
    } >"$work/out" 2>"$work/err" </dev/null
    status=$?
    [ ! -s "$work/map.nrrd" ] || sed '/^$/q' "$work/map.nrrd" >>"$work/out"
    [ ! -s "$work/map.nii" ] || od -An -v -tx1 -N348 "$work/map.nii" >>"$work/out"
    [ $status != 0 ] || last_word sha256 "$work/j.iftty" >>"$work/out"
    sed "s|${2%.*}.[a-z]*|FILE|g" "$work/out" "$work/err" | grep -v '^ok\|^    memory' >"$work/told"
}

begin "a file read without the helper equals the file read by ITK"
count=0
for file in ours/*.nrrd; do
    told "$iftty" "${file%.nrrd}.nhdr"
    mv "$work/told" "$work/itk"
    [ $status = 0 ] || fail "$file: $(cat "$work/itk")"
    told "$alone" "$file"
    cmp -s "$work/itk" "$work/told" || fail "$file: $(diff "$work/itk" "$work/told")"
    count=$((count + 1))
done
[ "$count" -gt 100 ] || fail "$count files"

begin "an uncertain header is passed to ITK, and read or rejected as before"
for file in left/*.nrrd; do
    "$alone" info "$file" >"$work/out" 2>"$work/err" </dev/null
    err_has "cannot start the volume helper" || fail "$file"
done

# The world of a map that is saved runs to the left, the back and the head: y alone is the other way
# than in left-anterior-superior.
begin "left-anterior-superior: x runs to the left, y to the front, with and without ITK"
for name in plain gzip hex dots series; do
    for file in las/$name.nrrd las/$name.nhdr; do
        rm -f "$work/map.nrrd"
        expect_out "axes      LAS" 0 "$iftty" info $file
        answers "2.5 mm, axes towards LAS," "open $file; info; save labels $work/map.nrrd empty=yes"
        ! grep -q "sides are wrong" "$work/out" || fail "$file: $(cat "$work/out")"
        grep -a '^space' "$work/map.nrrd" >"$work/space"
        printf '%s\n' "space: left-posterior-superior" \
            "space directions: (0.9,0,0) (0,-1.1,0) (0,0,2.5)" "space origin: (-12.5,-20,3)" |
            cmp -s - "$work/space" || fail "$file: $(cat "$work/space")"
    done
done
for file in las/plain.nrrd las/gzip.nrrd; do expect_out "axes      LAS" 0 "$alone" info $file; done

begin "a file of uncertain orientation has no named sides, and this is reported"
for name in none nan words; do
    for file in las/$name.nrrd las/$name.nhdr; do
        expect_out "axes      unknown" 0 "$iftty" info $file
        out_has "left-anterior-superior, and the place of its voxels in it is uncertain: sides of"
    done
done

begin "a map in left-anterior-superior is placed correctly over a scene in another space"
for file in las/plain.nrrd las/hex.nhdr; do
    answers "label 7: " "open las/ras.nrrd; labels $file; run; stats"
    out_has "centre 3.0,1.0,2.0 at 9.8,21.1,8.0 mm" # 12.5 - 3 * 0.9, 20 + 1.1, 3 + 2 * 2.5
    answers "centre 1.0,1.0,2.0 at 9.8,21.1,8.0 mm" "open las/turned.nrrd; labels $file; run; stats"
    expect 0 "$iftty" -c "open $file; labels las/turned.nrrd; run; stats"
    out_has "centre 1.0,1.0,2.0 at 11.6,21.1,8.0 mm"
done

finish
