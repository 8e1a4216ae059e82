#include "scheduler/service/service_state.hpp"

#include "common/base/assertion.hpp"

namespace palpate {

wire::Message& ServiceState::send(const std::string& peer,
                                  std::shared_ptr<const std::string> payload) {
  outbox.push_back({peer, {}, std::move(payload)});
  return outbox.back().message;
}

wire::ResultAck& ServiceState::acknowledge(const std::string& peer, const wire::Result& result) {
  PALPATE_ASSERT(!turns_since_retry, "plans with dropped results must not take new results");
  wire::ResultAck& ack = *send(peer).mutable_result_ack();
  ack.set_space(result.space());
  *ack.mutable_target() = result.target();
  *ack.mutable_parent() = result.parent();
  return ack;
}

}  // namespace palpate
