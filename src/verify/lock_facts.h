/*
 * What a lock says of a journal (lock.h), read from its bytes and from its golden images; no
 * command is carried out. Of the goldens, the SHA-256 of each file that the journal names, and of
 * the PNG beside it.
 */
#ifndef VERIFY_LOCK_FACTS_H
#define VERIFY_LOCK_FACTS_H

#include "base/buf.h"
#include "base/err.h"

/* Adds the lines. A golden image that cannot be read has none. *torn is the byte from which on the
 * journal is an unfinished record, 0 for none. ERR_INPUT for a journal that is damaged, ERR_IO,
 * ERR_MEMORY. */
enum err lock_facts(struct buf *out, uint64_t *torn, const char *path, struct fault *fault);

/* The chain among these lines: 32 digits, not ended; NULL where there is none. */
const char *lock_facts_chain(const char *facts);

#endif
