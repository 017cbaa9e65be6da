#!/bin/sh
# SPDX-License-Identifier: MIT
# iftty log --graph: a drawing in a pipe and at a terminal. What is drawn of which journal is in
# tests/test_graph.c.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1

# by_hand JOURNAL: from lines "COMMAND|WORDS"; its chain fits nothing, which is not asked here
by_hand() {
    { echo '# iftty journal 1 semantics 3'
      awk -F '|' '{ print $1
        print "= " NR ($2 == "" ? "" : " " $2) " chain=00000000000000000000000000000000" }'
    } >"$1"
}
by_hand g.iftty <<'EOS'
open s.nii|size=24,20,16
seed 2,3,4 1|seeds=1
undo|at=1
branch other|branch=other
seed 2,3,5 1|seeds=1
EOS

begin "in a pipe it is ASCII, and as wide as it is"
cat >expected <<'EOS'
* 1 open s.nii
|\
| * 2 (main) seed 2,3,4 1
| (3 undo: at 1)
* 4 branch other
@ 5 (other, present) seed 2,3,5 1
EOS
expect 0 env LC_ALL=C.UTF-8 "$iftty" log --graph g.iftty
same_files out expected
expect 0 "$iftty" log g.iftty --graph
same_files out expected
close_story

begin "what was recorded by a session is drawn"
make_scene s.nii 24 20 16
"$iftty" -c 'open s.nii; seed 2,3,4 1; run' --journal r.iftty >/dev/null || fail "cannot record"
expect 0 "$iftty" log --graph r.iftty
same "$(cat out)" "* 1 open s.nii weight=morph
* 2 seed 2,3,4 1
@ 3 (main, present) run"
close_story

begin "what cannot be drawn is one line"
echo 'open s.nii' >script.txt
expect 3 "$iftty" log --graph script.txt
err_has "this is a script"
[ ! -s out ] || fail "it draws: $(cat out)"
printf 'a|\nb|at=7\n' | by_hand h.iftty
expect 3 "$iftty" log --graph h.iftty
err_has "record 2, line 4: at=7: expected the number of a record before it, or 0"
expect 3 "$iftty" log --graph missing.iftty
expect 2 "$iftty" log --graph
close_story

begin "at a terminal lines are cut at its edge, and drawn where the locale is UTF-8"
if needs script; then
    script -qec "stty cols 24 && LC_ALL=C.UTF-8 '$iftty' log --graph g.iftty" /dev/null </dev/null |
        tr -d '\r' >seen
    same "$(cat seen)" "● 1 open s.nii
├─╮
│ ● 2 (main) seed 2,3,4 
│ (3 undo: at 1)
● 4 branch other
◆ 5 (other, present) see"
    script -qec "stty cols 24 && LC_ALL=C '$iftty' log --graph g.iftty" /dev/null </dev/null |
        tr -d '\r' >seen
    same "$(cat seen)" "$(cut -c 1-24 expected)"
fi
close_story

finish
