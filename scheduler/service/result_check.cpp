#include "scheduler/service/result_check.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/space/configuration.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// The part of a result that must be the same bits whoever computes it.
std::string reproducibleBytes(wire::Result result) {
  // Who asked for it and how long it took depends on timing, everything else on the scene.
  result.clear_job();
  result.clear_attempt();
  if (result.has_cost()) result.mutable_cost()->clear_seconds();
  return result.SerializeAsString();
}

}  // namespace

ResultCheck::ResultCheck(const Problem& problem) : problem_(&problem), build_(problemId(problem)) {}

std::string ResultCheck::objectionTo(const wire::Result& result, const std::string& payload,
                                     const std::string& kernel_family) const {
  if (result.build() != build_.bytes()) return "a result of another build";
  const auto outcome = fromWire(result);
  if (!outcome) return "a result that makes no sense";
  if (result.payload_bytes() != payload.size())
    return "a result whose payload has another length than it says";
  if (result.kernel_family() != kernel_family) return "a result of other kernels than its worker's";
  // A failure has no payload to check; its step is shown to people and ranks its cause.
  if (!outcome->converged) {
    const double reached = outcome->failure.step_reached;
    return std::isfinite(reached) && reached >= 0 && reached <= 1
               ? ""
               : "a failure with an impossible step";
  }
  if (ContentId::of(payload).bytes() != result.fields_id())
    return "a result whose payload has another content id";
  try {
    NodalFields::decode(payload, problem_->mesh.nodes.size(), pressureNodes(*problem_));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

bool ResultCheck::agree(const wire::Result& first, const wire::Result& second) {
  return reproducibleBytes(first) == reproducibleBytes(second);
}

}  // namespace palpate
