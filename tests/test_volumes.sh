#!/bin/sh
# Volumes that NIfTI is not, in files that other people's programs wrote (volumes/make.py): the same
# voxels in the same place as a NIfTI of nibabel's; what a file leaves open, lacks or holds twice;
# nothing private comes out; helpers that misbehave.
. "$(dirname "$0")/lib.sh"
PYTHON=/usr/bin/python3
unset IFTTY_SCENES

begin "files of other programs are made"
mkdir "$work/v"
"$PYTHON" -W ignore "$top/tests/volumes/make.py" "$work/v" >"$work/made" 2>&1 ||
    fail "$(tail -n 3 "$work/made")"
close_story
cd "$work/v" || exit 1

# opened_as FILE TWIN [OPTION...]: the same scene, in the same place
opened_as() {
    name=$1 twin=$2
    shift 2
    rm -f "$work"/[ab].nii "$work"/[ab].iftty
    expect 0 "$iftty" -c "open $twin; save labels $work/b.nii" --journal "$work/b.iftty"
    expect 0 "$iftty" -c "open $name $*; save labels $work/a.nii" --journal "$work/a.iftty" ||
        return
    for key in scene sha256 size spacing-nm; do
        value=$(last_word $key "$work/a.iftty")
        [ -n "$value" ] && [ "$value" = "$(last_word $key "$work/b.iftty")" ] ||
            fail "$name: $key is $value, not $(last_word $key "$work/b.iftty")"
    done
    is=$(last_word orientation "$work/a.iftty")
    case $(last_word orientation "$work/b.iftty") in
    unknown) same "$name $is" "$name unknown" ;;
    *) same "$name $is" "$name file" ;;
    esac
    "$PYTHON" "$top/tests/volumes/make.py" same "$work/a.nii" "$work/b.nii" 2>"$work/err" ||
        fail "$name: $(tail -n 9 "$work/err")"
}

begin "NRRD: three types, two spaces, packed, beside its header"
for name in LPS-short RAS-short LPS-byte RAS-byte LPS-float RAS-float; do
    opened_as $name.nrrd $name.nrrd.twin.nii
done
opened_as beside.nhdr beside.nhdr.twin.nii
close_story

begin "MetaImage: whole, packed, beside its header and nowhere else"
for name in whole.mha packed.mha apart.mhd; do
    opened_as $name $name.twin.nii
done
expect 3 "$iftty" -c "open outside.mhd"
close_story

begin "MINC 1 and 2, MRC, VTK, HDF5, TIFF, folders of TIFF and PNG, raw"
for name in small.mnc tiny.mnc a.mrc a.vtk a.h5 stack.tif tif-slices png-slices; do
    opened_as $name $name.twin.nii
done
opened_as minc2_4d.mnc minc2_4d.mnc.twin.nii volume=1
opened_as two.h5 two.h5.twin.nii data=/grey
opened_as raw:plain.raw plain.raw.twin.nii size=26,22,14 type=int16
close_story

begin "DICOM: as it is, by three packings, tilted, rescaled by slice, with a file twice"
for name in ct ct-dcmcrle ct-dcmcjpeg ct-dcmcjpls tilted pet doubled; do
    opened_as $name $name.twin.nii
done
opened_as times times.twin.nii volume=1
opened_as mixed ct.twin.nii series=1
opened_as gaps gaps.twin.nii missing=blank
close_story

refused() { # WORDS COMMAND: in one line
    expect 3 "$iftty" -c "$2"
    err_has "$1"
    same "$2: $(wc -l <"$work/err" | tr -d ' ') line" "$2: 1 line"
}
begin "what a file leaves open is asked, and what is wrong with it is said"
refused "it holds 2 series; choose one with series=N: 1: 14 slices of 26x22, CT; 2: 5 slices" \
    "open mixed"
refused "there is no series 3" "open mixed series=3"
refused "3 slices are missing (2 after slice 4, 1 after slice 7) of 14" "open gaps"
refused "place 4 of 14 along the series holds 2 slices" "open clash"
refused "a series of 2 volumes; choose one" "open times"
refused "choose one with data=NAME: /deep/other (26x22x14 int16), /grey" "open two.h5"
mkdir nothing
refused "the folder holds no slices" "open nothing"
expect 0 "$iftty" -c "open uneven"
out_has "slices are not evenly spaced: 2 to 3 mm apart; taken as 2.53846 mm"
expect 0 "$iftty" -c "open tilted"
out_has "its axes are sheared"
expect 0 "$iftty" -c "open doubled"
out_has "1 file is a copy of others, and left out"
expect 0 "$iftty" -c "open raw:plain.raw size=26,22,13 type=int16"
out_has "1144 of its bytes come after the voxels"
expect 0 "$iftty" -c "open stack.tif spacing=0.5,0.5,2"
out_has "26x22x14 voxels of 0.5x0.5x2 mm"
expect 2 "$iftty" -c "open a.vtk spacing=0.5,0.5,2"
err_has "the file says that its voxels are 0.9x1.1x2.5 mm apart"
expect 2 "$iftty" -c "open raw:plain.raw"
err_has "expected its layout"
close_story

finish
