#!/bin/sh
# SPDX-License-Identifier: MIT
# The commands of README, `make demo`, `make test` and `make deb`, in a new clone on a bare Debian
# with git, make and gcc: first as root, for whom missing packages are installed, then as an
# ordinary user without sudo, for whom they are already installed.
#
#     bare.sh [FOLDER]   make the machine again in FOLDER, or in build/bare
#     KEEP=yes           keep it afterwards
#     SUITE=trixie       a Debian 13; without it, 12
#
# It clones HEAD: commit first. Packages are downloaded from the sources of this machine. Requires
# root. Ends with "N passed, N failed, N skipped" of both runs; status 1 where something is missing,
# fails, or is skipped for a reason that is not in may_skip.txt.
set -u
cd "$(dirname "$0")/.." || exit 1
. tests/machine.sh
own_mounts tests/bare.sh "$@"
bare=${1:-build/bare}
mkdir -p "$bare" && bare=$(cd "$bare" && pwd) || exit 1
log=$bare/log said=$bare/said
trap clear_up EXIT
trap 'exit 1' HUP INT TERM

# ---- the newcomer ----

failures=0
try() { # USER COMMAND, "what is printed when all is well"
    echo "# $1: $2"
    inside "$1" "cd iftty && $2" 2>&1 | tee -a "$log" "$said"
    grep -qE "$3" "$said" || { failures=$((failures + 1)); echo "# $1: $2: that failed"; }
    : >"$said"
}
visit() { # USER
    inside root "chown -R $1: /src" && inside "$1" "git clone -q /src iftty" || exit 1
    try "$1" "make demo" '^  # [0-9]+ verified, 0 failed'
    try "$1" "make test" '^[0-9]+ passed, 0 failed, [0-9]+ skipped$'
    try "$1" "make deb" '^\./iftty_[^ ]+\.deb$'
}

: >"$log"
: >"$said"
make_machine "$bare" git,make,gcc
git clone -q --bare . "$root/src" && inside root "useradd -m somebody" || exit 1
visit root
visit somebody
grep 'stands in' "$log" && failures=$((failures + 1)) # the scene of the demo could not be installed
.ci/close "$log" || failures=$((failures + 1))
[ "$failures" = 0 ]
