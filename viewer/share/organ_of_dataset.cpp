#include "viewer/share/organ_of_dataset.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/problem/selection.hpp"
#include "common/problem/sites.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/haptics/touch_surface.hpp"

namespace palpate {
namespace {

/// Largest number of modes. Each mode takes one byte per shape; with more, a page would exceed 10
/// MB.
constexpr Eigen::Index most_modes = 255;
/// No further modes are added once the remaining error is below this value, m, root mean square
/// over the vertices of all shapes. Such an error is not visible.
constexpr double missed_by_modes = 5e-5;

using Shapes = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns the displacements of all surface nodes in one space, m, one row per point; zero for
/// unsolved points.
Shapes shapesOf(const Dataset& dataset, std::size_t space) {
  const std::vector<float> values = dataset.surfaceFields(space).displacement;
  const auto width = 3 * std::ssize(dataset.surfaceNodes());
  PALPATE_ASSERT(std::ssize(values) == width * std::ssize(dataset.spaces()[space].points),
                 "a dataset must store the displacements of surface nodes");
  Shapes shapes = Eigen::Map<const Shapes>(values.data(), std::ssize(values) / width, width);
  return shapes.array().isNaN().select(0.0f, shapes);
}

/// Returns how many of the largest eigenvalues must be subtracted from the sum of all until the
/// remainder is small enough. Rounds up to a multiple of three, at most most_modes. eigenvalues: in
/// ascending order. sum: of all eigenvalues. values: number of values in all shapes.
Eigen::Index modesNeeded(const Eigen::VectorXd& eigenvalues, double sum, double values) {
  double missed = sum;
  Eigen::Index count = 0;
  while (count < std::min(most_modes, eigenvalues.size()) &&
         missed > missed_by_modes * missed_by_modes * values)
    missed -= eigenvalues[eigenvalues.size() - ++count];
  return std::min(most_modes, (count + 2) / 3 * 3);
}

/// Returns `count` columns to start the subspace iteration. Each is the sum of a group of
/// successive shapes and of a column of the identity matrix, so that the columns have full rank.
Eigen::MatrixXd someOf(const std::vector<Shapes>& all, Eigen::Index width, Eigen::Index count) {
  std::int64_t rows = 0, row = 0;
  for (const Shapes& shapes : all) rows += shapes.rows();
  Eigen::MatrixXd some = Eigen::MatrixXd::Identity(width, count);
  for (const Shapes& shapes : all)
    for (Eigen::Index n = 0; n < shapes.rows(); ++n, ++row)
      some.col(row * count / rows) += shapes.row(n).transpose().cast<double>();
  return some;
}

/// Returns the sum of S^T S Q over all matrices of shapes S.
Eigen::MatrixXd productsWith(const std::vector<Shapes>& all, const Eigen::MatrixXd& q) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(q.rows(), q.cols());
  for (const Shapes& shapes : all) {
    const Eigen::MatrixXd exact = shapes.cast<double>();
    sum.noalias() += exact.transpose() * (exact * q);
  }
  return sum;
}

/// Reduces the shapes to modes by subspace iteration, because the full covariance matrix of
/// thousands of vertices would not fit into memory. Two iterations find the important modes. The
/// last modes converge least, but also matter least.
CarriedShapes reducedShapes(const Dataset& dataset) {
  const auto width = 3 * std::ssize(dataset.surfaceNodes());
  std::vector<Shapes> all;
  double sum = 0, rows = 0;
  for (std::size_t s = 0; s < dataset.spaces().size(); ++s) {
    all.push_back(shapesOf(dataset, s));
    sum += all.back().cast<double>().squaredNorm();
    rows += static_cast<double>(all.back().rows());
  }
  const Eigen::Index tried = std::min<Eigen::Index>(width, most_modes + 17);
  const auto orthonormal = [&](const Eigen::MatrixXd& columns) -> Eigen::MatrixXd {
    return Eigen::HouseholderQR<Eigen::MatrixXd>(columns).householderQ() *
           Eigen::MatrixXd::Identity(width, tried);
  };
  Eigen::MatrixXd q = orthonormal(someOf(all, width, tried));
  for (int turn = 0; turn < 2; ++turn) q = orthonormal(productsWith(all, q));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(q.transpose() * productsWith(all, q));
  const Eigen::Index count =
      modesNeeded(modes.eigenvalues(), sum, rows * static_cast<double>(width));
  const Shapes basis =
      (q * modes.eigenvectors().rightCols(count).rowwise().reverse()).transpose().cast<float>();
  CarriedShapes reduced;
  reduced.mode_count = at(count);
  reduced.modes.assign(basis.data(), basis.data() + basis.size());
  for (const Shapes& shapes : all) {
    const Shapes shares = shapes * basis.transpose();
    reduced.shares.emplace_back(shares.data(), shares.data() + shares.size());
  }
  return reduced;
}

CarriedTouch touchOf(const TouchArea& area, const Dataset& dataset) {
  const auto sites = chosenOf(dataset.spaces(), area.spaces);
  const auto around = placesAround(dataset.mesh(), centersOf(sites), area.radius);
  const auto number = [](std::size_t space) { return static_cast<std::int32_t>(space); };
  return {.name = area.name,
          .spaces = mapped(area.spaces, number),
          .finger_radius = area.radius,
          .collocation_points = AreaField::collocationPointsOf(sites, around).places};
}

CarriedTouch touchOf(std::size_t space, const Dataset& dataset) {
  const ActivePatch& patch = dataset.spaces()[space].patch;
  return {.name = patch.name,
          .spaces = {static_cast<std::int32_t>(space)},
          .rest = dataset.mesh().nodes[at(patch.node)]};
}

/// Returns the index of the space with the largest weight in a triangle.
std::int32_t spaceOf(const TouchSurface& surface, std::int32_t triangle) {
  const auto shares = surface.cornerSharesOf(triangle);
  return std::ranges::max_element(shares, {},
                                  [](const CornerShares& one) { return one.weights.sum(); })
      ->space;
}

}  // namespace

CarriedOrgan organOf(const Dataset& dataset) {
  const TouchSurface surface(dataset);
  if (surface.vertices().size() > most_carried_vertices)
    throw failure(
        "{}: the surface has {} vertices, but a page draws at most {}; share a coarser mesh",
        dataset.file().string(), surface.vertices().size(), most_carried_vertices);
  CarriedOrgan organ;
  organ.name = dataset.scene().name;
  organ.max_force = dataset.scene().workspace.max_force;
  organ.has_fibers = hasFibers(dataset.scene().regions);
  organ.vertices = surface.vertices();
  organ.triangles = surface.triangles();
  organ.spaces = dataset.spaces();
  for (const TouchArea& area : surface.areas()) organ.touches.push_back(touchOf(area, dataset));
  std::vector<std::int32_t> touch_of_space;
  for (std::size_t space = 0; space < organ.spaces.size(); ++space) {
    const std::int32_t area = surface.areaOfSpace(space);
    touch_of_space.push_back(area >= 0 ? area : static_cast<std::int32_t>(organ.touches.size()));
    if (area < 0) organ.touches.push_back(touchOf(space, dataset));
  }
  for (std::int32_t t = 0; t < std::ssize(organ.triangles); ++t)
    organ.touch_of_triangle.push_back(surface.touchable(t) ? touch_of_space[at(spaceOf(surface, t))]
                                                           : -1);
  organ.shapes = reducedShapes(dataset);
  return organ;
}

}  // namespace palpate
