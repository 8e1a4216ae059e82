#include <spdlog/spdlog.h>

#include "common/base/required_option.hpp"
#include "common/keys/key_options.hpp"
#include "worker/elements/blas_kernels.hpp"
#include "worker/link/follow_server.hpp"
#include "worker/verbs.hpp"

namespace palpate {
namespace {

constexpr std::chrono::milliseconds turn_time{50};

struct FollowOptions {
  std::string endpoint;
  KeyOptions keys;

  void addTo(CLI::App& app) {
    addRequired(app, "--listen", endpoint,
                "Endpoint for `palpate view --live`: tcp://HOST:PORT or ipc://PATH", "ENDPOINT");
    keys.addTo(app, "Serve clients without a key");
    app.footer(
        "Solves configurations near the hand of one haptic client at a time, so that this client\n"
        "needs no solver. Ends with Ctrl-C. Exit codes: 0 done, 1 failed, 2 wrong usage.");
  }
};

void follow(const FollowOptions& options) {
  catchInterrupts();
  prepareBlas();
  FollowServer server(options.endpoint, chooseKernels(), options.keys.keys());
  spdlog::info("listening at {}", server.endpoint());
  while (!interrupted()) server.turn(turn_time);
}

}  // namespace

const Verb follow_verb = {"follow", "Live solver: solve near a client's hand (palpate view --live)",
                          prepareVerb<FollowOptions, follow>};

}  // namespace palpate
