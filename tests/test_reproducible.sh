#!/bin/sh
# SPDX-License-Identifier: MIT
# A build depends on the source and the tools, not on its folder or its time: a sample of it.
# `make test-reproducible` compares whole programs and packages.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

begin "builds in two folders have the same bytes"
parts="src/main src/base/hash journal/journal src/helper/volume_answer"
for folder in one "another folder/with blanks"; do
    mkdir -p "$work/$folder"
    cp -R Makefile .ci src journal render tui "$work/$folder"
    CCACHE_DISABLE=yes MAKEFLAGS= expect_in "$work/$folder" 0 \
        make VARIANT=release SANITISE= $(printf 'build/%s.o ' $parts) </dev/null
done
for part in $parts; do
    same_files "$work/one/build/$part.o" "$work/another folder/with blanks/build/$part.o"
done

begin "the date of a build is that of the commit or the version, or is set explicitly"
mkdir -p "$work/plain/src/base"
cp -R .package "$work/plain"
cp src/base/version.h "$work/plain/src/base"
unset SOURCE_DATE_EPOCH
date=$(sed -n 's/^#define PROGRAM_DATE *"\(.*\)".*/\1/p' src/base/version.h)
same "$(date -u -d "@$("$work/plain/.package/date")" +%F)" "$date"
same "$(SOURCE_DATE_EPOCH=12345 .package/date)" 12345
if needs git && git -C "$work/plain" init -q; then
    GIT_COMMITTER_DATE='@86400 +0000' git -C "$work/plain" -c user.name=a \
        -c user.email=a@b.invalid commit -q --allow-empty -m a
    same "$("$work/plain/.package/date")" 86400
fi

finish
