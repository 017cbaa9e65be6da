#!/bin/sh
# SPDX-License-Identifier: MIT
# Volumes that name other files: files below their folder are read, and all others rejected by name,
# on every kernel; missing voxels are not replaced, and no reader waits for a pipe.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"
loose() { # COMMAND...: as on a kernel without Landlock
    "$PYTHON" -I -S "$top/tests/volumes/without_landlock.py" "$@"
}
mkdir "$work/secret"

begin "files that name others are made"
made_by elsewhere.py

scene_of() { # COMMAND...: the digest of the scene that it opens
    rm -f "$work/j.iftty"
    expect 0 "$@" --journal "$work/j.iftty"
    last_word scene "$work/j.iftty"
}
whole=$(scene_of "$iftty" -c 'open twin.nii')
gap=cc7312228db948da

# sound NAME...: each opens as its twin does, confined or not
sound() {
    for name; do
        same "$name $(scene_of "$iftty" -c "open $name")" "$name $whole"
        same "$name $(scene_of loose "$iftty" -c "open $name")" "$name $whole"
    done
}
# refused WORDS NAME...: by `open`, with and without Landlock, and by `info`; the first also by the
# replay of a stranger's journal that has been let read without; at once, and nothing is written
refused() {
    words=$1
    shift
    printf 'open %s\n' "$@" >all
    for kernel in env loose; do
        expect 3 $kernel timeout 30 "$iftty" run --keep-going all
        same "$kernel: $(grep -cF -e "$words" "$work/err") of $(wc -l <"$work/err")" \
            "$kernel: $# of $#"
    done
    for name; do expect_err "$words" 3 timeout 30 "$iftty" info "$name"; done
    printf 'open %s\nslice axial 0 secret.png\n' "$1" >j
    expect_err "$words" 3 loose timeout 30 "$iftty" replay j --unconfined --out "$work/pictures"
    same "$(ls "$work/pictures")" ""
    expect_out "$words" 3 timeout 30 "$iftty" verify j
}

begin "voxels next to a header are read, by a name, a list or a count; also from HDF5"
sound plain.mhd inner.mhd counted.mhd list.mhd
mkdir packed
cp plain.mhd packed
gzip -nc v.raw >packed/v.raw.gz
sound packed/plain.mhd
sound plain.nhdr inner.nhdr counted.nhdr list.nhdr percent.nhdr
sound virtual.h5 virtual-own.h5 external-plain.h5
for name in virtual.h5 external-plain.h5 list.mhd list.nhdr; do
    expect_in / 0 "$iftty" -c "open $work/v/$name"
done

begin "a name that leads out of the folder of its header is refused, on every kernel"
refused "../secret/v.raw, which is not below the folder of the header" parent.mhd parent.nhdr \
    external-parent.h5 small.mhd many.nhdr
refused "secret/v.raw, which is not below the folder" absolute.mhd absolute.nhdr \
    external-absolute.h5
refused "away.raw, which is not below the folder" away.mhd away.nhdr external-away.h5
refused "folder/v.raw, which is not below the folder" folder.mhd folder.nhdr
refused "zero.raw, which is not below the folder" zero.mhd zero.nhdr
refused "../secret/s01.raw, which is not below" counted-parent.mhd counted-parent.nhdr
refused "../secret/s02.raw, which is not below" list-parent.mhd list-parent.nhdr
refused "../secret/v.h5, which is not below" virtual-parent.h5
refused "secret/v.h5, which is not below" virtual-absolute.h5
refused "away.h5, which is not below" virtual-away.h5
refused "a part of it is in another file, ../secret/v.h5" link.h5 itk.h5
refused "the data set d of linked.h5, which is not there" virtual-linked.h5

begin "a header that its library might read otherwise is refused"
sed 's/^DimSize.*/DimSize = 6 5 1\n&/; s/^ElementDataFile.*/ElementDataFile = LIST\nv.raw/' \
    plain.mhd >sides-twice.mhd
refused "which files its voxels are in" swallowed.mhd twice.nhdr late.nhdr counted-twice.mhd \
    counted-twice.nhdr sides-twice.mhd

begin "a pipe is not waited for"
refused "pipe.raw, which is not a regular file" pipe.mhd pipe.nhdr list-pipe.mhd list-pipe.nhdr \
    virtual-pipe.h5 external-pipe.h5
refused "deep, which is not a regular file" here.mhd here.nhdr

begin "directories of a TIFF that go in a circle are found before a reader goes round in them"
"$PYTHON" - <<'EOP'
import struct
def directory(following):
    entries = [(256, 3, 4), (257, 3, 4), (258, 3, 8), (259, 3, 1), (262, 3, 1), (273, 4, 200),
               (277, 3, 1), (278, 3, 4), (279, 4, 16)]
    return struct.pack("<H", len(entries)) + b"".join(
        struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in entries) + \
        struct.pack("<I", following)
pixels = (b"II*\0" + struct.pack("<I", 300)).ljust(200, b"\0") + bytes(range(16))
for name, after in ("circle.tif", 500), ("self.tif", 300):
    with open(name, "wb") as file:
        file.write((pixels.ljust(300, b"\0") + directory(after)).ljust(500, b"\0") + directory(300))
EOP
for name in circle self; do refuses "its pages lead back to one another" "open $name.tif"; done

begin "missing files are named, and not read as zeros"
refused "none.raw, which is not there" none.mhd none.nhdr list-none.mhd list-none.nhdr \
    external-none.h5
refused "s05.raw, which is not there" counted-none.mhd counted-none.nhdr
refused "its header names 3 files, and says that it has 4 pieces" list-short.mhd
refused "none.h5, which is not there" virtual-none.h5 virtual-nested.h5
refused "d of less.h5, in which voxels of it are, is of another size" virtual-less.h5
refused "bad.h5, which is no HDF5 file, or is damaged" virtual-bad.h5
refused "cut short: short.raw" external-short.h5
gzip -nc v.raw | head -c 60 >packed/v.raw.gz
refuses "its voxels are in v.raw.gz, which is cut short or damaged" "open packed/plain.mhd"
same "$(scene_of "$iftty" -c 'open virtual-gap.h5')" $gap
out_has "30 of the 120 values of the data set are in none of the files that it is made of"

begin "without Landlock the files of a journal are read by our own readers, or with a yes"
for name in twin.nii plain.mhd virtual.h5; do
    expect 0 "$iftty" -c "open $name; seed 1,1,1 1; run" --journal "$name.iftty"
    expect 0 "$iftty" verify "$name.iftty"
    expect 0 loose "$iftty" verify --unconfined "$name.iftty"
    expect 0 loose "$iftty" replay --unconfined "$name.iftty"
    for program in verify replay; do
        case $name in
        *.nii) expect 0 loose "$iftty" $program "$name.iftty" ;;
        *)
            expect 3 loose "$iftty" $program "$name.iftty"
            cat "$work/out" >>"$work/err"
            err_has "this kernel has no Landlock to keep it to this file; \`--unconfined\` has it"
            ;;
        esac
    done
done
expect_out "landlock  none" 0 loose "$iftty" info

finish
