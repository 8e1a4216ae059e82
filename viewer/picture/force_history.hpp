#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <deque>

namespace palpate {

/// The forces of the last seconds, for the plot. One thread.
class ForceHistory {
 public:
  static constexpr double span = 5;  ///< length of the history, s
  struct Sample {
    double time = 0;  ///< s, HapticState::time
    Eigen::Vector3f force = Eigen::Vector3f::Zero();
    float bound = 0;  ///< error bound of the force, N; NaN if unknown
  };

  /// Adds a sample. Ignores a sample with the same time as the last one. A sample with an earlier
  /// time begins another run and clears the history.
  void add(double time, const Eigen::Vector3d& force, double error_bound) {
    if (!samples_.empty() && time == samples_.back().time) return;
    if (!samples_.empty() && time < samples_.back().time) samples_.clear();
    samples_.push_back({time, force.cast<float>(), static_cast<float>(error_bound)});
    while (samples_.front().time < time - span || samples_.size() > most_samples)
      samples_.pop_front();
  }
  /// Returns the samples, the oldest first.
  const std::deque<Sample>& samples() const { return samples_; }
  /// Returns the largest value of |force| + bound, N; 0 if the history is empty. The bound is
  /// limited to |force|. Otherwise one uncertain force would make all other forces look small.
  double largest() const {
    float largest = 0;
    for (const auto& [time, force, bound] : samples_) {
      const float length = force.norm();
      largest = std::max(largest, length + (bound > 0 ? std::min(bound, length) : 0));
    }
    return largest;
  }

 private:
  static constexpr std::size_t most_samples = 1024;  ///< enough for 200 frames per second
  std::deque<Sample> samples_;
};

}  // namespace palpate
