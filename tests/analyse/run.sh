#!/bin/sh
# What cppcheck and the analyser of gcc find in the source, and exceptions.txt does not explain.
# run.sh FOLDER, for what they say
cd "$(dirname "$0")/../.." || exit 1
said=$1
mkdir -p "$said"
sources() {
    find src journal render tui -name '*.c' "$@" | sort
}

cppcheck --enable=warning,performance,portability --std=c17 --quiet --max-configs=2 -Isrc -I. \
    -D_GNU_SOURCE -D__x86_64__ --suppress=missingIncludeSystem --template='{file}:{line} {id}' \
    -j "$(nproc)" src journal render tui >"$said/cppcheck" 2>&1
# gcc's is for C alone.
# shellcheck disable=SC2046
sources -print | xargs -P "$(nproc)" -I{} gcc -std=c17 -D_GNU_SOURCE -O1 -Isrc -I. \
    $(pkg-config --cflags OpenEXR 2>/dev/null) -fanalyzer -c -o /dev/null {} >"$said/gcc" 2>&1

{
    sed -nE 's/^([^:]+):[0-9]+ ([A-Za-z]+)$/\1 \2/p' "$said/cppcheck"
    sed -nE 's/^(\.\/)?([^:]+):[0-9]+:[0-9]+: warning: .*\[-W([a-z-]+)\]$/\2 \3/p' "$said/gcc"
    sed -nE 's/^(\.\/)?([^:]+):[0-9]+:[0-9]+: (fatal )?error: .*/\2 error/p' "$said/gcc"
} | sort -u >"$said/found"
sed -n '/^#/d; s/ *|.*//p' tests/analyse/exceptions.txt | sort -u >"$said/explained"
grep -vxFf "$said/explained" "$said/found" >"$said/unexplained"
sed 's/^/not explained: /' "$said/unexplained"
grep -vxFf "$said/found" "$said/explained" | sed 's/^/explained, and not found: /'
echo "$(wc -l <"$said/found" | tr -d ' ') found, $(wc -l <"$said/unexplained" | tr -d ' ')" \
    "not explained; $said/cppcheck and $said/gcc have the words"
[ ! -s "$said/unexplained" ]
