#!/bin/sh
# SPDX-License-Identifier: MIT
# Parts of files as scenes: their records, resumed sessions, saved files, and maps of the whole
# file. The voxels of a part are tested in test_part.c.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
gzip -k s.nii
crop='crop=4-19,2-17,3-12'

begin "a part is recorded, resumed and verified as it was opened"
expect 0 "$iftty" -c "open s.nii.gz $crop; seed 2,3,4 1; seed 12,10,5 2; run; why 0,0,0
save labels l.nii" --journal j.iftty
out_has '16x16x10 voxels'
grep -q "^open s.nii.gz $crop weight=morph\$" j.iftty || fail "$(cat j.iftty)"
expect 0 "$iftty" -c 'seed 1,1,1 3; run' --journal j.iftty
expect 0 "$iftty" verify j.iftty
expect 0 "$iftty" -c "open s.nii $crop; why 0,0,0"
cp out cropped
expect 0 "$iftty" -c "open s.nii reduce=2 $crop; info"
out_has "part      4-19,2-17,3-12 of the file's 24x20x16 voxels, the mean of each 2x2x2"
expect 0 "$iftty" -c 'open s.nii; why 4,2,3'
same "$(sed -n 's/.*intensity \([0-9]*\).*/\1/p' cropped)" \
    "$(sed -n 's/.*intensity \([0-9]*\).*/\1/p' out)"
expect 0 "$iftty" -c "open s.nii reduce=2 $crop; seed 1,1,1 1; run" --journal r.iftty
out_has '8x8x5 voxels of 2x2x2 mm'
grep -q "^open s.nii $crop reduce=2 weight=morph\$" r.iftty || fail "$(cat r.iftty)"
expect 0 "$iftty" verify r.iftty

begin "maps on the grid of the whole file are taken by the same part"
expect 0 "$iftty" -c 'open s.nii; seed 6,10,8 1; seed 20,10,8 2; run; save labels whole.nii'
expect 0 "$iftty" -c "open s.nii $crop; seed 2,8,5 1; mask whole.nii regions=1; run
save labels part.nii"
tail -c +353 whole.nii | od -An -v -tu1 -w1 | awk '{ i = NR - 1; x = i % 24
    y = int(i / 24) % 20; z = int(i / 480)
    if (x > 3 && x < 20 && y > 1 && y < 18 && z > 2 && z < 13) print $1 == 1 ? 1 : 0 }' >expected
tail -c +353 part.nii | od -An -v -tu1 -w1 | tr -d ' ' >got
same_files expected got
answers '2 regions' "open s.nii $crop reduce=2; seed-file whole.nii; run"
out_has '320 seeds'
answers '1 region' "open s.nii $crop; seed-file part.nii"
# Other options for the scene's file do not apply to the map's file.
tail -c +353 s.nii >s.raw
raw='raw:s.raw size=24,20,16 type=uint8'
for more in '' spacing=1,1,1; do
    rm -f part.nii
    expect 0 "$iftty" -c "open $raw $crop $more; seed 2,8,5 1; mask whole.nii regions=1; run
    save labels part.nii"
    tail -c +353 part.nii | od -An -v -tu1 -w1 | tr -d ' ' >got
    same_files expected got
done

# place FILE X: its first voxel lies at X,0,0 mm
place() {
    "$PYTHON" - "$1" "$2" <<'END'
import struct, sys
with open(sys.argv[1], 'r+b') as f:
    f.seek(254)
    f.write(struct.pack('<h', 1))
    f.seek(280)
    f.write(struct.pack('<12f', 1, 0, 0, float(sys.argv[2]), 0, 1, 0, 0, 0, 0, 1, 0))
END
}
begin "a displaced map of the whole file is rejected, or resampled"
for x in 0 3; do
    cp s.nii at$x.nii
    place at$x.nii $x
    expect 0 "$iftty" -c "open at$x.nii; seed 6,10,8 1; seed 20,10,8 2; run; save labels map$x.nii"
done
expect 0 "$iftty" -c "open at0.nii $crop; seed 2,8,5 1; mask map0.nii regions=1"
for less in "$crop" "$crop reduce=2"; do
    refuses '3 mm' "open at0.nii $less; mask map3.nii regions=1"
done
# Voxel x of the part is 4 + x of the file, and 3 mm less in the map: all of it is there.
expect 0 "$iftty" -c "open at0.nii $crop; seed-file map3.nii resample=yes; run; save labels got.nii"
tail -c +353 map3.nii | od -An -v -tu1 -w1 | awk '{ i = NR - 1; x = i % 24
    y = int(i / 24) % 20; z = int(i / 480)
    if (x > 0 && x < 17 && y > 1 && y < 18 && z > 2 && z < 13) print $1 + 0 }' >expected
tail -c +353 got.nii | od -An -v -tu1 -w1 | tr -d ' ' >got
same_files expected got

begin "other maps are refused with the reason, as is a box that is not in the file"
make_scene other.nii 23 20 16
expect 3 "$iftty" -c "open s.nii $crop; mask other.nii"
err_has 'the map has 23x20x16 voxels, the scene 16x16x10, and its file 24x20x16; a map must be'
refuses 'a map must be on the grid' "open s.nii $crop; interpolate 2 1 1; mask s.nii"
expect 2 "$iftty" -c 'open s.nii crop=0-24,0-1,0-1'
err_has 'crop: 0-24 is not in the 24 voxels along x, 0-23'
expect 2 "$iftty" -c 'open s.nii crop=0-3,0-1'
err_has 'crop: expected A-B,C-D,E-F, the voxels along x, y and z, and not 2 ranges'
expect_err 'reduce: expected a number 2..16, not 17' 2 "$iftty" -c 'open s.nii reduce=17'
{ # voxels 2.5 m apart along z, which may be, and 5 m, which may not
    head -c 88 s.nii
    printf '\000\100\034\105'
    tail -c +93 s.nii
} >far.nii
expect 0 "$iftty" -c 'open far.nii crop=0-5,0-5,0-5; info'
expect 3 "$iftty" -c 'open far.nii reduce=2'
err_has 'reduce=2: its voxels would be more than 4 m apart; those of the file are 1 x 1 x 2500 mm'
expect_err 'volume, crop and reduce apply to files' 2 "$iftty" -c 'open synth:geom reduce=2'
for word in series=1 data=x missing=blank spacing=1,1,2 huge=yes; do
    expect 2 "$iftty" -c "open synth:geom:9x9x9 $word"
    err_has 'are for files, not for synthetic scenes; nothing was opened'
    printf 'open synth:geom:9x9x9 %s\n' "$word" >recorded # before it was refused
    expect 0 "$iftty" replay recorded
done

begin "words for other formats are refused, and left out of records that have them"
raw='raw:s.raw size=24,20,16 type=uint8'
for word in series=1 missing=blank data=x; do
    expect_err "s.nii: ${word%%=*}=" 2 "$iftty" -c "open s.nii $word"
    err_has "and this is nifti-1: leave it out"
    expect_err "and this is raw: leave it out" 2 "$iftty" -c "open $raw $word"
    for file in s.nii "$raw"; do
        printf 'open %s %s\n' "$file" "$word" >recorded # before it was refused
        expect_out "${word%%=*}=" 0 "$iftty" replay recorded
        out_has ": left out"
    done
done
expect_err "series=N is for series of DICOM in a folder" 2 "$iftty" -c "open s.nii series=2"
expect 0 "$iftty" -c "open s.nii volume=0 huge=yes" # which are true of it
finish
