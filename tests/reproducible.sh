#!/bin/sh
# SPDX-License-Identifier: MIT
# Build HEAD in two folders, at two times, and compare every byte of the programs, the static file
# and the packages. Prints TAP; runs for about ten minutes.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

unset SOURCE_DATE_EPOCH
CCACHE_DISABLE=yes
export CCACHE_DISABLE
for folder in one another/folder; do
    git clone -q . "$work/$folder" || exit 1
done
# build TARGET...: in both; then the files of PATTERN are the same, and there are some
build_both() {
    for folder in one another/folder; do
        expect_in "$work/$folder" 0 make "$@" </dev/null || return
    done
}
compare() { # FOLDER PATTERN
    (cd "$work/one" && find "$1" -maxdepth 1 -name "$2" -type f) >"$work/files"
    [ -s "$work/files" ] || fail "there is no $1/$2"
    while read -r file; do
        same_files "$work/one/$file" "$work/another/folder/$file"
    done <"$work/files"
}

begin "programs"
build_both all build/iftty-manual && compare build 'iftty*'

begin "the static file, its bill of materials, and its licences"
build_both static && compare build/static 'iftty' && compare build/static '*.json' &&
    compare build/static/licences '*'

begin "packages"
build_both deb && compare build/deb '*.deb'

finish
