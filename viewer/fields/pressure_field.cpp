#include "viewer/fields/pressure_field.hpp"

#include "common/base/assertion.hpp"

namespace palpate {

PressureField::PressureField(const SpaceTable& space, std::span<const float> pressures)
    : blend_(space), rows_(blend_.rowsOf(pressures, 1)) {
  PALPATE_ASSERT(rows_.rows() == std::ssize(blend_.points()), "each point must have values");
}

void PressureField::add(const Eigen::Vector3d& displacement, double weight,
                        std::span<float> out) const noexcept {
  const LeafPlace place = blend_.leafAt(displacement);
  if (place.leaf < 0) return;
  Eigen::Map<Eigen::RowVectorXf> sum(out.data(), std::ssize(out));
  const std::array<double, 8> weights = trilinearWeights(place.local);
  for (std::size_t c = 0; c < 8; ++c) {
    if (weights[c] == 0) continue;
    const auto of_corner = static_cast<float>(weight * weights[c]);
    for (const PointShare& share : blend_.ofSlot(blend_.tree().corners(place.leaf)[c]))
      sum += of_corner * static_cast<float>(share.factor) * rows_.row(share.row);
  }
}

}  // namespace palpate
