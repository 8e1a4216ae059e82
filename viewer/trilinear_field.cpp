#include "viewer/trilinear_field.hpp"

namespace palpate {

TrilinearField::TrilinearField(const SpaceTable& space) : grid_(space) {
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    points_.push_back(space.points[n].equilibrium);
    displacement_.push_back(space.lattice.displacement(n));
  }
}

ForceSample TrilinearField::evaluate(const Eigen::Vector3d& displacement) const noexcept {
  const CellPlace place = grid_.find(displacement);
  if (place.corners == nullptr)
    return sampleOutside(points_[place.nearest], displacement - displacement_[place.nearest],
                         grid_.spacing());

  ForceSample sample;
  sample.inside = true;
  for (std::size_t c = 0; c < 8; ++c) {
    Eigen::Vector3d weight, slope;  // of the linear basis along each axis
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = (c >> axis & 1) != 0;
      weight[axis] = upper ? place.local[axis] : 1 - place.local[axis];
      slope[axis] = (upper ? 1 : -1) / grid_.spacing();
    }
    const Eigen::RowVector3d gradient(slope.x() * weight.y() * weight.z(),
                                      weight.x() * slope.y() * weight.z(),
                                      weight.x() * weight.y() * slope.z());
    const Eigen::Vector3d& force = points_[(*place.corners)[c]].force;
    sample.force += weight.prod() * force;
    sample.stiffness += force * gradient;
  }
  return sample;
}

}  // namespace palpate
