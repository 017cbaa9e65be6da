/* SPDX-License-Identifier: MIT */
/*
 * Signatures of journals: who vouches for one. Made and checked by OpenSSH's ssh-keygen, with the
 * keys that people have for it (or an agent, or a token), in the namespace "iftty-journal":
 *
 *     ssh-keygen -Y sign -n iftty-journal -f KEY <JOURNAL >JOURNAL.sig
 *     ssh-keygen -Y verify -n iftty-journal -f ALLOWED -I WHO [-r REVOKED] -s JOURNAL.sig <JOURNAL
 *
 * What is signed are the bytes of the journal, not a statement about it: anybody who has ssh-keygen
 * can check that without this program; there is no second form that two programs could read in two
 * ways; and the signature rests on SHA-512, where a statement of the last chain would rest on 128
 * bits of it, for which a signer with means could prepare two journals. The price is that a journal
 * which is continued needs another signature. Golden images are not signed: the journal names them,
 * and a replay proves them to the pixel, with their notes (command/golden_judge.h) and their PNGs
 * (evidence.h).
 *
 * A signature holds no time that anybody but the signer vouches for, so what is known of time is
 * what those know who verify. A key that ALLOWED has as valid-after or valid-before is judged as of
 * now, or as of the moment that they say; a key is revoked for good, whenever it signed.
 *
 * The program is found in PATH, and no shell is in between.
 */
#ifndef VERIFY_SIGNATURE_H
#define VERIFY_SIGNATURE_H

#include <stdbool.h>

#include "base/buf.h"
#include "base/err.h"
#include "base/watch.h"

#define SIGNATURE_NAMESPACE "iftty-journal"

/* Signs the bytes with the key in a file (a public one has an agent sign) and writes JOURNAL.sig,
 * which must not exist. Who has to type a passphrase is asked by ssh-keygen. ERR_IO. */
enum err signature_make(const char *journal, const struct buf *bytes, const char *key,
                        struct watch *watch, struct fault *fault);

struct signature_rules {
    const char *allowed;   /* the file of allowed signers (ssh-keygen(1)) */
    const char *revoked;   /* a KRL, or a list of public keys; NULL: none is revoked */
    const char *signed_at; /* the moment for which keys are judged; NULL: now */
};

/* OK, and who it was, where JOURNAL.sig is a signature of these bytes by somebody whom the rules
 * allow: "alice@example.org with ED25519 key SHA256:...", and of a pattern the key alone; safe to
 * print. ERR_CHECK where not; ERR_IO where that cannot be found out. */
enum err signature_check(struct buf *who, const char *journal, const struct buf *bytes,
                         const struct signature_rules *rules, struct watch *watch,
                         struct fault *fault);

/* Whether it is a moment as ssh-keygen has it: YYYYMMDD[HHMM[SS]][Z]. */
bool signature_is_time(const char *text);

#endif
