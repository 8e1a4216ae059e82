#pragma once

#include <filesystem>
#include <list>
#include <mutex>
#include <string>

#include "scheduler/service/coordinator.hpp"
#include "scheduler/web/http_server.hpp"
#include "scheduler/web/status_board.hpp"

namespace CLI {
class App;
}

namespace palpate {

/// What `serve` offers over HTTP, and where; nothing unless it is asked for.
struct PageOptions {
  std::string metrics;    ///< an HttpAddress; empty: nowhere
  std::string dashboard;  ///< a port of 127.0.0.1; "0": the system chooses; empty: nowhere

  /// --metrics and --dashboard.
  void addTo(CLI::App& app);
};

/// The pages of a scheduler: metrics for Prometheus, and on this machine the dashboard with what it
/// asks for. They are answered in threads of their own, from the status that the scheduler's thread
/// offers and from what lies in its state directory, which is read as `events` and `explain` do.
class ServedPages {
 public:
  /// Listens, and says where (log). Error when it cannot.
  ServedPages(const PageOptions& options, std::filesystem::path state);
  ServedPages(const ServedPages&) = delete;
  ServedPages& operator=(const ServedPages&) = delete;

  /// In every turn, by the thread of the coordinator.
  void offer(const Coordinator& coordinator);

 private:
  StatusBoard::Snapshot snapshot();
  HttpAnswer metrics();
  HttpAnswer status();
  HttpAnswer events(const HttpQuery& query);
  HttpAnswer explain(const HttpQuery& query);

  std::filesystem::path state_;
  StatusBoard board_;
  std::mutex reading_;             ///< of the state directory: by one at a time
  std::list<HttpServer> servers_;  ///< the last member: their threads use the others
};

}  // namespace palpate
