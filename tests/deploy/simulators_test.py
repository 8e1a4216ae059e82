#!/usr/bin/env python3
"""Tests deploy/examples/mujoco and dart: a robot's finger palpates a body with the forces of a dataset. ctest runs each
suite separately; by hand PALPATE_BIN_DIR=build/release/bin tests/deploy/simulators_test.py."""
import ctypes.util
import importlib.util
import subprocess
import unittest

from small_datasets import BIN, EXAMPLES, TIP, WithDatasets, palpate

if palpate is not None:
    import numpy as np

DEPTH = 0.004  # m


class WithAFinger(WithDatasets):
    """Reads the printed lines of numbers: time, depth (mm), forces (N) of the tissue and felt in the joints, bound."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        # The finger pushes a patch of the body, not a single node.
        cls.patch = cls.build("patch", TIP.replace("0.1]\n[[", "0.1]\nradius = 0.03\n[[", 1), 0.02, 0.01)

    def followsTheDataset(self, done):
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        lines = [line.split() for line in done.stdout.splitlines() if line.strip() and not line.startswith("#")]
        touching = np.array([line[-1] == "touching" for line in lines])
        values = np.array([[float(word) for word in line[:9]] for line in lines])
        depth, tissue, felt, bound = values[:, 1], values[:, 2:5], values[:, 5:8], values[:, 8]
        self.assertGreaterEqual(len(lines), 40)
        # The finger approaches, presses, and leaves.
        self.assertEqual(touching.tolist(), (depth > 0).tolist())
        self.assertFalse(touching[0] or touching[-1])
        self.assertGreater(depth.max(), 0.5)
        self.assertTrue((tissue[~touching] == 0).all())
        # The force equals that of the dataset at the finger's position; the printed depth has three digits.
        dataset = palpate.Dataset(self.patch)
        pressed = depth > 0.2
        expected = dataset.query(-1e-3 * depth[pressed, None] * [0, 0, 1], active="tip")
        np.testing.assert_allclose(tissue[pressed], expected.force, rtol=0.01, atol=5e-3)
        self.assertTrue((bound[pressed] > 0).all())
        # The force that a robot without a force sensor estimates.
        np.testing.assert_allclose(felt[pressed], tissue[pressed], atol=5e-3)


class RobotsOfDart(WithAFinger):
    def testAFingerFeelsTheForceOfTheDataset(self):
        if importlib.util.find_spec("dartpy") is None:
            self.skipTest("python3-dartpy is not installed: the example for DART is NOT tested")
        self.followsTheDataset(self.run_python(EXAMPLES.parent / "dart/palpation.py", self.patch, 1e3 * DEPTH))
        done = self.run_python(EXAMPLES.parent / "dart/palpation.py", self.folder / "absent.h5")
        self.assertIn("absent.h5: there is no such dataset", done.stderr)


class RobotsOfMuJoCo(WithAFinger):
    def testAFingerFeelsTheForceOfTheDataset(self):
        if ctypes.util.find_library("mujoco") is None:
            self.skipTest("libmujoco-dev is not installed: the example for MuJoCo is NOT tested")
        prefix, build = self.folder / "prefix", self.folder / "build"
        for words in (("cmake", "--install", BIN.parent, "--prefix", prefix, "--component", "library"),
                      ("cmake", "--install", BIN.parent, "--prefix", prefix, "--component", "development"),
                      ("cmake", "-S", EXAMPLES.parent / "mujoco", "-B", build, f"-DCMAKE_PREFIX_PATH={prefix}",
                       "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror"),
                      ("cmake", "--build", build)):
            done = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        run = {"capture_output": True, "text": True, "check": False}
        self.followsTheDataset(subprocess.run([build / "palpation", self.patch, str(1e3 * DEPTH)], **run))
        done = subprocess.run([build / "palpation", self.folder / "absent.h5"], **run)
        self.assertEqual(done.returncode, 1)
        self.assertIn("palpation: ", done.stderr)
        self.assertIn("absent.h5: there is no such dataset", done.stderr)


if __name__ == "__main__":
    unittest.main()
