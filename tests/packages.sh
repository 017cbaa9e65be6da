#!/bin/sh
# SPDX-License-Identifier: MIT
# The packages of `make deb` on a bare Debian 12: apt installs them with their dependencies, and
# their own test runs (debian/tests/demo), as root and as a user. After their removal no file of
# them is left. Finally autopkgtest repeats the first two steps.
#
#     packages.sh DEBS [FOLDER]   make the machine again in FOLDER, or in build/bare-deb
#     KEEP=yes                    keep it afterwards
#
# Requires root. Prints TAP.
debs=$1 folder=${2:-build/bare-deb}
cd "$(dirname "$0")/.." || exit 1
. tests/machine.sh
own_mounts tests/packages.sh "$@"
. tests/lib.sh
cd "$top" || exit 1
mkdir -p "$folder" && folder=$(cd "$folder" && pwd) || exit 1
trap 'clear_up; rm -rf "$work"' EXIT
# there USER COMMAND: it succeeds
there() {
    inside "$1" "$2" >"$work/out" 2>"$work/err" ||
        fail "$1: $2" "$(tail -n 5 "$work/out" "$work/err")"
}
apt="DEBIAN_FRONTEND=noninteractive apt-get -q -y -o Dpkg::Use-Pty=0"
files() { # below /usr and /etc, but for what others make anew whenever packages come or go
    inside root 'find /usr /etc ! -name "*cache*" ! -type d' | LC_ALL=C sort
}

make_machine "$folder" man-db,ca-certificates # both are what others recommend, and would stay
mkdir "$root/debs"
cp -R "$debs"/*.deb .package/debian/tests "$root/debs"
there root "useradd -m somebody && apt-get -q update"
files >"$work/before"
packages=$(cd "$debs" && ls *.deb | sed 's/_.*//' | grep -v dbgsym | LC_ALL=C sort)

begin "apt installs them with their dependencies"
same "$(echo $packages)" "iftty iftty-doc iftty-image iftty-volume"
there root "$apt install --no-install-recommends /debs/iftty_*.deb"
there somebody "iftty --version"
same "$(sed 1q "$work/out")" "iftty $(.package/version)"
there somebody "iftty info /debs/tests/control 2>&1 | grep 'the package iftty-'"
there root "$apt install $(printf '/debs/%s_*.deb ' $packages) mricron-data"

begin "their own test passes, as root and as a user"
for user in root somebody; do
    there $user "sh /debs/tests/demo"
    out_has "# 2 verified, 0 failed" "# 1 verified, 0 failed"
done

begin "the manual, completions and papers are where Debian has them"
there somebody "man -w iftty iftty-verify iftty-journal"
same "$(grep -c '^/usr/share/man/man[15]/iftty' "$work/out")" 3
there somebody "man iftty-journal"
out_has "THE SCENE"
there somebody "cd /usr/share && ls bash-completion/completions/iftty zsh/vendor-completions/_iftty
    cd /usr/share/doc/iftty && ls README.md.gz FORMAT.md.gz PROMISES.md.gz SECURITY.md changelog.gz"

begin "removed packages leave nothing"
there root "$apt purge $(echo $packages) mricron-data"
there root "$apt autoremove --purge"
files >"$work/after"
LC_ALL=C comm -13 "$work/before" "$work/after" >"$work/left"
[ ! -s "$work/left" ] || fail "left:" "$(sed 9q "$work/left")"
LC_ALL=C comm -23 "$work/before" "$work/after" >"$work/lost"
[ ! -s "$work/lost" ] || fail "lost:" "$(sed 9q "$work/lost")"
[ "$(wc -l <"$work/before")" -gt 1000 ] || fail "few files: $(wc -l <"$work/before")"
there root 'find / -xdev -name "*iftty*" ! -path "/debs/*" ! -path "/proc/*"'
same "$(cat "$work/out")" ""

begin "autopkgtest installs them again, and runs their test"
mkdir "$work/tree" && cp -R .package/debian "$work/tree/debian"
dpkg-deb --fsys-tarfile "$debs"/iftty_*.deb |
    tar -xO ./usr/share/doc/iftty/changelog.Debian.gz | gunzip >"$work/tree/debian/changelog"
mount -t proc proc "$root/proc"
expect 0 autopkgtest -B $(printf "$debs/%s_*.deb " $packages) "$work/tree/" -- chroot "$root"
out_has "demo                 PASS"

finish
