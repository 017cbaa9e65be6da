#!/bin/sh
# SPDX-License-Identifier: MIT
# iftty diff: where two journals part, how far their labels differ, the picture of it, and that a
# journal is trusted no more than by verify. The pure parts are in tests/test_diff.c.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16

# record JOURNAL COMMANDS: the common commands, and these
record() {
    "$iftty" -c "open s.nii; label 1 liver; seed 2,3,4 0; seed 6,10,8 1; $2" --journal "$1" \
        >/dev/null || fail "cannot record $1"
}
record a.iftty 'seed 20,10,8 2; run; size 60 50; view 30 20'
record b.iftty 'seed 20,12,3 2 radius=1; seed 3,15,12 3; label 3 spleen; run'
cp a.iftty plain.iftty
proof=$(tr ' ' '\n' <a.iftty | grep -E '=[0-9a-f]{64}$' | sed 's/.*=//')

begin "a journal and itself"
same "${#proof}" 64
expect_out "commands  8, all equal" 0 "$iftty" diff a.iftty a.iftty
out_has "scenes    the same: 24x20x16 voxels, SHA-256 $proof" "voxels    0 of 7680 differ"
grep -qE '^1 liver +1\.0000 ' out || fail "$(cat out)"
[ ! -s err ] || fail "it warns: $(cat err)"

begin "the first command at which two part, and every figure as the label maps have it"
expect_err "of 7680 voxels have another label" 1 "$iftty" diff a.iftty b.iftty
out_has "commands  4 equal, then they differ" "    A  a.iftty, command 5, line 10: seed 20,10,8 2"
out_has "    B  b.iftty, command 5, line 10: seed 20,12,3 2 radius=1"
cp out told
for n in a b; do
    "$iftty" -c "save labels $n.nii" --journal "$n.iftty" >/dev/null || fail "no labels of $n"
    voxels_of "$n.nii" | od -An -v -tu1 -w1 >"$n.labels"
done
paste a.labels b.labels | awk '
    { a[$1]++; b[$2]++; if ($1 == $2) both[$1]++; else differ++ }
    END { for (l = 1; l < 4; l++) {
              s = a[l] + b[l]; d = int((40000 * both[l] + s) / (2 * s))
              printf "%d %d.%04d %d %d %d\n", l, d / 10000, d % 10000, a[l], b[l], both[l] }
          printf "voxels %d of %d differ\n", differ, NR }' >expected
sed -nE 's/^([0-9]) (liver|spleen|) *([0-9.]*) *([0-9]*) *([0-9]*) *([0-9]*)$/\1 \3 \4 \5 \6/p
        s/^voxels *(.* differ)/voxels \1/p' told >figures
same_files figures expected
grep -q '^3 spleen' told || fail "no name that B alone has: $(cat told)"

begin "the same for programs"
expect 1 "$iftty" diff --json a.iftty b.iftty
"$PYTHON" - <<'EOS' >"$work/figures" || fail "no JSON: $(cat out)"
import json
d = json.load(open('out'))
assert d['parts'] and d['a']['command'] == 'seed 20,10,8 2' and d['b']['line'] == 10
assert d['same_scene'] and d['size'] == [24, 20, 16]
for l in d['labels']:
    print(l['label'], '%d.%04d' % divmod(l['dice_ten_thousandths'], 10000),
        l['a'], l['b'], l['both'])
print('voxels', d['differing'], 'of', d['voxels'], 'differ')
EOS
same_files figures expected

begin "a label has its own name, whatever name the other journal has at its index"
printf 'open s.nii\nlabel 300 ghost\nlabel 400 solid\nseed 2,3,4 400\nrun\n' >ghost.txt
printf 'open s.nii\nlabel 500 other\nseed 2,3,4 500\nrun\n' >other.txt
expect 1 "$iftty" diff ghost.txt other.txt
grep -qE '^500 other ' out || fail "$(cat out)"

begin "comments, results and questions are no commands"
"$iftty" log --script a.iftty | grep -v '^save' | sed 's/^run$/# why\ninfo\nrun/' >a.txt
expect_out "commands  8, all equal" 0 "$iftty" diff a.txt plain.iftty
sed 's/^run$/# by hand\nrun/' a.iftty >hand.iftty
expect_out "commands  9, all equal" 0 "$iftty" diff a.iftty hand.iftty
err_has "# hand.iftty was edited by hand; it reproduces its recorded results"

begin "up to a record"
expect_out "commands  4, all equal" 0 "$iftty" diff a.iftty b.iftty --until 4
err_has "# a.iftty ends with pending edits"
expect 2 "$iftty" diff a.iftty b.iftty --until 0

begin "scenes that are not the same"
mkdir other larger
make_scene other/s.nii 24 20 16
flip_byte other/s.nii 4000
make_scene larger/s.nii 25 20 16
cp a.txt other
cp a.txt larger
expect 0 "$iftty" diff a.txt a.txt
"$iftty" diff a.txt other/a.txt >out 2>err
[ $? -lt 2 ] || fail "$(cat err)"
out_has "commands  8, all equal" "scenes    not the same; both have 24x20x16 voxels"
err_has "# the scenes are not the same: voxels were compared place by place"
expect 3 "$iftty" diff a.txt larger/a.txt
err_has "scenes of 24x20x16 and 25x20x16 voxels: expected two of one size"
expect 0 "$iftty" diff a.txt larger/a.txt --scene s.nii

begin "the picture: three panes, whole, over nothing"
expect 1 "$iftty" diff a.iftty b.iftty --picture d.png
"$iftty" info d.png >info
grep -q '184x' info || fail "not three views of 60 and two seams: $(cat info)"
grep -q "iftty:differ: $(sed -n 's/voxels *\(.*\) differ/\1/p' told) voxels" info ||
    fail "$(cat info)"
cp d.png kept.png
expect_err "d.png" 3 "$iftty" diff a.iftty b.iftty --picture d.png
[ ! -s out ] || fail "it carried out before it looked"
same_files d.png kept.png
expect 1 "$iftty" diff a.iftty b.iftty --picture d2.png
same_files d.png d2.png
expect_err "expected a name that ends in .png" 2 "$iftty" diff a.iftty b.iftty --picture d.exr
expect 3 "$iftty" diff a.iftty b.iftty --picture nowhere/d.png
expect 0 "$iftty" diff a.iftty a.iftty --picture same.png

begin "a picture of a private scene does not name the journals"
sed 's/^open s.nii/& private=yes/' a.txt >private.txt
cp private.txt another.txt
expect 0 "$iftty" diff private.txt private.txt --picture one.png
expect 0 "$iftty" diff another.txt another.txt --picture two.png
same_files one.png two.png

begin "a journal is trusted no more than by verify"
mkdir inside
{ grep -v '^open' a.txt | sed '1s/^/open ..\/s.nii\n/'; } >inside/out.txt
expect_err "inside/out.txt: " 3 "$iftty" diff inside/out.txt a.txt
{ cat a.txt; echo 'render r.png'; echo 'save labels l.nii'; echo 'golden g'; } >writes.txt
listing . | grep -vE ' ./(out|err|before|d)$' >before
expect 0 "$iftty" diff writes.txt a.txt
listing . | grep -vE ' ./(out|err|before|d)$' | diff before - >d || fail "$(cat d)"
expect_err "--limit-memory" 3 "$iftty" diff a.txt a.iftty --limit-memory 1M

begin "an error of comparison is one line that names the file"
expect 3 "$iftty" diff a.iftty missing.iftty
expect_err 'expected `iftty diff A B`, and there is 1 operand' 2 "$iftty" diff a.iftty
expect 2 "$iftty" diff a.iftty a.iftty a.iftty
echo '# nothing' >empty.txt
expect_err "empty.txt: it opens no scene" 3 "$iftty" diff a.iftty empty.txt
sed 's/^= \([0-9]*\) forest=[0-9a-f]*/= \1 forest=0123456789abcdef/' a.iftty >lies.iftty
expect 3 "$iftty" diff a.iftty lies.iftty
err_has "lies.iftty: its results differ from the recorded ones; see iftty verify"
head -c 300 a.iftty >torn.iftty
expect_err "# torn.iftty ends with an unfinished record" 0 "$iftty" diff torn.iftty torn.iftty
printf 'open s.nii\nseed 999,1,1 1\n' >bad.txt
expect_err "bad.txt: " 3 "$iftty" diff bad.txt a.iftty
err_has "(line 2)"
same "$(wc -l <err)" 1

begin "Ctrl-C ends the processes; one that dies is named"
echo 'open synth:geom:222' >large.txt
echo 'seed 100,100,50 1' >>large.txt
echo 'run' >>large.txt
for n in 1 2 3 4 5 6 7 8; do echo 'adjacency 26'; echo 'adjacency 6'; done >>large.txt
# catch_child PROGRAM: its process, once there
catch_child() {
    comes_true has_child "$1"
}
has_child() {
    child=
    read -r child _ <"/proc/$1/task/$1/children"
    [ -n "$child" ]
}
env --default-signal=INT "$iftty" diff large.txt large.txt >out 2>err &
program=$!
catch_child "$program"
sleep 0.2
kill -INT "$program"
wait "$program"
same "$?" 130
[ ! -e "/proc/$child" ] || fail "$child outlives it"
"$iftty" diff large.txt large.txt >out 2>err &
program=$!
catch_child "$program"
sleep 0.2
kill -ABRT "$child" # which no sanitiser catches
wait "$program"
same "$?" 3
err_has "large.txt: its process was ended by signal 6 (Aborted)"

finish
