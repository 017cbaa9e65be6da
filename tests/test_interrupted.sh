#!/bin/sh
# SPDX-License-Identifier: MIT
# A run that was interrupted is repeated: it goes on after the last record where script and journal
# are of one run, and adds nothing where they are not. tests/test_crash.sh kills it.
. "$(dirname "$0")/lib.sh"

begin "an interrupted run continues after its last record of any kind"
mkdir again

cat >again/script <<'END'
# begins with a comment

open synth:geom:30x24x20
label 2 liver
# where it is bright
seed 7,12,10 liver
seed 2,2,2 1
stats
label 2 spleen
"seed" 3,3,3   radius=1 spleen
zoom fit
render
hint 1

labels map.nii label=3 regions=1
orient file
seed 4.2,3,8mm 0
undo
save labels map2.nii replace=yes
END
expect_in again 0 "$iftty" -c 'open synth:geom:30x24x20; seed 3,3,3 1; seed 20,20,15 2
    save labels map.nii'
expect_in again 0 "$iftty" run script --journal whole.iftty
records=$(grep -c '^= ' again/whole.iftty)
same "$records" 15
numbers=$(seq 1 "$records" | tr '\n' ' ')
head_of() { # of the whole, so many records
    awk -v last="$1" '{ print } /^= / && $2 == last { exit }' again/whole.iftty >again/k.iftty
}
for made in $(seq 1 "$records"); do
    for way in 'run script' 'run -' 'run pipe'; do
        rm -rf again/k.*
        cp -r again/whole.golden again/k.golden
        head_of "$made"
        case $way in
        'run script') expect_in again 0 "$iftty" run script --journal k.iftty ;;
        'run -') expect_in again 0 "$iftty" run - --journal k.iftty <again/script ;;
        *)
            rm -f again/pipe
            mkfifo again/pipe
            cat again/script >again/pipe &
            expect_in again 0 "$iftty" run pipe --journal k.iftty
            wait
            ;;
        esac
        same_files again/k.iftty again/whole.iftty
        same "$(sed -n 's/^ok \([0-9]*\) .*/\1/p' out | tr '\n' ' ')" "$numbers"
        if [ "$made" = "$records" ]; then
            err_has "k.iftty has all of " ", $records records: nothing is left to do"
        else
            err_has "k.iftty has the lines before line " ", $made record"
        fi
    done
done

begin "the ring of an outline, where the journal is gone on with, is the one recorded"
mkdir ring
cat >ring/script <<'END'
open synth:geom:30x24x20
seed 7,12,10 2 radius=2
seed 14,12,10 1 radius=2
seed 2,2,2 0
run
outline 5,9,10 2 to=10,9,10 to=10,15,10 to=5,15,10
seed 24,12,10 1
stats
END
expect_in ring 0 "$iftty" run script --journal whole.iftty
grep -q ' spared=[1-9]' ring/whole.iftty || fail "nothing is left out: $(cat ring/whole.iftty)"
for made in 6 7; do
    awk -v last=$made '{ print } /^= / && $2 == last { exit }' ring/whole.iftty >ring/k.iftty
    rest=$(sed "1,${made}d" ring/script | paste -sd ';' -)
    expect_in ring 0 "$iftty" -c "$rest" --journal k.iftty
    same_files ring/k.iftty ring/whole.iftty
done

begin "one that is another than the script is named, and nothing is added to it"
beginning() {
    rm -rf again/k.*
    head_of "$1"
    cp again/k.iftty again/former
}
differs() { # WORDS: this line, and this record
    expect_in again 3 "$iftty" run other --journal k.iftty
    err_has "$1" "the journal has another run, or was continued; nothing was added to it"
    same "$(wc -l <err)" 1
    same_files again/k.iftty again/former
}
beginning 5
sed 's/seed 2,2,2 1/seed 2,2,2 1 radius=1/' again/script >again/other
differs 'other:7: this line is `seed 2,2,2 1 radius=1`, and record 4 of k.iftty is `seed 2,2,2 1`'
sed '/^seed 2,2,2/d' again/script >again/other
differs 'other:8: this line is `label 2 spleen`, and record 4 of k.iftty is `seed 2,2,2 1`'
sed '6a label 9 more' again/script >again/other
differs 'other:7: this line is `label 9 more`, and record 4'
sed '6a labell 9 more' again/script >again/other
differs 'other:7: this line is `labell 9 more`, and record 4'
sed 6q again/script >again/other
differs 'other:7: the script ends, and record 4 of k.iftty is `seed 2,2,2 1`'
sed 's/30x24x20/20x20x20/' again/script >again/other
differs 'other:3: this line is `open synth:geom:20x20x20`, and record 1 of k.iftty is `open '
beginning 7
cp again/script again/other
sed -i 's/zoom fit/zoom 2/' again/script
beginning 8
sed 's/radius=1//' again/script >again/other.shorter
mv again/script again/changed
mv again/other again/script
cp again/changed again/other
differs 'other:11: this line is `zoom 2`, and record 8 of k.iftty is `zoom '
mv again/other.shorter again/other
differs 'other:10: this line is `"seed" 3,3,3    spleen`, and record 7 of k.iftty is `seed 3,3'
beginning 5
for line in 'undo' 'branch other' 'seed 9,9,9 1'; do # somebody went on by hand
    beginning 4
    expect_in again 0 "$iftty" -c "$line" --journal k.iftty
    cp again/k.iftty again/former
    cp again/script again/other
    differs "and record 5 of k.iftty is \`$line\`"
done

begin "file names lead to the same files for any folder of the journal and any current folder"
mkdir -p far/subj far/out far/home far/tables
make_scene far/subj/s.nii 24 20 16
make_scene far/subj/m.nii 24 20 16
ln -s s.nii far/subj/link.nii
printf '3,3,3,1\n9,9,9,1\n' >"far/tables/a b.csv"
cat >far/script <<'END'
open subj/link.nii
mask ./subj/m.nii regions=1-255
weight ~/w.nii
seed-file "tables/a b.csv" label=1
seed 20,15,12 2
run
END
cp far/subj/m.nii far/home/w.nii
HOME=$work/far/home expect_in far 0 "$iftty" run script --journal out/whole.iftty
for made in 1 2 3 4 5 6; do
    awk -v last="$made" '{ print } /^= / && $2 == last { exit }' far/out/whole.iftty \
        >far/out/k.iftty
    HOME=$work/far/home expect_in far 0 "$iftty" run script --journal out/k.iftty
    same_files far/out/k.iftty far/out/whole.iftty
done
sed 's/link.nii/m.nii/' far/script >far/other
HOME=$work/far/home expect_in far 3 "$iftty" run other --journal out/k.iftty
err_has 'other:1: this line is `open subj/m.nii`, and record 1 of out/k.iftty is `open ../subj/link'

begin "the journal keeps its comments if those of the script changed, and the run reports it"
beginning 5
sed 's/# where/# and where/' again/script >again/other
expect_in again 0 "$iftty" run other --journal k.iftty
err_has "the comments before its record 3 are others than those of the script; they stay"
same_files again/k.iftty again/whole.iftty

begin "signed records: names, times and sessions, which no script carries to another record"
printf '# why\nopen synth:geom:20x20x20\n#@ who=else session=9\nseed 5,5,5 1\n' >"$work/signed"
expect_in . 0 "$iftty" run signed --journal s.iftty --who jane --times
expect_in . 0 "$iftty" run signed --journal s.iftty --who jane --times
same "$(grep -c '^#@ who=jane at=20..-..-..T..:..:..Z session=1$' "$work/s.iftty")" 2
err_has "nothing is left to do"
grep "others than those" "$work/err" && fail "lines that sign count as comments"
same "$(grep -c 'else' "$work/s.iftty")" 0
expect_in . 0 "$iftty" -c "seed 9,9,9 2" --journal s.iftty --who bob
expect_in . 0 "$iftty" -c "seed 9,9,8 2" --journal s.iftty
expect_in . 0 "$iftty" log --times s.iftty
sed 's/ 20..-..-..T..:..:..Z / TIME /' "$work/out" >"$work/times"
same "$(cat "$work/times")" "1 TIME jane 1 open synth:geom:20x20x20 weight=morph
2 TIME jane 1 seed 5,5,5 1
3 - bob 2 seed 9,9,9 2
4 - - - seed 9,9,8 2"
expect_in . 0 "$iftty" log --script s.iftty
same "$(head -n 2 "$work/out")" "# why
open synth:geom:20x20x20 weight=morph"
expect_in . 0 "$iftty" log --anonymise s.iftty
same "$(grep -c '#\|jane' "$work/out")" 0
expect_in . 0 "$iftty" verify s.iftty
expect_in . 2 "$iftty" run signed --journal w.iftty --whole --who jane
err_has "--whole makes the same journal each time, and excludes --who and --times"
expect_in . 2 "$iftty" run signed --journal w.iftty --who "jane doe"
err_has "--who: expected a name of 1 to 64 bytes without blanks, not jane doe"

begin "lines that failed under --keep-going have no record, and fail again"
rm -rf again/k.*
sed '6a seed 99,99,99 1' again/script >again/other
expect_in again 3 "$iftty" run other --journal k.iftty --keep-going
same_files again/k.iftty again/whole.iftty
for made in 2 3 9; do
    beginning $made
    expect_in again 3 "$iftty" run other --journal k.iftty --keep-going
    same_files again/k.iftty again/whole.iftty
done

begin "a question after the last record is asked again, and its report is left alone"
rm -rf again/k.*
{ sed '$d' again/script; echo run; echo 'stats report=report.csv'; } >again/other
expect_in again 0 "$iftty" run other --journal k.iftty
cp again/k.iftty again/former
expect_in again 0 "$iftty" run other --journal k.iftty
err_has "other:20: report.csv exists already and was left alone"
same_files again/k.iftty again/former

begin "with --whole the journal appears when all is done, to the same bytes, wherever it was killed"
for made in 0 1 $(seq 4 3 "$records"); do
    rm -rf again/k.*
    cp -r again/whole.golden again/k.golden
    [ "$made" = 0 ] || { head_of "$made" && mv again/k.iftty again/k.iftty.part; }
    expect_in again 0 "$iftty" run script --journal k.iftty --whole
    same_files again/k.iftty again/whole.iftty
    same "$(cd again && echo k.*)" "k.golden k.iftty"
done
for shows in '' --json; do # and once more
    expect_in again 0 "$iftty" run script --journal k.iftty --whole $shows
    same_files again/k.iftty again/whole.iftty
done
out_has "{\"done\": true, \"journal\": \"k.iftty\", \"records\": $records, \"chain\": \""
expect_in again 0 "$iftty" verify k.iftty
{ cat again/script; echo 'golden last'; } >again/other
expect_in again 0 "$iftty" run other --journal l.iftty --whole
expect_in again 0 "$iftty" verify --strict l.iftty
grep -aq 'l\.iftty' again/l.golden/last.exr || fail "the golden image does not name the journal"
grep -aq 'iftty\.part' again/l.golden/last.exr && fail "the golden image names the part"

begin "a failed run remains a FILE.part; a complete journal is never extended"
rm -rf again/k.*
sed '6a seed 99,99,99 1' again/script >again/other
for way in '' --keep-going; do
    expect_in again 3 "$iftty" run other --journal k.iftty --whole --json $way
    same "$(cd again && echo k.ift*)" "k.iftty.part"
    grep -q '^{"done": false,' out || fail "another summary: $(cat out)"
done
expect_in again 0 "$iftty" run script --journal k.iftty --whole
{ cat again/script; echo 'seed 3,3,3 2'; } >again/other
expect_in again 3 "$iftty" run other --journal k.iftty --whole
err_has "k.iftty is complete, and the script has more commands: nothing was added"
sed 's/zoom fit/zoom 3/' again/script >again/other
expect_in again 3 "$iftty" run other --journal k.iftty --whole
err_has "the journal has another run"
same_files again/k.iftty again/whole.iftty
expect_in again 2 "$iftty" run script --whole
err_has "needs --journal FILE"

begin "a script that opens no scene adds to the journal, as ever"
beginning 5
printf '# more\nlabel 7 seven\nseed 1,1,1 7\n' >again/other
for times in 1 2; do
    expect_in again 0 "$iftty" run other --journal k.iftty
    expect_in again 0 "$iftty" run - --journal k.iftty <again/other
done
same "$(grep -c '^= ' again/k.iftty)" 13
same "$(grep -c '^# more' again/k.iftty)" 4
beginning 7
printf '# who\nwhy 1,1,1\nopen synth:geom:30x24x20\n' >again/other
mkfifo again/questions
cat again/other >again/questions &
expect_in again 2 "$iftty" run questions --journal k.iftty # which applies what waits
err_has "questions:3: a scene is open already"
wait
same "$(tail -n +2 again/k.iftty | grep -v '^=' | tail -n 1)" "run for=why"
rm -rf again/k.*
expect_in again 0 "$iftty" -c 'label 7 seven' --journal k.iftty # without a scene yet
expect_in again 0 "$iftty" run script --journal k.iftty
same "$(grep -c '^= ' again/k.iftty)" 16

finish
