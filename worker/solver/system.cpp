#include "worker/solver/system.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "worker/elements/shape_functions.hpp"

namespace palpate {
namespace {

/// The buffers of an assembly end with what belongs to the tool, then a sink for what belongs to
/// nobody.
constexpr std::int32_t tool_rows = 3;
constexpr std::int32_t tool_diagonal = 3;  ///< K_aa from diagonal local entries, one per direction
constexpr std::int32_t tool_off_diagonal =
    9;  ///< K_aa from local entries above the diagonal, to be added with its transpose

ElementParameters parametersOf(const Material& m, const Discretization& discretization) {
  ElementParameters p;
  p.displacement = discretization.displacement;
  p.pressure = isMixed(m) ? discretization.pressure : PressureSpace::none;
  p.constraint = discretization.constraint;
  if (p.pressure == PressureSpace::p1_stabilized) p.stabilization = 1 / shearModulus(m);
  p.bulk = m.bulk.value_or(0.0);
  p.law = m.law;
  p.mu = shearModulus(m);
  if (m.poisson) p.lambda = 2 * p.mu * *m.poisson / (1 - 2 * *m.poisson);
  p.c10 = m.c10;
  p.c01 = m.c01;
  p.c20 = m.c20;
  p.c30 = m.c30;
  p.c1 = m.c1;
  p.c2 = m.c2;
  p.k1 = m.k1;
  p.k2 = m.k2;
  p.dispersion = m.dispersion;
  p.ogden_terms = static_cast<int>(m.ogden.size());
  for (int term = 0; term < p.ogden_terms; ++term) {
    p.ogden_mu[term] = m.ogden[term].mu;
    p.ogden_alpha[term] = m.ogden[term].alpha;
  }
  return p;
}

/// All nodes of the displacement: the vertices, and of a quadratic mesh the middles of the edges.
std::vector<std::int32_t> nodesOf(const Mesh& mesh, std::int32_t element) {
  std::vector<std::int32_t> nodes(mesh.tetrahedra[element].begin(), mesh.tetrahedra[element].end());
  if (!mesh.mid_edge_nodes.empty())
    nodes.insert(nodes.end(), mesh.mid_edge_nodes[element].begin(),
                 mesh.mid_edge_nodes[element].end());
  return nodes;
}

/// Gradients of the barycentric coordinates of the first three vertices, columns, 1/m.
Eigen::Matrix3d gradientsOf(const Mesh& mesh, std::int32_t element) {
  const Tetrahedron& tetrahedron = mesh.tetrahedra[element];
  Eigen::Matrix3d edges;
  for (int b = 0; b < 3; ++b)
    edges.row(b) = mesh.nodes[tetrahedron[b]] - mesh.nodes[tetrahedron[3]];
  return edges.inverse();
}

}  // namespace

System::System(BodyModel model, const ElementKernels& kernels)
    : model_(std::move(model)), kernels_(kernels), mean_edge_(measure(model_.mesh).mean_edge) {
  prepareMaterials();
  numberUnknowns();
  buildBatches();
  buildPattern();
  buildScatter();
  for (std::size_t n = 0; n < model_.load.size(); n += 3)
    total_load_ += Eigen::Map<const Eigen::Vector3d>(&model_.load[n]).norm();
  if (!model_.tools.empty()) chooseTool(0);
}

void System::prepareMaterials() {
  shear_modulus_ = std::numeric_limits<double>::infinity();
  for (const Material& material : model_.materials) {
    parameters_.push_back(parametersOf(material, model_.discretization));
    shear_modulus_ = std::min(shear_modulus_, shearModulus(material));
  }
  for (ElementParameters& parameters : parameters_) parameters.pressure_scale = pressureScale();
}

void System::numberUnknowns() {
  const Mesh& mesh = model_.mesh;
  std::vector<std::uint8_t> has_pressure(mesh.nodes.size(), 0);
  for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
    const std::vector<std::int32_t> nodes = nodesOf(mesh, static_cast<std::int32_t>(element));
    const PressureSpace pressure = parameters_[model_.region_of[element]].pressure;
    // Where nothing can move the constraint says nothing; only a stabilisation would give the
    // pressure a row.
    if (pressure != PressureSpace::p1_stabilized && isFixed(nodes)) continue;
    for (int b = 0; b < pressureNodes(pressure); ++b) has_pressure[nodes[b]] = 1;
  }
  unknown_of_.assign(4 * mesh.nodes.size(), -1);
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    for (int i = 0; i < 3; ++i)
      if (!model_.fixed[3 * node + i]) unknown_of_[4 * node + i] = pattern_.n++;
    if (has_pressure[node]) {
      unknown_of_[4 * node + 3] = pattern_.n++;
      ++pressures_;
    }
  }
  rest_.u.assign(3 * mesh.nodes.size(), 0.0);
  switch (model_.discretization.pressure) {
    case PressureSpace::none:
      break;
    case PressureSpace::p1:
    case PressureSpace::p1_stabilized:
      rest_.q.assign(mesh.vertices(), 0.0);
      break;
    case PressureSpace::p2:
      rest_.q.assign(mesh.nodes.size(), 0.0);
      break;
  }
}

bool System::isFixed(const std::vector<std::int32_t>& nodes) const {
  return std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t node) {
    const std::uint8_t* fixed = &model_.fixed[3 * static_cast<std::size_t>(node)];
    return fixed[0] && fixed[1] && fixed[2];
  });
}

void System::buildBatches() {
  std::vector<std::vector<std::int32_t>> elements_of(model_.materials.size());
  for (std::size_t element = 0; element < model_.mesh.tetrahedra.size(); ++element)
    elements_of.at(model_.region_of[element]).push_back(static_cast<std::int32_t>(element));
  batches_of_node_.resize(model_.mesh.nodes.size());
  for (const std::vector<std::int32_t>& elements : elements_of)
    for (std::size_t first = 0; first < elements.size(); first += lanes) addBatch(elements, first);
}

void System::addBatch(const std::vector<std::int32_t>& elements, std::size_t first) {
  const Mesh& mesh = model_.mesh;
  Batch batch{};
  batch.material = model_.region_of[elements[first]];
  for (int lane = 0; lane < lanes; ++lane) {
    const bool used = first + lane < elements.size();
    const std::int32_t element = used ? elements[first + lane] : elements.back();
    batch.element[lane] = used ? element : -1;
    batch.geometry.volume[lane] = used ? sixVolume(mesh, element) / 6 : 0.0;
    const Eigen::Matrix3d gradients = gradientsOf(mesh, element);
    for (int b = 0; b < 3; ++b)
      for (int I = 0; I < 3; ++I) batch.geometry.gradient[b][I][lane] = gradients(I, b);
    if (!model_.fibers.empty())
      for (int family = 0; family < 2; ++family)
        for (int I = 0; I < 3; ++I)
          batch.geometry.fiber[family][I][lane] = model_.fibers[element][family][I];
    const std::vector<std::int32_t> nodes = nodesOf(mesh, element);
    for (std::size_t a = 0; a < nodes.size(); ++a) {
      batch.geometry.node[a][lane] = nodes[a];
      auto& touching = batches_of_node_[nodes[a]];
      const auto number = static_cast<std::int32_t>(batches_.size());
      if (touching.empty() || touching.back() != number) touching.push_back(number);
    }
  }
  batches_.push_back(batch);
}

std::int32_t System::localUnknowns(const Batch& batch) const {
  const ElementParameters& parameters = parameters_[batch.material];
  return 3 * displacementNodes(parameters.displacement) + pressureNodes(parameters.pressure);
}

System::Place System::placeOf(const Batch& batch, int local_unknown, int lane) const {
  const int first_pressure = 3 * displacementNodes(model_.discretization.displacement);
  if (local_unknown < first_pressure)
    return {batch.geometry.node[local_unknown / 3][lane], local_unknown % 3};
  return {batch.geometry.node[local_unknown - first_pressure][lane], 3};
}

void System::buildPattern() {
  std::vector<std::vector<std::int32_t>> columns(pattern_.n);
  for (const Batch& batch : batches_)
    for (int lane = 0; lane < lanes; ++lane) {
      const int local = localUnknowns(batch);
      for (int row = 0; row < local; ++row)
        for (int column = row; column < local; ++column) {
          const std::int32_t a = unknownOf(placeOf(batch, row, lane));
          const std::int32_t b = unknownOf(placeOf(batch, column, lane));
          if (a >= 0 && b >= 0) columns[std::min(a, b)].push_back(std::max(a, b));
        }
    }
  for (std::int32_t row = 0; row < pattern_.n; ++row) {
    auto& sorted = columns[row];
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    first_entry_.push_back(static_cast<std::int32_t>(pattern_.row.size()));
    for (const std::int32_t column : sorted) {
      pattern_.row.push_back(row + 1);
      pattern_.column.push_back(column + 1);
    }
  }
  first_entry_.push_back(static_cast<std::int32_t>(pattern_.row.size()));
}

void System::buildScatter() {
  held_.assign(pattern_.n, 0);
  border_.resize(pattern_.n, 0);
  rows_.resize(pattern_.n + tool_rows + 1);
  values_.resize(pattern_.row.size() + 3 * static_cast<std::size_t>(pattern_.n) + tool_diagonal +
                 tool_off_diagonal + 1);
  std::size_t rows = 0, entries = 0;
  for (Batch& batch : batches_) {
    batch.first_row = rows;
    batch.first_entry = entries;
    rows += static_cast<std::size_t>(localUnknowns(batch)) * lanes;
    entries += static_cast<std::size_t>(localEntries(localUnknowns(batch))) * lanes;
  }
  row_slots_.resize(rows);
  entry_slots_.resize(entries);
  for (const Batch& batch : batches_) fillSlots(batch);
}

std::optional<std::int32_t> System::expectedNegativePivots() const {
  if (!isInfSupStable(model_.discretization)) return std::nullopt;
  return pressures_;
}

std::int32_t System::rowSlot(const Place& place) const {
  const std::int32_t unknown = unknownOf(place);
  if (unknown < 0) return pattern_.n + tool_rows;
  return held_[unknown] ? pattern_.n + place.component : unknown;
}

std::int32_t System::entrySlot(const Place& place_a, const Place& place_b) const {
  const auto coupling_begin = static_cast<std::int32_t>(pattern_.row.size());
  const std::int32_t tool_begin = coupling_begin + 3 * pattern_.n;
  const std::int32_t sink = tool_begin + tool_diagonal + tool_off_diagonal;
  const std::int32_t a = unknownOf(place_a), b = unknownOf(place_b);
  const int i = place_a.component, j = place_b.component;
  if (a < 0 || b < 0) return sink;
  if (held_[a] && held_[b]) return a == b ? tool_begin + i : tool_begin + tool_diagonal + 3 * i + j;
  if (held_[a]) return coupling_begin + 3 * b + i;
  if (held_[b]) return coupling_begin + 3 * a + j;
  const std::int32_t row = std::min(a, b), column = std::max(a, b);
  const auto begin = pattern_.column.begin() + first_entry_[row],
             end = pattern_.column.begin() + first_entry_[row + 1];
  return static_cast<std::int32_t>(std::lower_bound(begin, end, column + 1) -
                                   pattern_.column.begin());
}

void System::fillSlots(const Batch& batch) {
  const int local = localUnknowns(batch);
  for (int lane = 0; lane < lanes; ++lane) {
    // Left-over lanes go to the sink: their volume is zero, but a NaN times zero would not be.
    const bool left_over = batch.element[lane] < 0;
    std::size_t entry = batch.first_entry + lane;
    for (int row = 0; row < local; ++row) {
      const Place a = placeOf(batch, row, lane);
      row_slots_[batch.first_row + row * lanes + lane] =
          left_over ? static_cast<std::int32_t>(rows_.size()) - 1 : rowSlot(a);
      for (int column = row; column < local; ++column, entry += lanes)
        entry_slots_[entry] = left_over ? static_cast<std::int32_t>(values_.size()) - 1
                                        : entrySlot(a, placeOf(batch, column, lane));
    }
  }
}

const Tool* System::rigidTool() const {
  return tool_ && model_.tools[*tool_].weights.empty() ? &model_.tools[*tool_] : nullptr;
}

const Tool* System::weightedTool() const {
  return tool_ && !model_.tools[*tool_].weights.empty() ? &model_.tools[*tool_] : nullptr;
}

void System::hold(const Tool& tool, std::uint8_t flag) {
  std::vector<std::int32_t> changed;
  for (const std::int32_t node : tool.nodes) {
    for (int i = 0; i < 3; ++i) held_[unknownOf({node, i})] = flag;
    changed.insert(changed.end(), batches_of_node_[node].begin(), batches_of_node_[node].end());
  }
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  for (const std::int32_t batch : changed) fillSlots(batches_[batch]);
}

void System::releaseTool() {
  if (const Tool* rigid = rigidTool()) hold(*rigid, 0);
  border_.resize(pattern_.n, 0);
  tool_.reset();
}

void System::chooseTool(std::size_t tool) {
  releaseTool();
  tool_ = tool;
  if (const Tool* rigid = rigidTool()) hold(*rigid, 1);
  if (const Tool* weighted = weightedTool()) {
    border_.setZero(pattern_.n, 3);
    for (std::size_t n = 0; n < weighted->nodes.size(); ++n)
      for (int i = 0; i < 3; ++i)
        border_(unknownOf({weighted->nodes[n], i}), i) = -weighted->weights[n];
  }
}

void System::setRest(const State& rest) {
  rest_ = rest;
  rest_.displacement.setZero();
  rest_.multiplier.setZero();
  energy_at_rest_ = 0;
  Residual residual;
  assemble(rest_, residual);
  energy_at_rest_ = residual.energy;
}

State System::moved(const State& state, const Eigen::VectorXd& step, double factor,
                    const Eigen::Vector3d& displacement) const {
  State next = state;
  for (std::size_t node = 0; node < model_.mesh.nodes.size(); ++node) {
    const std::int32_t* unknown = &unknown_of_[4 * node];
    for (int i = 0; i < 3; ++i)
      if (unknown[i] >= 0) next.u[3 * node + i] += factor * step[unknown[i]];
    if (unknown[3] >= 0) next.q[node] += factor * step[unknown[3]];
  }
  next.displacement = displacement;
  if (const Tool* rigid = rigidTool())
    for (const std::int32_t node : rigid->nodes)
      for (int i = 0; i < 3; ++i) next.u[3 * node + i] = rest_.u[3 * node + i] + displacement[i];
  if (weightedTool()) next.multiplier += factor * step.tail<3>();
  return next;
}

void System::assemble(const State& state, Residual& residual) const {
  run<false>(state, residual, nullptr);
}

void System::assemble(const State& state, Residual& residual, Tangent& tangent) const {
  run<true>(state, residual, &tangent);
}

/// Rows and energy of the loads.
void System::startRows(const State& state, Residual& residual) const {
  std::fill(rows_.begin(), rows_.end(), 0.0);
  residual.energy = 0;
  if (model_.load.empty()) return;
  for (std::size_t node = 0; node < model_.mesh.nodes.size(); ++node)
    for (int i = 0; i < 3; ++i) {
      const double load = load_factor_ * model_.load[3 * node + i];
      rows_[rowSlot({static_cast<std::int32_t>(node), i})] -= load;
      residual.energy -= load * state.u[3 * node + i];
    }
}

template <bool with_tangent>
void System::accumulate(const Batch& batch, const State& state, Residual& residual) const {
  BatchResult result;
  BatchTangent local;
  const ElementParameters& parameters = parameters_[batch.material];
  if constexpr (with_tangent) {
    kernels_.tangent(parameters, batch.geometry, state.u.data(), state.q.data(), result, local);
  } else {
    kernels_.residual(parameters, batch.geometry, state.u.data(), state.q.data(), result);
  }
  for (int lane = 0; lane < lanes && batch.element[lane] >= 0; ++lane) {
    residual.energy += result.energy[lane];
    // Written so that a NaN is kept as the worst.
    if (!(result.det_F[lane] >= residual.min_det_F) && !std::isnan(residual.min_det_F)) {
      residual.min_det_F = result.det_F[lane];
      residual.worst_element = batch.element[lane];
    }
  }
  const int unknowns = localUnknowns(batch);
  const std::int32_t* slot = &row_slots_[batch.first_row];
  for (int row = 0; row < unknowns; ++row)
    for (int lane = 0; lane < lanes; ++lane) rows_[*slot++] += result.residual[row][lane];
  if constexpr (with_tangent) {
    const int entries = localEntries(unknowns);
    const std::int32_t* entry_slot = &entry_slots_[batch.first_entry];
    for (int entry = 0; entry < entries; ++entry)
      for (int lane = 0; lane < lanes; ++lane) values_[*entry_slot++] += local.entry[entry][lane];
  }
}

template <bool with_tangent>
void System::run(const State& state, Residual& residual, Tangent* tangent) const {
  startRows(state, residual);
  if constexpr (with_tangent) std::fill(values_.begin(), values_.end(), 0.0);
  residual.min_det_F = std::numeric_limits<double>::infinity();
  residual.worst_element = -1;

  for (const Batch& batch : batches_) accumulate<with_tangent>(batch, state, residual);
  finishResidual(state, residual);
  if constexpr (with_tangent) finishTangent(*tangent);
}

Neighborhood System::neighborhood(std::size_t count) const {
  const Mesh& mesh = model_.mesh;
  std::vector<std::pair<double, std::int32_t>> nearest;
  const std::vector<std::int32_t>& patch = model_.tools.at(tool_.value()).nodes;
  for (std::int32_t node = 0; node < static_cast<std::int32_t>(mesh.nodes.size()); ++node) {
    double distance = std::numeric_limits<double>::infinity();
    for (const std::int32_t held : patch)
      distance = std::min(distance, (mesh.nodes[node] - mesh.nodes[held]).squaredNorm());
    if (distance > 0) nearest.emplace_back(distance, node);
  }
  count = std::min(count, nearest.size());
  std::partial_sort(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(count),
                    nearest.end());

  Neighborhood near;
  for (std::size_t n = 0; n < count; ++n) {
    const std::int32_t node = nearest[n].second;
    for (int component = 0; component < 4; ++component)
      if (const std::int32_t unknown = unknownOf({node, component}); unknown >= 0)
        near.unknowns.push_back(unknown);
    near.batches.insert(near.batches.end(), batches_of_node_[node].begin(),
                        batches_of_node_[node].end());
  }
  for (std::vector<std::int32_t>* numbers : {&near.unknowns, &near.batches}) {
    std::sort(numbers->begin(), numbers->end());
    numbers->erase(std::unique(numbers->begin(), numbers->end()), numbers->end());
  }
  for (std::int32_t row = 0; row < static_cast<std::int32_t>(near.unknowns.size()); ++row) {
    std::int32_t column = row;
    for (std::int32_t slot = first_entry_[near.unknowns[row]];
         slot < first_entry_[near.unknowns[row] + 1]; ++slot) {
      const std::int32_t unknown = pattern_.column[slot] - 1;
      while (column < static_cast<std::int32_t>(near.unknowns.size()) &&
             near.unknowns[column] < unknown)
        ++column;
      if (column < static_cast<std::int32_t>(near.unknowns.size()) &&
          near.unknowns[column] == unknown)
        near.entries.push_back({slot, row, column});
    }
  }
  return near;
}

void System::assemble(const State& state, const Neighborhood& near, Eigen::VectorXd& residual,
                      Eigen::MatrixXd& tangent) const {
  Residual ignored;
  startRows(state, ignored);
  std::fill(values_.begin(), values_.end(), 0.0);
  for (const std::int32_t batch : near.batches) accumulate<true>(batches_[batch], state, ignored);
  const auto size = static_cast<Eigen::Index>(near.unknowns.size());
  residual.resize(size);
  for (Eigen::Index n = 0; n < size; ++n) residual[n] = rows_[near.unknowns[n]];
  tangent.setZero(size, size);
  for (const Neighborhood::Entry& entry : near.entries)
    tangent(entry.row, entry.column) = tangent(entry.column, entry.row) = values_[entry.slot];
}

void System::finishResidual(const State& state, Residual& residual) const {
  residual.energy -= energy_at_rest_;
  residual.free.resize(pattern_.n + multipliers());
  auto forces = residual.free.head(pattern_.n);
  forces = Eigen::Map<const Eigen::VectorXd>(rows_.data(), pattern_.n);
  residual.tool = Eigen::Map<const Eigen::Vector3d>(rows_.data() + pattern_.n);
  double scaled_gap = 0;
  if (const Tool* weighted = weightedTool()) {
    Eigen::Vector3d gap = state.displacement;
    for (std::size_t n = 0; n < weighted->nodes.size(); ++n)
      for (int i = 0; i < 3; ++i) {
        const std::size_t component = 3 * static_cast<std::size_t>(weighted->nodes[n]) + i;
        gap[i] -= weighted->weights[n] * (state.u[component] - rest_.u[component]);
      }
    forces += border_ * state.multiplier;
    residual.free.tail<3>() = gap;
    residual.energy += state.multiplier.dot(gap);
    residual.tool = state.multiplier;
    scaled_gap = forceScale() / mean_edge_ * gap.norm();
  }
  residual.norm = std::hypot(forces.norm(), scaled_gap);
}

void System::finishTangent(Tangent& tangent) const {
  const std::size_t entries = pattern_.row.size();
  tangent.values.assign(values_.begin(), values_.begin() + static_cast<std::ptrdiff_t>(entries));
  for (std::int32_t unknown = 0; unknown < pattern_.n; ++unknown)
    // A positive pivot of the size of its neighbours.
    if (held_[unknown]) tangent.values[first_entry_[unknown]] = shear_modulus_ * mean_edge_;
  tangent.border = border_;
  tangent.tool_coupling.resize(pattern_.n + multipliers(), 3);
  tangent.tool_coupling.topRows(pattern_.n) =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
          values_.data() + entries, pattern_.n, 3);
  if (weightedTool()) tangent.tool_coupling.bottomRows<3>().setIdentity();
  const double* tool = values_.data() + entries + 3 * static_cast<std::size_t>(pattern_.n);
  const Eigen::Matrix3d off_diagonal =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(tool + tool_diagonal);
  tangent.tool = off_diagonal + off_diagonal.transpose();
  tangent.tool.diagonal() += Eigen::Map<const Eigen::Vector3d>(tool);
}

void System::lookAtNodes(const State& state, Residual& residual) const {
  using kernels_default::P2;
  if (model_.discretization.displacement != DisplacementSpace::p2) return;
  const Mesh& mesh = model_.mesh;
  for (std::int32_t element = 0; element < static_cast<std::int32_t>(mesh.tetrahedra.size());
       ++element) {
    const std::vector<std::int32_t> nodes = nodesOf(mesh, element);
    Eigen::Matrix<double, 3, 4> gradients;  // of the barycentric coordinates
    gradients.leftCols<3>() = gradientsOf(mesh, element);
    gradients.col(3) = -gradients.leftCols<3>().rowwise().sum();
    for (const auto& [first, second] : P2::end) {
      double x[4] = {};
      x[first] += 0.5;
      x[second] += 0.5;
      Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
      for (int a = 0; a < P2::nodes; ++a) {
        const Eigen::Map<const Eigen::Vector3d> u(&state.u[3 * static_cast<std::size_t>(nodes[a])]);
        for (int e = 0; e < P2::ends; ++e)
          F += P2::slope(a, e, x) * u * gradients.col(P2::end[a][e]).transpose();
      }
      if (const double det_F = F.determinant(); det_F < residual.min_det_F) {
        residual.min_det_F = det_F;
        residual.worst_element = element;
      }
    }
  }
}

}  // namespace palpate
