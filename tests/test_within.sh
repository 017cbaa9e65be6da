#!/bin/sh
# SPDX-License-Identifier: MIT
# Corrections that end within a distance, by commands: planted, explained, undone, recorded,
# resumed, written to a list and read again; and errors.
. "$(dirname "$0")/lib.sh"
open='open synth:geom:40x40x40'

begin "a tree ends at the reach of its seed, and voxels out of all reaches are counted"
asks='info; why 20,20,26; why 20,20,27'
expect 0 "$iftty" -c "$open; seed 20,20,20 1 radius=2 within=6; run; $asks" --journal j.iftty
out_has "reach     33 seeds with \`within\`; 63075 voxels without a tree, since all seeds"
out_has "of the seed at 20,20,22, within 6 voxels of 20,20,20"
out_has "it is out of reach of the seed at 20,20,22, within 6 voxels of 20,20,20, of label 1, whose"
grep -qx 'seed 20,20,20 1 radius=2 within=6' j.iftty || fail "$(cat j.iftty)"
expect 0 "$iftty" verify j.iftty

begin "other trees grow into the rest; it is resumed, undone and redone"
expect 0 "$iftty" -c 'seed 2,2,2 2; run; info' --journal j.iftty
out_has "no voxel is left without a tree by it"
before=$(last_word forest j.iftty)
expect 0 "$iftty" -c 'remove 20,20,20; run; info; undo 2' --journal j.iftty
out_has "marker 1 removed: 33 seeds of label 1"
[ "$(grep -c "^ *reach" "$work/out")" = 0 ] || fail "$(cat "$work/out")"
[ "$(last_word forest j.iftty)" = "$before" ] || fail "undo: $(tail -3 j.iftty)"
expect 0 "$iftty" -c 'redo 2; undo 2; goto 3; goto 5' --journal j.iftty
[ "$(last_word forest j.iftty)" = "$before" ] || fail "redo: $(tail -3 j.iftty)"
expect 0 "$iftty" verify j.iftty

begin "planted again with another distance it is another seed"
again='seed 20,20,20 1 radius=2 within'
expect 0 "$iftty" -c "$again=9; run; $again=6; run" --journal j.iftty
[ "$(last_word forest j.iftty)" = "$before" ] || fail "$(tail -5 j.iftty)"
expect 0 "$iftty" -c 'remove 20,20,20; run; why 20,20,20; save seeds s.csv' --journal j.iftty
out_has "within 9 voxels of 20,20,20"
expect 0 "$iftty" verify j.iftty

begin "a list of seeds has the distances, in voxels and in millimetres"
[ "$(head -1 s.csv)" = "x,y,z,label,within,of x,of y,of z" ] || fail "$(head -1 s.csv)"
grep -qx '20,20,22,1,9,20,20,20' s.csv || fail "$(cat s.csv)"
grep -qx '2,2,2,2' s.csv || fail "$(cat s.csv)"
before=$(last_word forest j.iftty)
expect 0 "$iftty" -c "$open; seed-file s.csv; run" --journal k.iftty
grep -q "forest=$before" k.iftty || fail "$(cat k.iftty)"
expect 0 "$iftty" -c "$open; seed 20,20,20 1 within=2.5mm; run; save seeds mm.csv" --journal l.iftty
grep -qx '20,20,20,1,2.500000mm,20,20,20' mm.csv || fail "$(cat mm.csv)"
before=$(sed -n 's/^= 3 \(forest=[0-9a-f]*\).*/\1/p' l.iftty)
expect 0 "$iftty" -c "$open; seed-file mm.csv; run" --journal m.iftty
grep -q "$before" m.iftty || fail "$(cat m.iftty)"
expect 0 "$iftty" verify k.iftty l.iftty m.iftty

begin "an exact seed has no reach: it is explained, written to a list and read again"
expect 0 "$iftty" -c "$open; seed 2,2,2 2; seed 20,20,20 1 radius=1 within=0; run; why 20,20,21
why 20,20,22; save seeds e.csv; info" --journal e.iftty
out_has "label 1, of the seed at 20,20,21, within=0" "label 2, of the seed at 2,2,2"
grep -qx '20,20,21,1,0,0,0,0' e.csv || fail "$(cat e.csv)"
before=$(last_word forest e.iftty)
expect 0 "$iftty" -c "$open; seed-file e.csv; run; why 20,20,21" --journal f.iftty
out_has "of the seed at 20,20,21, within=0"
[ "$(last_word forest f.iftty)" = "$before" ] || fail "$(cat f.iftty)"
expect 0 "$iftty" verify e.iftty f.iftty

begin "invalid arguments are rejected, and plant nothing"
refused() { # STATUS WORDS MESSAGE
    expect_err "$3" "$1" "$iftty" -c "$open; seed $2; info" --keep-going
    out_has "0 seeds, 0 edits pending"
}
refused 2 '20,20,20 1 radius=3 within=2' "within: less than the radius"
refused 2 '20,20,20 1 radius=3 within=2.9mm' "within: less than the radius"
refused 2 '20,20,20 1 within=-1' "within: expected a number 0..512, or millimetres"
refused 2 '20,20,20 1 within=513' "within: expected a number 0..512"
refused 2 '20,20,20 1 within=0mm' "within: expected"
refused 2 '20,20,20 1 within=1001mm' "within: expected"
refused 2 '20,20,20 0 radius=9 within=12 shell=yes' "within: above 0 only for one ball"
refused 2 '20,20,20 1 within=9 to=22,20,20' "within: above 0 only for one ball"
refused 2 '20,20,20 1 within=9 joined=yes' "within: above 0 only for one ball"

finish
