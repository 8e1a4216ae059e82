#include "worker/system.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"

namespace palpate {
namespace {

/// The buffers of an assembly end with what belongs to the tool, then a sink for what belongs to nobody.
constexpr std::int32_t tool_rows = 3;
constexpr std::int32_t tool_diagonal = 3;  ///< K_aa from diagonal local entries, one per direction
constexpr std::int32_t tool_off_diagonal =
    9;  ///< K_aa from local entries above the diagonal, to be added with its transpose

ElementParameters parametersOf(const Scene& scene) {
  const Material& material = scene.regions[0].material;
  ElementParameters parameters;
  parameters.law = material.law;
  parameters.pressure = scene.discretization.pressure;
  parameters.constraint = scene.discretization.constraint;
  parameters.c10 = material.c10;
  parameters.c01 = material.c01;
  if (material.law == LawName::mooney_rivlin) {
    parameters.mu = 2 * (material.c10 + material.c01);
  } else if (material.poisson) {
    const double nu = *material.poisson;
    parameters.mu = material.young / (2 * (1 + nu));
    parameters.lambda = material.young * nu / ((1 + nu) * (1 - 2 * nu));
  } else {
    parameters.mu = material.young / 3;
  }
  return parameters;
}

}  // namespace

System::System(const Problem& problem, const ElementKernels& kernels)
    : problem_(problem), kernels_(kernels), parameters_(parametersOf(problem.scene)) {
  mean_edge_ = measure(problem.mesh).mean_edge;
  parameters_.pressure_scale = parameters_.mu / mean_edge_;
  if (parameters_.pressure == PressureSpace::p1_stabilized) parameters_.stabilization = 1 / parameters_.mu;
  numberUnknowns();
  buildBatches();
  buildScatter();
  chooseTool(0);
}

void System::numberUnknowns() {
  const std::size_t nodes = problem_.mesh.nodes.size();
  const bool mixed = parameters_.pressure != PressureSpace::none;
  std::vector<std::uint8_t> fixed(nodes, 0);
  for (const std::int32_t node : problem_.fixed) fixed[node] = 1;
  unknown_of_.assign(4 * nodes, -1);
  for (std::size_t node = 0; node < nodes; ++node) {
    for (int i = 0; i < 3 && !fixed[node]; ++i) unknown_of_[4 * node + i] = pattern_.n++;
    if (mixed) unknown_of_[4 * node + 3] = pattern_.n++;
  }
  pressures_ = mixed ? static_cast<std::int32_t>(nodes) : 0;
}

void System::buildBatches() {
  const Mesh& mesh = problem_.mesh;
  const std::size_t count = mesh.tetrahedra.size();
  batches_of_node_.resize(mesh.nodes.size());
  for (std::size_t first = 0; first < count; first += lanes) {
    BatchGeometry batch;
    for (int lane = 0; lane < lanes; ++lane) {
      const std::size_t element = std::min(first + lane, count - 1);
      const Tetrahedron& tetrahedron = mesh.tetrahedra[element];
      Eigen::Matrix3d edges;
      for (int a = 0; a < 3; ++a) edges.row(a) = mesh.nodes[tetrahedron[a]] - mesh.nodes[tetrahedron[3]];
      const Eigen::Matrix3d gradients = edges.inverse();  // column a is grad N_a
      for (int a = 0; a < 3; ++a)
        for (int I = 0; I < 3; ++I) batch.gradient[a][I][lane] = gradients(I, a);
      batch.volume[lane] = first + lane < count ? sixVolume(mesh, element) / 6 : 0.0;
      for (int a = 0; a < 4; ++a) {
        batch.node[a][lane] = tetrahedron[a];
        auto& touching = batches_of_node_[tetrahedron[a]];
        const auto number = static_cast<std::int32_t>(batches_.size());
        if (touching.empty() || touching.back() != number) touching.push_back(number);
      }
    }
    batches_.push_back(batch);
  }
}

void System::buildScatter() {
  std::vector<std::vector<std::int32_t>> columns(pattern_.n);
  for (const Tetrahedron& tetrahedron : problem_.mesh.tetrahedra)
    for (const std::int32_t a : tetrahedron)
      for (int i = 0; i < 4; ++i) {
        const std::int32_t row = unknown_of_[4 * a + i];
        if (row < 0) continue;
        for (const std::int32_t b : tetrahedron)
          for (int j = 0; j < 4; ++j) {
            const std::int32_t column = unknown_of_[4 * b + j];
            if (column >= row) columns[row].push_back(column);
          }
      }
  diagonal_.resize(pattern_.n);
  for (std::int32_t row = 0; row < pattern_.n; ++row) {
    auto& sorted = columns[row];
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    first_entry_.push_back(static_cast<std::int32_t>(pattern_.row.size()));
    diagonal_[row] = first_entry_.back();
    for (const std::int32_t column : sorted) {
      pattern_.row.push_back(row + 1);
      pattern_.column.push_back(column + 1);
    }
  }
  first_entry_.push_back(static_cast<std::int32_t>(pattern_.row.size()));

  held_.assign(pattern_.n, 0);
  rows_.resize(pattern_.n + tool_rows + 1);
  values_.resize(pattern_.row.size() + 3 * static_cast<std::size_t>(pattern_.n) + tool_diagonal +
                 tool_off_diagonal + 1);
  row_slots_.resize(batches_.size() * local_unknowns * lanes);
  entry_slots_.resize(batches_.size() * local_entries * lanes);
  for (std::size_t batch = 0; batch < batches_.size(); ++batch) fillSlots(batch);
}

std::optional<std::int32_t> System::expectedNegativePivots() const {
  if (parameters_.pressure == PressureSpace::p1) return std::nullopt;
  return pressures_;
}

bool System::isHeld(std::int32_t node) const {
  const std::int32_t unknown = unknown_of_[4 * node];
  return unknown >= 0 && held_[unknown];
}

std::int32_t System::rowSlot(std::int32_t node, int i) const {
  const std::int32_t unknown = unknown_of_[4 * node + i];
  if (unknown < 0) return pattern_.n + tool_rows;
  return i < 3 && isHeld(node) ? pattern_.n + i : unknown;
}

std::int32_t System::entrySlot(std::int32_t node_a, int i, std::int32_t node_b, int j) const {
  const auto coupling_begin = static_cast<std::int32_t>(pattern_.row.size());
  const std::int32_t tool_begin = coupling_begin + 3 * pattern_.n;
  const std::int32_t sink = tool_begin + tool_diagonal + tool_off_diagonal;
  const std::int32_t a = unknown_of_[4 * node_a + i], b = unknown_of_[4 * node_b + j];
  if (a < 0 || b < 0) return sink;
  const bool a_held = i < 3 && held_[a], b_held = j < 3 && held_[b];
  if (a_held && b_held) return a == b ? tool_begin + i : tool_begin + tool_diagonal + 3 * i + j;
  if (a_held) return coupling_begin + 3 * b + i;
  if (b_held) return coupling_begin + 3 * a + j;
  const std::int32_t row = std::min(a, b), column = std::max(a, b);
  const auto begin = pattern_.column.begin() + first_entry_[row],
             end = pattern_.column.begin() + first_entry_[row + 1];
  return static_cast<std::int32_t>(std::lower_bound(begin, end, column + 1) - pattern_.column.begin());
}

void System::fillSlots(std::size_t batch) {
  const BatchGeometry& geometry = batches_[batch];
  const std::size_t first_element = batch * lanes;
  for (int lane = 0; lane < lanes; ++lane) {
    const bool padding = first_element + lane >= problem_.mesh.tetrahedra.size();
    int entry = 0;
    for (int row = 0; row < local_unknowns; ++row) {
      const std::int32_t node_a = geometry.node[row / 4][lane];
      // Padding lanes go to the sink: their volume is zero, but a NaN times zero would not be.
      row_slots_[(batch * local_unknowns + row) * lanes + lane] =
          padding ? static_cast<std::int32_t>(rows_.size()) - 1 : rowSlot(node_a, row % 4);
      for (int column = row; column < local_unknowns; ++column, ++entry) {
        const std::int32_t node_b = geometry.node[column / 4][lane];
        entry_slots_[(batch * local_entries + entry) * lanes + lane] =
            padding ? static_cast<std::int32_t>(values_.size()) - 1
                    : entrySlot(node_a, row % 4, node_b, column % 4);
      }
    }
  }
}

void System::chooseTool(std::size_t space) {
  std::vector<std::int32_t> changed;
  const auto hold = [&](std::size_t which, std::uint8_t flag) {
    for (const std::int32_t node : problem_.active.at(which).nodes) {
      for (int i = 0; i < 3; ++i) held_[unknown_of_[4 * node + i]] = flag;
      changed.insert(changed.end(), batches_of_node_[node].begin(), batches_of_node_[node].end());
    }
  };
  hold(tool_, 0);
  hold(space, 1);
  tool_ = space;
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  for (const std::int32_t batch : changed) fillSlots(batch);
}

State System::restState() const {
  State state;
  state.u.assign(3 * problem_.mesh.nodes.size(), 0.0);
  state.q.assign(pressures_, 0.0);
  return state;
}

State System::moved(const State& state, const Eigen::VectorXd& step, double factor,
                    const Eigen::Vector3d& displacement) const {
  State next = state;
  for (std::size_t node = 0; node < problem_.mesh.nodes.size(); ++node) {
    if (unknown_of_[4 * node] >= 0)
      for (int i = 0; i < 3; ++i) next.u[3 * node + i] += factor * step[unknown_of_[4 * node + i]];
    if (pressures_ > 0) next.q[node] += factor * step[unknown_of_[4 * node + 3]];
  }
  for (const std::int32_t node : problem_.active[tool_].nodes)
    for (int i = 0; i < 3; ++i) next.u[3 * node + i] = displacement[i];
  return next;
}

void System::assemble(const State& state, Residual& residual) const {
  run<false>(state, residual, nullptr);
}

void System::assemble(const State& state, Residual& residual, Tangent& tangent) const {
  run<true>(state, residual, &tangent);
}

template <bool with_tangent>
void System::run(const State& state, Residual& residual, Tangent* tangent) const {
  std::fill(rows_.begin(), rows_.end(), 0.0);
  if constexpr (with_tangent) std::fill(values_.begin(), values_.end(), 0.0);
  residual.energy = 0;
  residual.min_det_F = std::numeric_limits<double>::infinity();
  residual.worst_element = -1;

  BatchResult result;
  BatchTangent local;
  const std::size_t elements = problem_.mesh.tetrahedra.size();
  for (std::size_t batch = 0; batch < batches_.size(); ++batch) {
    const BatchGeometry& geometry = batches_[batch];
    if constexpr (with_tangent) {
      kernels_.tangent(parameters_, geometry, state.u.data(), state.q.data(), result, local);
    } else {
      kernels_.residual(parameters_, geometry, state.u.data(), state.q.data(), result);
    }
    const int used = static_cast<int>(std::min<std::size_t>(lanes, elements - batch * lanes));
    for (int lane = 0; lane < used; ++lane) {
      residual.energy += result.energy[lane];
      // Written so that a NaN is kept as the worst.
      if (!(result.det_F[lane] >= residual.min_det_F) && !std::isnan(residual.min_det_F)) {
        residual.min_det_F = result.det_F[lane];
        residual.worst_element = static_cast<std::int32_t>(batch * lanes + lane);
      }
    }
    const std::int32_t* slot = &row_slots_[batch * local_unknowns * lanes];
    for (int row = 0; row < local_unknowns; ++row)
      for (int lane = 0; lane < lanes; ++lane) rows_[*slot++] += result.residual[row][lane];
    if constexpr (with_tangent) {
      const std::int32_t* entry_slot = &entry_slots_[batch * local_entries * lanes];
      for (int entry = 0; entry < local_entries; ++entry)
        for (int lane = 0; lane < lanes; ++lane) values_[*entry_slot++] += local.entry[entry][lane];
    }
  }

  residual.free = Eigen::Map<const Eigen::VectorXd>(rows_.data(), pattern_.n);
  residual.tool = Eigen::Map<const Eigen::Vector3d>(rows_.data() + pattern_.n);
  residual.norm = residual.free.norm();
  if constexpr (with_tangent) {
    const std::size_t entries = pattern_.row.size();
    tangent->values.assign(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(entries));
    for (std::int32_t unknown = 0; unknown < pattern_.n; ++unknown)
      // A positive pivot of the size of its neighbours.
      if (held_[unknown]) tangent->values[diagonal_[unknown]] = parameters_.mu * mean_edge_;
    tangent->tool_coupling = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
        values_.data() + entries, pattern_.n, 3);
    const double* tool = values_.data() + entries + 3 * static_cast<std::size_t>(pattern_.n);
    const Eigen::Matrix3d off_diagonal =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(tool + tool_diagonal);
    tangent->tool = off_diagonal + off_diagonal.transpose();
    tangent->tool.diagonal() += Eigen::Map<const Eigen::Vector3d>(tool);
  }
}

}  // namespace palpate
