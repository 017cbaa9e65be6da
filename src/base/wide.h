/* SPDX-License-Identifier: MIT */
/*
 * WIDE: several versions of a function, of which the one for the machine at hand is called. For
 * loops of integers, which come out the same in each.
 */
#ifndef BASE_WIDE_H
#define BASE_WIDE_H

#if defined __x86_64__ && defined __gnu_linux__ && !defined __clang__ &&                           \
    !defined __SANITIZE_ADDRESS__ && !defined __SANITIZE_THREAD__
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif

#endif
