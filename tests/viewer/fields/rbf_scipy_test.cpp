#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "tests/support/command.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr const char* program = R"(
import sys, warnings
import numpy as np
from scipy.interpolate import RBFInterpolator
warnings.simplefilter("ignore")  # a degree below the recommended one is what we want
points, queries = np.loadtxt(sys.argv[1]), np.loadtxt(sys.argv[2])
rbf = RBFInterpolator(points[:, :3], points[:, 3:], kernel=sys.argv[3], degree=-1)  # no polynomial
np.savetxt(sys.stdout, rbf(queries), fmt="%.17g")
)";

class AgainstScipy : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(RbfField, AgainstScipy, ::testing::Values("linear", "cubic"),
                         [](const auto& kernel) { return std::string(kernel.param); });

TEST_P(AgainstScipy, ForcesMatchItsRbfInterpolator) {
  if (test::runCommand("/usr/bin/python3 -c 'import scipy.interpolate'").exit_code != 0)
    GTEST_SKIP() << "NOT COMPARED WITH SCIPY: /usr/bin/python3 has no scipy; install python3-scipy";

  const SpaceTable space = test::solvedSpace(Lattice(0.02, 0.005), test::StiffeningEnergy());
  const test::TemporaryDirectory directory;
  std::ofstream points(directory / "points.txt"), queries(directory / "queries.txt");
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Vector3d p = space.lattice.displacement(n), &f = space.points[n].equilibrium.force;
    points << fmt::format("{:.17g} {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", p.x(), p.y(), p.z(),
                          f.x(), f.y(), f.z());
  }
  std::vector<Vector3d> places;
  for (int n = 0; n < 100; ++n)
    places.emplace_back(0.019 * std::sin(1.0 * n) *
                        Vector3d(std::cos(3.0 * n), std::sin(3.0 * n), 0.3));
  for (const Vector3d& p : places)
    queries << fmt::format("{:.17g} {:.17g} {:.17g}\n", p.x(), p.y(), p.z());
  points.close();
  queries.close();
  std::ofstream(directory / "rbf.py") << program;

  const test::CommandResult interpolated = test::runCommand(fmt::format(
      "/usr/bin/python3 {} {} {} {}", (directory / "rbf.py").string(),
      (directory / "points.txt").string(), (directory / "queries.txt").string(), GetParam()));
  ASSERT_EQ(interpolated.exit_code, 0) << interpolated.output;
  std::istringstream forces(interpolated.output);
  const auto field = makeForceField(std::string("rbf-") + GetParam(), space);
  for (const Vector3d& p : places) {
    Vector3d expected;
    ASSERT_TRUE(forces >> expected.x() >> expected.y() >> expected.z());
    EXPECT_LE((field->evaluate(p).force - expected).norm(), 1e-9 * (1 + expected.norm()));
  }
}

}  // namespace
}  // namespace palpate
