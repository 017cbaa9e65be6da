#!/bin/sh
# SPDX-License-Identifier: MIT
# What cppcheck, the analyser of gcc and clang-tidy (.clang-tidy) find in the source, and
# exceptions.txt does not explain.
# run.sh FOLDER, for what they say
cd "$(dirname "$0")/../.." || exit 1
said=$1
mkdir -p "$said"
for tool in cppcheck gcc clang-tidy-14; do
    "$tool" --version >/dev/null 2>&1 || { echo "there is no $tool"; exit 1; }
done
sources() {
    find src journal render tui -name '*.c' "$@" | sort
}

options="-std=c17 -D_GNU_SOURCE -Isrc -I. $(pkg-config --cflags OpenEXR 2>/dev/null)"
# What fault_set and its like return; where they are made, those would be made anew.
promised="-include tests/analyse/faults.h"

cppcheck --enable=warning,performance,portability --std=c17 --quiet --max-configs=2 -Isrc -I. \
    -D_GNU_SOURCE -D__x86_64__ --suppress=missingIncludeSystem --template='{file}:{line} {id}' \
    -j "$(nproc)" src journal render tui >"$said/cppcheck" 2>&1
# gcc's is for C alone.
sources -print | xargs -P "$(nproc)" -I{} gcc $options -O1 -fanalyzer -c -o /dev/null {} \
    >"$said/gcc" 2>&1
# One file at a time: of a second one, it no longer knows va_start.
{
    sources ! -path src/base/err.c | xargs -P "$(nproc)" -I{} clang-tidy-14 --quiet {} -- $options \
        $promised
    clang-tidy-14 --quiet src/base/err.c -- $options
} >"$said/clang-tidy" 2>&1

{
    sed -nE 's/^([^:]+):[0-9]+ ([A-Za-z]+)$/\1 \2/p' "$said/cppcheck"
    sed -nE 's/^(\.\/)?([^:]+):[0-9]+:[0-9]+: warning: .*\[-W([a-z-]+)\]$/\2 \3/p' "$said/gcc"
    sed -nE 's/^(\.\/)?([^:]+):[0-9]+:[0-9]+: (fatal )?error: .*/\2 error/p' "$said/gcc"
    # Of a check of two names, the first.
    sed -nE 's/^([^:]+):[0-9]+:[0-9]+: (warning|error): .*\[([A-Za-z0-9.-]+)[],].*/\1 \3/p' \
        "$said/clang-tidy" | sed "s#^$PWD/##"
} | sort -u >"$said/found"
sed -n '/^#/d; s/ *|.*//p' tests/analyse/exceptions.txt | sort -u >"$said/explained"
grep -vxFf "$said/explained" "$said/found" >"$said/unexplained"
sed 's/^/not explained: /' "$said/unexplained"
grep -vxFf "$said/found" "$said/explained" | sed 's/^/explained, and not found: /'
echo "$(wc -l <"$said/found" | tr -d ' ') found, $(wc -l <"$said/unexplained" | tr -d ' ')" \
    "not explained; the words are in $said/cppcheck, gcc, clang-tidy"
[ ! -s "$said/unexplained" ]
