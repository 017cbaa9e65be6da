# SPDX-License-Identifier: MIT
"""Programs that benchmarks run: what they print, and how a benchmark ends where one fails."""

import os
import subprocess
import sys


class Broken(Exception):
    """A program could not be run; the words are for the user."""


def run(command, folder="."):
    """The bytes that a program prints; Broken where it cannot be started, or fails."""
    try:
        done = subprocess.run(command, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True)
    except OSError as error:
        raise Broken("%s: %s" % (command[0], error.strerror)) from None
    if done.returncode:
        raise Broken("%s: %s" % (" ".join(command), done.stderr.decode(errors="replace").strip()))
    return done.stdout


def leave_by(main):
    """Ends the process: with 0 once main() is done, with 3 where a program is Broken."""
    try:
        main()
    except Broken as error:
        print("%s: %s" % (os.path.basename(sys.argv[0]), error), file=sys.stderr)
        sys.exit(3)
    sys.exit(0)
