#!/usr/bin/python3
"""Tests the scorer of the yardstick, and solves some of its touches again (docs/yardstick.md). By hand
PALPATE_BIN_DIR=build/release/bin tests/measure/yardstick/yardstick_test.py."""
import csv
import importlib.machinery
import importlib.util
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE))
BODIES = ("dome", "flap", "layers", "muscle", "tube")

try:
    import getfem
    import numpy as np
    import scipy
    missing = ""
except ImportError as error:  # they belong to the packages of the tests
    missing = f"NOT TESTED: {error}"
if not missing:
    import bodies
    import solvers


def script(name):
    loader = importlib.machinery.SourceFileLoader(name, str(HERE / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    sys.modules[name] = module  # for its dataclasses
    loader.exec_module(module)
    return module


score = script("score")


def touches(body):
    with (HERE / "bodies" / f"{body}.csv").open(encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


class Scorer(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.exact = score.reference()

    def entry(self, forces, head="", header="id,fx,fy,fz"):
        file = self.folder / "entry.csv"
        rows = [f"{touch},{','.join(map(str, force))}" if force else f"{touch},,," for touch, force in forces]
        file.write_text("\n".join([f"{head}{header}", *rows, ""]), encoding="utf-8")
        return file

    def scaled(self, factor):
        return [(touch, tuple(factor * x for x in force)) for touch, force in self.exact.items()]

    def refused(self, file):
        run = subprocess.run([HERE / "score", file], capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
        return run.stderr

    def testTheTableOfThePageFollowsFromTheEntries(self):
        run = subprocess.run([HERE / "score", "--table"], capture_output=True, text=True, check=True)
        self.assertIn(run.stdout, (ROOT / "docs" / "yardstick.md").read_text(encoding="utf-8"))
        self.assertGreater(run.stdout.count("\n"), 6)

    def testErrorsAreRelativeToTheForceOfTheReference(self):
        (made,) = score.ranking([self.entry(self.scaled(1.1), "# name = a tenth too much\n# bytes = 8\n")])
        for share in (0.5, 0.95, 1):
            self.assertAlmostEqual(score.at(made.percent, share), 10)
        largest = max(sum(x * x for x in force) ** 0.5 for force in self.exact.values())
        self.assertAlmostEqual(made.newtons[-1], 0.1 * largest)
        self.assertEqual((made.name, made.facts["bytes"], made.answered), ("a tenth too much", "8", 1))

    def testATouchWithoutAnAnswerIsAnErrorOfTheWholeForce(self):
        forces = [(touch, force if number % 10 else None) for number, (touch, force) in enumerate(self.exact.items())]
        (made,) = score.ranking([self.entry(forces)])
        self.assertEqual((score.at(made.percent, 0.5), score.at(made.percent, 0.95)), (0, 100))
        self.assertAlmostEqual(made.answered, 0.9)
        self.assertLess(abs(made.within - 0.9), 0.02)  # some forces are below 10 mN

    def testEntriesAreRankedByTheMedianAndFactsAreKept(self):
        worse, better = self.entry(self.scaled(1.1)).rename(self.folder / "worse.csv"), self.entry(self.scaled(0.99))
        self.assertEqual([made.name for made in score.ranking([worse, better])], ["entry", "worse"])

    def testForcesInOtherUnitsAreRefused(self):
        for factor in (1000, 0.001):
            self.assertIn("newtons", self.refused(self.entry(self.scaled(factor))))

    def testForcesOfTheOppositeSignAreRefused(self):
        self.assertIn("opposite", self.refused(self.entry(self.scaled(-1))))

    def testMissingForeignAndRepeatedTouchesAreRefused(self):
        forces = self.scaled(1)
        gone = random.Random(1).randrange(len(forces))
        self.assertIn(forces[gone][0], self.refused(self.entry(forces[:gone] + forces[gone + 1:])))
        self.assertIn("heart-00-00", self.refused(self.entry([*forces, ("heart-00-00", (1, 0, 0))])))
        self.assertIn(forces[0][0], self.refused(self.entry([*forces, forces[0]])))

    def testNumbersThatAreNoForcesAreRefused(self):
        for wrong in ("nan", "inf", "much", ""):
            forces = [(touch, (wrong, 0, 0) if number == 7 else force) for number, (touch, force) in enumerate(self.scaled(1))]
            self.assertIn(":9:", self.refused(self.entry(forces)))

    def testFilesOfAnotherFormAreRefused(self):
        self.refused(self.entry(self.scaled(1), header="id,force"))
        self.refused(self.entry(self.scaled(1), "# answer_seconds = soon\n"))
        self.refused(self.folder / "absent.csv")
        self.refused(self.entry([(touch, None) for touch in self.exact]))


class References(unittest.TestCase):
    def testEachBodyHasAThousandTouchesOnWhichBothSolversAgree(self):
        for body in BODIES:
            rows = touches(body)
            self.assertEqual(len({row["id"] for row in rows}), 1000)
            self.assertLess(max(float(row["agreement"]) for row in rows), 1e-5)

    @unittest.skipIf(missing, missing)
    def testMeshesScenesAndNodeListsAreThoseThatTheScriptWrites(self):
        with tempfile.TemporaryDirectory() as folder, unittest.mock.patch.object(bodies, "BODIES", pathlib.Path(folder)):
            bodies.main()
            for file in pathlib.Path(folder).iterdir():
                self.assertEqual(file.read_bytes(), (HERE / "bodies" / file.name).read_bytes(), file.name)

    @unittest.skipIf(missing, missing)
    def testBothSolversGiveTheForcesOfSomeTouchesAgain(self):
        for number, body in enumerate(BODIES):
            with self.subTest(body):
                scene = solvers.Scene(HERE / "bodies" / f"{body}.toml")
                place = scene.text["active"][7 * number]
                rows = [row for row in touches(body) if row["place"] == place["name"]][:5]  # a ray
                displacements, forces = ([[float(row[key]) for key in keys] for row in rows] for keys in (("dx", "dy", "dz"), ("fx", "fy", "fz")))
                body_of_getfem = solvers.ByGetfem(scene, scene.points[place["node"]], place["radius"])
                listed = re.search(rf'Name="patch_{place["name"]}" NumberOfTuples="(\d+)"', (HERE / "bodies" / f"{body}.vtu").read_text())
                self.assertEqual(3 * int(listed[1]), len(body_of_getfem.held))
                getfem = body_of_getfem.path(displacements)
                palpate = [answer["force"] for answer in solvers.by_palpate(HERE / "bodies" / f"{body}.toml", place["name"], displacements)]
                for found in getfem, np.array(palpate):
                    self.assertLess((np.linalg.norm(found - forces, axis=1) / np.linalg.norm(forces, axis=1)).max(), 1e-5)


if __name__ == "__main__":
    unittest.main()
