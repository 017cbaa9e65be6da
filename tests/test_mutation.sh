#!/bin/sh
# SPDX-License-Identifier: MIT
# Would the golden suite notice? One thing at a time is changed in a copy of a journal, or of the
# program; verifying it, or the examples, must then fail. Programs are built from a copy of the tree
# and of what was built there, so that one constant costs the files that see it. IFTTY_TEST_SCALE
# above 1, as in `make test-long`, has all of them instead of two.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

# ---- the data ----

fresh() {
    rm -rf "$work"/e.*
    cp "$work/whole.iftty" "$work/e.iftty"
    cp -r "$work/whole.golden" "$work/e.golden"
}
red() { # WHAT: verifying the copy of the journal fails, and says where
    expect 1 "$iftty" verify "$work/e.iftty" </dev/null || fail "after: $1"
    out_has "not ok 1 - "
}
changed() { # WHAT SED-SCRIPT
    fresh
    sed -i "$2" "$work/e.iftty"
    cmp -s "$work/e.iftty" "$work/whole.iftty" && fail "nothing was changed: $1"
    red "$1"
}

begin "the least change of one sample of one golden pixel is detected"
expect 0 "$iftty" -c 'open synth:geom:40x40x20; seed 20,8,10 1; seed 10,17,10 2; seed 24,14,9 3
    run; size 64 64; render a.png; golden body' --out "$work" --journal "$work/whole.iftty"
expect 0 "$iftty" verify "$work/whole.iftty"
for plane in colour depth label voxel; do
    fresh
    expect 0 "$build/tests/mutation/nudge" "$work/e.golden/body.exr" $plane
    red "a golden image's $plane"
    out_has "golden image body"
done

begin "a change of one datum of a journal is detected"
changed "a seed, by one voxel" 's/^seed 20,8,10 1/seed 21,8,10 1/'
changed "a seed's label" 's/^seed 10,17,10 2/seed 10,17,10 3/'
changed "a digest of the forest" '/^= 5 /s/forest=\(.*\)[0-8]\(.*\) labels=/forest=\19\2 labels=/'
changed "the scene's digest" 's/scene=\(.*\)\([0-9a-e]\) size/scene=\1f size/'
changed "a chain" 's/\(^= 3 .*\)[0-9a-e]$/\1f/'
changed "a picture's digest" '0,/picture=0*[0-9a-e]/s/picture=[0-9a-e]/picture=f/'
changed "a command left out" '/^seed 24,14,9 3/,+1d'

# ---- the program ----

# what | file | sed script
programs='one shade: the highlights |render/light.c     |s/SPECULAR = 70,/SPECULAR = 71,/
one weight: steps of seven   |src/engine/weight_morph.c |s/= \(weight\[i\]\);/= \1 == 7 ? 8 : \1;/'
more='one shade: even light        |render/light.c     |s:\(AMBIENT = LIGHT_UNIT / 5\),:\1 + 16,:
one rule of ties: hops       |src/engine/scene.h   |s/key + (UINT64_C(1) <</key + (UINT64_C(2) <</
one multiplier of all digests|src/base/hash.h    |s/0xc4ceb9fe1a85ec53/0xc4ceb9fe1a85ec55/
one rounding of sines        |render/view.c      |s/(y + (1 << 15)) >> 16/y >> 16/
one darkness of edges        |render/shade.c     |s:EDGE = UNIT \* 35 / 100:EDGE = UNIT * 36 / 100:'
[ "${IFTTY_TEST_SCALE:-1}" -gt 1 ] && programs="$programs
$more"

# Verifies the examples that need no file; the paths of the copy are not those of the program.
mutate() { # FILE SED-SCRIPT
    cp -p "$1" "$work/original"
    sed -i "$2" "$work/tree/$1"
    if cmp -s "$1" "$work/tree/$1"; then
        fail "nothing was changed in $1"
    elif ! make -C "$work/tree" VARIANT=release SANITISE= build/iftty \
        </dev/null >"$work/make" 2>&1; then
        fail "does not build: $(grep -m 2 error "$work/make")"
    else
        expect 1 "$work/tree/build/iftty" verify "$top/examples/geom.iftty" \
            "$top/examples/looks.iftty" </dev/null && out_has "not ok"
    fi
    cp "$work/original" "$work/tree/$1" # with the time of now, so that it is built again
}

begin "the unchanged copy verifies"
copy_tree || finish
make -C "$work/tree" VARIANT=release build/iftty </dev/null >"$work/make" 2>&1 ||
    fail "$(tail -n 3 "$work/make")"
expect 0 "$work/tree/build/iftty" verify examples/geom.iftty examples/looks.iftty </dev/null
printf '%s\n' "$programs" >"$work/programs"
while IFS='|' read -r what file script; do
    begin "$(printf '%s' "$what" | sed 's/ *$//')"
    mutate "$(printf '%s' "$file" | tr -d ' ')" "$script"
done <"$work/programs"

finish
