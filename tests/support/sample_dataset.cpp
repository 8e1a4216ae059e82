#include "tests/support/sample_dataset.hpp"

#include <array>
#include <cmath>
#include <random>

#include "tests/support/meshes.hpp"

namespace palpate::test {
namespace {

/// The differences between the sizes.
struct Extent {
  int cells;      ///< along an edge of the cube
  double radius;  ///< m
  std::vector<ActivePatch> active;
  std::int32_t failed_point, failed_element, unknown_point, terminating_point;
};

Extent extentOf(SampleDataset::Size size) {
  if (size == SampleDataset::Size::small)
    return {1, 0.01, {{"tip", 7, {7}}, {"edge-2", 3, {1, 3}}}, 2, 4, 6, 5};
  return {2, 0.02, {{"tip", 26, {26}}, {"edge-2", 8, {5, 8}}}, 7, 11, 32, 20};
}

/// The derivative of order `derivative` of x^n.
double power(double x, int n, int derivative) {
  double factor = 1;
  for (int i = 0; i < derivative; ++i) factor *= n - i;
  return factor == 0 ? 0 : factor * std::pow(x, n - derivative);
}

Problem sampleProblem(PressureSpace pressure, DisplacementSpace displacement,
                      const Extent& extent) {
  Problem problem;
  problem.mesh = cubeMesh(0.1, extent.cells);
  problem.fixed = problem.mesh.node_groups.at("xmin");
  Scene& scene = problem.scene;
  scene.name = "sample";
  scene.mesh = "sample.msh";
  scene.regions[0].material =
      pressure == PressureSpace::none
          ? Material{.law = LawName::linear, .young = 15e3, .poisson = 0.4}
          : Material{.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280};
  scene.discretization = {displacement, pressure};
  scene.fixed.nodes = problem.fixed;
  scene.workspace = {
      .radius = extent.radius, .spacing = 0.01, .max_force = 8.5, .reject_inverted = true};
  problem.active = extent.active;
  for (const ActivePatch& patch : problem.active) {
    ActiveSelection active;
    active.name = patch.name;
    active.node = patch.node;
    scene.active.push_back(active);
  }
  problem.region_of.assign(problem.mesh.tetrahedra.size(), 0);
  if (displacement == DisplacementSpace::p2) addMidEdgeNodes(problem.mesh);
  problem.pressures = pressureSlots(problem);
  if (displacement == DisplacementSpace::p1) return problem;
  std::vector<std::int32_t>& edge = problem.active[1].nodes;
  edge.push_back(midEdgeNode(problem.mesh, edge[0], edge[1]));
  problem.active[1].weights = {0.25, 0.25, 0.5};
  scene.active[1].radius = 0.05;
  scene.active[1].tool = ToolKind::weighted_average;
  return problem;
}

PointRecord recordAt(const Eigen::Vector3d& p, std::int32_t n, const AnalyticEnergy& energy) {
  PointRecord point;
  point.tag = Tag::expandable;
  point.parent = 0;
  point.equilibrium = {
      {-energy.gradient(p), -energy.hessian(p), energy.energy(p), 0.5 + 1.0 / (n + 2)}, {}};
  point.residual = 1e-9 * (n + 1);
  point.cost = {3 + n % 4, 4 + n % 4, 1, 0};
  return point;
}

void clear(PointRecord& point, Tag tag, Cause cause) {
  const Cost cost = point.cost;
  point = {};
  point.tag = tag;
  point.cause = cause;
  point.cost = cost;
}

}  // namespace

double StiffeningEnergy::energy(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d q = p / 0.02;
  return 0.02 * (std::cosh(q.x()) - 1 + 0.5 * q.y() * q.y() * std::exp(0.3 * q.z()) +
                 std::cos(q.y() - q.z()) - 1 + q.z() * q.z());
}

Eigen::Vector3d StiffeningEnergy::gradient(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d q = p / 0.02;
  const double x = q.x(), y = q.y(), z = q.z(), e = std::exp(0.3 * z);
  return {std::sinh(x), y * e - std::sin(y - z), 0.15 * y * y * e + std::sin(y - z) + 2 * z};
}

Eigen::Matrix3d StiffeningEnergy::hessian(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d q = p / 0.02;
  const double y = q.y(), z = q.z(), e = std::exp(0.3 * z), c = std::cos(y - z);
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  h(0, 0) = std::cosh(q.x());
  h(1, 1) = e - c;
  h(1, 2) = h(2, 1) = 0.3 * y * e + c;
  h(2, 2) = 0.045 * y * y * e - c + 2;
  return h / 0.02;
}

PolynomialEnergy::PolynomialEnergy(int degree, double length) : length_(length) {
  std::mt19937 random(20);
  for (int a = 0; a <= degree; ++a)
    for (int b = 0; a + b <= degree; ++b)
      for (int c = 0; a + b + c <= degree; ++c)
        terms_.push_back({static_cast<double>(random()) / 2147483648.0 - 1, {a, b, c}});
}

double PolynomialEnergy::sum(const Eigen::Vector3d& p, std::array<int, 3> derivative) const {
  double total = 0;
  for (const Term& term : terms_) {
    double value = term.factor;
    for (std::size_t axis = 0; axis < 3; ++axis)
      value *= power(p[static_cast<int>(axis)] / length_, term.powers[axis], derivative[axis]) /
               std::pow(length_, derivative[axis]);
    total += value;
  }
  return total;
}

double PolynomialEnergy::energy(const Eigen::Vector3d& p) const { return sum(p, {0, 0, 0}); }

Eigen::Vector3d PolynomialEnergy::gradient(const Eigen::Vector3d& p) const {
  return {sum(p, {1, 0, 0}), sum(p, {0, 1, 0}), sum(p, {0, 0, 1})};
}

Eigen::Matrix3d PolynomialEnergy::hessian(const Eigen::Vector3d& p) const {
  Eigen::Matrix3d h;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      std::array<int, 3> derivative = {0, 0, 0};
      ++derivative[i];
      ++derivative[j];
      h(static_cast<int>(i), static_cast<int>(j)) = sum(p, derivative);
    }
  return h;
}

SpaceTable solvedSpace(const Lattice& lattice, const AnalyticEnergy& energy) {
  SpaceTable space;
  space.lattice = lattice;
  space.patch = {"tip", 0, {0}};
  for (std::int32_t n = 0; n < lattice.size(); ++n) {
    space.points.push_back(recordAt(lattice.displacement(n), n, energy));
    if (n > 0 && n < lattice.uniformSize()) space.points[n].parent = lattice.neighbours(n)[0];
  }
  return space;
}

SampleDataset::SampleDataset(PressureSpace pressure, DisplacementSpace displacement, Size size)
    : problem(sampleProblem(pressure, displacement, extentOf(size))),
      lattice(problem.scene.workspace.radius, problem.scene.workspace.spacing) {
  for (std::size_t s = 0; s < problem.active.size(); ++s) {
    spaces.push_back(solvedSpace(lattice, StiffeningEnergy()));
    spaces[s].patch = problem.active[s];
    for (std::int32_t n = 0; n < lattice.size(); ++n)
      spaces[s].points[n].fields = fields(s, n).id();
  }
  SpaceTable& tip = spaces[0];
  const Extent extent = extentOf(size);
  const std::int32_t failed = extent.failed_point;
  tip.points[extent.terminating_point].tag = Tag::terminating;
  clear(tip.points[failed], Tag::failed, Cause::wrong_inertia);
  clear(tip.points[extent.unknown_point], Tag::unknown, Cause::none);
  const std::int32_t element = extent.failed_element;
  tip.attempts = {{failed, 0, {Cause::wrong_inertia, 0.75, 2e-3, element, 0.125, 28, 27, 0, 0}},
                  {failed, 1, {Cause::factorization_failed, 0.5, 1.5, -1, 0, 0, 27, -9, 4096}}};
}

void SampleDataset::refine() {
  problem.scene.accuracy = {.force_error = 0.03, .probes = 2};
  lattice = uniformLattice(problem.scene);
  for (SpaceTable& space : spaces) {
    space.lattice = lattice;
    for (const Eigen::Vector3d& place :
         {Eigen::Vector3d(0.0123, -0.001, 0.004), Eigen::Vector3d(0, 0.0199, 0)}) {
      const Eigen::Vector3d p = lattice.radius() / 0.02 * place;
      space.probes.push_back({p, recordAt(p, 3, StiffeningEnergy())});
    }
  }
  clear(spaces[0].probes[1].record, Tag::failed, Cause::step_budget);
  SpaceTable& edge = spaces[1];
  const std::int32_t half = lattice.divisions() / 2, quarter = half / 2;
  edge.splits = {{{0, 0, 0}, 0}, {{half, 0, 0}, 1}};
  const auto add = [&](const LatticePoint& point) {
    if (edge.lattice.indexOf(point)) return;
    edge.lattice.add(point);
    const std::int32_t n = edge.lattice.size() - 1;
    edge.points.push_back(recordAt(edge.lattice.displacement(n), n, StiffeningEnergy()));
    edge.points[n].fields = fields(1, n).id();
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        add({i * half, j * half, k * half});
        add({half + i * quarter, j * quarter, k * quarter});
      }
  add({4 * half, 2 * half, 2 * half});                           // completes a cell at the boundary
                                                                 // of the ball
  edge.points[3].equilibrium.force += Eigen::Vector3d(0, 7, 0);  // another branch
}

NodalFields SampleDataset::fields(std::size_t space, std::int32_t point) const {
  NodalFields values;
  const std::size_t n_nodes = problem.mesh.nodes.size();
  for (std::size_t i = 0; i < 3 * n_nodes; ++i)
    values.displacement.push_back(1e-3f * static_cast<float>(point) +
                                  1e-6f * static_cast<float>(i * (space + 1)));
  for (std::size_t i = 0; i < problem.pressures.count(); ++i)
    values.pressure.push_back(100.0f + static_cast<float>(i) / (1.0f + static_cast<float>(point)));
  return values;
}

void SampleDataset::seal(const std::filesystem::path& file) const {
  sealDataset(file, problem, rowsOf(spaces), kernel_family,
              [this](std::size_t space, std::int32_t point) { return fields(space, point); });
}

}  // namespace palpate::test
