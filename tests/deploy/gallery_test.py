#!/usr/bin/env python3
"""deploy/scenes: what docs/gallery.md shows. ctest runs each case by itself; by hand
PALPATE_BIN_DIR=build/release/bin PALPATE_LONG_TESTS=1 tests/deploy/gallery_test.py."""
import functools
import importlib.util
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SCENES = ROOT / "deploy" / "scenes"
PALPATE = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", ROOT / "build/release/bin")).resolve() / "palpate"


def run(*words, **options):
    return subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)


def script(path):
    """A script of deploy/scenes as a module."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Gallery(unittest.TestCase):
    def testEveryShippedSceneIsValid(self):
        scenes = sorted(SCENES.glob("*/*.toml"))
        self.assertGreaterEqual(len(scenes), 9)
        for scene in scenes:
            with self.subTest(scene=scene.name):
                checked = run(PALPATE, "check", scene)
                self.assertEqual(checked.returncode, 0, checked.stdout)

    def testEveryMeshIsSmallEnoughToReview(self):
        for mesh in SCENES.glob("*/*.msh"):
            self.assertLessEqual(mesh.stat().st_size, 1 << 20, mesh)

    def testThePageHasEverySceneThatIsTouchedEverywhere(self):
        page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
        for scene in SCENES.glob("*/*.toml"):
            if 'tool = "finger"' in scene.read_text(encoding="utf-8"):
                self.assertIn(f"deploy/scenes/{scene.parent.name}/{scene.name}", page)
                self.assertIn(f"gallery-{scene.parent.name}.png", page)


if __name__ == "__main__":
    unittest.main()
