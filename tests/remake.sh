#!/bin/sh
# SPDX-License-Identifier: MIT
# After a change of pictures: examples/, and the journals of the present semantics in
# tests/journals, made again with their golden images. Each is run as a script into a new journal,
# without signatures. All are replaced, or none: every command, comment and word of a record must be
# unchanged, except for words of pictures (picture, spin, names) and the chain; a record may have
# more words.
#
#     remake.sh BUILD [NAME...]   the words of the examples with these names may differ; what does
#                                 is printed
set -u
cd "$(dirname "$0")/.." || exit 1
unset CI # a person decides here
iftty=$(cd "$1" && pwd)/iftty made=$1/remake
shift
may_differ=" $* "
present=$("$iftty" info | sed -n 's/^semantics //p')
rm -rf "$made" && mkdir -p "$made/examples" "$made/tests/journals" || exit 1

# Print all differences and the number of equal words; false if there is a difference.
compare() { # BEFORE NOW: without their first lines
    awk -v now="$2" -v name="$3" '
        BEGIN { split("chain picture spin names", list, " "); for (i in list) drawn[list[i]] = 1 }
        function differs(what) { print "# " name ": " what; bad = 1 }
        {
            if ((getline line <now) < 1) { differs("it ends before: " $0); exit }
            if (!/^= /) {
                if (index(line, $0) != 1) differs("\"" $0 "\" is now \"" line "\"")
                next
            }
            records++
            delete value
            count = split(line, word, " ")
            for (i = 3; i <= count; i++) {
                at = index(word[i], "=")
                value[substr(word[i], 1, at - 1)] = substr(word[i], at + 1)
            }
            for (i = 3; i <= NF; i++) {
                at = index($i, "=")
                key = substr($i, 1, at - 1)
                if (key in drawn) { anew += key != "chain" && value[key] != substr($i, at + 1) }
                else if (value[key] == substr($i, at + 1)) same++
                else differs("record " $2 ": " $i " is now " value[key])
            }
        }
        END {
            if (!bad && (getline line <now) > 0) differs("it goes on: " line)
            printf "# %s: %d records, %d words the same, %d of pictures anew\n",
                name, records, same, anew
            exit bad
        }' "$1"
}
remake() { # JOURNAL
    to=$made/$1
    mkdir -p "${to%.iftty}.golden"
    cp "${1%.iftty}.golden"/labels-* "${to%.iftty}.golden" 2>/dev/null
    sed '1d; /^#@ /d' "$1" >"$to.before"
    grep -v '^= ' "$to.before" >"$to.script"
    "$iftty" run "$to.script" --journal "$to" --out "$to.out" >"$to.log" 2>&1 ||
        { echo "$1 cannot be carried out:"; tail -n 3 "$to.log"; return 1; }
    sed 1d "$to" >"$to.now"
    compare "$to.before" "$to.now" "$1" && return
    name=${1##*/}
    case $may_differ in *" ${name%.iftty} "*) ;; *) return 1 ;; esac
}

examples/scenes.sh "$made/scenes" || exit 1
IFTTY_SCENES=/usr/share/mricron/templates:$(cd "$made/scenes" && pwd)
export IFTTY_SCENES
cp tests/journals/*.nii.gz tests/journals/*.c* "$made/tests/journals"
journals="$(ls examples/*.iftty tests/journals/*-"$present".iftty)" status=0
for journal in $journals; do
    remake "$journal" || status=1
done
[ $status = 0 ] || { echo "# nothing has changed"; exit 1; }
for journal in $journals; do
    cp "$made/$journal" "$journal"
    rm -rf "${journal%.iftty}.golden"
    cp -r "$made/${journal%.iftty}.golden" "${journal%.iftty}.golden"
done
for folder in examples tests/journals; do
    "$iftty" verify --strict "$folder" || status=1
done
exit $status
