#!/usr/bin/env python3
"""Tests the archive and the wheel in build/bundle, which deploy/bundle makes, on this machine; deploy/try_bundle tries them in bare
Debians. ctest runs each case separately; by hand tests/deploy/bundle_test.py."""
import json
import pathlib
import re
import subprocess
import tarfile
import tempfile
import unittest

from small_datasets import BIN, ROOT, WithDatasets

ARCHIVE, WHEEL = (next((ROOT / "build/bundle").glob(pattern), None) for pattern in ("palpate-*.tar.gz", "palpate-*.whl"))
NEEDED = {f"lib{name}" for name in ("c.so.6", "m.so.6", "dl.so.2", "pthread.so.0", "gcc_s.so.1")} | {"ld-linux-x86-64.so.2"}


def run(*words, **options):
    return subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False, **options)


def output(*words, **options):
    done = run(*words, **options)
    if done.returncode != 0:
        raise AssertionError(f"{words}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


@unittest.skipIf(ARCHIVE is None or WHEEL is None, "deploy/bundle has not run here: this is NOT tested")
class ArchiveAndWheel(WithDatasets):
    def setUp(self):
        self.place = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="a space ")))

    def unpacked(self):
        with tarfile.open(ARCHIVE) as archive:
            archive.extractall(self.place)
        return next(self.place.glob("palpate-*"))

    def environment(self):
        output("/usr/bin/python3", "-m", "venv", "--system-site-packages", self.place / "venv")
        return self.place / "venv/bin"

    def testProgramsNeedOnlyTheCLibraryOfDebian11(self):
        tree = self.unpacked()
        files = [path for path in [*(tree / "bin").iterdir(), *tree.glob("lib/**/*.so*")] if not path.is_symlink()]
        self.assertGreater(len(files), 6)
        for path in files:
            needed = set(re.findall(r"NEEDED +(\S+)", output("objdump", "-p", path)))
            self.assertLessEqual(needed, NEEDED | ({"libX11.so.6"} if "glfw" in path.name else set()), path)
            versions = re.findall(r"GLIBC_2\.(\d+)", output("objdump", "-T", path))
            self.assertLessEqual(max(map(int, versions)), 31, path)
            self.assertNotIn("GLIBCXX", output("objdump", "-T", path))

    def testTheArchiveHasTheLicenceOfEveryPart(self):
        names = {path.name for path in (self.unpacked() / "share/doc/palpate").rglob("*")}
        self.assertLessEqual({"LICENSE", "versions", "libhdf5-dev", "libzmq3-dev", "libprotobuf-dev", "libmumps-seq-dev", "libopenblas-pthread-dev",
                              "libgfortran-12-dev", "libeigen3-dev", "libfmt-dev", "libssl-dev", "libsqlite3-dev", "libglfw3"}, names)
        self.assertFalse({"gmsh", "tetgen"} & names)
        self.assertLess(max(ARCHIVE.stat().st_size, WHEEL.stat().st_size), 60e6)

    def testTheArchiveAnswersLikeTheBuildInAReadOnlyFolder(self):
        tree = self.unpacked()
        output("chmod", "-R", "a-w", tree)
        self.addCleanup(output, "chmod", "-R", "u+w", tree)
        asked = ("query", self.file, "--active", "tip", "--displacement", "0.001", "0.002", "-0.01", "--json")
        self.assertEqual(output(tree / "bin/palpate", *asked), output(BIN / "palpate", *asked))

    def testTheWheelAnswersLikeTheBuild(self):
        programs = self.environment()
        output(programs / "pip", "install", "--no-index", WHEEL)
        script = ("import json, sys, palpate; print(palpate._library.library_file); "
                  "print(json.dumps(palpate.Dataset(sys.argv[1]).query((0.001, 0.002, -0.01), active='tip').force.tolist()))")
        said = output(programs / "python", "-I", "-c", script, self.file, env={"PATH": "/usr/bin:/bin"}).splitlines()
        self.assertTrue(said[0].startswith(str(self.place)), said)
        built = output(BIN / "palpate", "query", self.file, "--active", "tip", "--displacement", "0.001", "0.002", "-0.01", "--json")
        self.assertEqual(json.loads(said[1]), json.loads(built)["force"])

    def testPipRefusesTheWheelOnOtherSystems(self):
        pip = self.environment() / "pip"
        for platform, fits in (("manylinux_2_31_x86_64", True), ("musllinux_1_2_x86_64", False), ("manylinux_2_31_aarch64", False)):
            done = run(pip, "install", "--no-index", "--no-deps", "--only-binary=:all:", "--platform", platform, "--target",
                       self.place / platform, WHEEL)
            self.assertEqual(done.returncode == 0, fits, f"{platform}: {done.stdout}{done.stderr}")


if __name__ == "__main__":
    unittest.main()
