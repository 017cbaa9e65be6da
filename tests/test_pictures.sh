#!/bin/sh
# SPDX-License-Identifier: MIT
# Pictures in every format, as other programs see them: exrheader, oiiotool and idiff must agree
# with us about channels, sizes, notes and pixels. And `iftty info`, which reads them back.
. "$(dirname "$0")/lib.sh"

begin "pictures as other programs see them"
needs exrheader oiiotool idiff || finish

make_scene s.nii 24 20 16
heic='' fits='' # in Debian 13 OpenImageIO does not write HEIC, and oiiotool aborts on its own FITS
by_oiiotool() { # FORMAT, read by a second process: of those that write first, some do not abort
    oiiotool --create 16x16 3 -d uint8 -o "$1" >t 2>&1 && oiiotool "$1" --ch 0,1,2 -o t.tif >t 2>&1
}
# To start oiiotool takes 0.3 s of the processor: one process compares many pictures.
compared() { # STATUS OPTION...: the status of oiiotool, whose --diff fails
    status=$1
    shift
    oiiotool "$@" >out 2>&1
    same "$? ($(sed 5q out))" "$status ($(sed 5q out))"
}
by_oiiotool t.heic && heic=heic
by_oiiotool t.fits && fits=fits
[ "$heic" ] || echo "# oiiotool does not write HEIC here: not compared"
[ "$fits" ] || echo "# oiiotool does not read its own FITS here: not compared"
formats="png tif tiff bmp tga ppm sgi iff rla dpx fits ico jp2 gif jpg webp hdr $heic"
{
    # Pale colours: formats with loss have half as many pixels for hues.
    printf '%s\n' 'open s.nii' 'label 1 ball #d6b296' 'label 2 rod #a0b4c8' \
        'seed 6,10,8 1' 'seed 20,10,8 2' 'seed 2,3,4 0' run 'background black' 'size 150 110' \
        'zoom 4' 'view 30 20' \
        'shade cubes' 'render lines.exr' 'render tiled.exr layout=tiled' # few colours, as GIF has
    for format in $formats; do echo "render a.$format"; done
} >script
"$iftty" run script --journal session.iftty >out 2>err || { cat err; echo "Bail out!"; exit 1; }
scene=$("$iftty" -c 'open s.nii; info' | sed -n 's/.*digest //p')

# The value of one attribute, as exrheader prints it: attribute FILE NAME
attribute() {
    exrheader "$1" | sed -n "s/^$2 (type string): \"\(.*\)\"\$/\1/p"
}
# The same out of what `iftty info` printed, and `oiiotool --info -v`: note TEXT NAME
note() {
    sed -n "s/^\(notes\)\{0,1\} *$2: //p" "$1"
}
oiio_note() { # as an attribute of its own, or a line of a description
    { tr '"' '\n' <"$1" | sed -n "/^ *$2: /{s///;p;q;}"
      sed -n "/^ *$2: \"\{0,1\}/{s///;s/\"\$//;p;q;}" "$1"; } | sed -n '/./{p;q;}'
}

begin "exrheader sees our channels, sizes, layouts and notes"
exrheader lines.exr >lines.txt
exrheader tiled.exr >tiled.txt
for name in A B G R; do
    grep -q "^    $name, 16-bit floating-point, sampling 1 1" lines.txt || fail "no channel $name"
done
for name in Z depth; do
    grep -q "^    $name, 32-bit floating-point, sampling 1 1" lines.txt || fail "no channel $name"
done
for name in label voxel; do
    grep -q "^    $name, 32-bit unsigned integer, sampling 1 1" lines.txt || fail "no channel $name"
done
for text in lines.txt tiled.txt; do
    grep -q '^dataWindow (type box2i): (0 0) - (149 109)' $text || fail "data window: $(cat $text)"
    grep -q '^displayWindow (type box2i): (0 0) - (149 109)' $text || fail "display window"
    grep -q '^compression .*: zip' $text || fail "compression"
done
! grep -q '^tiles' lines.txt || fail "lines.exr has tiles"
grep -q 'tile size 64 by 64 pixels' tiled.txt || fail "tiled.exr has no tiles"
same "$(sed -n '/^channels/,/^compression/p' lines.txt)" \
    "$(sed -n '/^channels/,/^compression/p' tiled.txt)"
for name in N.X N.Y N.Z; do
    grep -q "^    $name, 32-bit floating-point, sampling 1 1" lines.txt || fail "no channel $name"
done
same "$(attribute lines.exr iftty:scene)" "$scene"
same "$(attribute lines.exr iftty:scene-name)" s.nii
same "$(attribute lines.exr iftty:journal)" session.iftty
same "$(attribute tiled.exr iftty:journal)" session.iftty
same "$(attribute lines.exr Software)" "$("$iftty" --version | sed 1q)"
[ -n "$(attribute lines.exr iftty:chain)" ] || fail "no chain"

begin "no folder's name is in a picture, and under private=yes not even the file's or the journal's"
mkdir -p Smith_John
cp s.nii Smith_John/scan.nii
for private in "" " private=yes"; do
    rm -rf study.* private-*
    printf '%s\n' "open Smith_John/scan.nii$private" 'label 1 liver' 'seed 2,3,4 1' run \
        'size 60 50' 'render private-a.exr' 'render private-a.png' 'render private-a.tif' \
        'slice axial 2 private-s.png' 'mosaic private-m.png' 'spin 2 private-t.gif' \
        'golden private' 'save labels private-l.nii' 'save labels private-l.nrrd' \
        'save surface private-s.stl label=1' 'save surface private-s.ply label=1' \
        'stats report=private-r.json' 'compare private-l.nii picture=private-c.png' >private-script
    expect 0 "$iftty" run private-script --journal study.iftty
    rm private-script
    ! grep -ral Smith_John private-* study.golden || fail "a folder's name travels"
    names=$(grep -al 'scan.nii\|study.iftty' private-* study.golden/* | wc -l)
    [ "$names" = "$([ "$private" ] && echo 0 || echo 8)" ] || fail "$names files with a name"
    expect 0 "$iftty" verify --strict study.iftty
    cp study.iftty elsewhere.iftty
    cp -r study.golden elsewhere.golden
    expect 0 "$iftty" verify --strict elsewhere.iftty --scene s.nii # by another name
    rm -r elsewhere.*
done
same "$(sed -n 2p study.iftty)" "open Smith_John/scan.nii private=yes weight=morph"

# A helper that forks while threads of its library start hangs once in thirty times.
begin "dozens of openings, eight at once: every helper answers, with the size"
: >bad
ls a.* lines.exr tiled.exr >names
for column in 1 2 3 4 5 6 7 8; do
    for file in $(sed -n "$column~8p" names) $(sed -n "${column}p" names); do
        timeout 60 "$iftty" info $file >"$file.info" 2>&1 && grep -q '^pixels *150x110$' \
            "$file.info" || cat "$file.info" >>bad
    done &
done
wait
same "$(cat bad)" ""
[ "$(wc -l <names)" -ge 18 ] || fail "only $(cat names)"

begin "info prints the same as exrheader and oiiotool"
oiiotool --info -v lines.exr tiled.exr a.png a.tif a.jpg |
    awk '/^[^ ]+ +: +[0-9]+ x/ { name = $1 } name { print > ("theirs-" name) }'
for file in lines.exr tiled.exr a.png a.tif a.jpg; do
    cp $file.info out
    for name in Software iftty:scene-name iftty:scene iftty:view iftty:look \
        iftty:journal iftty:chain; do
        [ -n "$(note out $name)" ] || fail "$file: no $name"
        same "$file $name $(note out $name)" "$file $name $(oiio_note theirs-$file $name)"
    done
    same "$(note out iftty:scene)" "$scene"
done
same "$(note tiled.exr.info iftty:view)" "$(attribute tiled.exr iftty:view)"
same "$(sed -n 's/^format *//p' tiled.exr.info)" "openexr, tiled"
rm ./*.info

begin "tiles and lines hold the same pixels, in every channel"
expect 0 idiff -q lines.exr tiled.exr

begin "the OpenEXR file has the colours of the PNG"
# Back from linear light: not one level off.
compared 0 lines.exr --ch R,G,B,A,Z -o flat-lines.exr tiled.exr --ch R,G,B,A,Z -o flat-tiled.exr \
    lines.exr --ch R,G,B --colorconvert linear sRGB -d uint8 -o levels.ppm a.png -o a-png.ppm
same_files levels.ppm a-png.ppm

begin "other programs see a white background, and none behind a transparent picture"
{
    sed '/^render/d' script
    printf '%s\n' 'samples 2' 'background white' 'render white.png' 'background transparent' \
        'render clear.png' 'render clear.tif' 'render clear.exr' 'background #808080' \
        'render grey.png'
} >backgrounds
expect 0 "$iftty" run backgrounds
compared 0 --info clear.exr --ch A -d uint8 -o exr.ppm clear.png --ch A -d uint8 -o png.ppm \
    clear.tif --ch A -d uint8 -o tif.ppm white.png --cut 1x1+0+0 --printstats \
    clear.png --printstats clear.exr --ch Z --printstats
same "$(grep -o '^clear.*4 channel' out | sort -u | wc -l)" 2
! grep -q 'Stats Min: -' out || fail "what is seen lies behind the camera: $(grep Min out)"
same_files png.ppm exr.ppm
same_files tif.ppm exr.ppm
out_has 'Constant Color: 1.000000 1.000000 1.000000'
grep -q 'Min: *[0-9]* [0-9]* [0-9]* 0 ' out || fail "no pixel is clear"

begin "decorations change only colours, and the picture records them"
{
    sed '/^render/d' script
    printf '%s\n' 'render plain.exr' 'decorate letters scale legend' 'render over.exr' \
        'render over.png' 'golden over'
} >decorations
expect 0 "$iftty" run decorations --journal over.iftty
compared 0 plain.exr --ch Z,label,voxel,N.X over.exr --ch Z,label,voxel,N.X --diff
compared 1 plain.exr --ch R,G,B over.exr --ch R,G,B --diff # something is drawn
expect_out 'decorate letters scale legend' 0 "$iftty" info over.png
expect 0 "$iftty" verify over.iftty

begin "a compositor that knows OpenEXR puts our picture over its own, and finds it in the world"
# Edges too, up to the difference between the mean of sRGB values and the mean of light.
compared 0 --fail 0.04 --warn 1 clear.exr --ch R,G,B,A --create 150x110 4 \
    --fill:color=0.21586,0.21586,0.21586,1 150x110+0+0 --over --ch R,G,B \
    --colorconvert linear sRGB grey.png --diff
expect 0 "$iftty" -c 'open synth:geom:20x20x20; seed 9,9,9 1; run; label 1 core; render placed.exr'
exrheader placed.exr >placed.txt
for name in worldToCamera worldToNDC; do
    grep -q "^$name (type m44f)" placed.txt || fail "no $name: $(cat placed.txt)"
done
same "$(attribute placed.exr iftty:alpha)" associated
same "$(attribute placed.exr iftty:labels)" '{"1": {"name": "core", "colour": "#fc961e"}}'

begin "formats without loss agree with the PNG, pixel for pixel"
lossless="tif tiff bmp tga ppm sgi iff rla dpx $fits ico jp2"
set --
for format in $lossless; do
    set -- "$@" a.$format --ch 0,1,2 --chnames R,G,B -d uint8 -o back-$format.ppm
done
compared 0 "$@"
for format in $lossless; do same_files back-$format.ppm a-png.ppm; done

begin "formats with loss come near it"
set --
for format in jpg webp $heic gif; do set -- "$@" a.$format --ch R,G,B a.png --diff; done
compared 0 --fail 0.01 --warn 1 a.hdr --colorconvert linear sRGB a.png --diff \
    --fail 0.1 --failpercent 2 --hardfail 0.4 "$@"

begin "every extension is written whole, or refused in one line with no file left"
mkdir every
extensions="$(oiiotool --list-formats | sed -n 's/^ .* : //p' | tr -d ',') EXR PNG xyz"
{
    printf '%s\n' 'open s.nii' 'size 150 110' 'seed 6,10,8 1' run
    for format in $extensions; do echo "render every/a.$format"; done
} >all
expect 3 "$iftty" run all --keep-going
for format in $extensions; do
    written=$(grep -c "^    wrote every/a\.$format\$" out)
    refused=$(grep -c "^all:[0-9]*: cannot write every/a\.$format: ." err)
    same "$format $((written + refused))" "$format 1"
    if [ "$written" = 1 ]; then
        [ -s "every/a.$format" ] || fail "$format: no file"
    else
        [ ! -e "every/a.$format" ] || fail "$format: a file, although refused"
    fi
done
same "$(wc -l <err)" "$(grep -c '^all:[0-9]*: cannot write' err)"
same "$(ls -A every | wc -l)" "$(grep -c '^    wrote' out)"
[ "$(ls every | wc -l)" -gt 35 ] || fail "only $(ls every)"
same "$(oiiotool --info every/* 2>&1 | grep -c ' : *150 x  *110, ')" "$(ls every | wc -l)"

begin "the same picture has the same bytes on any date"
mkdir again
cp -p a.* lines.exr tiled.exr again/
rm -f a.* lines.exr tiled.exr session.iftty
until [ "$(date +%s)" -gt "$(stat -c %Y again/tiled.exr)" ]; do sleep 0.1; done
expect 0 "$iftty" run script --journal session.iftty
for file in a.* lines.exr tiled.exr; do
    case $file in
    *.dpx | *.rla) ;; # these have the name they were begun under in their header
    *) same_files $file again/$file ;;
    esac
done

begin "info tells scenes and journals, as text and as JSON"
expect 0 "$iftty" info s.nii
same "$(sed -n 's/^voxels *//p' out)" 24x20x16
out_has "uint8"
expect_out "iftty journal" 0 "$iftty" info session.iftty
same "$(sed -n 's/^records *//p' out)" "$(grep -c '^= ' session.iftty)"
for file in s.nii session.iftty lines.exr a.png a.tif a.gif; do
    expect 0 "$iftty" info $file --json
    same "$(wc -l <out)" 1
    "$PYTHON" -c 'import json, sys; json.load(sys.stdin)' <out 2>err ||
        fail "$file: $(cat out err)"
done
"$iftty" info a.tif --json >out
out_has "\"iftty:scene\": \"$scene\""
expect 0 "$iftty" -c 'open s.nii; seed 3,3,3 1; save root root.nii.gz' # of other types too
expect_out "uint32" 0 "$iftty" info root.nii.gz
answers "ok 1 open root.nii.gz" 'open root.nii.gz'
flip_byte session.iftty 300
expect 1 "$iftty" info session.iftty

begin "info rejects files that are no picture or half a picture, and prints no escape sequences"
printf 'P6 nothing' >no.png
head -c 900 a.png >half.png
head -c 2000 lines.exr >half.exr
mkdir folder.png
mkfifo pipe.png
for file in no.png half.png half.exr folder.png pipe.png missing.png script; do
    expect 3 "$iftty" info $file
    same "$file $(wc -l <err) $(wc -c <out)" "$file 1 0"
done
expect 2 "$iftty" info a b
oiiotool a.png --attrib note "$(printf 'red \033[31m "quoted" \\ text')" -o odd.png
expect 0 "$iftty" info odd.png
! grep -q "$(printf '\033')" out || fail "an escape sequence came through"
out_has '\x1b[31m'
expect 0 "$iftty" info odd.png --json
! grep -q "$(printf '\033')" out || fail "an escape sequence came through"
out_has 'red \u001b[31m \"quoted\" \\ text'

begin "pictures of other programs are described too"
oiiotool lines.exr --ch R,G,B -d float --compression piz -o other.exr \
    a.png a.png --siappend -d uint8 -o two.tif
expect_out "R G B float" 0 "$iftty" info other.exr
expect 0 "$iftty" info two.tif
same "$(sed -n 's/^frames *//p' out)" 2

finish
