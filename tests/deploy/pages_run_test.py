#!/usr/bin/env python3
"""Runs the commands of the pages unchanged, page by page. Each page has its own folder, with small bodies under the names
that it uses, and its own network. ELSEWHERE lists the commands that cannot run here, with the reason. The tutorial and
docs/python.md have their own tests. By hand PALPATE_BIN_DIR=build/release/bin tests/deploy/pages_run_test.py."""
import importlib.util
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from docs_commands_test import commands
from small_datasets import BIN, ENVIRONMENT, ROOT, SCENE, missing, palpate

sys.path.insert(0, str(ROOT / "tests" / "support"))
from virtual_screen import virtual_screen

PAGES = ("README.md", "docs/client.md", "docs/commands.md", "docs/export.md", "docs/meshes.md", "docs/metrics.md", "docs/operating.md",
         "docs/security.md", "docs/sharing.md", "docs/devices.md", "docs/install.md", "docs/failures.md",
         "docs/tissues.md", "docs/accuracy.md", "docs/faq.md")
# Commands that are not run here, and why.
ELSEWHERE = {
    r"--device haply": "needs the device",
    r"plugin:\./touch\.so": "is the reader's own: that of docs/devices.md is compiled here",
    r"palpate verify": "takes minutes: tests/verification",
    r"palpate fleet (slurm|ssh)": "needs other machines: tests/scheduler/fleet",
    r"side\.(toml|h5)|--at 0\.0315 ": "is of the kidney, which the tutorial makes: tutorial_test.py",
    r"palpate share": "needs the modules for browsers: tests/viewer/share",
}
if not os.environ.get("PALPATE_LONG_TESTS"):
    ELSEWHERE[r"palpate build organ/scene\.toml"] = "takes a minute: docs/meshes.md, with PALPATE_LONG_TESTS (deploy/test --nightly)"
# Programs that run until they are stopped.
ENDLESS = r"palpate (serve|work|device|follow) |--watch|--follow|palpate (view|touch) (?!.*--duration)|--metrics|--dashboard"
# Names in pages, and their replacements here.
STANDS_FOR = ((r"tcp://(HOST|head|new|0\.0\.0\.0|\$\(hostname\)):", "tcp://127.0.0.1:"), (r"/var/lib/palpate/|/var/tmp/|/local/", ""),
              (r"PREFIX/include/palpate", str(ROOT / "viewer/devices")),
              (r"\bSCENE\.toml", "skin.toml"), (r"\bOUT\.h5", "skin.h5"),
              (r"10\.0\.0\.5:9464", "127.0.0.2:9464"), (r" -j 16", " -j 1"), (r"\bKEY(_OF_\w+)?\b", "$KEY"))

TIP = '[[active]]\nname = "tip"\nnear = [0.05, 0.065, 0.1]'
SKIN = """[[active]]
name = "skin"
surface = { box = { lowest = [0.02, 0.1, 0.01], highest = [0.08, 0.14, 0.06] } }
tool = "finger"
radius = 0.03"""


def box_surface(x=100, y=130, z=100):
    """The surface of a box in millimetres, as STL."""
    corners = [(i, j, k) for i in (0, x) for j in (0, y) for k in (0, z)]
    faces = ((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4),
             (1, 5, 7), (1, 7, 3))
    lines = ["solid box"]
    for face in faces:
        lines += ["facet normal 0 0 0", "outer loop", *("vertex {} {} {}".format(*corners[n]) for n in face), "endloop", "endfacet"]
    return "\n".join([*lines, "endsolid box", ""])


class Bodies:
    """Small scenes, datasets and meshes, created once, under all the names that pages use."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        (folder / "organ.stl").write_text(box_surface(), encoding="utf-8")
        run = lambda *words: subprocess.run([BIN / "palpate", *words], cwd=folder, check=False, capture_output=True, text=True)
        self.said = [run("mesh", "organ.stl", "-o", "organ.msh", "--nodes", "150")]
        text = ("import meshio; mesh = meshio.read('organ.msh'); mesh.cell_sets = {}; mesh.write('organ.vtu'); "
                "surface = meshio.read('organ.stl'); surface.write('organ.ply'); surface.write('parts.obj')")
        self.said.append(subprocess.run([sys.executable, "-c", text], cwd=folder, check=False, capture_output=True, text=True))
        metres = "import meshio; m = meshio.read('organ.msh'); m.points *= 1e-3; m.write('block.msh', file_format='gmsh22', binary=False)"
        self.said.append(subprocess.run([sys.executable, "-c", metres], cwd=folder, check=False, capture_output=True, text=True))
        self.scene("liver", TIP, 0.03, 0.01)
        self.scene("long", TIP, 0.03, 0.0008)  # lasts as long as it is watched
        self.scene("skin", SKIN, 0.01, 0.01)
        for name in ("liver", "skin"):
            self.said.append(run("build", f"{name}.toml", "-o", f"{name}.h5", "-q", "-j", "2"))
        for name in ("stiff-liver", "liver-20mm", "liver-10mm", "liver-soft", "liver-stiff", "organ"):
            shutil.copy(folder / "liver.h5", folder / f"{name}.h5")
        shutil.copy(folder / "liver.toml", folder / "organ.toml")
        for kind in ("toml", "h5"):
            shutil.copy(folder / f"skin.{kind}", folder / f"liver-surface.{kind}")
        shutil.copytree(folder / "liver.h5.state", folder / "organ.h5.state")
        shutil.copy(ROOT / "deploy/examples/device-plugin/circle_device.c", folder)
        for name, numbers in (("positions.txt", "0.01 0 0\n0 0.01 -0.01\n"), ("way.txt", "0 0 0\n0.01 0 0\n0.01 0.01 0\n"),
                              ("touches.txt", "0.05 0.13 0.03 0 0 -0.005\n")):
            (folder / name).write_text(numbers, encoding="utf-8")

    def scene(self, name, active, radius, spacing):
        (self.folder / f"{name}.toml").write_text(SCENE.format(name="liver", active=active, radius=radius, spacing=spacing),
                                                   encoding="utf-8")


class Machine:
    """A screen, and a separate network with loopback only."""

    def __init__(self, display):
        self.display = display
        self.network = subprocess.Popen(["unshare", "--net", "sh", "-c", "ip link set lo up && echo up && exec sleep 3600"],
                                        stdout=subprocess.PIPE, text=True)
        if self.network.stdout.readline() != "up\n":
            raise RuntimeError("no network of its own")

    def close(self):
        self.network.kill()
        self.network.wait()
        self.network.stdout.close()


class Reader:
    """Follows a page in a separate folder."""

    def __init__(self, folder, bodies, machine):
        self.folder, self.bodies, self.machine = folder, bodies, machine
        folder.mkdir()
        self.server = None
        self.environment = {**ENVIRONMENT, "HOME": str(folder / "home"), "PATH": f"{BIN}:/usr/bin:/bin:/usr/sbin:/sbin",
                            "DISPLAY": machine.display, "LIBGL_ALWAYS_SOFTWARE": "1", "XDG_RUNTIME_DIR": str(folder)}
        self.environment.pop("XDG_CONFIG_HOME", None)
        self.environment["KEY"] = self.run("palpate key new --keys others", (0,)).strip()

    def close(self):
        self.stop_server()

    def follow(self, command):
        """The error of the command, or nothing."""
        for name, stands in STANDS_FOR:
            command = re.sub(name, stands, command)
        self.lay_out(command)
        try:
            if variable := re.match(r"(\w+)=\$\((.*)\)$", command):
                self.environment[variable[1]] = self.run(variable[2], (0,)).strip()
            elif command.startswith("palpate serve"):
                self.serve(command)
            elif re.search(ENDLESS, command):
                self.watch(command)
            else:
                self.run(command, (0, 1) if "doctor" in command else (0, 3))  # missing parts; points outside or failed
                if command.startswith("palpate stop"):
                    if self.server is None:
                        raise RuntimeError("stops what does not run")
                    self.server.wait(60)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            return f"{command}: {error}"
        return ""

    def lay_out(self, command):
        """Restores all files, without results of earlier commands under the same name."""
        shutil.copytree(self.bodies.folder, self.folder, dirs_exist_ok=True)
        verb = command.split()[1]
        if verb == "serve" or "skin" in command:  # other names of the liver or organ in the pages
            other = "long" if verb == "serve" else "skin"
            for name in ("liver", "organ"):
                shutil.copy(self.folder / f"{other}.toml", self.folder / f"{name}.toml")
                if verb != "serve":
                    shutil.copy(self.folder / f"{other}.h5", self.folder / f"{name}.h5")
        made = {"serve": ["liver.h5"], "new": ["organ", "kidney.toml"], "touch": ["organ.msh", "organ.toml"],
                "key": ["home/.config"] if command.endswith(" new") else []}.get(verb, [])
        if output := re.search(r" (?:-o|--html|--record) (\S+)", command):
            made += [output[1], output[1] + ".state", re.sub(r"\.pvd$", "", output[1])]
        elif verb == "build":
            made += ["liver.h5", "liver.h5.state"]
        for name in made:
            place = self.folder / name
            shutil.rmtree(place) if place.is_dir() else place.unlink(missing_ok=True)

    def start(self, command, out=subprocess.PIPE):
        return subprocess.Popen(["nsenter", f"--net=/proc/{self.machine.network.pid}/ns/net", "bash", "-c", f"exec {command}"],
                                cwd=self.folder, env=self.environment, text=True, stdin=subprocess.DEVNULL, stdout=out,
                                stderr=subprocess.STDOUT)

    def run(self, command, codes):
        process = self.start(command)
        try:
            said = process.communicate(timeout=120)[0]
        finally:
            process.kill()
        if process.returncode not in codes:
            raise RuntimeError(f"exit code {process.returncode}: {said[-600:]}")
        return said

    def watch(self, command):
        """Runs for a second and ends on request."""
        process = self.start(command)
        try:
            time.sleep(1)
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=60)[0]
        finally:
            process.kill()
        if process.returncode not in (0, 130, -signal.SIGINT):  # the last code if it is still loading
            raise RuntimeError(f"exit code {process.returncode}: {said[-600:]}")

    def serve(self, command):
        self.stop_server()
        shutil.rmtree(self.folder / re.search(r"--state (\S+)", command)[1], ignore_errors=True)
        log = self.folder / "serve.log"
        with log.open("w", encoding="utf-8") as said:
            self.server = self.start(command, said)
        for _ in range(100):
            time.sleep(0.1)
            if self.server.poll() is not None:
                raise RuntimeError(f"exit code {self.server.returncode}: {log.read_text()[-600:]}")
            if "listen" in log.read_text():
                return
        raise RuntimeError(f"does not listen: {log.read_text()[-600:]}")

    def stop_server(self):
        if self.server and self.server.poll() is None:
            self.server.send_signal(signal.SIGINT)
            self.server.wait(60)


class PagesInPython(unittest.TestCase):
    """Runs Python code of the pages that reads Palpate's files."""

    def setUp(self):
        if palpate is None:
            self.skipTest(missing)
        if shutil.which("gmsh") is None:
            self.skipTest("gmsh is not installed: Python of the pages is NOT run")
        for module, package in (("meshio", "python3-meshio"), ("vtkmodules", "python3-paraview")):
            if importlib.util.find_spec(module) is None:
                self.skipTest(f"{package} is not installed: Python of the pages is NOT run")
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())) / "bodies"
        for said in Bodies(self.folder).said:
            self.assertIn(said.returncode, (0, 3), said.args + [said.stdout, said.stderr])

    def run_here(self, *words, screen=None):
        done = subprocess.run(words, cwd=self.folder, env={**ENVIRONMENT, **(screen or {})}, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{words}\n{done.stdout}{done.stderr}")
        return done.stdout

    def blocks(self, page):
        return re.findall(r"^```python\n(.*?)^```", (ROOT / page).read_text(encoding="utf-8"), re.M | re.S)

    def testReadDatasetsAsDocumented(self):
        blocks = self.blocks("docs/dataset.md")
        self.assertEqual(len(blocks), 3)
        said = [self.run_here(sys.executable, "-c", block, "liver.h5") for block in blocks]
        self.assertIn("deformed surface nodes:", said[0])
        self.assertIn("largest displacement:", said[1])

    def testReadExportedFilesAsDocumented(self):
        with (self.folder / "liver.toml").open("a", encoding="utf-8") as scene:
            scene.write('\n[storage]\ndisplacement = "all"\n')  # det F needs the volume
        self.run_here(BIN / "palpate", "build", "liver.toml", "-o", "stored.h5", "-q")
        self.run_here(BIN / "palpate", "export", "stored.h5", "-o", "touch.vtu", "--displacement", "0.01", "0", "0")
        self.run_here(BIN / "palpate", "export", "stored.h5", "-o", "curve.csv", "--displacement", "0.02", "0", "0", "--steps", "5")
        blocks = self.blocks("docs/export.md")
        self.assertEqual(len(blocks), 4)
        for block in blocks:
            if "paraview" not in block:
                self.assertTrue(self.run_here(sys.executable, "-c", block))
            elif shutil.which("pvpython") and shutil.which("Xvfb"):
                (self.folder / "render.py").write_text(block, encoding="utf-8")
                with virtual_screen() as screen:
                    self.run_here("pvpython", "--force-offscreen-rendering", "render.py", screen=screen)
                self.assertGreater((self.folder / "touch.png").stat().st_size, 5000)
            else:
                print("NOT TESTED: ParaView needs pvpython and Xvfb (Debian: python3-paraview, xvfb)")


class Pages(unittest.TestCase):
    maxDiff = None

    def testHaveCommandsThatWork(self):
        if palpate is None:
            self.skipTest(missing)
        for program in ("gmsh", "tetgen", "Xvfb", "unshare", "cc"):
            if shutil.which(program) is None:
                self.skipTest(f"{program} is not installed: commands of the pages are NOT run")
        if os.geteuid() != 0:
            self.skipTest("a network of its own needs root: commands of the pages are NOT run")
        wrong, seen = [], 0
        machine = Machine(self.enterContext(virtual_screen())["DISPLAY"])
        self.addCleanup(machine.close)
        with tempfile.TemporaryDirectory() as root:
            bodies = Bodies(pathlib.Path(root) / "bodies")
            for said in bodies.said:
                self.assertIn(said.returncode, (0, 3), said.args + [said.stdout, said.stderr])
            for page in PAGES:
                reader = Reader(pathlib.Path(root) / page.replace("/", "-"), bodies, machine)
                self.addCleanup(reader.close)
                for where, command in commands():
                    if where.split(":")[0] != page or not re.match(r"(\w+=\$\()?palpate (-|[a-z]+( |$))|cc -shared ", command):
                        continue
                    if any(re.search(elsewhere, command) for elsewhere in ELSEWHERE):
                        continue
                    seen += 1
                    begin = time.monotonic()
                    if problem := reader.follow(command):
                        wrong.append(f"{where}: {problem}")
                    print(f"{time.monotonic() - begin:6.1f} s  {where}: {command}", flush=True)
                reader.close()
        self.assertEqual(wrong, [])
        self.assertGreater(seen, 90)


if __name__ == "__main__":
    unittest.main()
