#!/bin/sh
# SPDX-License-Identifier: MIT
# The layout of the source: who may include whom, headers that stand alone, integers only between a
# seed and a pixel, C++ in the helpers alone, no large libraries, one place for the names of
# commands, no more of the patterns of tests/words.txt than a room may have. `test_layout.sh count`
# prints the counts alone, `test_layout.sh words [ROOM]` each place of a pattern.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

law=$top/tests/layout.txt

sources() { # every C and C++ file of the folders given
    find "$@" -type f \( -name '*.[ch]' -o -name '*.cc' -o -name '*.hh' -o -name '*.cpp' -o \
        -name '*.hpp' -o -name '*.cxx' -o -name '*.C' \) 2>/dev/null | sort
}

# Print "FILE:LINE:CODE" without comments; string and character literals stay. Write the comments
# to the file COMMENTS, unless that is empty, as "FILE:LINE:COMMENT", one line each.
code_of() { # COMMENTS FILE...
    comments=$1
    shift
    awk -v comments="$comments" '
    function keep(text) {
        gsub(/^[ \t*]+|[ \t*\/]+$/, "", text)
        comment = comment (comment == "" || text == "" ? "" : " ") text
    }
    function flush() {
        if (comment != "" && comments != "") print from ":" comment >comments
        comment = ""
    }
    FNR == 1 { inside = 0 }
    { line = $0; code = ""
      while (length(line)) {
          if (inside) {
              at = index(line, "*/")
              if (!at) { keep(line); line = ""; break }
              keep(substr(line, 1, at - 1)); flush()
              line = substr(line, at + 2); inside = 0
          } else if (!match(line, /["\047]|\/[*\/]/)) { code = code line; line = ""
          } else {
              code = code substr(line, 1, RSTART - 1); line = substr(line, RSTART)
              if (substr(line, 1, 2) == "/*") {
                  inside = 1; line = substr(line, 3); from = FILENAME ":" FNR
              } else if (substr(line, 1, 2) == "//") {
                  from = FILENAME ":" FNR; keep(substr(line, 3)); flush(); line = ""
              } else if (match(line, /^"([^"\\]|\\.)*"/) ||
                         match(line, /^\047([^\047\\]|\\.)*\047/)) {
                  code = code substr(line, 1, RLENGTH); line = substr(line, RLENGTH + 1)
              } else { code = code substr(line, 1, 1); line = substr(line, 2) }
          }
      }
      print FILENAME ":" FNR ":" code }' "$@" </dev/null
}
code_of "$work/comments" $(sources src journal render tui) >"$work/code"

# "FILE INCLUDED" for each line of such code that includes a file of ours.
includes() {
    sed -nE 's|^([^:]*):[0-9]*:[[:space:]]*#[[:space:]]*include[[:space:]]*"([^"]*)".*|\1 \2|p' "$@"
}

# "NAME NUMBER" for each number that tests/layout.txt limits: code lines of each room and of all,
# comment lines for 1000 of them, files, rows of the law, pairs of rooms of which one includes the
# other, and lines of tests. Blank lines, includes and licence lines are neither code nor comment.
count() {
    echo "rows $(grep -cE '^[a-z]+(/[a-z]+)?: base' "$law")"
    cat $(sources tests) $(find tests -name '*.sh' -o -name '*.py') | wc -l | sed 's/^ */tests /'
    awk '
    FILENAME ~ /code$/ { file = $0; sub(/:.*/, "", file); room = file
        sub(/^src\//, "", room); sub(/\/[^\/]*$/, "", room)
        text = $0; sub(/^[^:]*:[0-9]*:[ \t]*/, "", text)
        if (text ~ /^#[ \t]*include/) {
            includes++
            if (text ~ /"/) {
                of = text; sub(/^[^"]*"/, "", of); sub(/\/[^\/]*$/, "", of)
                if (room != of && room != "main.c") pair[room, of]
            }
        } else if (text != "") { code++; codes[room]++ }
        next }
    FNR == 1 { files++ }
    /[^ \t]/ { filled++ }
    END { for (room in codes) print room, codes[room]
        for (one in pair) pairs++
        print "files", files; print "pairs", pairs; print "code", code
        print "comments", int(1000 * (filled - code - includes - files) / code)
    }' "$work/code" $(sources src journal render tui)
}
count >"$work/counts"
counted() { # NAME
    sed -n "s|^$1 ||p" "$work/counts"
}
echo "# count: $(counted code) code lines, $(counted comments) comment lines for 1000 of them," \
    "$(counted files) files, $(counted rows) rooms, $(counted pairs) pairs of rooms," \
    "$(counted tests) lines of tests"
[ "$1" != count ] || exit 0

# Each place of a pattern of tests/words.txt: "ROOM KIND FILE:LINE: [PATTERN] TEXT", where KIND is
# comments, messages (string literals) or readme.
words_of() { # COMMENTS CODE README...
    awk '
    function found(kind, place, text,    i, low, room) {
        low = " " tolower(text) " "
        gsub(/`[^`]*`/, " ", low)
        room = place
        sub(/:.*/, "", room); sub(/^src\//, "", room)
        if (!sub(/\/[^\/]*$/, "", room)) room = "top"
        for (i = 1; i <= patterns; i++)
            if ((kinds[i] == "all" || kinds[i] == kind) && match(low, pattern[i]))
                print room, kind, place ": [" name[i] "] " text
    }
    FILENAME ~ /words.txt$/ {
        if (match($0, /^(all|comments) [^:]*: /)) {
            patterns++
            kinds[patterns] = $1
            name[patterns] = substr($0, length($1) + 2, RLENGTH - length($1) - 3)
            pattern[patterns] = substr($0, RLENGTH + 1)
        }
        next
    }
    FILENAME ~ /comments$/ {
        place = $0
        match(place, /^[^:]*:[0-9]*/)
        found("comments", substr(place, 1, RLENGTH), substr($0, RLENGTH + 2))
        next
    }
    FILENAME ~ /code$/ {
        match($0, /^[^:]*:[0-9]*/)
        place = substr($0, 1, RLENGTH)
        line = substr($0, RLENGTH + 2)
        while (match(line, /"([^"\\]|\\.)*"/)) {
            text = substr(line, RSTART + 1, RLENGTH - 2)
            line = substr(line, RSTART + RLENGTH)
            if (text ~ / /) found("messages", place, text)
        }
        next
    }
    /^    / { next }
    { found("readme", FILENAME ":" FNR, $0) }' tests/words.txt "$@"
}
words_of "$work/comments" "$work/code" $(find README.md src journal render tui tests examples \
    -name '*.md' | sort) >"$work/words"
if [ "$1" = words ]; then
    grep -E "^${2:-.*} " "$work/words"
    exit 0
fi
begin "no room uses more of the patterns of tests/words.txt than it may"
for kind in comments messages readme; do
    for room in $(cut -d' ' -f1 "$work/words" | sort -u); do
        now=$(grep -c "^$room $kind " "$work/words")
        may=$(sed -n "s|^count $room $kind: ||p" tests/words.txt)
        [ "$now" -le "${may:-0}" ] ||
            fail "$room has $now in its $kind, and may have ${may:-0}:" \
                "see sh tests/test_layout.sh words $room"
    done
done

# One line for every such pair that the law does not allow.
violations() {
    awk -v law="$law" '
    BEGIN { while ((getline line < law) > 0) {
                n = split(line, w, /[ :]+/)
                for (i = 2; i <= n; i++) may[w[1], w[i]] = 1 } }
    { part = $1; sub(/^src\//, "", part)
      if (part != "main.c" && !sub(/\/[^\/]*$/, "", part)) { print $1 " lies in no part"; next }
      of = $2
      if (!sub(/\/[^\/]*$/, "", of)) { print $1 " includes " $2 " without its part"; next }
      if (!((part, of) in may)) print $1 " includes " $2 }' "$@"
}

begin "every include is allowed by tests/layout.txt"
includes "$work/code" >"$work/includes"
found=$(violations "$work/includes")
[ -z "$found" ] || fail "$found"

begin "the law is seen to be broken where it is"
fake=$work/fake
mkdir -p "$fake/src/engine" "$fake/src/base" "$fake/journal" "$fake/render" \
    "$fake/tui" "$fake/src/odd"
broken() { # the files of the fake tree that break the law
    (cd "$fake" && code_of "" $(sources src journal render tui)) | includes | violations -
}
printf '#include "base/err.h"\n/* #include "tui/term.h" */\n' >"$fake/src/engine/fine.c"
printf '#include "base/err.h"\n#include "program/program.h"\n' >"$fake/src/main.c"
found=$(broken)
[ -z "$found" ] || fail "a lawful tree is blamed: $found"
printf '#include "journal/journal.h"\n' >"$fake/src/engine/one.c"
printf '  #  include "engine/forest.h"\n' >"$fake/journal/two.c"
printf '#include "tui/term.h"\n' >"$fake/render/three.h"
printf '#include "engine/grid.h"\n' >"$fake/src/base/four.h"
printf '#include "command/interpreter.h"\n' >"$fake/tui/five.c"
printf '#include "base/err.h"\n' >"$fake/src/odd/six.c"
printf '#include "err.h"\n' >"$fake/src/base/seven.cc"
printf '#include "verify/verify.h"\n' >"$fake/src/main.c"
same "$(broken | sed 's/ .*//' | sort | tr '\n' ' ')" \
    "journal/two.c render/three.h src/base/four.h src/base/seven.cc src/engine/one.c src/main.c \
src/odd/six.c tui/five.c "

# A unit is x.c with x.h: what either includes, it needs.
circles() { # the units of each circle of such pairs, in lines
    sed -E 's/\.[a-z]+ / /; s/\.[a-z]+$//; s|^src/||' "$@" | awk '$1 != $2' | sort -u |
        tsort 2>&1 >/dev/null | sed -n 's/^tsort: \([a-z].*\)/\1/p' | grep -v ': '
}
begin "neither files nor rooms form a circle"
found=$(circles "$work/includes")
[ -z "$found" ] || fail "each needs the next, and the last the first:" "$found"
printf 'src/a/one.c a/two.h\nsrc/a/two.c a/one.h\nsrc/a/one.c a/one.h\n' >"$work/circle"
same "$(circles "$work/circle" | sort | tr '\n' ' ')" "a/one a/two "
printf 'src/a/one.c a/two.h\nsrc/a/two.h a/three.h\n' >"$work/circle"
same "$(circles "$work/circle")" ""
found=$(sed -nE 's/^([a-z]+(\/[a-z]+)?): (base.*)/\1 \3/p' "$law" |
    awk '{ for (i = 2; i <= NF; i++) print $1 ".c", $i ".h" }' | circles)
[ -z "$found" ] || fail "rooms:" "$found"

# Pairs of files of a folder, of which the first calls a function, or reads a table, of the second.
calls_of() {
    nm -Ag $(ls "$1"/*.c | sed "s|.*|$build/&|; s|c$|o|") | awk '
        { sub(/:.*/, "", $1) }
        $2 ~ /[TRDB]/ { of[$3] = $1 }
        $2 == "U" { caller[++n] = $1; name[n] = $3 }
        END { for (; n; n--) if (name[n] in of) print caller[n], of[name[n]] }' | sort -u
}
begin "files of tui/pilot call downward alone"
[ "$(calls_of tui/pilot | wc -l)" -gt 15 ] || fail "no calls are found"
calls_of tui/pilot | tsort >/dev/null 2>"$work/circle" || fail "a circle of" "$(cat "$work/circle")"

begin "only src/session writes the members of a session"
found=$(grep -rnE 'session->(inside|[a-z_.]+(\[[^]]*\])? ?([-+|&]?=[^=]|\+\+|--))' \
    --include='*.[ch]' src tui | grep -v '^src/session/')
[ -z "$found" ] || fail "$found"

begin "no two files have one name"
found=$(find src journal render tui -name '*.*' ! -name '*.md' | sed 's/\.[a-z]*$//' | sort -u |
    sed 's|.*/\(.*\)|\1 &|' | sort | awk '$1 == name { print file, $2 } { name = $1; file = $2 }')
[ -z "$found" ] || fail "$found"

# What is made anew when a header changes, as the compiler sees it: of all objects, so many parts of
# a hundred.
begin "no header is known to more objects than tests/layout.txt says"
share=$(sed -n 's/^share: //p' "$law")
widely=" $(sed -n 's/^widely: //p' "$law" | tr '\n' ' ')"
for file in $(sources src journal render tui); do
    [ ! -e "$build/${file%.*}.d" ] || echo "$build/${file%.*}.d"
done | sort -u >"$work/objects"
objects=$(wc -l <"$work/objects")
[ "$objects" -gt 100 ] || fail "there are $objects objects"
xargs awk '{ sub(/^[^ ]*:/, ""); sub(/\\$/, ""); for (i = 1; i <= NF; i++)
    if ($i ~ /^(src|journal|render|tui)\/.*\.h$/) print FILENAME, $i }' <"$work/objects" |
    sort -u | awk '{ print $2 }' | sort | uniq -c |
    awk -v objects="$objects" '{ print $2, int(100 * $1 / objects) }' >"$work/shares"
[ -s "$work/shares" ] || fail "no object says what it was made of"
while read -r header percent; do
    case $widely in *" $header "*) continue ;; esac
    [ "$percent" -le "$share" ] || fail "$header is known to $percent % of all objects"
done <"$work/shares"
for header in $widely; do [ -e "$header" ] || fail "there is no $header"; done

# The compiler has proven that of a header that a source or a test includes first.
begin "every header compiles alone"
flags=$(pkg-config --cflags OpenEXR 2>/dev/null)
awk '/^#include/ { if (gsub(/"/, "", $2)) { print $2; print "src/" $2 } nextfile }' \
    $(sources src journal render tui | grep '\.c$') tests/test_*.c >"$work/first"
for header in $(sources src journal render tui tests | grep '\.h$' | grep -vxFf "$work/first"); do
    ${CC:-cc} -std=c17 -D_GNU_SOURCE -Wall -Wno-unused -fsyntax-only -x c \
        -Isrc -I. $flags "$header" \
        >"$work/err" 2>&1 || fail "$header:" "$(sed 3q "$work/err")"
done

begin "no floating point in engine and render"
floats() { # "CODE FILE:LINE:" of code that has any
    sed -E 's/"[^"]*"//g; s/^([^:]*:[0-9]*:)(.*)/\2 \1/' "$@" |
        grep -wE -e 'float|double|_Float[0-9]+|__float128' \
            -e '<?(t?g?math|complex|float)\.h>?|[0-9]+\.[0-9]*f?'
}
found=$(grep -E '^(src/engine|render)/' "$work/code" | floats)
[ -z "$found" ] || fail "$found"
printf 'int a; /* a float\n double */ int doubled = 1;\n' >"$work/a.c"
same "$(code_of "" "$work/a.c" | sed 's|.*/||' | floats)" ""
printf 'int b;\nstatic float c;\n' >"$work/b.c"
same "$(code_of "" "$work/b.c" | sed 's|.*/||' | floats | wc -l)" 1

# The programs that it is measured against (tests/peers), and what writes files for tests, are no
# part of it; the probes (tests/probe) are the helpers.
begin "C++ in the helpers alone"
same "$(sources src journal render tui tests | grep -v '\.[ch]$' |
    grep -vE -e '^tests/(peers|probe|transforms)/' \
        -e '^tests/fuzz/fuzz_seg\.cc$' -e '^src/helper/[-_a-z0-9]*\.(cc|hh)$')" ""

begin "the program loads no large library"
libraries=$(ldd "$iftty" 2>&1) || fail "ldd: $libraries"
found=$(printf '%s\n' "$libraries" |
    grep -E 'ncurses|tinfo|readline|libedit|OpenImageIO|ITK|gdcm|stdc\+\+')
[ -z "$found" ] || is_sanitised || fail "$found"

# Programs of the command line (src/main.c) may share a name with a command; they are not commands.
# A key of JSON may be the same word, a parameter that an act asks for, and what progress is of.
begin "the name of a command is written in the table alone"
names=$(sed -n 's/^    {[CS][A-Z]*("\([a-z-]*\)",.*/\1/p' src/command/table.c src/session/setting.c)
[ "$(printf '%s\n' "$names" | wc -l)" -gt 15 ] || fail "the table was not understood: $names"
pattern=$(printf '%s\n' "$names" | sed 's/.*/"&"/' | paste -sd '|' -)
found=$(grep -E '^src/(command|session|show)/' "$work/code" |
    grep -vE '^[^:]*/(table|setting)\.c:' | grep -E ":.*($pattern)" |
    grep -vE '(json_[a-z]+\(&?json|(act|call)_[a-z_]+\(&?[a-z>-]+), "|task_begin\([^;]*,')
[ -z "$found" ] || fail "$found"
found=$(grep -v '^[^:]*/table\.c:' "$work/code" | grep -E "str(n|case)?cmp\([^;]*($pattern)")
[ -z "$found" ] || fail "$found"

# Tests write below $TMPDIR, in a folder that goes away: make_folder (folder.h), $work (lib.sh).
begin "no test names a folder for temporary files"
sed -n 's/^places: //p' "$law" | tr ' ' '\n' >"$work/apart"
found=$(find tests -type f ! -path '*/corpus/*' | grep -vxFf "$work/apart" | sort |
    xargs grep -nE '(^|[^[:alnum:]_}])/(tmp|var/tmp|dev/shm)([^[:alnum:]_]|$)')
[ -z "$found" ] || fail "$found"

# The first in PATH that is version 14: others put lines otherwise.
formatter() {
    for formatter in clang-format-14 clang-format; do
        $formatter --version 2>/dev/null | grep -q 'version 14\.' && return
    done
    apt-cache show clang-format-14 >/dev/null 2>&1 && skip "clang-format 14 is not installed"
    skip "this Debian has no clang-format 14"
    return 1
}

begin "every file is as .clang-format has it"
if formatter; then
    $formatter --dry-run $(sources src journal render tui tests) 2>"$work/err"
    [ ! -s "$work/err" ] ||
        fail "make format: $(grep -c warning: "$work/err") places:" \
            "$(grep warning: "$work/err" | sed 5q)"
fi

# Comments too, which no formatter touches. Columns are counted: letters in UTF-8, not their bytes.
too_long() { # FILE...
    awk '{ line = $0; gsub(/[\200-\277]/, "", line) }
        length(line) > 100 { print FILENAME ":" FNR " has " length(line) " columns" }' "$@"
}
begin "no line of a source or a script has more than 100 columns"
found=$(too_long Makefile $(find .ci .package src journal render tui tests examples -type f \
    \( -path '.ci/*' -o -path '.package/*' -o -name '*.[ch]' \
    -o -name '*.cc' -o -name '*.sh' -o -name '*.py' \)))
[ -z "$found" ] || fail "$found"
printf '%0100d\n%0101d\n%099d\303\244\n' 0 0 0 >"$work/wide"
same "$(too_long "$work/wide")" "$work/wide:2 has 101 columns"

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
found=$(glued $(sources src journal render tui tests))
[ -z "$found" ] || fail "$found"
printf '/*\n * Q1 one; as in Q3\n * Q2 two; see\n * Q3 three\n */\n' >"$work/fine.h"
printf '/*\n * Q1 one\n * that holds; Q2 two\n */\n' >"$work/glued.h"
same "$(glued "$work/fine.h" "$work/glued.h" | wc -l)" 1

# Help apart, which every program has (src/program/program.c).
begin "an option is looked for in the table of programs alone"
found=$(sed 's/"--help"//; s/"-h"//' "$work/code" | grep -v '^src/program/program_table\.c:' |
    grep -E '(cmp|getopt(_long)?)\([^;]*"-{1,2}[a-z]')
[ -z "$found" ] || fail "$found"

begin "a command, program, weight, format or protocol is one file and one row"
apart=" $(sed -n 's/^apart: //p' "$law") "
sed -n 's/^place \([a-z]*\): \(.*\)/\1 \2/p' "$law" >"$work/places"
while read -r kind script table header; do
    found=$(sed 's/, *&/,\n\&/g' "$table" | sed -nE "$script" | sort -u | paste -sd '|' -)
    [ -n "$found" ] || { fail "no $kind in $table"; continue; }
    grep -vE ':[[:space:]]*#[[:space:]]*include' "$work/code" | grep -wE "$found" |
        sed -E 's/^([^:]*):[0-9]*:/\1:/' | awk -F: -v names="$found" -v table="$table" \
        -v header="$header" -v apart="$apart" '
        BEGIN { count = split(names, of, "|") }
        $1 != table && $1 != header { sub(/\.[ch]$/, "", $1); for (i = 1; i <= count; i++)
            if ($0 ~ ("(^|[^a-z_])" of[i] "([^a-z_]|$)") && !seen[$1, of[i]]++ &&
                !index(apart, " " of[i] " ")) { where[of[i]] = where[of[i]] " " $1; n[of[i]]++ } }
        END { for (name in n) if (n[name] > 1) print name " is also in" where[name] }' >"$work/more"
    [ ! -s "$work/more" ] || fail "$(cat "$work/more")"
    grep -q "$table" src/README.md ||
        fail "src/README.md does not say that a $kind goes into $table"
done <"$work/places"
for path in $(sed -n '/^## Where to add/,/^## /s/`\([a-z_/]*\.[ch]\)`/\n\1\n/gp' src/README.md |
    grep '^[a-z_/]*\.[ch]$'); do
    [ -e "$path" ] || [ -e "src/command/$path" ] || [ -e "src/program/$path" ] ||
        [ -e "tui/pilot/$path" ] ||
        fail "src/README.md: there is no $path"
done

# src/image/README.md says for each format which property is read, refused or not applicable. Each
# cell names tests (N1) or, where nothing applies, a reason (a), which a list below the table has.
unproven() { # README TOP: what is wrong with the table, a line each
    awk -v top="$2" '
    function of_test(file, name,    path, line, wanted, found) {
        path = top "/tests/" file (file ~ /\.sh$/ ? "" : ".c")
        wanted = file ~ /\.sh$/ ? "begin \"" name "\"" : "STORY(" name ")"
        found = 0
        while ((getline line < path) > 0) {
            gsub(/\\/, "", line)
            if (line == wanted || (file ~ /\.sh$/ && index(line, wanted) == 1)) found = 1
        }
        close(path)
        return found
    }
    /^## / { on = /^## Read or refused, property by property/ }
    !on { next }
    /^    [A-Z][0-9]+ / {
        key = $1; file = $2; sub(/:$/, "", file)
        story = $0; sub(/^ *[^ ]* [^ ]* /, "", story)
        if (key in test) print key " is there twice"
        test[key] = 1
        if (!of_test(file, story)) print key ": there is no story \"" story "\" in tests/" file
        next
    }
    /^    [a-z]: ./ { key = substr($1, 1, 1); reason[key] = 1; next }
    /^\|/ && !head { head = 1; columns = split($0, title, "|"); next }
    /^\|[-|]*\|$/ { next }
    /^\|/ {
        rows++
        if (split($0, cell, "|") != columns) print "a row has too few or too many cells: " $0
        for (i = 3; i < columns; i++) {
            text = cell[i]; gsub(/^ +| +$/, "", text)
            where = cell[2] title[i] ": "
            kind = text ~ /^(read|refused)/ ? "test" : text ~ /^not applicable/ ? "reason" : ""
            if (kind == "") print where "neither read, refused nor not applicable: " text
            named = 0
            rest = text
            while (match(rest, /\[[A-Za-z][0-9]*\]/)) {
                key = substr(rest, RSTART + 1, RLENGTH - 2); rest = substr(rest, RSTART + RLENGTH)
                used[key] = where; if (key ~ (kind == "test" ? "^[A-Z]" : "^[a-z]$")) named++
            }
            if (kind != "" && !named) print where "no " kind " is named"
        }
        next
    }
    END {
        if (!rows) print "there is no table"
        for (key in used) if (!(key in test) && !(key in reason)) print used[key] "no [" key "]"
        for (key in test) if (!(key in used)) print key " is named by no cell"
        for (key in reason) if (!(key in used)) print key ": a reason of no cell"
    }' "$1"
}
begin "each cell of the formats' table names a story that is there, or why it needs none"
found=$(unproven src/image/README.md "$top")
[ -z "$found" ] || fail "$found"
# No format is left out: those of the table of readers, and those that iftty-volume is asked for.
{
    sed -n 's/.*ROW(\([a-z]*\)_format.*/\1/p' src/image/volume.h | grep -v 'helped'
    sed -n '/^static const struct kind kinds/,/^};/s/^    {"\([a-z0-9]*\)",.*/\1/p' \
        src/image/volume_helper.c
    sed -n '/^const Kind kinds/,/^};/s/^    {"\([a-z0-9-]*\)",.*/\1/p' src/helper/volume_itk.cc
} | sort -u >"$work/kinds"
[ "$(wc -l <"$work/kinds")" -gt 15 ] || fail "formats: $(cat "$work/kinds")"
while read -r kind; do
    sed -n '/^## Read or refused, property by property/,/^## Refused/p' src/image/README.md |
        grep -q "^| [^|]*\`$kind\`" || fail "no row has the format \`$kind\`"
done <"$work/kinds"
mkdir -p "$work/formats/tests"
printf 'begin "a is \\`b\\`"\n' >"$work/formats/tests/test_a.sh"
printf 'STORY(b_is_a)\n' >"$work/formats/tests/test_b.c"
table() { # CELL CELL LIST
    printf '## Read or refused, property by property\n\n| format | type | unit |\n|---|---|---|\n'
    printf '| A `a` | %s | %s |\n\n    A1 test_a.sh: a is `b`\n    a: it has none\n' "$1" "$2"
    printf '%s\n' "$3"
}
while IFS='@' read -r one two list wrong; do
    table "$one" "$two" "$list" >"$work/formats/README"
    same "$(unproven "$work/formats/README" "$work/formats" | head -n 1)" "$wrong"
done <<'END'
read [A1]@not applicable [a]@@
read [A1]; big refused [B1]@not applicable [a]@    B1 test_b: b_is_a@
read [A1]@not applicable@@ A `a`  unit : no reason is named
read@not applicable [a] [A1]@@ A `a`  type : no test is named
maybe [A1]@not applicable [a]@@ A `a`  type : neither read, refused nor not applicable: maybe [A1]
read [A1] [B2]@not applicable [a]@@ A `a`  type : no [B2]
read [A1]@not applicable [a]@    B1 test_b: b_is_b@B1: there is no story "b_is_b" in tests/test_b
END

# Rooms are those that may include something by tests/layout.txt.
rooms=$(sed -nE 's/^([a-z]+(\/[a-z]+)?): base.*/\1/p' "$law")
folder() { # ROOM
    case $1 in render | journal | tui*) echo "$1" ;; *) echo "src/$1" ;; esac
}
of_room() { # KIND ROOM [FILE]: the words of "KIND ROOM: WORDS"
    sed -n "s|^$1 $2: ||p" "${3:-$law}"
}
begin "no room has more than a fifth of the code, nor is anything above its ceiling"
for name in $rooms files rows pairs tests; do
    is=$(counted "$name") ceiling=$(of_room ceiling "$name")
    [ "$is" -le "${ceiling:-0}" ] || fail "$name: $is, and may be ${ceiling:-none}"
    case $name in
    tests) [ $((is + 1000)) -ge "${ceiling:-0}" ] ;;
    files | rows | pairs) [ $((is + 10)) -ge "${ceiling:-0}" ] ;;
    *) [ $((5 * is)) -le "$(counted code)" ] || fail "$name has $is of all code lines"
        [ $((is + 100)) -ge "${ceiling:-0}" ] ;;
    esac || fail "$name: $is: its ceiling of $ceiling comes down to that"
done
[ "$(counted comments)" -ge "$(of_room floor comments)" ] ||
    fail "$(counted comments) comment lines for 1000 code lines, not $(of_room floor comments)"
printf 'void a(void)\n{\n    b(); /* c */\n    /*\n     * d */\n\n    // e\n    f("/*");\n}\n' \
    >"$work/a.c"
same "$(code_of "" "$work/a.c" | grep -vcE ':[[:space:]]*$')" 5

# What README says of the licence, where machines look for it; first, or after the line of a script
# that says what runs it.
begin "every source and script names its licence"
{
    sources src journal render tui tests
    find Makefile .ci .package examples tests -type f \( -name Makefile -o -name '*.sh' -o \
        -name '*.py' -o -path '.ci/*' -o -path '.package/[a-z]*' ! -path '.package/*/*' \)
} >"$work/files"
xargs awk 'FNR > 2 { nextfile }
    /^(\/\*|#) SPDX-License-Identifier: (MIT|Bitstream-Vera)( \*\/)?$/ { print FILENAME }' \
    <"$work/files" | sort >"$work/named"
found=$(sort "$work/files" | comm -23 - "$work/named")
[ -z "$found" ] || fail "$found"

# The commit before: HEAD, where the file was changed since, else what HEAD was made of.
raised() { # FORMER NOW: ceilings of NOW that are higher, without a new line that says why
    for room in $(sed -n 's/^ceiling \([a-z/]*\): .*/\1/p' "$2"); do
        before=$(of_room ceiling "$room" "$1") why=$(of_room raised "$room" "$2")
        [ "$(of_room ceiling "$room" "$2")" -le "${before:-999999}" ] && continue
        [ -n "$why" ] && [ "$why" != "$(of_room raised "$room" "$1")" ] && continue
        echo "the ceiling of $room rose from $before, and no new line says why"
    done
}
begin "a ceiling falls, or the line next to it has the reason"
before=HEAD
git diff --quiet HEAD -- "$law" 2>/dev/null && before=HEAD^
if git show "$before:tests/layout.txt" >"$work/former" 2>/dev/null; then
    found=$(raised "$work/former" "$law")
    [ -z "$found" ] || fail "$found"
fi
printf 'ceiling a: 5\nraised a: once\nceiling b: 7\n' >"$work/one"
printf 'ceiling a: 6\nraised a: once\nceiling b: 6\nceiling c: 9\n' >"$work/two"
same "$(raised "$work/one" "$work/two")" \
    "the ceiling of a rose from 5, and no new line says why"
printf 'ceiling a: 6\nraised a: another\n' >"$work/two"
same "$(raised "$work/one" "$work/two")" ""

# ROOM and what it includes, without what comes with that anyway.
way() {
    awk -F': ' '
    /^[a-z]+(\/[a-z]+)?: base/ { order[++n] = $1; may[$1] = " " $2 " "
        m[$1] = split($2, list, " "); for (i = 1; i <= m[$1]; i++) of[$1, i] = list[i] }
    END { for (k = 1; k <= n; k++) {
        room = order[k]; words = ""
        for (i = 1; i <= m[room]; i++) {
            one = of[room, i]; comes = one == room
            for (j = 1; j <= m[room]; j++)
                comes = comes || (of[room, j] != one && of[room, j] != room &&
                                  index(may[of[room, j]], " " one " "))
            if (!comes) words = words (words ? ", " : "") one
        }
        printf "    %-12s %s\n", room, words ? words : "nothing"
    } }' "$law"
}
house() { # the rooms in words
    for room in $rooms; do
        printf '    %-14s%s\n' "$(folder "$room")" "$(of_room says "$room")"
    done
}
# What stands under a heading, in lines that begin with four blanks; of the first block alone.
shown() { # FILE HEADING
    awk -v heading="## $2" '$0 == heading { on = 1; next } on && /^    / { print; any = 1; next }
        on && any { exit }' "$1"
}
begin "README and src/README.md draw the rooms as tests/layout.txt has them"
house >"$work/house"
shown README.md "The folders" | grep -v '^    \(tests\|examples\) ' >"$work/drawn"
cmp -s "$work/house" "$work/drawn" || fail "README.md, The folders; it is" "$(cat "$work/house")"
way >"$work/way"
shown src/README.md "The folders and their includes" >"$work/drawn"
cmp -s "$work/way" "$work/drawn" || fail "src/README.md, The folders; it is" "$(cat "$work/way")"

begin "the behaviours of tests/guess.txt are where it says"
sed -n 's/^[^#].*: //p' tests/guess.txt >"$work/guessed"
[ "$(wc -l <"$work/guessed")" = 30 ] || fail "there are $(wc -l <"$work/guessed") behaviours"
while read -r file; do [ -f "$file" ] || fail "there is no $file"; done <"$work/guessed"

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

begin "the top level has only the listed files"
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

finish
