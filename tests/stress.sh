#!/bin/sh
# SPDX-License-Identifier: MIT
# The programs that depend on time, again and again on a busy machine: stress.sh BUILD [NAME...]
#
#     ROUNDS=20   number of rounds
#     LOAD=12     processes that only use processor time
#     JOBS=3      programs in parallel with them
#     LIMIT=3600  seconds for a program, which has a seventh of a core or less
#
# Closes as tests/run.sh does, with the sum of all rounds.
cd "$(dirname "$0")/.." || exit 1
build=$1
shift
[ $# -gt 0 ] || set -- test_prompt_pty test_tui_repl test_term test_history_file \
    test_picture_writer test_picture_writer_racing test_process test_flow test_kill test_durable \
    test_image_helper test_leaving.sh test_prompt.sh test_pilot.sh test_verify.sh test_trust.sh \
    test_durable.sh test_large.sh test_crash.sh test_diff.sh

log=$(mktemp)
busy=''
trap 'kill $busy 2>/dev/null; rm -f "$log"' EXIT
trap 'exit 1' HUP INT TERM
for _ in $(seq "${LOAD:-12}"); do
    while :; do :; done &
    busy="$busy $!"
done
for round in $(seq "${ROUNDS:-20}"); do
    echo "# round $round"
    JOBS=${JOBS:-3} LIMIT=${LIMIT:-3600} tests/run.sh "$build" "$@" | tee -a "$log"
done
.ci/close "$log"
