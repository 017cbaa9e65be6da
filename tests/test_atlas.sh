#!/bin/sh
# Atlases whose regions are no labels, the tables of names beside them, and seeds that go out and
# come in again.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
make_scene s.nii 24 20 16
{
    nifti_header 24 20 16 512 16
    awk 'BEGIN { for (i = 0; i < 7680; i++) {
        v = i % 24 < 4 ? 2001 : i % 24 < 8 ? 2002 : i % 24 > 19 ? 9170 : 0
        printf "%d\n", v } }' | python3 -c 'import struct, sys
for v in sys.stdin: sys.stdout.buffer.write(struct.pack("<H", int(v)))'
} >atlas.nii
printf '2001 Precentral_L 255 0 0 0\n2002 Precentral_R 0 255 0 0\n9170 Vermis 0 0 255 0\n' \
    >atlas.nii.txt
chosen='regions=2001,9170 as=4,9'

begin "an atlas of more than 255 regions is refused with what to type, and chosen from"
expect 3 "$iftty" -c 'open s.nii; seed-file atlas.nii'
err_has 'region 2001 of the map is no label 0..255; choose regions and their labels, as in'
err_has 'regions=2001,2002 as=1,2, or give all one label with label=; nothing has changed'
expect 0 "$iftty" -c "open s.nii; label-file atlas.nii.txt $chosen; seed-file atlas.nii $chosen \
erode=1; run; stats" --journal j.iftty
out_has '2 names and 2 colours of labels'
out_has 'region 2001 Precentral_L is label 4 Precentral_L, 504 seeds'
out_has 'region 9170 Vermis is label 9 Vermis, 504 seeds'
out_has '1008 seeds'
expect 0 "$iftty" -c "open s.nii; seed-file atlas.nii $chosen; label-file atlas.nii.txt $chosen
seed-file atlas.nii $chosen"
same "$(grep -c "their names: .label-file atlas.nii.txt $chosen." out)" 1
expect 0 "$iftty" -c "open s.nii; labels atlas.nii $chosen; undo; label-file atlas.nii.txt $chosen
labels atlas.nii $chosen"
same "$(grep -c "their names: .label-file atlas.nii.txt $chosen." out)" 1
printf '1 one\n2 two\n' >own.nii.txt
expect 0 "$iftty" -c 'open s.nii; seed 1,1,1 0; seed 9,9,9 1; run; save labels own.nii'
for command in labels seed-file; do
    expect 0 "$iftty" -c "open s.nii; $command own.nii; $command own.nii label=3"
    same "$(grep 'their names' out)" '    their names: `label-file own.nii.txt`'
done
expect 0 "$iftty" -c 'open s.nii; labels own.nii regions=0'
! grep -q 'their names' out || fail "$(cat out)"
grep -qx "seed-file atlas.nii regions=2001,9170 as=4,9 erode=1" j.iftty || fail "$(cat j.iftty)"
expect 2 "$iftty" -c 'open s.nii; seed-file atlas.nii regions=1,2 as=1'
err_has 'as: expected a label for each of `regions`; from 2 on there is none'
expect 2 "$iftty" -c 'open s.nii; seed-file atlas.nii regions=1 as=1 label=2'
err_has 'as and label are two answers to one question'
expect 2 "$iftty" -c 'open s.nii; seed-file atlas.nii regions=1,,2'
err_has 'regions: expected A-B, or A, within 0-65533, not 1,,2; several have commas between them'
close_story

begin "a replay reads the table again, and notices one that has changed"
expect 0 "$iftty" verify j.iftty
sed -i 's/Vermis/vermis/' atlas.nii.txt
expect 1 "$iftty" verify j.iftty
out_has 'differs  names'
sed -i 's/vermis/Vermis/' atlas.nii.txt
again='undo 3; label-file atlas.nii.txt regions=2002 as=4; undo; redo'
expect 0 "$iftty" -c "$again" --journal j.iftty
expect 0 "$iftty" verify j.iftty
close_story

begin "tables of names go out and come in again, in every format"
{ # 256 of red, of green, of blue
    awk 'BEGIN { for (i = 0; i < 256; i++) print i; for (i = 0; i < 512; i++) print 9 }' |
        python3 -c 'import sys
sys.stdout.buffer.write(bytes(int(v) for v in sys.stdin))'
} >c.lut
expect 0 "$iftty" -c 'open s.nii; label 4 "left part" #102030; label 5 spleen #405060
save names a.txt; save names a.ctbl; save names a.ctab; save names a.nii.txt; save names a.lut'
same "$(cat a.ctbl)" "# Color table file
0 Background 0 0 0 0
4 left_part 16 32 48 255
5 spleen 64 80 96 255" # the last is how opaque it is
same "$(cat a.ctab)" "# No. Label_Name R G B A
0 Unknown 0 0 0 0
4 left_part 16 32 48 0
5 spleen 64 80 96 0" # how transparent
for table in a.txt a.ctbl a.ctab a.nii.txt; do
    expect 0 "$iftty" -c "open s.nii; label-file $table; save names b.txt replace=yes"
    [ $table = a.txt ] && same_files a.txt b.txt
    grep -q '"spleen"' b.txt || fail "no spleen by $table"
done
expect 0 "$iftty" -c 'open s.nii; label-file c.lut; save names d.lut'
tail -c +2 c.lut | head -c 255 >c.red
tail -c +2 d.lut | head -c 255 >d.red
same_files c.red d.red
expect 0 "$iftty" -c 'open s.nii; label-file a.nii.txt; save names Smith.label' --journal n.iftty
expect 0 "$iftty" log --anonymise n.iftty
out_has 'label-file file-1.nii.txt'
out_has 'save names file-2.label'
expect 2 "$iftty" -c 'open s.nii; save names a.doc'
err_has 'expected .txt or .label for ITK-SNAP'
expect 3 "$iftty" -c 'open s.nii; label-file s.nii'
err_has 's.nii: line 1: expected NUMBER NAME [R G B A]'
close_story

begin "the tables of mricron are read"
templates=/usr/share/mricron/templates
if [ -e $templates/aal.nii.txt ]; then
    expect 0 "$iftty" -c "label-file $templates/aal.nii.txt; label-file $templates/aal.nii.lut
label-file $templates/JHU-WhiteMatter-labels-1mm.nii.txt; label-file $templates/AICHAmc.nii.txt"
    out_has '116 names and 0 colours of labels'
    out_has '0 names and 255 colours of labels'
    out_has '18 names had to be changed to fit; the first is of label 2, now Pontine_crossing_~'
    out_has '192 names'
else
    skip "mricron-data is not installed"
fi
close_story

begin "seeds that are saved are planted again, as they were"
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 0; seed 6,10,8 1 radius=2; seed 20,10,8 7
save seeds s.csv; run' --journal a.iftty
same "$(head -n 1 s.csv)" x,y,z,label
same "$(wc -l <s.csv | tr -d ' ')" 36
expect 0 "$iftty" -c 'open s.nii; seed-file s.csv; run' --journal b.iftty
same "$(last_word labels b.iftty)" "$(last_word labels a.iftty)"
same "$(last_word forest b.iftty)" "$(last_word forest a.iftty)"
expect 2 "$iftty" -c 'open s.nii; save seeds s.nii'
err_has 'expected FILE.csv for seeds'
close_story
finish
