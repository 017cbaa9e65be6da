#!/bin/sh
# SPDX-License-Identifier: MIT
# Units, axes, types and scales in headers (volumes/headers.py): the same voxels in the
# same place as a NIfTI of nibabel's; where it is not known, no length and no side; and a valid file
# that is not read is refused by the name of its kind.
. "$(dirname "$0")/lib.sh"
. "$top/tests/volumes/opened.sh"

begin "files are made"
made_by headers.py

# as_said STORY: each file has its expected refusal, or its expected note
as_said() {
    while IFS='	' read -r file words; do
        expect 3 "$iftty" -c "open $file"
        err_has "$words"
        same "$file: $(wc -l <"$work/err" | tr -d ' ') line" "$file: 1 line"
        ! grep -q damaged "$work/err" || [ "$file" = damaged.mrc ] || fail "$(cat "$work/err")"
    done <"$1.refused"
    while IFS='	' read -r file words; do
        expect 0 "$iftty" -c "open $file"
        out_has "$words"
    done <"$1.says"
}

begin "NRRD: units of the space and of axes, series, one slice, numbers as text"
for each in um0 um1 um2 um3 um4 um5 mixed nowhere nowhere-mixed units-um units-nm units-mm \
    units-cm units-m units-in units-angstrom units-none units-mixed key flat text; do
    opened_as $each.nrrd $each.nrrd.twin.nii
    opened_as $each.nhdr $each.nhdr.twin.nii
done
for each in last list; do
    opened_as $each.nrrd $each.nrrd.twin.nii volume=1
done
as_said nrrd

begin "MetaImage: units, scale, byte order, one slice"
for each in unit-um unit-mm unit-cm unit-none unit-nm after scaled slope0 binaryda-True \
    binaryda-False elementb-True elementb-False flat size; do
    opened_as $each.mha $each.mha.twin.nii
done
as_said meta

begin "MRC: types, signs of bytes, axes in any order, byte order, stacks"
for each in mode0 mode1 mode2 mode6 mode0big mode1big mode2big mode6big imod-unsigned imod-signed \
    by-statistics no-statistics low-statistics axes-none wrong-stamp no-stamp big-no-stamp tail; do
    opened_as $each.mrc $each.mrc.twin.nii
done
for each in 123 132 213 231 312 321; do
    opened_as axes$each.map axes$each.map.twin.nii
done
opened_as stack.mrc stack.mrc.twin.nii volume=1
as_said mrc

begin "HDF5: names of axes in any order, spacing by attributes, masks, what is not read"
for each in zyx xyz yxz zxy one labels axes axes-many other-names um um-xyz resolution nm nm-name \
    bool; do
    opened_as $each.h5 $each.h5.twin.nii
done
for each in zyxc czyx cxyz xyzc xcyz flat; do
    opened_as $each.h5 $each.h5.twin.nii volume=1
done
for each in tzyxc tczyx txyzc big; do
    opened_as $each.h5 $each.h5.twin.nii volume=3
done
as_said hdf5

begin "Imaris: the image without its padding, extent, times and channels as volumes, levels"
opened_as one.ims one.ims.twin.nii
opened_as four.ims four.ims.twin.nii volume=3
opened_as one.ims small.twin.nii \
    'data="/DataSet/ResolutionLevel 1/TimePoint 0/Channel 0/Data"'
opened_as four.ims four.ims.twin.nii \
    'data="/DataSet/ResolutionLevel 0/TimePoint 1/Channel 1/Data"'
as_said imaris

begin "VTK: any order of fields; cells, bits, fields and other grids are refused by name"
for each in plain turned aspect two; do
    opened_as $each.vtk $each.vtk.twin.nii
done
as_said vtk

finish
