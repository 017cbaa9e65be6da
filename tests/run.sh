#!/bin/sh
# Runs every test program and script and adds up their TAP: run.sh BUILD [NAME...]
# Closes with "N passed, N failed"; status 1 when anything failed.
build=$1
shift
export IFTTY_BUILD="$build"
cd "$(dirname "$0")/.." || exit 1
passed=0 failed=0
if [ $# -gt 0 ]; then
    names=$*
else
    names="$(ls "$build"/tests | grep '^test_[a-z_0-9]*$') $(ls tests | grep '^test_.*\.sh$')"
fi
for name in $names; do
    case $name in
    *.sh) command=tests/$name ;;
    *) command=$build/tests/$name ;;
    esac
    begin=$(date +%s.%N)
    output=$("$command" </dev/null 2>&1)
    status=$?
    end=$(date +%s.%N)
    good=$(printf '%s\n' "$output" | grep -c '^ok ')
    bad=$(printf '%s\n' "$output" | grep -c '^not ok ')
    # A program that dies before its plan has failed, whatever it printed.
    if ! printf '%s\n' "$output" | grep -q '^1\.\.' || { [ $status -ne 0 ] && [ "$bad" = 0 ]; }; then
        bad=$((bad + 1))
        output="$output
# $name ended with status $status before it was done"
    fi
    printf '%-28s %4d passed %4d failed  %6.1f s\n' "$name" "$good" "$bad" \
        "$(echo "$end $begin" | awk '{print $1 - $2}')"
    [ "$bad" = 0 ] || printf '%s\n' "$output" | grep -v '^ok '
    passed=$((passed + good))
    failed=$((failed + bad))
done
echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
