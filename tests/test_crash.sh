#!/bin/sh
# SPDX-License-Identifier: MIT
# The program is killed while it works, golden images, renditions, maps and surfaces among it: a run
# that was killed or cut at any byte continues when it is repeated, and its journal is in the end
# that of one which was not, byte for byte. test_kill kills sessions at random moments.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16

commands() { # 200 of them
    echo 'open s.nii'
    echo '# a comment that belongs to the next command'
    echo 'size 16 16'
    awk 'function place(i) { return i * 7 % 24 "," i * 3 % 20 "," i * 5 % 16 }
    BEGIN {
        for (i = 0; i < 198; i++) {
            if (i % 20 == 3) print "run"
            else if (i % 20 == 7) print "render mode=" (i % 40 == 7 ? "ii" : "bp")
            else if (i % 50 == 11) print "adjacency " (i % 100 == 11 ? 26 : 6)
            else if (i % 50 == 13) print "auto " (i % 100 == 13 ? "on" : "off")
            else if (i % 20 == 17) print "remove " place(i - 1)
            else if (i == 19) print "golden first"
            else if (i == 28) print "render r.exr replace=yes"
            else if (i == 39) print "save labels l.nii.gz replace=yes"
            else if (i == 52) print "save surface s.stl replace=yes"
            else if (i == 74) print "spin 2 t%d.png replace=yes"
            else if (i == 169) print "golden second of=mosaic"
            else print "seed " place(i) " " i % 9
        } }'
}
commands >script
sed '/^#/d; s/^open .*/& weight=morph/' script >canonical

begin "the whole script, undisturbed"
expect 0 "$iftty" run script --journal whole.iftty
same "$(grep -c '^ok ' out)" 200
expect 0 "$iftty" verify whole.iftty
"$iftty" log --script whole.iftty | grep -v '^#' | cmp -s - canonical ||
    fail "the journal holds other commands"

# resumes JOURNAL: it continues, verifies, and has the beginning of the script
resumes() {
    expect 0 "$iftty" run - --journal "$1" </dev/null
    expect 0 "$iftty" log --check "$1"
    expect 0 "$iftty" log --script "$1"
    grep '^[a-z]' out >kept
    kept=$(wc -l <kept)
    head -n "$kept" canonical | cmp -s - kept || fail "$1 holds what was not written"
}
bytes=$(file_bytes whole.iftty)
seed=12345 cuts='1 10 28 29 30 31 60'
for before in 1 2 33 34 40 60; do cuts="$cuts $((bytes - before))"; done
for _ in 1 2 3 4 5 6 7 8 9 10 11 12; do
    seed=$(((seed * 1103 + 12345) % 1000003))
    cuts="$cuts $((30 + seed % (bytes - 30)))"
done

begin "repeating a killed run continues it, to the same bytes"
trial=0 early=0
for after in 1 3 25 60 130 196; do
    trial=$((trial + 1)) journal=again$trial.iftty
    : >acks
    "$iftty" run script --journal $journal >acks 2>errors &
    victim=$!
    tries=0
    until [ "$(grep -c '^ok' acks)" -ge "$after" ] || [ $((tries += 1)) -gt 40000 ]; do :; done
    kill -9 "$victim" 2>/dev/null
    wait "$victim" 2>/dev/null
    [ ! -s errors ] || fail "trial $trial: $(cat errors)"
    had=$(grep -c '^= .*chain=[0-9a-f]*$' $journal)
    [ "$had" -lt 200 ] && early=$((early + 1))
    expect 0 "$iftty" run script --journal $journal
    same "$(grep -c '^ok ' out)" 200
    cmp -s $journal whole.iftty || fail "trial $trial: $(diff $journal whole.iftty | head -4)"
    expect 0 "$iftty" verify $journal
done
[ "$early" -gt 2 ] || fail "only $early of $trial were killed in the middle"
echo "# $trial times, $early of them in the middle"

begin "cut at any byte, and run again: the same bytes"
for cut in $cuts; do
    rm -rf again.iftty* again.golden
    head -c "$cut" whole.iftty >again.iftty
    expect 0 "$iftty" run script --journal again.iftty
    same_files again.iftty whole.iftty
done

begin "a torn tail is reported and saved, and not changed by readers"
head -c $((bytes - 7)) whole.iftty >t.iftty
cp -r whole.golden t.golden
cp t.iftty t.kept
expect_out "an unfinished record at byte" 0 "$iftty" verify t.iftty
expect 0 "$iftty" replay t.iftty --out replayed
expect 0 "$iftty" log t.iftty
same_files t.iftty t.kept
echo occupied >t.iftty.torn-1
expect_err "t.iftty.torn-2" 0 "$iftty" run - --journal t.iftty </dev/null
same "$(wc -l <err)" 1
same "$(cat t.iftty.torn-1)" occupied
cat t.iftty t.iftty.torn-2 | cmp -s - t.kept || fail "bytes are lost"

begin "an empty journal is started again"
: >e.iftty # as it is if its writer was killed before it wrote the header
expect 0 "$iftty" verify e.iftty
expect 1 "$iftty" verify --strict e.iftty
expect 0 "$iftty" run script --journal e.iftty
same_files e.iftty whole.iftty

begin "the reader of the acknowledgements goes away"
{ commands; } | "$iftty" run - --journal p.iftty 2>errors | head -n 3 >/dev/null
resumes p.iftty
expect 0 "$iftty" verify p.iftty

finish
