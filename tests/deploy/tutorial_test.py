#!/usr/bin/env python3
"""docs/tutorial.md, command by command: as it stands with PALPATE_LONG_TESTS (ten minutes), else with a coarser mesh.
By hand PALPATE_BIN_DIR=build/release/bin tests/deploy/tutorial_test.py."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from small_datasets import BIN, ENVIRONMENT, ROOT, missing, palpate

SOME_POINTS_FAILED = 3  # of a build, which the page says


class FirstPages(unittest.TestCase):
    def follow(self, page, made):
        """Runs the blocks of shell and Python of a page, writes its scene, in an empty folder."""
        if palpate is None:
            self.skipTest(missing)
        if shutil.which("gmsh") is None:
            self.skipTest("gmsh is not installed: the tutorial is NOT tested")
        self.assertEqual(page.count("--nodes 500"), 1)
        if not os.environ.get("PALPATE_LONG_TESTS"):
            page = page.replace("--nodes 500", "--nodes 200")
        blocks = re.findall(r"```(sh|python|toml)\n(.*?)```", page, re.S)
        self.assertGreater(len(blocks), 6)
        with tempfile.TemporaryDirectory() as folder:
            environment = {**ENVIRONMENT, "PATH": f"{BIN}:/usr/bin:/bin", "MPLCONFIGDIR": folder}
            for language, text in blocks:
                if language == "toml":
                    name = re.search(r'^name = "(.*)"', text, re.M)[1]
                    pathlib.Path(folder, f"{name}.toml").write_text(text, encoding="utf-8")
                    continue
                # As if it were installed.
                text = text.replace("/usr/share/palpate/scenes", str(ROOT / "deploy/scenes"))
                text = text.replace("/usr/share/doc/palpate/examples", str(ROOT / "deploy/examples"))
                for step in text.splitlines() if language == "sh" else [text]:
                    words = ["bash", "-ec", step] if language == "sh" else [sys.executable, "-c", step]
                    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
                    self.assertIn(done.returncode, (0, SOME_POINTS_FAILED if step.startswith("palpate build") else 0),
                                  step + done.stdout + done.stderr)
            for file in made:
                self.assertGreater(pathlib.Path(folder, file).stat().st_size, 500, file)

    def testTheTutorialLeadsFromASurfaceToAPlotAsItStands(self):
        page = (ROOT / "docs/tutorial.md").read_text(encoding="utf-8")
        self.follow(page, ("organ/scene.toml", "organ.h5", "organ.html", "stiffness.png", "curve.png", "touch.vtu", "press.pvd",
                           "curve.csv", "side.h5"))

    def testItsStepsInPythonFindTheLibraryAfterTheDemo(self):
        built = re.search(r"cmake --build .*--target (.*)\)", (ROOT / "deploy/demo").read_text(encoding="utf-8"))
        self.assertIn("palpate_library", built[1].split(), "deploy/python looks for build/*/lib/libpalpate.so.0")


if __name__ == "__main__":
    unittest.main()
