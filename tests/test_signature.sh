#!/bin/sh
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
