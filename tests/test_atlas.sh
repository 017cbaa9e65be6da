#!/bin/sh
# SPDX-License-Identifier: MIT
# Atlases whose regions are no labels, their tables of names, and seeds that are saved and planted
# again.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
{
    nifti_header 24 20 16 512 16
    awk 'BEGIN { for (i = 0; i < 7680; i++) {
        v = i % 24 < 4 ? 2001 : i % 24 < 8 ? 2002 : i % 24 > 19 ? 9170 : 0
        printf "%d\n", v } }' | "$PYTHON" -c 'import struct, sys
for v in sys.stdin: sys.stdout.buffer.write(struct.pack("<H", int(v)))'
} >atlas.nii
printf '2001 Precentral_L 255 0 0 0\n2002 Precentral_R 0 255 0 0\n9170 Vermis 0 0 255 0\n' \
    >atlas.nii.txt
chosen='regions=2001,9170 as=4,9'

begin "an atlas of more than 255 regions is refused with the command to choose regions"
expect 3 "$iftty" -c 'open s.nii; seed-file atlas.nii'
err_has 'region 2001 of the map is no label; `label 2001 NAME` makes it one; or choose regions and'
err_has 'as in regions=2001,2002 as=1,2, or give all one label with label=; nothing has changed'
expect 0 "$iftty" -c "open s.nii; label-file atlas.nii.txt $chosen; seed-file atlas.nii $chosen \
erode=1; run; stats" --journal j.iftty
out_has '2 names and 2 colours of labels'
out_has 'region 2001 Precentral_L is label 4 Precentral_L, 504 seeds'
out_has 'region 9170 Vermis is label 9 Vermis, 504 seeds' '1008 seeds'
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
err_has 'as: expected a label for each of `regions`; labels are missing from region 2 on'
expect 2 "$iftty" -c 'open s.nii; seed-file atlas.nii regions=1 as=1 label=2'
err_has 'as and label are mutually exclusive'
expect 2 "$iftty" -c 'open s.nii; seed-file atlas.nii regions=1,,2'
err_has 'regions: expected A-B, or A, within 0-4294967295, not 1,,2; several have commas between'

begin "regions above 255 are labels of the same numbers"
"$PYTHON" - <<'END' || fail "nibabel cannot write the atlas"
import nibabel, numpy
scene = nibabel.load('s.nii')
values = numpy.zeros(scene.shape, numpy.int32)
for i, value in enumerate((2035, 2, 1001, 41, 1035, 1002)):
    values[2 + 3 * i:5 + 3 * i, 3:15, 4:12] = value
nibabel.save(nibabel.Nifti1Image(values, scene.affine), 'aparc.nii.gz')
values = (numpy.arange(values.size) % 300 + 1000).reshape(values.shape).astype(numpy.int16)
nibabel.save(nibabel.Nifti1Image(values, scene.affine), 'many.nii')
values[0, 0, 0] = -5
nibabel.save(nibabel.Nifti1Image(values, scene.affine), 'negative.nii')
END
printf '2 Left-White 245 245 245 0\n5 Ventricle 1 2 3 0\n41 Right-White 0 225 0 0
1001 ctx-lh-bankssts 25 100 40 0
1002 ctx-lh-caudal 125 100 160 0\n1035 ctx-lh-insula 255 192 32 0\n2035 ctx-rh-insula 5 6 7 0\n' \
    >lut.txt # label 5 will be 1035, and 5 no label
saves='save labels o.nii.gz; save labels o.nrrd; save labels o.seg.nrrd; save labels o.mha'
expect 0 "$iftty" -c "open s.nii; labels aparc.nii.gz; run; label-file lut.txt; $saves
save names o.txt; save names o.ctbl; save surface o.obj; save surface o.vtp; stats report=o.csv
compare aparc.nii.gz" --journal aparc.iftty
out_has "6 regions of it are labels with the file's numbers"
out_has 'label 2035 ctx-rh-insula: ' '6 names and 6 colours of labels' '0 of 7680 voxels differ'
grep -qE '^labels aparc.nii.gz erode=0 numbers=2,41,1001-1002,1035,2035 copy=[0-9a-f]{32}$' \
    aparc.iftty || fail "$(grep ^labels aparc.iftty)"
"$PYTHON" - <<'END' || fail "another reader finds other numbers"
import nibabel, numpy
was, now = nibabel.load('aparc.nii.gz'), nibabel.load('o.nii.gz')
assert now.get_data_dtype() == numpy.uint16
assert (numpy.asarray(was.dataobj) == numpy.asarray(now.dataobj)).all()
raw = numpy.asarray(now.dataobj).astype('<u2').tobytes(order='F')
assert open('o.mha', 'rb').read().endswith(raw)
open('raw', 'wb').write(raw)
END
needs teem-unu && for map in o.nrrd o.seg.nrrd; do
    teem-unu save -f nrrd -e raw -i $map | teem-unu data - | cmp -s - raw || fail "$map"
done
grep -aqx 'Segment5_LabelValue:=2035' o.seg.nrrd || fail "$(strings o.seg.nrrd | grep Segment5)"
grep -aqx 'Segment5_Name:=ctx-rh-insula' o.seg.nrrd || fail "$(strings o.seg.nrrd | grep Segment5)"
grep -aqx 'Segment0_Extent:=5 7 3 14 4 11' o.seg.nrrd || fail "$(strings o.seg.nrrd | grep Ext)"
grep -q '^ 1035    255  192   32 .*"ctx-lh-insula"' o.txt || fail "$(cat o.txt)"
grep -qx '2035 ctx-rh-insula 5 6 7 255' o.ctbl || fail "$(cat o.ctbl)"
grep -qx 'o 2035 ctx-rh-insula' o.obj || fail "$(grep '^o ' o.obj)"
grep -aq 'type="UInt16" Name="label"' o.vtp || fail "$(strings o.vtp | head)"
grep -q '^2035,"ctx-rh-insula",' o.csv || fail "$(cat o.csv)"
expect 2 "$iftty" -c 'save names o.lut' --journal aparc.iftty
err_has 'labels are numbered by a file, and a .lut holds 0 to 255'
mv aparc.nii.gz gone.nii.gz # the copy has the labels, and the record their numbers
expect 0 "$iftty" verify aparc.iftty
expect 0 "$iftty" -c 'label 200 lesion; seed 1,1,1 200; labels o.nii.gz; save labels o2.nii.gz
info; goto 2; save labels o3.nii.gz; undo 2; label 1 one; save names n.txt' --journal aparc.iftty
out_has 'numbers   7 labels, 2 to 2035, of 255; `stats` lists them'
grep -q '^    1 .*"one"' n.txt || fail "undo leaves numbers: $(cat n.txt)"

begin "whole numbers stored as real ones are read exactly"
"$PYTHON" - <<'END' || fail "cannot make the map"
import nibabel, numpy
scene = nibabel.load('s.nii')
values = numpy.zeros(scene.shape, numpy.float32)
values[2:9], values[12:16], values[16:20] = 1010, 1018, 14175
nibabel.save(nibabel.Nifti1Image(values, scene.affine), 'real.nii')
values[0, 0, 0] = 0.5
nibabel.save(nibabel.Nifti1Image(values, scene.affine), 'half.nii')
END
expect 0 "$iftty" -c 'open s.nii; labels real.nii; save labels whole.nii; compare real.nii'
out_has 'label 14175: ' '0 of 7680 voxels differ'
"$PYTHON" - <<'END' || fail "nibabel finds other numbers"
import nibabel, numpy
was, now = nibabel.load('real.nii'), nibabel.load('whole.nii')
assert (numpy.asarray(was.dataobj) == numpy.asarray(now.dataobj)).all()
END
refuses 'regions are whole numbers; nothing has changed' 'open s.nii; labels half.nii'

begin "a number is one label, for people and in files"
expect 0 "$iftty" -c 'open s.nii; labels gone.nii.gz; seed 1,1,1 41; save labels two.nii
stats' --journal number.iftty # the region of the file
grep -qx 'seed 1,1,1 41' number.iftty || fail "$(cat number.iftty)"
"$iftty" log --script number.iftty >number.script
rm two.nii
expect_out 'label 41: ' 0 "$iftty" run number.script
out_has 'label 41: '
expect 0 "$iftty" -c 'open s.nii; labels gone.nii.gz; seed 1,1,1 41; label 41 lesion number=5000
save labels three.nii; compare three.nii; seed 2,1,1 5000; hide lesion; run'
out_has '0 of 7680 voxels differ'
out_has '5000 lesion '
expect 2 "$iftty" -c 'open s.nii; labels gone.nii.gz; label 41 lesion number=1001'
err_has 'number: there is a label 1001 already; nothing has changed'
for command in 'seed 1,1,1 1034' 'hide 1034' 'hints label=1034' \
    'seed 1,1,1 41 radius=1 within=0 over=1034'; do
    expect 2 "$iftty" -c "open s.nii; labels gone.nii.gz; label-file lut.txt; $command"
    err_has 'there is no label 1034; the nearest is 1035 ctx-lh-insula; `label 1034 NAME` makes it'
done
expect 2 "$iftty" -c 'open s.nii; seed 1,1,1 300'
err_has 'LABEL: expected a label 0..255 or the name of one, not 300; name one with `label N NAME`'
expect 0 "$iftty" -c 'open s.nii; label 4000000001 big; seed 1,1,1 4000000001; seed 9,9,9 0; run
save labels big.nii.gz; save labels big.seg.nrrd; save surface big.vtp; save seeds big.csv
seed-file big.csv; stats report=big.json' --journal big.iftty
grep -qx '1,1,1,4000000001' big.csv || fail "$(cat big.csv)"
grep -aqx 'Segment0_LabelValue:=4000000001' big.seg.nrrd || fail "$(strings big.seg.nrrd)"
grep -aq 'type="UInt32" Name="label"' big.vtp || fail "$(strings big.vtp | head)"
grep -q '"number": 4000000001' big.json || fail "$(cat big.json)"
grep -qx 'seed 1,1,1 4000000001' big.iftty || fail "$(cat big.iftty)"
/usr/bin/python3 - <<'END' || fail "nibabel finds another number"
import nibabel, numpy
values = numpy.asarray(nibabel.load('big.nii.gz').dataobj)
assert values.dtype == numpy.uint32 and set(numpy.unique(values)) == {0, 4000000001}
END
expect 0 "$iftty" -c 'open s.nii; labels big.nii.gz; run; save labels back.nii.gz
seed-file big.nii.gz; compare big.nii.gz; labels big.nii.gz regions=4000000001 as=4000000001'\
    --journal wide.iftty
out_has '4000000001 big   1.0000'
expect 0 "$iftty" -c 'open s.nii; mask big.nii.gz; seed 1,1,1 1'
grep -q '^labels big.nii.gz erode=0 numbers=4000000001 copy=' wide.iftty || fail "$(cat wide.iftty)"
expect 0 "$iftty" compare big.nii.gz back.nii.gz --csv
grep -q '^4000000001,"",' out || fail "$(cat out)"
expect 0 "$iftty" verify wide.iftty
/usr/bin/python3 - <<'END' || fail "the map is not the same"
import nibabel, numpy
one, two = nibabel.load('big.nii.gz'), nibabel.load('back.nii.gz')
assert (numpy.asarray(one.dataobj) == numpy.asarray(two.dataobj)).all()
END
expect 0 "$iftty" -c 'open s.nii; label-file lut.txt; labels gone.nii.gz; seed 1,1,1 1001; run
stats'
out_has 'label 41 Right-White: 1 marker' # as the table named it before
out_has 'label 1001: '

begin "a region is refused if a label of its number was planted, unless that came with a file"
expect 3 "$iftty" -c 'open s.nii; seed 1,1,1 2; labels gone.nii.gz; run'
err_has 'its region 2 has the number of a label that was planted here: `label 2 NAME number=N`'
err_has 'or choose regions and their labels, as in regions=2 as=2; nothing was planted'
expect 0 "$iftty" -c 'open s.nii; seed 1,1,1 2; labels gone.nii.gz regions=2,41 as=2,3; run'
out_has 'label 3: 1 marker'
expect 0 "$iftty" -c 'open s.nii; seed 1,1,1 2; label 2 lesion number=3; labels gone.nii.gz; stats'
out_has 'label 3 lesion: '
for first in 'labels gone.nii.gz' 'labels gone.nii.gz regions=2,41'; do
    answers 'label 2: ' "open s.nii; $first; seed 1,1,1 2; labels gone.nii.gz; stats"
done
expect 2 "$iftty" -c 'open s.nii; labels gone.nii.gz regions=2,41 as=2,300'
err_has 'as: there is no label 300; `label 300 NAME` makes it; nothing has changed'
expect 3 "$iftty" -c 'open s.nii; labels gone.nii.gz; label 7 lesion; seed 1,1,1 7
labels number.nii'
begin "too many regions and unknown numbers are refused with a command"
expect 3 "$iftty" -c 'open s.nii; labels many.nii'
err_has 'many.nii: it has 300 regions, and labels for 255 are free; choose some, as in'
err_has 'regions=1000-1254, or make all one label with label=1; nothing was planted'
expect 0 "$iftty" -c 'open s.nii; labels many.nii regions=1000-1254; run'
expect 0 "$iftty" -c 'open s.nii; labels many.nii label=1; run'
expect 3 "$iftty" -c 'open s.nii; labels negative.nii'
err_has '1 of its voxels holds numbers below 0 or above 4294967295, which are no regions'
expect_err 'numbers: only in journals' 2 "$iftty" -c 'open s.nii; labels gone.nii.gz numbers=7'

begin "a replay reads the table again, and detects a changed one"
expect 0 "$iftty" verify j.iftty
sed -i 's/Vermis/vermis/' atlas.nii.txt
expect_out 'differs  names' 1 "$iftty" verify j.iftty
sed -i 's/vermis/Vermis/' atlas.nii.txt
again='undo 3; label-file atlas.nii.txt regions=2002 as=4; undo; redo'
expect 0 "$iftty" -c "$again" --journal j.iftty
expect 0 "$iftty" verify j.iftty

begin "tables of names are written and read back in every format"
{ # 256 of red, of green, of blue
    awk 'BEGIN { for (i = 0; i < 256; i++) print i; for (i = 0; i < 512; i++) print 9 }' |
        "$PYTHON" -c 'import sys
sys.stdout.buffer.write(bytes(int(v) for v in sys.stdin))'
} >c.lut
expect 0 "$iftty" -c 'open s.nii; label 4 "left part" #102030; label 5 spleen #405060
save names a.txt; save names a.ctbl; save names a.ctab; save names a.nii.txt; save names a.lut'
same "$(grep -c 'changed to fit; the first is of label 4, in the file left_part' out)" 3
out_has '2 names not written: a .lut holds colours alone'
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
cat >odd.txt <<'END'
    4   255    0    0        1  1  1    "3rd vent, \"left\""
    5     0  255    0      0.5  1  1    "4th 'b' <x> & y"
    6     0  255    0        1  1  1    ""
END
expect 0 "$iftty" -c 'open s.nii; label-file odd.txt; seed 1,1,1 "3rd vent, \"left\""
    seed 8,8,4 "4th '"'b'"' <x> & y"; run; save seeds odd.csv; stats report=odd-stats.csv; stats
    save labels odd.seg.nrrd; save names odd-2.txt; label-file odd-2.txt' --journal odd.iftty
out_has '2 names and 3 colours of labels'
out_has 'label 4, in the file 3rd vent, '"'left'"
[ "$(grep -c 'had to be changed' out)" = 1 ] || fail "$(cat out)"
grep -qF '"3rd vent, ""left"""' odd-stats.csv || fail "$(cat odd-stats.csv)"
grep -aqxF 'Segment0_Name:=3rd vent, "left"' odd.seg.nrrd || fail "$(strings odd.seg.nrrd)"
expect 0 "$iftty" -c 'seed-file odd.csv' --journal odd.iftty
expect 0 "$iftty" verify --no-strict odd.iftty
"$iftty" log --script odd.iftty >odd.script
rm odd.seg.nrrd odd-2.txt odd-stats.csv
mv odd.csv odd-1.csv
sed -i 's/save seeds odd.csv/save seeds x.csv/; s/seed-file odd/seed-file odd-1/' odd.script
expect 0 "$iftty" run odd.script
expect 0 "$iftty" -c 'open s.nii; label-file c.lut; save names d.lut'
tail -c +2 c.lut | head -c 255 >c.red
tail -c +2 d.lut | head -c 255 >d.red
same_files c.red d.red
expect 0 "$iftty" -c 'open s.nii; label-file a.nii.txt; save names Smith.label' --journal n.iftty
expect_out 'label-file file-1.nii.txt' 0 "$iftty" log --anonymise n.iftty
out_has 'save names file-2.label'
expect_err 'expected .txt or .label for ITK-SNAP' 2 "$iftty" -c 'open s.nii; save names a.doc'
refuses 's.nii: line 1: expected NUMBER NAME [R G B A]' 'open s.nii; label-file s.nii'

begin "the tables of mricron are read"
templates=/usr/share/mricron/templates
if [ -e $templates/aal.nii.txt ]; then
    expect 0 "$iftty" -c "label-file $templates/aal.nii.txt; label-file $templates/aal.nii.lut
label-file $templates/JHU-WhiteMatter-labels-1mm.nii.txt; label-file $templates/AICHAmc.nii.txt"
    out_has '116 names and 0 colours of labels' '0 names and 255 colours of labels'
    out_has '18 names had to be changed to fit; the first is of label 2, now Pontine_crossing_~'
    out_has '192 names'
else
    skip "mricron-data is not installed"
fi

begin "saved seeds are planted again unchanged"
expect 0 "$iftty" -c 'open s.nii; seed 2,3,4 0; seed 6,10,8 1 radius=2; seed 20,10,8 7
save seeds s.csv; run' --journal a.iftty
same "$(head -n 1 s.csv)" x,y,z,label
same "$(wc -l <s.csv)" 36
expect 0 "$iftty" -c 'open s.nii; seed-file s.csv; run' --journal b.iftty
same "$(last_word labels b.iftty)" "$(last_word labels a.iftty)"
same "$(last_word forest b.iftty)" "$(last_word forest a.iftty)"
expect_err 'expected FILE.csv for seeds' 2 "$iftty" -c 'open s.nii; save seeds s.nii'
finish
