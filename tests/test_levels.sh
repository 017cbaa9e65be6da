#!/bin/sh
# SPDX-License-Identifier: MIT
# Scenes of real and of wide whole numbers, as nibabel writes them: values as they are in the file,
# few that are far from the others, ranges against numpy, records, and journals of before.
. "$(dirname "$0")/lib.sh"
unset IFTTY_SCENES
out_lacks() { # a fixed string
    ! grep -qF -e "$1" "$work/out" || fail "'$1' is in the output:" "$(grep -F -e "$1" "$work/out")"
}

begin "scenes are made"
"$PYTHON" -W ignore "$top/tests/levels/make.py" . >values 2>made || fail "$(tail -n 3 made)"
[ "$failures" = 0 ] || finish
read -r far counts <values

count() { # of lines FILE LOW HIGH: the voxels that numpy finds in the file, before each line
    "$PYTHON" -W ignore "$top/tests/levels/make.py" count
}
begin "a range contains the voxels whose value in the file is in it"
{
    printf '%s.nii 0.3 0.5\n' plain far4 far20 low holes
    printf '%s.nii 1e-1 8.75e-1\n' plain far4 far20 low holes
    printf '%s\n' 'far4.nii 2 1e5' 'far20.nii 1e19 1e21' 'low.nii -1e31 -1' 'holes.nii -1e9 1e9'
    printf 'hundredths.nii %s %s\n' 0.03 0.03 0.28 0.28 0.57 0.57 0.70 0.70
    echo 'tiny.nii 3e-7 5.25e-7'
    printf '%s.nii -1000 226\n' ct ct-real ct-far
    printf '%s.nii 226 3071\n' ct ct-real ct-far
    printf '%s\n' 'ct-far.nii 1500000000 3000000000' 'counts.nii 1000000000000 2500000000000' \
        'unsigned.nii 3000000000 4294967295' 'quotients.nii.gz 0.25 1.5'
} | count >counts
same "$(wc -l <counts)" 29
while read -r truth file low high; do
    answers "    $truth of 1680 voxels" "open $file; range $low $high"
    expect 0 "$iftty" -c "open $file; seed 0,0,0 1 radius=32 range=$low..$high"
    out_has "    left out, intensities beyond the range: $((1680 - truth)) voxels"
done <counts

begin "values far from all others are counted, reported, and use no levels"
expect 0 "$iftty" -c 'open far4.nii; why 3,4,5; why 7,7,7; info; profile 7,7,7 9,7,7'
out_has 'outliers: the scale is 0 to 1.9' '0 voxels below and 1 above are clamped to its ends'
out_has 'intensity 10000, ' '1 voxel is above 1.9' 'a level is 3.0'
cp out first
grep -q "voxel 7,7,7 .*: intensity $far, " first || fail "$far" "$(grep 7,7,7 first)"
expect 0 "$iftty" -c 'open far4.nii; box 0,0,0 13,11,9 1; stats report=far4.csv'
head -n 1 far4.csv | grep -q ',intensity_step,voxels_below_scale,voxels_above_scale$' ||
    fail "$(cat far4.csv)"
grep -q '^1,.*,0,1$' far4.csv || fail "$(cat far4.csv)"
expect 0 "$iftty" -c 'open far4.nii; interpolate 2 2 2; why 6,8,10; why 7,8,10'
same "$(grep -c 'intensity [0-9.]* +-[0-9.e-]* within the scale, ' "$work/out")" 2
expect 0 "$iftty" -c 'open plain.nii; interpolate 2 2 2; why 7,8,10'
out_lacks 'within the scale'
answers 'intensity 1e+20, ' 'open far20.nii; why 3,4,5'
expect 0 "$iftty" -c 'open holes.nii'
answers 'intensity no number, ' 'open holes.nii; why 0,0,0; why 1,1,1'
out_has 'intensity 1e+300, ' '121 voxels are no number or infinite: taken for less than 0'
answers 'the scale is -1000 to 6' 'open ct-far.nii; why 0,0,0; why 5,6,7'
out_has 'intensity -1000, '
answers 'outliers: the scale' 'open quotients.nii.gz; info'
expect 0 "$iftty" -c 'open plain.nii; info'
out_lacks 'outliers: the scale'
expect 0 "$iftty" info --histogram holes.nii
out_has "note      $((12 * 10 + 1)) voxels are no number or infinite: taken for "
expect_out 'scale     0..1.9' 0 "$iftty" info --histogram far4.nii
out_has '0 voxels below, 1 above'
answers '0 voxels below and 1 above' 'open series.nii volume=1 crop=0-13,0-11,2-9'
expect 0 "$iftty" -c 'open series.nii volume=0; info'
out_lacks 'outliers: the scale'
answers 'outliers: the scale' 'open far4.nii reduce=2; info'

begin "whole numbers are exact, whatever they are held as"
expect 0 "$iftty" -c 'open ct.nii; why 7,7,7' --journal a.iftty
expect 0 "$iftty" -c 'open ct-real.nii; why 7,7,7; info' --journal b.iftty
out_has 'values    1 * intensity -1000'
out_lacks 'a level is'
same "$(last_word scene a.iftty)" "$(last_word scene b.iftty)"
expect_out "intensity $counts, " 0 "$iftty" -c 'open counts.nii; why 0,0,1'

begin "a range that ends within a level says so, and how large a level is"
expect 0 "$iftty" -c 'open low.nii; seed 1,1,1 0
object 1 threshold -1e30..0.5 from=3,4,5; run; stats
stats report=s.json'
out_has 'a level is 3.0' '1 voxel is below -0.9'
grep -q '"intensity_step": *3.0' s.json || fail "$(cat s.json)"
expect 0 "$iftty" -c 'open close.nii; range 0.2 0.500000015'
out_has '120 voxels have a level that contains an end of the range: its width is 1.53e-05'
answers 'intensity 0.500008 +-7.6e-06, ' 'open close.nii; why 6,1,1; why 0,0,1'
out_has 'intensity 0.000595593, '
expect 0 "$iftty" -c 'open close.nii; seed 6,6,6 1 radius=1 range=0.2..0.500000015'
out_has 'voxels have a level that contains an end of the range'
expect 0 "$iftty" -c 'open close.nii; object 1 threshold 0.2..0.500000015 from=4,4,4'
out_has '120 voxels have a level that contains an end of the range'
expect 0 "$iftty" -c 'open close.nii; range 0.2 0.45'
out_lacks 'cuts'
answers 'a level is 1.53e-05' 'open close.nii; interpolate 2 1 1; range 0.2 0.5; info'

begin "numbers are recorded as typed, with the source of the scene"
expect 0 "$iftty" -c 'open far4.nii; range 1e-1 8.5e-1; window 2.5e-7 1e20; window 0.0015 40
seed 2,2,2 1 range=0..12345678901234567890; run' --journal j.iftty
grep -q '^= 1 .* scale=0\.\.1\.9[0-9]* beyond=0,1 values=[0-9a-f]* ' j.iftty ||
    fail "$(cat j.iftty)"
grep -q '^range 0.1 0.85$' j.iftty || fail "$(cat j.iftty)"
grep -q '^window 0.00000025 1e20$' j.iftty || fail "$(cat j.iftty)"
grep -q '^seed 2,2,2 1 range=0..12345678901234567890$' j.iftty ||
    fail "$(cat j.iftty)"
expect 0 "$iftty" verify j.iftty
expect 0 "$iftty" log --script j.iftty
expect_err 'of at most 19 digits' 2 "$iftty" -c 'open far4.nii; range 1 123456789012345678901'
cp far20.nii far4.nii # the same levels of other values
expect 1 "$iftty" verify j.iftty

begin "one value far from all others leaves them all levels"
expect 0 "$iftty" -c 'open far.nii; range 0 0.9'
truth=$(echo 'far.nii 0 0.9' | count)
out_has "${truth%% *} of 1728"

begin "options of another file format are rejected"
for word in series=1 missing=blank data=a/b; do
    expect_err "${word%=*}=" 2 "$iftty" -c "open plain.nii $word"
    err_has ', and this is nifti-1: leave it out'
done
finish
