#!/bin/sh
# SPDX-License-Identifier: MIT
# Run test programs and scripts in parallel and add up their TAP: run.sh BUILD [NAME...]
#
#     JOBS=N      programs at once; by default the number of cores plus two, since some wait for a
#                 terminal or a helper
#     LIMIT=S     a program that runs longer than S seconds fails; 1200 by default
#     TMPDIR=...  the folder for their files. By default they are in memory, if there is such a
#                 folder with enough space; tests of data on a disk use /tmp.
#
# Each program has a new folder as its TMPDIR, which is removed afterwards. The end lists the
# programs with the most processor time and the line "N passed, N failed, N skipped"; status 1 if a
# story failed or none was run. A story that ends in "# SKIP why" is named and counted as skipped,
# never as passed.
cd "$(dirname "$0")/.." || exit 1

# Start the longest first, so that a short one ends last.
longest='test_prompt_pty test_tiff.sh test_examples.sh test_volumes.sh test_bench.sh test_seg.sh
test_relax test_apply.sh test_marker_sessions test_pictures.sh test_tui_repl test_command
test_pilot.sh test_confine test_dicom.sh test_large.sh test_tutorial.sh test_headers.sh
test_program.sh test_leaving.sh test_trust.sh test_kill_files test_semantics.sh test_fuzz.sh
test_elsewhere.sh test_team_racing test_painter test_nrrd.sh test_golden_files.sh test_tilt.sh'
# Tests of several threads; others have one thread, since programs run in parallel.
threaded=' test_command test_examples.sh test_large.sh test_picture_writer test_tally '
# Tests of the data on the disk after a crash.
on_disk=' test_kill test_durable test_durable.sh test_crash.sh '

# ---- one program, as xargs starts it ----

say() { # print a file without lines of other programs in between
    flock "$results/lock" cat "$1"
}
run_one() { # NAME
    name=$1 result=$results/$1
    case $name in
    *.sh) command=tests/$name ;;
    *) command=$IFTTY_BUILD/tests/$name ;;
    esac
    case $on_disk in
    *" $name "*) TMPDIR=$disk/$name ;;
    *) TMPDIR=$memory/$name ;;
    esac
    case $threaded in
    *" $name "*) ;;
    *) export IFTTY_THREADS="${IFTTY_THREADS:-1}" ;;
    esac
    export TMPDIR
    mkdir "$TMPDIR" || exit 1
    begin=$(date +%s%N)
    timeout --foreground -k 10 "${LIMIT:-1200}" "$command" </dev/null >"$result.out" 2>&1
    status=$?
    seconds=$((($(date +%s%N) - begin) / 100000000))
    # All that it has had of the processor: the last line of times is "0m1.5s 0m0.2s".
    times >"$result.times"
    busy=$(awk 'END { gsub(/[ms]/, " "); print $1 * 60 + $2 + $3 * 60 + $4 }' "$result.times")
    skipped=$(grep -c '^ok .* # SKIP' "$result.out")
    passed=$(($(grep -c '^ok ' "$result.out") - skipped))
    failed=$(grep -c '^not ok ' "$result.out")
    planned=$(sed -n 's/^1\.\.\([0-9]*\)$/\1/p' "$result.out")
    # A program that dies before its plan, or with another, has failed, whatever it printed.
    if [ "$planned" != $((passed + failed + skipped)) ] ||
        { [ $status -ne 0 ] && [ "$failed" = 0 ]; }; then
        failed=$((failed + 1))
        ran=$((passed + skipped))
        echo "# $name ended with status $status after $ran of ${planned:-?} stories" >>"$result.out"
    fi
    echo "$passed $failed $skipped $busy $name" >"$result.counts"
    {
        printf '%-28s %4d passed %4d failed %4d skipped  %4d.%d s  %6.1f s busy\n' "$name" \
            "$passed" "$failed" "$skipped" $((seconds / 10)) $((seconds % 10)) "$busy"
        [ "$failed" = 0 ] || grep -v '^ok ' "$result.out"
        [ "$failed" != 0 ] || grep '^# count: ' "$result.out"
        sed -n "s/^ok [0-9]* - \(.*\) # SKIP \(.*\)/skipped: $name: \1: \2/p" "$result.out"
        left=$(ls -A "$TMPDIR")
        [ -z "$left" ] || echo "# $name leaves in its folder: $left"
    } >"$result.said"
    say "$result.said"
    chmod -R u+rwx "$TMPDIR"
    rm -rf "$TMPDIR"
}

if [ "$1" = one ]; then
    run_one "$2"
    exit 0
fi

# ---- all of them ----

# /dev/shm may be read-only, small, or, in a container, without the right to run what lies there.
is_roomy() { # FOLDER
    [ -w "$1" ] && [ "$(df -Pk "$1" | awk 'NR == 2 { print $4 }')" -gt 2000000 ] || return 1
    tried=$(mktemp "$1/iftty-XXXXXX") || return 1
    printf '#!/bin/sh\n' >"$tried"
    chmod +x "$tried"
    "$tried" 2>/dev/null
    set -- $?
    rm -f "$tried"
    return "$1"
}

ordered() { # NAMES, the longest first
    for name in $longest; do
        printf '%s\n' "$@" | grep -qx "$name" && echo "$name"
    done
    printf '%s\n' "$@" | grep -vxF "$longest"
}

IFTTY_BUILD=$1
shift
if [ $# = 0 ]; then
    set -- $(cd tests && ls test_*.sh && ls test_*.c | sed 's/\.c$//') \
        $(ls "$IFTTY_BUILD/tests" | grep '_racing$')
fi
longest=$(printf '%s\n' $longest)
here=${TMPDIR:-/tmp}
if [ -z "$TMPDIR" ] && is_roomy /dev/shm; then
    memory=/dev/shm
else
    memory=$here
fi
memory=$(mktemp -d "$memory/iftty-XXXXXX") && disk=$(mktemp -d "$here/iftty-XXXXXX") || exit 1
results=$disk/results
mkdir "$results"
export IFTTY_BUILD memory disk results
trap 'rm -rf "$memory" "$disk"' EXIT
trap 'kill $! 2>/dev/null; exit 1' HUP INT TERM

ordered "$@" | xargs -n 1 -P "${JOBS:-$(($(nproc) + 2))}" tests/run.sh one &
wait $!
if [ $# -gt 10 ]; then
    echo "# busy longest, in seconds of the processor:"
    cat "$results"/*.counts | sort -k 4 -nr | awk '
        { sum += $4 } NR <= 10 { printf "#   %6.1f  %s\n", $4, $5 }
        END { printf "#   %6.1f  all %d programs\n", sum, NR }'
fi
cat "$results"/*.counts 2>/dev/null | awk -v programs=$# '
    { passed += $1; failed += $2; skipped += $3 }
    END { left = programs - NR
          if (left > 0) { print "# " left " programs were not run"; failed += left }
          printf "%d passed, %d failed, %d skipped\n", passed, failed, skipped
          exit failed > 0 || passed == 0 }'
