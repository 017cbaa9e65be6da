#!/bin/sh
# SPDX-License-Identifier: MIT
# Three builds of one version: the checkout's program, the installation by `make install`, and the
# file of `make static`. Each writes journals, which the others verify and continue without a
# different byte. release.sh BUILD STATIC; TAP.
IFTTY_BUILD=$1
static=$2
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1
case $static in /*) ;; *) static=$top/$static ;; esac

make --no-print-directory install BUILD="$build" DESTDIR="$work/stage" PREFIX=/opt/iftty \
    >"$work/out" 2>&1 || { cat "$work/out"; exit 1; }
mkdir "$work/alone"
cp "$static/iftty" "$work/alone"
ways="checkout installed static"
program() { # WAY
    case $1 in
    checkout) echo "$iftty" ;;
    installed) echo "$work/stage/opt/iftty/bin/iftty" ;;
    static) echo "$work/alone/iftty" ;;
    esac
}
# by WAY FOLDER STATUS ARGUMENT...: the program of that way, in $work/FOLDER
by() {
    which=$(program "$1") where=$work/$2 wanted=$3
    shift 3
    expect_in "$where" "$wanted" "$which" "$@" </dev/null
}
# Folders of all builds have the same files with the same bytes.
same_folders() {
    (cd "$1" && find . -type f | LC_ALL=C sort) >"$work/these"
    (cd "$2" && find . -type f | LC_ALL=C sort) | cmp -s "$work/these" - ||
        fail "$1 and $2 have other files"
    [ -s "$work/these" ] || fail "there is nothing in $1"
    while read -r file; do same_files "$1/$file" "$2/$file"; done <"$work/these"
}

cat >"$work/small" <<'END'
open scene.nii weight=morph
orient RAS
label 1 ball #e07040
seed 6,10,8 1 radius=2
seed 20,4,3 0 to=20,16,3
seed 12,15,3 2
run
outline 4,8,9 1 to=9,8,9 to=9,13,9 to=4,13,9
remove 12,15,3
undo
auto off
seed 21,17,12 3
stats report=stats.json
finish relax
finished on
size 96 80
view left
golden left
golden plane of=mosaic
hints report=hints.json
render picture.png
save labels labels.nii.gz
save labels labels.nrrd
save surface surface.stl
END
cat >"$work/head" <<'END'
open ch2.nii.gz reduce=2
seed 30,54,45 1 radius=3
seed 50,54,45 1 to=50,54,60
seed 5,54,45 0 radius=2
box 0,0,0 89,107,1 0
finish relax
finished on
size 200 200
golden head
why 45,54,45
save labels head.nii.gz
END
cat >"$work/more" <<'END'
seed 2,2,2 2 radius=1
undo
redo
branch other
remove 2,2,2
render more.png
golden more
END
for way in $ways; do
    mkdir "$work/$way"
    make_scene "$work/$way/scene.nii" 24 20 16
done

begin "the outputs are equal, byte for byte: journals, golden images, maps, reports"
for way in $ways; do
    for name in small head; do by "$way" "$way" 0 run "$work/$name" --journal $name.iftty; done
    same_folders "$work/checkout" "$work/$way"
done
[ "$(grep -c '^= ' "$work/static/small.iftty")" -gt 15 ] || fail "few records"

begin "each verifies the outputs of the others, strictly"
for maker in $ways; do
    for way in $ways; do
        by "$way" "$maker" 0 verify --strict small.iftty head.iftty
        out_has "# 2 verified, 0 failed"
    done
done

begin "each continues the journals of the others, with equal results"
for maker in $ways; do
    for way in $ways; do
        cp -R "$work/$maker" "$work/$maker-$way"
        for name in small head; do
            by "$way" "$maker-$way" 0 run "$work/more" --journal $name.iftty --out $name-more
        done
        same_folders "$work/checkout-checkout" "$work/$maker-$way"
    done
done
[ "$(grep -c '^golden ' "$work/static-static/small.iftty")" = 3 ] || fail "nothing was added"
by static checkout-static 0 verify --strict small.iftty head.iftty

# The output, without times and the path of the program.
timeless() { # FILE WAY
    sed -E 's/"ms": [0-9]+/"ms": 0/g; s|'"$(program "$2")"'|iftty|g' "$1"
}
# alike STATUS ARGUMENT...: each ends with this status and the same output
alike() {
    for way in $ways; do
        by "$way" "$way-$way" "$@" || return
        for stream in out err; do
            timeless "$work/$stream" "$way" >"$work/$stream-$way"
            cmp -s "$work/$stream-checkout" "$work/$stream-$way" ||
                fail "$way: $*" "$(diff "$work/$stream-checkout" "$work/$stream-$way" | sed 5q)"
        done
    done
}
begin "JSON, other answers and exit statuses are the same"
for way in $ways; do
    cp "$work/$way/small.iftty" "$work/$way-$way/former.iftty"
    cp -R "$work/$way/small.golden" "$work/$way-$way/former.golden"
    sed '0,/radius=2/s//radius=3/' "$work/$way/small.iftty" >"$work/$way-$way/edited.iftty"
    cp -R "$work/$way/small.golden" "$work/$way-$way/edited.golden"
    echo "no scene" >"$work/$way-$way/head.nii"
done
head -n 6 "$work/small" | sed 's/radius=2/radius=3/' >"$work/short"
for way in $ways; do # without the lines of helpers, which the static file has not
    by "$way" "$way-$way" 0 --version
    same "$(sed 3q "$work/out")" "$("$iftty" --version | sed 3q)"
done
alike 0 help seed
alike 0 info --json scene.nii --histogram
alike 0 info --json small.iftty
alike 0 verify --json small.iftty head.iftty
alike 1 verify --json small.iftty edited.iftty
alike 3 diff --json small.iftty head.iftty
alike 0 diff --json small.iftty former.iftty
alike 0 compare --json labels.nii.gz labels.nii.gz
alike 0 run --json "$work/short" --journal new.iftty
alike 1 diff --json small.iftty new.iftty
alike 1 log --check edited.iftty
alike 2 verify --strikt small.iftty
alike 2 -c 'open scene.nii; seed 1,1'
alike 3 -c 'open scene.nii; seed 99,1,1 1'
alike 3 verify missing.iftty
alike 3 info head.nii
alike 3 run "$work/small" --journal head.iftty

begin "Ctrl-C ends each with status 130, and the others continue its journal"
slow='interpolate 2 2 2; finish relax sweeps=1000 reach=16; seed 90,108,90 3 radius=9;'\
' seed 4,4,4 0; run; stats finished=yes'
for way in $ways; do
    cd "$work/$way" || exit 1
    env --default-signal=INT "$(program "$way")" -c "open ch2.nii.gz reduce=2; $slow" \
        --journal stopped.iftty >"$work/out" 2>"$work/err" </dev/null &
    comes_true test -f stopped.iftty
    comes_true has_line stopped.iftty '^run'
    kill -INT $!
    wait $!
    same $? 130
    for other in $ways; do
        cp stopped.iftty "again-$other.iftty"
        by "$other" "$way" 0 -c 'undo; seed 1,1,1 0' --journal "again-$other.iftty"
        same_files again-checkout.iftty "again-$other.iftty"
    done
done
cd "$top" || exit 1

finish
