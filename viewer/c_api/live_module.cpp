#include "viewer/c_api/live_module.hpp"

#include <stdexcept>

#include "common/base/error.hpp"
#include "common/base/foreign_program.hpp"
#include "common/keys/key_options.hpp"
#include "viewer/live/live_link.hpp"
#include "viewer/live/unsolved_dataset.hpp"

namespace palpate {
namespace {

/// Longest wait for the state at rest.
constexpr std::chrono::seconds start_patience{60};

LiveLinkOptions linkOptions(const Problem& problem, const LiveRequest& request) {
  LiveLinkOptions options;
  options.problem = encodeProblem(problem);
  if (request.follower == nullptr) {
    options.worker = installedPath(request.worker != nullptr ? request.worker : "palpate-worker");
    if (options.worker.empty())
      throw std::runtime_error(
          fmt::format("there is no program {}; install Palpate, or set options->worker",
                      request.worker != nullptr ? request.worker : "palpate-worker in PATH"));
    return options;
  }
  options.endpoint = request.follower;
  const std::string keys = request.keys != nullptr ? request.keys : "";
  options.keys = KeyOptions{keys, request.keys != nullptr && keys.empty()}.keys();
  return options;
}

class LinkedService final : public LiveService {
 public:
  LinkedService(const LiveRequest& request, const Problem& problem)
      : build_(problemId(problem)), options_(linkOptions(problem, request)) {
    if (request.unsolved) unsolved_.emplace(problem);
  }
  std::string unsolved() const override { return unsolved_ ? unsolved_->file().string() : ""; }
  ContentId build() const override { return build_; }
  void start(LiveTouch& touch) override {
    link_.emplace(touch, std::move(options_));
    if (link_->waitUntilReady(start_patience)) return;
    const std::string trouble = link_->trouble();
    throw std::runtime_error(trouble.empty() ? "the live solver has not started" : trouble);
  }
  std::string trouble() const override { return link_->trouble(); }
  LiveStatistics statistics() const override { return link_->statistics(); }

 private:
  ContentId build_;
  LiveLinkOptions options_;
  std::optional<UnsolvedDataset> unsolved_;
  std::optional<LiveLink> link_;
};

}  // namespace
}  // namespace palpate

extern "C" palpate::LiveService* openLiveService(const palpate::LiveRequest& request) {
  return new palpate::LinkedService(request, palpate::loadProblem(request.scene));
}
