#!/bin/sh
# SPDX-License-Identifier: MIT
# TIFF: files of tifffile, PIL, libtiff's tools, OpenImageIO and of bytes by hand (volumes/tiff.py)
# have the voxels and the spacing of their twins; pages that are no slices, and channels and frames
# that are volumes; and files that are rejected, in one line.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"

begin "files of other programs are made"
made_by tiff.py
mv "$work/made" "$work/list"

# facts_of FILE [OPTION...]: the digest, size and spacing of a scene, in $work/facts
facts_of() {
    rm -f "$work/j.iftty"
    expect 0 "$iftty" -c "open $*" --journal "$work/j.iftty" || return 1
    awk -v RS='[ \n]' -F = '{ last[$1] = $2 }
        END { split("scene sha256 size spacing-nm orientation", keys, " ")
              for (k = 1; k <= 5; k++) print keys[k], last[keys[k]] }' \
        "$work/j.iftty" >"$work/facts"
}
# like_twins STORY: each of its files equals its twin
like_twins() {
    count=0
    while read -r of name twin options; do
        [ "$of" = "$1" ] || continue
        count=$((count + 1))
        if [ ! -f "$twin.facts" ]; then
            facts_of "$twin" ${options##volume=*} || continue
            cp "$work/facts" "$twin.facts"
        fi
        facts_of "$name" $options || { fail "$name $options"; continue; }
        cmp -s "$work/facts" "$twin.facts" ||
            fail "$name $options:" "$(diff "$twin.facts" "$work/facts")"
    done <"$work/list"
    [ "$count" -ge "$2" ] || fail "$count files of $1, expected $2"
}
says() { # FILE WORDS
    expect_out "$2" 0 "$iftty" info "$1"
}
silent() { # FILE: `open` says nothing of its pages or numbers
    expect 0 "$iftty" info "$1"
    ! grep -q '^note' "$work/out" || fail "$1: $(cat "$work/out")"
}
refused() { # WORDS FILE...: by open, in one line, whatever volume is asked for
    words=$1
    shift
    for name; do
        expect_err "$name: $words" 3 timeout 60 "$iftty" -c "open $name volume=0"
        same "$name: $(wc -l <"$work/err") line" "$name: 1 line"
    done
}

begin "11 types and 1 bit, both byte orders, BigTIFF, strips and tiles; NaN"
like_twins types 58
silent uint16.tif

begin "numbers of 2, 4, 6, 10, 12, 14 and 24 bits, with a sign and without"
like_twins bits 10

begin "LZW, deflate, packbits, zstd, lzma, fax and JPEG, predictors, FillOrder"
like_twins packed 37

begin "palettes are indices, alpha is left out, samples are volumes, an Orientation is obeyed"
like_twins samples 29
says palette.tif "its colours are of a palette: voxels are the indices, which it stores"
says alpha.tif "its pixels are grey with alpha: the grey is taken, alpha is left out"
says contig.tif "its volumes are 3 channels"
says white.tif "0 is white in it (MinIsWhite): its voxels are 1 where it is white"
says turned6.tif "(Orientation 6): put in the order of display"
says range.tif "the type of its numbers is unknown: read as unsigned integers"
silent bare.tif
refuses "a series of 3 volumes; choose one" "open contig.tif"

begin "thumbnails, masks and pyramids are left out and counted"
like_twins pages 5
for name in thumb-first.tif thumb-between.tif pyramid.tif; do
    case $name in *first*) pages="1 page" ;; *) pages="5 pages" ;; esac
    [ $name = pyramid.tif ] || says $name "$pages of reduced resolution left out"
done
says mask-first.tif "1 mask page left out"
says mask-between.tif "5 mask pages left out"
refused "a TIFF of thumbnails or masks: none of its pages is an image" only-thumbs.tif

begin "pages that differ are refused, and named"
refused "a TIFF of pages that differ: page 3 of 4 is 26x22 with 1 value of uint8" other-type.tif
refused "a TIFF of pages that differ: page 3 of 4 is 26x22 with 1 value of int16" other-sign.tif
refused "a TIFF of pages that differ: page 3 of 4 is 26x20 with 1 value of uint16" other-size.tif
refused "a TIFF of pages that differ: page 3 of 4 is 26x22 with 2 values" other-samples.tif
refused "a TIFF of pages that differ: page 3 of 4 is 26x22 with 1 value of uint8 (0 is white)" \
    other-colours.tif
refused "a TIFF of pages that differ: page 3 of 4 is 26x22 with 1 value of uint16 (0 is black, \
Orientation 4), and page 1" other-turned.tif
refused "a TIFF of pages that differ: page 3 of 4 is 26x22 with 1 value of complex16" \
    other-complex.tif
refused "packed in a way that libtiff does not read (Compression 34712)" other-packing.tif
expect_err "page 3 of 4 is 26x22 with 1 value of uint8" 3 "$iftty" info other-type.tif

begin "colours, complex numbers and rare kinds are refused by name"
refused "a TIFF with colours (3 values a pixel)" rgb.tif ycbcr.tif lab.tif
refused "a TIFF with colours (4 values a pixel)" cmyk.tif
refused "a TIFF of complex numbers; save their magnitude" complex.tif complex-int.tif
refused "a TIFF in which 0 is white (MinIsWhite), and readers disagree" negative.tif
refused "a TIFF with numbers of 24 bits (real), which are not read" float24.tif
refused "a TIFF with numbers of 40 bits, which are not read" of40.tif
refused "packed in a way that libtiff does not read (Compression 6)" old-jpeg.tif
refused "packed in a way that libtiff does not read (Compression 34712)" jpeg2000.tif
refused "a TIFF with 7 slices in a page (ImageDepth)" deep.tif
refused "a TIFF with values of different types in a pixel" mixed.tif
refused "a stack of FluoView, whose channels and frames are not read" fluoview.tif
refused "a stack of MetaMorph, whose channels and frames are not read" metamorph.tif
refused "a stack of ScanImage, whose channels and frames are not read" scanimage.tif
cp negative.tif copy.tif
for page in 0 1 2 3 4; do expect 0 tiffset -d $page -s 262 1 copy.tif; done
expect 0 "$iftty" -c "open copy.tif"

begin "false sizes, strips that are missing, torn or too short: one line, and no zeros"
refused "cut short or false: a page has 572 bytes of pixels, and its size promises 3600000000" \
    huge.tif
refused "60000x60000x1 voxels; at most" huge-packed.tif
refused "it has 4294967295 voxels along one side" high.tif
refused "damaged: a directory of its pages cannot be read" flat.tif no-bits.tif no-samples.tif \
    no-tile.tif
refused "cut short or damaged: the pixels of page 1 cannot be unpacked" no-strips.tif sparse.tif \
    short-strip.tif torn-strip.tif torn-fax.tif torn-jpeg.tif
refused "cut short: it has $(file_bytes no-offsets.tif) bytes, and its header promises" \
    no-offsets.tif
refused "cut short or false: a page has 542 bytes of pixels, and its size promises 572" \
    few-bytes.tif
is_sanitised || refused "it needs more memory than is allowed" wide-tile.tif
refused "cut short or false: a page has 100 bytes of pixels, and its size promises 4096" \
    tile-offset.tif tiles-before.tif twice.tif
answers "intensity 2" "open tiles-after.tif; why 63,63,0"

begin "ImageJ: channels and frames are volumes, also without directories; tifffile's shapes"
like_twins imagej 48
says ij.tif "its volumes are 2 channels of each of 3 frames, in this order"
says ij-flat.tif "its ImageJ description says pixels of 0.5x0.25 mm, and nothing how far apart \
slices are: where you know that, open it with spacing=0.5,0.25,Z"
says ij-pixel.tif "says voxels of 0.5x0.25x3, and their unit is pixel: where you know their size, \
open it with spacing=X,Y,Z"
says ij-without.tif "says voxels of 0.5x0.25x3, and no unit: where you know their size"
says ij-frames.tif "its ImageJ description says 1 slice for each: where they are slices of one"
cp ij-frames.tif copy.tif
expect 0 tiffset -u 270 copy.tif
answers "26x22x3 voxels" "open copy.tif"
silent words.tif
silent shaped-one.tif
expect 0 "$iftty" info rest.tif
out_has "bytes come after the pixels of its only page: \`open raw:FILE size=78,66,N type=uint16 \
offset=8 endian=little\` reads them as slices"
facts_of rest-all.twin.nii
mv "$work/facts" "$work/slices"
facts_of raw:rest.tif size=78,66,5 type=uint16 offset=8 endian=little
same_files "$work/facts" "$work/slices"
refused "cut short: it has $(file_bytes ij-cut.tif) bytes, and its header promises" ij-cut.tif
refused "its ImageJ description says images=6" ij-few.tif
refused "its ImageJ description says images=5" ij-wrong.tif
refused "its ImageJ description has images=-5; expected a number" ij-letters.tif
refused "its ImageJ description says 6 images in 1 page, which is packed or in pieces" \
    ij-packed.tif
cp ij-few.tif copy.tif
expect 0 tiffset -u 270 copy.tif
answers "26x22x5 voxels" "open copy.tif"

begin "OME: six orders, pages that are mapped, sizes and units, channels as samples"
like_twins ome 62
says part.ome.tif "6 pages without an OME description left out"
says flat.ome.tif "its OME description says pixels of 0.0005x0.0005 mm, and nothing how far apart"
says flat.ome.tif "open it with spacing=0.0005,0.0005,Z"
says strange.ome.tif "its OME description has PhysicalSizeX 0.5, and its unit is reference frame"
refused "a part of it is in another file, set_C1.ome.tif" set.ome.tif
refused "a part of it is in another file, a.companion.ome" binary.ome.tif
refused "its OME description says 30 planes, and it has 29 pages" few.ome.tif
refused "its OME description has no page for plane 30 of 30" hole.ome.tif
refused "its OME description has two pages for plane" twice.ome.tif
refused "its OME description has 30 planes from page 2, and it has 30 pages" beyond.ome.tif
refused "its OME description has DimensionOrder XYZZT" order.ome.tif
refused "it holds 2 images, says its OME description; \`bfconvert -series 0" images.ome.tif
refused "its OME description is damaged: it is no XML" torn.ome.tif bomb.ome.tif
refused "its OME description is of an image of 26x22 uint16, and its pages are 26x22 uint8" \
    other.ome.tif

begin "LSM: channels in planes, thumbnails after each page, metres"
like_twins lsm 6
says a.lsm "10 pages of reduced resolution left out"
refused "its CZ_LSMINFO says 9 slices, 3 channels and 2 frames, and it has 10 pages" wrong.lsm
refused "cut short: its CZ_LSMINFO has 40 bytes" short.lsm
refused "a TIFF with colours (3 values a pixel)" ycbcr.lsm
truncate -s 5G a.lsm
refused "an LSM of more than 4 GB" a.lsm
rm a.lsm

begin "folders: one page each; errors name the slice and its file"
like_twins folders 2
refused "slice 1 of 5, s0.tif: a TIFF of 3 pages; expected 1" pages
refused "slice 4 of 5, s3.tif: it is 26x22 with 1 value of uint8 (0 is black), and the first" \
    differs
refused "slice 1 of 5, s0.tif: a TIFF of 2 channels or frames; expected 1" channels
refused "slice 1 of 5, s0.tif: a TIFF in which 0 is white" white
refused "slice 1 of 10, c0z0.tif: a part of it is in another file, other.tif" set

begin "masks that zstd and a fax pack to a thousandth and less"
like_twins close 2

begin "70000 pages of 35 volumes"
like_twins many 2

begin "wrong numbers in directories: each file is opened or refused in one line"
"$PYTHON" -B "$top/tests/volumes/tiff.py" break . $((6 * ${IFTTY_TEST_SCALE:-1}))
count=0
for name in bad/*; do
    may_open "$name" "open $name volume=0"
    ! grep -q 'its reader failed\|died' "$work/err" || fail "$name: $(cat "$work/err")"
done
[ "$count" -ge 90 ] && [ $((4 * bad)) -gt "$count" ] || fail "$bad of $count were refused"

begin "a label map of 32 bits is read by labels; info tells scenes from pictures"
"$PYTHON" -c "import numpy, tifffile
labels = numpy.zeros((5, 22, 26), 'u4')
labels[1:4, 3:6, 4:8] = 1
labels[1:4, 9:12, 14:18] = 2
tifffile.imwrite('labels.tif', labels, photometric='minisblack')"
answers "2 labels" "open uint16.tif; labels labels.tif; run; info"
expect_out "26x22x5" 0 "$iftty" info bits.tif
out_has "uint8"
expect_out "R G B uint8" 0 "$iftty" info rgb.tif
expect_out '"volumes": 6' 0 "$iftty" info --json ij.tif

finish
