#include "worker/link/follow_server.hpp"

#include <spdlog/spdlog.h>

#include "common/base/error.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds longest_silence{2};

}  // namespace

FollowServer::FollowServer(const std::string& endpoint, const ElementKernels& kernels,
                           const std::optional<KeyFolder>& keys)
    : kernels_(kernels), socket_(makeRouter(context_)) {
  if (keys) zap_handler_.emplace(context_, socket_, *keys);
  endpoint_ = bindRouter(socket_, endpoint);
}

void FollowServer::turn(std::chrono::milliseconds longest) {
  waitForMessages(socket_, longest);
  while (const auto incoming = inbox_.next(socket_, true)) handle(*incoming);
}

void FollowServer::handle(const Incoming& incoming) {
  if (zap_handler_ && !include(zap_handler_->rolesOf(incoming.key), Roles::system_operator))
    return refuse(
        incoming.peer,
        "your key may not use this live solver: run palpate key allow KEY operator on its "
        "machine");
  if (incoming.message.has_follow_request()) return begin(incoming);
  if (incoming.message.has_hand_motion() && incoming.peer == client_ && follower_)
    return follow(incoming);
  if (incoming.message.has_goodbye() && incoming.peer == client_) return client_.clear();
  spdlog::debug("an unexpected message was ignored");
}

void FollowServer::begin(const Incoming& incoming) {
  const wire::FollowRequest& request = incoming.message.follow_request();
  if (request.protocol() != protocol_version)
    return refuse(incoming.peer, fmt::format("it speaks version {} of the protocol, you speak {}: "
                                             "use the same version of palpate",
                                             protocol_version, request.protocol()));
  if (!client_.empty() && client_ != incoming.peer && Clock::now() - last_heard_ < longest_silence)
    return refuse(incoming.peer, "it is solving for another client");
  client_.clear();
  follower_.reset();
  try {
    problem_ = decodeProblem(incoming.payload);
    if (!(request.finger_radius() > 0)) throw badInput("the radius of the finger is not positive");
    follower_.emplace(*problem_, kernels_, request.finger_radius());
  } catch (const Error& error) {
    return refuse(incoming.peer, error.what());
  }
  client_ = incoming.peer;
  last_heard_ = Clock::now();
  spdlog::info("solving near the hand on {}, {} nodes", printable(problem_->scene.name),
               problem_->mesh.nodes.size());
  wire::Message reply;
  reply.mutable_follow_reply();
  send(client_, reply);
}

void FollowServer::follow(const Incoming& incoming) {
  wire::Message reply;
  if (incoming.message.hand_motion().released()) {
    follower_->release();
    reply.mutable_follow_reply();
  } else if (const auto hand = fromWire(incoming.message.hand_motion())) {
    try {
      toWire(follower_->follow(*hand), *reply.mutable_followed());
    } catch (const Error& error) {
      if (error.exitCode() != ExitCode::usage) {
        spdlog::warn("{}", error.what());
        return refuse(client_, error.what());
      }
      toWire(Followed{Failure{}, {}}, *reply.mutable_followed());
      reply.mutable_followed()->set_objection(error.what());
    }
  } else {
    return spdlog::debug("an invalid hand position was ignored");
  }
  last_heard_ = Clock::now();
  send(client_, reply);
}

void FollowServer::refuse(const std::string& peer, const std::string& why) {
  wire::Message reply;
  reply.mutable_refused()->set_reason(why);
  send(peer, reply);
}

void FollowServer::send(const std::string& peer, const wire::Message& message) {
  if (sendMessage(socket_, peer, message) != Sent::yes)
    spdlog::debug("a client does not read its results");
}

}  // namespace palpate
