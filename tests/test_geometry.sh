#!/bin/sh
# SPDX-License-Identifier: MIT
# Facts about the place that a file does not state are unknown in every answer and picture, until
# the user states them.
. "$(dirname "$0")/lib.sh"
cp "$top"/tests/journals/*.nii.gz .

sides="his |patient's|left|front|back|head|feet|superior|anterior|axial|coronal|sagittal"

begin "of an unknown orientation no answer names a side of the patient"
cat >unplaced.txt <<'EOF'
open unplaced.nii.gz
seed 8,10,8 1 radius=2
seed 1,1,1 0
run
view left
clip axial 3-9
info
slice axial 8
mosaic m.png
clip none
view 30 20
why 3,3,3
pick 256 256 of=axial
stats
EOF
expect 0 "$iftty" run unplaced.txt
grep -v 'if you know towards which\|^ok ' "$work/out" | sed 's/background//' >answers
grep -E "$sides|[0-9] mm| ml" answers >named && fail "$(cat named)"
out_has "orientation unknown: no picture or answer names a side of the patient"
out_has "voxels of unknown size, orientation unknown" "lengths and volumes are in voxels"
out_has "up; orientation unknown" "all but z slices 3-9" "through 12,10,8: z 8, y 10, x 12; "
expect_err "expected z slices A-B within 0-15" 2 "$iftty" -c 'open unplaced.nii.gz; clip axial'
grep -qE "$sides" "$work/err" && fail "$(cat "$work/err")"

begin "the same voxels shown with sides and without differ in letters alone, which vanish"
for how in LAS file; do
    expect 0 "$iftty" -c "open unplaced.nii.gz; orient $how; overlay none cross=off; size 200 200
        slice axial 8 $how.exr replace=yes; overlay words=off; slice axial 8 $how-plain.exr"
done
expect_out "iftty:orientation: unknown" 0 "$iftty" info file.exr
out_has "iftty:slice: z through 12,10,8"
expect_out "iftty:orientation: set by the user" 0 "$iftty" info LAS.exr
out_has "iftty:slice: axial through "

begin "open and info report unusual geometry, and do not report usual geometry"
make_scene plain.nii 12 10 8
expect 0 "$iftty" -c 'open plain.nii'
cp "$work/out" plain
cp plain.nii tilted.nii
put tilted.nii 252 '\000\000\001\000' # the sform alone: 37 degrees about z
put tilted.nii 280 '\315\314\114\077\232\231\031\277\000\000\000\000'
put tilted.nii 296 '\232\231\031\077\315\314\114\077\000\000\000\000'
put tilted.nii 312 '\000\000\000\000\000\000\000\000\000\000\200\077'
put tilted.nii 123 '\000'
printf '1234567' >>tilted.nii
expect 0 "$iftty" -c 'open tilted.nii'
grep '^  ' "$work/out" | tail -n +2 | sed 's/^ *//' >said
out_has "its axes are oblique: up to 37 degrees off the sides of the patient that name them"
out_has "it has no unit of length: millimetres are assumed"
out_has "7 of its bytes come after the voxels; does its header say all of its volumes?"
expect 0 "$iftty" info tilted.nii
sed -n 's/^note *//p' "$work/out" >noted
same_files said noted
expect 0 "$iftty" info --json tilted.nii
same "$("$PYTHON" -c 'import json, sys; print(*json.load(sys.stdin)["open_notes"], sep="\n")' \
    <"$work/out")" "$(cat said)"
! grep -q 'oblique\|come after' plain || fail "$(cat plain)"

begin "an orientation set by the user is recorded, undone, and shown as set by the user"
expect 0 "$iftty" -c 'open unplaced.nii.gz; orient LPI; info; undo; info; redo; info' \
    --journal told.iftty
[ "$(grep -c 'axes towards LPI set by the user' "$work/out")" = 3 ] || fail "$(cat "$work/out")"
[ "$(grep -c 'size, orientation unknown' "$work/out")" = 1 ] || fail "$(cat "$work/out")"
grep -q '^= 1 .* orientation=unknown' told.iftty || fail "$(cat told.iftty)"
grep -q '^= 2 orientation=told' told.iftty || fail "$(cat told.iftty)"
expect 0 "$iftty" verify told.iftty
expect 0 "$iftty" run - --journal told.iftty </dev/null
refuses "three letters for the sides that the axes run towards" 'open unplaced.nii.gz; orient LPX'
refuses "HOW: the file has no sform; nothing has changed" 'open unplaced.nii.gz; orient sform'
expect 3 "$iftty" -c 'open synth:geom:9x8x7; orient LAS'
err_has "the file says that its axes run towards RAS; where that is wrong, correct the file"

begin "an sform and a qform that contradict each other are chosen between"
expect 0 "$iftty" -c 'open contrary.nii.gz; info; orient sform; info; orient qform; info' \
    --journal chosen.iftty
out_has "axes towards LAS by the sform, RAS by the qform"
out_has "\`orient sform\` or \`orient qform\` decides" "2 mm, orientation unknown"
out_has "2 mm, axes towards LAS," "2 mm, axes towards RAS,"
expect 0 "$iftty" verify chosen.iftty
refuses "the position of this scene in the world is unknown" 'open contrary.nii.gz; seed 12,4,9mm 1'
expect 0 "$iftty" -c 'open contrary.nii.gz; orient sform; seed 12,4,9mm 1; orient qform
    seed 5,6,9mm 1'
out_has "seed 8,8,1 1" "seed 8,4,2 1"

begin "maps of a scene without orientation have no orientation"
expect 0 "$iftty" -c 'open unplaced.nii.gz; save labels a.nii empty=yes; orient LPI
save labels b.nii empty=yes'
[ "$(grep -c "its position is as unknown as that of the scene" "$work/out")" = 2 ] ||
    fail "$(cat "$work/out")"
cmp -s a.nii b.nii || fail "what was told is in the map"
expect_out "axes      unknown" 0 "$iftty" info a.nii

# A scene of 1 mm with an sform, and maps of it that are moved along x.
placed() { # FILE BYTES: the x of voxel 0, as a float
    gzip -dc scene.nii.gz >"$1"
    put "$1" 254 '\001\000'
    put "$1" 280 '\000\000\200\077\000\000\000\000\000\000\000\000'
    put "$1" 292 "$2"
    put "$1" 296 '\000\000\000\000\000\000\200\077'
    put "$1" 320 '\000\000\200\077'
}
placed here.nii '\000\000\000\000'
placed far.nii '\000\000\360\101'   # 30 mm
placed near.nii '\315\314\314\076'  # 0.4 mm
placed beside.nii '\000\000\300\077' # 1.5 mm

begin "a displaced map is rejected with its distance, unless it is resampled"
for command in "mask far.nii" "seed-file far.nii label=1" "weight far.nii"; do
    refuses "far.nii: the map is up to 30 mm away from the scene" "open here.nii; $command"
    err_has "resample=yes uses its nearest voxels; nothing has changed"
    expect 0 "$iftty" -c "open here.nii; ${command%%far.nii*}near.nii"
    ! grep -q resampled "$work/out" || fail "$(cat "$work/out")"
done
expect 0 "$iftty" -c "open here.nii; mask beside.nii resample=yes" --journal resampled.iftty
out_has "resampled from 24x20x16 voxels by the nearest"
out_has "320 voxels of the scene are outside the map: set to 0"
grep -q '^mask beside.nii resample=yes$' resampled.iftty || fail "$(cat resampled.iftty)"
expect 0 "$iftty" verify resampled.iftty
expect 2 "$iftty" -c "open here.nii; weight sobel resample=yes"
err_has "resample: \`weight sobel\` has none"

begin "a map less than half a voxel off is used, and the shift is printed in mm"
expect 0 "$iftty" -c "open here.nii; seed 3,3,3 1; seed 20,16,12 2; run; save labels map.nii
    save labels same.nii"
cp map.nii shifted.nii
put shifted.nii 292 '\315\314\314\076'
for command in "mask shifted.nii" "seed-file shifted.nii" "weight shifted.nii" \
    "labels shifted.nii" "mask shifted.nii resample=yes" \
    "seed 3,3,3 1; run; compare shifted.nii"; do
    expect 0 "$iftty" -c "open here.nii; $command"
    out_has "the map is 0.4 mm off the scene's grid, less than half a voxel: used voxel for voxel"
    expect 0 "$iftty" -c "open here.nii; $(echo "$command" | sed 's/shifted/same/')"
    ! grep -q "off the scene's grid" "$work/out" || fail "$(cat "$work/out")"
done
expect 0 "$iftty" -c "open here.nii; labels shifted.nii; save labels saved.nii" \
    --journal off.iftty
same_files saved.nii same.nii # at the scene's place, not the map's
expect 0 "$iftty" verify off.iftty
expect_err "the map is 0.4 mm off the scene's grid" 0 "$iftty" compare same.nii shifted.nii
expect 0 "$iftty" -c "open here.nii crop=2-20,1-18,0-9 reduce=3; labels shifted.nii"
out_has "the map is 0.4 mm off the scene's grid"
expect 0 "$iftty" -c "open here.nii crop=2-20,1-18,0-9 reduce=3; labels same.nii"
! grep -q "off the scene's grid" "$work/out" || fail "$(cat "$work/out")"

finish
