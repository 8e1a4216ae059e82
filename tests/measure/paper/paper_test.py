#!/usr/bin/python3
"""Tests what tests/measure/paper keeps and refuses. ctest runs each case separately; by hand
PALPATE_BIN_DIR=build/release/bin tests/measure/paper/paper_test.py."""
import collections
import functools
import json
import os
import pathlib
import runpy
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
sys.dont_write_bytecode = True

import builds
import claims
import figure
import interpolation
import newton_iteration
import organs
import references
import surveys
from interruption import write_whole
from record import ALL, Incomplete, Measured, NotMeasured, Record, needed

PROGRAMS = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", HERE.parents[2] / "build/release/bin")).parent


def waited(until, seconds=60):
    ends = time.monotonic() + seconds
    while not until():
        if time.monotonic() > ends:
            raise AssertionError(f"waited for {seconds} s")
        time.sleep(0.05)


class Paper(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.said = []

    def record(self):
        record = Record(self.folder, say=self.said.append)
        record.target = "test"
        return record

    # Measurements are kept

    def testAMeasurementIsNotRepeated(self):
        made = []
        for _ in range(2):
            self.assertEqual(self.record().measure("a number", lambda: made.append(1) or 7, "of this").value, 7)
        self.assertEqual(len(made), 1)

    def testAnotherInputIsMeasuredSeparately(self):
        made = [self.record().measure("a number", lambda: word, word).value for word in ("of this", "of that")]
        self.assertEqual(made, ["of this", "of that"])

    def testAMeasurementCutByAKillIsRepeated(self):
        self.record().measure("a number", lambda: 7)
        (file,) = (self.folder / "measurements").iterdir()
        file.write_text(file.read_text()[:20])
        self.assertEqual(self.record().measure("a number", lambda: 8).value, 8)

    def testACommandIsRepeatedIfItsInputFileChanges(self):
        file = self.folder / "input.json"
        for text in ("1", "2"):
            file.write_text(text)
            self.assertEqual(self.record().run("cat", ["cat", file]).value, int(text))

    def testACommandIsRepeatedIfTheMeshOfItsSceneChanges(self):
        scene, mesh = self.folder / "scene.toml", self.folder / "body.msh"
        scene.write_text(f'mesh = "{mesh.name}"\n')
        count = ["sh", "-c", 'wc -c < "$(dirname "$0")/body.msh"', scene]
        for text in ("1", "22"):
            mesh.write_text(text)
            self.assertEqual(self.record().run("count", count).value, len(text))

    def testTheInputOfACommandIsKeptForRepetition(self):
        measured = self.record().run("cat", ["cat"], "[1, 2]")
        command, _, file = measured.command.partition(" < ")
        self.assertEqual((command, pathlib.Path(os.path.join(HERE.parents[2], file)).read_text()), ("cat", "[1, 2]"))

    def testACommandEndsWithTheRunThatWaitsForIt(self):
        program = f"""
import sys
sys.path.insert(0, {str(HERE)!r})
from record import Record
Record({str(self.folder)!r}).run("wait", ["sh", "-c", 'echo $$ > "$0"; exec sleep 600', {str(self.folder / "pid")!r}])"""
        with subprocess.Popen([sys.executable, "-B", "-c", program], stdout=subprocess.DEVNULL) as run:
            waited(lambda: (self.folder / "pid").exists() and (self.folder / "pid").read_text())
            run.kill()
        process = pathlib.Path("/proc") / (self.folder / "pid").read_text().strip()
        waited(lambda: not process.exists() or "State:\tZ" in (process / "status").read_text())

    def testAFailedCommandIsNotAMeasurement(self):
        with self.assertRaisesRegex(Incomplete, "ls .*/nowhere ended with 2: .*No such file"):
            self.record().run("ls", ["ls", "/nowhere"])
        self.assertEqual(list(self.folder.glob("measurements/*")), [])

    def testAMissingProgramIsNamedWithTheRemedy(self):
        record = Record(self.folder, self.folder / "release", say=self.said.append)
        with self.assertRaisesRegex(NotMeasured, "no .*release/bench/palpate_newton_bench: build the targets all and benchmarks"):
            record.run("newton", [record.bench / "palpate_newton_bench"])

    def testANumberHasItsCommandMachineAndCommit(self):
        record = self.record()
        record.number("one", 1.5, "N", record.run("echo", ["echo", "1.5"]))
        record.not_measured("other", "no such package")
        record.save()
        kept = json.loads((self.folder / "results.json").read_text())
        number = kept["numbers"]["test/one"]
        self.assertEqual((number["value"], number["unit"], number["command"]), (1.5, "N", "echo 1.5"))
        self.assertTrue(number["machine"]["processor"] and number["commit"])
        self.assertEqual(kept["not_measured"], {"test/other": "no such package"})

    def testANumberOfSeveralMeasurementsHasAllTheirSources(self):
        of = lambda command, commit, at: Measured(1, command, "machine", commit, at)
        all_of = Measured.of_all([of("one", "c1", "2026-01-02"), of("two", "c2", "2026-01-03"), of("one", "c1", "2026-01-01")])
        self.assertEqual((all_of.command, all_of.commit, all_of.at), ("one; two", "c1; c2", "2026-01-03"))
        self.assertEqual(Measured.of_all([of("one", "c1", "2026-01-02")], "both").command, "both")
        self.assertEqual(all_of.machine, "machine")
        elsewhere = Measured(1, "two", "another machine", "c1", "2026-01-02")
        self.assertEqual(Measured.of_all([of("one", "c1", "2026-01-02"), elsewhere]).machine, ["machine", "another machine"])

    def testATargetOfSeveralMachinesOrCommitsSaysSo(self):
        self.record().measure("a number", lambda: 7)
        record = self.record()
        record.commit = "another"
        for number in "a number", "another number":
            record.measure(number, lambda: 8)
        record.save()
        sources = json.loads((self.folder / "results.json").read_text())["sources"]["test"]
        self.assertEqual(sources, sorted(f"{record.machine['processor']}, {commit}" for commit in (self.record().commit, "another")))

    def testATargetMadeAloneKeepsTheNumbersOfOthers(self):
        record = self.record()
        record.number("one", 1, "N", record.run("echo", ["echo", "1"]))
        record.save()
        other = Record(self.folder, say=self.said.append)
        other.target = "other"
        other.number("two", 2, "N", other.run("echo", ["echo", "2"]))
        other.save()
        self.assertEqual(sorted(json.loads((self.folder / "results.json").read_text())["numbers"]), ["other/two", "test/one"])

    def testAMissingTargetKeepsEarlierNumbersOfExistingFigures(self):
        record = self.record()
        for number in "one", "two":
            record.number(number, 1, "N", record.run("echo", ["echo", "1"]))
        record.save()
        again = self.record()
        again.commit = "another"
        again.number("one", 2, "N", again.run("echo", ["echo", "2"]))
        again.not_measured(ALL, "no time")
        again.save()
        kept = json.loads((self.folder / "results.json").read_text())
        self.assertEqual({name: number["value"] for name, number in kept["numbers"].items()}, {"test/one": 2, "test/two": 1})
        self.assertEqual(kept["not_measured"], {"test/all": "no time"})
        self.assertEqual(len(kept["sources"]["test"]), 2)

    def testTargetsWithoutTimeAreNamedAndTheRestIsKept(self):
        self.record().measure("a number", lambda: 7)
        record = Record(self.folder, hours=0, say=self.said.append)
        self.assertEqual(record.measure("a number", lambda: 8).value, 7)
        with self.assertRaisesRegex(NotMeasured, "another was not begun in the hours that were given"):
            record.measure("another", lambda: 8)

    # Times of builds

    def built(self, again=False, scene=None, **options):
        """Seven configurations of a body that takes no time; `again`: even if it was measured."""
        for measurement in self.folder.glob("measurements/build-*") if again else []:
            measurement.unlink()
        record = Record(self.folder, PROGRAMS, say=self.said.append, **{"jobs": 1, **options})
        return record.dataset("seven", scene or organs.scene(organs.organ(500), "linear", radius=0.001, divisions=1)).value

    def setClock(self, **clock):
        (self.folder / "datasets" / "seven.clock").write_text(json.dumps(clock))

    def testAnInterruptedBuildTookAsLongAsItsParts(self):
        self.assertEqual(self.built()["points"]["points"], 7)
        self.setClock(seconds=1000.0, jobs=1)
        self.assertGreater(self.built(again=True)["seconds"], 1000)

    def testABuildWithoutItsResultsStartsItsTimeAtZero(self):
        self.built()
        self.setClock(seconds=1000.0, jobs=1)
        shutil.rmtree(self.folder / "datasets" / "seven.h5.state")
        self.assertLess(self.built(again=True)["seconds"], 1000)

    def testABuildBegunByOthersStartsFromScratch(self):
        self.built()
        for begun in ({"seconds": 1000.0, "jobs": 2}, {"seconds": 1000.0, "jobs": None}):
            self.setClock(**begun)
            self.assertLess(self.built(again=True)["seconds"], 1000)

    def testABuildOfAnotherSceneStartsFromScratch(self):
        self.built()
        self.setClock(seconds=1000.0, jobs=1)
        other = organs.scene(organs.organ(500), "linear", radius=0.002, divisions=1)
        self.assertLess(self.built(scene=other)["seconds"], 1000)

    def testTimesOfLocalAndOtherWorkersAreSeparate(self):
        self.built()
        with self.assertRaisesRegex(NotMeasured, "was not begun"):
            self.built(listen="tcp://127.0.0.1:*", hours=0)

    def testParallelMeasurementsAreOrderedAndAFailureEndsTheRest(self):
        record = Record(self.folder, jobs=2, say=self.said.append)
        numbers = record.together([functools.partial(record.measure, f"number {n}", lambda n=n: n) for n in range(20)])
        self.assertEqual([number.value for number in numbers], list(range(20)))
        begun = []
        fail = lambda: record.run("ls", ["ls", "/nowhere"])
        with self.assertRaisesRegex(Incomplete, "nowhere"):
            record.together([fail, *[lambda: begun.append(time.sleep(0.2))] * 20])
        self.assertLess(len(begun), 20)

    def testAMissingPackageIsNamed(self):
        with self.assertRaisesRegex(NotMeasured, "no_such_package_anywhere is not installed"):
            needed("no_such_package_anywhere")

    # Incomplete data are not drawn

    def testAFigureWithAHoleIsNotDrawn(self):
        with self.assertRaisesRegex(Incomplete, r"hole: no value of force \(N\)"):
            figure.save_figure(self.record(), "hole", ["p (m)", "force (N)"], [[0.0, 1.0], [0.1, None]], lambda page: None)
        self.assertFalse((self.folder / "figures").exists())

    def testAFigureWithoutDataIsNotDrawn(self):
        with self.assertRaisesRegex(Incomplete, "there are no data"):
            figure.save_figure(self.record(), "empty", ["p (m)"], [], lambda page: None)

    def testAFigureIsReproducibleAndStoredWithItsData(self):
        drawn = []
        for _ in range(2):
            figure.save_figure(self.record(), "line", ["p (m)", "force (N)"], [[0.0, 1.0], [0.1, 2.0]],
                               lambda page: page.subplots().plot([0, 0.1], [1, 2]))
            drawn.append((self.folder / "figures" / "line.svg").read_bytes())
        self.assertEqual(drawn[0], drawn[1])
        self.assertEqual((self.folder / "figures" / "line.csv").read_text(), "p (m),force (N)\n0,1\n0.1,2\n")

    def testATableMarksMissingMeasurements(self):
        figure.save_table(self.record(), "table", ["method", "error (N)"], [["ours", 0.25], ["other", None]])
        self.assertEqual((self.folder / "figures" / "table.md").read_text(),
                         "| method | error (N) |\n| --- | --- |\n| ours | 0.25 |\n| other | not measured |\n")

    def testTablesRefuseRowsWithoutNumbersAndInvalidNumbers(self):
        rows = [["ours", "here", 0.25], ["other", "there", None], ["third", "there", float("nan")]]
        figure.save_table(self.record(), "table", ["method", "where", "error (N)"], rows)
        figure.save_table(self.record(), "words", ["method", "source"], [["ours", "a page"]])
        self.assertEqual(figure.faults(self.folder / "figures"), ["table.csv: other, there, ", "table.csv: third, there, nan"])

    def testAnIncompleteSurveyIsNamedAndNotDrawn(self):
        with self.assertRaisesRegex(Incomplete, "not all of the paper's surveys"):
            surveys.how_far(self.withoutTime())
        table = (self.folder / "figures" / "paths.md").read_text()
        self.assertEqual(table.count("| liver"), len(surveys.surveys(self.withoutTime())))
        self.assertIn("| Mooney-Rivlin | finger, 20 mm | regular | 20 mm, adaptive | not measured |", table)
        self.assertFalse((self.folder / "figures" / "paths-way.svg").exists())

    def testAFailedSurveyDoesNotAffectOthers(self):
        record = Record(self.folder, nodes=(500,), laws=("mr",), say=self.said.append)
        record.target = "paths"
        there = surveys.Reached([0.1] * 4, 0.1, 4, 4, 4, collections.Counter(), Measured(None, "", {}, "", ""))
        fails = lambda survey: survey.tool == "finger"

        def walked(record, survey, merely):
            if fails(survey):
                raise Incomplete("the survey ended with 1")
            return there

        with unittest.mock.patch.object(surveys, "walked", walked), self.assertRaisesRegex(Incomplete, "^failed: .*finger, 20 mm, regular$"):
            surveys.how_far(record)
        table = (self.folder / "figures" / "paths.md").read_text().splitlines()[2:]
        self.assertEqual(["| 100 |" in line for line in table], [not fails(survey) for survey in surveys.surveys(record)])
        self.assertTrue((self.folder / "figures" / "paths-way.svg").exists())

    def testALatticeWithoutMeasurementIsARowOfFig7(self):
        for row in newton_iteration.ROWS:
            for divisions in organs.LATTICES:
                self.assertEqual(len(builds.measured_row(self.withoutTime(), row, divisions)), len(builds.COLUMNS))

    def testOnlyARequestedSizeOfAllNodesIsReportedMissing(self):
        rows = [builds.measured_row(self.withoutTime(), row, divisions) for row in newton_iteration.ROWS for divisions in organs.LATTICES]
        builds.save_table(self.withoutTime(), rows)
        head, _, *lines = [line.split(" | ") for line in (self.folder / "figures" / "figure7-table.md").read_text().splitlines()]
        cells = [line[head.index("with all nodes (MB)")] for line in lines]
        self.assertEqual(cells, ["not measured" if builds.wants_all_nodes(row, divisions) else "-"
                                 for row in newton_iteration.ROWS for divisions in organs.LATTICES])

    def testTablesNameEveryRowThatIsNotMeasured(self):
        newton_iteration.table1(self.withoutTime())
        claims.claims(self.withoutTime())
        surveys.limits(self.withoutTime())
        for name, rows in ("table1", newton_iteration.ROWS), ("claims", claims.CLAIMS), ("limits", range(3 * 2 * 2)):
            table = (self.folder / "figures" / f"{name}.md").read_text()
            self.assertEqual(len([line for line in table.splitlines()[2:] if "not measured" in line]), len(rows))

    def testErrorsAlongPathsAreDrawnForCompleteCasesOnly(self):
        record = self.withoutTime()
        with self.assertRaisesRegex(Incomplete, "there are no data"):
            interpolation.figure8(record)
        self.assertEqual(len(record.missing), len(interpolation.cases(record)))

    def withoutTime(self):
        record = Record(self.folder, hours=0, say=self.said.append)
        record.target = "test"
        return record

    def testASingleLawCanBeRequested(self):
        record = Record(self.folder, laws=("mr",), say=self.said.append)
        asked = [survey.law for survey in surveys.surveys(record)] + [row.law for row in builds.cases(record)]
        asked += [case.law for case in interpolation.cases(record)]
        self.assertEqual(set(asked), {"mr"})

    def testQuadraticLatticesAreBuiltByLocalWorkersOnly(self):
        linear, quadratic = (next(row for row in newton_iteration.ROWS if row.order == order) for order in (1, 2))
        asked = [builds.numbers_of_workers(self.record(), row) for row in (linear, quadratic)]
        self.assertEqual(asked, [[2, 1], [2]])

    # The paper's experiments

    def testAnotherOrganIsNotAFinerMeshOfThisOne(self):
        here, other = organs.Organ("liver-493", None, "", (), "reference"), organs.Organ("liver-2000", None, "", (), "shipped")
        finer = organs.Organ("liver-5984", None, "", (), "reference")
        for organs_there, kept in (({2000: other, 6000: finer}, ["liver-5984"]), ({2000: finer, 6000: finer}, ["liver-5984"])):
            record = self.record()
            with unittest.mock.patch.object(organs, "organ", organs_there.get):
                self.assertEqual([organ.name for organ in claims.finer_meshes(record, here)], kept)
            self.assertEqual(len(record.missing), 1)

    def testTheLatticesHaveThePapersPoints(self):
        self.assertEqual({n: len(claims.ball(n)) for n in organs.LATTICES}, organs.LATTICES)

    def testThereAre26DirectionsOfLengthOne(self):
        every = organs.directions()
        self.assertEqual(len(set(every)), 26)
        for direction in every:
            self.assertAlmostEqual(sum(x * x for x in direction), 1)

    def testRegularPathsGo100MillimetresInStepsOfOne(self):
        paths = references.regular_paths()
        self.assertEqual((len(paths), len(paths[0])), (26, 100))
        for path in paths:
            self.assertAlmostEqual(sum(x * x for x in path[0]) ** 0.5, 0.001)
            self.assertAlmostEqual(sum(x * x for x in path[-1]) ** 0.5, 0.1)

    def testRandomPathsStayInTheBallAndAreReproducible(self):
        paths = references.random_paths(20)
        self.assertEqual(paths, references.random_paths(20))
        for path in paths:
            self.assertEqual(len(path), 200)
            for before, after in zip([[0.0] * 3, *path], path):
                self.assertAlmostEqual(sum((a - b) ** 2 for a, b in zip(after, before)) ** 0.5, 0.001)
                self.assertLessEqual(sum(x * x for x in after) ** 0.5, 0.1 + 1e-12)

    def testAPlaceIsCoveredIfAllPointsAroundItAreSolved(self):
        numpy, h5py = needed("numpy"), needed("h5py")
        ijk = numpy.array([(i, j, k) for i in range(-2, 3) for j in range(-2, 3) for k in range(-2, 3)])
        tag = numpy.ones(len(ijk), dtype=numpy.uint8)
        tag[(ijk == (1, 1, 1)).all(1)] = 3  # failed
        with h5py.File(self.folder / "lattice.h5", "w") as file:
            points = file.create_group("points")
            points.attrs["divisions"], points.attrs["spacing"] = 1.0, 0.01
            points["ijk"], points["tag"] = ijk, tag
        places = [(-0.005, -0.005, -0.005), (0.005, 0.005, 0.005), (0.021, 0.005, 0.005), (-0.015, 0.001, 0.001)]
        inside = interpolation.covered(self.folder / "lattice.h5", places)
        self.assertEqual(inside["trilinear"].tolist(), [True, False, False, True])
        self.assertEqual(inside["tricubic"].tolist(), [False, False, False, False])
        tag[:] = 1
        with h5py.File(self.folder / "lattice.h5", "a") as file:
            file["points/tag"][:] = tag
        inside = interpolation.covered(self.folder / "lattice.h5", places)
        self.assertEqual(inside["trilinear"].tolist(), [True, True, False, True])
        self.assertEqual(inside["tricubic"].tolist(), [True, True, False, False])

    def testPointsWithoutAWeightMayBeMissing(self):
        numpy, h5py = needed("numpy"), needed("h5py")
        ijk = numpy.array([(i, j, 0) for i in range(-2, 3) for j in range(-2, 3)])
        with h5py.File(self.folder / "plane.h5", "w") as file:
            points = file.create_group("points")
            points.attrs["divisions"], points.attrs["spacing"] = 1.0, 0.01
            points["ijk"], points["tag"] = ijk, numpy.ones(len(ijk), dtype=numpy.uint8)
        inside = interpolation.covered(self.folder / "plane.h5", [(0.005, 0.005, 0), (0.005, 0.005, 0.001), (0.01 * (1 - 1e-12), -0.02, 0)])
        self.assertEqual(inside["trilinear"].tolist(), [True, False, True])
        self.assertEqual(inside["tricubic"].tolist(), [True, False, True])

    def testPlacesAfterADetourAreCounted(self):
        detours = iter([[0, 1, 0], [0, 0], [2]])
        record = unittest.mock.Mock(bench=self.folder, target="figure8", **{"together": lambda each: [one() for one in each], "scene.return_value": "scene"})
        record.run = lambda *_: Measured({"paths": [{"reached": [{"displacement": [0, 0, 0], "force": [0, 0, 0], "detours": d}
                                                                 for d in next(detours)]}]}, "", {}, "", "")
        self.assertEqual(references.solved_along(record, "any", "", [[0] * 3] * 3).after_detour, 3)

    # The command

    def testAnUnknownTargetIsRefusedWithTheValidNames(self):
        done = subprocess.run([HERE / "run", "figure99"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("no target figure99; there are table1,", done.stderr)

    def testWithoutABuildItSaysWhatToBuild(self):
        done = subprocess.run([HERE / "run", "--programs", self.folder, "claims"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1)
        self.assertIn("build the targets all and benchmarks", done.stderr)

    def testFiguresOfAnEarlierRunAreMarked(self):
        for file in "bin/palpate", "bench/palpate_path_forces", "kept/figures/figure6.svg":
            path = self.folder / file
            path.parent.mkdir(parents=True)
            path.touch()
            os.utime(path, (1, 1))
        done = subprocess.run([HERE / "run", "--programs", self.folder, "--folder", self.folder / "kept", "--hours", "0", "figure6"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertRegex(done.stdout, "not begun in the hours that were given; of an earlier run: figure6.svg\n")

    def testFilesOfATargetFromAnEarlierRunAreMarked(self):
        record = Record(self.folder, self.folder, say=lambda text: None)
        kept = self.folder / "figures" / "figure5-mr.png"
        write_whole(kept, "")
        os.utime(kept, (1, 1))

        def only_a_table(record):
            """Fig. 5 without a screen."""
            figure.save_table(record, "figure5", ["a"], [[1]])

        run = runpy.run_path(str(HERE / "run"))
        with unittest.mock.patch.dict(run["make"].__globals__, target=lambda name: only_a_table):
            self.assertTrue(run["make"]("figure5", record))
        self.assertEqual(record.missing, {"figure5/files": "of an earlier run: figure5-mr.png"})


if __name__ == "__main__":
    unittest.main()
