#!/bin/sh
# SPDX-License-Identifier: MIT
# `stats` through the program: its text, its reports, finished labels, and the change by the last
# edit compared with counts before and after it. tests/test_stats.c tests the counting itself.
. tests/lib.sh
make_scene scene.nii 30 24 20

field() { # FILE LABEL NAME: from a report in CSV
    awk -F, -v label="$2" -v name="$3" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) at = i }
        $1 == label { print $at }' "$1"
}

begin "counts before and after an edit differ by the reported changes, undone or not"
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

begin "changes of the last edit are reported, with and without a list, for any number of threads"
for threads in 1 3; do
    mkdir $threads
    sed "s|report=|report=$threads/|" script >threaded
    IFTTY_THREADS=$threads expect 0 "$iftty" run threaded
done
for number in 0 1 2 3 4; do same_files 1/$number.csv 3/$number.csv; done
grep -q "the last edit added [0-9]* voxels* to it and removed [0-9]*: [+-][0-9.]* m" "$work/out" ||
    fail "$(cat "$work/out")"
expect 0 "$iftty" -c "open scene.nii; seed 7,12,10 1; seed 2,2,2 0; run; stats report=all.csv;
    weight difference; stats report=anew.csv"
same "$(field all.csv 1 change)" "$(field all.csv 1 voxels)"
same "$(field all.csv 1 gained)" ""
same "$(field anew.csv 1 change)" "$(($(field anew.csv 1 voxels) - $(field all.csv 1 voxels)))"
[ "$(field anew.csv 1 change)" != 0 ] || fail "other weights have changed nothing"
grep -q "the last edit changed it by [+-][0-9.]* m" "$work/out" || fail "$(cat "$work/out")"

begin "where the place in the world is not known, no millimetres of it are printed"
expect 0 "$iftty" -c "open scene.nii; info; seed 7,12,10 1; run; stats report=place.csv"
out_has "orientation unknown" "centre "
! grep -q "centre.* mm" "$work/out" || fail "$(cat "$work/out")"
same "$(field place.csv 1 centre_x_mm)" ""

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
has_line smooth.json '"name": "", "code": "", "voxels": '"$(field smooth.csv 2 voxels)," ||
    fail "$(cat smooth.json)"
expect 2 "$iftty" -c "open scene.nii; stats report=x.txt"
err_has "report: expected a name that ends in .json or .csv"

begin "commands that show, write or answer from labels apply pending edits, as a run does"
expect 0 "$iftty" -c 'open scene.nii; seed 7,12,10 1; seed 2,2,2 2; run; save labels map.nii'
applied="as \`run\` does"
for asks in 'stats' 'stats report=REPORT.csv' hints 'why 7,12,12' 'profile 2,2,2 9,12,10' \
    'compare map.nii' 'compare map.nii report=REPORT.csv' 'slice axial 10 REPORT.png' \
    'mosaic REPORT.png' 'golden g of=coronal' 'golden g' 'render REPORT.png' 'spin 2 REPORT.gif' \
    'save labels REPORT.nii' 'save seeds REPORT.csv'; do
    rm -rf j.golden r.golden
    for way in run wait; do
        [ $way = run ] && first=run || first='landmark A 1,1,1'
        rm -f j.iftty REPORT.*
        expect 0 "$iftty" -c "open scene.nii; seed 7,12,10 1; seed 2,2,2 2; $first; $asks" \
            --journal j.iftty
        grep -v "^ok\|$applied\| changed, \|stored as\|kept" "$work/out" >$way.said
        for file in REPORT.*; do [ ! -e "$file" ] || mv "$file" "$way.${file##*.}"; done
        expect 0 "$iftty" verify j.iftty
        last_word labels j.iftty >$way.labels
        [ $way = run ] || expect 0 "$iftty" -c info --journal j.iftty
    done
    out_has "2 seeds, 0 edits pending"
    same_files run.said wait.said
    same_files run.labels wait.labels
    for file in run.csv run.nii; do [ ! -e $file ] || same_files $file wait.${file##*.}; done
    rm -f run.* wait.*
done

begin "edits applied by a question are recorded as a run, and undone as one"
rm -f j.iftty
expect 0 "$iftty" -c 'open scene.nii; seed 7,12,10 1; stats; stats; seed 2,2,2 2; why 7,12,12
    undo; info; stats; undo 2; info' --journal j.iftty
same "$(grep -c "applied the pending edit, $applied" "$work/out")" 3
same "$(sed -n 's/^ok \([0-9-]*\) \(stats\|why\).*/\1/p' "$work/out" | tr '\n' ' ')" "3 - 5 7 "
same "$(grep '^[a-z]' j.iftty | tail -n +3 | tr '\n' ';')" \
    "run for=stats;seed 2,2,2 2;run for=why;undo;run for=stats;undo 2;"
out_has "1 seed, 1 edit pending" # after undo
out_has "1 seed, 0 edits pending" # after the second
expect 0 "$iftty" verify j.iftty
expect_out "1 edit pending" 0 "$iftty" -c 'redo; info' --journal j.iftty
expect 0 "$iftty" -c 'finish majority; stats finished=yes' --journal j.iftty
words_of j.iftty "$(grep -c '^= ' j.iftty)" | grep -q '^forest=[^ ]* labels=[^ ]* seeds=2$' ||
    fail "$(tail -n 1 j.iftty)" # those of a run alone
expect 0 "$iftty" verify j.iftty

begin "where no seed is planted, an answer says so; a question that fails applies nothing"
for asks in stats 'stats report=none.csv' 'compare map.nii'; do
    expect 0 "$iftty" -c "open scene.nii; $asks; seed 7,12,10 1; stats"
    same "$(grep -c 'no seed is planted: no voxel has a label' "$work/out")" 1
done
rm -f j.iftty
expect 3 "$iftty" -c 'open scene.nii; seed 7,12,10 1; compare none.nii' --journal j.iftty
same "$(grep -c '^= ' j.iftty)" 2
expect_out "0 seeds, 1 edit pending" 0 "$iftty" -c info --journal j.iftty

begin "commands that use the shown picture report the edits that it does not include"
for asks in 'pick 32 32' 'hint 1' 'zoom fit'; do
    expect 0 "$iftty" -c "open scene.nii; size 64 64; seed 7,12,10 1; seed 2,2,2 2; render
        seed 9,9,9 3; $asks; seed 9,9,8 3; $asks; render; $asks"
    same "$(grep -c 'not included: the pending edit (`run` applies it)' "$work/out")" 1
    same "$(grep -c 'not included: the 2 pending edits (`run` applies them)' "$work/out")" 1
done

finish
