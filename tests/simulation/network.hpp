#pragma once

#include <deque>
#include <limits>
#include <map>

#include "common/wire/wire.hpp"
#include "scheduler/service/coordinator.hpp"
#include "tests/simulation/history.hpp"
#include "tests/simulation/random.hpp"

namespace palpate::simulation {

/// True seconds since the start of a simulation, unknown to its processes.
using Seconds = double;
inline constexpr Seconds never = std::numeric_limits<Seconds>::infinity();

/// Connections between one scheduler and its workers, which behave like those of ZeroMQ. A worker's
/// side reconnects by itself. Messages of a broken connection are lost. The scheduler's side knows
/// a peer from the peer's first message until it notices that the connection is broken. Messages
/// within a connection keep their order, unless an accident changes it.
class Network {
 public:
  explicit Network(std::uint64_t seed) : random_(seed) {}

  // The two ends. A worker is named by its peer id.
  void join(const std::string& worker, Seconds now);
  /// The worker's process has ended. Its system notifies the other end if that is reachable.
  void leave(const std::string& worker, Seconds now);
  /// The worker makes a new socket.
  void reconnect(const std::string& worker, Seconds now);
  void schedulerStarts() { scheduler_up_ = true; }
  void schedulerEnds();
  Sent toWorker(const std::string& worker, const wire::Message& message, std::string payload,
                Seconds now);
  void toScheduler(const std::string& worker, const wire::Message& message,
                   std::string_view payload, Seconds now);

  // Messages that have arrived by now.
  std::optional<Incoming> forScheduler(Seconds now);
  std::optional<Incoming> forWorker(const std::string& worker, Seconds now);
  /// Time at which the next message arrives at this end; infinity if none is on its way.
  Seconds nextForScheduler() const;
  Seconds nextForWorker(const std::string& worker) const;

  /// Begins an accident, for all workers if `worker` is empty.
  void happen(const Event& event, const std::string& worker);
  /// How often each kind of accident took effect.
  const std::map<Accident, std::uint64_t>& felt() const { return felt_; }
  /// The longest queue so far.
  std::size_t mostWaiting() const { return most_waiting_; }

 private:
  using Queue = std::multimap<Seconds, Incoming>;  ///< by time of arrival
  struct Line {
    Queue to_worker, to_scheduler;
    Seconds last_to_worker = 0, last_to_scheduler = 0;  ///< latest arrivals, to keep the order
    bool known = false;                                 ///< the scheduler's side has a route
    Seconds connects_at = 0;                            ///< time of the next attempt to connect
    bool connected = false;                             ///< in the view of the worker's side
    bool dead_end = false;  ///< half open: messages of the scheduler are lost
    bool gone = false;
  };
  struct Trouble {
    Event event;
    std::string worker;
  };

  bool troubled(Accident accident, const std::string& worker, Seconds now);
  const Trouble* trouble(Accident accident, const std::string& worker, Seconds now) const;
  bool cut(bool to_worker, const std::string& worker, Seconds now);
  void post(Queue& queue, Seconds& last, Incoming letter, const std::string& worker, Seconds now);
  void breakLine(Line& line, Seconds now);
  void connectAgain(const std::string& worker, Line& line, Seconds now);

  Random random_;
  std::map<std::string, Line> lines_;
  std::vector<Trouble> troubles_;
  std::map<Accident, std::uint64_t> felt_;
  bool scheduler_up_ = false;
  std::size_t most_waiting_ = 0;
};

}  // namespace palpate::simulation
