"""Functions that allow killing a run at any time."""
import ctypes
import os
import signal


def write_whole(path, text):
    """Writes a file completely or not at all, even if this process is killed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(path.name + ".new")
    beside.write_text(text, encoding="utf-8")
    os.replace(beside, path)


def end_with_parent():
    """Requests SIGTERM when the parent ends, even by kill -9: otherwise a build would continue in a directory that the
    next run needs."""
    pr_set_pdeathsig = 1
    ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGTERM)
