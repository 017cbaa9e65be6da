#!/bin/sh
# SPDX-License-Identifier: MIT
# Folders of BMP slices, as scanners of small animals write them: grey of 8 bits is read, from the
# bottom and from the top; other files are refused by name, with a converter.
. "$(dirname "$0")/lib.sh"

begin "slices of each kind, and their voxels"
"$PYTHON" -W ignore - <<'END' || fail "no slices"
import os, struct, nibabel, numpy
a = (numpy.arange(6 * 4 * 5).reshape(6, 4, 5) * 2).astype("u1") # z, y, x
nibabel.save(nibabel.Nifti1Image(a.transpose(2, 1, 0), numpy.eye(4)), "right.nii")
grey = b"".join(bytes([i, i, i, 0]) for i in range(256))
def fill(row): return row + bytes(-len(row) % 4)
def bmp(folder, z, rows, bits=8, palette=grey, height=4, packing=0, header=40, metre=0, cut=0):
    os.makedirs(folder, exist_ok=True)
    data, begin = b"".join(rows), 14 + header + len(palette)
    if header == 12:
        head = struct.pack("<IHHHH", header, 5, height, 1, bits)
    else:
        head = struct.pack("<IiiHHIIiiII", header, 5, height, 1, bits, packing, len(data), metre,
                           metre, len(palette) // 4 % 256, 0) + bytes(header - 40)
    bytes_ = b"BM" + struct.pack("<IHHI", begin + len(data), 0, 0, begin) + head + palette + data
    with open("%s/rec%d.bmp" % (folder, z), "wb") as out:
        out.write(bytes_[:len(bytes_) - cut])
def up(z): return [fill(a[z, y].tobytes()) for y in (3, 2, 1, 0)]
for z in range(6):
    bmp("up", z + 7, up(z)) # 7 to 12, which names alone would put elsewhere
    bmp("down", z, [fill(row.tobytes()) for row in a[z]], height=-4)
    bmp("wide", z, up(z), header=124, metre=20000)
    bmp("short", z, up(z), palette=grey[:4 * 250])
    bmp("mixed", z, up(z), height=4 if z < 3 else 3)
    bmp("cut", z, up(z), cut=1 if z == 4 else 0)
    bmp("inverse", z, up(z), palette=b"".join(bytes([255 - i] * 3 + [0]) for i in range(256)))
    bmp("coloured", z, up(z), palette=b"".join(bytes([i, 0, i, 0]) for i in range(256)))
    bmp("packed", z, [b"\5\7\0\0"] * 4 + [b"\0\1"], packing=1)
    bmp("os2", z, up(z), header=12, palette=b"".join(bytes([i] * 3) for i in range(256)))
    for bits, width in ((1, 1), (4, 3), (16, 10), (24, 15), (32, 20)):
        bmp("bits%d" % bits, z, [fill(bytes(width))] * 4, bits=bits,
            palette=b"" if bits > 8 else grey[:4 * 2 ** bits])
bmp("huge", 0, up(0), height=2 ** 31 - 1)
bmp("none", 0, [], height=0)
END
[ "$failures" = 0 ] || finish

begin "grey of 8 bits is read voxel for voxel, rows from the bottom and from the top"
for folder in up down wide short; do
    answers "5x4x6 voxels of unknown size, orientation unknown" "open $folder; info"
    expect 0 "$iftty" info --json --histogram $folder
    "$PYTHON" -c 'import json, sys; d = json.load(sys.stdin)
assert d["format"] == "BMP slices" and d["type"] == "uint8", d' <out || fail "$(cat out)"
    for voxel in 0,0,0 4,0,0 0,3,0 2,1,3 4,3,5; do
        value=$(echo $voxel | awk -F, '{ print (($3 * 4 + $2) * 5 + $1) * 2 }')
        answers "voxel $voxel: intensity $value" "open $folder; why $voxel"
    done
done
answers "0 of 120 voxels differ" "open right.nii; labels up; run; compare right.nii"

begin "a resolution is noted and not taken, and spacing= says it"
answers "its resolution says pixels of 0.05x0.05 mm" "open wide"
out_has "open it with spacing=0.05,0.05,Z"
answers "0.05x0.05x0.1 mm" "open wide spacing=0.05,0.05,0.1; info"
expect 0 "$iftty" -c "open up"
! grep -q resolution out || fail "$(cat out)"

begin "a file without 8-bit grey is named, with a converter"
while read -r folder words; do
    expect 3 "$iftty" -c "open $folder"
    err_has "slice 1 of 6, rec0.bmp, is a BMP $words; those of 8 bits of grey are read: \`mogrify"
done <<'END'
bits1 of 1 bits a pixel
bits4 of 4 bits a pixel
bits16 of 16 bits a pixel
bits24 of 24 bits a pixel
bits32 of 32 bits a pixel
coloured with a palette of colours
inverse with a palette of colours
packed that is packed (as RLE)
os2 of OS/2 (a header of 12 bytes)
END

begin "slices that are cut, of another size or empty are refused, and a name can be left out"
refuses "slice 5 of 6, rec4.bmp, is cut short" "open cut"
answers "5x4x5 voxels" "open cut skip=rec4.bmp"
expect 3 "$iftty" -c "open mixed"
err_has "slice 4 of 6 is 5x3 with 1 value of uint8 a pixel, and the first 5x4 with 1 of uint8; \
expected slices of one kind"
refuses "cut short" "open huge"
refuses "without pixels" "open none"

finish
