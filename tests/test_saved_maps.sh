#!/bin/sh
# SPDX-License-Identifier: MIT
# Saved maps as other people's programs read them: NRRD by teem's unu, with the voxels and the place
# that the same map has as NIfTI.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
start='seed 2,3,4 0; seed 6,10,8 1; seed 20,10,8 7; label 7 "left lobe" #40c060; label 9 nothing'

# place FILE: its voxels run to the left, to the front and up, turned, from 90,-126,-72 mm on
place() {
    "$PYTHON" - "$1" <<'END'
import struct, sys
with open(sys.argv[1], 'r+b') as f:
    f.seek(254)
    f.write(struct.pack('<h', 1))
    f.seek(80)
    f.write(struct.pack('<3f', 2, 2.5, 5))
    f.seek(280)
    f.write(struct.pack('<12f', -2, 0, 0, 90, 0, 2, -3, -126, 0, 1.5, 4, -72))
END
}
# The voxels of a NIfTI of ours, of an NRRD as unu reads them, of a MetaImage: on standard output.
nifti_voxels() {
    python3 -c 'import struct, sys
bytes = open(sys.argv[1], "rb").read()
sys.stdout.buffer.write(bytes[int(struct.unpack_from("<f", bytes, 108)[0]):])' "$1"
}
nrrd_voxels() {
    teem-unu save -f nrrd -e raw -i "$1" | teem-unu data -
}
mha_voxels() {
    tail -c "$2" "$1"
}
has_header() { # FILE LINE
    sed '/^$/q' "$1" | grep -aqxF -e "$2" || fail "no '$2' in $1:" "$(sed '/^$/q' "$1")"
}

begin "every map as NRRD and MetaImage equals the NIfTI, voxel for voxel"
needs teem-unu && {
    maps='labels cost root border distance margin'
    expect 0 "$iftty" -c "open s.nii; $start; $(printf "save %s %s.nii; save %s %s.nrrd; save %s \
%s.mha; " $(for m in $maps; do echo $m $m $m $m $m $m; done))"
    for map in $maps; do
        nifti_voxels $map.nii >expected
        nrrd_voxels $map.nrrd | cmp -s - expected || fail "$map.nrrd differs from $map.nii"
        mha_voxels $map.mha "$(file_bytes expected)" | cmp -s - expected || fail "$map.mha differs"
    done
    teem-unu head root.nrrd >out
    out_has 'type: unsigned int'
    teem-unu head cost.nrrd >out
    out_has 'type: unsigned short'
}

begin "where no place is known, none is written"
grep -aq '^space' labels.nrrd && fail "$(sed '/^$/q' labels.nrrd)"
has_header labels.nrrd 'spacings: 1 1 1'
grep -aqE '^(TransformMatrix|Offset|Anatom)' labels.mha && fail "labels.mha has a place"
grep -aqx 'ElementSpacing = 1 1 1' labels.mha || fail "labels.mha has no spacing"

begin "a place is written in the world of each format"
cp s.nii p.nii
place p.nii
expect 0 "$iftty" -c "open p.nii; $start; save labels p.nrrd; save labels p.mha"
has_header p.nrrd 'space: left-posterior-superior'
has_header p.nrrd 'space directions: (2,0,0) (0,-2,1.5) (0,3,4)'
has_header p.nrrd 'space origin: (-90,126,-72)'
grep -aqx 'Offset = -90 126 -72' p.mha || fail "$(strings p.mha | head -n 14)"
grep -aq '^TransformMatrix = 1 0 0 0 -0.8 0.6 0 0.6 0.8$' p.mha || fail "axes of p.mha"

begin "a map without a label is refused, and voxels that no seed reaches are counted"
expect 3 "$iftty" -c 'open s.nii; seed 1,1,1 0; save labels empty.nii'
err_has 'no voxel has a label above 0: plant a `seed` of one first, or write the empty map with'
[ ! -e empty.nii ] || fail "it was written"
expect 3 "$iftty" -c 'open s.nii; save surface empty.stl'
expect 0 "$iftty" -c 'open s.nii; save labels empty.nii empty=yes'
out_has '7680 voxels that no seed reaches have no label'
expect 0 "$iftty" -c 'open s.nii; seed 6,10,8 1 radius=2; save labels all.nii'
! grep -q 'have no label' out || fail "$(cat out)"
expect 0 "$iftty" -c 'open s.nii; seed 6,10,8 1 within=2; save labels some.nii; save surface s.stl'
same "$(grep -c '7647 voxels that no seed reaches have no label' out)" 2
expect 0 "$iftty" -c 'open s.nii; range 90 1000; seed 20,10,8 1; save labels roi.nii'
out_has 'voxels outside the region of interest have no label'
expect 2 "$iftty" -c 'open s.nii; save cost c.nii empty=yes'

begin "a .seg.nrrd has names, colours and extents of its segments"
expect 0 "$iftty" -c "open p.nii; $start; save labels l.seg.nrrd; save labels l.nii"
for line in 'Segment0_ID:=Segment_1' 'Segment0_Name:=Segment_1' 'Segment0_LabelValue:=1' \
    'Segment1_Name:=left lobe' 'Segment1_LabelValue:=7' 'Segment1_Layer:=0' \
    'Segment1_Color:=0.250980 0.752941 0.376471' 'Segment2_Name:=nothing' \
    'Segment2_Extent:=0 -1 0 -1 0 -1' 'Segmentation_MasterRepresentation:=Binary labelmap'; do
    has_header l.seg.nrrd "$line"
done
grep -aq '^Segment3' l.seg.nrrd && fail "a fourth segment"
nifti_voxels l.nii | od -An -v -tu1 -w1 | awk -v nx=24 -v ny=20 '$1 == 7 {
    i = NR - 1; p[0] = i % nx; p[1] = int(i / nx) % ny; p[2] = int(i / nx / ny)
    for (a = 0; a < 3; a++) {
        if (!n || p[a] < low[a]) low[a] = p[a]
        if (!n || p[a] > high[a]) high[a] = p[a] }
    n++ } END { print "Segment1_Extent:=" low[0], high[0], low[1], high[1], low[2], high[2] }' >want
has_header l.seg.nrrd "$(cat want)"
needs teem-unu && {
    nifti_voxels l.nii >expected
    nrrd_voxels l.seg.nrrd | cmp -s - expected || fail "l.seg.nrrd differs from l.nii"
}
expect 2 "$iftty" -c "open p.nii; $start; save cost c.seg.nrrd"
err_has 'a .seg.nrrd holds labels; expected .nrrd for this map'
[ ! -e c.seg.nrrd ] || fail "it is there"

# The file as a scene: its digest (voxels, spacing, axes) and the position of its far corner.
seen_as() {
    rm -f seen.iftty
    "$iftty" -c "open $1; why 23,19,15" --journal seen.iftty >seen || fail "cannot open $1"
    echo "$(last_word sha256 seen.iftty) $(sed -n 's/.* at \(.* mm\):.*/\1/p' seen)"
}
begin "ITK reads the same voxels in the same place"
expect 0 "$iftty" -c "open p.nii; $start; save cost q.nii; save cost q.nrrd; save cost q.mha
save labels l.nii replace=yes"
same "$(seen_as q.nii | wc -w | tr -d ' ')" 3
for file in q.nrrd q.mha; do same "$(seen_as $file)" "$(seen_as q.nii)"; done
same "$(seen_as l.seg.nrrd)" "$(seen_as l.nii)"
expect_out '9x5x7 voxels' 0 "$iftty" -c "open q.mha crop=2-19,0-9,1-15 reduce=2; info"

begin "FreeSurfer's files, as nibabel reads them: the voxels and the place of the same NIfTI"
maps='labels cost border distance margin'
expect 0 "$iftty" -c "open p.nii; $start; $(printf "save %s f-%s.nii; save %s f-%s.mgz; " \
    $(for m in $maps; do echo $m $m $m $m; done)) save cost f.mgh"
"$PYTHON" - $maps 2>err <<'END' || fail "$(cat err)"
import gzip, nibabel, numpy, sys
for name in sys.argv[1:]:
    a, b = nibabel.load("f-%s.nii" % name), nibabel.load("f-%s.mgz" % name)
    p, q = numpy.asarray(a.dataobj), numpy.asarray(b.dataobj)
    assert p.shape == q.shape and (p == q).all(), name
    assert numpy.abs(a.affine - b.affine).max() < 1e-5, (name, a.affine, b.affine)
    assert q.dtype == (">u1" if name in ("labels", "border") else ">i4"), (name, q.dtype)
assert gzip.open("f-cost.mgz").read() == open("f.mgh", "rb").read()
END
same "$(seen_as f-labels.mgz)" "$(seen_as f-labels.nii)"
same "$(seen_as f-cost.mgz)" "$(seen_as f-cost.nii)"
expect 2 "$iftty" -c "open p.nii; $start; save root r.mgz"
err_has "FreeSurfer's files hold no numbers up to 4294967295; expected .nii.gz, .nrrd or .mha"
answers 'its position is as unknown as that of the scene' "open s.nii; $start; save labels s.mgz"
expect 0 "$iftty" -c "open s.nii; seed-file s.mgz"
expect 0 "$iftty" -c "open f-cost.mgz; save labels again.mgz empty=yes" # bit for bit
"$PYTHON" - 2>err <<'END' || fail "$(cat err)"
import gzip
a, b = (gzip.open(name).read()[30:90] for name in ("f-cost.mgz", "again.mgz"))
assert a == b, (a, b)
END

begin "the same map has the same bytes, and a failed save leaves no file"
save="save labels l.seg.nrrd replace=yes; save labels m.seg.nrrd"
expect 0 "$iftty" -c "open p.nii; $start; $save"
same_files l.seg.nrrd m.seg.nrrd
expect 3 "$iftty" -c "open p.nii; $start; save labels l.seg.nrrd"
same_files l.seg.nrrd m.seg.nrrd
expect 2 "$iftty" -c "open p.nii; $start; weight polarity; save margin n.nrrd"
err_has "there is no margin under \`weight polarity\`"
[ ! -e n.nrrd ] || fail "a margin under polarity"
finish
