#!/bin/sh
# SPDX-License-Identifier: MIT
# Maps whose axes are the scene's in another order, or run the other way, as nibabel reorders them:
# the same place, so the same voxels, without a question. Scene and maps are oblique.
. "$(dirname "$0")/lib.sh"

begin "a scene, and three maps of it in each of the 48 orders of axes, by nibabel"
"$PYTHON" -W ignore - 2>err <<'END' || fail "$(cat err)"
import itertools, nibabel, numpy
turn = numpy.array([[0.96, -0.28, 0.0], [0.2688, 0.9216, -0.28], [0.0784, 0.2688, 0.96]])
place = numpy.eye(4)
place[:3, :3] = turn * [0.9, 1.1, 2.5]
place[:3, 3] = [-31.5, 12.25, 40.0]
random = numpy.random.default_rng(1)
def save(data, name, order=None):
    image = nibabel.Nifti1Image(data, place)
    image.header.set_xyzt_units("mm")
    nibabel.save(image if order is None else image.as_reoriented(order), name)
for name, size in (("", (12, 10, 9)), ("cube-", (10, 10, 10))):
    scene = random.integers(0, 200, size).astype("i2")
    labels = random.integers(0, 4, size).astype("u1")
    weight = random.integers(0, 999, size).astype("u2")
    save(scene, name + "scene.nii")
    number = 0
    for axes in itertools.permutations(range(3)):
        for signs in itertools.product([1, -1], repeat=3):
            order = numpy.array(list(zip(axes, signs)))
            save(labels, "%smap%02d.nii" % (name, number), order)
            save(weight, "%sweight%02d.nii" % (name, number), order)
            number += 1
    save(labels, name + "ref.nii")
# As far away as half a voxel, which counts as the same place; and further.
for name, far in (("near", 0.4), ("far", 0.7)):
    place[:3, 3] += turn[:, 0] * far
    save(labels, name + ".nii", numpy.array([[2, -1], [0, -1], [1, 1]]))
    place[:3, 3] -= turn[:, 0] * far
END
[ "$failures" = 0 ] || finish

# alike OPEN COMMANDS: with MAP for a map of labels and WEIGHT for one of weights, commands give the
# same labels by all orders of axes, in one session that returns to its scene
alike() {
    rm -f got*.nii said*
    {
        echo "open $1"
        for n in $(seq -w 0 47); do
            echo "$2; save labels got$n.nii; goto 1" |
                sed "s/MAP/${cube}map$n.nii/g; s/WEIGHT/${cube}weight$n.nii/g; s/; */\n/g"
        done
    } >commands
    expect 0 "$iftty" run commands || return
    : >said0
    awk '/^    its axes run towards/ { print >("said" n + 0) } /^ok .* goto 1$/ { n++ }' out
    for n in $(seq -w 0 47); do cmp -s got00.nii "got$n.nii" || fail "$1, $2, order $n"; done
}
begin "seeds, a start, a mask and weights are the same by every order, and one line says it"
cube=
alike scene.nii "seed-file MAP erode=0; run"
same "$(cat said0)" ""
same "$(cat said47)" "    its axes run towards IPL and the scene's towards RAS: taken voxel by \
voxel, in the scene's order"
same "$(cat said47 said1 said19 | wc -l)" 3
alike scene.nii "labels MAP"
alike scene.nii "mask MAP regions=1-2; seed 3,3,3 1; run"
alike scene.nii "weight WEIGHT; seed 3,3,3 1; seed 8,8,8 2; run"
cube=cube- # where sizes say nothing of the order
alike cube-scene.nii "seed-file MAP erode=0; run"

begin "the map of a comparison: by the command, and by the program"
cube=
for n in 00 05 13 30 47; do
    cp "map$n.nii" b.nii
    expect 0 "$iftty" -c "open scene.nii; labels ref.nii; compare b.nii"
    grep -v 'its axes\|^ok\|[0-9] ms' out >"compared$n"
    same_files compared00 "compared$n"
    "$iftty" compare ref.nii b.nii >out 2>err || fail "$(cat err)"
    cp out "program$n"
    same_files program00 "program$n"
done

begin "a journal with such a map verifies"
expect 0 "$iftty" -c "open scene.nii; seed-file map29.nii erode=0; run
    mask map41.nii regions=0-3; run" --journal j.iftty
expect 0 "$iftty" verify j.iftty

begin "of a file that is opened in part, the same part in every order"
alike "scene.nii crop=2-9,1-7,3-8" "seed-file MAP erode=0; run"
alike "scene.nii crop=2-10,1-7,0-8 reduce=3" "seed-file MAP erode=0; run"
cube=cube-
alike "cube-scene.nii crop=0-4,5-9,2-6" "seed-file MAP erode=0; run"
alike "cube-scene.nii crop=1-8,5-9,2-6 reduce=3" "mask MAP regions=1; seed 1,0,0 1; run"
answers "its axes run towards ARS" "open scene.nii reduce=2; seed-file map16.nii erode=0"
expect 3 "$iftty" -c "open scene.nii reduce=2; seed-file map17.nii erode=0"
err_has "its axes are reversed to those of the scene, where each voxel is 2 along an axis"
# A map of the part itself, as it was opened.
expect 0 "$iftty" -c "open scene.nii crop=2-9,1-7,3-8; labels ref.nii erode=0; save labels part.nii"
"$PYTHON" - <<'END'
import nibabel, numpy
order = numpy.array([[0, -1], [1, 1], [2, -1]])
nibabel.save(nibabel.load("part.nii").as_reoriented(order), "turned.nii")
END
expect 0 "$iftty" -c "open scene.nii crop=2-9,1-7,3-8; labels turned.nii erode=0
    save labels again.nii"
same_files part.nii again.nii

begin "half a voxel away is the same place, more is not, and resampling on request works"
answers "its axes run towards" "open cube-scene.nii; seed-file near.nii erode=0"
out_has "the map is 0.4 mm off the scene's grid, less than half a voxel"
expect 3 "$iftty" -c "open cube-scene.nii; seed-file far.nii erode=0"
err_has "away from the scene; resample=yes uses its nearest voxels"
expect 0 "$iftty" -c "open cube-scene.nii; seed-file cube-map30.nii erode=0 resample=yes; run
    save labels asked.nii"
expect 0 "$iftty" -c "open cube-scene.nii; seed-file cube-map30.nii erode=0; run
    save labels unasked.nii"
same_files asked.nii unasked.nii

finish
