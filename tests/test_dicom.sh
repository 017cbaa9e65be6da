#!/bin/sh
# SPDX-License-Identifier: MIT
# DICOM with several images at each place, with numbers that are easily misread, and objects that
# are no images (volumes/kinds.py).
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"

begin "files of several images at each place are made"
made_by kinds.py

# scene_of OPEN: the digests of a scene, which hold its voxels, spacing and place
scene_of() {
    rm -f "$work/c.iftty"
    "$iftty" -c "open $1" --journal "$work/c.iftty" >"$work/out" 2>"$work/err" ||
        fail "$1: $(cat "$work/err")"
    sed -n 's/^= 1 \(.*\) weights=.*sha256=\([^ ]*\).*/\1 \2/p' "$work/c.iftty"
}

# same_scene NAME OPTIONS TWIN: a twin that has the bytes of another is opened once
same_scene() {
    twin=$work/twin-$(cksum <"$3" | tr ' ' -)
    [ -f "$twin" ] || scene_of "$3" >"$twin"
    same "$1 $2: $(scene_of "$1 $2")" "$1 $2: $(cat "$twin")"
}

# volumes_of NAME LABEL...: each volume is its twin, and the answer and a refusal have its label
volumes_of() {
    series=$1 volume=0
    shift
    for label in "$@"; do
        same_scene "$series" "volume=$volume" "$series-$volume.twin.nii"
        out_has "volume $volume: $label, 5 slices"
        volume=$((volume + 1))
    done
    last=$(($# - 1))
    refused "a series of $# volumes; choose one, as in \`open FILE volume=0\`, of 0 to $last; \
volume 0: $1, 5 slices; volume 1: $2, 5 slices" "open $series"
    refused "there is no volume $#; it holds $#" "open $series volume=$#"
}

begin "one tag tells the volumes of a series apart, whatever the names and numbers of its files"
opened_as echo echo-1.twin.nii volume=1
volumes_of echo "echo 4.92 ms" "echo 9.84 ms"
volumes_of echo-number "echo number 9" "echo number 10"
volumes_of b "b 0" "b 500" "b 1000"
volumes_of b-missing "b not said" "b 1000"
volumes_of gradient "b 0" "b 700, gradient 0,0,1" "b 700, gradient 0,1,0"
volumes_of phase "image type 1 of 2 (magnitude)" "image type 2 of 2 (phase)"
volumes_of derived "image type 1 of 2" "image type 2 of 2"
volumes_of inversion "inversion time 900 ms" "inversion time 2500 ms"
volumes_of flip "flip angle 4 degrees" "flip angle 20 degrees"
volumes_of temporal "temporal position 2" "temporal position 11"
volumes_of acquisition "acquisition number 9" "acquisition number 10"
volumes_of echo-phase "echo 5 ms, image type 1 of 2 (magnitude)" \
    "echo 5 ms, image type 2 of 2 (phase)" "echo 9 ms, image type 1 of 2 (magnitude)" \
    "echo 9 ms, image type 2 of 2 (phase)"
volumes_of b-twice "b 0, acquisition number 1" "b 0, acquisition number 3" "b 800"

begin "a time that differs from slice to slice divides a series by its order at each place"
volumes_of trigger "trigger time 12 to 20 ms" "trigger time 500 to 512 ms"
volumes_of time "acquisition time +0 to 0.04 s" "acquisition time +22 to 22.04 s"
volumes_of content "content time +0 to 0.04 s" "content time +1 to 1.04 s"
volumes_of midnight "acquisition time +0 to 240 s" "acquisition time +600 to 840 s"

begin "frames of an enhanced image are divided by the tags of their groups, in whatever order"
opened_as enhanced-echo enhanced-echo-1.twin.nii volume=1
volumes_of enhanced-echo "echo 4.92 ms" "echo 9.84 ms"
volumes_of enhanced-b "b 0" "b 500" "b 1000"
volumes_of enhanced-gradient "b 0" "b 700, gradient 0,0,1" "b 700, gradient 0,1,0"
volumes_of enhanced-phase "image type 1 of 2 (magnitude)" "image type 2 of 2 (phase)"
volumes_of enhanced-component "complex component 1 of 2 (magnitude)" \
    "complex component 2 of 2 (phase)"
volumes_of enhanced-inversion "inversion time 900 ms" "inversion time 2500 ms"
volumes_of enhanced-trigger "trigger time 20 to 32 ms" "trigger time 500 to 512 ms"
volumes_of enhanced-temporal "temporal position 2" "temporal position 11"
volumes_of enhanced-acquisition "acquisition number 9" "acquisition number 10"
volumes_of enhanced-time "acquisition time +0 to 0.04 s" "acquisition time +22 to 22.04 s"
volumes_of enhanced-index "dimension index 3: 1" "dimension index 3: 2"

begin "InstanceNumber decides where nothing else differs, and it divides the series in blocks"
volumes_of numbers "instance number 20 to 24" "instance number 40 to 44"
for name in numbers numbers-by-place; do
    same_scene $name volume=0 $name-0.twin.nii
    out_has "its images of one place differ in nothing but InstanceNumber, which divides them"
done

begin "a series that no tag divides into complete volumes is rejected, with the differences"
refuses="each place along the series holds 2 slices, and no tag divides them into whole volumes; \
those of one place differ in"
refused "$refuses instance number (10 values)" "open jumbled volume=0"
refused "$refuses no tag" "open used-twice volume=0"
refused "$refuses no tag" "open frames volume=0"
refused "$refuses content time (10 values), instance number (10 values)" \
    "open both-differ volume=0"
refused "$refuses echo (2 values), image type (2 values)" "open mixed-kinds volume=0"
refused "$refuses b (2 values), instance number (10 values)" "open one-wrong volume=0"
refused "place 1 of 5 along the series holds 2 slices and place 3 holds 1; those of one place \
differ in echo (2 values)" "open incomplete volume=0"
opened_as by-slice by-slice.twin.nii

begin "info lists the volumes of a series"
expect_out "volumes   3" 0 "$iftty" info b
out_has "note      volume 2: b 1000, 5 slices"

begin "a Modality LUT is applied, and a slope of 0 is none"
opened_as lookup lookup.twin.nii
out_has "its values are those of its Modality LUT"
twins % lookup-short lookup-bytes
for name in lookup-cut lookup-slope; do
    refused "an image whose Modality LUT is damaged, or contradicts its RescaleSlope" "open $name"
done
opened_as slope-0 slope-0.twin.nii
out_has "its slope is 0 and its intercept -1000: values are not scaled"
refused "is scaled by a slope of 0, and other slices are not; skip=IM" "open slope-0-once"

begin "files of one SOPInstanceUID are copies only if their place, tags and pixels are the same"
opened_as one-object one-object.twin.nii
out_has "4 images have the SOPInstanceUID of another, but not its place or pixels: kept"
volumes_of one-object-echoes "echo 5 ms" "echo 9 ms"
refused "those of one place differ in no tag" "open one-object-pixels volume=0"
opened_as packed-copy packed-copy.twin.nii
out_has "1 file is a copy of others, and left out"

begin "a decimal comma is refused in every number that is read, by its tag"
while read -r name words; do
    refused "is a file whose $words is no decimal number with a point" "open comma-$name"
    err_has "; skip=IM"
done <<'END'
RescaleSlope Rescale Slope (0028,1053)
RescaleIntercept Rescale Intercept (0028,1052)
PixelSpacing Pixel Spacing (0028,0030)
ImagePositionPatient Image Position (Patient) (0020,0032)
ImageOrientationPatient Image Orientation (Patient) (0020,0037)
SliceThickness Slice Thickness (0018,0050)
SpacingBetweenSlices Spacing Between Slices (0018,0088)
EchoTime Echo Time (0018,0081)
SliceLocation Slice Location (0020,1041)
END
refused "Rescale Slope (0028,1053) is no decimal number with a point" "open comma-enhanced"

begin "slices without a position are ordered by SliceLocation or number, which is reported"
says=unknown
for name in location location-down location-numbers location-jumbled; do
    opened_as $name $name.twin.nii
    out_has "they are in the order of their SliceLocation"
done
for name in numbers-alone location-once; do
    opened_as $name numbers-alone.twin.nii
    out_has "they are in the order of their numbers"
done
refused "a slice is missing (1 after slice 3) of 6" "open location-gap"
answers "they are in the order of their frames" "open frames-unplaced"
refused "no SliceLocation, and no InstanceNumber that differs from file to file" "open nothing"
says=file

begin "objects that are no images are refused by name, in every command that reads a volume"
while read -r name words; do
    file=objects/$name.dcm
    refused "$file: $words" "open $file"
    "$iftty" info "$file" >"$work/out" 2>&1
    out_has "$words"
    [ $name = rtstruct ] || continue
    expect 3 "$iftty" run --keep-going - <<END2
open by-slice
labels $file
seed-file $file
mask $file
weight $file
END2
    same "$file: $(grep -cF -e "$words" "$work/err") of $(wc -l <"$work/err")" \
        "$file: 4 of 4"
    expect_err "$words" 3 "$iftty" compare by-slice.twin.nii "$file"
done <<'END'
parametric a parametric map, which is not read; `paramap2itkimage
rtstruct contours of radiotherapy (RTSTRUCT), which are not read; `plastimatch convert
rtplan a plan or record of radiotherapy (RTPLAN), without voxels
report a structured report (SR), which has no voxels
pdf an encapsulated document (PDF, CDA, STL), without voxels
state a presentation state, which has no voxels
surface a surface segmentation, meshes without voxels
registration a registration or a list of points, which has no voxels
spectrum MR spectroscopy, which is not read
END
mkdir alone
cp objects/rtstruct.dcm alone
refused "rtstruct.dcm is contours of radiotherapy (RTSTRUCT)" "open alone"
cp objects/seg.dcm by-slice
refused "it holds 2 series" "open by-slice"
opened_as by-slice by-slice.twin.nii series=1
refused "seg.dcm is a segmentation (DICOM SEG)" "open by-slice series=2"

begin "labels of an enhanced image refer to its frames"
expect 0 "$iftty" -c "open enhanced-echo volume=1; seed 5,5,2 4 radius=3 within=0; \
save labels frames.dcm; save labels frames.nii"
expect 0 "$PYTHON" -B "$top/tests/volumes/seg.py" read frames.dcm frames.nii enhanced-echo
out_has "4|label 4"

begin "labels at missing slices refer to none"
for name in by-slice/IM*; do # until one is missing between others
    rm -rf gap
    cp -r by-slice gap
    rm "gap/${name#*/}"
    "$iftty" -c "open gap series=1" 2>&1 | grep -q missing=blank && break
done
expect 0 "$iftty" -c "open gap series=1 missing=blank; seed 5,5,2 1 radius=6 within=0; \
save labels gap.dcm"
dcmdump gap.dcm >dump
same "$(grep -c 0020,9113..SQ dump) $(grep -c 0008,9124..SQ dump)" "5 4"

finish_opened
