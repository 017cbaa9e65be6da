#!/bin/sh
# `stats` as users meet it: what it prints, reports for programs, finished labels, and what the last
# edit changed beside the counts before and after it. tests/test_stats.c has the counting itself.
. tests/lib.sh
cd "$work" || exit 1
make_scene scene.nii 30 24 20

field() { # FILE LABEL NAME: from a report in CSV
    awk -F, -v label="$2" -v name="$3" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) at = i }
        $1 == label { print $at }' "$1"
}

begin "counts before and after an edit differ by what it gave and took, undone or not"
cat >script <<'END'
open scene.nii
auto on
label 1 lower
seed 7,12,10 1 radius=2
seed 25,20,15 2 radius=2
seed 2,2,2 0
stats report=0.csv
seed 7,12,12 2
stats report=1.csv
seed 8,12,12 2
stats report=2.csv
undo
stats report=3.csv
seed 26,20,15 1 radius=1
stats report=4.csv
END
expect 0 "$iftty" run script
known=0
for after in 1 2 3 4; do
    for label in 1 2; do
        gained=$(field $after.csv $label gained)
        [ -n "$gained" ] || continue
        known=$((known + 1))
        before=$(field $((after - 1)).csv $label voxels)
        same "$(field $after.csv $label voxels)" \
            "$((${before:-0} + gained - $(field $after.csv $label lost)))"
        same "$(field $after.csv $label change)" $((gained - $(field $after.csv $label lost)))
    done
done
[ $known -gt 2 ] || fail "no report says what the last edit changed"
same "$(cut -d, -f1-23 1.csv)" "$(cut -d, -f1-23 3.csv)"
same "$(field 0.csv 1 name)" '"lower"'
close_story

begin "what the last edit changed is told, with a list of it and without"
mkdir told
sed "s|report=|report=told/|" script >telling
expect 0 "$iftty" run telling
grep -q "the last edit gave it [0-9]* voxels*, and took [0-9]*: [+-][0-9.]* m" "$work/out" ||
    fail "$(cat "$work/out")"
expect 0 "$iftty" -c "open scene.nii; seed 7,12,10 1; seed 2,2,2 0; run; stats report=all.csv;
    weight difference; stats report=anew.csv"
same "$(field all.csv 1 change)" "$(field all.csv 1 voxels)"
same "$(field all.csv 1 gained)" ""
same "$(field anew.csv 1 change)" "$(($(field anew.csv 1 voxels) - $(field all.csv 1 voxels)))"
[ "$(field anew.csv 1 change)" != 0 ] || fail "other weights have changed nothing"
grep -q "the last edit changed it by [+-][0-9.]* m" "$work/out" || fail "$(cat "$work/out")"
close_story

begin "reports are the same for any number of threads"
for threads in 1 3; do
    mkdir $threads
    sed "s|report=|report=$threads/|" script >threaded
    IFTTY_THREADS=$threads expect 0 "$iftty" run threaded
done
for number in 0 1 2 3 4; do same_files 1/$number.csv 3/$number.csv; done
close_story

begin "where the place in the world is not known, no millimetres of it are printed"
expect 0 "$iftty" -c "open scene.nii; info"
out_has "orientation unknown"
expect 0 "$iftty" -c "open scene.nii; seed 7,12,10 1; run; stats report=place.csv"
out_has "centre "
! grep -q "centre.* mm" "$work/out" || fail "$(cat "$work/out")"
same "$(field place.csv 1 centre_x_mm)" ""
close_story

begin "finished labels are counted when asked for, and a report is JSON where its name says so"
expect 0 "$iftty" -c "open scene.nii; seed 7,12,10 1 radius=2; seed 25,20,15 2 radius=2;
    seed 2,2,2 0; run; save labels plain.nii; stats report=plain.csv; finish majority radius=2;
    stats report=smooth.json finished=yes; stats report=smooth.csv finished=yes;
    save labels smooth.nii finished=yes"
out_has "finish    majority radius=2"
for kind in plain smooth; do
    for label in 1 2; do
        same "$(field $kind.csv $label voxels)" \
            "$(tail -c +353 $kind.nii | od -An -v -tu1 -w1 | grep -c "^ *$label\$")"
    done
done
same "$(field smooth.csv 1 gained)" ""
has_line smooth.json '"number": 2, "name": "", "voxels": '"$(field smooth.csv 2 voxels)," ||
    fail "$(cat smooth.json)"
expect 2 "$iftty" -c "open scene.nii; stats report=x.txt"
err_has "report: expected a name that ends in .json or .csv"
close_story

begin "what is answered of labels says which edits are not in it"
"$iftty" -c 'open scene.nii; seed 7,12,10 1; seed 2,2,2 2; run; save labels map.nii' >/dev/null ||
    fail "cannot segment"
for question in stats hints 'why 7,12,10' 'compare map.nii'; do
    expect 0 "$iftty" -c "open scene.nii; seed 7,12,10 1; $question; seed 2,2,2 0; $question"
    same "$(grep -c 'without the edit that waits for `run`' "$work/out")" 1
    same "$(grep -c 'without the 2 edits that wait for `run`' "$work/out")" 1
    expect 0 "$iftty" -c "open scene.nii; seed 7,12,10 1; seed 2,2,2 0; run; $question"
    ! grep -q 'without the' "$work/out" || fail "$(cat "$work/out")"
done
close_story

finish
