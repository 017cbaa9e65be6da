#!/bin/sh
# SPDX-License-Identifier: MIT
# The helpers are confined in every use: each is replaced by a probe (probe/), the helper itself
# with the attempts of a hostile file in place of its decoders.
. "$(dirname "$0")/lib.sh"
unset IFTTY_SCENES
mkdir "$work/bin" "$work/there"
cp "$iftty" "$build/tests/probe/iftty-image" "$build/tests/probe/iftty-volume" "$work/bin"
probed=$work/bin/iftty
cd "$work/there" || exit 1
make_scene s.nii 24 20 16
printf 'ObjectType = Image\nNDims = 3\n' >v.mha
printf 'NRRD0004\n' >v.nrrd
printf '\211PNG\r\n' >p.png
: >n.txt
mkdir slices
cp p.png slices

is_confined() { # true if this kernel has all mechanisms of confinement
    needs_landlock || return
    "$iftty" info | grep -q '^seccomp  *the helpers make few' ||
        { skip "the kernel has no seccomp"; return 1; }
}
# refused WHAT STATUS COMMAND...: the probe was asked to do WHAT, and everything else was refused
refused() {
    what=$1
    shift
    "$@" >"$work/out" 2>"$work/err" </dev/null
    grep -q "$what: [0-9]* attempts, all refused" "$work/out" "$work/err" ||
        fail "$*:" "$(cat "$work/out" "$work/err")"
    same "$(ls | tr '\n' ' ')" "$listing"
}
listing=$(ls | tr '\n' ' ')

begin "pictures are read and written by a confined process"
if is_confined; then
    refused telling "$probed" info p.png
    refused reading "$probed" show --graphics kitty p.png
    refused writing "$probed" -c "open s.nii; render r.tif"
    refused writing "$probed" -c "open s.nii; slice axial 3 r.jpg"
    refused writing "$probed" -c "open s.nii; spin 4 r.gif"
fi

begin "volumes too: scenes, folders, masks, weights and maps of labels"
if is_confined; then
    for scene in v.mha v.nrrd slices; do
        refused opening "$probed" -c "open $scene"
        refused opening "$probed" info $scene
    done
    cp v.mha "$work/there/beside.mha"
    expect 3 "$probed" -c "open beside.mha" # a header that names s.nii beside it
    err_has "opening: let through: open-beside"
    same "$(wc -w <"$work/err" | tr -d ' ')" 6
    rm beside.mha
    refused opening "$probed" -c "open s.nii; mask v.mha"
    refused opening "$probed" -c "open s.nii; weight v.mha"
    refused opening "$probed" -c "open s.nii; labels v.mha"
fi

begin "also in replay and verify, inside their own confinement"
if is_confined; then
    printf 'open v.mha\n' >"$work/j"
    for program in replay verify; do
        refused opening "$probed" $program "$work/j" --scene v.mha
    done
    printf 'open s.nii\nrender r.tif\n' >"$work/j"
    refused writing "$probed" replay "$work/j" --scene s.nii --out "$work/out-folder"
fi

finish
