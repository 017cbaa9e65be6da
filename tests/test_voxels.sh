#!/bin/sh
# SPDX-License-Identifier: MIT
# Each type, byte order and packing of a format, by files made by hand: the same voxels, or a
# refusal that names the kind of file. The table of src/image/README.md leads here.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"

begin "files of each format are made by hand"
made_by voxels.py

# The same voxels as right.nii, those of the second volume where there are two.
same_voxels() { # FILE...
    for name; do
        case $name in times* | um.* | mm.* | cm.*) echo "labels $name volume=1" ;;
        *) echo "labels $name" ;;
        esac
        echo 'compare right.nii'
        echo 'undo'
    done >"$work/commands"
    { echo 'open right.nii'; cat "$work/commands"; } | expect 0 "$iftty" run -
    same "$(grep -c '^    0 of 60 voxels differ' "$work/out") of $#" "$# of $#"
    ! grep -q 'its axes run' "$work/out" || fail "$(grep 'its axes run' "$work/out")"
}
typed() { # FILE TYPE
    expect 0 "$iftty" info "$1"
    grep -q "^type *$2\$" "$work/out" || fail "$1 is no $2: $(cat "$work/out")"
}

begin "MetaImage: ten types in both byte orders; a fourth axis and channels are volumes"
same_voxels *-little.mha *-big.mha times*.mha
typed UINT-big.mha uint32
typed LONG_LONG-little.mha int64
refused "a series of 2 volumes; choose one" "open times.mha"
refused "a series of 2 volumes; choose one" "open times-channels.mha"

begin "VTK: nine types, binary and as text; two numbers a voxel are volumes"
same_voxels *.vtk
refused "a series of 2 volumes; choose one" "open times.vtk"
typed unsigned_int.vtk uint32
typed double-text.vtk float64

begin "HDF5: ten types in both byte orders, three packings, and a series"
same_voxels *-little.h5 *-big.h5 gzip.h5 shuffle.h5 sum.h5 times.h5
typed u8-big.h5 uint64
refused "a series of 2 volumes; choose one" "open times.h5"

begin "HDF5 of ITK: its voxels at its place; big-endian ones are named"
same_voxels itk-little.hdf5 times.hdf5
refused "a series of 2 volumes; choose one" "open times.hdf5"
refused "its voxels are big-endian, which is not read of HDF5 of ITK" "open itk-big.hdf5"
expect_out "axes      RAS" 0 "$iftty" info itk-little.hdf5
out_has "1x1x1 mm"

begin "MRC: words and floats in both byte orders"
same_voxels *.mrc
typed u2-big.mrc uint16
expect_out "1x1x1 mm" 0 "$iftty" info f4-big.mrc

begin "GIPL: bytes, words and floats, and a series; wide whole numbers are named"
same_voxels i1.gipl u1.gipl i2.gipl u2.gipl f4.gipl f8.gipl times.gipl
refused "a series of 2 volumes; choose one" "open times.gipl"
refused "its voxels are of type 31 (uint32), which is not read" "open u4.gipl"
refused "its voxels are of type 32 (int32), which is not read" "open i4.gipl"

begin "raw: ten types in both byte orders, after other bytes, plain and as gzip"
for kind in int8 uint8 int16 uint16 int32 uint32 int64 uint64 float32 float64; do
    for order in little big; do
        for name in $kind-$order.raw $kind-$order.raw.gz; do
            echo "open raw:$name size=5,4,3 type=$kind endian=$order offset=4" >"$work/commands"
            printf '%s\n' 'why 0,0,0' 'why 4,3,2' 'why 1,2,1' >>"$work/commands"
            expect 0 "$iftty" run "$work/commands"
            sed -n 's/.*: intensity \([0-9]*\),.*/\1/p' "$work/out" | paste -sd ' ' - >"$work/is"
            same "$name $(cat "$work/is")" "$name 1 10 16"
            out_has "orientation unknown" "5x4x3 voxels of unknown size"
        done
    done
done
expect 0 "$iftty" -c "open raw:int8-big.raw size=5,4,3 type=int8 offset=4 spacing=0.5,1,2"
out_has "5x4x3 voxels of 0.5x1x2 mm"
expect_err "type: expected" 2 "$iftty" -c "open raw:int8-big.raw size=5,4,3 type=int24"

begin "MINC 1 and 2: axes in other units than mm are refused"
for name in um old-um; do
    refused "the unit of its axes is not mm, in which MINC is read" "open $name.mnc"
done
for name in long none old; do expect 0 "$iftty" -c "open $name.mnc"; done

begin "NRRD in both byte orders, plain, as gzip, as hex and as text"
same_voxels big-*.nrrd little-*.nrrd text.nrrd

begin "formats of scanners of which no file is available to test a reader are refused by name"
mkdir bruker
for name in zeros.4x bruker/2dseq a.spr a.sdt a.ima; do head -c 9000 /dev/zero >$name; done
{ printf IMGF; cat zeros.4x; } >genesis.mr
refused "an image of a GE scanner (GE 4, ADW), which is not read" "open zeros.4x"
refused "an image of a GE scanner (GE 5), which is not read" "open genesis.mr"
refused "an image of a Bruker scanner, which is not read" "open bruker/2dseq"
refused "a Stimulate volume, which is not read" "open a.spr"
refused "a Stimulate volume, which is not read" "open a.sdt"
refused "an image of Siemens Vision (.ima) is not read" "open a.ima"

begin "ANALYZE: a series, and units of length"
same_voxels times.img mm.img
refused "a series of 2 volumes; choose one" "open times.img"
for unit in um:0.001 mm:1 cm:10; do
    expect_out "${unit#*:}x${unit#*:}x${unit#*:} mm" 0 "$iftty" info "${unit%:*}.hdr"
done

begin "PNG: 8 and 16 bits as they are, fewer spread over 8; a resolution is noted"
same_voxels png-8 png-16 png-fine
for bits in 1:255 2:85 4:17; do # voxel 0,0,0 is 1
    answers "intensity ${bits#*:}," "open png-${bits%:*}; why 0,0,0"
done
answers "its resolution says pixels of 0.05x0.1 mm" "open png-fine"
out_has "voxel spacing unknown"

begin "PNG: palettes, colours and alpha are refused, as are slices that differ"
refused "slice 1 of 3 has 3 values a pixel (colours, perhaps of a palette); expected grey" \
    "open png-palette"
refused "slice 1 of 3 has 3 values a pixel (colours, perhaps of a palette)" "open png-colours"
refused "slice 1 of 3 has 2 values a pixel (grey with alpha); expected grey: \`mogrify" \
    "open png-alpha"
refused "slice 3 of 3 is 5x4 with 1 value of uint16 a pixel, and the first 5x4 with 1 of uint8" \
    "open png-deeper"
refused "slice 3 of 3 is 5x3" "open png-shorter"

begin "gzip around a format without this packing is named, with a program that unpacks it"
for name in *.mha.gz *.vtk.gz *.h5.gz *.mrc.gz *.gipl.gz *.nrrd.gz; do
    refused "packed by gzip; \`gunzip\` it first" "open $name"
done

finish
