#!/bin/sh
# SPDX-License-Identifier: MIT
# The whole way once: seeds to pictures on a real scene, recorded, replayed and verified.
# demo.sh BUILD; leaves its pictures and its journal in BUILD/demo.
set -eu
build=$1
examples=$(dirname "$0")
iftty=$build/iftty
out=$build/demo

name=brain
if ! "$iftty" -c 'open ch2.nii.gz' >/dev/null 2>&1; then
    echo "The T1 scene ch2.nii.gz (Debian's mricron-data) is not here;" \
        "the synthetic scene stands in."
    name=geom
fi
rm -rf "$out"
mkdir -p "$out"

echo "Segmenting by the procedure of examples/$name.iftty:"
"$iftty" run "$examples/$name.iftty" --journal "$out/$name.iftty" --out "$out" >"$out/run.txt"
awk '
    /^ok/ { seeds += $3 == "seed"; removed += $3 == "remove"; command = $3 }
    /voxels changed/ && command == "run" {
        printf "  iteration %d: %3d seeds and %d eliminators planted, %8d voxels changed, %s %s\n",
               ++n, seeds, removed, $1, $(NF - 1), $NF
        seeds = removed = 0
    }' "$out/run.txt"

echo "Replaying the journal, comparing every digest and golden image:"
status=0
"$iftty" verify "$out/$name.iftty" "$examples/$name.iftty" >"$out/verify.txt" || status=$?
sed 's/^/  /' "$out/verify.txt"
[ "$status" = 0 ] || exit "$status"

echo "Pictures, labels and journal:"
ls "$out"/*.png "$out"/*.exr "$out"/*.nii.gz "$out"/*.iftty | sed 's/^/  /'
"$iftty" show "$out/$name.png"
