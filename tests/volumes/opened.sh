# SPDX-License-Identifier: MIT
# Files that others write, and whether a volume is opened as its twin is: for test_volumes.sh,
# test_series.sh and test_elsewhere.sh, which source this after lib.sh.
unset IFTTY_SCENES

# made_by SCRIPT: a story in which it makes files in $work/v, the working folder from then on;
# without them there is nothing more to test
made_by() {
    mkdir "$work/v"
    "$PYTHON" -B -W ignore "$top/tests/volumes/$1" "$work/v" >"$work/made" 2>&1 ||
        fail "$(tail -n 3 "$work/made")"
    [ "$failures" = 0 ] || finish
    cd "$work/v" || exit 1
}

# opened_as FILE TWIN [OPTION...]: the same scene, in the same place, as $says says; for
# finish_opened.
says=file opened=0
: >"$work/opened"
opened_as() {
    name=$1 twin=$2
    shift 2
    opened=$((opened + 1))
    a=$work/opened-$opened-a b=$work/opened-$opened-b
    expect 0 "$iftty" -c "open $twin; save labels $b.nii empty=yes" --journal "$b.iftty"
    expect 0 "$iftty" -c "open $name $*; save labels $a.nii empty=yes" \
        --journal "$a.iftty" || return
    awk -v name="$name" -v says="$says" '
        { for (i = 1; i <= NF; i++)
            if (at = index($i, "="))
                last[FILENAME == ARGV[1] ? "a" : "b", substr($i, 1, at - 1)] = substr($i, at + 1) }
        END { split("scene sha256 size spacing-nm", keys, " ")
              for (k = 1; k <= 4; k++)
                  if (last["a", keys[k]] == "" || last["a", keys[k]] != last["b", keys[k]])
                      print name ": " keys[k] " is " last["a", keys[k]] ", not " last["b", keys[k]]
              wanted = last["b", "orientation"] == "unknown" ? "unknown" : says
              if (last["a", "orientation"] != wanted)
                  print name ": orientation is " last["a", "orientation"] ", not " wanted }
    ' "$a.iftty" "$b.iftty" >"$work/differs"
    [ ! -s "$work/differs" ] || fail "$(cat "$work/differs")"
    printf '%s\t%s\t%s\n' "$name" "$a.nii" "$b.nii" >>"$work/opened"
}
# twins PATTERN [volume=N] NAME...: PATTERN with each NAME for its % is opened as its twin
twins() {
    before=${1%%%*} after=${1#*%} chosen=
    shift
    case $1 in volume=*) chosen=$1; shift ;; esac
    for each; do opened_as "$before$each$after" "$before$each$after.twin.nii" $chosen; done
}
refused() { # WORDS COMMANDS: in one line
    refuses "$1" "$2"
    same "$2: $(wc -l <"$work/err") line" "$2: 1 line"
}
# may_open NAME COMMANDS: they succeed, or are refused in one line; counted in $count, and $bad
count=0 bad=0
may_open() {
    timeout 60 "$iftty" -c "$2" >"$work/out" 2>"$work/err"
    got=$? lines=$(grep -vc '^iftty: .* voxels: needs' "$work/err") count=$((count + 1))
    [ $got = 0 ] || bad=$((bad + 1))
    [ $got = 0 ] || [ "$got $lines" = "3 1" ] || fail "$1: status $got: $(cat "$work/err")"
}
# A last story, in which one process compares the places of all pairs in the world.
finish_opened() {
    begin "each of $opened files is in the place of its twin"
    "$PYTHON" "$top/tests/volumes/make.py" same "$work/opened" >"$work/differs" 2>&1 ||
        fail "$(tail -n 9 "$work/differs")"
    finish
}
