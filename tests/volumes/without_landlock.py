# SPDX-License-Identifier: MIT
"""Runs a command as on a kernel without Landlock: without_landlock.py COMMAND..."""
import ctypes
import os
import struct
import sys

CREATE_RULESET = 444  # on every processor
ENOSYS = 38
PR_SET_SECCOMP, PR_SET_NO_NEW_PRIVS, MODE_FILTER = 22, 38, 2
STEPS = [(0x20, 0, 0, 0),  # the number of the call
         (0x15, 0, 1, CREATE_RULESET),
         (0x06, 0, 0, 0x00050000 | ENOSYS),
         (0x06, 0, 0, 0x7FFF0000)]

libc = ctypes.CDLL(None, use_errno=True)
steps = ctypes.create_string_buffer(b"".join(struct.pack("=HBBI", *step) for step in STEPS))
program = ctypes.create_string_buffer(struct.pack("@HP", len(STEPS), ctypes.addressof(steps)))
if libc.prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) or \
        libc.prctl(PR_SET_SECCOMP, MODE_FILTER, program, 0, 0):
    sys.exit("no seccomp: %s" % os.strerror(ctypes.get_errno()))
os.execvp(sys.argv[1], sys.argv[1:])
