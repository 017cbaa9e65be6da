# SPDX-License-Identifier: MIT
# Files that others write, and whether a volume is opened as its twin is: for test_volumes.sh,
# test_series.sh and test_elsewhere.sh, which source this after lib.sh.
PYTHON=/usr/bin/python3
unset IFTTY_SCENES

# made_by SCRIPT: a story in which it makes files in $work/v, the working folder from then on;
# without them there is nothing more to test
made_by() {
    mkdir "$work/v"
    "$PYTHON" -W ignore "$top/tests/volumes/$1" "$work/v" >"$work/made" 2>&1 ||
        fail "$(tail -n 3 "$work/made")"
    [ "$failures" = 0 ] || { close_story; finish; }
    close_story
    cd "$work/v" || exit 1
}

# opened_as FILE TWIN [OPTION...]: the same scene, in the same place, as $says says
says=file
opened_as() {
    name=$1 twin=$2
    shift 2
    rm -f "$work"/[ab].nii "$work"/[ab].iftty
    expect 0 "$iftty" -c "open $twin; save labels $work/b.nii empty=yes" --journal "$work/b.iftty"
    expect 0 "$iftty" -c "open $name $*; save labels $work/a.nii empty=yes" \
        --journal "$work/a.iftty" || return
    for key in scene sha256 size spacing-nm; do
        value=$(last_word $key "$work/a.iftty")
        [ -n "$value" ] && [ "$value" = "$(last_word $key "$work/b.iftty")" ] ||
            fail "$name: $key is $value, not $(last_word $key "$work/b.iftty")"
    done
    is=$(last_word orientation "$work/a.iftty")
    case $(last_word orientation "$work/b.iftty") in
    unknown) same "$name $is" "$name unknown" ;;
    *) same "$name $is" "$name $says" ;;
    esac
    "$PYTHON" "$top/tests/volumes/make.py" same "$work/a.nii" "$work/b.nii" 2>"$work/err" ||
        fail "$name: $(tail -n 9 "$work/err")"
}
