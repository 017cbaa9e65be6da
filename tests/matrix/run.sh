#!/bin/sh
# SPDX-License-Identifier: MIT
# The same bits everywhere: build in many ways, and compare the results.
#
#     run.sh short BUILD    the works (works.h): one list of digests from every build and machine,
#                           except that slow ones are only built; and examples/geom.iftty under 1 to
#                           8 threads
#     run.sh all BUILD      the lists of all, and the whole program built in every way, which has to
#                           verify every example; then every example under 1 to 8 threads
#
# Prints TAP; status 1 if a comparison failed. Builds are in BUILD/matrix. The first line of the
# table makes the list that the others are compared with, threads excepted.
set -u
cd "$(dirname "$0")/../.." || exit 1

# name | compiler | options | what runs it | more libraries | slow: takes minutes to emulate
works='gcc-O2             |gcc  |-O2||-lnettle
gcc-O0                    |gcc  |-O0||-lnettle
gcc-O3-native             |gcc  |-O3 -march=native||-lnettle
clang-O0                  |clang|-O0||-lnettle
clang-O2                  |clang|-O2||-lnettle
clang-O3-native           |clang|-O3 -march=native||-lnettle
gcc-address-undefined|gcc|-O1 -fsanitize=address,undefined -fno-sanitize-recover=all||-lnettle
clang-address-undefined|clang|-O1 -fsanitize=address,undefined -fno-sanitize-recover=all||-lnettle
i386                      |i686-linux-gnu-gcc   |-O2 -msse2|qemu-i386-static|own
i386-O0                   |i686-linux-gnu-gcc   |-O0 -msse2|qemu-i386-static|own|slow
aarch64                   |aarch64-linux-gnu-gcc|-O2|qemu-aarch64-static|own
aarch64-O3                |aarch64-linux-gnu-gcc|-O3|qemu-aarch64-static|own|slow
s390x-big-endian          |s390x-linux-gnu-gcc  |-O2|qemu-s390x-static|own
s390x-big-endian-O0       |s390x-linux-gnu-gcc  |-O0|qemu-s390x-static|own|slow'
programs='gcc-O0           |gcc  |-O0|
gcc-O3-native              |gcc  |-O3 -march=native|
clang-O0                   |clang|-O0|
clang-O2                   |clang|-O2|
clang-O3-native            |clang|-O3 -march=native|
gcc-address-undefined      |gcc  |-O1|-fsanitize=address,undefined -fno-sanitize-recover=all
clang-address-undefined    |clang|-O1|-fsanitize=address,undefined -fno-sanitize-recover=all'

flags='-std=c17 -D_GNU_SOURCE -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Wconversion
    -Wvla -Wstrict-prototypes -Wmissing-prototypes -Werror -Isrc -I.'

field() { # N LINE, without the blanks around it
    printf '%s\n' "$2" | cut -d '|' -f "$1" | sed 's/^ *//;s/ *$//'
}

# ---- the works ----

# Builds one line of the table and makes its list: BUILD/matrix/NAME.list. SHA-256 is nettle's, or
# the test's own where nettle is not there; no work uses zlib, which is missing as well.
built_alone='built, and not run'
make_list() { # LINE, for how
    name=$(field 1 "$1") libraries=$(field 5 "$1") machine=$(field 4 "$1")
    own=''
    [ "$libraries" != own ] ||
        { own=tests/matrix/sha2/sha2.c libraries='-static -Itests/matrix/sha2'; }
    mkdir -p "$out/$name"
    # Lists of words on purpose.
    if ! $(field 2 "$1") $flags $(field 3 "$1") -o "$out/$name/works" \
        $(ls src/base/*.c | grep -v '/packed\.c$') src/engine/*.c render/*.c journal/*.c \
        tests/matrix/*.c $own $libraries -pthread >"$out/$name.log" 2>&1; then
        echo "does not build" >"$out/$name.list"
        return
    fi
    if [ "$how" = short ] && [ "$(field 6 "$1")" = slow ]; then
        echo "$built_alone" >"$out/$name.list"
        return
    fi
    $machine "$out/$name/works" "$out/$name" 1 >"$out/$name.list" 2>>"$out/$name.log" ||
        echo "ended with status $?" >>"$out/$name.list"
}

say() { # STORY, and why it failed, or nothing
    number=$((number + 1))
    [ -n "$2" ] || { echo "ok $number - $1"; return; }
    bad=$((bad + 1))
    printf '%s\n' "$2" | sed 's/^/# /'
    echo "not ok $number - $1"
}

compare_lists() { # STORY LIST
    lines=$(wc -l <"$expected")
    if [ "$lines" -lt 500 ]; then
        say "$1" "the list is only $lines lines long: $(tail -n 1 "$expected")"
    else
        say "$1" "$(diff "$expected" "$2" | head -n 6; sed 3q "${2%.list}.log" 2>/dev/null)"
    fi
}

run_works() {
    printf '%s\n' "$works" | tr '\n' '\0' | xargs -0 -n 1 -P "$(nproc)" "$0" one "$build" "$how"
    expected=$out/$(field 1 "$works" | head -n 1).list
    printf '%s\n' "$works" >"$out/table"
    while read -r line; do
        name=$(field 1 "$line")
        if [ "$(cat "$out/$name.list")" = "$built_alone" ]; then
            say "the works build by $name" "$(cat "$out/$name.log")"
        else
            compare_lists "the works by $name" "$out/$name.list"
        fi
    done <"$out/table"
    for threads in 2 3 4 5 6 7 8; do
        "$out/gcc-O2/works" "$out/gcc-O2" $threads >"$out/threads.list" 2>&1
        compare_lists "the works with $threads threads" "$out/threads.list"
    done
}

# ---- the program ----

verify() { # STORY PROGRAM JOURNAL...
    story=$1 program=$2
    shift 2
    said=$("$program" verify "$@" 2>&1)
    status=$?
    [ $status = 0 ] && said='' || said="status $status
$(printf '%s\n' "$said" | grep -v '^ok ' | head -n 12)"
    say "$story" "$said"
}

verify_threads() { # JOURNAL...
    for threads in 1 2 3 4 5 6 7 8; do
        IFTTY_THREADS=$threads verify "$* with $threads threads" "$build/iftty" "$@"
    done
}

run_programs() {
    printf '%s\n' "$programs" >"$out/table"
    while read -r line; do
        name=$(field 1 "$line")
        if make VARIANT="matrix/$name" CC="$(field 2 "$line")" OPTIMISE="$(field 3 "$line")" \
            SANITISE="$(field 4 "$line")" "build/matrix/$name/iftty" \
                </dev/null >"$out/$name.log" 2>&1; then
            verify "every example by $name" "build/matrix/$name/iftty" $journals </dev/null
        else
            say "every example by $name" "does not build: $(grep -m 3 error "$out/$name.log")"
        fi
    done <"$out/table"
}

how=$1 build=$2 number=0 bad=0 out=$2/matrix
mkdir -p "$out"
case $how in
one)
    how=$3
    make_list "$4"
    exit 0
    ;;
short)
    run_works
    verify_threads examples/geom.iftty
    ;;
all)
    journals=$(ls examples/*.iftty)
    examples/scenes.sh "$out/scenes" || exit 1
    IFTTY_SCENES=/usr/share/mricron/templates:$(cd "$out/scenes" && pwd)
    export IFTTY_SCENES
    run_works
    run_programs
    verify_threads $journals
    ;;
*)
    echo "run.sh: expected short or all, not $how" >&2
    exit 2
    ;;
esac
echo "1..$number"
echo "$((number - bad)) passed, $bad failed, 0 skipped"
[ $bad = 0 ]
