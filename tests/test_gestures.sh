#!/bin/sh
# SPDX-License-Identifier: MIT
# iftty diff --gestures: what an expert and a trainee did, counted by hand; Dice after each step as
# the saved maps of each beginning have it; the picture; and that a journal is trusted no more than
# by verify. Which gestures are matched: tests/test_gesture_match.c.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
make_scene s.nii 24 20 16

# record JOURNAL COMMANDS: what all begin with, and these
record() {
    "$iftty" -c "open s.nii; label 1 liver; $2" --journal "$1" >/dev/null ||
        fail "cannot record $1"
}
record e.iftty 'seed 2,3,4 0; seed 6,10,8 1 radius=1; seed 20,10,8 2 to=20,14,8 to=22,14,8; run
    box 18,2,2 21,4,3 0; auto on; seed 8,10,8 1 radius=2; undo; seed 7,10,9 1
    remove 7,10,9; fill 2,15,3 2 to=5,15,3 to=4,18,3; seed 12,10,8 1 radius=3 shell=yes'
record t.iftty 'auto on; seed 20,11,8 2 to=20,14,8; seed 6,10,8 1 radius=1; seed 2,3,4 0
    seed 10,18,14 2; goto 6; branch second; seed 11,2,2 1 radius=2; weight gauss 1; weight morph'

begin "gestures are counted by hand, and none has a time"
expect 0 "$iftty" diff --gestures e.iftty t.iftty
[ ! -s "$work/err" ] || fail "it warns: $(cat "$work/err")"
cp out told
tr -s ' ' <told | sed 's/ $//' >words
for line in 'seed 2 2' 'ball 2 2' 'stroke 1 1' 'shell 1 0' 'box 1 0' 'fill 1 0' \
    'eliminator 1 0' 'undo 1 0' 'goto 0 1' 'all 10 6' 'taken back 1 1' \
    'time a journal records none'; do
    grep -qxF "$line" words || fail "no '$line': $(cat words)"
done
# The expert's box is at 19.5,3,2.5, farther than 2.4 mm from all; the stroke's middles are 21,12,8
# and 20,12.5,8.
out_has "farther than 2.40 mm:"
out_has "3 matched, 5 of the expert and 1 of the trainee not"
grep -qxE '2 2 1 1 1.12 1.12 [0-9.]*' words || fail "no stroke: $(cat words)"
grep -qxE '1 liver 3 2 1 0.00 0.00 [0-9.]*' words || fail "no ball: $(cat words)"
out_has "Kendall's tau -3/3 (-1.0000); the longest common order has 1 of 3 matched"
close_story

begin "Dice after each step is that of the maps which each beginning leads to"
expect 0 "$iftty" diff --gestures e.iftty t.iftty --json
cp out told.json
maps() { # JOURNAL: NAME.N.raw after each record, by a script of that many
    name=${1%.iftty}
    "$iftty" log --script "$1" >all.txt
    for n in $(seq "$(wc -l <all.txt)"); do
        ! grep -q "^= $n .*pending=" "$1" || continue
        { head -n "$n" all.txt; echo "save labels $name.$n.nii replace=yes"; } >some.txt
        "$iftty" run some.txt >/dev/null 2>&1 && tail -c +353 "$name.$n.nii" >"$name.$n.raw"
    done
}
# Where edits wait, `save` would apply them: such beginnings are left out.
maps e.iftty
maps t.iftty
if needs python3; then
    python3 - <<'EOS' || fail "they differ"
import json, os
d = json.load(open('told.json'))
assert d['a']['gestures'] == 10 and d['b']['gestures'] == 6 and d['same_scene']
assert d['order'] == {'agreeing': 0, 'disagreeing': 3, 'tau': -1, 'longest_common': 1}
assert [m['mm'] for m in d['matched']][1] == 0 and len(d['matched']) == 3
assert len(d['unmatched_a']) == 5 and len(d['unmatched_b']) == 1
assert 'time' not in d
def voxels(name): return open(name, 'rb').read()
def dice(a, b, labels):
    n = sum(x in labels for x in a) + sum(x in labels for x in b)
    both = sum(x == y and x in labels for x, y in zip(a, b))
    return (2 * 2 * both * 10000 + n) // (2 * n) if n else 10000
end = voxels('e.%d.raw' % max(int(f.split('.')[1]) for f in os.listdir('.')
                              if f.startswith('e.') and f.endswith('.raw')))
steps = 0
for side, name in (('steps_a', 'e'), ('steps_b', 't')):
    for step in d[side]:
        if not os.path.exists('%s.%d.raw' % (name, step['record'])):
            continue
        is_now = voxels('%s.%d.raw' % (name, step['record']))
        want = dice(is_now, end, set(range(1, 256)))
        assert step['dice_ten_thousandths'] == want, (name, step, want)
        for label in step['labels']:
            want = dice(is_now, end, {label['label']})
            assert label['dice_ten_thousandths'] == want, (name, step, label, want)
        steps += 1
    records = [s['record'] for s in d[side]]
    assert records == sorted(set(records)) and len(records) > 5, records
assert d['steps_a'][-1]['dice_ten_thousandths'] == 10000
assert steps >= 12, steps
EOS
fi
close_story

begin "a journal beside itself agrees in all"
expect 0 "$iftty" diff --gestures e.iftty e.iftty
out_has "8 matched, 0 of the expert and 0 of the trainee not"
out_has "Kendall's tau 28/28 (1.0000); the longest common order has 8 of 8 matched"
grep -qE '^10 +1.0000 +1.0000$' out || fail "$(cat out)"
close_story

begin "a stroke of several records is one gesture, and edits that wait count from their run"
cat >long.txt <<'EOS'
open s.nii
seed 2,3,4 0
seed 6,10,8 1 to=8,10,8
seed 8,10,8 1 to=8,14,8 joined=yes
seed 8,14,8 1 to=4,14,8 joined=yes
run
EOS
sed '/joined/d; s/to=8,10,8/to=8,10,8 to=8,14,8 to=4,14,8/' long.txt >whole.txt
expect 0 "$iftty" diff --gestures long.txt whole.txt --json
if needs python3; then
    python3 - <<'EOS' || fail "$(cat out)"
import json
d = json.load(open('out'))
assert d['a']['gestures'] == d['b']['gestures'] == 2, d['a']
assert [m['mm'] for m in d['matched']] == [0, 0]
assert [(s['record'], s['gestures']) for s in d['steps_a']] == [(6, 2)]
assert [(s['record'], s['gestures']) for s in d['steps_b']] == [(4, 2)]
EOS
fi
close_story

begin "an outline is one gesture, in the middle of its corners"
cat >outline.txt <<'EOS'
open s.nii
auto on
outline 4,4,8 1 to=8,4,8 to=8,10,8 to=4,10,8
outline 4,4,8 1 to=8,4,8 to=8,12,8 to=4,12,8 instead=1
EOS
expect 0 "$iftty" diff --gestures outline.txt outline.txt
tr -s ' ' <out | grep -qxE 'outline 2 2 ?' || fail "no outlines: $(cat out)"
printf 'open s.nii\nauto on\nseed 6,7,8 1\nseed 6,8,8 1\n' >middles.txt
expect 0 "$iftty" diff --gestures outline.txt middles.txt --json
out_has '"matched": [{"a": 3, "b": 3, "mm": 0}, {"a": 4, "b": 4, "mm": 0}]'
close_story

begin "what was undone before the scene was interpolated stays taken back"
printf '%s\n' 'open s.nii' 'seed 2,3,4 0' undo 'interpolate 2 1 1' 'seed 9,3,4 1' run >new.txt
expect 0 "$iftty" diff --gestures new.txt new.txt
tr -s ' ' <out | grep -qx 'taken back 1 1 *' || fail "$(cat out)"
out_has "1 matched, 0 of the expert and 0 of the trainee not"
close_story

begin "up to a record, and nothing in common"
expect 0 "$iftty" diff --gestures e.iftty t.iftty --until 3
out_has "order     fewer than two gestures are matched"
expect 0 "$iftty" diff --gestures e.iftty t.iftty --until 2
! grep -q '^all' out || fail "$(cat out)"
close_story

begin "the picture of both curves"
expect 0 "$iftty" diff --gestures e.iftty t.iftty --picture c.png
"$iftty" info c.png >info
grep -q '1024x' info || fail "$(cat info)"
cp c.png kept.png
expect 3 "$iftty" diff --gestures e.iftty t.iftty --picture c.png
[ ! -s out ] || fail "it carried out before it looked"
same_files c.png kept.png
expect 0 "$iftty" diff --gestures e.iftty t.iftty --picture d.png
same_files c.png d.png
expect 2 "$iftty" diff --gestures e.iftty t.iftty --picture d.exr
err_has "expected a name that ends in .png"
close_story

begin "a picture of a private scene does not name the journals"
sed 's/^open s.nii/& private=yes/' long.txt >private.txt
cp private.txt another.txt
expect 0 "$iftty" diff --gestures private.txt private.txt --picture one.png
expect 0 "$iftty" diff --gestures another.txt another.txt --picture two.png
same_files one.png two.png
close_story

begin "a journal is trusted no more than by verify"
mkdir inside larger
printf 'open ../s.nii\nseed 1,1,1 1\n' >inside/out.txt
expect 3 "$iftty" diff --gestures e.iftty inside/out.txt
err_has "inside/out.txt: "
printf 'open s.nii\nseed 1,1,1 1\nrender r.png\nsave labels l.nii\ngolden g\n' >writes.txt
listing . | grep -vE ' ./(out|err|before|d)$' >before
expect 0 "$iftty" diff --gestures writes.txt e.iftty
listing . | grep -vE ' ./(out|err|before|d)$' | diff before - >d || fail "$(cat d)"
expect 3 "$iftty" diff --gestures e.iftty t.iftty --limit-memory 1M
err_has "--limit-memory"
sed 's/ forest=[0-9a-f]*/ forest=0123456789abcdef/' t.iftty >lies.iftty
expect 3 "$iftty" diff --gestures e.iftty lies.iftty
err_has "lies.iftty: it gives other results than it records; see iftty verify"
sed 's/^undo$/# by hand\nundo/' e.iftty >hand.iftty
expect 0 "$iftty" diff --gestures hand.iftty t.iftty
err_has "# hand.iftty was edited by hand; it gives the results that it records"
make_scene larger/s.nii 25 20 16
printf 'open s.nii\nseed 1,1,1 1\n' >larger/a.txt
expect 3 "$iftty" diff --gestures e.iftty larger/a.txt
err_has "larger/a.txt: a scene of 25x20x16 voxels, and the expert's has 24x20x16"
make_scene other.nii 24 20 16
flip_byte other.nii 4000
sed 's/s.nii/other.nii/' long.txt >other.txt
expect 0 "$iftty" diff --gestures long.txt other.txt
err_has "# the scenes are not the same"
echo '# nothing' >empty.txt
expect 3 "$iftty" diff --gestures e.iftty empty.txt
err_has "empty.txt: it opens no scene"
{ echo 'open s.nii'; yes 'seed 1,1,1 1' | head -n 20001; } >many.txt
expect 3 "$iftty" diff --gestures e.iftty many.txt
err_has "many.txt: there are more than 20000 gestures"
close_story

finish
