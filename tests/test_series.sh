#!/bin/sh
# What scanners write besides plain slices (volumes/series.py): mosaics of Siemens, as nibabel reads
# them; folders of several series, and of files of which some are damaged.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"
unset IFTTY_SCENES

begin "files as scanners write them are made"
mkdir "$work/v"
"$PYTHON" -W ignore "$top/tests/volumes/series.py" "$work/v" >"$work/made" 2>&1 ||
    fail "$(tail -n 3 "$work/made")"
[ "$failures" = 0 ] || { close_story; finish; }
close_story
cd "$work/v" || exit 1

refused() { # WORDS COMMAND: in one line
    expect 3 "$iftty" -c "$2"
    err_has "$1"
    same "$2: $(wc -l <"$work/err" | tr -d ' ') line" "$2: 1 line"
}

begin "a mosaic is the volume that nibabel reads of it, in the same place"
for name in mosaic reversed full one uncalled thick; do
    opened_as $name $name.twin.nii
done
opened_as more mosaic.twin.nii # of which the rest is blank, and not 0
opened_as mosaic/IM0 mosaic.twin.nii
opened_as times times.twin.nii volume=1
for options in "dwi0" "dwi1000" "dwi volume=1"; do
    rm -f "$work/a.nii"
    expect 0 "$iftty" -c "open $options; seed 64,64,24 1; run; save labels $work/a.nii"
    "$PYTHON" "$top/tests/volumes/make.py" same "$work/a.nii" dwi0.twin.nii 2>"$work/err" ||
        fail "$options: $(tail -n 9 "$work/err")"
done
expect 0 "$iftty" -c "open dwi0"
out_has "128x128x48 voxels of 1.79688x1.79687x3 mm"
expect 0 "$iftty" info dwi0
out_has "axes      LPS"
expect 0 "$iftty" -c "open thick"
out_has "it says how thick its slices are, 2.25 mm, and not how far apart: taken as the same"
expect 0 "$iftty" -c "open cut"
out_has "27x21x1 voxels"
close_story

begin "a mosaic that does not say what it holds is refused, and never one large slice"
refused "a series of 3 volumes; choose one, as in \`open FILE volume=0\`, of 0 to 2" "open times"
for name in bare uncounted broken bare/IM0; do
    refused "a mosaic, and nothing says how many images it holds" "open $name"
done
refused "do not say the same of how many images it holds" "open contrary"
refused "does not say where its images lie" "open unturned"
refused "said to hold 7 images, and 61x84 pixels are not so many" "open odd"
refused "holds more images than its private header says" "open hidden"
close_story

finish
