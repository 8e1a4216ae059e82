#include "viewer/picture/force_history.hpp"

#include <algorithm>

namespace palpate {

void ForceHistory::add(double time, const Eigen::Vector3d& force) {
  if (size_ > 0 && time == latest().time) return;
  if (size_ > 0 && time < latest().time) first_ = size_ = 0;
  if (size_ == samples_.size()) {
    first_ = (first_ + 1) % samples_.size();
    --size_;
  }
  samples_[(first_ + size_) % samples_.size()] = {time, force.cast<float>()};
  ++size_;
  while (at(0).time < time - span) {
    first_ = (first_ + 1) % samples_.size();
    --size_;
  }
}

double ForceHistory::largest() const {
  float largest = 0;
  for (std::size_t n = 0; n < size_; ++n) largest = std::max(largest, at(n).force.norm());
  return largest;
}

}  // namespace palpate
