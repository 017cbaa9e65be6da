#!/bin/sh
# SPDX-License-Identifier: MIT
# Surfaces in files, read by another program: closed, in world millimetres for any affine map of the
# scene, with the volume of the voxels, and the same after a replay.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

# oblique FILE ROW ROW ROW: gives a scene of make_scene these rows of an sform
oblique() {
    "$PYTHON" - "$@" <<'EOF' || fail "no scene $1"
import struct, sys
data = bytearray(open(sys.argv[1], "rb").read())
rows = [[float(x) for x in row.split(',')] for row in sys.argv[2:]]
for a in range(3):
    struct.pack_into("<f", data, 80 + 4 * a, sum(row[a] ** 2 for row in rows) ** 0.5)
data[123] = 2
struct.pack_into("<2h", data, 252, 0, 1)
for a in range(3):
    struct.pack_into("<4f", data, 280 + 16 * a, *rows[a])
open(sys.argv[1], "wb").write(data)
EOF
}
read_surfaces() {
    "$PYTHON" -B tests/surface_reader.py "$@" || fail "cannot read $*"
}

begin "every format holds the same closed surface, in the scene's own world"
i=0
while read -r x y z; do
    i=$((i + 1))
    scene=$work/scene$i.nii room=$work/$i
    make_scene "$scene" 24 20 16
    oblique "$scene" "$x" "$y" "$z"
    mkdir "$room"
    expect_in "$room" 0 "$iftty" -c "open $scene
        seed 6,10,8 1; seed 20,10,8 2; seed 1,1,1 0
        label 1 ball #102030; label 2 block #aabbcc
        save labels labels.nii; save surface few.ply label=1 triangles=200
        save surface one.stl label=ball; save surface all.stl; save surface raw.stl smooth=0
        save surface one.ply label=1; save surface all.ply; save surface one.obj label=1
        save surface all.obj; save surface one.vtp label=1; save surface all.vtp"
    read_surfaces "$room/labels.nii" 1 "$room"/one.* >"$work/wrong"
    read_surfaces "$room/labels.nii" 0 "$room"/all.* "$room/raw.stl" >>"$work/wrong"
    [ ! -s "$work/wrong" ] || fail "$(cat "$work/wrong")"
    read_surfaces "$room/few.ply" | grep -q 'triangles 200 open 0 ' || fail "not 200 triangles"
done <<'EOF'
1,0,0,0 0,1,0,0 0,0,1,0
-1,0,0,30 0,1.5,0,-20 0,0,3,7
0,0.5,-0.2,3 0.9,0,0.1,4 0.1,0.3,2,-5
0,0,2,1 0,-1,0.25,2 1.25,0,0,3
EOF
read_surfaces "$work"/1/all.ply "$work"/1/all.obj "$work"/1/all.vtp | sed 's/.*colours//' |
    sort -u >"$work/colours"
same "$(cat "$work/colours")" " #102030 #aabbcc"
read_surfaces "$work"/1/one.ply "$work"/1/one.obj "$work"/1/one.vtp | sort -u >"$work/ones"
same "$(wc -l <"$work/ones")" 1

begin "every format of the table has a reader here, and is written above"
endings=$(sed -n 's/.*{"\(\.[a-z0-9]*\)", [a-z]*, write_[a-z]*}.*/\1/p' src/image/surface_file.c)
[ "$(printf '%s\n' "$endings" | wc -l)" -ge 4 ] || fail "the table was not understood: $endings"
for ending in $endings; do
    grep -q "\"${ending#.}\": read_${ending#.}[,}]" tests/surface_reader.py ||
        fail "tests/surface_reader.py does not read $ending"
    grep -q "save surface all\\$ending" "$0" && grep -q "save surface one\\$ending" "$0" ||
        fail "no surface is saved as $ending"
done

begin "a surface is written whole, again only where that is asked for, and the same by a replay"
make_scene "$work/s.nii" 24 20 16
expect_in "$work" 0 "$iftty" -c "open s.nii; seed 6,10,8 1; seed 20,10,8 2
    save surface a.ply triangles=900; save surface a.stl; save surface a.vtp; save surface a.obj" \
    --journal j.iftty
echo "save surface a.ply" >"$work/again.iftty"
expect_in "$work" 3 "$iftty" run again.iftty --journal j.iftty
err_has "a.ply exists already and was left alone; replace=yes overwrites it"
expect_in "$work" 0 "$iftty" replay j.iftty --out again
for ending in ply stl vtp obj; do same_files "$work/a.$ending" "$work/again/a.$ending"; done
IFTTY_THREADS=1 expect_in "$work" 0 "$iftty" verify j.iftty
grep -qa "orientation unknown" "$work/a.stl" || fail "a.stl names the world"
grep -qa "SPACE=RAS" "$work/1/all.stl" || fail "no SPACE=RAS in all.stl"
expect_in "$work" 0 "$iftty" -c "open s.nii; seed 6,10,8 1; save surface b.ply"
out_has "its coordinates are in millimetres along the voxel axes"
expect_in "$work" 0 "$iftty" -c "open s.nii; seed 6,10,8 1; finish open radius=2; finish largest
    save surface raw.ply; save surface finished.ply finished=yes; save labels f.nii finished=yes" \
    --journal finished.iftty
grep -qa "; finished: open radius=2, largest" "$work/finished.ply" || fail "no note of what it is"
! cmp -s "$work/raw.ply" "$work/finished.ply" || fail "finished=yes is the same"
[ -n "$(last_word finished "$work/finished.iftty")" ] || fail "no digest of finished labels"
expect_in "$work" 3 "$iftty" -c "open s.nii; seed 6,10,8 1; save surface nowhere/a.ply"
err_has "there is no folder nowhere"
left=$(find "$work" -name '.iftty-*')
[ -z "$left" ] || fail "a draft is left: $left"

finish
