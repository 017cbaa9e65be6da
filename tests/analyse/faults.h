/* SPDX-License-Identifier: MIT */
/* For analysers alone, which read one file at a time: what base/err.h promises of the functions
 * that fill a fault, that they return an error, and which. */
#ifndef ANALYSE_FAULTS_H
#define ANALYSE_FAULTS_H

#include "base/err.h"

#define fault_set(fault, code, ...)    ((fault_set)(fault, code, __VA_ARGS__), (code))
#define fault_prefix(fault, code, ...) ((fault_prefix)(fault, code, __VA_ARGS__), (code))
#define fault_errno(fault, what, path) ((fault_errno)(fault, what, path), ERR_IO)
#define fault_memory(fault, purpose)   ((fault_memory)(fault, purpose), ERR_MEMORY)

#endif
