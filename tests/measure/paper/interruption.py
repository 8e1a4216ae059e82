"""What lets a run be killed at any time."""
import ctypes
import os
import signal


def write_whole(path, text):
    """A file is there as a whole or not at all, whenever we are killed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(path.name + ".new")
    beside.write_text(text, encoding="utf-8")
    os.replace(beside, path)


def end_with_parent():
    """SIGTERM when the parent is gone, even by kill -9: else a build would go on in a directory that the next run wants."""
    pr_set_pdeathsig = 1
    ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGTERM)
