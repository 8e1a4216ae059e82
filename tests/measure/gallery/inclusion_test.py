#!/usr/bin/env python3
"""Finds a ball in the skin of deploy/scenes from forces alone (docs/gallery.md). ctest runs each case separately; by hand
PALPATE_BIN_DIR=build/release/bin PALPATE_LONG_TESTS=1 tests/measure/gallery/inclusion_test.py."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests/deploy"))
from small_datasets import palpate

try:
    import numpy as np
    import palpation
except ImportError:  # NumPy and SciPy belong to the packages of the tests
    np = palpation = None

SCENES = ROOT / "deploy" / "scenes"
sys.path.insert(0, str(SCENES))
PALPATE = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", ROOT / "build/release/bin")).resolve() / "palpate"


def run(*words):
    return subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


@unittest.skipUnless(os.environ.get("PALPATE_LONG_TESTS"), "builds a dataset: set PALPATE_LONG_TESTS=1")
@unittest.skipUnless(palpation and palpate, "needs python3-scipy and the Python package")
class Inclusion(unittest.TestCase):
    """Finds a ball in the skin from forces alone: the top is pressed by 3 mm at 225 places. The true position is read
    afterwards.

    The gallery's skin is built with a touchable top only, in one coarse step, which takes half a minute of processor time.
    The finder (palpation.py) knows the layers of healthy skin. It was developed with the shipped block and one without a
    ball, before the other place was tried; its radii with all three, before the larger ball.
    """

    DEPTH = 0.003  # m, of each press
    REACH = 0.028  # m from the middle of the block

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def felt(self, scene):
        """What the finder feels under the skin of a scene whose mesh is in the folder."""
        scene = re.sub(r'surface = "all"', "surface = { box = { lowest = [-0.031, -0.031, 0.0199], "
                       "highest = [0.031, 0.031, 0.0201] } }", scene)
        scene = re.sub(r"(?s)\[workspace\].*?(?=\[device\])", "[workspace]\nradius = 0.004\nspacing = 0.004\n\n", scene)
        (self.folder / "skin.toml").write_text(scene, encoding="utf-8")
        built = run(PALPATE, "build", self.folder / "skin.toml", "-o", self.folder / "skin.h5")
        self.assertEqual(built.returncode, 0, built.stdout)
        grid = np.linspace(-self.REACH, self.REACH, 15)
        places = np.array([(x, y, 0.02) for x in grid for y in grid])
        sensor = palpate.Sensor(palpate.Dataset(self.folder / "skin.h5"), len(places))
        for depth in np.linspace(-0.0005, self.DEPTH, 36):
            felt = sensor.step(0.01, places - [0, 0, depth])
        self.assertTrue(felt.inside.all() and felt.touching.all())
        stiffness = felt.force[:, 2] / self.DEPTH
        layers = [(0.001, 333000), (0.002, 11670), (0.017, 1083)]
        return palpation.feel(places[:, :2], stiffness, layers, finger=0.012, half=0.036, lump=14170)

    def skin(self):
        return (SCENES / "skin" / "skin.toml").read_text(encoding="utf-8")

    def make(self, *options):
        if not shutil.which("gmsh"):
            self.skipTest("needs gmsh")
        made = run(SCENES / "skin" / "make_skin.py", "--out", self.folder, *options)
        self.assertEqual(made.returncode, 0, made.stdout)

    def truth(self):
        """Centre of the ball in the mesh, its depth, and the radius of a ball of the same volume, m."""
        from layers import read_mesh, volumes
        points, tetrahedra, group, names = read_mesh(self.folder / "skin.msh")
        ball = tetrahedra[[names[number] == "inclusion" for number in group]]
        size = volumes(points, ball)
        center = size @ points[ball].mean(axis=1) / size.sum()
        return center[:2], points[:, 2].max() - center[2], (3 * size.sum() / 4 / np.pi) ** (1 / 3)

    def hold(self, felt):
        place, depth, radius = self.truth()
        aside = np.linalg.norm(felt.place - place)
        print(f"felt at {1e3 * felt.place} mm, {1e3 * felt.depth:.1f} mm deep, radius {1e3 * felt.radius:.2f} mm, "
              f"{100 * felt.height:.0f} % stiffer; it is at {1e3 * place} mm, {1e3 * depth:.1f} mm deep, radius {1e3 * radius:.2f} mm")
        self.assertTrue(felt.found)
        self.assertLess(aside, 0.002)
        self.assertLess(abs(felt.depth - depth), 0.005)
        self.assertLess(abs(felt.radius - radius), 0.002)

    def testTheShippedInclusionIsFound(self):
        shutil.copy(SCENES / "skin" / "skin.msh", self.folder)
        self.hold(self.felt(self.skin()))

    def testAnInclusionAtAnUntunedPlaceIsFound(self):
        self.make("--inclusion", "-0.014", "0.007", "0.012", "0.005")
        self.hold(self.felt(self.skin()))

    def testALargerInclusionAtAnotherUntunedPlaceIsFound(self):
        self.make("--inclusion", "0.008", "0.015", "0.011", "0.0065")
        self.hold(self.felt(self.skin()))

    def testNoInclusionIsFoundInHealthySkin(self):
        self.make("--none")
        without = re.sub(r'(?s)\[\[region\]\][^\[]*group = "inclusion".*?(?=\[\[region)', "", self.skin())
        felt = self.felt(without)
        print(f"{100 * felt.height:.1f} % stiffer at most")
        self.assertFalse(felt.found)


if __name__ == "__main__":
    unittest.main()
