#!/usr/bin/env python3
"""Tests deploy/python, the Python package, on datasets that the programs build here. ctest runs each suite separately; by
hand PALPATE_BIN_DIR=build/release/bin tests/deploy/python_test.py."""
import contextlib
import copy
import dataclasses
import importlib.util
import inspect
import json
import os
import pickle
import re
import shutil
import subprocess
import sys
import threading
import time
import unittest
import unittest.mock

from small_datasets import BIN, EXAMPLES, FINGER, LIBRARY, PACKAGE, ROOT, SCENE, TIP, WithDatasets, palpate

if palpate is not None:
    import h5py
    import numpy as np


class PythonQueries(WithDatasets):
    def testAnswersMatchTheProgramToTheLastBit(self):
        displacements = np.random.default_rng(5).uniform(-0.015, 0.015, (20, 3))
        with palpate.Dataset(self.file) as dataset:
            answers = dataset.query(displacements, active="tip")
        lines = "".join(" ".join(map(repr, p)) + "\n" for p in displacements.tolist())
        said = subprocess.run([BIN / "palpate", "query", self.file, "--active", "tip", "--displacement", "-", "--json"],
                              input=lines, capture_output=True, text=True, check=False)
        said = [json.loads(line) for line in said.stdout.splitlines()]
        self.assertEqual(len(said), len(displacements))
        for n, one in enumerate(said):
            for member in ("force", "stiffness"):
                np.testing.assert_array_equal(getattr(answers, member)[n], one[member])
            for member in ("energy", "error_bound", "coverage", "inside"):
                np.testing.assert_equal(getattr(answers, member)[n], np.nan if one[member] is None else one[member])

    def testArraysOfAnyShapeAreAnsweredAndOldAnswersAreOverwritten(self):
        dataset = palpate.Dataset(self.file)
        displacements = np.random.default_rng(6).uniform(-0.01, 0.01, (2, 5, 3))
        answers = dataset.query(displacements, active=0)
        self.assertEqual((answers.force.shape, answers.stiffness.shape, answers.energy.shape), ((2, 5, 3), (2, 5, 3, 3), (2, 5)))
        one = dataset.query(displacements[1, 2], active=0)
        self.assertEqual(one.force.shape, (3,))
        np.testing.assert_array_equal(one.force, answers.force[1, 2])
        np.testing.assert_array_equal(dataset.query(displacements[:, ::-2], active=0).force, answers.force[:, ::-2])
        force = answers.force
        self.assertIs(dataset.query(2 * displacements, active=0, out=answers), answers)
        np.testing.assert_array_equal(force, dataset.query(2 * displacements, active=0).force)
        with self.assertRaisesRegex(ValueError, "out.force must be the array of an earlier answer"):
            dataset.query(displacements[0], active=0, out=answers)
        self.assertEqual(dataset.query(np.empty((0, 3)), active=0).force.shape, (0, 3))

    def testPlacesOutsideAndNaNAreMarkedAndNotErrors(self):
        answers = palpate.Dataset(self.file).query([[0, 0, -0.01], [0, 0, 1], [np.nan, 0, 0]], active="tip")
        self.assertEqual(answers.inside.tolist(), [True, False, False])
        self.assertTrue(np.isfinite(answers.force).all() and np.isfinite(answers.stiffness).all())
        self.assertGreater(answers.force[0, 2], 0)  # the tissue pushes back
        self.assertEqual(answers.force[2].tolist(), [0, 0, 0])

    def testTheBodyMatchesTheFile(self):
        dataset = palpate.Dataset(self.file, methods=["tricubic"])
        self.assertEqual(dataset.methods, ("tricubic",))
        self.assertEqual([space.name for space in dataset.spaces], ["tip", "rim"])
        self.assertEqual((dataset.name, dataset.areas, len(dataset.content_id)), ("nodes", (), 64))
        tip = dataset.spaces[0]
        np.testing.assert_allclose(tip.rest_position, (0.05, 0.05, 0.1))
        np.testing.assert_array_equal(dataset.vertices[tip.vertex], tip.rest_position)
        a, b, c = dataset.vertices[dataset.triangles].transpose(1, 0, 2)
        self.assertAlmostEqual(np.einsum("ni,ni", a, np.cross(b, c)) / 6, 0.1 ** 3)  # the volume is positive if normals point outward
        self.assertTrue(dataset.touchable.any() and not dataset.touchable.all())
        shape = dataset.shape((0, 0, -0.01), active="tip")
        np.testing.assert_allclose(shape[tip.vertex], (0, 0, -0.01), atol=1e-5)

    def testAFileCanBeOpenedWhileH5pyReadsOthers(self):
        stop, read = threading.Event(), []

        def reads():
            while not stop.is_set():
                with palpate.Arrays(self.file) as arrays:
                    read.append(len(arrays["tip"].force))

        reader = threading.Thread(target=reads)
        reader.start()
        for _ in range(5):
            self.assertEqual(palpate.Dataset(self.file).name, "nodes")
        stop.set()
        reader.join()
        self.assertGreater(len(set(read)), 0)

    def testManyThreadsCanAskAtOnceWhileOthersRun(self):
        dataset = palpate.Dataset(self.file)
        displacements = np.random.default_rng(8).uniform(-0.01, 0.01, (400000, 3))
        expected = dataset.query(displacements, active=0).force
        equal = []
        threads = [threading.Thread(target=lambda: equal.append(np.array_equal(dataset.query(displacements, active=0).force, expected)))
                   for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(equal, [True] * 3)
        # With a switch interval of 1000 s, another thread only runs while this one releases the interpreter: during the
        # call.
        held, ran, interval = threading.Lock(), [], sys.getswitchinterval()
        with held:
            other = threading.Thread(target=lambda: held.acquire() and ran.append(True))
            other.start()
            sys.setswitchinterval(1000)
        try:
            dataset.query(displacements, active=0)
            self.assertEqual(ran, [True])
        finally:
            sys.setswitchinterval(interval)
            other.join()

    def testItStaysOpenUntilItsLastCallHasEnded(self):
        dataset = palpate.Dataset(self.file)
        again, expected = copy.copy(dataset), dataset.query([0, 0, -0.01], active=0).force
        ask = palpate._library.functions["query_many"]

        def closing(*arguments):  # another thread may close it
            dataset.close()
            again.close()
            return ask(*arguments)

        with unittest.mock.patch.dict(palpate._library.functions, query_many=closing):
            np.testing.assert_array_equal(dataset.query([0, 0, -0.01], active=0).force, expected)
        with self.assertRaisesRegex(palpate.Error, "was closed"):
            dataset.query([0, 0, -0.01], active=0)

    def testRepeatedAnswersAreEqualEvenIfUnknown(self):
        one, other = palpate.Dataset(self.file), palpate.Dataset(self.file)
        p = [[0, 0, -0.01], [0, 0, 1]]
        for method in ("potential", "trilinear"):  # its energy is NaN
            self.assertEqual(one.query(p, active="tip", method=method), other.query(p, active="tip", method=method))
        answers = one.query(p, active="tip")
        for different in (one.query(p[:1], active="tip"), one.query(p[::-1], active="tip"), p,
                          dataclasses.replace(answers, drive=answers.force)):
            self.assertNotEqual(answers, different)
        self.assertEqual(one.spaces, other.spaces)
        self.assertNotEqual(one.spaces[0], one.spaces[1])
        with palpate.Contact(one) as contact, palpate.Guard() as guard, palpate.Guard() as same:
            tool = one.spaces[0].rest_position
            away, touches = contact.update(tool + [0, 0, 1]), contact.follow([tool - [0, 0, 0.001]] * 2)
            self.assertTrue(touches[0].touching)
            self.assertEqual(dataclasses.replace(touches[1], stepped=touches[0].stepped), touches[0])
            self.assertNotEqual(away, touches[0])
            self.assertEqual(guard.limit(tool, touches[0]), same.limit(tool, touches[0]))

    def testAFileCanBeOpenedWhileOthersImport(self):
        class Meanwhile(str):
            def startswith(self, *words):
                modules["another"] = None
                return super().startswith(*words)

        modules = {Meanwhile("one"): None, "two": None}
        with unittest.mock.patch.object(palpate.dataset, "sys", unittest.mock.Mock(modules=modules)):
            self.assertEqual(palpate.Dataset(self.file).name, "nodes")

    def testErrorsCanBePickled(self):
        with self.assertRaises(palpate.Error) as caught:
            palpate.Dataset(self.folder / "absent.h5")
        received = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((str(received), received.status), (str(caught.exception), caught.exception.status))
        self.assertIn("absent.h5: there is no such dataset", str(received))

    def testADatasetIsPickledByItsPathAndAContactIsNot(self):
        with contextlib.chdir(self.file.parent):
            dataset = palpate.Dataset(self.file.name, ["trilinear"])
        received = pickle.loads(pickle.dumps(dataset))
        self.assertEqual((received.content_id, received.methods), (dataset.content_id, ("trilinear",)))
        np.testing.assert_array_equal(received.query([0, 0, -0.01], active=0).force, dataset.query([0, 0, -0.01], active=0).force)
        touch = palpate.Contact(dataset).update([0, 0, 1])
        self.assertEqual(pickle.loads(pickle.dumps(touch)), touch)
        for stays in palpate.Contact(dataset), palpate.Guard():
            with self.assertRaisesRegex(TypeError, "stays in its process"):
                pickle.dumps(stays)
        with palpate.Arrays(self.file) as arrays:
            again, space = pickle.loads(pickle.dumps((arrays, arrays["tip"])))
        self.assertEqual(again.content_hash, dataset.content_id)
        self.assertEqual(space.position.shape[1:], (3,))
        moved = palpate.Dataset(shutil.copy(self.file, self.folder / "moved.h5"))
        sent = pickle.dumps(moved)
        shutil.copy(self.build("other", TIP, 0.01, 0.01), self.folder / "moved.h5")
        with self.assertRaisesRegex(palpate.Error, "moved.h5: was replaced"):
            pickle.loads(sent)

    def testInvalidQueriesNameTheErrorAndValidChoices(self):
        dataset = palpate.Dataset(self.file)
        for ask, text in ((lambda: dataset.query([0, 0, 0]), "name the active node; there are: tip, rim"),
                          (lambda: dataset.query([0, 0, 0], active="nose"), "no active node 'nose'; there are: tip, rim"),
                          (lambda: dataset.query([0, 0, 0], active=7), "no active node 7"),
                          (lambda: dataset.query([0, 0, 0], active="tip", method="quick"), "there are: potential, trilinear"),
                          (lambda: dataset.query([0, 0, 0], at=[0, 0, 0]), "name the area; there are: none"),
                          (lambda: palpate.Dataset(self.folder / "absent.h5"), "absent.h5: there is no such dataset"),
                          (lambda: palpate.Dataset(self.folder / "block.msh"), "block.msh: is not an HDF5 file"),
                          (lambda: palpate.Dataset(self.file, methods=["quick"]), "method \"quick\""),
                          (lambda: palpate.device("spoon"), "spoon")):
            with self.assertRaisesRegex(palpate.Error, text):
                ask()
        for ask in (lambda: dataset.query([0, 0]), lambda: dataset.query(0.01), lambda: dataset.shape(np.zeros((2, 3)), active=0)):
            with self.assertRaisesRegex(ValueError, "shape"):
                ask()
        dataset.close()
        frozen = palpate.Dataset(self.file).query([0, 0, 0.01], active=0)
        frozen.force.flags.writeable = False
        with self.assertRaisesRegex(ValueError, "out.force"):
            palpate.Dataset(self.file).query([0, 0, 0.01], active=0, out=frozen)
        with self.assertRaisesRegex(palpate.Error, "was closed"):
            dataset.query([0, 0, 0], active=0)


class PythonFingers(WithDatasets):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.finger = cls.build("finger", FINGER, 0.01, 0.005)

    def testAFingerAnswersAtOneOrManyPlaces(self):
        dataset = palpate.Dataset(self.finger)
        self.assertEqual([area.name for area in dataset.areas], ["finger"])
        p, at = (0.001, 0, -0.006), np.array([(0.05, 0.05, 0.104), (0.045, 0.052, 0.1)])
        answers = dataset.query(p, at=at)
        self.assertEqual((answers.force.shape, answers.drive.shape, answers.triangle.shape), ((2, 3), (2, 3), (2,)))
        np.testing.assert_allclose(answers.at[:, 2], 0.1)  # the nearest point of the surface
        self.assertTrue(answers.inside.all() and (answers.force[:, 2] > 0).all())
        np.testing.assert_allclose(answers.distance, (0.004, 0), atol=1e-12)
        away = dataset.query(p, at=1e3 * at)  # given in millimetres by mistake
        self.assertEqual(away.inside.tolist(), [False, False])
        self.assertTrue((away.distance > 50).all() and np.isfinite(away.force).all())
        said = json.loads(self.run_program("query", self.finger, "--at", *at[1], "--displacement", *p, "--json"))
        np.testing.assert_array_equal(answers.force[1], said["force"])
        np.testing.assert_allclose(answers.drive[1], said["drive"], atol=1e-12)
        self.assertEqual((answers.inside[1], answers.distance[1]), (said["inside"], said["distance"]))
        many = dataset.query(np.outer((0.2, 0.6, 1), p), at=at[1])
        np.testing.assert_array_equal(many.force[2], answers.force[1])
        self.assertIs(dataset.query(p, at=at, out=answers), answers)
        with self.assertRaisesRegex(palpate.Error, "one method only"):
            dataset.query(p, at=at, method="trilinear")
        for again in self.examples_draw("stiffness_map.py", self.finger, "3"):
            self.assertRegex(again, r"[0-9]+ places, [0-9.]+ to [0-9.]+ N/mm")

    def examples_draw(self, script, *words):
        figure = self.folder / "figure.png"
        done = self.run_python(EXAMPLES / script, words[0], figure, *words[1:], MPLCONFIGDIR=str(self.folder))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(figure.stat().st_size, 10000)
        yield done.stdout


class PythonSensors(WithDatasets):
    DOWN = np.array([0, 0, -1.0]) if palpate is not None else None

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.finger = palpate.Dataset(cls.build("finger", FINGER, 0.01, 0.005))
        cls.top = np.array([0.05, 0.05, 0.1])

    def path(self, depths):
        return self.top + np.outer(depths, self.DOWN)

    def testForcesComeInTheFrameAndUnitsOfTheEngine(self):
        path = self.path(np.linspace(-0.001, 0.004, 11)) + np.outer(np.linspace(0, 0.003, 11), [1, 0, 0])
        expected = palpate.Contact(self.finger).follow(path)
        self.assertTrue(expected[-1].touching)
        turn, place, tip = np.array([[0, 0, 1.0], [1, 0, 0], [0, 1, 0]]), np.array([30, -20, 90.0]), np.array([0, 3.0, 1])
        for mirror, signs in ("", [1, 1, 1]), ("x", [-1, 1, 1]), ("z", [1, 1, -1]):
            given = 100 * (path * signs) @ turn.T + place  # an engine in centimetres
            sensor = palpate.Sensor(self.finger, organ=(place, [0.5, 0.5, 0.5, 0.5]), metres=0.01, mirror=mirror, tip=tip)
            for touch, point in zip(expected, given):
                felt = sensor.step(0.001, point - turn @ tip, turn)  # the axes of the tool are those of the organ
                np.testing.assert_allclose(felt.force, 100 * turn @ (signs * touch.force), atol=1e-8)
                self.assertAlmostEqual(felt.error_bound, 100 * touch.error_bound)
                self.assertAlmostEqual(felt.energy, 1e4 * touch.energy)
                np.testing.assert_allclose(felt.torque, np.cross(turn @ tip, felt.force), atol=1e-6)
                np.testing.assert_allclose(felt.force + felt.organ_force, 0)
                np.testing.assert_allclose(np.cross(felt.point - place, felt.force) + felt.organ_torque, 0, atol=1e-6)
            about = sensor.step(0.001, point - turn @ tip, turn, about=felt.point)
            np.testing.assert_allclose(about.torque, 0, atol=1e-6)

    def testOneOfManyAndAMovingOrganFeelTheSame(self):
        path = self.path(np.linspace(-0.001, 0.004, 11))
        one, many, moved = (palpate.Sensor(self.finger, count) for count in (None, 3, None))
        for point in path:
            felt, all_felt = one.step(0.001, point), many.step(0.001, np.tile(point, (3, 1)), organ=([0, 0, 0], None))
            pushed = moved.step(0.001, path[0], organ=(path[0] - point, [1, 0, 0, 0]))
            np.testing.assert_array_equal(all_felt.force, np.tile(felt.force, (3, 1)))
            np.testing.assert_allclose(pushed.force, felt.force, rtol=1e-9, atol=1e-12)
            self.assertAlmostEqual(pushed.work, felt.work)
        self.assertGreater(felt.force[2], 0.05)

    def testALongStepIsMadeOfShortOnes(self):
        short, long = palpate.Sensor(self.finger), palpate.Sensor(self.finger)
        for depth in np.linspace(-0.0005, 0.004, 10):
            expected = short.step(0.001, self.path([depth])[0])
        long.step(0.02, self.path([-0.0005])[0])
        felt = long.step(0.009, self.path([0.004])[0])
        np.testing.assert_allclose(felt.force, expected.force, rtol=1e-9)
        self.assertAlmostEqual(felt.work, expected.work, delta=0.01 * expected.work)
        self.assertFalse(felt.jumped)
        jumped = long.step(0.009, self.path([-0.2])[0])  # 200 mm in 9 ms: a reset
        self.assertTrue(jumped.jumped and not jumped.touching)
        self.assertAlmostEqual(jumped.gap, 0.2)
        inside = long.step(0.009, self.path([0.004])[0])
        self.assertTrue(inside.jumped and not inside.touching)
        self.assertEqual(inside.force.tolist(), [0, 0, 0])

    def testTheWorkOfAToolIsStoredOrLostToFriction(self):
        sensor = palpate.Sensor(self.finger)
        angles = np.linspace(0, 2 * np.pi, 500)
        pressed = [sensor.step(0.002, point) for point in self.path(0.004 * (1 - np.cos(angles)) / 2 - 0.0005)]
        most = max(felt.energy for felt in pressed)
        self.assertGreater(most, 1e-5)
        for felt in pressed:
            self.assertAlmostEqual(felt.work, felt.energy, delta=0.01 * most)
        self.assertFalse(pressed[-1].touching)
        sensor.release()
        for point in self.path(np.linspace(-0.0005, 0.004, 200)):
            sensor.step(0.002, point)
        losses = [felt.work - felt.energy for felt in
                  (sensor.step(0.002, point + [slide, 0, 0]) for slide in np.linspace(0, 0.015, 400))]
        self.assertGreater(losses[-1], 10 * abs(losses[0]))
        self.assertGreater(np.diff(losses).min(), -1e-3 * losses[-1])  # friction only takes energy

    def testAToolThatBouncesOffAFreeOrganKeepsMomentumAndEnergy(self):
        sensor, dt, masses = palpate.Sensor(self.finger), 0.0001, np.array([0.1, 0.3])
        places, speeds = np.array([self.top + [0, 0, 0.001], [0, 0, 0]]), np.array([[0, 0, -0.3], [0, 0, 0]])
        momentum, energy, worst, most = masses @ speeds, 0.5 * masses @ (speeds**2).sum(axis=1), 0, 0
        for _ in range(1000):
            felt = sensor.step(dt, places[0], organ=(places[1], None))
            worst = max(worst, abs(0.5 * masses @ (speeds**2).sum(axis=1) + felt.work - energy))
            most = max(most, felt.energy)
            speeds += dt * np.array([felt.force, felt.organ_force]) / masses[:, None]
            places += dt * speeds
        self.assertFalse(felt.touching)
        self.assertGreater(speeds[0, 2], 0.1)  # it went back
        self.assertGreater(most, 0.5 * energy)
        np.testing.assert_allclose(masses @ speeds, momentum, atol=1e-12)
        self.assertLess(worst, 0.01 * energy)
        self.assertLess(abs(felt.work), 0.01 * energy)

    def testABadPoseOfOneToolIsFlaggedAndTheOthersGoOn(self):
        sensor = palpate.Sensor(self.finger, 4)
        quaternions = np.tile([1.0, 0, 0, 0], (4, 1))
        for depth in np.linspace(-0.001, 0.003, 9):
            positions = np.tile(self.path([depth]), (4, 1))
            positions[1, 0], quaternions[2], positions[3, 2] = np.nan, 0, np.inf
            felt = sensor.step(0.001, positions, quaternions)
        self.assertEqual(felt.inside.tolist(), [True, False, False, False])
        self.assertEqual(felt.touching.tolist(), [True, False, False, False])
        self.assertGreater(felt.force[0, 2], 0.05)
        for values in felt.force, felt.torque, felt.organ_force, felt.organ_torque, felt.work:
            self.assertTrue((values[1:] == 0).all() and np.isfinite(values).all())

    def testAProbePressesWithThreeNewtons(self):
        (self.folder / "firm.toml").write_text(SCENE.format(name="firm", active=FINGER, radius=0.01, spacing=0.005)
                                               .replace("1300", "13000").replace("1280", "12800"), encoding="utf-8")
        self.run_program("build", self.folder / "firm.toml", "-o", self.folder / "firm.h5", "-q")
        done = self.run_python(EXAMPLES / "probe.py", self.folder / "firm.h5", *self.top)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("deeper than computed", done.stdout)
        self.assertLess(float(re.search(r"worst deviation while sweeping: (\S+) N", done.stdout)[1]), 0.03)
        forces = [float(force) for force in re.findall(r"deep +(\S+) N", done.stdout)]
        self.assertEqual((len(forces), forces[0]), (16, 0))
        np.testing.assert_allclose(forces[4:], 3, atol=0.03)

    def testWrongHandsAndUnitsAreSentences(self):
        left = np.diag([1, 1, -1.0])
        sensor = palpate.Sensor(self.finger)
        self.assertRegex(repr(palpate.Sensor(self.finger, metres=0.001)), "100 engine units long")
        for ask, text in ((lambda: palpate.Sensor(self.finger, organ=([0, 0, 0], left)), "organ's rotation is a left-handed matrix"),
                          (lambda: sensor.step(0.001, [0, 0, 1], left), "tool's rotation is a left-handed matrix"),
                          (lambda: sensor.step(0.001, [0, 0, 1], 1000 * np.eye(3)), "has a scale"),
                          (lambda: sensor.step(0.001, [0, 0, 1], [1, 0, 0]), "must be a quaternion"),
                          (lambda: sensor.step(2, [0, 0, 1]), "time step in seconds"),
                          (lambda: sensor.step(np.nan, [0, 0, 1]), "time step in seconds"),
                          (lambda: sensor.step(0.001, [0, 0]), "must be x, y and z"),
                          (lambda: palpate.Sensor(self.finger, organ=([0, 0, np.nan], None)), "organ's pose is not finite"),
                          (lambda: palpate.Sensor(self.finger, metres=0), "engine's unit in metres"),
                          (lambda: palpate.Sensor(self.finger, mirror="left"), "must be the axis")):
            with self.assertRaisesRegex(ValueError, f"^[^\n]*{text}[^\n]*$"):
                ask()
        with unittest.mock.patch.object(self.finger, "vertices", 1000 * self.finger.vertices):
            with self.assertRaisesRegex(ValueError, "the organ is 100 m long; .*length_unit"):
                palpate.Sensor(self.finger)


class PythonContacts(WithDatasets):
    def pressing(self, tip, depths):
        return tip.rest_position + np.outer(depths, (0, 0, -1))

    def testAToolPressesIsPushedBackAndReleases(self):
        dataset = palpate.Dataset(self.file)
        tip = dataset.spaces[0]
        with palpate.Contact(dataset) as contact:
            depths = np.concatenate([np.linspace(-0.002, 0.008, 50), np.linspace(0.008, -0.002, 50)])
            touches = contact.follow(self.pressing(tip, depths))
            self.assertEqual((touches[0].touching, touches[49].touching, touches[-1].touching), (False, True, False))
            self.assertAlmostEqual(touches[0].gap, 0.002)
            deepest = touches[49]
            expected = dataset.query(deepest.displacement, active="tip").force
            np.testing.assert_allclose(deepest.force, expected, rtol=0.2)
            self.assertGreater(deepest.force[2], 0)
            np.testing.assert_allclose(deepest.anchor + deepest.displacement, self.pressing(tip, [0.008])[0], atol=1e-9)
            shape = contact.shape(deepest)
            self.assertLess(shape[tip.vertex, 2], -0.004)
            self.assertFalse(contact.shape(touches[0]).any())

    def testOptionsAreThoseOfTheSceneByDefault(self):
        dataset = palpate.Dataset(self.file)
        options = palpate.Contact.defaults(dataset)
        self.assertEqual(options.mode, palpate.ContactMode.UNILATERAL)
        options.mode = palpate.ContactMode.GLUED
        tip = dataset.spaces[0]
        with palpate.Contact(dataset, options, method="trilinear") as contact:
            held = contact.follow(self.pressing(tip, np.linspace(-0.001, -0.006, 20)))[-1]
            self.assertLess(held.force[2], 0)  # it pulls the tool back
            contact.use(dataset, "potential")
            self.assertTrue(contact.update(held.anchor + held.displacement).touching)
            self.assertFalse(contact.update(held.anchor + held.displacement, hold=False).touching)
            contact.release()
        options.friction = -1
        with self.assertRaisesRegex(palpate.Error, "friction"):
            palpate.Contact(dataset, options)

    def testManyContactsEqualSingleOnesToTheLastBit(self):
        n, random = 100, np.random.default_rng(9)
        places, depths = random.uniform((0.04, 0.04, 0.1), (0.06, 0.06, 0.1), (n, 3)), random.uniform(0.002, 0.008, n)
        frictions = random.uniform(0, 1, n)
        for file in self.file, self.build("finger", FINGER, 0.01, 0.005):
            dataset, options = palpate.Dataset(file), palpate.Contact.defaults(palpate.Dataset(file))
            single = [palpate.Contact(dataset, dataclasses.replace(options, friction=friction)) for friction in frictions]
            many, out, touching = palpate.Contacts(dataset, n, threads=2), None, 0
            many.set_friction(frictions)
            self.assertEqual(len(many), n)
            for phase in np.linspace(0, 1, 40):
                tools = places + np.outer(0.001 - depths * np.sin(3 * phase), (0, 0, 1)) + [0.01 * phase, 0, 0]
                if 0.5 < phase < 0.53:
                    tools[7, 1] = np.nan
                if 0.7 < phase < 0.73:
                    which = np.arange(n) % 3 == 0
                    many.release(which)
                    for contact in np.array(single)[which]:
                        contact.release()
                out = many.update(tools, out=out)
                for i, touch in enumerate(contact.update(tool) for contact, tool in zip(single, tools)):
                    for field in dataclasses.fields(palpate.Touches):
                        np.testing.assert_array_equal(getattr(out, field.name)[i], getattr(touch, field.name), field.name)
                touching += out.touching.sum()
                self.assertEqual(many.touch(31), single[31].update(tools[31]))
                single[31].release()
                many.release(np.arange(n) == 31)
            self.assertGreater(touching, 1000)
            np.testing.assert_array_equal(many.shape(many.touch(1)), single[1].shape(many.touch(1)))
            self.assertFalse(many.update(tools).touching[31])
            many.release()
            self.assertFalse(many.update(tools).touching.any())

    def testManyContactsTakeOddArraysAndRefuseWrongOnes(self):
        dataset = palpate.Dataset(self.file)
        contacts = palpate.Contacts(dataset, 3, dataclasses.replace(palpate.Contact.defaults(dataset), mode=palpate.ContactMode.GLUED))
        tools = np.tile(dataset.spaces[0].rest_position, (3, 1))
        self.assertTrue(contacts.update(tools).touching.all())
        self.assertEqual(contacts.update(np.asfortranarray(tools, np.float32), hold=[True, False, True]).touching.tolist(),
                         [True, False, True])
        self.assertFalse(contacts.update(tools, hold=False).touching.any())
        out = contacts.update(tools)
        contacts.set_friction(0.5)
        for wrong, text in ((lambda: contacts.update(tools[:2]), "tools have shape"),
                            (lambda: contacts.update(tools, hold=[True] * 2), "broadcast"),
                            (lambda: contacts.release([True] * 2), "broadcast"),
                            (lambda: contacts.set_friction([0.1] * 2), "broadcast"),
                            (lambda: palpate.Contacts(dataset, 2).update(tools[:2], out=out), "out.touching")):
            with self.assertRaisesRegex(ValueError, text):
                wrong()
        for wrong, text in ((lambda: contacts.set_friction([0.1, -1, 0.1]), "friction 1 is -1"),
                            (lambda: contacts.touch(3), "contact 3 does not exist"),
                            (lambda: palpate.Contacts(dataset, 3, threads=-1), "threads is -1")):
            with self.assertRaisesRegex(palpate.Error, text):
                wrong()
        contacts.close()
        with self.assertRaisesRegex(palpate.Error, "this Contacts was closed"):
            contacts.update(tools)

    def testAGuardLimitsTheForceOfADevice(self):
        dataset = palpate.Dataset(self.file)
        options = palpate.Guard.defaults("touch", period=0.001)
        options.max_force = 0.05
        with palpate.Guard(options) as guard, palpate.Contact(dataset) as contact:
            for tool in self.pressing(dataset.spaces[0], np.linspace(-0.001, 0.01, 300)):
                touch = contact.update(tool)
                given = guard.limit(tool, touch)
                self.assertLessEqual(np.linalg.norm(given.force), 0.05 * (1 + 1e-12))
            self.assertIn("clamped", given.guards)
            self.assertEqual(guard.limit(tool, touch, lost=True).force.tolist(), [0, 0, 0])
            guard.reset()
            wall = dataclasses.replace(contact.update([1, 1, 1]), touching=True, force=np.array([0, 0, 0.02]))
            for _ in range(1000):  # until the force has faded in
                given = guard.limit([1, 1, 1], wall)
            np.testing.assert_allclose(given.force, [0, 0, 0.02], atol=1e-9)
            deep = contact.update(tool)
            dataset.close()
            self.assertEqual(contact.shape(deep).shape[1], 3)
        self.assertGreater(palpate.device("touch").max_force, 1)


class PythonLive(WithDatasets):
    """A finger on the cube, pressed 5 mm deep in a second and held there."""

    WORKER = BIN / "palpate-worker"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scene = cls.folder / "finger.toml"
        cls.dataset = palpate.Dataset(cls.build("finger", FINGER, 0.01, 0.01))

    @staticmethod
    def press(contact, seconds, begin=0):
        for n in range(int(1000 * begin), int(1000 * (begin + seconds))):
            touch = contact.update((0.051, 0.048, max(0.101 - 6e-6 * n, 0.095)))
            time.sleep(0.001)
        return touch

    def assertIsExact(self, touch):
        said = self.run_program("solve", self.scene, "--json", "--at", *touch.anchor, "--displacement", *touch.displacement)
        exact = np.array(json.loads(said)["force"])
        error, force = np.linalg.norm(touch.force - exact), np.linalg.norm(exact)
        self.assertGreater(force, 0.2)
        self.assertLess(error, 0.005 * force)
        self.assertLess(error, touch.error_bound)
        self.assertLess(touch.error_bound, 0.2 * force)

    def testCorrectsADatasetToTheExactForce(self):
        with palpate.Live(self.scene, self.dataset, worker=self.WORKER) as live:
            self.assertIs(live.dataset, self.dataset)
            contact = palpate.Contact(self.dataset, live=live)
            with self.assertRaisesRegex(palpate.Error, "another contact"):
                palpate.Contact(self.dataset, live=live)
            self.assertIsExact(self.press(contact, 2))
            self.assertEqual((live.info.ready, live.info.trouble, live.info.restarts), (True, "", 0))
            self.assertGreater(live.info.answers, 10)
            contact.close()
            palpate.Contact(self.dataset, live=live)

    def testFollowsASceneWithoutADatasetUntilTheContactIsClosed(self):
        with palpate.Live(self.scene, worker=self.WORKER) as live:
            with self.assertRaisesRegex(palpate.Error, "belongs to another dataset"):
                palpate.Contact(self.dataset, live=live)
            with self.assertRaisesRegex(TypeError, "no file"):
                pickle.dumps(live.dataset)
            contact = palpate.Contact(live.dataset, live=live)
        touch = self.press(contact, 2)
        self.assertTrue(touch.inside)
        self.assertIsExact(touch)

    def testCorrectsOneOfManyContacts(self):
        with palpate.Live(self.scene, self.dataset, worker=self.WORKER) as live, palpate.Contacts(self.dataset, 3) as many:
            many.follow(1, live)
            for index, given, problem in ((2, live, "another contact uses live"), (3, None, "contact 3 does not exist")):
                with self.assertRaisesRegex(palpate.Error, problem):
                    many.follow(index, given)
            out = None
            for n in range(2000):
                out = many.update([(0.051, 0.048, max(0.101 - 6e-6 * n, 0.095))] * 2 + [(0.05, 0.05, 0.2)], out=out)
                time.sleep(0.001)
            self.assertEqual(list(out.touching), [True, True, False])
            self.assertIsExact(many.touch(1))
            self.assertTrue((out.force[0] != out.force[1]).any())
            many.follow(1, None)
            self.assertFalse(many.touch(1).touching)
            palpate.Contact(self.dataset, live=live).close()

    def testFeelsASecondFingerThatHolds(self):
        with palpate.Live(self.scene, worker=self.WORKER) as live, palpate.Contact(live.dataset, live=live) as contact:
            self.press(contact, 1)
            self.assertTrue(np.isnan(live.hold_force).all())
            held = np.array((0.05, 0.0, 0.07)), np.array((0.0, 0.004, 0.002))  # on a side of the cube
            live.hold(*held)
            touch = self.press(contact, 1, 1)
            exact = json.loads(self.run_program("solve", self.scene, "--json", "--at", *touch.anchor, "--displacement",
                                                *touch.displacement, "--hold", *held[0], *held[1]))
            alone = json.loads(self.run_program("solve", self.scene, "--json", "--at", *touch.anchor, "--displacement",
                                                *touch.displacement))
            force = np.linalg.norm(exact["force"])
            self.assertLess(np.linalg.norm(touch.force - exact["force"]), 0.005 * force)
            self.assertGreater(np.linalg.norm(touch.force - alone["force"]), 0.02 * force)
            self.assertLess(np.linalg.norm(live.hold_force - exact["hold_force"]), 0.01 * np.linalg.norm(exact["hold_force"]))
            live.let_go()
            self.assertIsExact(self.press(contact, 1, 2))
            with self.assertRaisesRegex(palpate.Error, "finite"):
                live.hold((0, 0, np.nan), (0, 0, 0))

    def testABarOfTwoTipsFeelsForcesAndTorqueOfOneEquilibrium(self):
        spec = importlib.util.spec_from_file_location("bar", EXAMPLES / "bar.py")
        example = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(example)
        axis = np.array((np.cos(0.08), 0, np.sin(0.08)))  # the tip at larger x is less deep
        with palpate.Live(self.scene, worker=self.WORKER) as live:
            felt = []
            for direction in axis, -axis:
                bar = example.Bar(live, 0.05)
                for n in range(2000):
                    middle = np.array((0.05, 0.05, max(0.105 - 1e-5 * n, 0.096)))
                    forces, torque = bar.update(middle, direction)
                    time.sleep(0.001)
                first, second = bar.followed.update(middle + 0.025 * direction), bar.holding.update(middle - 0.025 * direction)
                exact = json.loads(self.run_program("solve", self.scene, "--json", "--at", *first.anchor, "--displacement",
                                                    *first.displacement, "--hold", *second.anchor, *second.displacement))
                np.testing.assert_allclose(forces, (exact["force"], exact["hold_force"]), atol=0.01 * np.abs(forces).max())
                felt.append((forces.sum(axis=0), torque))
                bar.close()
            (force, torque), (other_force, other_torque) = felt
            self.assertGreater(force[2], 0.2)
            self.assertGreater(torque[1], 0.1 * 0.025 * force[2])  # the deeper tip is pushed up, so the bar turns back
            np.testing.assert_allclose(other_force, force, atol=0.01 * force[2])  # whichever tip is followed
            np.testing.assert_allclose(other_torque, torque, atol=0.02 * np.abs(torque).max())

    def testStartsAKilledSolverAgain(self):
        with palpate.Live(self.scene, worker=self.WORKER) as live, palpate.Contact(live.dataset, live=live) as contact:
            self.press(contact, 1.5)
            subprocess.run(["pkill", "-KILL", "-P", str(os.getpid()), "palpate-worker"], check=True)
            troubles, before, second = set(), live.info.answers, 2
            while not (live.info.restarts and live.info.ready and live.info.answers > before + 10) and second < 60:
                self.press(contact, 0.01, second)
                troubles.add(live.info.trouble)
                second += 0.01
            self.assertEqual(live.info.restarts, 1)
            self.assertGreater(len(troubles), 1)  # a sentence while it is away
            self.assertIsExact(self.press(contact, 1, second))

    def testNamesWhatIsMissing(self):
        with self.assertRaisesRegex(palpate.Error, "palpate-worker in PATH"), unittest.mock.patch.dict("os.environ"):
            os.environ["PATH"] = "/nowhere"
            palpate.Live(self.scene)
        with self.assertRaisesRegex(palpate.Error, "/nowhere/palpate-worker"):
            palpate.Live(self.scene, worker="/nowhere/palpate-worker")
        with self.assertRaisesRegex(palpate.Error, "missing.toml"):
            palpate.Live(self.folder / "missing.toml", worker=self.WORKER)
        (self.folder / "other.toml").write_text(self.scene.read_text().replace("1300", "2600"), encoding="utf-8")
        with self.assertRaisesRegex(palpate.Error, "give the scene from which it was built"):
            palpate.Live(self.folder / "other.toml", self.dataset, worker=self.WORKER)
        with self.assertRaisesRegex(palpate.Error, "options->period"):
            palpate.Live(self.scene, period=0, worker=self.WORKER)


class PythonArrays(WithDatasets):
    def testArraysMatchTheFile(self):
        with palpate.Arrays(self.file) as arrays, h5py.File(self.file) as f:
            self.assertEqual(list(arrays), ["tip", "rim"])
            rim, rows = arrays["rim"], slice(*f["spaces/first_point"][1:3])
            for name in ("position", "force", "stiffness", "energy", "tag", "min_det_F"):
                np.testing.assert_array_equal(getattr(rim, name), f["points"][name][rows])
            np.testing.assert_array_equal(rim["parent"], f["points/parent"][rows])
            np.testing.assert_array_equal(rim.displacement(), f["points/displacement"][rows])
            np.testing.assert_array_equal(rim.displacement(3), f["points/displacement"][rows.start + 3])
            np.testing.assert_array_equal(rim.displacement(rim.solved), f["points/displacement"][rows][rim.solved])
            np.testing.assert_array_equal(arrays.nodes[arrays.stored_nodes], f["mesh/points"][:][f["mesh/stored_nodes"][:]])
            corners = arrays.nodes[arrays.tetrahedra]
            self.assertGreater(np.linalg.det(corners[:, 1:] - corners[:, :1]).min(), 0)
            self.assertEqual(len(rim.probes["position"]), len(rim.probes["force"]))
            with self.assertRaisesRegex(KeyError, "no active node 'nose'; there are: tip, rim"):
                arrays["nose"]
            with self.assertRaisesRegex(KeyError, "no /points/colour; there are: .*position"):
                rim["colour"]

    def testInterpolationPassesThroughEverySolvedPoint(self):
        with palpate.Arrays(self.file) as arrays:
            tip = arrays["tip"]
            answers = palpate.Dataset(self.file).query(tip.position[tip.solved], active="tip")
            np.testing.assert_allclose(answers.force, tip.force[tip.solved], atol=1e-9)
        with self.assertRaisesRegex(palpate.Error, "energy: the file was closed"):
            tip.energy

    def testQuantizedDisplacementsComeInMetres(self):
        coarse = self.build("coarse", TIP, 0.02, 0.01, '[storage]\nprecision = "int16"\n')
        with palpate.Arrays(self.file) as exact, palpate.Arrays(coarse) as rounded:
            a, b = exact["tip"], rounded["tip"]
            np.testing.assert_allclose(b.displacement(b.solved), a.displacement(a.solved), atol=0.02 / 60000)

    def testTagsAndCausesHaveTheProgramsWords(self):
        page = (ROOT / "docs/failures.md").read_text(encoding="utf-8")
        listed = {int(number): word for number, word in re.findall(r"^\| ([0-9]+) \| `([a-z_]+)` \|", page, re.M)}
        self.assertEqual(dict(enumerate(palpate.arrays.CAUSES[1:], 1)), listed)

    def testAFileLeftOpenForWritingIsNotCalledDamaged(self):
        left = shutil.copy(self.file, self.folder / "left.h5")
        leave = "import h5py, os, sys; f = h5py.File(sys.argv[1], 'r+'); f.flush(); os._exit(0)"
        subprocess.run([sys.executable, "-c", leave, left], check=True)
        for reader in palpate.Arrays, palpate.Dataset:
            with self.assertRaisesRegex(palpate.Error, "left.h5: is open for writing .*h5clear -s"):
                reader(left)

    def testRecordingsAreRead(self):
        run = self.folder / "run.h5"
        self.run_program("view", self.file, "--headless", "--fast", "--duration", "1.5", "--record", run, "-q")
        recording = palpate.Recording.read(run)
        self.assertEqual(recording.force.shape, (len(recording.time), 3))
        self.assertTrue(recording.touching.any() and np.isfinite(recording.force).all())
        with h5py.File(run) as f:
            np.testing.assert_array_equal(recording.raw_force, f["force/raw"])
        self.assertIn("nodes", recording.attributes["models"] + recording.attributes["datasets"])
        self.assertEqual(recording, palpate.Recording.read(run))
        self.assertTrue(np.isnan(recording.hold_force).all() and np.isnan(recording.hold_error_bound).all())
        held = {"anchor": recording.tool, "displacement": -recording.tool, "force": recording.force, "error_bound": recording.time}
        with h5py.File(run, "a") as f:
            for name, values in held.items():
                f["hold/" + name] = values
        for name, values in held.items():
            np.testing.assert_array_equal(getattr(palpate.Recording.read(run), "hold_" + name), values)
        with h5py.File(run, "a") as f:
            del f["contact/inside"], f["contact/coverage"]
        older = palpate.Recording.read(run)
        np.testing.assert_array_equal(older.force, recording.force)
        self.assertTrue(older.inside.all() and np.isnan(older.coverage).all())
        half = self.folder / "half.h5"
        with h5py.File(half, "w") as f:
            f.attrs["format"] = "palpate-recording"
        for wrong, text in ((self.file, "not a palpate recording"), (half, "not a palpate recording; palpate view --record"),
                            (self.folder / "none.h5", "none.h5: there is no such recording; palpate view --record makes one"),
                            (self.folder, "is not a file"), (self.folder / "block.msh", "block.msh: is not an HDF5 file")):
            with self.assertRaisesRegex(palpate.Error, f"^[^\n]*{text}[^\n]*$"):
                palpate.Recording.read(wrong)
        with self.assertRaisesRegex(palpate.Error, "not a palpate dataset; palpate build makes one"):
            palpate.Arrays(run)


class PythonPackage(WithDatasets):
    def testAMissingLibraryIsReportedWithTheRemedy(self):
        for library, text in ((self.folder / "absent.so", "cannot load libpalpate: .*absent.so.*Install libpalpate0"),
                              (self.folder / "block.msh", "block.msh: (file too short|invalid ELF header)"),
                              ("libm.so.6", "older than this package: .*palpate_")):
            done = self.run_python("-c", "import palpate", PALPATE_LIBRARY=str(library))
            self.assertEqual(done.returncode, 1)
            self.assertRegex(done.stderr.splitlines()[-1], "ImportError: .*" + text)
        other = self.folder / "arm.so"
        other.write_bytes(LIBRARY.read_bytes()[:18] + b"\xb7\0" + LIBRARY.read_bytes()[20:])  # its header says AArch64
        done = self.run_python("-c", "import palpate", PALPATE_LIBRARY=str(other))
        self.assertRegex(done.stderr.splitlines()[-1], "ImportError: .*arm.so.*Install libpalpate0")

    def testAMissingNumPyOrH5pyIsNamed(self):
        done = self.run_python("-c", "import sys; sys.modules['numpy'] = None; import palpate")
        self.assertIn("ImportError: palpate needs NumPy: install python3-numpy", done.stderr)
        done = self.run_python("-c", "import sys, palpate; sys.modules['h5py'] = None; palpate.Arrays(sys.argv[1])", self.file)
        self.assertIn("ImportError: arrays of files need h5py: install python3-h5py", done.stderr)

    def testItFindsTheLibraryOfItsOwnBuild(self):
        tree = self.folder / "tree"
        shutil.copytree(PACKAGE, tree / "lib/python3/dist-packages", ignore=shutil.ignore_patterns("__pycache__"))
        (tree / "lib/x86_64-linux-gnu").mkdir()
        shutil.copy(LIBRARY, tree / "lib/x86_64-linux-gnu")
        environment = {"PYTHONPATH": str(tree / "lib/python3/dist-packages"), "PALPATE_LIBRARY": ""}
        done = self.run_python("-c", "import palpate; print(palpate._library.library_file)", **environment)
        self.assertEqual(done.stdout.strip(), str(tree / "lib/x86_64-linux-gnu/libpalpate.so.0"), done.stderr)

    def testPublicNamesHaveDocstringsAndTypes(self):
        for name in palpate.__all__:
            thing = getattr(palpate, name)
            self.assertTrue(thing.__doc__, name)
            members = inspect.getmembers(thing, inspect.isfunction) if inspect.isclass(thing) else [(name, thing)]
            for member, function in members:
                if function.__module__.split(".")[0] != "palpate" or member.startswith("_") and member != "__init__" or "__dataclass_fields__" in vars(thing):
                    continue
                self.assertTrue(function.__doc__ or member == "__init__", f"{name}.{member} has no docstring")
                signature = inspect.signature(function)
                untyped = [p for p in signature.parameters.values() if p.annotation is p.empty and p.name not in ("self", "_")]
                self.assertEqual(untyped, [], f"{name}.{member}")

    def testMypyFindsNothing(self):
        if shutil.which("mypy") is None:
            self.skipTest("mypy is not installed")
        done = subprocess.run(["mypy", "--strict", "--ignore-missing-imports", "--cache-dir", self.folder / "mypy", PACKAGE / "palpate"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def testTheManualRunsUnchanged(self):
        manual = (ROOT / "docs/python.md").read_text(encoding="utf-8")
        programs = re.findall(r"```python\n(.*?)```", manual, re.S)
        self.assertGreater(len(programs), 3)
        shutil.copy(self.file, self.folder / "liver.h5")
        shutil.copy(self.build("finger", FINGER, 0.01, 0.005), self.folder / "organ.h5")
        shutil.copy(self.folder / "finger.toml", self.folder / "organ.toml")
        self.run_program("view", self.file, "--headless", "--fast", "--duration", "1", "--record", self.folder / "run.h5", "-q")
        done = self.run_python("-c", "\n".join(programs), MPLCONFIGDIR=str(self.folder), PATH=f"{BIN}:{os.environ['PATH']}")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertRegex(done.stdout, r"6\.0 mm True \[")
        self.assertRegex(done.stdout, r"N, solved: True bound .*trouble=''")
        for figure in re.findall(r"savefig\(\"(.*?)\"\)", manual):
            self.assertGreater((self.folder / figure).stat().st_size, 5000)

    def testTheExampleOfACurveRuns(self):
        figure = self.folder / "curve.svg"
        done = self.run_python(EXAMPLES / "force_curve.py", self.file, figure, "tip", 0, 0, -1, MPLCONFIGDIR=str(self.folder))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"tip: [0-9.]+ N at most, 100% of the path inside")
        self.assertIn("<svg", figure.read_text(encoding="utf-8"))


if __name__ == "__main__":
    unittest.main()
