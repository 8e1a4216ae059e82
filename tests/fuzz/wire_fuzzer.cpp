#include "common/wire/bundle.hpp"
#include "scheduler/service/status.hpp"
#include "tests/fuzz/frames.hpp"
#include "tests/fuzz/fuzzer.hpp"
#include "tests/support/solved_table.hpp"

namespace palpate::fuzz {
namespace {

/// An accepted result must survive being sent on.
void readResult(const wire::Result& result) {
  const std::optional<Outcome> outcome = fromWire(result);
  if (!outcome) return;
  wire::Result again;
  toWire(*outcome, "fields", again);
  require(fromWire(again).has_value(), "an outcome is not read as it was written");
}

/// What a follower and its client accept must survive being sent on.
template <class Message>
void readFollowing(const Message& message) {
  const auto accepted = fromWire(message);
  if (!accepted) return;
  Message again;
  toWire(*accepted, again);
  require(fromWire(again).has_value(), "a hand or an equilibrium is not read as it was written");
}

/// The first byte selects the receiver; the frames of one message follow.
void readWireMessage(std::string_view bytes) {
  Choices choices(bytes);
  const bool router = choices.oneOf(2) == 1;
  static SocketPair sockets;
  sockets.send(choices);
  for (;;) {
    std::optional<Incoming> incoming = receiveMessage(sockets.receiver(), router);
    if (!incoming) break;
    for (const Incoming& part : unbundled(std::move(*incoming))) {
      require(!part.message.has_bundle(), "a bundle is left");
      if (part.message.has_result()) readResult(part.message.result());
      if (part.message.has_hand_motion()) readFollowing(part.message.hand_motion());
      if (part.message.has_followed()) readFollowing(part.message.followed());
    }
  }
}

std::string frames(const wire::Message& message, const std::string& payload = "") {
  Script script;
  script.op(1).putBytes("peer").putBytes(message.SerializeAsString());
  if (!payload.empty()) script.putBytes(payload);
  return script.text();
}

std::vector<std::string> wireSeeds() {
  const Problem problem = test::cubeProblem();
  std::vector<std::string> seeds;
  Bundler bundler;
  for (const LatticePoint& target : {LatticePoint{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
    const auto [result, payload] = test::solve(problem, 0, target, {0, 0, 0});
    wire::Message message;
    *message.mutable_result() = result;
    seeds.push_back(frames(message, payload));
    bundler.add(std::move(message), payload);
  }
  for (const Letter& letter : bundler.take())
    seeds.push_back(frames(letter.message, letter.payload));
  wire::Message hello;
  hello.mutable_hello()->set_worker("worker");
  hello.mutable_hello()->add_ended("another");
  wire::Message job;
  *job.mutable_job()->add_targets()->mutable_point() = toWire(LatticePoint{-1, 0, 2});
  wire::Message hand, followed, failed;
  toWire(HandMotion{{1, 2, 3}, {4, 5, 6}}, *hand.mutable_hand_motion());
  toWire(Followed{Expansion{}, {}}, *followed.mutable_followed());
  toWire(Followed{Failure{.cause = Cause::inverted_element}, {}}, *failed.mutable_followed());
  for (const wire::Message& message : {hand, followed, failed}) seeds.push_back(frames(message));
  seeds.push_back(frames(hello));
  seeds.push_back(frames(job));
  return seeds;
}

const Registration wire_fuzzer({"wire", readWireMessage, wireSeeds});

}  // namespace
}  // namespace palpate::fuzz
