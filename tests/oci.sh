#!/bin/sh
# SPDX-License-Identifier: MIT
# The container image of `make oci`, run by crun: oci.sh BUILD IMAGE. Asks for root; TAP. It has no
# network there, no other file than a folder of the user's, and nothing but the program.
IFTTY_BUILD=$1
image=$2
cd "$(dirname "$0")/.." || exit 1
. tests/machine.sh
own_mounts tests/oci.sh "$@"
. tests/lib.sh
cd "$top" || exit 1
case $image in /*) ;; *) image=$top/$image ;; esac

# crun requires control groups of one kind, but the test needs none.
umount -R -l /sys/fs/cgroup 2>/dev/null
mount -t cgroup2 none /sys/fs/cgroup || exit 1
mkdir "$work/layout" "$work/data" "$work/here"
tar -xf "$image" -C "$work/layout" &&
    umoci unpack --image "$work/layout:iftty" "$work/bundle" >"$work/out" 2>&1 ||
    { cat "$work/out"; exit 1; }
cp "$work/bundle/config.json" "$work/config.json"
for folder in data here; do make_scene "$work/$folder/scene.nii" 24 20 16; done
chmod 777 "$work" "$work/data"

# contained USER STATUS ARGUMENT...: the program in a container, with $work/data as /work
contained() {
    user=$1 wanted=$2
    shift 2
    python3 - "$work" "$user" "$@" <<'END'
import json, sys
work, user, arguments = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
config = json.load(open(work + "/config.json"))
process = config["process"]
process.update(terminal=False, args=process["args"][:1] + arguments,
               user={"uid": user, "gid": user})
process["capabilities"] = {}
config["root"]["readonly"] = True
config["mounts"] = [one for one in config["mounts"] if one["type"] != "cgroup"]
config["mounts"].append({"destination": "/work", "type": "bind", "source": work + "/data",
                         "options": ["bind", "rw"]})
del config["linux"]["resources"]
json.dump(config, open(work + "/bundle/config.json", "w"))
END
    expect "$wanted" crun --root "$work/state" --cgroup-manager=disabled run \
        --bundle "$work/bundle" "iftty-$$" </dev/null
}

begin "it has its labels, and only the program and its licences"
contained 0 0 --version
same "$(sed 3q "$work/out")" "$("$iftty" --version | sed 3q)"
same "$(grep -c ': missing; ' "$work/out")" 3
same "$(cd "$work/bundle/rootfs" && find . -type f ! -path './usr/share/doc/iftty/*')" \
    ./usr/bin/iftty
same "$(cd "$work/bundle/rootfs" && find . -type f -perm /6000)" ""
[ -s "$work/bundle/rootfs/usr/share/doc/iftty/licences/iftty.txt" ] || fail "no licence"
[ -s "$work/bundle/rootfs/usr/share/doc/iftty/iftty.spdx.json" ] || fail "no bill of materials"
grep -q '"org.opencontainers.image.version": *"'"$("$iftty" --version | sed -n 's/^iftty //p')"'"' \
    "$work/config.json" || fail "no label of the version: $(cat "$work/config.json")"

begin "outputs of a user without a name equal those of the checkout's program"
script='open scene.nii weight=morph; seed 6,10,8 1; seed 20,4,3 0; run; finish relax; golden left;'\
' render picture.png; save labels labels.nii.gz; save surface surface.stl'
contained 4321 0 -c "$script" --journal a.iftty
expect_in "$work/here" 0 "$iftty" -c "$script" --journal a.iftty </dev/null
same "$(ls "$work/data")" "$(ls "$work/here")"
for file in a.iftty a.golden/left.exr a.golden/left.png picture.png labels.nii.gz surface.stl; do
    same_files "$work/here/$file" "$work/data/$file"
done
same "$(stat -c %u "$work/data/a.iftty")" 4321
contained 4321 0 verify --strict a.iftty
out_has "# 1 verified, 0 failed"
contained 4321 1 verify --strict --expect 00000000000000000000000000000000 a.iftty
contained 4321 3 verify missing.iftty

finish
