"""An interruptible build of a dataset, with its time."""
import contextlib
import json
import shutil
import subprocess
import tempfile
import time

from interruption import end_with_parent, write_whole


class DatasetBuild:
    """Builds NAME.toml into NAME.h5 in `folder`; NAME.clock holds the seconds of all parts so far, and by which workers.
    workers: number of local ones; None if they come from anywhere."""

    def __init__(self, folder, name, workers):
        folder.mkdir(parents=True, exist_ok=True)
        self.scene, self.dataset, self.clock = (folder / f"{name}{ending}" for ending in (".toml", ".h5", ".clock"))
        self.state, self.workers = folder / f"{name}.h5.state", workers

    def of(self, text):
        """Removes results of another scene."""
        if not self.scene.exists() or self.scene.read_text(encoding="utf-8") != text:
            self.begin_anew()
            write_whole(self.scene, text)

    def begin_anew(self):
        shutil.rmtree(self.state, ignore_errors=True)
        self.dataset.unlink(missing_ok=True)
        self.clock.unlink(missing_ok=True)

    def run(self, command):
        """Resumes the build, or starts from scratch if others began it: (exit code, output, seconds of all parts)."""
        before = self.seconds_before()
        self.note(before)
        began = time.monotonic()
        with (tempfile.TemporaryFile("w+") as words,
              subprocess.Popen(command, stdout=words, stderr=words, preexec_fn=end_with_parent) as build):
            code = None
            while code is None:  # if this run is killed, its time so far is known to 2 s
                with contextlib.suppress(subprocess.TimeoutExpired):
                    code = build.wait(2)
                self.note(seconds := before + time.monotonic() - began)
            words.seek(0)
            return code, words.read().strip(), seconds

    def seconds_before(self):
        """Seconds of the parts whose results still exist."""
        with contextlib.suppress(OSError, ValueError, KeyError):
            noted = json.loads(self.clock.read_text(encoding="ascii"))
            if noted["jobs"] == self.workers and self.state.is_dir():
                return noted["seconds"]
        self.begin_anew()
        return 0.0

    def note(self, seconds):
        write_whole(self.clock, json.dumps({"seconds": seconds, "jobs": self.workers}))
