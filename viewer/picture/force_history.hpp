#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace palpate {

/// The forces of the last seconds, for the plot. One thread; does not allocate.
class ForceHistory {
 public:
  static constexpr double span = 5;  ///< s that are kept
  struct Sample {
    double time = 0;  ///< s, HapticState::time
    Eigen::Vector3f force = Eigen::Vector3f::Zero();
  };

  /// The same time again adds nothing; an earlier one begins anew (another run).
  void add(double time, const Eigen::Vector3d& force);
  std::size_t size() const { return size_; }
  /// 0: the oldest.
  const Sample& at(std::size_t index) const { return samples_[(first_ + index) % samples_.size()]; }
  const Sample& latest() const { return at(size_ - 1); }
  double largest() const;  ///< N, of the lengths; 0 when empty

 private:
  std::array<Sample, 1024> samples_;  ///< 200 pictures per second
  std::size_t first_ = 0, size_ = 0;
};

}  // namespace palpate
