#!/usr/bin/env python3
"""Tests deploy/container/Containerfile. ctest runs each case separately; by hand PALPATE_BIN_DIR=build/release/bin
tests/deploy/container_test.py."""
import functools
import os
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../.."))
PROGRAMS = os.path.abspath(os.environ.get("PALPATE_BIN_DIR", f"{ROOT}/build/release/bin"))
CONTAINERFILE = f"{ROOT}/deploy/container/Containerfile"


def output(*words, **options):
    return subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=True, **options).stdout


def stages():
    """Returns the commands of each stage, each on one line."""
    with open(CONTAINERFILE, encoding="utf-8") as file:
        text = re.sub(r"\\\n", " ", re.sub(r"^#.*\n", "", file.read(), flags=re.M))
    return [re.findall(r"^.+$", stage, re.M) for stage in re.split(r"^(?=FROM )", text, flags=re.M) if stage.strip()]


def runtime_packages():
    (install,) = [line for line in stages()[1] if "apt-get install" in line]
    words = re.search(r"apt-get install (.*?)&&", install)[1].split()
    return [word for word in words if not word.startswith("-")]


def installed_with(packages):
    """These packages and their dependencies on this machine."""
    everything = {}
    for line in output("dpkg-query", "-W", "-f", "${Package}\t${Pre-Depends}, ${Depends}\t${Provides}\t${Essential}\n").splitlines():
        name, needs, provides, essential = line.split("\t")
        alternatives = [[re.sub(r"[ (:].*", "", word.strip()) for word in need.split("|")] for need in needs.split(",") if need.strip()]
        everything[name] = alternatives
        for also in filter(None, (re.sub(r" .*", "", word.strip()) for word in provides.split(","))):
            everything.setdefault(also, [[name]])
        if essential == "yes":
            packages = [*packages, name]
    there, wanted = set(), list(packages)
    while wanted:
        name = wanted.pop()
        if name in everything and name not in there:
            there.add(name)
            wanted += [word for alternatives in everything[name] for word in alternatives[:1]]
    return there


@functools.cache
def libraries():
    """The libraries that the programs of the image load here, each with its package."""
    said = "".join(output("ldd", os.path.join(PROGRAMS, program)) for program in ("palpate", "palpate-answers", "palpate-scheduler", "palpate-worker"))
    paths = {os.path.realpath(path) for path in re.findall(r"=> (/\S+)", said)}
    # Packages list files under the path from before or after /lib became a link to /usr/lib; dpkg does not know the other
    # path.
    names = paths | {path.removeprefix("/usr") for path in paths}
    owners = subprocess.run(["dpkg", "-S", *names], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=False).stdout
    return {path: package for package, path in re.findall(r"^([^:\s]+).*: (\S+)$", owners, re.M)}


def not_in(packages):
    there = installed_with(packages)
    return {library: package for library, package in libraries().items() if package not in there}


def image_system():
    """Returns whether this machine is the Debian of the image, whose packages have the names in its file."""
    with open("/etc/os-release", encoding="utf-8") as file:
        codename = re.search(r"VERSION_CODENAME=(\w+)", file.read())
    return codename is not None and codename[1] in stages()[1][0]


class Container(unittest.TestCase):
    def testTheImageHasEveryLibraryThatItsProgramsLoad(self):
        if re.search("lib[at]san", output("ldd", f"{PROGRAMS}/palpate")):
            self.skipTest("programs with sanitizers load what the image does not need")
        if not image_system():
            self.skipTest("another Debian than the image's: its packages have other names")
        self.assertGreater(len(libraries()), 20)
        self.assertEqual(not_in(runtime_packages()), {})

    @unittest.skipUnless(image_system(), "another Debian than the image's: its packages have other names")
    def testAForgottenPackageIsFound(self):
        for forgotten in "libzmq5", "libmumps-seq-5.5", "libsqlite3-0", "libhdf5-103-1", "libtomlplusplus3":
            rest = [package for package in runtime_packages() if package != forgotten]
            self.assertIn(forgotten, not_in(rest).values())

    def testCopiedFilesExistAndBuiltFilesAreCopied(self):
        copied = [word for line in stages()[0] if line.startswith("COPY ") for word in line.split()[1:-1]]
        for path in copied:
            self.assertTrue(os.path.exists(os.path.join(ROOT, path)), path)
        with open(f"{ROOT}/CMakeLists.txt", encoding="utf-8") as file:
            text = file.read()
        folders = re.findall(r"^add_subdirectory\((\w+)\)", text, re.M)
        self.assertEqual([folder for folder in folders if folder not in copied], [])
        needed = re.findall(r"^include\((\S+/\S+)\)", text, re.M)  # excludes OPTIONAL
        self.assertEqual([path for path in needed if path.split("/")[0] not in copied and path not in copied], [])

    def testCopiedSourcesCanBeConfigured(self):
        with tempfile.TemporaryDirectory() as folder:
            for line in stages()[0]:
                if line.startswith("COPY "):
                    *paths, into = line.split()[1:]
                    for path in paths:
                        copy = os.path.join(folder, into, "" if os.path.isdir(f"{ROOT}/{path}") else os.path.basename(path))
                        os.makedirs(os.path.dirname(copy.rstrip("/")), exist_ok=True)
                        subprocess.run(["cp", "-r", "-T", f"{ROOT}/{path}", copy], check=True)
            done = subprocess.run(["cmake", "--preset", "release", "-DPALPATE_TESTS=OFF"], cwd=folder, capture_output=True, text=True,
                                  check=False)
            self.assertEqual(done.returncode, 0, done.stdout[-1000:] + done.stderr)

    def testTheComponentHasTheProgramsOfTheManifests(self):
        """Compares with the files of `cmake --install --component service`."""
        cache = os.path.join(os.path.dirname(PROGRAMS), "CMakeCache.txt")
        if not os.path.exists(cache):
            self.skipTest(f"no build folder at {os.path.dirname(PROGRAMS)}: what is installed was NOT looked at")
        with tempfile.TemporaryDirectory() as prefix:
            output("cmake", "--install", os.path.dirname(PROGRAMS), "--component", "service", "--prefix", prefix)
            installed = sorted(os.path.relpath(os.path.join(folder, name), prefix)
                               for folder, _, names in os.walk(prefix) for name in names)
        self.assertEqual(installed, ["bin/palpate", "bin/palpate-answers", "bin/palpate-scheduler", "bin/palpate-worker"])

    def testTheImageIsBuiltAndBuildsADataset(self):
        if not os.environ.get("PALPATE_LONG_TESTS"):
            self.skipTest("an image takes ten minutes and was NOT built; set PALPATE_LONG_TESTS=1 (deploy/test --nightly does)")
        base = re.match(r"FROM (\S+)", stages()[1][0])[1]
        if not shutil.which("podman") or subprocess.run(["podman", "image", "exists", base], check=False).returncode != 0:
            self.skipTest(f"no podman, or no {base} in it: the image was NOT built")
        tried = subprocess.run(["podman", "run", "--rm", "--network=none", base, "true"], capture_output=True, text=True, check=False)
        if tried.returncode != 0:
            self.skipTest(f"podman runs nothing here, and the image was NOT built: {tried.stderr}")
        image = "localhost/palpate-test"
        self.addCleanup(subprocess.run, ["podman", "rmi", image], check=False, stdout=subprocess.DEVNULL)
        output("podman", "build", "--network=host", "--layers=false", "-t", image, "-f", CONTAINERFILE, ROOT)
        with tempfile.TemporaryDirectory() as folder:
            for name in "liver.toml", "liver-500.msh":
                shutil.copy(f"{ROOT}/deploy/scenes/liver/{name}", folder)
            os.chmod(folder, 0o777)
            said = output("podman", "run", "--rm", "--network=none", "--read-only", "--read-only-tmpfs=false", "--cap-drop=ALL",
                          "--security-opt=no-new-privileges", "-v", f"{folder}:/organ", image,
                          "build", "/organ/liver.toml", "-o", "/organ/liver.h5")
            self.assertIn("sealed after", said)


if __name__ == "__main__":
    unittest.main()
