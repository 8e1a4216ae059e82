#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "common/keys/key_options.hpp"
#include "scheduler/verbs/served_build.hpp"
#include "scheduler/verbs/served_pages.hpp"
#include "scheduler/verbs/service_manager.hpp"
#include "scheduler/verbs/status_text.hpp"
#include "scheduler/verbs/verbs.hpp"

namespace palpate {
namespace {

/// Time limit for reading results or sealing. It is announced to the service manager, because no
/// turns run meanwhile.
constexpr std::chrono::hours longest_pause{1};
/// Status text before a build restarts from its records.
constexpr const char* going_over = "reading the recorded results again";

struct ServeOptions {
  BuildOrder order;
  std::string endpoint = default_endpoint;
  KeyOptions keys;
  PageOptions pages;

  void addTo(CLI::App& app) {
    order.addTo(app);
    app.get_option("--state")->required()->description("State directory, on a local disk");
    app.add_option("--listen", endpoint, "Endpoint for workers, tcp://HOST:PORT")
        ->capture_default_str();
    order.spot_checks_percent = 100 * SpotCheckSettings{}.share;
    app.add_option("--spot-checks", order.spot_checks_percent,
                   "Percentage of the results that another machine solves again")
        ->capture_default_str()
        ->check(CLI::Range(0.0, 100.0));
    keys.addTo(
        app, "Require no keys: anyone who reaches the port can deliver results and stop the build");
    pages.addTo(app);
    app.footer(
        "Ends when the dataset is sealed or the build is stopped; the same command then "
        "continues.\n"
        "Exit codes: 0 done or stopped, 1 failed, 2 bad scene or usage, 3 done but some points "
        "failed, 130 interrupted.");
  }
};

/// Workers that connect from anywhere. Keeps the service manager and the pages up to date.
class RemoteWorkers : public Crew {
 public:
  RemoteWorkers(const Server& server, Build& build, ServiceManager& manager, ServedPages& pages)
      : coordinator_(build.coordinator()), manager_(manager), pages_(pages) {
    spdlog::info("listening on {}", server.endpoint());
    manager_.ready();
  }

  void look() override {
    const auto now = Clock::now();
    pages_.offer(coordinator_);
    manager_.alive(now, [&] { return progressLine(coordinator_.status(now)); });
  }
  void pause(Next why) override {
    manager_.mayTake(longest_pause, why == Next::complete ? "sealing the dataset"
                                    : why == Next::anew   ? going_over
                                                          : "stopping");
  }
  bool isThere() override {
    pages_.offer(coordinator_);
    return !coordinator_.deserted(Clock::now());
  }

 private:
  using Clock = std::chrono::steady_clock;

  const Coordinator& coordinator_;
  ServiceManager& manager_;
  ServedPages& pages_;
};

ExitCode serve(const ServeOptions& options) {
  checkEndpoint(options.endpoint);
  ServedPages pages(options.pages, options.order.state);
  ServiceManager manager;
  manager.mayTake(longest_pause, "reading the recorded results");
  const auto crew = [&](Server& server, Build& build) {
    return std::make_unique<RemoteWorkers>(server, build, manager, pages);
  };
  const ExitCode code =
      serveBuild(options.order, {.endpoint = options.endpoint,
                                 .keys = options.keys.keys(),
                                 .crew = crew,
                                 .anew = [&] { manager.mayTake(longest_pause, going_over); },
                                 .when_stopped = ExitCode::done});
  // If READY is not sent, the service manager considers a start with nothing to do as failed.
  manager.ready();
  manager.stopping();
  return code;
}

}  // namespace

const Verb serve_verb = {"serve",
                         "Compute the dataset of a scene with workers that connect from anywhere",
                         prepareVerb<ServeOptions, serve>};

}  // namespace palpate
