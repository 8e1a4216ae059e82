"""The results of an evaluation: every number with its command, machine and commit.

A *measurement* is the JSON of one command or function, kept in FOLDER/measurements under a hash of its inputs. An
interrupted run finds it there and continues. A *number* is a value for the reader."""
import concurrent.futures
import contextlib
import datetime
import hashlib
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import time

from dataset_build import DatasetBuild
from interruption import end_with_parent, write_whole

ROOT = pathlib.Path(__file__).resolve().parents[3]
ALL = "all"  # marks a target that was not made at all, in what is not measured
BUILD_THEM = "build the targets all and benchmarks (docs/internals/benchmarks.md)"


class Incomplete(Exception):
    """Data for a table or figure are missing: it is not made, and the run says why."""


class NotMeasured(Exception):
    """A peer, package, program or mesh is missing, or there is no time: its column says so, and the rest is made."""


def machine():
    text = pathlib.Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    model = re.search(r"^model name\s*: (.*)$", text, re.M)
    memory = re.search(r"^MemTotal:\s*(\d+)", pathlib.Path("/proc/meminfo").read_text(encoding="ascii"), re.M)
    return {"processor": model[1] if model else platform.machine(), "cores": len(os.sched_getaffinity(0)),
            "memory_GB": round(int(memory[1]) / 1e6, 1) if memory else None, "system": platform.platform()}


def commit():
    """The commit of the sources, with a + if they have changed since."""
    try:
        git = lambda *words: subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True, check=True).stdout.strip()
        return git("rev-parse", "--short=12", "HEAD") + ("+" if git("status", "--porcelain", "-uno") else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown: the sources are not in a git repository"


def commit_of(programs):
    """The commit of the programs according to `palpate --version`."""
    try:
        said = subprocess.run([programs / "palpate", "--version"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return "unknown: palpate does not exist"
    return (re.search(r"^commit (.*)$", said, re.M) or ["", "unknown"])[1]


class Record:
    """folder: where everything is kept. programs: build/release, with bin and bench in it. quick: the smallest set that
    shows every table and figure. jobs: local workers; with `listen`, an address, workers from anywhere instead. nodes and
    laws: approximate organ sizes and words of organs.LAWS, for targets with several. random_paths: number in a survey.
    hours: no measurement begins after that time."""

    def __init__(self, folder, programs=ROOT / "build" / "release", quick=False, jobs=2, listen=None, nodes=(500, 2000),
                 laws=("mr", "msvk", "svk"), random_paths=200, hours=float("inf"), say=print):
        self.folder = pathlib.Path(folder).resolve()
        self.programs, self.bench = pathlib.Path(programs).resolve() / "bin", pathlib.Path(programs).resolve() / "bench"
        self.quick, self.jobs, self.listen, self.say = quick, jobs, listen, say
        self.nodes, self.laws = (500,) if quick else tuple(nodes), tuple(laws)
        self.random_paths = random_paths
        self.ends = time.monotonic() + 3600 * hours
        self.machine, self.commit = machine(), f"{commit()}, programs of {commit_of(self.programs)}"
        self.target = None
        self.numbers, self.missing, self.sources = {}, {}, {}

    # Measurements

    def measure(self, name, make, *depends, command=""):
        """The value of make(), in JSON types, or that of an earlier run with the same `depends`."""
        key = hashlib.sha256(json.dumps([name, *map(str, depends)]).encode()).hexdigest()[:16]
        path = self.folder / "measurements" / f"{re.sub(r'[^a-z0-9.-]+', '-', name.lower())}-{key}.json"
        with contextlib.suppress(OSError, ValueError, KeyError):
            kept = json.loads(path.read_text(encoding="utf-8"))
            return self.used(Measured(kept["value"], kept["command"], kept["machine"], kept["commit"], kept["at"]))
        if time.monotonic() >= self.ends:
            raise NotMeasured(f"{name} was not begun in the hours that were given")
        self.say(f"    {name} ...")
        began = time.monotonic()
        value = json.loads(json.dumps(make()))  # in the form that a later run reads
        made = {"name": name, "command": command, "machine": self.machine, "commit": self.commit,
                "at": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
                "seconds": round(time.monotonic() - began, 3), "value": value}
        write_whole(path, json.dumps(made))
        return self.used(Measured(value, command, made["machine"], made["commit"], made["at"]))

    def used(self, measured):
        """Records the sources of a target's measurements; a target that was continued elsewhere has several."""
        self.sources.setdefault(self.target, {})[f"{measured.machine['processor']}, {measured.commit}"] = None
        return measured

    def run(self, name, command, text=None, lines=False, codes=(0,), depends=()):
        """Measures a command that prints one JSON object, or with `lines` one per line."""
        words = [str(word) for word in command]

        def make():
            try:
                done = subprocess.run(words, input=text, capture_output=True, text=True, check=False, cwd=self.folder,
                                      preexec_fn=end_with_parent)
            except FileNotFoundError as missing:
                raise NotMeasured(f"there is no {self.shown(words[:1])}: {BUILD_THEM}") from missing
            if done.returncode not in codes:
                raise Incomplete(f"{self.shown(words)} ended with {done.returncode}: {done.stderr.strip()[-1000:]}")
            return [json.loads(line) for line in done.stdout.splitlines() if line] if lines else json.loads(done.stdout)

        self.folder.mkdir(parents=True, exist_ok=True)
        inputs = [content(pathlib.Path(word)) for word in words[1:]]
        read = hashlib.sha256((text or "").encode()).hexdigest()
        return self.measure(name, make, words, inputs, read, *depends, command=self.shown(words) + self.reading(read, text))

    def reading(self, name, text):
        """The end of a command that reads `text`: the file that holds it, so that anybody can repeat the command."""
        if text is None:
            return ""
        file = self.folder / "inputs" / f"{name[:16]}.txt"
        if not file.exists():
            write_whole(file, text)
        return f" < {self.shown([file])}"

    def together(self, measurements):
        """The results of these functions in order, run in parallel by as many threads as there are local workers. Not for
        timed measurements. If one fails, or the run is interrupted, the rest is not started."""
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            begun = [pool.submit(measure) for measure in measurements]
            try:
                return [one.result() for one in begun]
            finally:
                pool.shutdown(wait=True, cancel_futures=True)

    def scene(self, name, text):
        """Writes a scene file with this text, for commands that read one."""
        path = self.folder / "scenes" / f"{name}.toml"
        write_whole(path, text)
        return path

    def dataset(self, name, scene, jobs=None):
        """Builds `scene` (text of a scene file) and measures the time: {dataset, seconds, bytes, jobs (None: workers from
        anywhere), points by tag}. An interrupted build is resumed, and its time is the sum of its parts; a build begun
        with other workers or another scene starts from scratch."""
        jobs = jobs or self.jobs
        build = DatasetBuild(self.folder / "datasets", name, None if self.listen else jobs)
        build.of(scene)
        command = [str(self.programs / "palpate"), "build", str(build.scene), "-o", str(build.dataset), "-j", str(jobs), "-q"]
        if self.listen:
            command[1:2], command[-3:-1] = ["serve"], ["--listen", self.listen, "--state", str(build.state)]

        def make():
            code, said, seconds = build.run(command)
            if code not in (0, 3):  # 3: complete, with failed points
                raise Incomplete(f"{self.shown(command)} ended with {code}: {said[-1000:]}")
            spaces = json.loads(subprocess.run([self.programs / "palpate", "status", build.state, "--json"],
                                               capture_output=True, text=True, check=True).stdout)["spaces"]
            return {"dataset": str(build.dataset), "seconds": seconds, "bytes": build.dataset.stat().st_size, "jobs": build.workers,
                    "points": {tag: sum(space[tag] for space in spaces)
                               for tag in ("points", "expandable", "terminating", "failed", "unknown")}}

        made = self.measure(f"build {name}", make, scene, content_of_mesh(build.scene), build.workers, command=self.shown(command))
        if not build.dataset.exists():  # the measurement exists, but its dataset was removed
            raise Incomplete(f"{build.dataset} is gone; remove {self.folder}/measurements/build-{name}-*.json to build it again")
        return made

    def shown(self, words):
        """The command as typed in the root of the sources."""
        return " ".join(os.path.relpath(word, ROOT) if str(word).startswith("/") and str(word).startswith(str(ROOT)) else str(word) for word in words)

    # Numbers for the reader

    def number(self, name, value, unit, measured):
        """One number of a table or figure, with its source measurement."""
        value = value.item() if hasattr(value, "item") else value  # of numpy
        self.numbers[f"{self.target}/{name}"] = {"value": value, "unit": unit, "command": measured.command,
                                                 "machine": measured.machine, "commit": measured.commit, "at": measured.at}

    def row(self, name, columns, values, sources):
        """The numbers of a row of a table or figure; columns such as "force (N)". Values without a source, or that are
        not numbers, are left out."""
        for column, value, measured in zip(columns, values, sources):
            if measured is not None and value is not None and not isinstance(value, str):
                what, unit = column.rsplit(" (", 1) if column.endswith(")") else (column, "")
                self.number(f"{name}/{what}", value, unit.rstrip(")"), measured)

    def not_measured(self, name, why):
        self.missing[f"{self.target}/{name}"] = why
        self.say(f"    not measured: {name}: {why}")

    def save(self):
        """results.json: the numbers of this run and those of targets that it did not make or complete, whose figures
        still exist."""
        path = self.folder / "results.json"
        before = {}
        with contextlib.suppress(OSError, ValueError):
            before = json.loads(path.read_text(encoding="utf-8"))
        made = {name.split("/")[0] for name in [*self.numbers, *self.missing]}
        whole = made - {name.split("/")[0] for name in self.missing if name.endswith(f"/{ALL}")}
        rest = lambda kind, of: {name: value for name, value in before.get(kind, {}).items() if name.split("/")[0] not in of}
        earlier = rest("sources", whole)  # for a target that is not made, these remain the sources of some numbers
        sources = {target: sorted({*some, *earlier.get(target, ())}) for target, some in self.sources.items()}
        write_whole(path, json.dumps({"numbers": {**rest("numbers", whole), **self.numbers},
                                      "not_measured": {**rest("not_measured", made), **self.missing},
                                      "sources": {**earlier, **sources}}, indent=1, sort_keys=True) + "\n")


class Measured:
    """A value and its source."""

    def __init__(self, value, command, made_on, of_commit, at):
        self.value, self.command, self.machine, self.commit, self.at = value, command, made_on, of_commit, at

    @staticmethod
    def of_all(parts, command=None):
        """A source for a number of several measurements, with their machine or a list of machines; `command` if one makes
        them all, otherwise each has its own."""
        each = lambda name: "; ".join(dict.fromkeys(getattr(part, name) for part in parts))
        machines = [part.machine for n, part in enumerate(parts) if part.machine not in [other.machine for other in parts[:n]]]
        return Measured(None, command or each("command"), machines[0] if len(machines) == 1 else machines, each("commit"),
                        max(part.at for part in parts))


def content(path):
    """A word for the contents of a file in a command line, for a scene with its mesh; other words stand for themselves."""
    if not path.is_file() or path.stat().st_size > 1 << 28:
        return ""
    return hashlib.sha256(path.read_bytes()).hexdigest() + (content_of_mesh(path) if path.suffix == ".toml" else "")


def content_of_mesh(scene):
    """The contents of the mesh of a scene file."""
    mesh = re.search(r'^mesh = "(.*)"$', scene.read_text(encoding="utf-8"), re.M)
    return content(scene.parent / mesh[1]) if mesh else ""


def needed(module):
    """Imports a package of the distribution. Raises NotMeasured with its name if it is missing."""
    try:
        return __import__(module)
    except ImportError as missing:
        package = {"h5py": "python3-h5py", "matplotlib": "python3-matplotlib", "numpy": "python3-numpy", "scipy": "python3-scipy",
                   "torch": "python3-torch", "getfem": "python3-getfem"}.get(module, module)
        raise NotMeasured(f"{package} is not installed for {sys.executable} ({missing})") from missing
