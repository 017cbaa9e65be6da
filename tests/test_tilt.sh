#!/bin/sh
# SPDX-License-Identifier: MIT
# Series of a scanner whose gantry leans, made by pydicom, and sheared sforms, by nibabel: a ball in
# the world has its volume, its surface and its place, on slices as they are and straightened.
. "$(dirname "$0")/lib.sh"

cat >make.py <<'END'
"""make.py TESTS: leans/, steep/ and plain/, series of a ball; leans.nii, the same.
   make.py TESTS ball MAP MM: whether label 1 of a map is the ball, in the world, within so much."""
import sys
sys.path.insert(0, sys.argv[1] + "/volumes")
import make
import nibabel
import numpy

RADIUS, MIDDLE = 17.0, numpy.array([3.0, -8.0, 21.0])


def place(degrees, size):
    """The table moves along the patient, and slices lean by so much."""
    turn = numpy.radians(degrees)
    to_mm = numpy.eye(4)
    to_mm[:3, 0] = [0.9, 0, 0]
    to_mm[:3, 1] = [0, 0.8 * numpy.cos(turn), 0.8 * numpy.sin(turn)]
    to_mm[:3, 2] = [0, 0, 2]
    to_mm[:3, 3] = MIDDLE - to_mm[:3, :3] @ (numpy.array(size) / 2)
    return to_mm


def depth(to_mm, size):
    """How far each voxel is from the surface, inwards."""
    index = numpy.stack(numpy.meshgrid(*[numpy.arange(n) for n in size], indexing="ij"), -1)
    return RADIUS - numpy.linalg.norm(index @ to_mm[:3, :3].T + to_mm[:3, 3] - MIDDLE, axis=-1)


def series():
    for name, degrees in (("leans", 15), ("steep", -27), ("plain", 0)):
        size = (52, 60, 34)
        to_mm = place(degrees, size)
        data = (1000 * numpy.clip(depth(to_mm, size) / 2 + 0.5, 0, 1)).astype(numpy.int16)
        make.save_series(name, make.slices_of(data, to_mm))
        image = nibabel.Nifti1Image(data, to_mm)
        image.header.set_xyzt_units("mm")
        nibabel.save(image, name + ".nii")


def ball(path, mm):
    image = nibabel.load(path)
    label = numpy.asarray(image.dataobj) == 1
    to_mm = image.affine
    far = depth(to_mm, label.shape)
    wrong = (label != (far > 0)) & (numpy.abs(far) > mm)
    middle = to_mm[:3, :3] @ numpy.argwhere(label).mean(0) + to_mm[:3, 3] - MIDDLE
    axes = to_mm[:3, :3].T @ to_mm[:3, :3]
    lean = numpy.abs(axes - numpy.diag(numpy.diag(axes))).max()
    if wrong.any() or numpy.abs(middle).max() > mm / 4:
        sys.exit("%d voxels are wrong, the middle is %s mm off" % (wrong.sum(), middle))
    print("sheared" if lean > 1e-3 else "straight")


ball(sys.argv[3], float(sys.argv[4])) if len(sys.argv) > 3 else series()
END
"$PYTHON" -W ignore make.py "$top/tests" || exit 1

# measures OPEN: of the ball, on that scene: $mm3 and $mm2, and the map all.nii
measures() {
    rm -f all.nii report.json first.iftty j.iftty
    expect 0 "$iftty" -c "open $1" --journal first.iftty || return
    last=$(last_word size first.iftty | awk -F, '{ print $1 - 1 "," $2 - 1 "," $3 - 1 }')
    level=${2:-0} # half of the ball's value, in the file's unit
    expect 0 "$iftty" -c "open $1
        box 0,0,0 $last 1 range=$level..9999
        box 0,0,0 $last 0 range=-9999..$((level - 1)); run
        stats report=report.json; save labels all.nii" --journal j.iftty || return
    mm3=$("$PYTHON" -c 'import json
one = json.load(open("report.json"))["by_label"][0]
print(round(one["volume_mm3"]), round(one["surface_mm2"]))')
    mm2=${mm3#* } mm3=${mm3% *}
}
is_near() { # WHAT IS WANTED PERCENT
    awk -v is="$2" -v wanted="$3" -v percent="$4" \
        'BEGIN { off = 100 * (is / wanted - 1); exit !(off <= percent && off >= -percent) }' ||
        fail "$1 is $2, not $3 within $4 %"
}
lies() { # straight|sheared [MM]: the ball of all.nii, in its place
    "$PYTHON" -W ignore make.py "$top/tests" ball all.nii "${2:-0.4}" >"$work/lie" 2>&1 ||
        fail "$(tail -n 2 "$work/lie")"
    same "$(cat "$work/lie")" "$1"
}
ball_mm3=20580 ball_mm2=3632

begin "volumes and surfaces of sheared slices are measured in the world, in every answer"
for scene in leans steep plain leans.nii steep.nii; do
    level=0
    case $scene in *.nii) level=500 ;; esac
    measures $scene $level
    is_near "the volume of $scene" "$mm3" $ball_mm3 0.7
    is_near "the surface of $scene" "$mm2" $ball_mm2 3
    [ $scene = plain ] || lies sheared
done
measures leans
out_has "20.5 ml"
grep -q '"shear_degrees": 15' report.json || fail "$(cat report.json)"
out_has "roughly, of sheared axes"
expect 0 "$iftty" -c "open leans; measure 10,10,3 10,10,23; measure 10,10,3 10,34,23; info"
out_has "its axes are sheared: 15 degrees off a right angle; volumes, surfaces and"
out_has "40.00 mm, 20.00 voxels from 10,10,3 to 10,10,23"
out_has "48.64 mm" # 40 and 19.2 mm, at an angle of 75 degrees
expect 0 "$iftty" compare all.nii all.nii
out_has "axes are sheared by 15 degrees; distances ignore that"
expect 0 "$iftty" compare --json all.nii all.nii
grep -q '"shear_degrees": 15' "$work/out" || fail "$(cat "$work/out")"

begin "a straightened ball keeps its place and volume; the journal verifies"
for scene in leans steep leans.nii steep.nii; do
    level=0
    case $scene in *.nii) level=500 ;; esac
    measures "$scene straighten=yes" $level
    is_near "the volume of $scene" "$mm3" $ball_mm3 0.7
    is_near "the surface of $scene" "$mm2" $ball_mm2 2
    lies straight
    expect 0 "$iftty" verify j.iftty
    has_line j.iftty "^open $scene straighten=yes weight=morph"
    ! grep -q shear report.json || fail "$(cat report.json)"
done
answers "52x82x34 voxels of 0.9x0.8x1.93185 mm" "open leans straighten=yes"
out_has "straightened: its axes were 15 degrees off a right angle; slices are shifted in their"
out_has "voxels beyond them are -1000"
! grep -q "its axes are sheared" "$work/out" || fail "$(cat "$work/out")"
answers "its axes are at right angles: nothing to straighten" "open plain straighten=yes"
answers "its axes are sheared" "open leans straighten=no"
expect_err "huge and straighten are for files" 2 "$iftty" -c "open synth:geom straighten=yes"
"$PYTHON" - <<'END' || fail "nibabel writes no scene"
import nibabel, numpy
to_mm = numpy.diag([1.0, 1, 2, 1])
to_mm[1, 2] = 0.5
nibabel.save(nibabel.Nifti1Image(numpy.eye(9, dtype=numpy.uint8).reshape(3, 9, 3), to_mm), "up.nii")
END
answers "its axes are oblique: up to 14 degrees off" "open up.nii"
answers "straightened: its axes were 14 degrees off a right angle" "open up.nii straighten=yes"
! grep -q "its axes are oblique" "$work/out" || fail "$(cat "$work/out")"

begin "the same for a part, an interpolated scene, and a map of the original slices"
measures "leans crop=4-47,4-55,5-28 reduce=2 straighten=yes"
lies straight
is_near "the volume of a part" "$mm3" $ball_mm3 2
expect 0 "$iftty" verify j.iftty
measures leans
mv all.nii sheared.nii
rm -f j.iftty
expect 0 "$iftty" -c "open leans straighten=yes; 
    seed-file sheared.nii regions=0-1 as=0,1 erode=0 resample=yes; run
    save labels all.nii" --journal j.iftty
lies straight 1.3
expect 0 "$iftty" verify j.iftty
refuses "resample=yes" "open leans straighten=yes; seed-file sheared.nii"
rm -f j.iftty
expect 0 "$iftty" -c "open leans straighten=yes; interpolate 1 2 2; seed 26,60,33 1 radius=3
    seed 2,2,2 0; run; info" --journal j.iftty
expect 0 "$iftty" verify j.iftty

finish
