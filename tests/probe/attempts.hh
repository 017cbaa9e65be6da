/* SPDX-License-Identifier: MIT */
/* What a decoder that a hostile file took over would try. The probes are the helpers themselves
 * with this in place of their libraries (Makefile): what confines them is the product's. */
#ifndef TESTS_PROBE_ATTEMPTS_HH
#define TESTS_PROBE_ATTEMPTS_HH

#include <string>

/* Tries all of it; the words are "N attempts, all refused" or those that were let through. By the
 * name of the file, something else: "memory" holds more and more, "spin" never ends. */
std::string attempts(const std::string &path, bool may_write, bool may_thread);

#endif
