#!/bin/sh
# SPDX-License-Identifier: MIT
# iftty verify as a test tool: folders, parts of many journals, an early end, timings, orphans
# removed, and which journal is meant.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16

record() { # JOURNAL LABEL
    "$iftty" -c "open s.nii; seed 2,3,4 $2; seed 6,10,8 7; run; size 40 30; golden first" \
        --journal "$1" >/dev/null || fail "cannot record $1"
}
for n in 1 2 3 4 5 6; do record "j$n.iftty" $n; done
verified() { # the journals that the last verification took
    sed -n 's/^\(not \)\{0,1\}ok [0-9]* - \([^ ]*\).*/\2/p' out | tr '\n' ' '
}

begin "every journal is in one part, and stays there if others are added or it is moved"
for part in 1 2 3; do
    expect 0 "$iftty" verify --shard $part/3 j?.iftty
    verified >"part$part"
done
same "$(cat part1 part2 part3 | tr ' ' '\n' | sort | tr -d '\n')" \
    "j1.ifttyj2.ifttyj3.ifttyj4.ifttyj5.ifttyj6.iftty"
mkdir far
cp -r s.nii j?.iftty j?.golden far
record far/j0.iftty 8
for part in 1 2 3; do
    expect_in far 0 "$iftty" verify --shard $part/3 j?.iftty
    verified | sed 's/j0.iftty //' | cmp -s - "part$part" || fail "part $part has changed"
done
expect 0 "$iftty" verify --shard 2/2000 j1.iftty
same "$(cat out)" "1..0
# 0 verified, 0 failed"
for part in 1 2 3; do # it is missed by nobody
    expect 3 "$iftty" verify --shard $part/3 nothing.iftty
done
for wrong in 0/3 4/3 1 1/0 a/b 1/3x -1/3; do expect 2 "$iftty" verify --shard $wrong j1.iftty; done
rm -r far

begin "a folder means all journals in it and below, of any name"
deep=study/.hidden/deep/..more
line=$(printf 'two\nlines')
mkdir -p $deep "study/folder.iftty" "study/$line"
for folder in study study/.hidden $deep study/folder.iftty "study/$line"; do
    cp s.nii "$folder"
done
n=1
for journal in study/a.iftty study/.hidden/B.IFTTY $deep/c.Iftty study/folder.iftty/.d.iftty \
    "study/$line/e.iftty"; do
    cp j$n.iftty "$journal"
    cp -r j$n.golden "${journal%.iftty}.golden"
    : $((n += 1))
done
cp j1.iftty study/a.iftty.before-1 # by its name it is none
cp j1.iftty study/aiftty
mkfifo study/pipe
ln -s ../j6.iftty study/z.iftty
ln -s nowhere study/dangling
cp -r j6.golden study/z.golden
expect 0 "$iftty" verify study
same "$(sed 's/ (.*//' out)" 'ok 1 - study/.hidden/B.IFTTY
ok 2 - study/.hidden/deep/..more/c.Iftty
ok 3 - study/a.iftty
ok 4 - study/folder.iftty/.d.iftty
ok 5 - study/two\x0alines/e.iftty
ok 6 - study/z.iftty
1..6
# 6 verified, 0 failed'
[ ! -s err ] || fail "$(cat err)"
expect_in study 0 "$iftty" verify .
out_has "ok 3 - ./a.iftty ("
expect 0 "$iftty" verify j1.iftty study/ j2.iftty --json
same "$(sed -n 's/.*"journal": "\([^"]*\)".*/\1/p' out | sed '1p;6p;$!d' | tr '\n' ' ')" \
    'j1.iftty study/two\u000alines/e.iftty j2.iftty '
for part in 1 2 3; do
    expect 0 "$iftty" verify --shard $part/3 study
    grep '^ok' out
done >parts
same "$(wc -l <parts)" 6
ln -s ../far "study/way"
mkdir far
cp j6.iftty s.nii far
expect 0 "$iftty" verify study
err_has "# not entered: study/way is a link to a folder; name that folder as well to verify it"
same "$(tail -n 1 out)" "# 6 verified, 0 failed"
ln -s far road # but where it is named, it is meant
cp -r j6.golden far
expect_out "ok 1 - road/j6.iftty" 0 "$iftty" verify road
cp j1.golden/first.exr $deep/c.Iftty.golden # and one that differs is a failure as any other
expect 1 "$iftty" verify study --html page.html --junit report.xml
out_has "not ok 2 - study/.hidden/deep/..more/c.Iftty"
same "$(grep -c '<testcase' report.xml) $(grep -c '<failure' report.xml)" "6 1"
cp j3.golden/first.exr $deep/c.Iftty.golden

begin "a folder that cannot be entered, or has no journal, fails"
mkdir study/closed study/empty
chmod 0 study/closed
expect_err "cannot enter study/closed: Permission denied" 3 with_permissions "$iftty" verify study
chmod 700 study/closed
cp j1.iftty study/closed
chmod 400 study/closed
expect 3 with_permissions "$iftty" verify study
err_has "cannot enter study/closed/j1.iftty: Permission denied"
chmod 700 study/closed
rm -r study/closed
for folder in study/empty study/empty/ far/empty; do
    mkdir -p far/empty
    expect 1 "$iftty" verify j1.iftty "$folder"
    err_has "there is no journal *.iftty in $folder or below"
    [ ! -s out ] || fail "$(cat out)"
done
long=$(printf '%0250d' 0)
(
    cd far && for n in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17; do
        mkdir "$long" && cd -P "$long" || exit 1
    done
)
expect_err "cannot enter far/0" 3 "$iftty" verify far # not looked at, so not passed over
(cd far && rm -r 0*)
expect 2 "$iftty" verify
rm -r study far road

begin "a journal has the chain that is expected, or fails"
chain=$(last_word chain j1.iftty)
expect 0 "$iftty" verify j1.iftty --expect "$chain"
mkdir one
cp j1.iftty s.nii one
cp -r j1.golden one
expect 0 "$iftty" verify one --expect "$chain"
head -n "$(($(wc -l <j1.iftty) - 2))" j1.iftty >one/j2.iftty
expect 0 "$iftty" verify one/j2.iftty # its end is gone, and nothing in it says so
expect 1 "$iftty" verify one/j2.iftty --expect "$chain"
out_has "# its last chain is $(last_word chain one/j2.iftty), and $chain was expected"
for wrong in "--expect $chain j2.iftty" "--expect 12 --expect" "--expect ${chain}0" \
    "--expect $(echo "$chain" | tr a-f A-F)x"; do
    expect 2 "$iftty" verify j1.iftty $wrong
done
expect_err "--expect: expected one journal, not 2" 2 "$iftty" verify one --expect "$chain"
rm -r one

begin "bytes after the last record, which no chain covers, are none of the expected journal"
cp j1.iftty sound
for tail in '# reviewed by Dr X, all well\n' '\n' 'seed 1,1,1 1' '\0\0\0'; do
    cp sound j1.iftty
    printf "$tail" >>j1.iftty
    expect 0 "$iftty" verify j1.iftty
    for part in "" "--until 3"; do
        expect 1 "$iftty" verify j1.iftty --expect "$(last_word chain sound)" $part
        out_has "# --expect: it ends with an unfinished record, at byte $(file_bytes sound)"
    done
done
cp sound j1.iftty

begin "the first failure ends the run, and the remaining journals are named"
cp j2.golden/first.exr j1.golden/first.exr
expect 1 "$iftty" verify --fail-fast j3.iftty j1.iftty j2.iftty j4.iftty --junit report.xml
out_has "ok 1 - j3.iftty (6 commands" "not ok 2 - j1.iftty"
out_has "ok 3 - j2.iftty # SKIP not verified: another failed before"
same "$(tail -n 2 out)" "1..4
# 1 verified, 1 failed, 2 skipped"
grep -q 'tests="4" failures="1" errors="0" skipped="2"' report.xml || fail "$(cat report.xml)"
same "$(grep -c '<skipped/>' report.xml)" 2
expect 1 "$iftty" verify --fail-fast --json j1.iftty j2.iftty
out_has '"verified": false, "skipped": true'
expect 0 "$iftty" verify --fail-fast -j 3 j2.iftty j3.iftty j4.iftty

begin "a failure states if labels and voxels differ, or only colours"
expect_out "labels differ in " 1 "$iftty" verify j1.iftty
expect 0 "$iftty" -c "open s.nii; seed 2,3,4 3 ; seed 6,10,8 7; label 3 other #102030; run
    size 40 30; golden first" --journal dark.iftty
cp dark.golden/first.exr j3.golden/first.exr
expect_out "; colours alone differ, labels and voxels are the same" 1 "$iftty" verify j3.iftty
rm -r dark.*

begin "the slowest records of a journal"
expect 0 "$iftty" verify --timings j4.iftty
same "$(grep -cE '^#   took     [0-9]+\.[0-9]{3} ms, record [1-6]: [a-z]' out)" 6
grep '^#   took' out | sed 's/.*took *//; s/ ms.*//' >times
sort -rn times | cmp -s - times || fail "they are not in order: $(cat out)"
expect_out '"slowest": ["' 0 "$iftty" verify --timings --json j4.iftty

begin "orphan golden images are all listed, and removed on request"
cp j4.golden/first.exr j4.golden/third.exr
cp j4.golden/first.exr 'j4.golden/odd$(name);.exr'
cp j4.golden/first.png j4.golden/third.png
cp j4.golden/first.png j4.golden/lone.png
expect_out "#   orphan   third.exr" 1 "$iftty" verify j4.iftty j5.iftty
out_has '#   orphan   odd$(name);.exr' "#   orphan   lone.png"
expect 2 env CI=true "$iftty" verify --remove-orphans j4.iftty
expect 1 "$iftty" verify --remove-orphans j4.iftty j5.iftty # `golden` gives no such name
out_has "#   removed  third.exr"
out_has 'odd$(name);.exr was left alone: no record of this journal can have made it'
same "$(ls j4.golden | tr '\n' ' ')" 'first.exr first.png odd$(name);.exr '
rm 'j4.golden/odd$(name);.exr'
expect 0 "$iftty" verify --remove-orphans j4.iftty j5.iftty
expect 0 "$iftty" verify j4.iftty
# Of a journal that fails, nothing is removed: perhaps it is the journal that is wrong.
cp j1.golden/first.exr j1.golden/third.exr
expect 1 "$iftty" verify --remove-orphans j1.iftty
[ -e j1.golden/third.exr ] || fail "it was removed"

finish
