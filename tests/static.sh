#!/bin/sh
# SPDX-License-Identifier: MIT
# The single file of `make static`, without other files: static.sh BUILD STATIC, the folders of the
# checkout's program and of the static one, which may be for another machine. TAP.
IFTTY_BUILD=$1
static=$2
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1
case $static in /*) ;; *) static=$top/$static ;; esac

# A root with the file, /proc, and the examples with their scenes, and a place to write to.
root=$work/root
scenes=/usr/share/mricron/templates
mkdir -p "$root/proc" "$root/tmp" "$root$scenes"
cp -R examples "$root/examples"
cp "$scenes"/ch2.nii.gz "$scenes"/ch2bet.nii.gz "$root$scenes"
examples/scenes.sh "$root$scenes" || exit 1
cp "$static/iftty" "$root"
make_scene "$root/scene.nii" 24 20 16

# Another machine's program is run by qemu, which has to be there, too.
runner=
if ! "$static/iftty" --version >"$work/out" 2>&1; then
    machine=$(readelf -h "$static/iftty" | sed -n 's/^ *Machine: *//p' | tr A-Z a-z)
    cp "/usr/bin/qemu-$machine-static" "$root/qemu" || exit 1
    runner=/qemu
fi
private=-mpf
[ "$(id -u)" = 0 ] || private=-rmpf
# alone STATUS ARGUMENT...: the program in the root $place, where it sees its own processes alone
alone() {
    wanted=$1
    shift
    expect "$wanted" unshare $private --kill-child sh -c '
            cd "$1" && shift && mount -t proc proc proc &&
            { [ ! -f dev/null ] || mount --bind /dev/null dev/null; } &&
            exec env -i /usr/sbin/chroot . "$@"' sh "$place" $runner /iftty "$@" </dev/null
}
place=$root

begin "it is one file: no loader, no library, at any address, nothing to be written to and run"
readelf -lW "$static/iftty" >"$work/out"
! grep -qE 'INTERP|GNU_STACK.*E ' "$work/out" || fail "$(cat "$work/out")"
out_has GNU_RELRO
readelf -hdW "$static/iftty" >"$work/out"
! grep -q NEEDED "$work/out" || fail "$(cat "$work/out")"
out_has DYN
out_has BIND_NOW
[ "$(file_bytes "$static/iftty")" -lt 5000000 ] || fail "it has $(file_bytes "$static/iftty") bytes"

begin "the examples verify"
set -- geom.iftty sulci.iftty
[ -n "$runner" ] || set -- $(cd examples && ls *.iftty)
alone 0 verify --strict $(printf 'examples/%s ' "$@")
out_has "# $# verified, 0 failed"

begin "pictures, labels and surfaces are those of the checkout's program"
work_of_it='open scene.nii weight=morph; seed 6,10,8 1; seed 20,4,3 0; run;'\
' render tmp/picture.png; render tmp/picture.exr; slice axial tmp/slice.png;'\
' save labels tmp/labels.nii.gz; save labels tmp/labels.nrrd; save labels tmp/l.seg.nrrd;'\
' save surface tmp/surface.stl'
alone 0 -c "$work_of_it"
mkdir -p "$work/here/tmp"
cp "$root/scene.nii" "$work/here"
expect_in "$work/here" 0 "$iftty" -c "$work_of_it" </dev/null
same "$(ls "$root/tmp")" "$(ls "$work/here/tmp")"
same "$(ls "$root/tmp" | wc -l)" 7
for file in "$work"/here/tmp/*; do same_files "$file" "$root/tmp/${file##*/}"; done

begin "a journal of either verifies in the other"
script='open scene.nii weight=morph; seed 6,10,8 1; run; golden left; finish relax; golden top'
mkdir "$root/theirs" "$work/here/ours"
cp "$root/scene.nii" "$root/theirs"
cp "$root/scene.nii" "$work/here/ours"
alone 0 -c "$script" --journal theirs/a.iftty
expect_in "$work/here" 0 "$iftty" -c "$script" --journal ours/a.iftty </dev/null
same_files "$root/theirs/a.iftty" "$work/here/ours/a.iftty"
cp -R "$work/here/ours" "$root/ours"
alone 0 verify --strict ours/a.iftty
expect_in "$root" 0 "$iftty" verify --strict theirs/a.iftty </dev/null

begin "scenes as NIfTI, MGH and NRRD are read, compressed too"
/usr/bin/python3 -c '
import sys, nibabel
scene = nibabel.load(sys.argv[1])
nibabel.save(nibabel.MGHImage(scene.get_fdata().astype("uint8"), scene.affine), sys.argv[2])' \
    "$root/tmp/labels.nii.gz" "$root/tmp/labels.mgz" || fail "no .mgz"
for file in scene.nii tmp/labels.nii.gz tmp/labels.mgz tmp/labels.nrrd tmp/l.seg.nrrd; do
    alone 0 -c "open $file; seed 6,10,8 1; run"
done

begin "a command that requires a helper reports it"
alone 3 -c 'open scene.nii; seed 6,10,8 1; run; render tmp/picture.jpg'
err_has "; the package iftty-image has it"
alone 0 -c 'open scene.nii; seed 6,10,8 1; run; save labels tmp/labels.mha'
alone 3 -c 'open tmp/labels.mha'
err_has "; the package iftty-volume has it"

# The oldest Debian that still is served; as root alone, since it is made by debootstrap.
begin "in a bare Debian 11"
bullseye=$build/debian-11 # which stays for the next time
if [ "$(id -u)" != 0 ]; then
    skip "debootstrap asks for root"
elif needs debootstrap && [ ! -x "$bullseye/bin/ls" ]; then
    for mirror in $(apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' | sort -u); do
        rm -rf "$bullseye"
        debootstrap --variant=minbase --arch="$(dpkg --print-architecture)" bullseye "$bullseye" \
            "$mirror" >"$work/out" 2>&1 && break
    done
    [ -x "$bullseye/bin/ls" ] || fail "$(tail -n 3 "$work/out")"
fi
if [ -x "$bullseye/bin/ls" ] && [ "$failures" = 0 ]; then
    rm -rf "$bullseye/examples" "$bullseye$scenes" "$bullseye/tmp/picture.png"
    mkdir -p "$bullseye$scenes"
    cp -R "$root/examples" "$root/iftty" "$root/scene.nii" "$bullseye"
    [ -z "$runner" ] || cp "$root$runner" "$bullseye"
    cp "$root$scenes"/* "$bullseye$scenes"
    place=$bullseye
    alone 0 verify --strict examples/geom.iftty examples/sulci.iftty
    out_has "# 2 verified, 0 failed"
    alone 0 -c "${work_of_it%%; render tmp/picture.exr*}"
    same_files "$work/here/tmp/picture.png" "$bullseye/tmp/picture.png"
    place=$root
fi

begin "the bill of materials names every library that was linked, and its licence is next to it"
/usr/bin/python3 - "$static" >"$work/out" 2>&1 <<'END' || fail "$(cat "$work/out")"
import hashlib, json, os, re, sys
folder = sys.argv[1]
bill = json.load(open(folder + "/iftty.spdx.json"))
assert bill["spdxVersion"] == "SPDX-2.3" and bill["dataLicense"] == "CC0-1.0"
packages = {package["SPDXID"]: package for package in bill["packages"]}
assert len(packages) == len(bill["packages"])
assert all(re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", name) for name in packages)
program = packages.pop("SPDXRef-iftty")
sum = hashlib.sha256(open(folder + "/iftty", "rb").read()).hexdigest()
assert program["checksums"][0]["checksumValue"] == sum
linked = {relation["relatedSpdxElement"] for relation in bill["relationships"]
          if relation["relationshipType"] == "STATIC_LINK"}
assert linked == set(packages), linked ^ set(packages)
sources = [package["sourceInfo"] for package in packages.values()]
archives = set(re.findall(r"^([^ (]+\.a)\(", open(folder + "/iftty.map").read(), re.M))
of = {"libc": "glibc", "libm": "glibc", "libm-2.36": "glibc", "libz": "zlib",
      "libdeflate": "libdeflate", "libnettle": "nettle", "libOpenEXRCore": "openexr",
      "libgcc": "gcc-", "libgcc_eh": "gcc-"}
for archive in archives:
    name = os.path.basename(archive)[:-2]
    if name != "libiftty":
        assert any("source package " + of[name] in source for source in sources), archive
assert len(archives) > 7, archives
for source in sources:
    text = folder + "/" + source.split("; ")[1]
    words = open(text).read()
    for name in re.findall(r"/usr/share/common-licenses/([A-Za-z0-9.-]*[A-Za-z0-9])", words):
        assert os.path.getsize(folder + "/licences/" + name) > 1000, name
assert "Permission is hereby granted" in open(folder + "/licences/iftty.txt").read()
END

finish
