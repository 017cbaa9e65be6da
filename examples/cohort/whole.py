# SPDX-License-Identifier: MIT
"""Files that are there as a whole or not at all, and after a power cut too."""
import os


def write_whole(path, data):
    draft = "%s.%d.part" % (path, os.getpid())
    try:
        with open(draft, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(draft, path)
    except OSError:
        if os.path.exists(draft):
            os.unlink(draft)
        raise
