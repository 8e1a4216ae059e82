#!/usr/bin/env python3
"""docs/tutorial.md, command by command: as it stands with PALPATE_LONG_TESTS (five minutes), else with a coarser mesh.
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

PAGE = ROOT / "docs/tutorial.md"


class TutorialPage(unittest.TestCase):
    def testLeadsFromASurfaceToAPlotAsItStands(self):
        if palpate is None:
            self.skipTest(missing)
        if shutil.which("gmsh") is None:
            self.skipTest("gmsh is not installed: the tutorial is NOT tested")
        page = PAGE.read_text(encoding="utf-8")
        self.assertEqual(page.count("--nodes 500"), 1)
        if not os.environ.get("PALPATE_LONG_TESTS"):
            page = page.replace("--nodes 500", "--nodes 200")
        blocks = re.findall(r"```(sh|python)\n(.*?)```", page, re.S)
        self.assertGreater(len(blocks), 6)
        with tempfile.TemporaryDirectory() as folder:
            bare = pathlib.Path(folder)
            environment = {**ENVIRONMENT, "PATH": f"{BIN}:/usr/bin:/bin", "MPLCONFIGDIR": folder}
            for language, text in blocks:
                # As if it were installed.
                text = text.replace("/usr/share/palpate/scenes", str(ROOT / "deploy/scenes"))
                text = text.replace("/usr/share/doc/palpate/examples", str(ROOT / "deploy/examples"))
                words = ["bash", "-ec", text] if language == "sh" else [sys.executable, "-c", text]
                done = subprocess.run(words, cwd=bare, env=environment, capture_output=True, text=True, check=False)
                some_points_failed = 3  # which the page says
                self.assertIn(done.returncode, (0, some_points_failed if text.startswith("palpate build") else 0),
                              text + done.stdout + done.stderr)
            for made in ("organ/scene.toml", "organ.h5", "stiffness.png", "curve.png", "press.pvd", "curve.csv"):
                self.assertGreater((bare / made).stat().st_size, 500, made)


if __name__ == "__main__":
    unittest.main()
