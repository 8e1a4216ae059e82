#!/usr/bin/env python3
"""Tests deploy/examples/mujoco, bullet and dart: a robot's finger palpates a body with the forces of a dataset. ctest runs each
suite separately; by hand PALPATE_BIN_DIR=build/release/bin tests/deploy/simulators_test.py."""
import ctypes.util
import importlib.util
import re
import subprocess
import unittest

from small_datasets import BIN, EXAMPLES, FINGER, TIP, WithDatasets, palpate

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
        # The energy is accounted for.
        stored, lost = map(float, re.search(r"^# energy: (\S+) mJ stored .* (\S+) mJ not accounted for$", done.stdout, re.M).groups())
        self.assertGreater(stored, 0.9 * 1e3 * dataset.query([0, 0, -1e-3 * depth.max()], active="tip").energy)
        self.assertLess(lost, 0.01 * stored)
        # The force that a robot without a force sensor estimates.
        np.testing.assert_allclose(felt[pressed], tissue[pressed], atol=5e-3)


class RobotsOfDart(WithAFinger):
    def testAFingerFeelsTheForceOfTheDataset(self):
        if importlib.util.find_spec("dartpy") is None:
            self.skipTest("python3-dartpy is not installed: the example for DART is NOT tested")
        self.followsTheDataset(self.run_python(EXAMPLES.parent / "dart/palpation.py", self.patch, 1e3 * DEPTH))
        done = self.run_python(EXAMPLES.parent / "dart/palpation.py", self.folder / "absent.h5")
        self.assertIn("absent.h5: there is no such dataset", done.stderr)

    def testAFingerMapsTheStiffnessOfASurface(self):
        if importlib.util.find_spec("dartpy") is None:
            self.skipTest("python3-dartpy is not installed: the example for DART is NOT tested")
        area, figure = self.build("area", FINGER, 0.01, 0.005), self.folder / "map.png"
        done = self.run_python(EXAMPLES.parent / "dart/robot_map.py", area, figure, 0.05, 0.05, 0.1, 7, 4, MPLCONFIGDIR=str(self.folder))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(figure.stat().st_size, 5000)
        rows = np.array([[float(word) for word in line.replace("mm", "").split()[:3]] for line in done.stdout.splitlines()])
        self.assertEqual(rows.shape, (25, 3))
        places = np.column_stack([0.05 + 1e-3 * rows[:, :2], np.full(25, 0.1)])
        expected = palpate.Dataset(area).query([0, 0, -0.003], at=places).force[:, 2] / 0.003
        self.assertGreater(expected.max(), 1.1 * expected.min())
        np.testing.assert_allclose(rows[:, 2], expected, rtol=0.05)


class WithACompiler(WithAFinger):
    """Builds C++ programs against an installed libpalpate."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.prefix = cls.folder / "prefix"
        for component in "library", "development":
            cls.expect_success("cmake", "--install", BIN.parent, "--prefix", cls.prefix, "--component", component)

    @staticmethod
    def expect_success(*words, **options):
        done = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False, **options)
        if done.returncode:
            raise AssertionError(f"{words}\n{done.stdout}{done.stderr}")
        return done.stdout

    def feelsTheForce(self, engine, needed):
        if ctypes.util.find_library(needed) is None:
            self.skipTest(f"lib{engine}-dev is not installed: the example for it is NOT tested")
        build = self.folder / "build"
        self.expect_success("cmake", "-S", EXAMPLES.parent / engine, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}",
                            "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Wpedantic -Werror")
        self.expect_success("cmake", "--build", build)
        run = {"capture_output": True, "text": True, "check": False}
        self.followsTheDataset(subprocess.run([build / "palpation", self.patch, str(1e3 * DEPTH)], **run))
        done = subprocess.run([build / "palpation", self.folder / "absent.h5"], **run)
        self.assertEqual(done.returncode, 1)
        self.assertIn("palpation: ", done.stderr)
        self.assertIn("absent.h5: there is no such dataset", done.stderr)


class RobotsOfMuJoCo(WithACompiler):
    def testAFingerFeelsTheForceOfTheDataset(self):
        self.feelsTheForce("mujoco", "mujoco")


class RobotsOfBullet(WithACompiler):
    def testAFingerFeelsTheForceOfTheDataset(self):
        self.feelsTheForce("bullet", "BulletDynamics")


STEPS = """#include <cstdio>
#include <palpate_sensor.hpp>
int main(int, char** argv) try {
  palpate::Sensor sensor(argv[1], 0.01);
  sensor.place({{30, -20, 90}, {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}}});
  double dt;
  palpate::Vector tip;
  while (std::scanf("%lf %lf %lf %lf", &dt, &tip[0], &tip[1], &tip[2]) == 4) {
    const palpate::Wrench felt = sensor.step(dt, tip);
    const palpate::Vector torque = felt.torque({30, -20, 90});
    std::printf("%.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %d %d %d\\n", felt.force[0], felt.force[1],
                felt.force[2], torque[0], torque[1], torque[2], felt.error_bound, felt.energy, felt.work, felt.touching,
                felt.inside, felt.jumped);
  }
  sensor.place({{0, 0, 0}, {{{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}}});
} catch (const std::exception& error) {
  std::puts(error.what());
}
"""


class RobotsInCpp(WithACompiler):
    def testASensorFeelsWhatThatOfPythonFeels(self):
        (self.folder / "steps.cpp").write_text(STEPS, encoding="utf-8")
        library = next(self.prefix.rglob("libpalpate.so")).parent
        self.expect_success("c++", "-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-I", self.prefix / "include",
                            self.folder / "steps.cpp", "-o", self.folder / "steps", f"-L{library}", "-lpalpate",
                            f"-Wl,-rpath,{library}")
        turn, place = np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]), np.array([30, -20, 90.0])
        depths = np.concatenate([np.linspace(-0.001, 0.006, 20), [0.002, 0.0025, -0.1, np.nan, -0.1, -0.001, 0.004]])
        tips = 100 * ([0.05, 0.05, 0.1] - np.outer(depths, [-0.1, 0.2, 1])) @ turn.T + place
        said = self.expect_success(self.folder / "steps", self.patch,
                                   input="".join(f"0.01 {x!r} {y!r} {z!r}\n" for x, y, z in tips.tolist())).splitlines()
        self.assertIn("left-handed", said.pop())
        sensor = palpate.Sensor(palpate.Dataset(self.patch), organ=(place, turn), metres=0.01)
        for line, tip in zip(said, tips, strict=True):
            felt = sensor.step(0.01, tip, about=place)
            np.testing.assert_allclose(np.array(line.split(), float), [*felt.force, *felt.torque, felt.error_bound, felt.energy,
                                       felt.work, felt.touching, felt.inside, felt.jumped], rtol=1e-9, atol=1e-9)
        self.assertTrue(felt.touching)


if __name__ == "__main__":
    unittest.main()
