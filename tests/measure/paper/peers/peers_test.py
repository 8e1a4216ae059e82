#!/usr/bin/python3
"""Tests the peers on meshes made here: derivatives by differences, equilibria, answers of reduced and trained models."""
import itertools
import pathlib
import sys
import types
import unittest
import unittest.mock

import numpy as np

TESTS = pathlib.Path(__file__).resolve().parents[3]
sys.path[:0] = [str(TESTS / "measure" / "paper"), str(TESTS / "support")]
sys.dont_write_bytecode = True

from kuhn_box import box

from peers import body, configurations, equilibrium, laws, loop, methods, reduced, sampled, setting

MOONEY_RIVLIN = laws.MooneyRivlin(1300.0, 1280.0)


def held_box(law=MOONEY_RIVLIN, patch=False):
    """Fixed at x = 0, with the tool at a corner of the other end, or at a whole edge there."""
    points, tetrahedra = box(size=0.03)
    far = np.isclose(points[:, 0], points[:, 0].max()) & np.isclose(points[:, 1], 0)
    tool = np.flatnonzero(far if patch else far & np.isclose(points[:, 2], 0))
    return body.Body(points, tetrahedra, np.flatnonzero(points[:, 0] == 0), tool, law)


def whole(some_body):
    return equilibrium.Whole(some_body, body.Factors)


class LawsTest(unittest.TestCase):
    def setUp(self):
        self.random = np.random.default_rng(1)
        self.F = np.eye(3) + 0.3 * self.random.standard_normal((20, 3, 3))
        self.F = self.F[np.linalg.det(self.F) > 0.2]
        self.p = 1000 * self.random.standard_normal(len(self.F))

    def testDerivativesMatchDifferences(self):
        for law in MOONEY_RIVLIN, laws.Corotated(5160.0):
            H, step = self.random.standard_normal(self.F.shape), 1e-6
            here = law.at(self.F, self.p)
            ahead, behind = law.at(self.F + step * H, self.p), law.at(self.F - step * H, self.p)
            along = lambda tensor: np.einsum("mij,mij->m", tensor, H)
            slope = lambda quantity: (quantity(ahead) - quantity(behind)) / (2 * step)
            np.testing.assert_allclose(along(here.stress), slope(lambda d: d.energy), rtol=1e-5, atol=1e-3)
            np.testing.assert_allclose(along(here.constraint_slope), slope(lambda d: d.constraint), rtol=1e-6, atol=1e-7)
            second = (here.tangent @ H.reshape(-1, 9, 1)).reshape(-1, 3, 3)
            np.testing.assert_allclose(second, slope(lambda d: d.stress), rtol=1e-4, atol=1e-1)

    def testRotationsStoreNothing(self):
        Q = np.linalg.qr(self.random.standard_normal((5, 3, 3)))[0]
        Q *= np.linalg.det(Q)[:, None, None]
        for law in MOONEY_RIVLIN, laws.Corotated(5160.0):
            np.testing.assert_allclose(law.at(Q, np.zeros(5)).energy, 0, atol=1e-9)

    def testBothLawsAreTheSameAtRest(self):
        one, other = (law.at(np.eye(3)[None], np.zeros(1)) for law in (MOONEY_RIVLIN, laws.Corotated(MOONEY_RIVLIN.shear_modulus)))
        np.testing.assert_allclose(one.tangent, other.tangent, atol=1e-8)
        np.testing.assert_allclose(one.constraint_slope, other.constraint_slope)


class BodyTest(unittest.TestCase):
    def testResidualAndTangentMatchDifferences(self):
        for law, patch in itertools.product((MOONEY_RIVLIN, laws.Corotated(5160.0)), (False, True)):
            model = held_box(law, patch)
            random = np.random.default_rng(2)
            z, p = 0.002 * random.standard_normal(model.size), np.array([0.004, -0.002, 0.003])
            dz, dp = random.standard_normal(model.size), random.standard_normal(3)
            step = 1e-7
            here = model.assemble(z, p)
            ahead, behind = model.assemble(z + step * dz, p + step * dp, False), model.assemble(z - step * dz, p - step * dp, False)
            self.assertAlmostEqual((ahead.energy - behind.energy) / (2 * step), here.residual @ dz - here.force @ dp, delta=1e-5)
            np.testing.assert_allclose((ahead.residual - behind.residual) / (2 * step), here.tangent @ dz + here.coupling @ dp, atol=2e-2)
            np.testing.assert_allclose((behind.force - ahead.force) / (2 * step), here.coupling.T @ dz + here.tool @ dp, atol=2e-2)

    def testForceIsMinusTheSlopeOfTheEnergy(self):
        model = whole(held_box(patch=True))
        place = np.array([0.02, 0.01, -0.015])
        here = equilibrium.transition(model, model.at_rest(), place)
        for axis in range(3):
            ends = [equilibrium.transition(model, here, place + sign * 1e-5 * np.eye(3)[axis]).energy for sign in (1, -1)]
            self.assertAlmostEqual(-(ends[0] - ends[1]) / 2e-5, here.force[axis], delta=1e-4)

    def testStiffnessIsTheSlopeOfTheForce(self):
        model = whole(held_box())
        here = equilibrium.transition(model, model.at_rest(), [0.01, 0.0, 0.005])
        K = body.stiffness(model.assemble(here.z, here.p), here.slope)
        moved = [equilibrium.transition(model, here, here.p + sign * np.array([1e-5, 0, 0])).force for sign in (1, -1)]
        np.testing.assert_allclose(K[:, 0], (moved[0] - moved[1]) / 2e-5, rtol=1e-4, atol=1e-3)
        np.testing.assert_allclose(K, K.T, atol=1e-8)


def lattice_of(some_body, spacing=0.01):
    """Configurations of the 27 places around rest, with rest first, and a probe between them."""
    places = spacing * np.array(sorted(itertools.product((-1, 0, 1), repeat=3), key=lambda p: sum(map(abs, p))), float)
    model = whole(some_body)
    rest = model.at_rest()
    solved = [equilibrium.transition(model, rest, p) for p in places]
    stiffness = [body.stiffness(model.assemble(one.z, one.p), one.slope) for one in solved]
    fields = [some_body.fields(one.z, one.p) for one in solved]
    probe = equilibrium.transition(model, rest, spacing * np.array([0.4, -0.6, 0.3]))
    return configurations.Configurations(
        "made here", some_body.points, some_body.tetrahedra, None, some_body.tool_nodes, spacing, spacing * 3**0.5, places,
        np.array([one.force for one in solved]), np.array(stiffness), np.array([one.energy for one in solved]),
        np.array([u for u, _ in fields]), np.array([some_body.pressure_scale * q for _, q in fields]), 0,
        probe.p[None], probe.force[None], np.array([probe.energy]), 0)


class ReducedTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.body = held_box(patch=True)
        cls.given = lattice_of(cls.body)
        cls.made = reduced.snapshots(cls.body, cls.given)

    def errorOf(self, model):
        reached = reduced.answer(model, self.given.probe_place[0], model.at_rest())
        return np.linalg.norm(reached.force - self.given.probe_force[0])

    def testMoreModesAreMoreAccurate(self):
        linear = np.linalg.norm(self.given.stiffness[0] @ self.given.probe_place[0] - self.given.probe_force[0])
        few, many = (self.errorOf(reduced.Reduced(self.body, self.made, modes)) for modes in (3, 15))
        self.assertLess(few, linear)
        self.assertLess(many, 0.2 * few)
        self.assertLess(many, 1e-3 * np.linalg.norm(self.given.probe_force[0]))

    def testAllModesReproduceTheConfigurations(self):
        model = reduced.Reduced(self.body, self.made, 26)
        for n in 5, 26:
            reached = equilibrium.newton(model, model.coordinates[n], self.given.place[n])
            np.testing.assert_allclose(reached.force, self.given.force[n], atol=1e-5)

    def testForceIsMinusTheSlopeOfTheEnergyWithFewElementsToo(self):
        whole_sum = reduced.Reduced(self.body, self.made, 4)
        few = sampled.Sampled(whole_sum, 1e-2, states=10)
        self.assertLess(len(few.elements), 0.9 * len(self.body.volume))
        for model in whole_sum, few:
            here = reduced.answer(model, self.given.probe_place[0], model.at_rest())
            for axis in range(3):
                ends = [equilibrium.transition(model, here, here.p + sign * 1e-5 * np.eye(3)[axis]).energy for sign in (1, -1)]
                self.assertAlmostEqual(-(ends[0] - ends[1]) / 2e-5, here.force[axis], delta=1e-4)

    def testFollowingAHandWithOldTangentsGivesTheSameAnswers(self):
        few = sampled.Sampled(reduced.Reduced(self.body, self.made, 4), 1e-2, states=10)
        rest = few.at_rest()
        follower, target = equilibrium.Follower(few, rest, tolerance=1e-7), self.given.probe_place[0]
        force = follower.walk(target)
        np.testing.assert_allclose(force, equilibrium.transition(few, rest, target).force, atol=1e-6)
        self.assertLess(follower.tangents, 4)

    def testMemoryIsCountedWithoutTheZerosBetweenDisplacementAndPressure(self):
        model = reduced.Reduced(self.body, self.made, 4)
        few = sampled.Sampled(model, 1e-2, states=5)
        beside = sum(kept.nbytes for kept in (self.made.lift, model.coordinates, self.body.gradients, self.body.volume))
        self.assertEqual(model.memory(), beside + 4 * self.body.tetrahedra.size + 8 * np.count_nonzero(model.basis))
        basis = few.memory() - sum(kept.nbytes for kept in (few.gradients, few.volume, few.coordinates))
        self.assertGreaterEqual(basis, 8 * np.count_nonzero(few.basis))  # those of fixed nodes are zero
        self.assertLess(basis, few.basis.nbytes)
        self.assertEqual(few.memory_with_shape() - few.memory(), 4 * self.body.displacements * (model.columns[0] + 3))

    def testAllElementsWithWeightOneAreTheReducedModel(self):
        model = reduced.Reduced(self.body, self.made, 4)
        few = sampled.Sampled(model, 1e-2, states=5)
        few.elements, few.weights = np.arange(len(self.body.volume)), np.ones(len(self.body.volume))
        few.gradients, few.volume, few.basis = self.body.gradients, self.body.volume, sampled.element_basis(model)
        a, p = model.coordinates[7], self.given.place[7] + 0.001
        one, other = model.assemble(a, p), few.assemble(a, p)
        self.assertAlmostEqual(one.energy, other.energy, delta=1e-12)
        for part in "residual", "force", "tangent", "coupling", "tool":
            np.testing.assert_allclose(getattr(one, part), getattr(other, part), atol=1e-8)


class NonNegativeTest(unittest.TestCase):
    def testFindsTheFewColumnsOfASum(self):
        random = np.random.default_rng(3)
        A, x = random.standard_normal((200, 100)), np.zeros(100)
        x[random.permutation(100)[:7]] = 1 + random.random(7)
        chosen, found, misfit = sampled.non_negative(A, A @ x, 1e-6, 100)
        self.assertLess(misfit, 1e-6)
        made = np.zeros(100)
        made[chosen] = found
        np.testing.assert_allclose(made, x, atol=1e-5)

    def testIsNotNegativeWhereLeastSquaresWouldBe(self):
        random = np.random.default_rng(4)
        A, b = random.standard_normal((60, 30)), random.standard_normal(60)
        chosen, found, misfit = sampled.non_negative(A, b, 1e-6, 30)
        self.assertTrue((found > 0).all())
        import scipy.optimize
        self.assertAlmostEqual(misfit * np.linalg.norm(b), scipy.optimize.nnls(A, b)[1], delta=1e-6)


class NetworkTest(unittest.TestCase):
    def setUp(self):
        try:
            from peers import network
        except Exception as missing:  # record.NotMeasured: python3-torch is missing
            self.skipTest(str(missing))
        self.network, self.given = network, lattice_of(held_box())

    def testTheExportedNetworkGivesTheSameAnswers(self):
        for kind, activation in itertools.product(self.network.KINDS, self.network.ACTIVATIONS):
            model = self.network.Model(kind, self.network.Settings(8, 3, activation, 0.01, "squared"), self.given)
            exported, places = self.network.Exported(model), self.network.data_of(self.given).place
            np.testing.assert_allclose(exported.force(self.given.place), model.force(places).detach().numpy(), atol=1e-12)
            np.testing.assert_allclose(exported.force(self.given.place[3]), model.force(places[3:4]).detach().numpy()[0], atol=1e-12)

    def testASearchLearnsMoreThanTheLinearBody(self):
        effort = self.network.Effort(2, 100, 1, 200, 50, 1, 20)
        model, told = self.network.search("energy", self.given, effort)
        linear = np.linalg.norm(self.given.force - self.given.place @ self.given.stiffness[0], axis=1).mean()
        self.assertLess(told["training_error"], 0.3 * linear)


class AnswersTest(unittest.TestCase):
    def testMissingAnswersAreCountedAndNotAveraged(self):
        exact = np.array([[1.0, 0, 0], [2.0, 0, 0], [0, 0, 0.01]])
        told = configurations.errors(np.array([[1.1, 0, 0], [np.nan] * 3, [0, 0, 0.02]]), exact)
        self.assertEqual(told["unanswered"], 1)
        self.assertAlmostEqual(told["mean"], 0.055)
        self.assertAlmostEqual(told["worst"], 0.1)
        self.assertAlmostEqual(told["in_target"], 100 / 3)
        self.assertAlmostEqual(told["relative_p95"], 10 + 0.95 * 10)  # 0.01 N relative to the floor of 0.05 N; 10 % of 1 N
        self.assertEqual(configurations.errors(np.full((3, 3), np.nan), exact)["unanswered"], 3)

    def testMissingAnswersHaveAnInfiniteError(self):
        given = setting.Setting(None, None, types.SimpleNamespace(probe_force=np.array([[1.0, 0, 0], [2.0, 0, 0]])), None, 0, [], [], "")
        self.assertEqual(given.lengths_of_errors([[1.0, 2.0, 0], None]), [2.0, float("inf")])

    def testWithoutAnIterateInTimeAllSolversAnswerLinearly(self):
        place, length = np.array([[0.0] * 3, [0.01, 0, 0]]), round(loop.SPEEDS[0] * loop.BUDGETS[0], 9)
        given = types.SimpleNamespace(place=place, force=100 * place, stiffness=np.array([100 * np.eye(3)] * 2))
        _, ways = loop.movements(given, 1)
        exact = {length: [{"force": (100 * (place[1] + length * ways[0])).tolist(), "seconds": 1.0}]}
        late = [{"seconds": 1.0, "converged": True, "force": [7.0, 0, 0]}]
        with unittest.mock.patch.object(loop, "BUDGETS", loop.BUDGETS[:1]), unittest.mock.patch.object(loop, "SPEEDS", loop.SPEEDS[:1]):
            for rows, never in ((loop.worker_rows(exact, given, 1), 0), (loop.getfem_rows({length: [late]}, exact, given, 1), 0),
                                (loop.getfem_rows({length: [[]]}, exact, given, 1), 1)):
                self.assertEqual(rows[0][4:6], [1, 0])
                self.assertEqual(rows[0][7], never)
                self.assertAlmostEqual(rows[0][-1], 0)

    def testTheErrorOfALateLinearAnswerGrowsWithTheHandsMotion(self):
        path = [[0.001 * n, 0, 0] for n in range(41)]
        force = [[place[0] ** 2, 0, 0] for place in path]
        stiffness = [np.diag([2 * place[0], 0, 0]) for place in path]
        at_once = loop.two_rates("", lambda way: 0.0, path, force, stiffness)
        never = loop.two_rates("", lambda way: 1e9, path, force, stiffness)
        for speed, quick, stuck in zip(loop.SPEEDS, at_once, never):
            self.assertEqual(quick[1], 1e3 * speed)
            self.assertEqual(quick[-1], 0)
            self.assertAlmostEqual(stuck[-1], 0.04**2)
            self.assertAlmostEqual(quick[2] * 0.04 / speed, 40)
            self.assertEqual(stuck[2], 0)

    def testTheOtherSolverIsReportedIfOneNeverConverges(self):
        record, made = unittest.mock.MagicMock(), types.SimpleNamespace(value={
            "place": [[0.0] * 3, [0.001, 0, 0]], "force": [[0.0] * 3] * 2, "stiffness": [np.zeros((3, 3))] * 2, "largest_difference": 0.0,
            "largest_difference_N": 0.0})
        given = types.SimpleNamespace(name="here", case=setting.Case(500, 0.0, 0.06, 3, 20), configurations=None, body=None, fine=[0],
                                      row=lambda label, value, *_, **__: [label, value.get("answer_s")])
        told = dict(by_worker=({0.001: [{"force": [0.0] * 3, "seconds": 1.0}]}, made), exact_along=made, worker_rows=[],
                    by_getfem=({0.001: [[], [{"seconds": 9.0, "converged": False, "force": [0.0] * 3}]]}, made), getfem_rows=[])
        with unittest.mock.patch.multiple(loop, **{name: unittest.mock.Mock(return_value=value) for name, value in told.items()}):
            _, rates, main = methods.newton(record, given)
        self.assertEqual([row[0] for row in rates], ["this project's worker"] * len(loop.SPEEDS) + ["GetFEM"])
        self.assertEqual([row[1] for row, _ in main], [1.0, None])
        self.assertEqual(rates[-1][1:], [None] * (len(loop.TWO_RATES) - 1))
        record.not_measured.assert_called_once_with("here/GetFEM at two rates", "not one of its movements converged")

    def testASolverAnswersExactlyIfItConvergesInTime(self):
        length = round(loop.SPEEDS[0] * loop.BUDGETS[0], 9)
        outcomes = lambda _: [(0.5e-3, lambda budget: [1, 0, 0]), (0.5, lambda budget: [3, 0, 0]), None, (None, lambda budget: [2, 0, 0])]
        first = loop.rows_of("", outcomes, lambda _: [[1, 0, 0]] * 4)[0]
        self.assertEqual(first[3:6], [1e3 * length, 3, 100 / 3])
        self.assertEqual(first[7:], [1, 1.0, 2.0])


class GetfemTest(unittest.TestCase):
    def testSolvesTheSameEquations(self):
        try:
            from peers import getfem_body
        except Exception as missing:  # record.NotMeasured: python3-getfem is missing
            self.skipTest(str(missing))
        some_body = held_box(patch=True)
        given = lattice_of(some_body)
        solver = getfem_body.GetfemBody(some_body, np.flatnonzero(some_body.points[:, 0] == 0))
        self.assertTrue(solver.start(given.displacement[9], given.pressure[9], given.place[9]))
        np.testing.assert_allclose(solver.force(), given.force[9], atol=1e-6)
        history = solver.history(solver.kept(), given.probe_place[0])
        self.assertTrue(history[-1]["converged"])
        np.testing.assert_allclose(history[-1]["force"], given.probe_force[0], atol=1e-5)


if __name__ == "__main__":
    unittest.main()
