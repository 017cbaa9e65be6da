#!/bin/sh
# SPDX-License-Identifier: MIT
# Acts (src/command) read only parameters that their commands have in the table: another name would
# abort the program, on a path that few tests may take.
. "$(dirname "$0")/lib.sh"
cd "$top" || exit 1

# Print a line for each name that an act, or a function it calls, requests but its command lacks;
# then the number of requested names. The tree is at $1.
cat >"$work/asked.py" <<'END'
import glob, re, subprocess, sys
top = sys.argv[1]
words = r'(?:act|call)_(?:value|has|given|text|number|number_or|place|is_yes)'
asks = re.compile(r'\b' + words + r'\([^,()]*,\s*((?:"[^"]*"\s*)+)')
table = subprocess.run(['cc', '-E', '-P', '-I' + top + '/src', '-I' + top,
                        top + '/src/command/table.c'], capture_output=True, text=True).stdout
rows = list(re.finditer(r'\{\s*"([\w-]+)",\s*(?:NULL|\(\(void \*\)0\)|"[^"]*"),'
                        r'\s*(?:NULL|\(\(void \*\)0\)|"[^"]*"),\s*(act_\w+),', table))
has = {}  # of each act, the parameters of each command that it carries out
for i, row in enumerate(rows):
    end = rows[i + 1].start() if i + 1 < len(rows) else len(table)
    names = set(re.findall(r'\{\s*"([^"]+)",\s*VALUE_', table[row.end():end]))
    has.setdefault(row[2], []).append((row[1], names))
body, public = {}, {}  # functions, by file and name; those that other files know, by name
for path in glob.glob(top + '/src/command/*.c'):
    for f in re.finditer(r'^([a-z][^;{}#]*?)\b(\w+)\([^;{}]*\)\n\{\n(.*?)^\}', open(path).read(),
                         re.M | re.S):
        body[path, f[2]] = f[3]
        if not f[1].startswith('static'):
            public[f[2]] = (path, f[2])
def reached(key, seen):
    if key not in seen:
        seen.add(key)
        code = re.sub(r'"(?:[^"\\]|\\.)*"|/\*.*?\*/', '', body[key], flags=re.S)
        for name in set(re.findall(r'(?<!->)(?<!\.)\b[a-z]\w+\b', code)):
            to = (key[0], name) if (key[0], name) in body else public.get(name)
            if to:
                reached(to, seen)
    return seen
count = 0
for act, commands in sorted(has.items()):
    if act not in public:
        print(act + ' was not found')
        continue
    for key in reached(public[act], set()):
        for literal in asks.findall(body[key]):
            for name in ''.join(re.findall(r'"([^"]*)"', literal)).split('|'):
                count += 1
                for command, names in commands:
                    if name not in names:
                        print(f'{key[1]} asks for {name}, which `{command}` has not')
print(count, 'asked')
END

begin "acts request only parameters of their command"
found=$("$PYTHON" "$work/asked.py" "$top")
[ "$(echo "$found" | sed '$d')" = '' ] || fail "$found"
[ "$(echo "$found" | sed -n '$s/ asked//p')" -gt 200 ] || fail "$found"

begin "another parameter is found, also in a function that several acts call"
mkdir "$work/tree"
cp -r "$top/src" "$top/render" "$top/journal" "$work/tree"
sed -i 's/"replace"/"replaced"/' "$work/tree"/src/command/act*.c
sed -i 's/act_has(act, "around|through")/act_has(act, "around|thorough")/' \
    "$work/tree"/src/command/*.c
found=$("$PYTHON" "$work/asked.py" "$work/tree")
for line in "asks for replaced, which \`spin\` has not" \
    "asks for thorough, which \`seed\` has not"; do
    echo "$found" | grep -qF "$line" || fail "no $line in $found"
done

finish
