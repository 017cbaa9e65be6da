#!/bin/sh
# SPDX-License-Identifier: MIT
# Files of every format that were cut: at a quarter, a half, 99 of 100, and by one byte. Writers of
# ITK, teem and others made them (volumes/cut.py). Each is refused, and the words name the file, the
# actual and the expected number of bytes; no missing voxel is replaced.
. "$(dirname "$0")/lib.sh"
unset IFTTY_SCENES

begin "files of other programs are made, and copies of them cut"
mkdir "$work/v"
"$PYTHON" -B -W ignore "$top/tests/volumes/cut.py" "$work/v" >"$work/cuts" 2>"$work/made" ||
    fail "$(tail -n 3 "$work/made")"
[ "$failures" = 0 ] || finish
cd "$work/v" || exit 1

begin "whole, they open"
sed 's|.*/cut/[^/]*/||; s/ .*//' "$work/cuts" | sort -u >"$work/names"
while read -r name; do
    case $name in
    stack.lsm) continue ;; # no writer of LSM to be had: a TIFF of that name is none
    list.mhd | count.mhd) more=volume=1 ;;
    *) more= ;;
    esac
    rm -f j.iftty
    expect 0 "$iftty" -c "open $name $more" --journal j.iftty
    last_word sha256 j.iftty >"$work/digest-$name"
done <"$work/names"
for name in packed.mha packed.mhd itk.mhd text.mha itk.nrrd LPS-short.nrrd packed.nhdr unu.nrrd \
    itk.gipl itk.vtk unu.vtk itk.h5; do
    same "$name $(cat "$work/digest-$name")" "$name $(cat "$work/digest-itk.mha")"
done

# refused COMMAND FILE COUNTING LEFT MOST: in words that tell how much is missing
refused() {
    expect 3 "$iftty" -c "$1" || { fail "$1"; return; }
    same "$1: $(wc -l <"$work/err") line" "$1: 1 line"
    err_has "cut short"
    has=$(sed -n 's/.*: it has \([0-9]*\) .*/\1/p' "$work/err")
    promised=$(sed -n 's/.*[^-]promises \([0-9]*\); fetch.*/\1/p' "$work/err")
    case $3 in
    plain | parts) ;;
    *) # within the header it is a matter of bytes, later of what they stand for
        has=${has:-$(sed -n 's/.* voxels \([0-9]*\) bytes can be had.*/\1/p' "$work/err")}
        [ "$3" = text ] || [ -z "$promised" ] || same "$1: $promised" "$1: $unpacked"
        [ -n "$has" ] || fail "$1: $(cat "$work/err")"
        return
        ;;
    esac
    case $1 in # by the bytes of its header, or what NIfTI's own reader says
    *.nii | *.mgh | *.hdr) err_has "but $4 bytes hold at most $4" ;;
    *)
        same "$1: $has" "$1: $4"
        [ "$promised" -gt "$4" ] && [ "$promised" -le "$5" ] || fail "$1: $promised of $5"
        [ "$3" = parts ] || same "$1: $promised" "$1: $5"
        ;;
    esac
    case $1 in */"$2"*) ;; *.hdr) err_has "its .img: " ;; *) err_has "$2" ;; esac
}
begin "cut, each is refused with the bytes that it has, and that it needs"
while read -r name file counting left most; do
    unpacked=16016
    case $name in */RAS-byte.nrrd) unpacked=8008 ;; esac
    refused "open $name" "$file" "$counting" "$left" "$most"
done <"$work/cuts"
same "$(wc -l <"$work/cuts")" 120

begin "a mask, seeds, a start or weights that were cut are refused, too; and info refuses a header"
cp itk.mha whole.mha
while read -r name file counting left most; do
    case $name:$((left * 2 / most)) in
    */itk.mha:* | */itk.gipl:0 | */tiny.mnc:0) ;; # a quarter of the others
    *) continue ;;
    esac
    expect 3 "$iftty" run --keep-going - <<END
open whole.mha
mask $name
seed-file $name
labels $name
weight $name
END
    words="cut short: it has $left bytes, and its header promises"
    same "$name: $(grep -cF -e "$words" "$work/err") of $(wc -l <"$work/err")" \
        "$name: 4 of 4"
    expect_err "cut short: it has $left bytes" 3 "$iftty" info "$name"
done <"$work/cuts"

begin "voxels that never came: after LOCAL, in a file that is empty, none or in no list"
sed '/^ElementDataFile/q' itk.mha >empty.mha
expect 3 "$iftty" -c "open empty.mha"
err_has "empty.mha: cut short: it has $(file_bytes empty.mha) bytes, and its header promises"
printf '%s\n' 'ObjectType = Image' 'NDims = 3' 'DimSize = 4 4 4' 'ElementType = MET_UCHAR' \
    'DataFile = x' >within.mha
expect 3 "$iftty" -c "open within.mha"
err_has "within.mha: cut short: it has $(file_bytes within.mha) bytes, and ends within its header"
: >itk.raw
expect 3 "$iftty" -c "open itk.mhd"
err_has "itk.raw, which is cut short: it has 0 bytes, and its header promises 16016; fetch"
rm itk.raw list2.raw
for name in itk.mhd list.mhd; do expect 3 "$iftty" -c "open $name volume=1"; done
sed -i '$d' list.mhd
refuses "its header names 1 file, and says that it has 2 pieces" "open list.mhd volume=1"
refuses "its voxels are packed, and its header lacks CompressedDataSize" "open loose.mha"

begin "a bit of packed voxels that turned over"
for name in packed.mha RAS-byte.nrrd; do
    "$PYTHON" - "$name" turned-$name <<'END'
import sys
data = bytearray(open(sys.argv[1], "rb").read())
data[-40] ^= 4
open(sys.argv[2], "wb").write(data)
END
    refuses "cut short or damaged: of its packed voxels" "open turned-$name"
done

begin "HDF5: an unwritten data set is rejected, and a partly written one is reported"
"$PYTHON" - <<'END'
import h5py, numpy
with h5py.File("part.h5", "w") as file:
    file.create_dataset("a", (8, 9, 10), "i2", chunks=(2, 9, 10))[:2] = 3
with h5py.File("none.h5", "w") as file:
    file.create_dataset("a", (8, 9, 10), "i2")
with h5py.File("all.h5", "w") as file:
    file.create_dataset("a", data=numpy.ones((8, 9, 10), "i2"), chunks=(3, 4, 4))
END
refuses "nothing of the data set was written: it holds no voxel" "open none.h5"
expect 0 "$iftty" -c "open part.h5"
out_has "3 of the 4 pieces of the data set are not in the file: voxels there have the value"
expect 0 "$iftty" -c "open all.h5"
! grep -q pieces "$work/out" || fail "$(cat "$work/out")"

begin "bytes that are left over change nothing"
while read -r name; do
    case $name in
    *slices | stack.lsm | *.mhd | *.nhdr | *.hdr | *.nii | *.h5 | itk.mnc) continue ;;
    esac
    mkdir -p more
    { cat "$name"; printf ' 1234567'; } >"more/$name"
    rm -f j.iftty
    expect 0 "$iftty" -c "open more/$name" --journal j.iftty
    same "$name $(last_word sha256 j.iftty)" "$name $(cat "$work/digest-$name")"
done <"$work/names"

finish
