#!/usr/bin/python3
"""Reads the files of palpate export with VTK, meshio and ParaView, and compares them with the numbers of the dataset.
ctest runs each case separately; by hand PALPATE_BIN_DIR=build/release/bin tests/viewer/export/export_test.py."""
import csv
import itertools
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree as ElementTree

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "tests" / "support"))
from virtual_screen import virtual_screen

try:
    import h5py
    import numpy as np
    from kuhn_box import box, write_gmsh
except ImportError:  # belongs to the packages of the tests
    h5py = np = None
try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
except ImportError:
    vtkXMLUnstructuredGridReader = None
try:
    import meshio
except ImportError:
    meshio = None

PALPATE = pathlib.Path(os.environ.get("PALPATE_BIN_DIR", ROOT / "build/release/bin")).resolve() / "palpate"

# Ends of the edges of VTK's quadratic tetrahedron, in the order of its mid-edge nodes.
EDGES = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]

needs_vtk = unittest.skipUnless(h5py and vtkXMLUnstructuredGridReader, "NOT TESTED: needs python3-h5py, and VTK for Python "
                                "(Debian: python3-paraview)")
needs_paraview = unittest.skipUnless(shutil.which("pvpython") and shutil.which("Xvfb"),
                                     "NOT TESTED: needs pvpython and Xvfb (Debian: python3-paraview, xvfb)")


SCENE = """name = "a box & <more>"
mesh = "box.msh"
[material]
law = "mooney-rivlin"
c10 = 1300
c01 = 1280
[discretization]
displacement = "{displacement}"
[fixed]
below = {{ axis = "x", at = 0.001 }}
[[active]]
name = "tip"
near = [0.06, 0.02, 0.04]
radius = 0.021
[workspace]
radius = 0.01
spacing = 0.005
[storage]
displacement = "{stored}"
"""


# The top of a box of smaller cubes, touched by a finger.
FINGER_SCENE = """mesh = "box.msh"
[material]
law = "mooney-rivlin"
c10 = 1300
c01 = 1280
[fixed]
below = { axis = "z", at = 0.001 }
[[active]]
name = "skin"
surface = { box = { lowest = [0.005, 0.005, 0.039], highest = [0.055, 0.035, 0.041] } }
tool = "finger"
radius = 0.015
[workspace]
radius = 0.006
spacing = 0.006
[storage]
displacement = "all"
"""


class VtkGrid:
    """A grid read by VTK: points, cells (one row each), cell_type, and arrays by name."""

    def __init__(self, file):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(file))
        reader.Update()
        grid = reader.GetOutput()
        assert grid.GetNumberOfCells() > 0, f"{file} holds no cells"
        self.points = vtk_to_numpy(grid.GetPoints().GetData())
        (self.cell_type,) = set(vtk_to_numpy(grid.GetCellTypesArray()))
        cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
        self.cells = cells.reshape(grid.GetNumberOfCells(), -1)
        self.point, self.cell, self.field = (
            {data.GetArrayName(n): vtk_to_numpy(data.GetArray(n)) for n in range(data.GetNumberOfArrays())}
            for data in (grid.GetPointData(), grid.GetCellData(), grid.GetFieldData()))


class MeshioGrid:
    """A grid as meshio reads it."""

    TYPES = {"triangle": 5, "tetra": 10, "tetra10": 24}

    def __init__(self, file):
        mesh = meshio.read(file)
        (block,) = mesh.cells
        self.points, self.cells, self.cell_type = mesh.points, block.data, self.TYPES[block.type]
        self.point, self.field = mesh.point_data, mesh.field_data
        self.cell = {name: values for name, (values,) in mesh.cell_data.items()}


def slopes(x):
    """Gradients of the ten quadratic shape functions with respect to the barycentric coordinates, at x."""
    rows = np.zeros((10, 4))
    for n in range(4):
        rows[n, n] = 4 * x[n] - 1
    for e, (i, j) in enumerate(EDGES):
        rows[4 + e, i], rows[4 + e, j] = 4 * x[j], 4 * x[i]
    return rows


def places_of_solver():
    """Barycentric coordinates at which the solver evaluates det F of a quadratic element: Stroud's rule T3:5-1 and nodes."""
    root = np.sqrt(15)
    a, b, c = (7 + root) / 34, (7 - root) / 34, (5 - root) / 20
    orbits = [(0.25,) * 4, (a, a, a, 1 - 3 * a), (b, b, b, 1 - 3 * b), (c, c, 0.5 - c, 0.5 - c), (1, 0, 0, 0),
              (0.5, 0.5, 0, 0)]
    return [np.array(x) for orbit in orbits for x in sorted(set(itertools.permutations(orbit)))]


def jacobian(nodes, x):
    """Returns d position / d (barycentric coordinates 1 to 3) of an element with 4 or 10 nodes at x, 3 x 3."""
    rows = slopes(x) if len(nodes) == 10 else np.eye(4)
    by_coordinate = nodes.T @ rows
    return by_coordinate[:, 1:] - by_coordinate[:, :1]


def det_F(rest, moved, places):
    """F is the Jacobian of the deformed element times the inverse of that at rest; returns its smallest determinant."""
    return min(np.linalg.det(jacobian(moved, x) @ np.linalg.inv(jacobian(rest, x))) for x in places)


class ExportedBox(unittest.TestCase):
    def build(self, displacement="P1", stored="all"):
        self.build_scene(SCENE.format(displacement=displacement, stored=stored), *box())

    def build_scene(self, scene, points, tetrahedra):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        write_gmsh(self.folder / "box.msh", points, tetrahedra)
        (self.folder / "box.toml").write_text(scene, encoding="utf-8")
        self.run_palpate("build", "box.toml", "-o", "box.h5", "-j", "1")
        self.dataset = self.enterContext(h5py.File(self.folder / "box.h5"))

    def run_palpate(self, *words, code=0, lines=""):
        done = subprocess.run([PALPATE, *words], cwd=self.folder, input=lines, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, code, f"{words}: {done.stdout}")
        return done.stdout

    def export(self, name, *words, **options):
        self.run_palpate("export", "box.h5", "-o", name, *words, **options)
        return self.folder / name

    def row(self, *point):
        """The row of a lattice point in /points."""
        (row,) = np.flatnonzero((self.dataset["points/ijk"][:] == np.multiply(
            point, int(self.dataset["points"].attrs["divisions"]))).all(axis=1))
        return row

    def of_point(self, name, row):
        return self.dataset["points/" + name][row]

    def holds(self, grid, row):
        """Checks that a grid has the configuration of a row of /points."""
        mesh, stored = self.dataset["mesh"], self.dataset["mesh/stored_nodes"][:]
        np.testing.assert_array_equal(grid.points, mesh["points"][:][stored])
        np.testing.assert_array_equal(grid.point["displacement"], self.of_point("displacement", row))
        self.assertEqual(grid.point["displacement"].dtype, np.float32)
        np.testing.assert_array_equal(grid.point["fixed"], np.isin(stored, mesh["fixed_nodes"][:]))
        np.testing.assert_array_equal(grid.point["touched"], np.isin(stored, self.dataset["patches/node"][:]))
        for name in ("force", "stiffness", "energy"):
            np.testing.assert_array_equal(np.ravel(grid.field[name]), np.ravel(self.of_point(name, row)), name)
        np.testing.assert_array_equal(np.ravel(grid.field["tool_displacement"]), self.of_point("position", row))
        np.testing.assert_array_equal(np.ravel(grid.field["tool_place"]),
                                      mesh["points"][self.dataset["spaces/active_node"][0]])
        self.assertEqual(grid.field["inside"].item(), 1)

    def holds_volume(self, grid, row):
        """Checks that its elements are those of the mesh, with positive volume and the det F of the definition."""
        mesh = self.dataset["mesh"]
        tetrahedra = mesh["tetrahedra"][:]
        np.testing.assert_array_equal(grid.cells[:, :4], tetrahedra)
        quadratic = "edges" in mesh
        self.assertEqual(grid.cell_type, 24 if quadratic else 10)
        pressure = self.of_point("pressure", row)
        if quadratic:
            pressure = np.concatenate([pressure, pressure[mesh["edges"][:]].mean(axis=1)])
        np.testing.assert_allclose(grid.point["pressure"], pressure, rtol=1e-6, atol=1e-3)
        places = places_of_solver() if quadratic else [np.full(4, 0.25)]
        moved = grid.points + grid.point["displacement"]
        expected = []
        for nodes in grid.cells:
            rest = grid.points[nodes]
            for e, (i, j) in enumerate(EDGES if quadratic else []):
                np.testing.assert_allclose(rest[4 + e], (rest[i] + rest[j]) / 2, atol=1e-12)
            for x in places:
                self.assertGreater(np.linalg.det(jacobian(rest, x)), 0)
                self.assertGreater(np.linalg.det(jacobian(moved[nodes], x)), 0)
            expected.append(det_F(rest, moved[nodes], places))
        np.testing.assert_allclose(grid.cell["det_F"], expected, atol=2e-5)
        self.assertAlmostEqual(grid.cell["det_F"].min(), self.of_point("min_det_F", row), delta=2e-5)
        self.assertEqual(grid.field["min_det_F"].item(), self.of_point("min_det_F", row))
        self.assertGreater(np.ptp(grid.cell["det_F"]), 0.01, "nothing is deformed")


@needs_vtk
class ExportedBody(ExportedBox):
    def testVolumeMatchesTheDataset(self):
        for displacement in ("P1", "P2"):
            self.build(displacement)
            file = self.export("touch.vtu", "--point", "1", "-1", "-1")
            for grid in [VtkGrid(file)] + ([MeshioGrid(file)] if meshio else []):
                self.holds(grid, self.row(1, -1, -1))
                self.holds_volume(grid, self.row(1, -1, -1))

    def testSurfaceMatchesTheDataset(self):
        for displacement in ("P1", "P2"):
            self.build(displacement, stored="surface")
            file = self.export("touch.vtu", "--point", "1", "-1", "-1")
            for grid in [VtkGrid(file)] + ([MeshioGrid(file)] if meshio else []):
                self.holds(grid, self.row(1, -1, -1))
                self.assertEqual(grid.cell_type, 5)
                stored = self.dataset["mesh/stored_nodes"][:]
                np.testing.assert_array_equal(stored[grid.cells], self.dataset["mesh/surface"][:])
                self.assertNotIn("det_F", grid.cell)
                self.assertNotIn("pressure", grid.point)

    def testBetweenLatticePointsHasTheirMeanAndTheForceOfQuery(self):
        self.build()
        asked = ["--displacement", "0.0025", "0.001", "0"]
        grid = VtkGrid(self.export("touch.vtu", *asked))
        weights = {(0, 0, 0): 0.5 * 0.8, (1, 0, 0): 0.5 * 0.8, (0, 1, 0): 0.5 * 0.2, (1, 1, 0): 0.5 * 0.2}
        for name in ("displacement", "pressure"):
            mean = sum(weight * self.of_point(name, self.row(*point)) for point, weight in weights.items())
            np.testing.assert_allclose(grid.point[name], mean, rtol=1e-5, atol=1e-6 * np.abs(mean).max())
        answer = json.loads(self.run_palpate("query", "box.h5", *asked, "--json"))
        for name in ("force", "stiffness", "energy", "error_bound", "coverage"):
            np.testing.assert_array_equal(np.ravel(grid.field[name]), np.ravel(answer[name]), name)

    def testUnderGravityTheSagIsInTheDisplacementAndNotInTheTool(self):
        scene = SCENE.format(displacement="P1", stored="all").replace("c01 = 1280", "c01 = 1280\ndensity = 1000")
        self.build_scene(scene + "[gravity]\nacceleration = [0, 0, -9.81]\n", *box())
        rest, moved = (VtkGrid(self.export(f"{n}.vtu", "--point", str(n), "0", "0")) for n in (0, 1))
        sag = rest.point["displacement"]
        self.assertLess(sag[:, 2].min(), -1e-4, "it sags")
        for grid, n in ((rest, 0), (moved, 1)):
            self.holds(grid, self.row(n, 0, 0))
            self.holds_volume(grid, self.row(n, 0, 0))
            tool = np.ravel(grid.field["tool_displacement"])
            np.testing.assert_array_equal(tool, [0.005 * n, 0, 0])
            touched = grid.point["touched"] == 1
            np.testing.assert_allclose((grid.point["displacement"] - sag)[touched], np.tile(tool, (touched.sum(), 1)), atol=1e-8)

    def testUnderAFingerTheBodyMovesWithIt(self):
        self.build_scene(FINGER_SCENE, *box((6, 4, 4), 0.01))
        place = ["--at", "0.031", "0.022", "0.04"]
        site = VtkGrid(self.export("site.vtu", *place, "--point", "0", "0", "-1"))
        spaces, patches = self.dataset["spaces"], self.dataset["patches"]
        centers = spaces["finger"][:, :3]
        nearest = np.argmin(np.linalg.norm(centers - (0.031, 0.022, 0.04), axis=1))
        np.testing.assert_array_equal(np.ravel(site.field["tool_place"]), centers[nearest])
        of_site = slice(*spaces["first_patch_node"][nearest:nearest + 2])
        np.testing.assert_array_equal(np.flatnonzero(site.point["touched"]), patches["node"][of_site])
        mean = patches["weight"][of_site] @ site.point["displacement"][patches["node"][of_site]]
        np.testing.assert_allclose(mean, [0, 0, -0.006], atol=1e-7)
        self.assertAlmostEqual(site.cell["det_F"].min(), site.field["min_det_F"].item(), delta=2e-5)

        asked = [*place, "--displacement", "0.001", "0", "-0.004"]
        between = VtkGrid(self.export("between.vtu", *asked))
        answer = json.loads(self.run_palpate("query", "box.h5", *asked, "--json"))
        np.testing.assert_array_equal(np.ravel(between.field["tool_place"]), answer["at"])
        for name in ("force", "stiffness", "energy", "drive"):
            np.testing.assert_array_equal(np.ravel(between.field[name]), np.ravel(answer[name]), name)
        moved = between.point["displacement"][between.point["touched"] == 1].mean(axis=0)
        self.assertLess(np.linalg.norm(moved - (0.001, 0, -0.004)), 0.004)
        self.assertLess(moved[2], -0.001)

    def testPathIsASeriesWithTimes(self):
        self.build()
        series = ElementTree.parse(self.export("press.pvd", "--displacement", "0.004", "0", "-0.003", "--steps", "4"))
        steps = series.getroot().findall("./Collection/DataSet")
        self.assertEqual([float(step.get("timestep")) for step in steps], [0, 1, 2, 3, 4])
        for n, step in enumerate(steps):
            grid = VtkGrid(self.folder / step.get("file"))
            np.testing.assert_allclose(np.ravel(grid.field["tool_displacement"]), np.array([4e-3, 0, -3e-3]) * n / 4)
            self.assertAlmostEqual(grid.field["way"].item(), 5e-3 * n / 4)
            touched = grid.point["displacement"][grid.point["touched"] == 1]
            np.testing.assert_allclose(touched, np.tile([4e-3 * n / 4, 0, -3e-3 * n / 4], (len(touched), 1)), atol=1e-8)

    def testInterruptedLeavesNoListAndNoPartialFile(self):
        self.build()
        going = subprocess.Popen([PALPATE, "export", "box.h5", "-o", "press.pvd", "--displacement", "0.004", "0", "0",
                                  "--steps", "100000"], cwd=self.folder, stdout=subprocess.DEVNULL,
                                 stderr=subprocess.PIPE, text=True)
        self.addCleanup(going.kill)
        while not (self.folder / "press/press_0003.vtu").exists():
            self.assertIsNone(going.poll(), "it ended by itself")
            time.sleep(0.01)
        going.send_signal(signal.SIGINT)
        _, told = going.communicate()
        self.assertEqual(going.returncode, 130, told)
        self.assertIn("press.pvd was not written", told)
        self.assertFalse((self.folder / "press.pvd").exists())
        files = sorted((self.folder / "press").iterdir())
        self.assertEqual([file.name for file in files], [f"press_{n:04}.vtu" for n in range(len(files))])
        self.assertEqual(VtkGrid(files[-1]).point["displacement"].shape, VtkGrid(files[0]).points.shape)

    def testInterruptedWhileReadingReplacesNothing(self):
        self.build()
        (self.folder / "curve.csv").write_text("of yesterday", encoding="utf-8")
        going = subprocess.Popen([PALPATE, "export", "box.h5", "-o", "curve.csv", "--displacement", "-", "--replace"],
                                 cwd=self.folder, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.addCleanup(going.kill)
        going.stdin.write("0.001 0 0\n0.002 0 0\n")
        going.stdin.flush()
        time.sleep(1)
        going.send_signal(signal.SIGTERM)
        told = going.stdout.read()
        self.assertEqual((going.wait(), (self.folder / "curve.csv").read_text(encoding="utf-8")), (130, "of yesterday"), told)
        self.assertIn("nothing was written", told)
        going.stdin.close()
        going.stdout.close()

    def testAnInvalidPlaceKeepsTheEarlierSeries(self):
        self.build_scene(FINGER_SCENE, *box((6, 4, 4), 0.01))
        touch = "0.031 0.022 0.04 0 0 -0.004\n"
        self.export("press.pvd", "--at", "-", "--displacement", "-", lines=2 * touch)
        before = {file.name: file.read_bytes() for file in [self.folder / "press.pvd", *(self.folder / "press").iterdir()]}
        for words in (("--at", "-", "--displacement", "-"), ("--at", "31", "22", "40", "--point", "0", "0", "-1")):
            name = "press.pvd" if "-" == words[1] else "site.vtu"
            told = self.run_palpate("export", "box.h5", "-o", name, *words, "--replace", code=2, lines=touch + "31 22 40 0 0 -0.004\n")
            self.assertIn("--at", told)
        after = {file.name: file.read_bytes() for file in [self.folder / "press.pvd", *(self.folder / "press").iterdir()]}
        self.assertEqual(after, before)
        self.assertFalse((self.folder / "site.vtu").exists())

    def testOutsideIsMarked(self):
        self.build()
        grid = VtkGrid(self.export("out.vtu", "--displacement", "0.5", "0", "0", code=3))
        self.assertEqual(np.ravel(grid.field["inside"]).tolist(), [0])

    def testForcesAreACurveWithTheAnswersOfQuery(self):
        self.build()
        file = self.export("curve.csv", "--displacement", "0.006", "0", "0.012", "--steps", "6", code=3)
        with open(file, newline="", encoding="utf-8") as text:
            lines = list(csv.DictReader(text))
        places = "".join(f"{0.006 * (n / 6)!r} 0 {0.012 * (n / 6)!r}\n" for n in range(7))
        answers = self.run_palpate("query", "box.h5", "--displacement", "-", "--json", lines=places, code=3)
        for line, answer in zip(lines, map(json.loads, answers.splitlines()), strict=True):
            for name, unit in (("displacement", "m"), ("force", "N")):
                self.assertEqual([float(line[f"{name}_{axis}_{unit}"]) for axis in "xyz"], answer[name])
            self.assertEqual([[float(line[f"stiffness_{a}_{b}_N_per_m"]) for b in "xyz"] for a in "xyz"],
                             answer["stiffness"])
            for name, key in (("energy_J", "energy"), ("error_bound_N", "error_bound"), ("coverage", "coverage")):
                self.assertEqual(float(line[name]) if line[name] else None, answer[key], name)
            self.assertEqual(line["inside"] == "1", answer["inside"])
        self.assertEqual([line["inside"] for line in lines], ["1"] * 5 + ["0"] * 2)


# The steps of a person in ParaView; prints the results.
PARAVIEW = """
import sys
from paraview import simple

def opened(name):
    reader = simple.OpenDataFile(name)
    reader.UpdatePipeline()
    return reader

for name in sys.argv[2:]:
    reader = opened(name)
    for time in list(getattr(reader, "TimestepValues", None) or [0]):
        reader.UpdatePipeline(time)
        info = reader.GetDataInformation()
        way = reader.FieldData["way"]
        print(name, time, info.GetNumberOfPoints(), info.GetNumberOfCells(), way.GetRange(0)[0] if way else 0)
warped = simple.WarpByVector(Input=opened(sys.argv[2]), Vectors=["POINTS", "displacement"])
view = simple.CreateView("RenderView")
view.ViewSize = [400, 300]
shown = simple.Show(warped, view)
shown.Representation = "Surface With Edges"
simple.ColorBy(shown, ("CELLS", "det_F"))
shown.RescaleTransferFunctionToDataRange()
view.ResetCamera()
simple.SaveScreenshot(sys.argv[1], view)
"""


@needs_vtk
@needs_paraview
class ExportedToParaView(ExportedBox):
    def testOpensEveryFormatAndDrawsTheDeformedBody(self):
        self.build("P2")
        (self.folder / "open.py").write_text(PARAVIEW, encoding="utf-8")
        self.export("touch.vtu", "--point", "1", "-1", "-1")
        self.export("press.pvd", "--displacement", "0.004", "0", "-0.003", "--steps", "2")
        files = ["touch.vtu", "press.pvd"]
        command = ["pvpython", "--force-offscreen-rendering", "open.py", "body.png", *files]
        with virtual_screen() as env:
            pvpython = subprocess.run(command, cwd=self.folder, env=env, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                      text=True, check=False)
        self.assertEqual(pvpython.returncode, 0, pvpython.stdout)
        mesh = self.dataset["mesh"]
        seen = [line.split() for line in pvpython.stdout.splitlines() if line.split(" ")[0] in files]
        self.assertEqual([name for name, *_ in seen], files + ["press.pvd"] * 2, pvpython.stdout)
        for name, _, points, cells, _ in seen:
            self.assertEqual((int(points), int(cells)), (len(mesh["points"]), len(mesh["tetrahedra"])), name)
        self.assertEqual([float(time) for _, time, *_ in seen[-3:]], [0, 1, 2])
        np.testing.assert_allclose([float(way) for *_, way in seen[-3:]], [0, 2.5e-3, 5e-3])
        picture = self.folder / "body.png"
        reader = vtkPNGReader()
        reader.SetFileName(str(picture))
        reader.Update()
        pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
        colours, counts = np.unique(pixels, axis=0, return_counts=True)
        self.assertGreater(len(colours), 50)
        self.assertLess(counts.max() / counts.sum(), 0.97, "nothing but the background")
        if keep := os.environ.get("PALPATE_KEEP_PICTURE"):
            shutil.copy(picture, keep)


if __name__ == "__main__":
    unittest.main()
