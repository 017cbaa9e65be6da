#!/bin/sh
# SPDX-License-Identifier: MIT
# Volumes that a single NIfTI is not, in files that other people's programs wrote (volumes/make.py):
# the same voxels in the same place as a NIfTI of nibabel's; files with ambiguous, missing or
# repeated data; no private data in outputs; helpers that misbehave.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"
own=$("$PYTHON" -c "import nibabel, os; print(os.path.dirname(nibabel.__file__))")/tests/data

begin "files of other programs are made"
made_by make.py

alike() { # FILE...: each opens as the first does, in every word
    for name; do
        expect 0 "$iftty" -c "open $name; info"
        grep -v '^ok\|^    memory' "$work/out" >"$work/words"
        [ "$name" = "$1" ] && cp "$work/words" "$work/first"
        cmp -s "$work/words" "$work/first" || fail "$name:" "$(diff "$work/first" "$work/words")"
    done
}
begin "ANALYZE and NIfTI in pairs, by either file, of both byte orders, packed"
for pair in an-byte an-short an-float an-double spm99 spm2 medcon; do
    opened_as $pair.hdr $pair.twin.nii
    alike $pair.hdr $pair.img
done
opened_as an-int.hdr.gz an-int.twin.nii
alike an-int.hdr.gz an-int.img.gz
says=sform
for name in ni1.hdr ni1-packed.hdr.gz ni2.hdr; do
    opened_as $name ${name%%.*}.twin.nii
    alike $name ${name%%.*}.img${name#*.hdr}
done
says=file
gzip -n <an-byte.img >an-packed.img.gz # its header as it is
cp an-byte.hdr an-packed.hdr
cp an-byte.hdr CAPITALS.HDR
cp an-byte.img CAPITALS.IMG
alike an-byte.hdr an-packed.hdr an-packed.img.gz CAPITALS.HDR CAPITALS.IMG
answers "4x5x3 voxels" "open an-byte.img crop=2-9,3-12,0-5 reduce=2"

begin "MGH of FreeSurfer: five types, packed, several volumes, and without a place"
twins % byte.mgh short.mgz int.mgz float.mgh ushort.mgh nowhere.mgh
twins % volume=0 series.mgz
expect_out "volumes   2" 0 "$iftty" info series.mgz
expect 0 "$iftty" info nowhere.mgh
out_has "its goodRASFlag is 0: its spacing and its orientation in the patient are unknown"
out_has "spacing   unknown"
expect 0 "$iftty" -c "open nowhere.mgh spacing=1,1,2; orient RAS; seed 3,3,3 1; run"
expect 3 "$iftty" -c "open rgb.mgh"
err_has "its voxels are rgb (type 9); \`mri_convert --out_data_type float\` makes real numbers"
expect 0 "$iftty" -c "open $own/test.mgz volume=1; save labels $work/own.mgz empty=yes"
"$PYTHON" - "$own/test.mgz" "$work/own.mgz" 2>"$work/err" <<'END' || fail "$(cat "$work/err")"
import nibabel, sys
a, b = (nibabel.load(name) for name in sys.argv[1:])
assert (a.affine == b.affine).all() and b.shape == a.shape[:3], (a.affine, b.affine)
END

begin "NRRD: eight types, two spaces, packed, next to its header"
twins LPS-%.nrrd short byte float char int uint ushort double
twins RAS-%.nrrd short byte float
twins % beside.nhdr

begin "MetaImage: whole, packed, next to its header and in no other folder"
twins % whole.mha packed.mha apart.mhd
expect 3 "$iftty" -c "open outside.mhd"

begin "MINC 1 and 2, MRC, VTK, GIPL, HDF5, TIFF, folders of TIFF and PNG, raw"
twins % small.mnc tiny.mnc a.mrc a.vtk a.gipl a.h5 stack.tif tif-slices png-slices
mkdir "$work/room" # MINC 1 is read by way of a file in a folder that goes again
expect 0 env TMPDIR="$work/room" "$iftty" info tiny.mnc
expect 0 env TMPDIR="$work/room" "$iftty" -c 'open tiny.mnc'
same "$(ls -A "$work/room")" ""
expect 3 env TMPDIR="$work/none" "$iftty" -c 'open tiny.mnc'
err_has "it is MINC 1, which needs room in \$TMPDIR to read"
twins % volume=1 minc2_4d.mnc
opened_as two.h5 two.h5.twin.nii data=/grey
opened_as raw:plain.raw plain.raw.twin.nii size=26,22,14 type=int16

begin "DICOM: as it is, by three packings, tilted, rescaled by slice, with a file twice"
twins % ct ct-dcmcrle ct-dcmcjpeg ct-dcmcjpls tilted pet doubled
twins % volume=1 times
opened_as mixed ct.twin.nii series=1
opened_as gaps gaps.twin.nii missing=blank

begin "a head is the same from NIfTI and from DICOM: labels, slices, letters, rendition"
opened_as oblique ni1.twin.nii
for name in head.nii.gz head; do
    expect 0 "$iftty" -c "open $name; seed 45,54,45 1 radius=3; seed 5,54,45 0; run
        view 30 20; size 400 400; mosaic $work/$name-m.png; overlay tint
        slice sagittal 35 $work/$name-s.png" --journal "$work/$name.iftty"
done
for key in scene sha256 forest labels; do
    same "$key $(last_word $key "$work/head.iftty")" \
        "$key $(last_word $key "$work/head.nii.gz.iftty")"
done
for picture in m s; do
    expect 0 idiff -q "$work/head.nii.gz-$picture.png" "$work/head-$picture.png"
done

begin "single files of DICOM equal pydicom's result; a preamble is not sufficient"
twins one/%.dcm CT_small MR_small MR_small_RLE MR_small_bigendian MR_small_expb MR_small_implicit \
    MR_small_padded MR_small_jp2klossless MR_small_jpeg_ls_lossless rtdose rtdose_expb rtdose_rle \
    image_dfl tiff nifti words twelve dose-absolute dose-downwards
for name in rtdose_1frame rtdose_expb_1frame rtdose_rle_1frame; do # it says its thickness nowhere
    rm -f "$work"/[ab].iftty
    expect_out "voxel spacing unknown" 0 "$iftty" -c "open one/$name.dcm" --journal "$work/a.iftty"
    expect 0 "$iftty" -c "open one/$name.dcm.twin.nii" --journal "$work/b.iftty"
    for key in scene sha256; do
        same "$name $(last_word $key "$work/a.iftty")" "$name $(last_word $key "$work/b.iftty")"
    done
done
expect 0 "$iftty" -c "open one/rtdose_expb.dcm; info"
out_has "values    8e-06 * intensity +0.795" # a dose of 1e-6 a number
answers "bytes come after the pixels of 1 file, up to 128: left out" "open one/MR_small_padded.dcm"
expect 0 "$iftty" -c "open one/badVR.dcm" # which does not say how many frames there are
out_has "bytes come after the pixels of 1 file, up to 5600: left out"
answers "slices are not evenly spaced: 4 to 6 mm apart" "open one/dose-uneven.dcm"
for name in few many; do
    answers "voxel spacing unknown" "open one/dose-$name.dcm"
    out_has "its slices hold no place in the patient"
done
answers "it does not say what dose its numbers are" "open one/unscaled.dcm"
answers "they have 12 bits, up to bit 15: they are used unchanged" "open one/left.dcm"
answers "5.00 mm" "open one/unspaced.dcm spacing=0.5,0.25,1; measure 0,0,0 10,0,0"

begin "missing pixels are not read as zeros: the message has the file and its bytes"
refused "one/MR_truncated.dcm: cut short: 8130 of 8192 bytes of pixels are there" \
    "open one/MR_truncated.dcm"
expect_err "8130 of 8192 bytes" 3 "$iftty" info one/MR_truncated.dcm
refused "SECRETNAME_IM0021.dcm is cut short: 700 of 1144 bytes of pixels are there; and so are \
others, 2 in all; skip=SECRETNAME_IM0021.dcm leaves it out" "open one/cut-slice"
refused "cut short: 5000 of 6000 bytes of pixels are there" "open one/cut-plain.dcm"
refused "cut short: 5330 of 8192 bytes of pixels are there" "open one/cut-big.dcm"
refused "of 262144 bytes of pixels are there" "open one/cut-deflated.dcm"
refused "cut short: the last piece of its packed pixels has 6538 of 6830 bytes" \
    "open one/cut-jpeg.dcm"
for name in cut-jpeg-ls cut-jpeg-2000 cut-rle; do
    refused "cut short: the last piece of its packed pixels has" "open one/$name.dcm"
done
for name in few-jpeg short-jpeg few-jpeg-ls short-jpeg-ls; do
    refused "cut short: 2 of 3 frames of its packed pixels are whole" "open one/$name.dcm"
done
refused "cut short: 14 of 15 frames" "open one/few-rle.dcm"
expect 0 "$iftty" -c "open one/whole-jpeg.dcm"
expect 0 "$iftty" -c "open one/whole-jpeg-ls.dcm"
refused "one/bomb.dcm: a deflated DICOM file of more than 256 MB when it is inflated; \`dcmconv" \
    "open one/bomb.dcm"
refused "its pixels have colours" "open one/SC_rgb_rle.dcm"
refused "its pixels have 1 bits; expected 8, 16 or 32" "open one/bits.dcm"
refused "holds no pixels of whole numbers" "open one/float.dcm"

begin "missing facts of a file are requested, and its errors are reported"
refused "it holds 2 series; choose one with series=N, or with a piece of its description: \
1: 14 slices of 26x22, CT, 0.9x1.1x2.5 mm; 2: 5 slices of 26x22, MR, 0.9x1.1x2.5 mm" \
    "open mixed"
refused "there is no series 3" "open mixed series=3"
refused "3 slices are missing (2 after slice 4, 1 after slice 7) of 14" "open gaps"
refused "place 4 of 14 along the series holds 2 slices" "open clash"
refused "a series of 2 volumes; choose one" "open times"
refused "choose one with data=NAME: /deep/other (26x22x14 int16), /grey" "open two.h5"
mkdir nothing
refused "the folder holds no slices" "open nothing"
answers "slices are not evenly spaced: 2 to 3 mm apart; taken as 2.53846 mm" "open uneven"
answers "its axes are sheared" "open tilted"
answers "1 file is a copy of others, and left out" "open doubled"
answers "1144 of its bytes come after the voxels" "open raw:plain.raw size=26,22,13 type=int16"
answers "26x22x14 voxels of 0.5x0.5x2 mm" "open stack.tif spacing=0.5,0.5,2"
expect 0 "$iftty" -c "open stack.tif"
! grep -q resolution "$work/out" || fail "$(cat "$work/out")"
for name in fine fine/s1.tif; do
    expect 0 "$iftty" -c "open $name"
    out_has "its resolution says pixels of 0.1x0.1 mm, and nothing how far apart slices are"
    out_has "with spacing=0.1,0.1,Z" "voxel spacing unknown"
done
expect 2 "$iftty" -c "open a.vtk spacing=0.5,0.5,2"
err_has "the file says that its voxels are 0.9x1.1x2.5 mm apart"
expect_err "expected its layout" 2 "$iftty" -c "open raw:plain.raw"
while read -r format words; do
    expect_err "and this is $format: leave it out" 2 "$iftty" -c "open $words"
done <<'END'
DICOM ct data=/grey
DICOM ct/SECRETNAME_IM0000.dcm data=/grey
HDF5 two.h5 data=/grey series=1
HDF5 a.h5 missing=blank
NRRD LPS-short.nrrd series=2
TIFF stack.tif missing=blank
END
expect 2 "$iftty" -c "open fine missing=blank"
err_has "missing=blank is for a series of DICOM, and this is TIFF slices: leave it out"
expect 2 "$iftty" -c "open minc2_4d.mnc data=/grey"
err_has "and this is MINC: leave it out; volume=N chooses one of its volumes"
# Options for the scene's file do not apply to a map's.
expect 0 "$iftty" -c "open two.h5 data=/grey; seed 3,3,3 1; run; save labels $work/all.nii"
answers "1 region" "open two.h5 data=/grey crop=2-9,3-12,0-5; seed-file $work/all.nii"
answers "its orient byte, 0, is not to be relied on" "open spm2.hdr; info"
out_has "its values are multiplied by 0.25, then 0 is added"
out_has "the .mat of SPM next to it may have its position; it is not read: \`nib-convert"
out_has "orientation unknown: no picture or answer names a side"
expect 0 "$iftty" -c "open an-byte.hdr"
! grep -qE "multiplied|[.]mat" "$work/out" || fail "$(cat "$work/out")"
cp -r nothing pair
cp an-short.hdr an-byte.img pair
mv pair/an-byte.img pair/an-short.img
refused "pair/an-short.hdr: its .img: cut short or false: its header claims 16016 bytes" \
    "open pair/an-short.hdr"
cp an-float.img pair/an-short.img
expect 0 "$iftty" -c "open pair/an-short.img"
out_has "16016 of its bytes come after the voxels; is this .img the one of this .hdr?"
printf '!INTERFILE :=\n' >pair/a.hdr
refused "\`medcon -f FILE -c nifti\` makes a NIfTI of it" "open pair/a.hdr"
mv pair/a.hdr pair/b.img
refused "there is no b.hdr next to it, with its header" "open pair/b.img"

begin "open and info explain rejections alike: CIFTI, PAR/REC, AFNI, ECAT, colours"
"$PYTHON" -W ignore - 2>"$work/err" <<'END' || fail "$(cat "$work/err")"
import nibabel, numpy
from nibabel import cifti2
model = cifti2.BrainModelAxis.from_mask(numpy.ones((3, 4, 5), bool), "thalamus_left",
                                        numpy.diag([2, 2, 2, 1]))
image = cifti2.Cifti2Image(numpy.ones((2, 60), "f4"), (cifti2.ScalarAxis(["a", "b"]), model))
nibabel.save(image, "made.dscalar.nii")
colours = numpy.zeros((4, 4, 4), [("R", "u1"), ("G", "u1"), ("B", "u1")])
nibabel.save(nibabel.Nifti1Image(colours, numpy.eye(4)), "rgb.nii")
END
while read -r name words; do
    refuses "$words" "open $name volume=0"
    "$iftty" info "$name" >"$work/out" 2>&1
    out_has "$words"
done <<END
$own/row_major.dconn.nii it is CIFTI, values of grayordinates and of no grid; \`wb_command
made.dscalar.nii it is CIFTI, values of grayordinates and of no grid; \`wb_command
$own/T2.PAR a PAR/REC of Philips, which is not read: \`dcm2niix FOLDER\` makes a NIfTI of it
$own/scaled+tlrc.HEAD a data set of AFNI, which is not read: \`3dAFNItoNIFTI FILE\` makes a
$own/scaled+tlrc.BRIK a data set of AFNI, which is not read: \`3dAFNItoNIFTI FILE\` makes a
$own/tinypet.v an ECAT volume, which is not read: \`dcm2niix FILE\` makes a NIfTI of it
rgb.nii its voxels are rgb24 (datatype 128); it has colours: take one channel
rgb.mgh its voxels are rgb (type 9)
END
expect_out '"refused": "it is CIFTI' 0 "$iftty" info --json made.dscalar.nii
cp an-short.twin.nii "$work/without-ending" # which open takes by its first bytes
expect_out "26x22x14" 0 "$iftty" info "$work/without-ending"
printf '\0\0\0\2 no header' >"$work/none.mgz"
refuses "none.mgz: cut short: it ends within the header (14 bytes on disk)" "open $work/none.mgz"
expect 3 "$iftty" info "$work/none.mgz"
err_has "none.mgz: cut short: it ends within the header (14 bytes on disk)"

begin "private data of a DICOM is in no output"
secrets='SECRETNAME|SECRETNUMBER|19450508|1[.]2[.]826[.]0[.]1[.]3680043'
mkdir "$work/private" plain
cp ct/SECRETNAME_IM0000.dcm plain/IM0
mv clash "$work/v/SECRET" # what the user calls things stays theirs; what is in the files does not
{
    "$iftty" -c "open ct; seed 9,12,6 1; seed 1,1,1 0; run; info; why 9,12,6
        slice axial 6 $work/private/s.png; render $work/private/r.png; render $work/private/r.exr
        save labels $work/private/l.nii.gz
        save labels $work/private/l.seg.nrrd
        golden front-1; save surface $work/private/s.ply" --journal "$work/private/j.iftty"
    for options in "ct" "mixed" "gaps" "SECRET" "uneven" "plain"; do
        "$iftty" -c "open $options; info" --journal "$work/private/$options.iftty"
    done
    "$iftty" info ct
    "$iftty" info plain/IM0
    "$iftty" info --json plain/IM0
    TMPDIR=$work/private "$iftty" replay "$work/private/j.iftty" --scene ct
} >"$work/private/said" 2>&1
for file in "$work"/private/* "$work"/private/*/*; do
    [ -f "$file" ] || continue
    case $file in *.nii.gz) gunzip -c "$file" ;; *) cat "$file" ;; esac |
        grep -aE "$secrets" >"$work/found" && fail "${file##*/}: $(head -c 200 "$work/found")"
done
grep -q "scene=" "$work/private/j.iftty" || fail "$(cat "$work/private/said")"
mv SECRET clash

# ---- a helper that misbehaves ----

# odd_helper SCRIPT: a program next to a copy of iftty, in place of the helper. It can print the
# 14 numbers of a header (`ones`), and a line of one of such sides (`begins SIDES`).
odd='ones() { for i in $(seq 14); do printf "\0\0\0\0\0\0\360\077"; done; }
begins() { echo "volume $1 1 0 5 5 0"; printf DICOMint16; }'
odd_helper() {
    mkdir -p "$work/odd"
    cp "$iftty" "$work/odd/iftty"
    printf '%s\n' '#!/bin/sh' "$odd" "$1" 'cat >/dev/null' >"$work/odd/iftty-volume"
    chmod +x "$work/odd/iftty-volume"
}
# told WORDS: the import fails with one line, and the session continues
told() {
    expect 3 timeout 60 "$work/odd/iftty" run --keep-going --journal "$work/odd/j.iftty" - <<'END'
open ct
open synth:geom:20x20x20
seed 3,3,3 1
END
    err_has "$1"
    same "$(wc -l <"$work/err")" 1
    out_has "ok 2 seed 3,3,3 1"
    rm -f "$work/odd/j.iftty"
}
begin "a helper that is missing, ends, dies, lies or floods ends only the import"
odd_helper 'exit 0'
rm "$work/odd/iftty-volume"
told "; the package iftty-volume has it"
: >"$work/odd/libiftty.a" # as beside the program of a checkout
told "\`make\` builds it (of ITK, which Debian has as libinsighttoolkit5-dev)"
rm "$work/odd/libiftty.a"
while IFS='|' read -r words script; do
    odd_helper "$script"
    told "$words"
done <<'END'
ended with status 7|exit 7
died (Segmentation fault)|kill -SEGV $$
invalid answer|echo what
invalid answer|yes progress
invalid answer|echo "volume 70000 1 1 1 3 5 5 0"; printf "DICOMint16"
expected finite ones|begins "65000 65000 65000"; head -c 112 /dev/zero
voxels|begins "65000 65000 65000"; ones
invalid answer|printf "volume 9 9 9 1 0 5 5 5\nDICOMint16\033[2J\n"; head -c 112 /dev/zero
invalid answer|echo "error 99999"; yes
weir|echo "volume 9 9 9 1 0 5 4 0"; printf DICOMweird; ones
ended with status 0|begins "9 9 9"; ones; read voxels; echo "piece 5"; printf 12345; exit
END

begin "Ctrl-C works while a helper runs, and ends the helper"
odd_helper 'echo $$ >"$0.pid"; echo progress 1 9; sleep 50 & wait'
env --default-signal=INT "$work/odd/iftty" -c "open ct" >"$work/out" 2>"$work/err" &
process=$!
comes_true test -s "$work/odd/iftty-volume.pid"
kill -INT "$process"
wait "$process"
err_has "cancelled; nothing has changed"
kill -0 "$(cat "$work/odd/iftty-volume.pid")" 2>/dev/null && fail "the helper lives on"

begin "a journal of another replays on such scenes, and reads no more than the folder it names"
rm -rf "$work/there"
mkdir "$work/there"
cp -r ct whole.mha apart.mhd apart.raw an-byte.hdr an-byte.img "$work/there"
cd "$work/there" || exit 1
for scene in ct whole.mha apart.mhd an-byte.hdr an-byte.img; do
    expect 0 "$iftty" -c "open $scene; seed 9,12,6 1; seed 1,1,1 0; run" --journal j.iftty
    expect 0 "$iftty" verify j.iftty
    rm j.iftty
done
printf 'open ../v/uneven\n' >j
expect_err "expected --scene FILE" 3 "$iftty" replay j
expect 0 "$iftty" replay j --scene "$work/v/uneven"
ln -s "$work/v/ct" away
printf 'open away\n' >j
expect_err "leads out of its folder" 3 "$iftty" replay j
rm -rf ct/*
ln -s "$work"/v/ct/* ct
printf 'open ct\n' >j
expect_err "the folder holds no slices" 3 "$iftty" replay j
expect 0 "$iftty" -c "open ct" # the user's own may be links
cd "$work/v" || exit 1

begin "dozens of files with wrong bytes: each is opened or refused in one line"
cat >"$work/break.py" <<'END'
import os, random, shutil, sys
source, place, ending, rounds = sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])
# Of 60 seeds, the six with the most different outcomes, and then others
for number, seed in enumerate([1, 6, 7, 16, 20, 51, *range(100, 94 + rounds)], 1):
    target = os.path.join(place, str(number), "broken" + ending)
    os.makedirs(os.path.dirname(target))
    random.seed(seed)
    (shutil.copytree if os.path.isdir(source) else shutil.copy)(source, target)
    one = target
    if os.path.isdir(target):
        one = os.path.join(target, random.choice(sorted(os.listdir(target))))
    data = bytearray(open(one, "rb").read())
    head = min(len(data), random.choice([64, 400, 3000, len(data)]))
    for _ in range(random.choice([1, 1, 3, 20])):
        data[random.randrange(head)] = random.choice([0, 1, 127, 128, 255, random.randrange(256)])
    if random.random() < 0.1:
        del data[random.randrange(len(data)):]
    open(one, "wb").write(data)
END
rounds=$((${ROUNDS:-6} * ${IFTTY_TEST_SCALE:-1}))
# ANALYZE, NIfTI and NRRD have targets of the fuzzer.
for name in whole.mha packed.mha small.mnc tiny.mnc a.mrc a.vtk a.h5 stack.tif tif-slices \
    png-slices ct ct-dcmcrle ct-dcmcjpeg ct-dcmcjpls; do
    ending=${name#"${name%%.*}"}
    "$PYTHON" "$work/break.py" "$name" "$work/broken" "$ending" $rounds
    for round in $(seq $rounds); do
        # OpenEXR, which needs no other helper
        may_open "$name $round" "open $work/broken/$round/broken$ending; size 64 64
            slice axial 0 $work/slice.exr replace=yes"
    done
    rm -rf "$work/broken"
done
[ $((4 * bad)) -gt "$count" ] || fail "$bad of $count were refused"

finish_opened
