#!/bin/sh
# SPDX-License-Identifier: MIT
# A strict verification fails on incomplete evidence, and is the default if CI is set; the line of a
# journal that passes lists the comparisons.
. "$(dirname "$0")/lib.sh"
make_scene s.nii 24 20 16
"$iftty" -c 'open s.nii; seed 2,3,4 1; seed 6,10,8 2 radius=1; run; size 40 30; view 30 20
    golden first; render; seed 20,10,8 3; run' --journal j.iftty >/dev/null || exit 1
header=$(head -n 1 j.iftty)

# weak WORDS JOURNAL: it passes as a rule, and fails, saying so, wherever verification is strict
weak() {
    expect 0 "$iftty" verify "$2"
    expect 0 "$iftty" verify --no-strict "$2"
    expect_out "not ok 1 - $2" 1 "$iftty" verify --strict "$2"
    out_has "# strict: $1"
    cp out strict
    expect 1 env CI=true "$iftty" verify "$2"
    same_files out strict
    expect 0 env CI=true "$iftty" verify --no-strict "$2"
    expect 0 env CI= "$iftty" verify "$2"
    expect 1 "$iftty" verify --strict --junit weak.xml "$2"
    grep -q "message=\"strict: " weak.xml || fail "the report gives no reason"
}
copy() { # NAME: the journal and its golden images under another name
    cp j.iftty "$1.iftty"
    cp -r j.golden "$1.golden"
}

begin "the line of a journal that passes lists the comparisons"
for how in "" --strict; do
    expect 0 "$iftty" verify $how j.iftty
    same "$(head -n 1 out)" \
        "ok 1 - j.iftty (10 commands, 10 results with 19 digests, 1 golden image of 1200 pixels)"
done
expect 0 "$iftty" verify --strict --json j.iftty
out_has '"commands": 10' '"results_the_same": 10' '"digests": 19' '"golden_images": 1' \
    '"pixels": 1200' "\"chain\": \"$(last_word chain j.iftty)\""
expect 2 "$iftty" verify --strict --no-strict j.iftty
err_has "--strict and --no-strict: give one of them"

begin "digests that were taken out, all or of one record, with the chain recomputed"
copy none
sed 's/^\(= [0-9]*\) .* chain=/\1 chain=/' j.iftty >before
chain_anew before none.iftty
expect 0 "$iftty" log --check none.iftty
weak "8 records without the digest that the command computes, the first is record 1 (line 2)" \
    none.iftty
copy one
rewrite one.iftty 10 'seeds=9'
weak "1 record without the digest that the command computes, the first is record 10" one.iftty
expect 0 "$iftty" log --reseal one.iftty
same "$(words_of one.iftty 10)" "$(words_of j.iftty 10)"
expect 0 "$iftty" verify --strict one.iftty

begin "no golden image, or no record at all"
"$iftty" -c 'open s.nii; seed 2,3,4 1; run' --journal plain.iftty >/dev/null
weak "no golden image was compared: " plain.iftty
expect 0 "$iftty" verify --strict --until 2 plain.iftty # a part is not asked for one
printf '%s\n' "$header" >header.iftty
weak "it has a header and no records" header.iftty
for bytes in 0 5 20; do
    head -c "$bytes" j.iftty >begun.iftty
    expect 1 "$iftty" verify --strict begun.iftty
done

begin "an unfinished record at the end"
copy torn
printf 'seed 1,1,1 1\n' >>torn.iftty
weak "it ends with an unfinished record, at byte $(file_bytes j.iftty)" torn.iftty
out_has "# an unfinished record at byte"

begin "a PNG that differs from its golden image always fails"
copy seen
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first' --journal o.iftty >/dev/null
cp o.golden/first.png seen.golden/first.png
bad_png() { # WORDS [NAME]
    for how in "" --no-strict "--expect $(last_word chain seen.iftty)"; do
        expect 1 "$iftty" verify $how seen.iftty
        out_has "golden ${2:-first}: seen.golden/${2:-first}.png: $1"
        out_has "; delete it, and \`golden\` draws it again"
    done
}
bad_png "it differs from its golden image in "
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 31; golden first' --journal p.iftty >/dev/null
cp p.golden/first.png seen.golden/first.png
bad_png "it has another size"
for bytes in 0 7 8 30 100 $(($(file_bytes j.golden/first.png) - 1)); do
    head -c "$bytes" j.golden/first.png >seen.golden/first.png
    expect_out ": seen.golden/first.png: it is " 1 "$iftty" verify seen.iftty
done
rm seen.golden/first.png # one that is not there shows nothing
expect 0 "$iftty" verify --strict seen.iftty

begin "a PNG with the right pixels, and other texts or chunks that change their display"
# put_chunk TYPE HEXADECIMAL [TYPE]: into the PNG, before the first chunk of that type (IDAT)
put_chunk() {
    "$PYTHON" - "$1" "$2" "${3:-IDAT}" <<'END'
import struct, sys, zlib
kind, data, before = sys.argv[1].encode(), bytes.fromhex(sys.argv[2]), sys.argv[3].encode()
png = open("j.golden/first.png", "rb").read()
at = png.index(before) - 4
chunk = struct.pack(">I", len(data)) + kind + data
chunk += struct.pack(">I", zlib.crc32(chunk[4:]))
open("seen.golden/first.png", "wb").write(png[:at] + chunk + png[at:])
END
}
hex() { printf "$1" | od -An -v -tx1 | tr -d ' \n'; }
put_chunk tEXt "$(hex 'Comment\0reviewed by Dr X, all well')"
bad_png "it has a text that its golden image lacks: Comment: reviewed by Dr X, all well"
put_chunk tEXt "$(hex 'iftty:scene\00000000000000000')"
bad_png "two texts in it have one name"
sed 's/iftty:scene-name/iftty:scene-file/' j.golden/first.png >seen.golden/first.png
bad_png "a checksum in it is wrong"
put_chunk iTXt "$(hex 'a\0\0\0\0\0b')"
bad_png "it has a text that its golden image lacks: a: b"
for part in tIME:07ea0101000000 gAMA:00000001 tRNS:000000000000 \
    acTL:0000000200000000 'eXIf:4d4d' iCCP:6100 bKGD:000000000000; do
    put_chunk "${part%%:*}" "${part#*:}"
    bad_png "it has a part ${part%%:*} that iftty does not write there"
done
put_chunk tEXt "$(hex 'Comment\0after')" IEND
bad_png "something follows its pixels"
cat j.golden/first.png s.nii >seen.golden/first.png
bad_png "something follows its pixels"
"$PYTHON" - <<'END' # the same pixels by another writer: every filter, two IDAT
import struct, zlib
png, at, rows = open("j.golden/first.png", "rb").read(), 8, b""
while at < len(png):
    length, kind = struct.unpack(">I4s", png[at:at + 8])
    rows += png[at + 8:at + 8 + length] if kind == b"IDAT" else b""
    at += length + 12
rows, wide, up = zlib.decompress(rows), 3 * 40, bytes(3 * 40)
def paeth(a, b, c):
    return min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
def guess(kind, row, up, i):
    a, b, c = row[i - 3] if i > 2 else 0, up[i], up[i - 3] if i > 2 else 0
    return (0, a, b, (a + b) // 2, paeth(a, b, c))[kind]
packed = b""
for y in range(30):
    line, row = rows[y * (wide + 1):(y + 1) * (wide + 1)], bytearray(wide)
    for i in range(wide):
        row[i] = (line[1 + i] + guess(line[0], row, up, i)) & 255
    packed += bytes([y % 5]) + bytes((row[i] - guess(y % 5, row, up, i)) & 255 for i in range(wide))
    up = row
def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
packed = zlib.compress(packed)
open("seen.golden/first.png", "wb").write(png[:33] + chunk(b"IDAT", packed[:99]) +
    chunk(b"IDAT", packed[99:]) + chunk(b"IEND", b""))
END
expect 0 "$iftty" verify seen.iftty

begin "a PNG that was deleted is drawn again by golden, and is right"
rm seen.golden/first.png
expect 0 "$iftty" -c 'undo 2; golden first' --journal seen.iftty
cmp -s seen.golden/first.png j.golden/first.png && fail "it says the chain of another record"
expect_out "2 golden images" 0 "$iftty" verify --strict seen.iftty
rm -r seen.*
copy seen

begin "a golden image and its PNG have the notes of the drawn one"
# note NAME VALUE: both files carry it, with the checksum of the PNG right
note() {
    "$PYTHON" - "$1" "$2" <<'END'
import re, struct, sys, zlib
name, value = sys.argv[1].encode(), sys.argv[2].encode()
exr = open("j.golden/first.exr", "rb").read()
former = re.search(name + b"\\0string\\0(....)", exr, re.S)
length = struct.unpack("<I", former.group(1))[0]
value = value.ljust(length, b".")[:length]
exr = exr[:former.end()] + value + exr[former.end() + length:]
open("seen.golden/first.exr", "wb").write(exr)
png = open("j.golden/first.png", "rb").read()
at = png.index(b"tEXt" + name + b"\0")
length = struct.unpack(">I", png[at - 4:at])[0]
chunk = b"tEXt" + name + b"\0" + value
assert len(chunk) == length + 4
png = png[:at] + chunk + struct.pack(">I", zlib.crc32(chunk)) + png[at + length + 8:]
open("seen.golden/first.png", "wb").write(png)
END
}
for name in iftty:scene-name iftty:scene iftty:view iftty:look iftty:chain Software; do
    note $name "all is well"
    expect_out "golden image first: its note $name is all " 1 "$iftty" verify seen.iftty
done
cp j.golden/first.* seen.golden
expect 0 "$iftty" verify seen.iftty
cp s.nii t.nii
expect 0 "$iftty" verify --strict --scene t.nii seen.iftty

begin "the PNG is over the background of its time, or has alpha; another background shows"
printf '%s\n' 'open s.nii' 'seed 2,3,4 1' run 'size 60 50' 'view 30 20' 'samples 4' 'golden grey' \
    'background white' 'golden page' 'background transparent' 'golden clear' \
    'decorate letters' 'golden named' 'background black' 'golden all of=mosaic' >script
expect 0 "$iftty" run script --journal ground.iftty
expect_out "5 golden images" 0 "$iftty" verify --strict ground.iftty
for other in grey clear; do
    rm -rf seen.golden
    cp -r ground.golden seen.golden
    cp ground.iftty seen.iftty
    cp ground.golden/page.png seen.golden/$other.png
    bad_png "it differs from its golden image" $other
done

begin "a recorded word that no command returns always fails"
copy word
rewrite word.iftty 4 "$(words_of j.iftty 4) flavour=sweet"
expect_out "differs  flavour" 1 "$iftty" verify --no-strict word.iftty

begin "a signature by ssh-keygen proves the file, --strict its pictures"
if needs ssh-keygen; then
    mkdir signing
    copy signing/ch2
    cp s.nii signing
    cd signing || exit 1
    ssh-keygen -q -t ed25519 -N '' -C anna -f key || fail "no key"
    ssh-keygen -q -t ed25519 -N '' -C ben -f ben || fail "no key"
    printf 'anna@example.org namespaces="iftty-journal" %s\n' "$(cat key.pub)" >allowed
    sed -n 's|~/.ssh/id_ed25519|key|; s/^ *\(ssh-keygen -Y \)/\1/p' "$top/journal/README.md" \
        >commands
    grep 'Y sign' commands >sign
    grep 'Y verify' commands >check
    same "$(wc -l <sign) $(wc -l <check)" "1 1"
    expect 0 sh sign
    expect 0 sh check
    expect 0 "$iftty" verify --strict ch2.iftty
    sed 's/^label/# a remark\n&/; s/^run$/# a remark\nrun/' ch2.iftty >before
    chain_anew before ch2.iftty # an honest forgery
    expect 0 "$iftty" verify --strict ch2.iftty
    expect 255 sh check
    cp ../j.iftty ch2.iftty
    expect 0 sh check
    cp ch2.golden/first.png ch2.golden/first.exr # which the signature does not cover
    expect 0 sh check
    expect 1 "$iftty" verify --strict ch2.iftty
    rm ch2.iftty.sig
    expect 0 sh -c "$(sed 's/ key / ben /' sign)" # a key that nobody allows
    expect 255 sh check
    cd "$work" || exit 1
fi

finish
