#!/bin/sh
# The layout of the source: who may include whom, headers that stand alone, integers only between a
# seed and a pixel, C++ in the helpers alone, no large libraries, one place for the names of
# commands.
. "$(dirname "$0")/lib.sh"

law=$top/tests/layout.txt

# Code without comments; string and character literals stay.
without_comments() {
    awk '
    { line = $0; code = ""
      while (length(line)) {
          if (inside) {
              at = index(line, "*/")
              if (!at) { line = ""; break }
              line = substr(line, at + 2); inside = 0
          } else if (substr(line, 1, 2) == "/*") { inside = 1; line = substr(line, 3)
          } else if (substr(line, 1, 2) == "//") { line = ""
          } else if (match(line, /^"([^"\\]|\\.)*"/) || match(line, /^\047([^\047\\]|\\.)*\047/)) {
              code = code substr(line, 1, RLENGTH); line = substr(line, RLENGTH + 1)
          } else { code = code substr(line, 1, 1); line = substr(line, 2) }
      }
      print code }' "$1"
}

sources() { # every C and C++ file of the folders given
    find "$@" -type f \( -name '*.[ch]' -o -name '*.cc' -o -name '*.hh' -o -name '*.cpp' -o \
        -name '*.hpp' -o -name '*.cxx' -o -name '*.C' \) 2>/dev/null | sort
}

# One line for every include in the tree at $1 that the law does not allow.
violations() {
    (cd "$1" && sources src journal render tui | while read -r file; do
        without_comments "$file" |
            sed -n 's/^[[:space:]]*#[[:space:]]*include[[:space:]]*"\([^"]*\)".*/\1/p' |
            sed "s|^|$file |"
    done) | awk -v law="$law" '
    BEGIN { while ((getline line < law) > 0) {
                n = split(line, w, /[ :]+/)
                for (i = 2; i <= n; i++) may[w[1], w[i]] = 1 } }
    { part = $1; sub(/^src\//, "", part)
      if (part != "main.c" && !sub(/\/[^\/]*$/, "", part)) { print $1 " lies in no part"; next }
      of = $2
      if (!sub(/\/[^\/]*$/, "", of)) { print $1 " includes " $2 " without its part"; next }
      if (!((part, of) in may)) print $1 " includes " $2 }'
}

begin "every include is allowed by tests/layout.txt"
found=$(violations "$top")
[ -z "$found" ] || fail "$found"
close_story

begin "the law is seen to be broken where it is"
fake=$work/fake
mkdir -p "$fake/src/engine" "$fake/src/base" "$fake/journal" "$fake/render" \
    "$fake/tui" "$fake/src/odd"
printf '#include "base/err.h"\n/* #include "tui/term.h" */\n' >"$fake/src/engine/fine.c"
printf '#include "base/err.h"\n#include "program/program.h"\n' >"$fake/src/main.c"
found=$(violations "$fake")
[ -z "$found" ] || fail "a lawful tree is blamed: $found"
printf '#include "journal/journal.h"\n' >"$fake/src/engine/one.c"
printf '  #  include "engine/forest.h"\n' >"$fake/journal/two.c"
printf '#include "tui/term.h"\n' >"$fake/render/three.h"
printf '#include "engine/grid.h"\n' >"$fake/src/base/four.h"
printf '#include "command/interpreter.h"\n' >"$fake/tui/five.c"
printf '#include "base/err.h"\n' >"$fake/src/odd/six.c"
printf '#include "err.h"\n' >"$fake/src/base/seven.cc"
printf '#include "verify/verify.h"\n' >"$fake/src/main.c"
same "$(violations "$fake" | sed 's/ .*//' | sort | tr '\n' ' ')" \
    "journal/two.c render/three.h src/base/four.h src/base/seven.cc src/engine/one.c src/main.c \
src/odd/six.c tui/five.c "
close_story

begin "every header compiles alone"
flags=$(pkg-config --cflags OpenEXR 2>/dev/null)
for header in $(sources src journal render tui tests | grep '\.h$'); do
    # shellcheck disable=SC2086
    ${CC:-cc} -std=c17 -D_GNU_SOURCE -Wall -Wno-unused -fsyntax-only -x c \
        -Isrc -I. $flags "$header" \
        >"$work/err" 2>&1 || fail "$header:" "$(sed 3q "$work/err")"
done
close_story

begin "no floating point in engine and render"
floats() {
    for file in $(sources "$@"); do
        without_comments "$file" | sed 's/"[^"]*"//g' |
            grep -nwE -e 'float|double|_Float[0-9]+|__float128' \
                -e '<?(t?g?math|complex|float)\.h>?|[0-9]+\.[0-9]*f?' |
            sed "s|^|$file:|"
    done
}
found=$(floats src/engine render)
[ -z "$found" ] || fail "$found"
mkdir "$work/floats"
printf 'int a; /* a float\n double */ int doubled = 1;\n' >"$work/floats/a.c"
same "$(floats "$work/floats")" ""
printf 'int b;\nstatic float c;\n' >"$work/floats/b.c"
same "$(floats "$work/floats" | wc -l | tr -d ' ')" 1
close_story

# The programs that it is measured against (tests/peers) are no part of it; the probes (tests/probe)
# are the helpers.
begin "C++ in the two helpers alone"
same "$(sources src journal render tui tests | grep -v '\.[ch]$' |
    grep -vE '^tests/p(eers|robe)/|^src/image/(iftty-)?(image|volume|wire)[_a-z0-9]*\.(cc|hh)$')" ""
close_story

begin "the program loads no large library"
libraries=$(ldd "$iftty" 2>&1) || fail "ldd: $libraries"
found=$(printf '%s\n' "$libraries" |
    grep -E 'ncurses|tinfo|readline|libedit|OpenImageIO|ITK|gdcm|stdc\+\+')
[ -z "$found" ] || is_sanitised || fail "$found"
close_story

# Programs of the command line (src/main.c) may share a name with a command; they are not commands.
# A key of JSON, and what progress is of, may be the same word.
begin "the name of a command is written in the table alone"
names=$(sed -n 's/^    {[CS][A-Z]*("\([a-z-]*\)",.*/\1/p' src/command/table.c src/session/setting.c)
[ "$(printf '%s\n' "$names" | wc -l)" -gt 15 ] || fail "the table was not understood: $names"
pattern=$(printf '%s\n' "$names" | sed 's/.*/"&"/' | paste -sd '|' -)
for file in $(sources src/command src/session src/show src/report |
    grep -vE '/(table|setting)\.c$'); do
    found=$(without_comments "$file" | sed 's/task_begin([^"]*"[^"]*"//' |
        grep -nE "$pattern" | grep -vE 'json_[a-z]+\(&?json, "')
    [ -z "$found" ] || fail "$file:$found"
done
for file in $(sources src journal tui | grep -v '/table\.c$'); do
    found=$(without_comments "$file" | grep -nE "str(n|case)?cmp\([^;]*($pattern)")
    [ -z "$found" ] || fail "$file:$found"
done
close_story

# Tests write below $TMPDIR, in a folder that goes away: make_folder (folder.h), $work (lib.sh).
begin "no test names a place for files of its own"
apart=" $(sed -n 's/^places: //p' "$law") "
for file in $(find tests -type f ! -path '*/corpus/*' | sort); do
    case $apart in *" $file "*) continue ;; esac
    found=$(grep -nE '(^|[^[:alnum:]_}])/(tmp|var/tmp|dev/shm)([^[:alnum:]_]|$)' "$file")
    [ -z "$found" ] || fail "$file: $found"
done
close_story

# The first in PATH that is version 14: others put lines otherwise.
formatter() {
    for formatter in clang-format-14 clang-format; do
        $formatter --version 2>/dev/null | grep -q 'version 14\.' && return
    done
    skip "clang-format 14 is not installed"
    return 1
}

begin "every file is as .clang-format has it"
if formatter; then
    # shellcheck disable=SC2046
    $formatter --dry-run $(sources src journal render tui tests) 2>"$work/err"
    [ ! -s "$work/err" ] ||
        fail "make format: $(grep -c warning: "$work/err") places:" \
            "$(grep warning: "$work/err" | sed 5q)"
fi
close_story

# Comments too, which no formatter touches. Columns are counted: letters in UTF-8, not their bytes.
too_long() { # FILE...
    awk '{ line = $0; gsub(/[\200-\277]/, "", line) }
        length(line) > 100 { print FILENAME ":" FNR " has " length(line) " columns" }' "$@"
}
begin "no line of a source or a script has more than 100 columns"
# shellcheck disable=SC2046
found=$(too_long Makefile $(find .ci src journal render tui tests examples -type f \
    \( -path '.ci/*' -o -name '*.[ch]' -o -name '*.cc' -o -name '*.sh' -o -name '*.py' \)))
[ -z "$found" ] || fail "$found"
printf '%0100d\n%0101d\n%099d\303\244\n' 0 0 0 >"$work/wide"
same "$(too_long "$work/wide")" "$work/wide:2 has 101 columns"
close_story

# A promise "S3 text" in the middle of a line of a comment, though "S2" begins one: what a formatter
# makes of a list.
glued() {
    awk '
    function report() {
        for (label in within) {
            former = substr(label, 1, 1) (substr(label, 2) - 1)
            if (former in begun && !(label in begun))
                print file ": " label " has no line of its own"
        }
        split("", within); split("", begun)
    }
    FNR == 1 { report(); file = FILENAME }
    sub(/^[ \t]*(\/\*+|\*|\/\/)[ \t]*/, "") {
        n = split($0, word, /[ ,;:.()]+/)
        for (i = 1; i <= n; i++)
            if (word[i] ~ /^[A-Z][0-9]+$/) {
                if (i == 1) begun[word[i]]
                else if (word[i - 1] !~ /^[A-Z][0-9]+$/) within[word[i]]
            }
    }
    END { report() }' "$@"
}
begin "every numbered promise has a line of its own"
# shellcheck disable=SC2046
found=$(glued $(sources src journal render tui tests))
[ -z "$found" ] || fail "$found"
printf '/*\n * Q1 one; as in Q3\n * Q2 two; see\n * Q3 three\n */\n' >"$work/fine.h"
printf '/*\n * Q1 one\n * that holds; Q2 two\n */\n' >"$work/glued.h"
same "$(glued "$work/fine.h" "$work/glued.h" | wc -l | tr -d ' ')" 1
close_story

# Help apart, which every program has (src/program/program.c).
begin "an option is looked for in the table of programs alone"
for file in $(sources src journal render tui | grep -v '^src/program/table\.c$'); do
    found=$(without_comments "$file" | sed 's/"--help"//; s/"-h"//' |
        grep -nE '(cmp|getopt(_long)?)\([^;]*"-{1,2}[a-z]')
    [ -z "$found" ] || fail "$file:$found"
done
close_story

begin "a command, program, weight, format or protocol is one file and one row"
apart=" $(sed -n 's/^apart: //p' "$law") "
sed -n 's/^place \([a-z]*\): \(.*\)/\1 \2/p' "$law" >"$work/places"
while read -r kind script table header; do
    found=$(sed 's/, *&/,\n\&/g' "$table" | sed -nE "$script" | sort -u | paste -sd '|' -)
    [ -n "$found" ] || { fail "no $kind in $table"; continue; }
    grep -rowE --include='*.[ch]' "$found" src journal render tui |
        awk -F: -v table="$table" -v header="$header" -v apart="$apart" '
        $1 != table && $1 != header && !seen[$0]++ && !index(apart, " " $2 " ") {
            where[$2] = where[$2] " " $1; n[$2]++ }
        END { for (name in n) if (n[name] > 1) print name " is also in" where[name] }' >"$work/more"
    [ ! -s "$work/more" ] || fail "$(cat "$work/more")"
    grep -q "$table" src/README.md ||
        fail "src/README.md does not say that a $kind goes into $table"
done <"$work/places"
for path in $(sed -n '/^## Where to add/,/^## /s/`\([a-z_/]*\.[ch]\)`/\n\1\n/gp' src/README.md |
    grep '^[a-z_/]*\.[ch]$'); do
    [ -e "$path" ] || [ -e "src/command/$path" ] || [ -e "src/program/$path" ] ||
        fail "src/README.md: there is no $path"
done
close_story

# Rooms: the folders that may include something by tests/layout.txt.
rooms() {
    sed -nE 's/^((render|journal|tui)[a-z\/]*): .*/\1/p; t; s/^([a-z]+): base.*/src\/\1/p' "$law"
}
lines_of() { # ROOM, without those below it
    find "$@" -maxdepth 1 -type f \( -name '*.[ch]' -o -name '*.cc' -o -name '*.hh' \) \
        -exec cat {} + | wc -l
}
ceiling=$(sed -n 's/^lines: //p' "$law")
begin "no room has more than a fifth of the lines, and all have less than $ceiling"
all=$(lines_of src)
for room in $(rooms); do all=$((all + $(lines_of "$room"))); done
for room in $(rooms); do
    [ $((5 * $(lines_of "$room"))) -le "$all" ] ||
        fail "$room has $(lines_of "$room") of $all lines"
done
[ "$all" -lt "$ceiling" ] || fail "there are $all lines"
same "$all" "$(sources src journal render tui | xargs cat | wc -l)"
close_story

begin "no function of a test hides a tool, and a tool is looked for by needs"
tools=$(sed -n 's/^tools: //p' "$law")
for file in tests/*.sh tests/*/*.sh; do
    for tool in $(sed -n 's/^\( *if\)\{0,1\} *needs \([a-z0-9 -]*\).*/\2/p' "$file"); do
        case " $tools " in
        *" $tool "*) ;;
        *) fail "$file needs $tool, which tests/layout.txt does not list" ;;
        esac
    done
    grep -q 'command -v' "$file" &&
        [ "${file##*/}" != lib.sh ] && [ "${file##*/}" != test_layout.sh ] &&
        fail "$file: command -v finds functions too; needs does not"
    for name in $(sed -n 's/^ *\([a-z_][a-z_0-9]*\)() *{.*/\1/p' "$file"); do
        case " $tools " in *" $name "*) fail "$file: the function $name hides a tool" ;; esac
    done
done
close_story

begin "the top level holds what it may hold"
allowed=" $(sed -n 's/^top: //p' "$law") "
if [ -e .git ] && git ls-files >/dev/null 2>&1; then
    entries=$({ git ls-files; git ls-files -o --exclude-standard; } | sed 's|/.*||' | sort -u)
else
    entries=$(ls -A | grep -vx 'build\|compile_commands.json')
fi
[ -n "$entries" ] || fail "nothing was found"
for entry in $entries; do
    case $allowed in *" $entry "*) ;; *) fail "$entry" ;; esac
done
close_story

finish
