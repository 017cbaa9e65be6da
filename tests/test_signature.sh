#!/bin/sh
# SPDX-License-Identifier: MIT
# Signatures: `log --sign` and `verify --allowed-signers`, by ssh-keygen and what it says.
. "$(dirname "$0")/lib.sh"
cd "$work" || exit 1
make_scene s.nii 24 20 16
"$iftty" -c 'open s.nii; seed 2,3,4 1; run; size 40 30; golden first' --journal j.iftty \
    >/dev/null || exit 1
can_sign() {
    needs ssh-keygen || return
    [ -e alice ] && return
    for who in alice bob; do
        ssh-keygen -q -t ed25519 -N '' -C "$who" -f "$who" || fail "no key"
    done
    printf 'alice@example.org namespaces="iftty-journal" %s\n' "$(cat alice.pub)" >allowed
}
# unsigned WORDS: verified as a rule, and not where a signature is asked for
unsigned() {
    expect 1 "$iftty" verify j.iftty --allowed-signers allowed
    out_has "not ok 1 - j.iftty"
    out_has "# $1"
    ! grep -q 'signed by' out || fail "$(cat out)"
}

begin "a signature says who, and covers every byte"
if can_sign; then
    unsigned "it is not signed: there is no j.iftty.sig, which iftty log --sign KEY makes"
    cp j.iftty kept
    expect 0 "$iftty" log --sign alice j.iftty
    out_has "# j.iftty.sig signs 5 records, chain $(last_word chain j.iftty)"
    same_files j.iftty kept
    expect 0 "$iftty" verify --strict j.iftty --allowed-signers allowed
    out_has "ok 1 - j.iftty"
    out_has "# signed by alice@example.org with ED25519 key $(ssh-keygen -lf alice.pub |
        cut -d ' ' -f 2)"
    expect 0 "$iftty" verify j.iftty --allowed-signers allowed --json
    out_has '"signed_by": "alice@example.org with ED25519 key SHA256:'
    # Without this program:
    ssh-keygen -Y verify -n iftty-journal -f allowed -I alice@example.org -s j.iftty.sig \
        <j.iftty >out 2>&1 || fail "$(cat out)"
    # Chains computed anew are not enough any more.
    sed 's/^label/# a remark\n&/; s/^run$/# a remark\nrun/' kept >before &&
        chain_anew before j.iftty
    expect 0 "$iftty" verify --strict j.iftty
    unsigned "its signature does not hold for alice@example.org: ssh-keygen: "
    cp kept j.iftty
    expect 0 "$iftty" -c 'label 1 liver' --journal j.iftty # continued
    unsigned "its signature does not hold"
    cp kept j.iftty
fi
close_story

begin "a signature by somebody else, for something else, or none"
if can_sign; then
    mv j.iftty.sig alices.sig
    expect 0 "$iftty" log --sign bob j.iftty
    unsigned "its signature is by nobody whom allowed names, or is none: ssh-keygen: "
    ssh-keygen -q -Y sign -n file -f alice <j.iftty >j.iftty.sig 2>/dev/null
    unsigned "its signature does not hold for alice@example.org"
    for bytes in 0 20 200; do
        head -c $bytes alices.sig >j.iftty.sig
        unsigned "its signature is by nobody whom allowed names, or is none"
    done
    head -c 5000 /dev/urandom >j.iftty.sig
    unsigned "its signature is by nobody whom allowed names, or is none"
    rm j.iftty.sig
    expect 3 "$iftty" verify j.iftty --allowed-signers nobody
    out_has "there is no file of allowed signers nobody"
fi
close_story

begin "of a signer that is a pattern nothing is known but the key"
if can_sign; then
    rm -f j.iftty.sig
    expect 0 "$iftty" log --sign alice j.iftty
    key="ED25519 key $(ssh-keygen -lf alice.pub | cut -d ' ' -f 2)"
    for pattern in '*' '*@example.org' 'alic?'; do
        { printf '# the staff, whoever ssh-ed25519 they are\n* namespaces="file" '; cat bob.pub
            printf '%s namespaces="a ssh-rsa b,iftty-journal" ' "$pattern"
            sed 's/alice$/Alice \o033[2J (home)/' alice.pub; } >wide
        expect 0 "$iftty" verify j.iftty --allowed-signers wide
        out_has "# signed by $key, Alice \\033[2J (home), one that wide has for $pattern"
        ! grep -q "signed by \*" out || fail "$(cat out)"
    done
    { printf '* '; sed 's/ alice$//' alice.pub; } >wide
    expect 0 "$iftty" verify j.iftty --allowed-signers wide
    out_has "# signed by $key, no comment, one that wide has for *"
fi
close_story

begin "a key that is revoked, by a list or by ssh-keygen's KRL"
if can_sign; then
    ssh-keygen -q -k -f krl alice.pub
    ssh-keygen -q -k -f others bob.pub
    cat bob.pub >list
    for revoked in others list; do
        expect 0 "$iftty" verify j.iftty --allowed-signers allowed --revoked $revoked
        out_has "# signed by alice@example.org with "
    done
    cat alice.pub >>list
    head -c 500 /dev/urandom >noise
    for revoked in krl list noise .; do
        expect 1 "$iftty" verify j.iftty --allowed-signers allowed --revoked $revoked
        out_has "not ok 1 - j.iftty"
        out_has "# its signature is by a key that $revoked revokes, or that is no list of keys"
        ! grep -q 'signed by' out || fail "$(cat out)"
    done
    expect 3 "$iftty" verify j.iftty --allowed-signers allowed --revoked nothing
    out_has "there is no file of revoked keys nothing"
    expect 2 "$iftty" verify j.iftty --revoked krl
    err_has "--allowed-signers FILE asks for signatures"
    cp j.iftty kept # revoked or not: what was changed is not called revoked
    "$iftty" -c 'label 1 liver' --journal j.iftty >/dev/null
    expect 1 "$iftty" verify j.iftty --allowed-signers allowed --revoked krl
    out_has "# its signature does not hold for alice@example.org"
    cp kept j.iftty
fi
close_story

begin "no signature says when: a key is judged as of now, or of a moment that the user knows"
if can_sign; then
    for times in 'valid-before="20200101Z"' 'valid-after="20200101Z"' \
        'valid-after="20150101Z",valid-before="20200101Z"'; do
        printf 'alice@example.org %s %s\n' "$times" "$(cat alice.pub)" >timed
        now=1 then=0
        [ "$times" != 'valid-after="20200101Z"' ] || now=0 then=1
        expect $now "$iftty" verify j.iftty --allowed-signers timed
        [ $now = 0 ] || out_has "key has expired: verify time"
        [ $now = 1 ] || out_has "# when, no signature says: the key was judged as of now"
        expect $then "$iftty" verify j.iftty --allowed-signers timed --signed-at 20190101Z
        [ $then = 0 ] || out_has "key is not yet valid: verify time"
        [ $then = 1 ] ||
            out_has "# when, no signature says: the key was judged as of 20190101Z"
        expect $then "$iftty" verify j.iftty --allowed-signers timed --signed-at 20190101120000Z
    done
    for wrong in 2019 20190101z now -1 201901011 '20190101Z;x' ''; do
        expect 2 "$iftty" verify j.iftty --allowed-signers timed --signed-at "$wrong"
    done
    expect 2 "$iftty" verify j.iftty --signed-at 20190101Z
    rm j.iftty.sig
fi
close_story

begin "a signature covers what is seen: golden images, their words and their PNGs"
if can_sign; then
    expect 0 "$iftty" log --sign alice j.iftty
    "$iftty" -c 'open s.nii; seed 9,9,4 2; run; size 40 30; golden first' --journal k.iftty \
        >/dev/null || fail "no other journal"
    cp -r j.golden kept.golden
    for other in exr png; do
        cp k.golden/first.$other j.golden
        expect 1 "$iftty" verify j.iftty --allowed-signers allowed
        out_has "golden first: "
        cp kept.golden/first.$other j.golden
    done
    sed 's/40x30 pixels/12x34 pixels/' kept.golden/first.exr >j.golden/first.exr
    expect 1 "$iftty" verify j.iftty --allowed-signers allowed
    out_has "golden image first: its note iftty:view is yaw 0 pitch 0 roll 0 degrees, "
    cp kept.golden/first.exr j.golden
    expect 0 "$iftty" verify j.iftty --allowed-signers allowed
    rm j.iftty.sig
fi
close_story

begin "a signature that is there stays, and a journal that is not sound is not signed"
if can_sign; then
    echo precious >j.iftty.sig
    expect 3 "$iftty" log --sign alice j.iftty
    same "$(cat j.iftty.sig)" precious
    rm j.iftty.sig
    sed 's/^seed 2,3,4/seed 2,3,5/' j.iftty >edited.iftty
    expect 1 "$iftty" log --sign alice edited.iftty
    err_has "only an intact journal is signed"
    printf 'seed 1,1,1 1\n' | cat j.iftty - >torn.iftty
    expect 1 "$iftty" log --sign alice torn.iftty
    echo 'open s.nii' >a-script
    expect 1 "$iftty" log --sign alice a-script
    err_has "this is a script, not a journal, and was not signed"
    expect 3 "$iftty" log --sign nobody j.iftty
    err_has "ssh-keygen could not sign with the key nobody; nothing was written"
    same "$(ls -A | grep -E 'sig|tmp')" "alices.sig"
fi
close_story

begin "names are words, whatever they hold: there is no shell"
if can_sign; then
    odd='a $(touch stolen); `touch stolen` -q.iftty'
    cp j.iftty "$odd"
    cp -r j.golden "${odd%.iftty}.golden"
    cp alice './-f $(touch stolen)'
    cp alice.pub './-f $(touch stolen).pub'
    expect 0 "$iftty" log --sign '-f $(touch stolen)' "$odd"
    printf '%s %s\n' '"-Y,`touch stolen`;$(touch"' "$(cat alice.pub)" >'allowed ; touch stolen'
    expect 0 "$iftty" verify "$odd" --allowed-signers 'allowed ; touch stolen'
    [ ! -e stolen ] || fail "a shell has carried it out"
fi
close_story

begin "where ssh-keygen is missing, it is said what to install"
mkdir bin
for how in "log --sign key" "verify --allowed-signers key"; do
    echo >key
    echo >j.iftty.sig
    [ "${how%% *}" = verify ] || rm j.iftty.sig
    # shellcheck disable=SC2086
    PATH=$work/bin expect 3 "$iftty" $how j.iftty
    cat out err >said
    grep -q "ssh-keygen, which makes and checks signatures, is not installed: .* openssh-client" \
        said || fail "$(cat said)"
done
close_story

finish
