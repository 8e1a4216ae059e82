#include "worker/solver/system.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

State undeformed(const BodyModel& model, const PressureSlots& pressures) {
  return {.u = std::vector<double>(3 * model.mesh.nodes.size()),
          .q = std::vector<double>(pressures.count())};
}

BodyModel checked(BodyModel model) {
  const Mesh& mesh = model.mesh;
  PALPATE_ASSERT(!model.materials.empty(), "a body needs a material");
  PALPATE_ASSERT(model.region_of.size() == mesh.tetrahedra.size(), "each element needs a material");
  PALPATE_ASSERT(model.fixed.size() == 3 * mesh.nodes.size(),
                 "each displacement must be fixed or free");
  PALPATE_ASSERT(model.load.empty() || model.load.size() == model.fixed.size(),
                 "each displacement needs a load, or none has one");
  PALPATE_ASSERT(model.fibers.empty() || model.fibers.size() == mesh.tetrahedra.size(),
                 "each element needs fibres, or none has them");
  PALPATE_ASSERT(
      mesh.mid_edge_nodes.empty() == (model.discretization.displacement == DisplacementSpace::p1),
      "only meshes with P2 displacement can have mid-edge nodes");
  return model;
}

}  // namespace

System::System(BodyModel model, const ElementKernels& kernels)
    : model_(checked(std::move(model))),
      kernels_(kernels),
      mean_edge_(measure(model_.mesh).mean_edge),
      shear_modulus_(shearModulus(*std::ranges::min_element(model_.materials, {}, shearModulus))),
      parameters_(elementParameters(model_, pressureScale())),
      pressures_(pressureSlots(model_)),
      unknowns_(model_, pressures_),
      batches_(model_, pressures_),
      pattern_(patternOf(unknowns_, batches_)),
      sums_(unknowns_, pattern_, batches_),
      rest_(undeformed(model_, pressures_)) {
  border_.resize(unknowns(), 0);
  for (std::size_t node = 0; 3 * node < model_.load.size(); ++node)
    total_load_ += ofNode(model_.load, node).norm();
  if (!model_.tools.empty()) chooseTool(0);
}

std::optional<std::int32_t> System::expectedNegativePivots() const {
  if (!isInfSupStable(model_.discretization)) return std::nullopt;
  return unknowns_.pressures() - static_cast<std::int32_t>(idle_.size()) + multipliers();
}

const Tool* System::rigidTool() const {
  return tool_ && tool_->weights.empty() ? &*tool_ : nullptr;
}

const Tool* System::weightedTool() const {
  return tool_ && !tool_->weights.empty() ? &*tool_ : nullptr;
}

void System::releaseTool() {
  hold_.reset();
  clearTool();
}

void System::clearTool() {
  if (const Tool* rigid = rigidTool()) sums_.hold(rigid->nodes, idle_, false);
  idle_.clear();
  border_.resize(unknowns(), 0);
  tool_.reset();
}

void System::hold(std::optional<Tool> tool) {
  PALPATE_ASSERT(!tool || weightedTool(), "only beside a weighted tool can another one hold");
  hold_ = std::move(tool);
  setBorder();
}

/// Sets the border of the hold and the chosen tool.
void System::setBorder() {
  border_.setZero(unknowns(), (hold_ ? 3 : 0) + (weightedTool() ? 3 : 0));
  const auto add = [&](const Tool& tool, Eigen::Index column) {
    for (std::size_t n = 0; n < tool.nodes.size(); ++n)
      for (int i = 0; i < 3; ++i)
        border_(unknowns_.at({tool.nodes[n], i}), column + i) = -tool.weights[n];
  };
  if (hold_) add(*hold_, 0);
  if (const Tool* weighted = weightedTool()) add(*weighted, border_.cols() - 3);
}

void System::chooseTool(Tool tool) {
  PALPATE_ASSERT(tool.weights.empty() || tool.weights.size() == tool.nodes.size(),
                 "a weighted tool needs a weight for each of its nodes");
  PALPATE_ASSERT(!hold_ || !tool.weights.empty(), "a rigid tool cannot move a held body");
  clearTool();
  tool_ = std::move(tool);
  if (const Tool* rigid = rigidTool()) {
    idle_ = idlePressures(model_, pressures_, rigid->nodes);
    std::erase_if(idle_, [&](std::int32_t slot) {
      return unknowns_.at({slot, pressure_component}) < 0;
    });
    sums_.hold(rigid->nodes, idle_, true);
  }
  if (weightedTool()) setBorder();
}

void System::setRest(const State& rest) {
  rest_ = rest;
  rest_.displacement.setZero();
  rest_.multiplier.setZero();
  rest_.held_displacement.setZero();
  rest_.held_multiplier.setZero();
  energy_at_rest_ = 0;
  Residual residual;
  assemble(rest_, residual);
  energy_at_rest_ = residual.energy;
}

State System::moved(const State& state, const Eigen::VectorXd& step, double factor,
                    const Eigen::Vector3d& displacement) const {
  State next = state;
  for (std::int32_t node = 0; at(node) < model_.mesh.nodes.size(); ++node)
    for (int i = 0; i < 3; ++i)
      if (const std::int32_t unknown = unknowns_.at({node, i}); unknown >= 0)
        ofNode(next.u, node)[i] += factor * step[unknown];
  for (std::int32_t slot = 0; at(slot) < next.q.size(); ++slot)
    if (const std::int32_t pressure = unknowns_.at({slot, pressure_component});
        pressure >= 0 && !sums_.isHeld(pressure))
      next.q[slot] += factor * step[pressure];
  next.displacement = displacement;
  // The nodes of a rigid tool are set from the rest state and not moved by a step, so that their
  // positions are exact to the last bit.
  if (const Tool* rigid = rigidTool())
    for (const std::int32_t node : rigid->nodes)
      ofNode(next.u, node) = ofNode(rest_.u, node) + displacement;
  if (weightedTool()) next.multiplier += factor * step.tail<3>();
  if (hold_) next.held_multiplier += factor * step.segment<3>(unknowns());
  return next;
}

Eigen::VectorXd System::displacementsOf(const Eigen::VectorXd& unknowns) const {
  std::vector<std::int32_t> rows;
  for (std::int32_t node = 0; at(node) < model_.mesh.nodes.size(); ++node)
    for (int i = 0; i < 3; ++i)
      if (const std::int32_t unknown = unknowns_.at({node, i}); unknown >= 0)
        rows.push_back(unknown);
  return unknowns(rows);
}

void System::addLoads(const State& state, Residual& residual) const {
  if (model_.load.empty()) return;
  for (std::int32_t node = 0; at(node) < model_.mesh.nodes.size(); ++node)
    for (int i = 0; i < 3; ++i) {
      const double load = load_factor_ * ofNode(model_.load, node)[i];
      sums_.add({node, i}, -load);
      residual.energy -= load * ofNode(state.u, node)[i];
    }
}

void System::accumulate(std::int32_t number, const State& state, Residual& residual,
                        bool with_tangent) const {
  const ElementBatch& batch = batches_.all[number];
  const ElementParameters& parameters = parameters_[batch.material];
  BatchResult result;
  BatchTangent tangent;
  kernels_.evaluate(parameters, batch.geometry, state.u.data(), state.q.data(), result,
                    with_tangent ? &tangent : nullptr);
  if (with_tangent) sums_.add(number, tangent);
  sums_.add(number, result);
  for (int lane = 0; lane < lanes && batch.element[lane] >= 0; ++lane) {
    residual.energy += result.energy[lane];
    // A NaN replaces any number here, and no number replaces a NaN.
    if (!(result.det_F[lane] >= residual.min_det_F) && !std::isnan(residual.min_det_F)) {
      residual.min_det_F = result.det_F[lane];
      residual.worst_element = batch.element[lane];
    }
  }
}

void System::run(const State& state, Residual& residual, Tangent* tangent) const {
  PALPATE_ASSERT(state.u.size() == rest_.u.size() && state.q.size() == rest_.q.size(),
                 "the state must be of this body");
  // Callers pass the same Residual for many states, so it may hold old values.
  residual.energy = 0;
  residual.min_det_F = std::numeric_limits<double>::infinity();
  residual.worst_element = -1;
  sums_.clearRows();
  if (tangent) sums_.clearEntries();
  addLoads(state, residual);
  for (std::int32_t batch = 0; at(batch) < batches_.all.size(); ++batch)
    accumulate(batch, state, residual, tangent != nullptr);
  finishResidual(state, residual);
  if (tangent) finishTangent(*tangent);
}

void System::assemble(const State& state, const Neighborhood& near, Eigen::VectorXd& residual,
                      Eigen::MatrixXd& tangent) const {
  Residual ignored;
  sums_.clearRows();
  sums_.clearEntries();
  addLoads(state, ignored);
  for (const std::int32_t batch : near.batches) accumulate(batch, state, ignored, true);
  const auto size = static_cast<Eigen::Index>(near.unknowns.size());
  residual = sums_.rows()(near.unknowns);
  tangent.setZero(size, size);
  for (const Neighborhood::Entry& entry : near.entries)
    tangent(entry.row, entry.column) = tangent(entry.column, entry.row) = sums_.entry(entry.number);
}

/// Returns p - B (u - u_rest) of a weighted tool, metres.
Eigen::Vector3d System::gapOf(const Tool& tool, const State& state,
                              const Eigen::Vector3d& p) const {
  Eigen::Vector3d gap = p;
  for (std::size_t n = 0; n < tool.nodes.size(); ++n)
    gap -= tool.weights[n] * (ofNode(state.u, tool.nodes[n]) - ofNode(rest_.u, tool.nodes[n]));
  return gap;
}

void System::finishResidual(const State& state, Residual& residual) const {
  residual.energy -= energy_at_rest_;
  residual.free.resize(unknowns() + multipliers());
  auto forces = residual.free.head(unknowns());
  forces = sums_.rows();
  residual.tool = sums_.toolRows();
  double scaled_gap = 0;
  if (const Tool* weighted = weightedTool()) {
    const Eigen::Vector3d gap = gapOf(*weighted, state, state.displacement);
    forces += border_.rightCols<3>() * state.multiplier;
    residual.free.tail<3>() = gap;
    residual.energy += state.multiplier.dot(gap);
    residual.tool = state.multiplier;
    scaled_gap = forceScale() / mean_edge_ * gap.norm();
  }
  if (hold_) {
    const Eigen::Vector3d gap = gapOf(*hold_, state, state.held_displacement);
    forces += border_.leftCols<3>() * state.held_multiplier;
    residual.free.segment<3>(unknowns()) = gap;
    residual.energy += state.held_multiplier.dot(gap);
    scaled_gap = std::hypot(scaled_gap, forceScale() / mean_edge_ * gap.norm());
  }
  residual.norm = std::hypot(forces.norm(), scaled_gap);
}

void System::finishTangent(Tangent& tangent) const {
  tangent.values = sums_.entries();
  for (std::int32_t unknown = 0; unknown < unknowns(); ++unknown)
    // A held unknown gets a positive diagonal entry of the size of the others.
    if (sums_.isHeld(unknown))
      tangent.values[pattern_.row_begin[unknown]] = shear_modulus_ * mean_edge_;
  tangent.border = border_;
  tangent.tool_coupling.resize(unknowns() + multipliers(), 3);
  tangent.tool_coupling.topRows(unknowns()) = sums_.toolCoupling();
  if (hold_) tangent.tool_coupling.middleRows<3>(unknowns()).setZero();
  if (weightedTool()) tangent.tool_coupling.bottomRows<3>().setIdentity();
  tangent.tool = sums_.toolEntries();
}

}  // namespace palpate
