#pragma once

#include <filesystem>
#include <list>
#include <mutex>
#include <string>

#include "common/base/program.hpp"
#include "scheduler/service/coordinator.hpp"
#include "scheduler/web/http_server.hpp"
#include "scheduler/web/status_board.hpp"

namespace palpate {

/// Addresses of the pages that `serve` offers over HTTP; none by default.
struct PageOptions {
  std::string metrics;    ///< an HttpAddress; if empty, there is no page of metrics
  std::string dashboard;  ///< port on 127.0.0.1, "0" for any; if empty, no dashboard

  /// Declares --metrics and --dashboard.
  void addTo(CLI::App& app);
};

/// The pages of a scheduler: metrics for Prometheus, and the dashboard with its data, which only
/// this machine can reach. Their threads use the status that the scheduler's thread offers, and
/// read the state directory as `palpate events` and `palpate explain` do.
class ServedPages {
 public:
  /// Listens and logs the addresses. Throws Error if it cannot listen.
  ServedPages(const PageOptions& options, std::filesystem::path state);

  /// Offers the current status. Call in every turn, on the coordinator's thread.
  void offer(const Coordinator& coordinator);

 private:
  StatusBoard::Snapshot snapshot();
  HttpAnswer metrics();
  HttpAnswer status();
  HttpAnswer events(const HttpQuery& query);
  HttpAnswer explain(const HttpQuery& query);

  std::filesystem::path state_;
  StatusBoard board_;
  std::mutex reading_;             ///< lets one request at a time read the state directory
  std::list<HttpServer> servers_;  ///< destroyed first: its threads use the other members
};

}  // namespace palpate
