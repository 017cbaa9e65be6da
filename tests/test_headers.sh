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
        refused "$words" "open $file"
        ! grep -q damaged "$work/err" || [ "$file" = damaged.mrc ] || fail "$(cat "$work/err")"
    done <"$1.refused"
    while IFS='	' read -r file words; do
        answers "$words" "open $file"
    done <"$1.says"
}

begin "NRRD: units of the space and of axes, series, one slice, numbers as text"
for file in %.nrrd %.nhdr; do
    twins $file um0 um1 um2 um3 um4 um5 mixed nowhere nowhere-mixed units-um units-nm units-mm \
        units-cm units-m units-in units-angstrom units-none units-mixed key flat text
done
twins %.nrrd volume=1 last list
as_said nrrd

begin "MetaImage: units, scale, byte order, one slice"
twins %.mha unit-um unit-mm unit-cm unit-none unit-nm after scaled slope0 binaryda-True \
    binaryda-False elementb-True elementb-False flat size
as_said meta

begin "MRC: types, signs of bytes, axes in any order, byte order, stacks"
twins %.mrc mode0 mode1 mode2 mode6 mode0big mode1big mode2big mode6big imod-unsigned imod-signed \
    by-statistics no-statistics low-statistics axes-none wrong-stamp no-stamp big-no-stamp tail
twins axes%.map 123 132 213 231 312 321
twins %.mrc volume=1 stack
as_said mrc

begin "HDF5: names of axes in any order, spacing by attributes, masks, unsupported data"
twins %.h5 zyx xyz yxz zxy one labels axes axes-many other-names um um-xyz resolution nm nm-name \
    bool
twins %.h5 volume=1 zyxc czyx cxyz xyzc xcyz flat
twins %.h5 volume=3 tzyxc tczyx txyzc big
as_said hdf5

begin "Imaris: the image without its padding, extent, times and channels as volumes, levels"
twins % one.ims
twins % volume=3 four.ims
opened_as one.ims small.twin.nii \
    'data="/DataSet/ResolutionLevel 1/TimePoint 0/Channel 0/Data"'
opened_as four.ims four.ims.twin.nii \
    'data="/DataSet/ResolutionLevel 0/TimePoint 1/Channel 1/Data"'
as_said imaris

begin "VTK: any order of fields; cells, bits, fields and other grids are refused by name"
twins %.vtk plain turned aspect two
as_said vtk

finish_opened
