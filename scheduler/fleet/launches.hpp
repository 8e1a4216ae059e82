#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace palpate {

/// Exponential backoff between attempts. One thread.
class Backoff {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit Backoff(std::chrono::seconds first_pause) : first_(first_pause) {}

  /// Records a failure: over() is false until pause() has passed. The pause doubles with each
  /// failure in a row, up to 32 times the first.
  void failed(Time now);
  void succeeded() { failures_ = 0; }
  bool over(Time now) const { return failures_ == 0 || now >= until_; }
  std::chrono::seconds pause() const;

 private:
  std::chrono::seconds first_;
  int failures_ = 0;  ///< number of failures in a row; counts up to 6
  Time until_;
};

/// Decides, from the outcome of earlier jobs, how many more jobs to request and on which nodes.
///
/// A job that fails within seconds of its start would be replaced for ever: its program or a
/// library may be missing, its CPU too old, or its key not allowed. After several early failures in
/// a row, one job at a time is tried, with growing pauses, until one survives. (HyperQueue pauses a
/// queue in this case.) A node whose jobs fail while other nodes work would always be idle and get
/// every new job, so it is excluded.
///
/// Knows neither the engine nor the time: the caller passes jobs and time. One thread.
class Launches {
 public:
  using Time = Backoff::Time;
  /// A job that fails within this time after its start counts as an early failure. A job that has
  /// run longer is considered to work.
  static constexpr std::chrono::seconds early{30};
  static constexpr int most_in_a_row = 5, most_on_a_node = 3;

  struct Running {
    std::string id, node;
    std::chrono::seconds age{};
  };
  struct Ended {
    /// `from_outside`: the job was ended by Slurm or a user (preempted, cancelled)
    enum class How : std::uint8_t { well, failed, from_outside };
    std::string id, node;
    How how{};
    std::string words;           ///< description, such as "exit code 127"
    std::chrono::seconds age{};  ///< age at its end
    std::string when;  ///< end time on the engine's clock; compared only with other such times
  };
  /// The changes that a call of see() made.
  struct Change {
    bool held = false;  ///< new early failures put requests on hold for the time pause()
    std::vector<std::string> left_out;  ///< nodes that are now excluded
  };

  explicit Launches(std::chrono::seconds first_pause) : backoff_(first_pause) {}

  /// Call with the current jobs. `ended` is sorted by time and may repeat jobs of earlier calls.
  Change see(const std::vector<Ended>& ended, const std::vector<Running>& running, Time now);

  /// Returns true if, after most_in_a_row early failures, only one job at a time is tried.
  bool held() const { return in_a_row_ >= most_in_a_row; }
  /// Returns the limit on the number of jobs that are queued or younger than `early`.
  int mostUnproven(Time now) const;
  std::chrono::seconds pause() const { return backoff_.pause(); }
  /// The latest early failures in a row, at most most_in_a_row of them, oldest first.
  const std::deque<Ended>& failures() const { return last_failures_; }
  const std::set<std::string>& badNodes() const { return bad_nodes_; }

 private:
  bool countNew(const std::vector<Ended>& ended, Time now);
  bool works(const Running& job) const;
  void believe(const std::vector<Running>& running, Time now);
  std::vector<std::string> leaveOut(const std::vector<Running>& running);

  Backoff backoff_;
  /// ended jobs that are counted already and that the engine still lists
  std::set<std::string> seen_;
  int in_a_row_ = 0;  ///< number of early failures in a row, except on bad nodes
  std::map<std::string, int> on_a_node_;  ///< number of early failures on each node
  std::set<std::string> bad_nodes_;
  std::deque<Ended> last_failures_;
  Time last_failure_;
};

}  // namespace palpate
