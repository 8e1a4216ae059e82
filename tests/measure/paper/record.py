"""The results of an evaluation: every number with its command, machine and commit.

A *measurement* is the JSON of one command or function, kept in FOLDER/measurements under a key that is a hash of its inputs. A
run that continues an interrupted one reuses measurements. A *number* is a value that is shown to a reader."""
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
ALL = "all"  # marks a whole target as not measured
BUILD_THEM = "build the targets all and benchmarks (docs/benchmarks.md)"


class Incomplete(Exception):
    """Something that a table or figure needs is missing. It is not made, and the run prints the reason."""


class NotMeasured(Exception):
    """A peer, package, program or mesh, or the time, is missing. Its column shows this; everything else is made."""


def machine():
    text = pathlib.Path("/proc/cpuinfo").read_text(encoding="ascii", errors="replace")
    model = re.search(r"^model name\s*: (.*)$", text, re.M)
    memory = re.search(r"^MemTotal:\s*(\d+)", pathlib.Path("/proc/meminfo").read_text(encoding="ascii"), re.M)
    return {"processor": model[1] if model else platform.machine(), "cores": len(os.sched_getaffinity(0)),
            "memory_GB": round(int(memory[1]) / 1e6, 1) if memory else None, "system": platform.platform()}


def commit():
    """Returns the commit of the sources, with a + if they have changed since."""
    try:
        git = lambda *words: subprocess.run(["git", "-C", ROOT, *words], capture_output=True, text=True, check=True).stdout.strip()
        return git("rev-parse", "--short=12", "HEAD") + ("+" if git("status", "--porcelain", "-uno") else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown: the sources are not in a git repository"


def commit_of(programs):
    """Returns the commit of the programs, as `palpate --version` prints it."""
    try:
        said = subprocess.run([programs / "palpate", "--version"], capture_output=True, text=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return "unknown: palpate does not exist"
    return (re.search(r"^commit (.*)$", said, re.M) or ["", "unknown"])[1]


class Record:
    """folder: place of all files. programs: build/release, with bin and bench in it. quick: use the smallest set that shows every
    table and figure. jobs: number of local workers; with an address `listen`, workers from anywhere instead. nodes, laws:
    approximate sizes of the organs and words of organs.LAWS, for targets with several. random_paths: of a survey. hours: start
    no measurement after this time."""

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
        """Returns the value of make(), which must fit in JSON, or the value of an earlier run with the same `depends`."""
        key = hashlib.sha256(json.dumps([name, *map(str, depends)]).encode()).hexdigest()[:16]
        path = self.folder / "measurements" / f"{re.sub(r'[^a-z0-9.-]+', '-', name.lower())}-{key}.json"
        with contextlib.suppress(OSError, ValueError, KeyError):
            kept = json.loads(path.read_text(encoding="utf-8"))
            return self.used(Measured(kept["value"], kept["command"], kept["machine"], kept["commit"], kept["at"]))
        if time.monotonic() >= self.ends:
            raise NotMeasured(f"{name} was not begun in the hours that were given")
        self.say(f"    {name} ...")
        began = time.monotonic()
        value = json.loads(json.dumps(make()))  # like a later run that reads it
        made = {"name": name, "command": command, "machine": self.machine, "commit": self.commit,
                "at": datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="seconds"),
                "seconds": round(time.monotonic() - began, 3), "value": value}
        write_whole(path, json.dumps(made))
        return self.used(Measured(value, command, made["machine"], made["commit"], made["at"]))

    def used(self, measured):
        """Records the machine and commit of a measurement of this target. A run that continues elsewhere has several."""
        self.sources.setdefault(self.target, {})[f"{measured.machine['processor']}, {measured.commit}"] = None
        return measured

    def run(self, name, command, text=None, lines=False, codes=(0,), depends=()):
        """Measures a command that prints one JSON object, or one per line with `lines`."""
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
        """Returns the end of the command line of a command that reads `text`: the file with that text, so that anyone can repeat
        it."""
        if text is None:
            return ""
        file = self.folder / "inputs" / f"{name[:16]}.txt"
        if not file.exists():
            write_whole(file, text)
        return f" < {self.shown([file])}"

    def together(self, measurements):
        """Returns the results of these functions in order. Runs as many at once as there are local workers, so do not use it for
        timings. If one fails or the run is interrupted, the others are not started."""
        with concurrent.futures.ThreadPoolExecutor(self.jobs) as pool:
            begun = [pool.submit(measure) for measure in measurements]
            try:
                return [one.result() for one in begun]
            finally:
                pool.shutdown(wait=True, cancel_futures=True)

    def scene(self, name, text):
        """Writes a scene file with this text, and returns its path."""
        path = self.folder / "scenes" / f"{name}.toml"
        write_whole(path, text)
        return path

    def dataset(self, name, scene, jobs=None):
        """Builds `scene` (text of a scene file), and returns {dataset, seconds, bytes, jobs (None: workers from anywhere), points
        by tag}. An interrupted build continues, and its time is the sum of its parts. With other workers or another scene, the
        build restarts."""
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
        if not build.dataset.exists():  # only the dataset was removed
            raise Incomplete(f"{build.dataset} is missing; remove {self.folder}/measurements/build-{name}-*.json to build it again")
        return made

    def shown(self, words):
        """Returns a command as a reader would type it in the root of the sources."""
        return " ".join(os.path.relpath(word, ROOT) if str(word).startswith("/") and str(word).startswith(str(ROOT)) else str(word) for word in words)

    # Numbers for readers

    def number(self, name, value, unit, measured):
        """Records one number of a table or figure, with its measurement."""
        value = value.item() if hasattr(value, "item") else value  # NumPy scalars
        self.numbers[f"{self.target}/{name}"] = {"value": value, "unit": unit, "command": measured.command,
                                                 "machine": measured.machine, "commit": measured.commit, "at": measured.at}

    def row(self, name, columns, values, sources):
        """Records the numbers in a row of a table or figure; columns such as "force (N)". Skips cells without a source, and
        texts."""
        for column, value, measured in zip(columns, values, sources):
            if measured is not None and value is not None and not isinstance(value, str):
                what, unit = column.rsplit(" (", 1) if column.endswith(")") else (column, "")
                self.number(f"{name}/{what}", value, unit.rstrip(")"), measured)

    def not_measured(self, name, why):
        self.missing[f"{self.target}/{name}"] = why
        self.say(f"    not measured: {name}: {why}")

    def save(self):
        """Writes results.json: the numbers of this run, and those of targets that it did not make completely, since their figures
        still exist."""
        path = self.folder / "results.json"
        before = {}
        with contextlib.suppress(OSError, ValueError):
            before = json.loads(path.read_text(encoding="utf-8"))
        made = {name.split("/")[0] for name in [*self.numbers, *self.missing]}
        whole = made - {name.split("/")[0] for name in self.missing if name.endswith(f"/{ALL}")}
        rest = lambda kind, of: {name: value for name, value in before.get(kind, {}).items() if name.split("/")[0] not in of}
        earlier = rest("sources", whole)  # a target that was not made still has numbers from these
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
        """Returns the source of a number that several measurements give: their machine, or a list of machines. command: makes all
        of them; by default their own commands."""
        each = lambda name: "; ".join(dict.fromkeys(getattr(part, name) for part in parts))
        machines = [part.machine for n, part in enumerate(parts) if part.machine not in [other.machine for other in parts[:n]]]
        return Measured(None, command or each("command"), machines[0] if len(machines) == 1 else machines, each("commit"),
                        max(part.at for part in parts))


def content(path):
    """Returns a hash of a file on a command line, for a scene including its mesh; empty for other words."""
    if not path.is_file() or path.stat().st_size > 1 << 28:
        return ""
    return hashlib.sha256(path.read_bytes()).hexdigest() + (content_of_mesh(path) if path.suffix == ".toml" else "")


def content_of_mesh(scene):
    """Returns the hash of the mesh that a scene file names."""
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
