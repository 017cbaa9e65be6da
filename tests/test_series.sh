#!/bin/sh
# SPDX-License-Identifier: MIT
# Files of scanners other than plain slices (volumes/series.py): mosaics of Siemens, as nibabel
# reads them; folders with several series, and with damaged files.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"

begin "files as scanners write them are made"
made_by series.py

begin "a mosaic is the volume that nibabel reads of it, in the same place"
twins % mosaic reversed full one uncalled thick
opened_as more mosaic.twin.nii # of which the rest is blank, and not 0
opened_as mosaic/IM0 mosaic.twin.nii
twins % volume=1 times
for options in "dwi0" "dwi1000" "dwi volume=1"; do
    saved=$work/opened-${options##*[ =]}.nii
    expect 0 "$iftty" -c "open $options; seed 64,64,24 1; run; save labels $saved"
    printf '%s\t%s\t%s\n' "$options" "$saved" "$work/v/dwi0.twin.nii" >>"$work/opened"
done
answers "128x128x48 voxels of 1.79688x1.79687x3 mm" "open dwi0"
expect_out "axes      LPS" 0 "$iftty" info dwi0
expect 0 "$iftty" -c "open thick"
out_has "it says how thick its slices are, 2.25 mm, and not how far apart: taken as the same"
answers "27x21x1 voxels" "open cut"

begin "a mosaic without its layout is rejected, and never read as one large slice"
refused "a series of 3 volumes; choose one, as in \`open FILE volume=0\`, of 0 to 2" "open times"
for name in bare uncounted broken bare/IM0; do
    refused "a mosaic, and nothing says how many images it holds" "open $name"
done
refused "do not say the same of how many images it holds" "open contrary"
refused "without the place of its images" "open unturned"
refused "header says 7 images, which do not fit side by side into its 61x84 pixels" "open odd"
refused "holds more images than its private header says" "open hidden"

begin "a folder of several series lists their differences, in several lines if one is too long"
expect 3 "$iftty" -c "open study"
err_has "it holds 6 series; choose one with series=N, or with a piece of its description"
same "$(wc -l <"$work/err")" 1
cat >"$work/listed" <<'END'
    1: "localizer", 5 slices of 26x22, MR, 0.9x1.1x2.5 mm
    2: "t1_mprage sag", 14 slices of 26x22, MR, 0.9x1.1x2.5 mm
    3: "gre_field", 5 slices of 26x22, MR, 0.9x1.1x2.5 mm, TE 4.92 ms
    4: "gre_field", 5 slices of 26x22, MR, 0.9x1.1x2.5 mm, TE 7.38 ms
    5: "gre_field", 5 slices of 26x22, MR, 0.9x1.1x2.5 mm, TE 7.38 ms, phase
    6: 5 slices of 26x22, MR, 1.8x2.2x2.5 mm
END
cmp -s "$work/out" "$work/listed" || fail "$(diff "$work/listed" "$work/out")"
expect 3 "$iftty" info study
sed 's/^    //' "$work/listed" | cmp -s - "$work/out" || fail "$(cat "$work/out")"
expect 3 "$iftty" -c "open many"
same "$(grep -c '^    [0-9]*: "protocol with a long name, and number' "$work/out")" 30
refused "it holds 2 series; choose one with series=N, or with a piece of its description: \
1: 1 slice of 78x66, MR, 0.9x1.1x2.5 mm, cannot be read; 2: \"t2\", 5 slices" "open study-mosaic"
refused "IM0 is a mosaic, and nothing says how many" "open study-mosaic series=1"
expect 0 "$iftty" -c "open study-mosaic series=t2"
refused "2 of its 6 series have that in their description; choose one with series=N: \
2: \"t1_mprage sag\", 14 slices of 26x22, MR, 0.9x1.1x2.5 mm; 6: 5 slices of" \
    "open study series=mprage"
refused "no series has that in its description; it holds 2" "open study-mosaic series=flair"
refused "there is no series 3; it holds 2 series: 1: 1 slice" "open study-mosaic series=3"
for text in 0 100001 -2; do
    expect 2 "$iftty" -c "open study series=$text"
    err_has "series: expected 1..100000, or a piece of its description"
done
expect 2 "$iftty" -c "open mosaic.twin.nii series=t1"
err_has "series=N is for series of DICOM in a folder"

begin "a series that is named by its description is recorded by its number, and found again"
mkdir "$work/kept"
opened_as study study.twin.nii "series=\"T1_MPRAGE SAG\""
for words in 'series="1_mprage s"' series=2 series=002; do
    rm -f "$work/kept/j.iftty"
    expect 0 "$iftty" -c "open $work/v/study $words; seed 9,12,6 1; seed 1,1,1 0; run
        slice axial 6 $work/kept/s.png replace=yes; render $work/kept/r.exr replace=yes
        save labels $work/kept/l.nii replace=yes; golden front; info" \
        --journal "$work/kept/j.iftty" --keep-going
    grep -q "^open .*/study series=2 weight=morph\$" "$work/kept/j.iftty" ||
        fail "$(grep ^open "$work/kept/j.iftty")"
    cp "$work/out" "$work/kept/out"
    expect 0 "$iftty" verify --scene study "$work/kept/j.iftty"
    rm -rf "$work/kept/j.golden"
done
printf 'open study series="1_mprage s"\nseed 9,12,6 1\nrun\n' >script # and when it goes on
expect 0 "$iftty" run script --journal "$work/kept/j.iftty.whole"
awk '{ print } /^= 2/ { exit }' "$work/kept/j.iftty.whole" >"$work/kept/k.iftty"
expect 0 "$iftty" run script --journal "$work/kept/k.iftty"
same_files "$work/kept/k.iftty" "$work/kept/j.iftty.whole"
printf 'open study\nopen study series=9\n' >"$work/v/j"
expect 3 "$iftty" replay j >"$work/kept/replayed" 2>&1
cat "$work/out" "$work/err" >"$work/kept/said"
grep -q "it holds 6 series; choose one with series=N: 1: 5 slices of 26x22, MR" "$work/kept/said" ||
    fail "$(cat "$work/kept/said")"
grep -raiE 'mprage|localizer|gre_field|SECRETN' "$work/kept" >"$work/found" &&
    fail "$(head -c 300 "$work/found")"

begin "one bad file among many names itself, and may be left out, which is counted and recorded"
for name in damaged cut-header; do
    refused "IM2-4 is damaged: fetch it again; skip=IM2-4 leaves it out" "open $name series=2"
done
refused "IM2-4 is an image without pixels: fetch it again; skip=IM2-4 leaves it out" \
    "open cut-between series=2"
refused "IM2-4 is slice 5 of 14, which cannot be decoded" "open undecodable series=2"
err_has "; skip=IM2-4 leaves it out"
for name in damaged cut-header cut-between undecodable; do
    refused "a slice is missing (1 after slice 4) of 14" "open $name series=2 skip=IM2-4"
    rm -f j.iftty
    expect 0 "$iftty" -c "open $name series=2 skip=IM2-4 missing=blank" --journal j.iftty
    out_has "skip: 1 file left out"
    expect 0 "$iftty" verify j.iftty
done
answers "26x22x12 voxels" "open damaged series=2 skip=IM2-4,IM2-13,IM2-12 missing=blank"
out_has "skip: 3 files left out"
mkdir with-report
cp study/IM2-* with-report
"$PYTHON" -c "
import pydicom
report = pydicom.dcmread('study/IM2-4')
report.file_meta.MediaStorageSOPClassUID = '1.2.840.10008.5.1.4.1.1.88.11'
for name in 'PixelData', 'Rows', 'Columns':
    delattr(report, name)
report.save_as('with-report/SR')" || fail "pydicom writes no report"
opened_as with-report study.twin.nii
out_has "1 file of DICOM without pixels left out"
mkdir -p "below/deep, er"
cp damaged/IM2-4 "below/deep, er/of it"
cp study/IM2-* below
refused "deep, er/of it is damaged: fetch it again; skip=\"deep, er/of it\" leaves it out" \
    "open below"
opened_as below study.twin.nii 'skip="deep, er/of it"'
refused "skip: there is no file IM2-44 in the folder" "open damaged series=2 skip=IM2-4,IM2-44"
refused "skip=NAME leaves out files of a folder, and this is one file" "open mosaic/IM0 skip=IM0"
expect 2 "$iftty" -c "open mosaic.twin.nii skip=IM0"
err_has "skip=NAME is for a folder of slices, and this is nifti-1: leave it out"

begin "mosaics with wrong bytes are opened, or refused in one line"
rounds=$((25 * ${IFTTY_TEST_SCALE:-1}))
"$PYTHON" -c "
import random
for count in range(1, $rounds + 1):
    random.seed(count)
    data = bytearray(open('times/IM2', 'rb').read())
    at = data.index(b'SV10\4\3\2\1') if count % 3 else 132
    for _ in range(random.choice([1, 3, 20])):
        data[at + random.randrange(700)] = random.choice([0, 1, 127, 128, 255])
    open('broken-%d' % count, 'wb').write(data)"
rm -rf broken
cp -r times broken
while [ "$count" -lt $rounds ]; do
    mv "broken-$((count + 1))" broken/IM2
    may_open "$count" "open broken volume=0"
    [ $got = 0 ] || same "$count: $(wc -l <"$work/err") line" "$count: 1 line"
done
[ $((3 * bad)) -gt $((count + 1)) ] || fail "$bad of $count were refused"

cd "$work" || exit 1
. "$top/tests/tmux.sh"
begin_terminal
begin "at the prompt a list that is longer than the screen is paged, and its error is below it"
enter_anew "cd v; $iftty"
see '^session>$'
enter "open many"
see '1: "protocol with a long name, and number 1"'
see '^-- more --$'
press Space Space Space
see 'number 30"'
see '^error: .*it holds 30 series'
enter "open study"
see '^6: 5 slices of 26x22, MR, 1.8x2.2x2.5 mm'
see '^error: .*it holds 6 series'
enter "quit"

begin "slices behind links are read for their user; otherwise the remedy is printed"
cd "$work/v" || exit 1
mkdir "$work/annex" linked
number=0
find study -type f >files
while read -r file; do
    cp "$file" "$work/annex/$((number += 1))"
    ln -s "$work/annex/$number" linked
done <files
rm -f linked.iftty
expect 0 "$iftty" -c 'open linked series=1' --journal linked.iftty
for option in '' '--scene linked'; do
    expect 3 "$iftty" verify linked.iftty $option
    out_has "links not followed); in a replay no link of a folder is followed: \`cp -rL\` makes a"
done
cp -rL linked whole
expect 0 "$iftty" verify linked.iftty --scene whole
rm -r "$work/annex"
refuses "a link to a file that is not there, as of git-annex, is not followed: " 'open linked'

finish_opened
