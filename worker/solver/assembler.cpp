#include "worker/solver/assembler.hpp"

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/mesh/node_set.hpp"

namespace palpate {
namespace {

// rows_ and entries_ end with the sums of the tool, and then one number, the sink, to which all
// dropped rows or entries are added.
constexpr std::int32_t tool_rows = 3;
/// Number of sums for the diagonal entries of elements in K_aa, the tangent of the tool: one sum
/// per direction.
constexpr std::int32_t tool_diagonal = 3;
/// Number of sums for the rest of K_aa: entries of elements above the diagonal, to be added
/// together with their transpose.
constexpr std::int32_t tool_off_diagonal = 9;

}  // namespace

SparsityPattern patternOf(const DofMap& unknowns, const ElementBatches& batches) {
  std::vector<std::vector<std::int32_t>> columns(unknowns.count());
  for (const ElementBatch& batch : batches.all)
    for (int lane = 0; lane < lanes; ++lane)
      for (int row = 0; row < batch.unknowns; ++row)
        for (int column = row; column < batch.unknowns; ++column) {
          const std::int32_t a = unknowns.at(batch.dofOf(row, lane));
          const std::int32_t b = unknowns.at(batch.dofOf(column, lane));
          if (a >= 0 && b >= 0) columns[std::min(a, b)].push_back(std::max(a, b));
        }
  return patternOf(std::move(columns));
}

Assembler::Assembler(const DofMap& unknowns, const SparsityPattern& pattern,
                     const ElementBatches& batches)
    : unknowns_(unknowns),
      pattern_(pattern),
      batches_(batches),
      held_(unknowns.count(), 0),
      rows_(unknowns.count() + tool_rows + 1),
      entries_(pattern.row.size() + 3 * static_cast<std::size_t>(unknowns.count()) + tool_diagonal +
               tool_off_diagonal + 1) {
  PALPATE_ASSERT(pattern.n == unknowns.count(), "the matrix must have a row for every unknown");
  int most = 0;
  for (const ElementBatch& batch : batches.all) most = std::max(most, batch.unknowns);
  row_stride_ = static_cast<std::size_t>(most) * lanes;
  entry_stride_ = static_cast<std::size_t>(localEntries(most)) * lanes;
  row_slots_.resize(batches.all.size() * row_stride_);
  entry_slots_.resize(batches.all.size() * entry_stride_);
  for (std::int32_t batch = 0; at(batch) < batches.all.size(); ++batch) findSlots(batch);
}

std::int32_t Assembler::rowSlot(const Dof& place) const {
  const std::int32_t unknown = unknowns_.at(place);
  if (unknown < 0) return unknowns_.count() + tool_rows;
  if (!held_[unknown]) return unknown;
  return unknowns_.count() + (place.component == pressure_component ? tool_rows : place.component);
}

std::int32_t Assembler::entrySlot(const Dof& place_a, const Dof& place_b) const {
  const auto coupling_begin = static_cast<std::int32_t>(pattern_.row.size());
  const std::int32_t tool_begin = coupling_begin + 3 * unknowns_.count();
  const std::int32_t sink = tool_begin + tool_diagonal + tool_off_diagonal;
  const std::int32_t a = unknowns_.at(place_a), b = unknowns_.at(place_b);
  const int i = place_a.component, j = place_b.component;
  if (a < 0 || b < 0) return sink;
  // All elements around an idle pressure move as a rigid body. Their volume does not change, so
  // these entries are zero and are dropped.
  if ((held_[a] && i == pressure_component) || (held_[b] && j == pressure_component)) return sink;
  if (held_[a] && held_[b]) return a == b ? tool_begin + i : tool_begin + tool_diagonal + 3 * i + j;
  if (held_[a]) return coupling_begin + 3 * b + i;
  if (held_[b]) return coupling_begin + 3 * a + j;
  return pattern_.entryOf(a, b);
}

void Assembler::findSlots(std::int32_t number) {
  const ElementBatch& batch = batches_.all[number];
  std::int32_t* row_slot = row_slots_.data() + number * row_stride_;
  std::int32_t* entry_slot = entry_slots_.data() + number * entry_stride_;
  // Unused lanes are added to the sink. Their volume is zero, but zero times a NaN is NaN.
  const auto sinkOf = [](const std::vector<double>& sums) {
    return static_cast<std::int32_t>(sums.size()) - 1;
  };
  for (int row = 0; row < batch.unknowns; ++row) {
    for (int lane = 0; lane < lanes; ++lane)
      *row_slot++ = batch.element[lane] < 0 ? sinkOf(rows_) : rowSlot(batch.dofOf(row, lane));
    for (int column = row; column < batch.unknowns; ++column)
      for (int lane = 0; lane < lanes; ++lane)
        *entry_slot++ = batch.element[lane] < 0
                            ? sinkOf(entries_)
                            : entrySlot(batch.dofOf(row, lane), batch.dofOf(column, lane));
  }
}

void Assembler::hold(const std::vector<std::int32_t>& nodes, const std::vector<std::int32_t>& idle,
                     bool by_tool) {
  std::vector<std::int32_t> changed;
  for (const std::int32_t node : nodes) {
    for (int i = 0; i < 3; ++i) {
      const std::int32_t unknown = unknowns_.at({node, i});
      PALPATE_ASSERT(unknown >= 0, "nodes held by the tool must not be fixed");
      held_[unknown] = by_tool ? 1 : 0;
    }
    changed.insert(changed.end(), batches_.of_node[node].begin(), batches_.of_node[node].end());
  }
  for (const std::int32_t slot : idle)
    held_[unknowns_.at({slot, pressure_component})] = by_tool ? 1 : 0;
  sortUnique(changed);
  for (const std::int32_t batch : changed) findSlots(batch);
}

void Assembler::add(std::int32_t batch, const BatchResult& result) {
  const std::int32_t* slot = row_slots_.data() + batch * row_stride_;
  for (int row = 0; row < batches_.all[batch].unknowns; ++row)
    for (int lane = 0; lane < lanes; ++lane) rows_[*slot++] += result.residual[row][lane];
}

void Assembler::add(std::int32_t batch, const BatchTangent& tangent) {
  const std::int32_t* slot = entry_slots_.data() + batch * entry_stride_;
  const int entries = localEntries(batches_.all[batch].unknowns);
  for (int entry = 0; entry < entries; ++entry)
    for (int lane = 0; lane < lanes; ++lane) entries_[*slot++] += tangent.entry[entry][lane];
}

std::vector<double> Assembler::entries() const {
  return {entries_.begin(), entries_.begin() + static_cast<std::ptrdiff_t>(pattern_.row.size())};
}

Eigen::MatrixX3d Assembler::toolCoupling() const {
  return Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>>(
      entries_.data() + pattern_.row.size(), unknowns_.count(), 3);
}

Eigen::Matrix3d Assembler::toolEntries() const {
  const double* tool =
      entries_.data() + pattern_.row.size() + 3 * static_cast<std::size_t>(unknowns_.count());
  const Eigen::Matrix3d off_diagonal =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(tool + tool_diagonal);
  Eigen::Matrix3d sum = off_diagonal + off_diagonal.transpose();
  sum.diagonal() += Eigen::Map<const Eigen::Vector3d>(tool);
  return sum;
}

}  // namespace palpate
