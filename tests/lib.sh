# SPDX-License-Identifier: MIT
# Helpers for the tests in shell: TAP, a temporary folder, which becomes the working folder, and the
# program: . "$(dirname "$0")/lib.sh"
#
#     begin "name of the story"   start a story and end the former one, which prints
#                                 "ok N - name", "not ok N - name" or, if a part of it could not
#                                 run, "ok N - name # SKIP why"
#     fail "what is wrong"        record a failure of the story
#     needs TOOL && ...           a part of a story that requires a tool
#     finish                      end the last story, print the plan and exit
#
# With IFTTY_TEST_BUSY=1 each story prints the processor time of all stories so far.
#
# No function here or in a test has the name of a tool that a test uses: the function would be run
# instead of the tool (tests/test_layout.sh sees to it).

LC_ALL=C
IFTTY_HISTORY= # neither write nor read the user's history
export LC_ALL IFTTY_HISTORY IFTTY_CONFIG
unset CI # under which verification is strict; stories set it if they need it
cd "$(dirname "$0")/.." || exit 1
top=$(pwd)
IFTTY_CONFIG=$top/tests/bare.config # with IFTTY_CONFIG= a session begins as for a new user
build=${IFTTY_BUILD:-build}
case $build in /*) ;; *) build=$top/$build ;; esac
iftty=$build/iftty
PYTHON=/usr/bin/python3 # which has Debian's modules
work=$(mktemp -d "${TMPDIR:-/tmp}/iftty-test-XXXXXX") || exit 1
trap 'chmod -R u+rwx "$work" 2>/dev/null; rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
cd "$work" || exit 1

story='' stories=0 bad_stories=0 failures=0 lacks=''

close_story() { # of begin and finish
    [ -n "$story" ] || return
    stories=$((stories + 1))
    if [ "$failures" = 0 ]; then
        printf 'ok %d - %s%s\n' "$stories" "$story" "${lacks:+ # SKIP $lacks}"
    else
        bad_stories=$((bad_stories + 1))
        printf 'not ok %d - %s\n' "$stories" "$story"
    fi
    [ -z "$IFTTY_TEST_BUSY" ] || { echo '# busy until here, this shell and what it ran:'; times; }
}
begin() {
    close_story
    story=$1 failures=0 lacks=''
}
fail() {
    failures=$((failures + 1))
    printf '%s\n' "$*" | sed 's/^/# /'
}
skip() { # WHY: the story, or a part of it, cannot be done here
    lacks=${lacks:-$1}
}
# TOOL...: programs in PATH; without them the story is skipped. A new shell has no such functions.
needs() {
    for tool; do
        sh -c 'command -v "$0"' "$tool" >/dev/null 2>&1 ||
            { skip "$tool is not installed"; return 1; }
    done
}
needs_landlock() {
    "$iftty" info | grep -q '^landlock  version' || { skip "the kernel has no Landlock"; return 1; }
}
# True if the program was built with a sanitiser (`make help`: variants).
is_sanitised() {
    ldd "$iftty" 2>/dev/null | grep -q 'lib[at]san\.'
}
# For a part in which a replay writes a picture by the image helper, whose memory it limits.
can_limit_memory() {
    ! is_sanitised || { skip "a sanitiser takes more memory than a replay leaves"; return 1; }
}
finish() {
    close_story
    printf '1..%d\n' "$stories"
    [ "$bad_stories" = 0 ]
    exit
}

# A copy of the tree in $work/tree with all that was built, times of files too, so that make builds
# no more than it has to. Only the release is copied.
copy_tree() {
    [ "$build" = "$top/build" ] || { skip "only the release is copied"; return 1; }
    mkdir -p "$work/tree/build"
    (cd "$top" && cp -a Makefile .ci src journal render tui tests "$work/tree/" &&
        cp -a build/.packages build/src build/journal build/render build/tui build/iftty* \
            "$work/tree/build/")
}

# For scripts that mount a disk: restart the script in its own mount namespace.
# private_mounts SCRIPT; then can_mount holds, or the kernel does not let us.
private_mounts() {
    [ -z "$IFTTY_MOUNTS" ] || return
    [ "$(id -u)" = 0 ] && private=-m || private=-rm
    unshare $private true 2>/dev/null || return
    rmdir "$work"
    cd "$top" || exit 1
    IFTTY_MOUNTS=yes exec unshare $private "$1"
}
can_mount() {
    [ -n "$IFTTY_MOUNTS" ] || { skip "the kernel gives no mounts of our own"; return 1; }
}
# can_fuse BELOW ABOVE: a file system of FUSE that shows one folder as another.
can_fuse() {
    needs bindfs || return
    bindfs --no-allow-other "$1" "$2" 2>"$work/err" ||
        { skip "the kernel gives no FUSE"; return 1; }
}
# Run a command that obeys the permissions of files, even if root runs the test.
with_permissions() {
    if [ "$(id -u)" = 0 ]; then
        setpriv --bounding-set=-dac_override,-dac_read_search,-fowner "$@"
    else
        "$@"
    fi
}

# Wait until a command succeeds, up to a minute, since the machine may be busy.
comes_true() {
    tries=0
    until "$@"; do
        if [ $((tries += 1)) -gt 2400 ]; then
            fail "never comes true: $*"
            return 1
        fi
        sleep 0.025
    done
}
has_line() { # FILE PATTERN
    grep -q "$2" "$1"
}

# expect STATUS COMMAND...: run it with standard output in $work/out, standard error in $work/err.
# Standard input is that of the caller.
expect() {
    wanted=$1
    shift
    "$@" >"$work/out" 2>"$work/err"
    got=$?
    [ "$got" = "$wanted" ] && return 0
    fail "status $got, expected $wanted: $*" "$(sed 3q "$work/err")"
    return 1
}
expect_in() { # FOLDER STATUS COMMAND...
    here=$(pwd)
    cd "$1" || return
    shift
    expect "$@"
    cd "$here" || exit 1
}
out_has() { has_parts "$work/out" "$@"; } # fixed strings in lines of the last command's output
err_has() { has_parts "$work/err" "$@"; } # the same of its errors
has_parts() { # FILE STRING...; to start a grep would take longer
    printed=$1
    shift
    for expected_part; do
        while IFS= read -r read_line || [ -n "$read_line" ]; do
            case $read_line in *"$expected_part"*) continue 2 ;; esac
        done <"$printed"
        fail "no '$expected_part' in ${printed##*/}:" "$(tail -n 9 "$printed")"
    done
}
# expect_out WORDS STATUS COMMAND...: expect, and find the words on standard output
# expect_err WORDS STATUS COMMAND...: expect, and find the words in the errors
expect_out() {
    expected_words=$1
    shift
    expect "$@"
    out_has "$expected_words"
}
expect_err() {
    expected_words=$1
    shift
    expect "$@"
    err_has "$expected_words"
}
# answers WORDS COMMANDS: iftty executes them, and the words are in its output
# refuses WORDS COMMANDS: it fails with bad input, and the words are in the errors
answers() {
    expect_out "$1" 0 "$iftty" -c "$2"
}
refuses() {
    expect_err "$1" 3 "$iftty" -c "$2"
}
same() { # two texts
    [ "$1" = "$2" ] || fail "'$1' is not '$2'"
}
same_files() {
    cmp -s "$1" "$2" || fail "$1 differs from $2"
}
# The value of the last "KEY=" in a journal: last_word forest FILE
last_word() {
    tr ' ' '\n' <"$2" | sed -n "s/^$1=//p" | tail -n 1
}

# ---- files made by hand ----

le16() { # little-endian, as printf escapes
    printf '\\%03o\\%03o' $(($1 & 255)) $(($1 >> 8 & 255))
}
# voxels_of FILE: the voxels of a .nii of this machine, behind its header and names of labels
voxels_of() {
    set -- "$1" $(od -An -tf4 -j108 -N4 "$1")
    tail -c +$((${2%.*} + 1)) "$1"
}
# nifti_header NX NY NZ [TYPE BITS]: the 352 bytes before the voxels; uint8 by default
nifti_header() {
    {
        printf '\134\001\000\000'
        head -c 36 /dev/zero
        printf "$(le16 3)$(le16 "$1")$(le16 "$2")$(le16 "$3")$(le16 1)$(le16 1)$(le16 1)$(le16 1)"
        head -c 14 /dev/zero
        printf "$(le16 "${4:-2}")$(le16 "${5:-8}")"
        head -c 2 /dev/zero
        printf '\000\000\200\077\000\000\200\077\000\000\200\077\000\000\200\077'
        head -c 16 /dev/zero
        printf '\000\000\260\103'
        head -c 232 /dev/zero
        printf 'n+1\000\000\000\000\000'
    }
}
# make_scene FILE NX NY NZ: two blocks and a ball on a slope
make_scene() {
    {
        nifti_header "$2" "$3" "$4"
        awk -v nx="$2" -v ny="$3" -v nz="$4" 'BEGIN {
            for (z = 0; z < nz; z++) for (y = 0; y < ny; y++) for (x = 0; x < nx; x++) {
                v = 10 + x + 2 * y + (x > nx / 2 ? 60 : 0)
                if ((x - nx / 4) ^ 2 + (y - ny / 2) ^ 2 + (z - nz / 2) ^ 2 < 16) v += 80
                printf "%c", v } }'
    } >"$1"
}
byte_at() { # FILE OFFSET
    od -An -tu1 -j "$2" -N 1 "$1" | tr -d ' '
}
flip_byte() { # FILE OFFSET: the lowest bit of that byte
    printf "\\$(printf %03o $(($(byte_at "$1" "$2") ^ 1)))" |
        dd of="$1" bs=1 seek="$2" conv=notrunc 2>/dev/null
}
# put FILE OFFSET BYTES-AS-PRINTF-ESCAPES
put() {
    printf "$3" | dd of="$1" bs=1 seek="$2" conv=notrunc 2>/dev/null
}
file_bytes() {
    wc -c <"$1"
}
# chain_anew FROM TO: a copy of a journal with all its chains right: an honest forgery
chain_anew() {
    chain=00000000000000000000000000000000 covered=
    : >"$2"
    while IFS= read -r text; do
        case $text in
        '= '*)
            covered=$covered${text% chain=*}
            chain=$(printf %s%s "$chain" "$covered" | sha256sum | cut -c 1-32)
            printf '%s chain=%s\n' "$covered" "$chain" >>"$2"
            covered=
            ;;
        *) covered="$covered$text
" ;;
        esac
    done <"$1"
}
# rewrite JOURNAL NUMBER WORDS: the result words of that record, with all chains right
rewrite() {
    awk -v n="$2" -v words="$3" '/^= / && $2 == n {
        print "= " n " " words " chain=" substr($NF, 7); next }
        { print }' "$1" >"$work/rewritten"
    chain_anew "$work/rewritten" "$1"
    rm "$work/rewritten"
}
words_of() { # JOURNAL NUMBER
    sed -n "s/^= $2 \(.*\) chain=.*/\1/p" "$1"
}
# List all files below a folder with the time of their last write; equal lists mean that nothing
# was written meanwhile, not even the same bytes again. Folders may have had drafts.
states() {
    find "$1" -type d -printf '%P/\n' -o -printf '%P %y %i %s %T@\n' | sort
}
# List all files below a folder with their content; equal listings mean equal folders.
listing() {
    (cd "$1" && find . -type f -exec cksum {} + | sort -k 3; find . ! -type f | sort)
}
