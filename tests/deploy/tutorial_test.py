#!/usr/bin/env python3
"""Runs the tutorials command by command: docs/tutorial.md unchanged with PALPATE_LONG_TESTS (ten minutes), else with a coarser
mesh. By hand PALPATE_BIN_DIR=build/release/bin tests/deploy/tutorial_test.py."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from small_datasets import BIN, ENVIRONMENT, LIBRARY, ROOT, missing, palpate

SOME_POINTS_FAILED = 3  # exit code of a build, explained on the page


class FirstPages(unittest.TestCase):
    def follow(self, made, *pages):
        """Runs the blocks of shell and Python of pages, and writes their scenes and programs, in an empty folder."""
        if palpate is None:
            self.skipTest(missing)
        if shutil.which("gmsh") is None:
            self.skipTest("gmsh is not installed: the tutorial is NOT tested")
        text = "".join((ROOT / "docs" / page).read_text(encoding="utf-8") for page in pages)
        if not os.environ.get("PALPATE_LONG_TESTS"):
            text = text.replace("--nodes 500", "--nodes 200")
        blocks = re.findall(r"```(sh|python|toml|c)\n(.*?)```", text, re.S)
        self.assertGreater(len(blocks), 3)
        with tempfile.TemporaryDirectory() as folder:
            environment = {**ENVIRONMENT, "PATH": f"{BIN}:/usr/bin:/bin", "MPLCONFIGDIR": folder, "PKG_CONFIG_PATH": folder,
                           "LD_LIBRARY_PATH": str(LIBRARY.parent)}
            pathlib.Path(folder, "palpate.pc").write_text(  # as if it were installed
                f"Name: palpate\nDescription: built here\nVersion: 0\nCflags: -I{ROOT}/viewer/c_api\nLibs: {LIBRARY}\n", encoding="utf-8")
            for language, text in blocks:
                if language in ("toml", "c"):
                    name = re.search(r'^name = "(.*)"|^/\* (\w+)\.c:', text, re.M)
                    pathlib.Path(folder, f"{name[1] or name[2]}.{language}").write_text(text, encoding="utf-8")
                    continue
                # As on a machine with Palpate installed.
                text = text.replace("/usr/share/palpate/scenes", str(ROOT / "deploy/scenes"))
                text = text.replace("/usr/share/doc/palpate/examples", str(ROOT / "deploy/examples"))
                for step in text.splitlines() if language == "sh" else [text]:
                    words = ["bash", "-ec", step] if language == "sh" else [sys.executable, "-c", step]
                    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
                    self.assertIn(done.returncode, (0, SOME_POINTS_FAILED if step.startswith("palpate build") else 0),
                                  step + done.stdout + done.stderr)
            for file in made:
                self.assertGreater(pathlib.Path(folder, file).stat().st_size, 500, file)

    def testTheTutorialRunsFromASurfaceToAPlot(self):
        self.assertEqual((ROOT / "docs/tutorial.md").read_text(encoding="utf-8").count("--nodes 500"), 1)
        self.follow(("organ/scene.toml", "organ.h5", "organ.html", "stiffness.png", "curve.png", "touch.vtu", "press.pvd",
                     "curve.csv", "side.h5"), "tutorial.md")

    def testAStiffLumpIsFoundAndALoopSlidesOverIt(self):
        self.follow(("lump.h5", "lump.png", "loop.txt", "loop.png"), "tutorial-lump.md", "tutorial-loop.md")

    def testTwoMaterialsMakeAFigure(self):
        self.follow(("neo.h5", "exp.h5", "two.png"), "tutorial-python.md")

    def testItsPythonStepsFindTheLibraryAfterTheDemo(self):
        built = re.search(r"cmake --build .*--target (.*)\)", (ROOT / "deploy/demo").read_text(encoding="utf-8"))
        self.assertIn("palpate_library", built[1].split(), "deploy/python looks for build/*/lib/libpalpate.so.0")


if __name__ == "__main__":
    unittest.main()
