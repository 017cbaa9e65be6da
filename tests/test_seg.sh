#!/bin/sh
# SPDX-License-Identifier: MIT
# DICOM SEG, read by `labels` (volumes/seg.py): places, overlaps, fractions, and damaged files.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"

begin "an oblique CT, its segmentations and maps of the same labels are made"
made_by seg.py
overlaps=$(cat "$work/made")

# labelled OPTIONS TWIN: the CT with these labels, saved, has the voxels of the map, and its place,
# for finish_opened; the answers are in $work/out
labelled() {
    opened=$((opened + 1))
    a=$work/v/$opened.a.nii b=$work/v/$opened.b.nii
    expect 0 "$iftty" -c "open $2.twin.nii; labels $2.twin.nii; save labels $b"
    expect 0 "$iftty" -c "open ct; labels $1; save labels $a; stats"
    cat "$work/err" >>"$work/out"
    same "$1: $(voxels_of $a | cksum)" "$1: $(voxels_of $b | cksum)"
    printf '%s\t%s\t%s\n' "$1" "$a" "$b" >>"$work/opened"
}

begin "each voxel of a SEG has its label at its place, whatever the order of frames"
for name in binary implicit unspaced labelmap labelmap8; do
    labelled $name.dcm labels
    out_has "$name.dcm: 3 labels and the background, 10 markers"
    out_has "3 names and colours from the file"
    out_has "label 1 liver: 1 marker"
    out_has 'label 3 spleen "left": 7 markers'
done
labelled few.dcm few # planes that are missing, of an unknown distance
labelled "binary.dcm rest=keep regions=1,2,3" labels
expect_out "DICOM SEG" 0 "$iftty" info binary.dcm
expect_out "0 of 8008 voxels differ" 0 "$iftty" compare labels.twin.nii binary.dcm
for name in binary.dcm labels.twin.nii; do
    expect 0 "$iftty" -c "open ct crop=2-20,3-18,2-10; labels $name; save labels $name.nii"
done
same "$(voxels_of binary.dcm.nii | cksum)" "$(voxels_of labels.twin.nii.nii | cksum)"

begin "names, colours and labels of a SEG are in the journal's copy"
expect 0 "$iftty" -c "open ct; labels binary.dcm; save names a.txt" --journal seg.iftty
has_line a.txt '^ *1  *159  *89  *64 .*"liver"'
mv binary.dcm away.dcm
expect 0 "$iftty" verify seg.iftty
mv away.dcm binary.dcm

begin "where segments overlap, the highest number is the label, and the voxels are counted"
labelled overlap.dcm overlap
out_has "$overlaps voxels are in several segments: the one with the highest number has them; \
regions=N reads one of them"
for name in overlap.dcm overlap-1.twin.nii; do
    expect 0 "$iftty" -c "open ct; mask $name regions=1" --journal "$name.iftty"
    sed -n 's/^= 2 \(.*\) chain.*/\1/p' "$name.iftty" >"$name.mask"
done
same_files overlap.dcm.mask overlap-1.twin.nii.mask
labelled "overlap.dcm regions=1" overlap-1
grep -q "several segments" "$work/out" && fail "regions=1 has no overlaps"

begin "fractional segments need a threshold, which is inclusive; other maps have none"
labelled "fractional.dcm threshold=0.6" labels
answers "fractional.dcm: 0 labels" "open ct; labels fractional.dcm threshold=0.601"
refused "of fractions, 0 to 1; \`labels FILE threshold=0.5\`" "open ct; labels fractional.dcm"
refused "and these are binary: leave it out" "open ct; labels binary.dcm threshold=0.5"
expect_err "and this is nifti-1: leave it out" 2 "$iftty" -c \
    "open ct; labels few.twin.nii threshold=0.5"
expect_err "of fractions" 3 "$iftty" compare labels.twin.nii fractional.dcm

begin "another grid is refused, or resampled"
refused "resample=yes uses its nearest voxels" "open ct; labels bad-other-grid.dcm"
answers "resampled from 26x22x13 voxels" "open ct; labels bad-other-grid.dcm resample=yes"
refused "the map has 26x22x13 voxels, the scene 13x11x7, and its file 26x22x14; a map must be on \
the grid of the scene or of its file, and DICOM SEG lacks planes without segments; otherwise use \
resample=yes, for its nearest voxels" "open ct reduce=2; labels binary.dcm"
answers "resampled from 26x22x13 voxels" "open ct reduce=2; labels binary.dcm resample=yes"
for how in "" resample=yes; do # without what was there before
    labelled "labels.twin.nii; labels few.dcm $how" few
done

begin "another frame of reference is named"
"$PYTHON" -c 'import pydicom
one = pydicom.dcmread("binary.dcm")
one.FrameOfReferenceUID = "1.2.3"
one.save_as("elsewhere.dcm")'
answers "another DICOM frame of reference" "open ct; labels elsewhere.dcm"
answers "another DICOM frame of reference" "open ct; channel elsewhere.dcm"
expect 0 "$iftty" -c "open ct; labels binary.dcm"
[ "$(grep -c "frame of reference" "$work/out")" = 0 ] || fail "$(cat "$work/out")"

begin "a voxel of a SEG elsewhere is not tested by a proof"
mkdir here
"$PYTHON" -c 'import nibabel
nibabel.save(nibabel.load("labels.twin.nii").slicer[9:10, 9:10, 6:7], "here/one.nii")'
expect_in here 0 "$iftty" -c "open one.nii; channel ../binary.dcm" --journal one.iftty
grep -q ' sha256=.* sha256=\|^= 2 .* sha256=' here/one.iftty || fail "$(cat here/one.iftty)"
expect 3 "$iftty" verify here/one.iftty
expect 0 "$iftty" verify here/one.iftty --channel binary.dcm

# may_label FILE...: in one session, each is read, and counted in $read, or refused in one line
may_label() {
    { echo open ct; printf 'labels %s\n' "$@"; } >script
    expect 3 timeout 600 "$iftty" run --keep-going script
    read=$(grep -c '^ok [0-9]* labels' "$work/out")
    same "$(grep -c '^script:[0-9]*: ' "$work/err") $(wc -l <"$work/err")" \
        "$(($# - read)) $(($# - read))"
}
begin "contradictory files are refused in one line"
while read -r name words; do
    refused "$words" "open ct; labels $name.dcm"
    refused "$words" "open $name.dcm"
done <<'END'
bad-many says that it has 1000000000 frames, and describes 19
bad-more says that it has 20 frames, and describes 19
bad-large cut short: 1360 of 10200236035 bytes
bad-stray frame 3 is of segment 9, which it does not describe
bad-both a frame is of several segments
bad-nowhere frame 3 of its segments holds no place
bad-shifted frame 3 is up to 0.5 mm off
bad-between its frames are not evenly spaced
bad-far its frames are not evenly spaced, or too far apart
bad-endless frame 3 of its segments is more than a kilometre away
bad-twice its segments are not numbered from 1
bad-again frames 2 and 3 hold the same segment in one plane
bad-padded with 11 bytes more than its frames of 26x22 have
bad-none without segments
bad-kind whose pixels are not those of
bad-pixels cut short
END
at=300
while [ $at -lt "$(wc -c <binary.dcm)" ]; do
    head -c $at binary.dcm >cut-$at.dcm
    at=$((at + 331))
done
may_label cut-*.dcm
same "$read" 0
"$PYTHON" -B "$top/tests/volumes/seg.py" corpus # that of the fuzz target
expect 0 "$build/tests/fuzz/replay" seg 0 bad-*.dcm corpus/* </dev/null
"$PYTHON" -B "$top/tests/volumes/seg.py" damage binary.dcm
may_label damaged-*

begin "a saved SEG has each voxel at its place, names, colours, numbers and references"
expect 0 "$iftty" -c "open ct; labels binary.dcm; label 7 empty; label 300 third number=300; \
seed 2,2,2 300 radius=2 within=0 over=0; save labels out.dcm; save labels out.nii; \
save labels again.dcm; save names out.txt"
same_files out.dcm again.dcm # the same bytes, without a date
expect 0 "$PYTHON" -B "$top/tests/volumes/seg.py" read out.dcm out.nii ct
cat >listed <<'END'
1 liver [30073, 40021, 39977]
2 Nebenniere rechts~u\337erer Teil
END
same "$(sed -n 's/^\([0-9]*\)|\(.*\)|\[.*/\1 \2/p' "$work/out" | tr '\n' ,)" \
    '1 liver,2 Nebenniere rechts~ußerer Teil,3 spleen "left",7 empty,300 third,'
expect 0 "$iftty" -c "open ct; labels out.dcm; save labels back.nii; save names back.txt"
same "$(voxels_of back.nii | cksum)" "$(voxels_of out.nii | cksum)"
same_files out.txt back.txt # with the colours
expect_out "yes: out.dcm" 0 dcmftest out.dcm
dcmdump out.dcm >dump 2>dump.err
same "$(cat dump.err)" ""
has_line dump '(0008,0023) DA \[19000101\]'
has_line dump '(0010,0010) PN (no value available)'
grep -q SECRET dump && fail "it names the patient: $(grep SECRET dump)"

# codes_of SCRIPT: the codes of labels, after these commands
codes_of() {
    rm -f codes.json
    "$iftty" -c "open ct; $1; run; stats report=codes.json" >"$work/none" 2>&1
    "$PYTHON" -c 'import json; print(*("%d %s" % (l["number"], l["code"])
        for l in json.load(open("codes.json"))["by_label"]), sep=", ")'
}

begin "a place that all frames share is that of each"
expect 0 "$iftty" -c "open ct; labels bad-shared.dcm; save labels shared.nii"
expect 0 "$PYTHON" -c 'import nibabel, numpy
a, b = (numpy.asarray(nibabel.load(name).dataobj) for name in ("shared.nii", "labels.twin.nii"))
z = numpy.nonzero(a.any((0, 1)))[0]
assert len(z) == 1 and (a[:, :, z] == b[:, :, z]).all()'

begin "codes are read, set, undone, written to each format and read back"
liver=SCT:10200004:Liver
same "$(codes_of "labels binary.dcm")" "1 $liver, 2 $liver, 3 $liver"
echo '1 liver 9 9 9 0
2 colon 9 9 9 0' >names.ctab
same "$(codes_of "label-file names.ctab; labels binary.dcm")" "1 $liver, 2 , 3 $liver"
answers "1 label with another name than before, whose code remains" \
    "open ct; labels binary.dcm; label-file names.ctab"
"$iftty" -c "open ct; labels binary.dcm" >"$work/out"
out_has "3 codes from the file"
grep -q "more in the file" "$work/out" && fail "nothing is lost"
coded="labels binary.dcm; label 2 kidney code=SCT:64033007; label 3 \"the spleen\"; \
label 3 spleen code=none; label 1 liver code=none; undo"
same "$(codes_of "$coded")" "1 $liver, 2 SCT:64033007, 3 "
expect 0 "$iftty" -c "open ct; $coded; save labels coded.dcm; save labels coded.seg.nrrd; \
save labels coded.nii.gz" --journal coded.iftty
out_has "its code remains $liver; code=none removes it"
expect 0 "$iftty" verify coded.iftty
for name in coded.dcm coded.seg.nrrd coded.nii.gz; do
    same "$name: $(codes_of "labels $name")" "$name: 1 $liver, 2 SCT:64033007, 3 "
    "$iftty" -c "open ct; labels $name" >"$work/out"
    grep -q "more in the file" "$work/out" && fail "$name: nothing is lost"
done
expect 0 "$iftty" -c "open ct; labels coded.dcm" --journal copied.iftty
mv coded.dcm away.dcm
expect 0 "$iftty" copied.iftty <<'END'
run
stats report=codes.json replace=yes
END
same "$(grep -c '"code": "SCT:64033007"' codes.json)" 1
expect 0 "$iftty" verify copied.iftty
mv away.dcm coded.dcm
expect 0 "$PYTHON" -B "$top/tests/volumes/seg.py" read coded.dcm labels.twin.nii ct
same "$(cut -d '|' -f 1,2,4- "$work/out" | sort)" \
    "1|liver|SCT|123037004|Anatomical Structure|SCT|10200004|Liver
2|kidney|SCT|123037004|Anatomical Structure|SCT|64033007|kidney
3|spleen|SCT|85756007|Tissue|SCT|85756007|Tissue"
same "$(grep -a 'Segment1_Tags' coded.seg.nrrd)" "Segment1_Tags:=TerminologyEntry:Segmentation \
category and type - DICOM master list~SCT^123037004^Anatomical Structure~SCT^64033007^kidney~^^~\
Anatomic codes - DICOM master list~^^~^^|"
needs dciodvfy && {
    dciodvfy coded.dcm >"$work/out" 2>&1
    same "$(grep Error "$work/out")" ""
}

begin "what a SEG has besides a code is counted, and a meaning that does not fit left out"
same "$(codes_of "labels bad-coded.dcm")" "1 $liver, 2 SRT:M-01000, 3 "
same "$(codes_of "labels bad-lacking.dcm")" "1 , 2 , 3 " # without a value, a scheme, with a colon
answers "3 labels with more in the file" "open ct; labels bad-lacking.dcm"
expect 0 "$iftty" -c "open ct; labels bad-coded.dcm"
out_has "3 labels with more in the file, which is not kept: IDs or tags of 3D Slicer, or the \
category, modifier or region of a code"

begin "the patient and a date are written only on request"
expect 0 "$iftty" -c "open ct; labels binary.dcm; save labels known.dcm identity=keep times=yes"
dcmdump known.dcm >dump
has_line dump "(0010,0010) PN \[SECRETNAME^ANNA\]"
has_line dump "(0008,0020) DA \[19450508\]"
has_line dump "(0008,0023) DA \[20"
expect 0 "$PYTHON" -B "$top/tests/volumes/seg.py" read known.dcm labels.twin.nii ct
same "$(cmp -s known.dcm out.dcm && echo same)" ""
expect_err "identity= and times= are for" 2 "$iftty" -c \
    "open ct; labels binary.dcm; save labels new.nii times=yes"

begin "dciodvfy finds no error in them"
needs dciodvfy && for name in out known; do
    dciodvfy $name.dcm >"$work/out" 2>&1
    out_has "Segmentation"
    same "$name: $(grep Error "$work/out")" "$name: "
done

begin "parts of the series refer to their slices, and other grids to the series"
expect 0 "$iftty" -c "open ct crop=2-20,3-18,4-10; labels binary.dcm; save labels part.dcm; \
save labels part.nii"
expect 0 "$PYTHON" -B "$top/tests/volumes/seg.py" read part.dcm part.nii ct
expect 0 "$iftty" -c "open ct reduce=2; seed 3,3,3 5 radius=2 within=0; save labels half.dcm; \
save labels half.nii"
expect 0 "$PYTHON" -B "$top/tests/volumes/seg.py" read half.dcm half.nii

begin "nothing is written without the files of the series, or over another file"
refuses "the scene is no DICOM series" "open labels.twin.nii; labels labels.twin.nii; \
save labels no.dcm"
expect_err "holds labels alone" 2 "$iftty" -c "open ct; labels binary.dcm; run; save cost no.dcm"
refuses "out.dcm exists already" "open ct; labels binary.dcm; save labels out.dcm"
cp -r ct other
printf 'open other\nlabels binary.dcm\n' >script
expect 0 "$iftty" run script --journal other.iftty
printf 'save labels later.dcm\n' >more
expect 0 "$iftty" other.iftty <more
expect 0 "$PYTHON" -B "$top/tests/volumes/seg.py" read later.dcm labels.twin.nii other
{
    echo 'open other'
    echo 'labels binary.dcm'
    until [ "$(grep -c '^= ' changed.iftty 2>"$work/none")" = 2 ]; do sleep 0.1; done
    cp ct/IM5 other/IM6
    echo 'save labels no.dcm'
} | expect 3 "$iftty" run - --journal changed.iftty
comes_true test ! -e no.dcm

finish_opened
