"""Functions that make a run safe against being killed."""
import ctypes
import os
import signal


def write_whole(path, text):
    """Writes a file atomically, so that it is complete or absent if the process is killed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(path.name + ".new")
    beside.write_text(text, encoding="utf-8")
    os.replace(beside, path)


def end_with_parent():
    """Sends SIGTERM to this process when its parent ends, even by kill -9. Otherwise a build would continue in a directory
    that the next run uses."""
    pr_set_pdeathsig = 1
    ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGTERM)
