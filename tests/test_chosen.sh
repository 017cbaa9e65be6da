#!/bin/sh
# SPDX-License-Identifier: MIT
# One volume of a map with several: layers of a .seg.nrrd, a NIfTI of one mask for each label, HDF5.
# Each command and program that reads a map accepts a choice, records it, and lists the choices.
. "$(dirname "$0")/lib.sh"

begin "maps of two volumes, and each volume as a separate file"
"$PYTHON" -W ignore - <<'END' 2>err || fail "$(cat err)"
import h5py, nibabel, numpy
random = numpy.random.default_rng(43)
size = (12, 10, 8)
place = numpy.diag([1.0, 1.5, 2.0, 1.0])
scene = random.integers(0, 200, size).astype("i2")
nibabel.save(nibabel.Nifti1Image(scene, place), "s.nii")
layer = numpy.zeros((2,) + size, "u1")
layer[0, 1:5, 1:5, 1:5], layer[0, 6:9, 1:5, 1:5] = 3, 1
layer[1, 3:8, 3:8, 3:6], layer[1, 9:11, 8:9, 6:7] = 1, 2
for number in (0, 1):
    nibabel.save(nibabel.Nifti1Image(layer[number], place), "only%d.nii" % number)
nibabel.save(nibabel.Nifti1Image(numpy.moveaxis(layer, 0, 3), place), "both.nii")
segment = [("Segment_1", "left lobe", 3, 0), ("Segment_2", "cyst", 1, 0),
           ("Segment_3", "vessel", 1, 1), ("Segment_4", "stone\\n2", 2, 1)]
lines = ["NRRD0004", "type: unsigned char", "dimension: 4", "space: left-posterior-superior",
         "sizes: 2 12 10 8", "space directions: none (-1,0,0) (0,-1.5,0) (0,0,2)",
         "kinds: list domain domain domain", "encoding: raw", "space origin: (0,0,0)"]
old = list(lines)
for i, (key, name, value, number) in enumerate(segment):
    lines += ["Segment%d_ID:=%s" % (i, key), "Segment%d_Name:=%s" % (i, name),
              "Segment%d_LabelValue:=%d" % (i, value), "Segment%d_Layer:=%d" % (i, number)]
for i, name in enumerate(("first", "second")): # as 3D Slicer wrote them before layers
    old += ["Segment%d_ID:=%s" % (i, name), "Segment%d_Name:=%s" % (i, name)]
voxels = numpy.moveaxis(layer, 0, 3).transpose(2, 1, 0, 3)
for name, text, data in (("both.seg.nrrd", lines, voxels), ("old.seg.nrrd", old, voxels > 0)):
    with open(name, "wb") as out:
        out.write(("\n".join(text) + "\n\n").encode() + data.astype("u1").tobytes())
with h5py.File("both.h5", "w") as out:
    out["maps"] = layer.transpose(0, 3, 2, 1)
    out["other"] = scene.transpose(2, 1, 0)
END
[ "$failures" = 0 ] || finish

# what_of FILE ARGUMENTS...: the output of each command that reads a map
commands_of() { # FILE WORDS
    printf '%s\n' "labels $1$2; run; save labels got.nii empty=yes" \
        "seed-file $1$2; run; save labels got.nii" \
        "mask $1$2; seed 4,4,4 1; run; save labels got.nii" \
        "weight $1$2; seed 1,1,1 1; seed 9,9,7 2; run; save labels got.nii" \
        "labels only0.nii; run; compare $1$2; save labels got.nii"
}
begin "labels, seed-file, mask, weight and compare accept volume=, as open does"
for number in 0 1; do
    commands_of "only$number.nii" "" >plain
    for file in both.nii both.seg.nrrd both.h5; do
        words=" volume=$number"
        [ "$file" != both.h5 ] || words="$words data=maps"
        commands_of "$file" "$words" >chosen
        paste -d '|' plain chosen >pairs
        while IFS='|' read -r one two; do
            rm -f got.nii
            expect 0 "$iftty" -c "open s.nii; $one"
            grep ' ml \|differ' out >answer
            voxels_of got.nii >expected && rm got.nii
            expect 0 "$iftty" -c "open s.nii; $two" --journal chosen.iftty
            grep ' ml \|differ' out | cmp -s - answer || fail "$two: $(cat out)"
            voxels_of got.nii >got # .seg.nrrd has names
            same_files got expected
            grep -q "^${two%%;*}" chosen.iftty ||
                grep -qF "volume=$number" chosen.iftty || fail "$(cat chosen.iftty)"
            expect 0 "$iftty" verify --no-strict chosen.iftty
            rm -rf chosen.iftty chosen.golden
        done <pairs
    done
done

begin "a replay without the copy of labels reads the volume that was recorded"
expect 0 "$iftty" -c "open s.nii; labels both.nii volume=1; run" --journal kept.iftty
grep -q '^labels both.nii volume=1 .*copy=\|^labels both.nii .*volume=1.*copy=' kept.iftty ||
    fail "$(cat kept.iftty)"
rm -r kept.golden
expect 0 "$iftty" verify --no-strict kept.iftty
sed 's/ volume=1/ volume=0/' kept.iftty >other.iftty
expect 3 "$iftty" replay other.iftty

begin "without it, each names the volumes and the words to type"
for command in labels seed-file mask weight compare; do
    expect 3 "$iftty" -c "open s.nii; $command both.nii"
    err_has "a series of 2 volumes; choose one, as in \`$command FILE volume=0\`, of 0 to 1"
    expect 3 "$iftty" -c "open s.nii; $command both.seg.nrrd"
    err_has "choose one, as in \`$command FILE volume=0\`, of 0 to 1; layers of segments:"
    err_has "volume=0 left lobe (3), cyst (1); volume=1 vessel (1), stone\\n2 (2)"
    expect 3 "$iftty" -c "open s.nii; $command both.nii volume=2"
    err_has "there is no volume 2; it holds 2, counted from 0"
    refuses "choose one with data=NAME: /maps" "open s.nii; $command both.h5"
done
expect 3 "$iftty" -c "open s.nii; labels old.seg.nrrd"
err_has "layers of segments: volume=0 first (1); volume=1 second (1)"
refuses "as in \`open FILE volume=0\`, of 0 to 1; layers of segments:" "open both.seg.nrrd"
for words in "volume=1" "data=maps"; do
    expect 2 "$iftty" -c "open s.nii; weight sobel $words"
    err_has "${words%=*}: \`weight sobel\` has none"
    expect_err "\`mask none\` has no" 2 "$iftty" -c "open s.nii; mask none $words"
    echo 1,1,1,1 >list.csv
    expect 2 "$iftty" -c "open s.nii; seed-file list.csv $words"
    err_has "are for label maps, and list.csv is a list"
done
expect 2 "$iftty" -c "open s.nii; labels both.nii volume=0 data=maps"
err_has "data=NAME is for data sets of HDF5"

begin "of a layer, the answer names the segments and their values"
expect 0 "$iftty" -c "open s.nii; labels both.seg.nrrd volume=1"
out_has "volume 1 of 2: the segments vessel (1), stone\\n2 (2)"

begin "programs accept --volume, one number for each file"
expect 0 "$iftty" compare only1.nii only0.nii --csv
grep -v nii out | cut -d, -f3- >expected
for files in "both.nii both.seg.nrrd --volume 1,0" "only1.nii both.nii --volume 0" \
    "both.seg.nrrd only0.nii --volume 1,0"; do
    expect 0 "$iftty" compare $files --csv
    grep -v nii out | cut -d, -f3- | cmp -s - expected || fail "$files: $(cat out)"
done
expect 0 "$iftty" compare both.nii only1.nii --volume 1,0 --picture p.png
out_has "0 of 960 voxels differ"
expect 3 "$iftty" compare both.nii only0.nii
err_has "both.nii: a series of 2 volumes; choose one, as in --volume 0, of 0 to 1"
expect 3 "$iftty" compare only0.nii both.nii --volume 0,2
err_has "there is no volume 2; it holds 2, counted from 0"
expect 2 "$iftty" compare only0.nii both.nii --volume x
expect 0 "$iftty" info --histogram both.nii --volume 1
sed -n '/^histogram/,$p' out >got
expect 0 "$iftty" info --histogram only1.nii
sed -n '/^histogram/,$p' out | cmp -s - got || fail "info: $(cat got)"
expect_err "as in --volume 0" 3 "$iftty" info --histogram both.nii

begin "apply opens the volume of each scene, and its journal says which"
"$PYTHON" -W ignore - <<'END' || fail nibabel
import nibabel, numpy
s = nibabel.load("s.nii")
a = numpy.asanyarray(s.dataobj)
nibabel.save(nibabel.Nifti1Image(numpy.stack([a * 0, a], 3), s.affine), "times.nii")
END
expect 0 "$iftty" -c "open s.nii; seed 2,2,2 1 radius=2; seed 9,8,6 2 radius=2; run" \
    --journal procedure.iftty
mkdir made
expect 3 "$iftty" apply procedure.iftty times.nii --by world --out made
{ cat out err; } >both.txt
grep -qF -e '--volume 0' both.txt || fail "$(cat both.txt)"
expect 0 "$iftty" apply procedure.iftty times.nii --by world --out made --volume 1
grep -q '^open .*times.nii volume=1' made/times.iftty || fail "$(cat made/times.iftty)"
expect 0 "$iftty" verify --no-strict made/times.iftty

finish
