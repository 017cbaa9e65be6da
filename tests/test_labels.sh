#!/bin/sh
# SPDX-License-Identifier: MIT
# A segmentation to begin with, in a journal: the copy beside it makes the replay need nothing else,
# goes with the journal, and is believed no more than the digest that the command records. What
# markers are made is in tests/test_labels.c.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
"$iftty" -c 'open s.nii; seed 2,3,4 0; seed 6,10,8 1; seed 20,10,8 2; run; save labels model.nii' \
    >/dev/null || fail "cannot segment"

begin "the labels are copied next to the journal, and the command names the copy"
expect 0 "$iftty" -c 'open s.nii; labels model.nii erode=1; run; save labels one.nii' \
    --journal a.iftty
out_has "label 1: 1 marker" "copied to a.golden/labels-"
grep -qE '^labels model.nii erode=1 copy=[0-9a-f]{32}$' a.iftty || fail "$(cat a.iftty)"
digest=$(sed -nE 's/^labels .* copy=//p' a.iftty)
[ -f "a.golden/labels-$digest.nii.gz" ] || fail "$(ls a.golden)"
expect_out "uint16" 0 "$iftty" info "a.golden/labels-$digest.nii.gz"

begin "erosion is off by default and recorded; voxels outside the regions are background"
expect 0 "$iftty" -c 'open s.nii; labels model.nii; run; save labels same.nii; undo 2
    labels model.nii regions=2; run; save labels part.nii' --journal whole.iftty
same_files same.nii model.nii
same "$(grep -cE '^labels model.nii (regions=2 )?erode=0 copy=' whole.iftty)" 2
expect 0 "$iftty" verify whole.iftty
tail -c +353 model.nii | tr '\1' '\0' >expected
tail -c +353 part.nii >found
same_files expected found

begin "a correction deep in a piece changes only its surroundings"
{
    nifti_header 24 20 16 2 8
    awk 'BEGIN { for (z = 0; z < 16; z++) for (y = 0; y < 20; y++) for (x = 0; x < 24; x++)
        printf "%c", (x > 4 && x < 19 && y > 4 && y < 15 && z > 3 && z < 12) ? 99 : 65 }'
} >room.nii
expect 0 "$iftty" -c 'open room.nii; box 0,0,0 23,19,15 2; box 3,3,2 20,16,13 1
    save labels block.nii'
deep='open room.nii; labels block.nii; run; seed 11,10,8 2'
expect_out '    7 voxels changed' 0 "$iftty" -c "$deep; run"
expect 0 "$iftty" -c "$deep radius=2; run; undo 2; save labels undone.nii"
! grep -q 'undo reverts it' "$work/out" || fail "$(cat "$work/out")"
cmp -s block.nii undone.nii || fail "undo has left something"
expect 0 "$iftty" -c "$deep to=14,10,8 radius=1; run; stats"
[ "$(sed -n 's/^    \([0-9]*\) voxels changed.*/\1/p' "$work/out" | tail -1)" -lt 150 ] ||
    fail "$(cat "$work/out")"

begin "a record without rounds means none"
cp -r whole.golden before.golden
sed -E 's/^labels model.nii erode=0 copy/labels model.nii copy/' whole.iftty >before.iftty
expect 1 "$iftty" verify before.iftty
"$iftty" log --reseal before.iftty >/dev/null 2>&1
for journal in before whole; do
    grep '^= 2 ' $journal.iftty | sed 's/chain.*//' >$journal
done
same_files before whole

begin "a map of noise is reported before it is planted, with a command to use instead"
{
    nifti_header 24 20 16 2 8
    awk 'BEGIN { srand(7); for (i = 0; i < 7680; i++) printf "%c", 97 + int(9 * rand()) }'
} >noise.nii
expect 0 "$iftty" -c 'open s.nii; labels noise.nii'
err_has 'noise.nii is more like noise, or a picture, than a segmentation: '
err_has 'MB (Ctrl-C stops; `labels FILE least=100` leaves out pieces of fewer voxels)'
expect 3 "$iftty" -c 'open s.nii; labels noise.nii least=100'
err_has 'no piece of it has 100 voxels; nothing was planted'
expect 0 "$iftty" -c 'open s.nii; labels model.nii least=100; run; save labels large.nii'
same_files large.nii model.nii

begin "of an atlas the answer is a line, and the labels of most pieces"
seeds='seed 0,0,0 0' label=1
while [ $label -lt 21 ]; do # label 20 in two pieces
    at=$((label % 5 * 4 + 2)),$((label / 5 * 4 + 2)),8
    seeds="$seeds; seed $at $((label == 7 ? 20 : label))"
    label=$((label + 1))
done
"$iftty" -c "open s.nii; $seeds; run; save labels atlas.nii" >/dev/null || fail "cannot segment"
expect 0 "$iftty" -c 'open s.nii; label 20 cortex; labels atlas.nii erode=0; run; stats' \
    --journal atlas.iftty
out_has "atlas.nii: 19 labels and the background, 21 markers, " "label 20 cortex: 2 markers"
out_has "10 more labels, of as many markers or fewer; after \`run\`, \`stats\` lists all"
same "$(grep -c '^ *label [0-9a-z ]*: [12] marker' "$work/out")" 10
same "$(grep -c '^ *label .*seeds\?, ' "$work/out")" 20
expect 0 "$iftty" verify atlas.iftty
expect 0 "$iftty" -c 'open s.nii; labels atlas.nii regions=3 erode=0'
out_has "atlas.nii: 1 label and the background, 2 markers, "

begin "a replay, a resumed session and another file's journal need the map no more"
mv model.nii elsewhere.nii
expect 0 "$iftty" verify a.iftty
expect 0 "$iftty" -c 'stats; save labels two.nii' --journal a.iftty
same_files one.nii two.nii
expect 0 "$iftty" -c 'journal b.iftty; undo' --journal a.iftty
[ -f "b.golden/labels-$digest.nii.gz" ] || fail "the copy does not go with the journal"
expect 0 "$iftty" verify b.iftty
"$iftty" log --anonymise b.iftty >c.iftty || fail "it cannot be anonymised"
cp -r b.golden c.golden
expect 0 "$iftty" replay c.iftty --scene s.nii --out replayed
same_files one.nii replayed/file-3.nii

begin "a second command with the same labels uses the same copy, and undo removes all markers"
cp elsewhere.nii model.nii
expect 0 "$iftty" -c 'labels model.nii erode=0; run; undo 2; labels model.nii regions=1,2 as=2,1' \
    --journal a.iftty
same "$(ls a.golden | wc -l)" 2
expect 0 "$iftty" verify a.iftty
rm model.nii

begin "where there is no copy, the map itself will do, if it holds the same"
cp -r a.golden copies
rm -r a.golden
expect_out "there is no copy" 3 "$iftty" verify a.iftty
cp elsewhere.nii model.nii
expect 0 "$iftty" verify a.iftty
{ head -c 352 elsewhere.nii; tail -c +354 elsewhere.nii; printf '\007'; } >model.nii
expect_out "model.nii holds labels other than recorded" 3 "$iftty" verify a.iftty
rm model.nii

begin "a copy that was changed is not believed, nor a digest that leads elsewhere"
mkdir a.golden
first=$(ls copies | head -n 1)
for copy in $(ls copies); do cp "copies/$first" "a.golden/$copy"; done
expect_out "holds labels other than recorded" 3 "$iftty" verify a.iftty
printf 'open s.nii\nlabels x.nii copy=../../../../../../etc/passwd00000000000\n' >script
expect_err "expected 32 digits" 2 "$iftty" run script
rm -r a.golden
ln -s /etc a.golden
expect 3 "$iftty" verify a.iftty
rm a.golden
cp -r copies a.golden
expect 0 "$iftty" verify a.iftty

begin "a command that cannot be recorded leaves no copy"
cp elsewhere.nii model.nii
"$iftty" -c 'open s.nii' --journal d.iftty >/dev/null || fail "no journal"
expect_err "no voxel of these regions" 3 "$iftty" -c 'labels model.nii regions=9' --journal d.iftty
[ ! -e d.golden ] || [ -z "$(ls d.golden)" ] || fail "it leaves $(ls d.golden)"
expect 0 "$iftty" -c 'open s.nii; labels model.nii' # without a journal, and so without a copy

begin "a file that is no label map of this scene is rejected"
make_scene small.nii 24 20 15
expect 3 "$iftty" -c 'labels small.nii' --journal d.iftty
err_has "the map has 24x20x15 voxels and the scene 24x20x16"
expect 3 "$iftty" -c 'labels missing.nii' --journal d.iftty
expect 2 "$iftty" -c 'labels model.nii as=1' --journal d.iftty
expect 2 "$iftty" -c 'labels model.nii regions=1 as=2 label=3' --journal d.iftty

begin "an object by its range is one marker, replayed and taken back"
expect 0 "$iftty" -c 'open s.nii; seed 6,10,8 1; object 1 threshold 90..200.5
    object 2 threshold 95..105 from=20,5,5; run; stats; save labels own.nii' --journal e.iftty
grep -qE '^ *[0-9]+ voxels of label 1$' out || fail "$(cat out)"
grep -q '^object 2 threshold 95..105 from=20,5,5$' e.iftty || fail "$(cat e.iftty)"
expect 0 "$iftty" verify e.iftty
expect 0 "$iftty" -c 'undo 2; run; object 2 threshold 95..105 from=20,5,5; run
    save labels again.nii' \
    --journal e.iftty
same_files own.nii again.nii
expect 3 "$iftty" -c 'object 5 threshold 70..89' --journal e.iftty
err_has "no seed of label 5 is in a voxel of this range"
expect 2 "$iftty" -c 'object 5 threshold' --journal e.iftty
expect 2 "$iftty" -c 'object 5 threshold 9..1' --journal e.iftty

finish
