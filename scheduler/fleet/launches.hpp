#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace palpate {

/// Later and later, as long as something fails. One thread.
class Backoff {
 public:
  using Time = std::chrono::steady_clock::time_point;

  explicit Backoff(std::chrono::seconds first_pause) : first_(first_pause) {}

  /// It failed: nothing before pause() is over, the first after one failure, and twice as long with
  /// each more, 32 times at most.
  void failed(Time now);
  void succeeded() { failures_ = 0; }
  bool over(Time now) const { return failures_ == 0 || now >= until_; }
  std::chrono::seconds pause() const;

 private:
  std::chrono::seconds first_;
  int failures_ = 0;  ///< in a row
  Time until_;
};

/// Judges by how the jobs fared that an engine started how many more may be asked for, and where.
///
/// A job that fails within seconds of its start would be replaced for ever: its program is not
/// there, or a library, its CPU is too old, its key is not let in. After some in a row one job at a
/// time is tried, later and later, until one lives (HyperQueue pauses such a queue). A node that
/// fails jobs while others work is empty soonest, and would get all of them: it is left out.
///
/// Knows no engine and no clock but the one that it is told. One thread.
class Launches {
 public:
  using Time = Backoff::Time;
  /// A job that fails sooner never worked; one that is older does.
  static constexpr std::chrono::seconds early{30};
  static constexpr int most_in_a_row = 5, most_on_a_node = 3;

  struct Running {
    std::string id, node;
    std::chrono::seconds age{};
  };
  struct Ended {
    enum class How : std::uint8_t { well, failed, from_outside };
    std::string id, node;
    How how{};
    std::string words;           ///< "exit code 127"
    std::chrono::seconds age{};  ///< that it reached
    std::string when;            ///< of the engine's clock: only compared with others of it
  };
  /// What changed.
  struct Change {
    bool held = false;                  ///< for pause() from now on: again, or for the first time
    std::vector<std::string> left_out;  ///< nodes
  };

  explicit Launches(std::chrono::seconds first_pause) : backoff_(first_pause) {}

  /// What there is by now; `ended` in order, those that were seen before too, for as long as the
  /// engine tells them.
  Change see(const std::vector<Ended>& ended, const std::vector<Running>& running, Time now);

  /// So many failed in a row that one at a time is tried.
  bool held() const { return in_a_row_ >= most_in_a_row; }
  /// How many may be queued, or younger than `early`, at a time.
  int mostUnproven(Time now) const;
  std::chrono::seconds pause() const { return backoff_.pause(); }
  /// The latest that failed early in a row, at most most_in_a_row, the latest last.
  const std::deque<Ended>& failures() const { return last_failures_; }
  const std::set<std::string>& badNodes() const { return bad_nodes_; }

 private:
  bool countNew(const std::vector<Ended>& ended, Time now);
  bool works(const Running& job) const;
  void believe(const std::vector<Running>& running, Time now);
  std::vector<std::string> leaveOut(const std::vector<Running>& running);

  Backoff backoff_;
  std::set<std::string> seen_;            ///< ends that the engine still tells
  int in_a_row_ = 0;                      ///< failed early, without those on bad nodes
  std::map<std::string, int> on_a_node_;  ///< the same of each
  std::set<std::string> bad_nodes_;
  std::deque<Ended> last_failures_;
  Time last_failure_;
};

}  // namespace palpate
