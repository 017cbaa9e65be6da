#!/bin/sh
# SPDX-License-Identifier: MIT
# What `make install` puts where: a tree that works wherever it was moved to, pages that groff and
# mandoc set without a word, completions that the shells themselves take, and nothing left of it.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

stage=$work/stage
mkdir "$stage"
expect 0 .package/install "$build" "$stage" /opt/iftty || fail "$(cat "$work/err")"
mv "$stage" "$work/moved" # nothing in it may know where it was
tree=$work/moved/opt/iftty
doc=$tree/share/doc/iftty

begin "the installed program finds its helpers, and verifies an example"
for helper in image volume register; do
    [ -x "$tree/libexec/iftty/iftty-$helper" ] || fail "there is no iftty-$helper"
done
[ -z "$(find "$tree/bin" -name 'iftty-*')" ] || fail "helpers lie beside the program"
cp -R "$doc/examples" "$work/examples"
expect_in "$work" 0 "$tree/bin/iftty" verify --strict examples/geom.iftty </dev/null
make_scene "$work/scene.nii" 24 20 16
expect_in "$work" 0 "$tree/bin/iftty" -c 'open scene.nii; seed 6,10,8 1; run; render'\
' picture.png; save labels labels.mha; save labels labels.nrrd' </dev/null
[ -s "$work/picture.png" ] || fail "there is no picture"
expect_in "$work" 0 "$tree/bin/iftty" info picture.png </dev/null
out_has png
mv "$tree/libexec" "$work/away"
expect_in "$work" 3 "$tree/bin/iftty" info picture.png </dev/null
err_has "image helper"
err_has "; the package iftty-image has it, or \`make install\` of a checkout where it was built"
expect_in "$work" 3 "$tree/bin/iftty" -c 'open labels.mha' </dev/null
err_has "; the package iftty-volume has it"
expect_in "$work" 0 "$tree/bin/iftty" -c 'open labels.nrrd' </dev/null
mv "$work/away" "$tree/libexec"
ln -s "$tree/bin/iftty" "$work/linked"
expect_in "$work" 0 "$work/linked" info picture.png </dev/null

begin "programs are stripped, and each part that was not built is named with its missing function"
for program in "$tree/bin/iftty" "$tree"/libexec/iftty/iftty-*; do
    ! readelf -SW "$program" | grep -q '\.debug_info\|\.symtab' || fail "$program is not stripped"
done
mkdir "$work/half"
cp -R "$build/share" "$build/iftty" "$build/iftty-image" "$work/half"
expect 0 .package/install "$work/half" "$work/part" /usr
same "$(wc -l <"$work/err")" 2
err_has "left out: $work/half/iftty-volume was not built, so DICOM, "
err_has "left out: $work/half/iftty-register was not built, so scenes are not registered"
[ -x "$work/part/usr/libexec/iftty/iftty-image" ] || fail "the image helper is not there"
rm -rf "$work/part"

begin "the list of changes, the citation and the promises are installed"
version=$("$iftty" --version | sed -n 's/^iftty //p')
date=$(sed -n 's/^#define PROGRAM_DATE *"\(.*\)".*/\1/p' src/base/version.h)
grep -qx "## $version" "$doc/CHANGELOG.md" || fail "no changes of $version"
grep -qx "version: \"$version\"" "$doc/CITATION.cff" || fail "another version is cited"
grep -qx "date-released: $date" "$doc/CITATION.cff" || fail "another date is cited"
# The tests that it names exist.
for test in $(grep -ho '`test_[a-z_]*\(\.sh\)\{0,1\}`' "$doc/SECURITY.md" "$doc/PROMISES.md" |
    tr -d '`' | sort -u); do
    [ -x "tests/$test" ] || [ -f "tests/$test.c" ] || fail "there is no $test"
done
same "$(grep -c '^- \*\*.*\*\*' "$doc/PROMISES.md")" 10
same "$(sed -n "/^## Promised/,/^## /p" "$doc/PROMISES.md" | tr '\n' ' ' |
    sed 's/ - \*\*/\n&/g' | grep '^ - ' | grep -c '`test_')" 10
for file in "$doc/SECURITY.md" "$doc/README.md" "$tree/share/man/man1/iftty.1"; do
    tr '\n' ' ' <"$file" | grep -qE 'no(t a)? medical device' || fail "$file: no word of medicine"
done

programs=$("$iftty" --help | sed -n 's/^    iftty \([a-z][a-z]*\)\( .*\)\{0,1\}$/\1/p' | sort -u)
begin "every program has a page, and each page is set without a warning"
[ "$(printf '%s\n' "$programs" | wc -l)" -gt 10 ] || fail "programs: $programs"
for page in iftty.1 iftty-journal.5 $(printf 'iftty-%s.1\n' $programs); do
    file=$tree/share/man/man${page##*.}/$page
    [ -s "$file" ] || { fail "there is no $page"; continue; }
    if needs mandoc; then
        mandoc -T lint "$file" >"$work/out" 2>&1 || fail "mandoc:" "$(cat "$work/out")"
        [ ! -s "$work/out" ] || fail "mandoc:" "$(cat "$work/out")"
    fi
    if needs man; then
        MANWIDTH=80 man --warnings -E UTF-8 -l "$file" >"$work/page" 2>"$work/err"
        [ -s "$work/page" ] && [ ! -s "$work/err" ] || fail "$page:" "$(cat "$work/err")"
    fi
done
same "$(find "$tree/share/man" -type f | wc -l)" "$(($(printf '%s\n' "$programs" | wc -l) + 2))"

begin "pages have each option of the programs, and each command"
for program in $programs; do
    "$iftty" "$program" --help | sed -n 's/^    \(--*[a-z-]*\).*/\1/p' | sed 's/-/\\-/g' |
        while read -r option; do
            printf '%s\n' "$option" >"$work/option"
            grep -qFf "$work/option" "$tree/share/man/man1/iftty-$program.1" ||
                echo "$program $option"
        done
done >"$work/missing"
"$iftty" help all | sed -n 's/^\([a-z][a-z-]*\)\( .*\)\{0,1\}$/\1/p' | sed 's/-/\\\\-/g' |
    while read -r command; do
        grep -q "^.fB$command\\( \\|.fP\\)" "$tree/share/man/man5/iftty-journal.5" ||
            echo "journal $command"
    done >>"$work/missing"
[ ! -s "$work/missing" ] || fail "$(cat "$work/missing")"

# complete WORD...: what bash offers for the last one
complete_bash() {
    bash --norc -c '
        . "$1" || exit
        complete -p iftty >/dev/null || exit
        shift
        COMP_WORDS=(iftty "$@") COMP_CWORD=$#
        __iftty; printf "%s\n" "${COMPREPLY[@]}"' bash \
        "$tree/share/bash-completion/completions/iftty" "$@" 2>"$work/err"
}
offers() { # SHELL WANTED, what it says on standard input
    grep -qx -e "$2" || fail "$1 does not offer $2" "$(cat "$work/err")"
}
begin "bash completes programs, options, words and files"
mkdir "$work/files"
cd "$work/files" || exit 1
touch 'a scene.nii'
complete_bash ver | offers bash verify
complete_bash verify --str | offers bash --strict
complete_bash --out files verify --str | offers bash --strict
complete_bash show --graphics si | offers bash sixel
complete_bash help ver | offers bash verify
complete_bash help interp | offers bash interpolate
complete_bash run a | offers bash 'a scene.nii'
same "$(complete_bash run --str)" ""
same "$(complete_bash 'a scene.nii' veri)" ""
cd "$top" || exit 1

begin "zsh completes programs and options"
if needs zsh; then
    for typed in 'iftty verif|iftty verify ' 'iftty verify --stri|iftty verify --strict ' \
        'iftty show --graphics six|iftty show --graphics sixel '; do
        zsh -f -c '
            zmodload zsh/zpty
            zpty shell zsh -f -i
            zpty -w shell "PS1=; PS2=; unsetopt beep; fpath=($1 \$fpath)"
            zpty -w shell "autoload -U compinit; compinit -u -D"
            zpty -w shell "zle -N take; take() { print -r -- \"<\$BUFFER>\" >>$3 }"
            zpty -w shell "bindkey \"^T\" take; print ready >>$3"
            for i in {1..400}; do
                [[ -s $3 ]] && break
                zpty -r -t shell text; sleep 0.025
            done
            zpty -w -n shell "$2$(print "\t")"
            for i in {1..100}; do # with other keys waiting, a tab is one
                zpty -w -n shell "$(print "\x14")"
                sleep 0.1
                grep -qF "<$4>" $3 && break
                zpty -r -t shell text
            done
            zpty -d shell' zsh "$tree/share/zsh/site-functions" "${typed%|*}" "$work/zsh" \
            "${typed#*|}" \
            >/dev/null 2>"$work/err"
        grep -qF "<${typed#*|}>" "$work/zsh" || fail "zsh: $(cat "$work/zsh" "$work/err")"
        rm -f "$work/zsh"
    done
fi

begin "fish completes programs, options and words"
if needs fish; then
    complete_fish() { # LINE
        HOME=$work fish --no-config -c 'source $argv[1]; complete -C $argv[2]' \
            "$tree/share/fish/vendor_completions.d/iftty.fish" "$1" 2>"$work/err" |
            sed 's/	.*//'
    }
    complete_fish 'iftty ver' | offers fish verify
    complete_fish 'iftty verify --str' | offers fish --strict
    complete_fish 'iftty show --graphics si' | offers fish sixel
    same "$(complete_fish 'iftty run --str')" ""
fi

begin "uninstalling removes all installed files, and keeps other files"
expect 0 .package/install -u "$work/moved" /opt/iftty
same "$(find "$work/moved" -mindepth 1)" ""
expect 0 .package/install "$build" "$work/moved" /opt/iftty
expect 0 .package/install "$build" "$work/moved" /opt/iftty # over itself
touch "$tree/bin/other"
expect 0 .package/install -u "$work/moved" /opt/iftty
same "$(find "$work/moved" -type f)" "$tree/bin/other"
expect_err "nothing is installed" 1 .package/install -u "$work/moved" /opt/iftty

finish
