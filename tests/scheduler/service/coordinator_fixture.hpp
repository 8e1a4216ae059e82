#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scheduler/service/coordinator.hpp"
#include "tests/scheduler/build_world.hpp"

namespace palpate::test {

/// A coordinator with its state directory, and workers that say what a test has them say.
struct CoordinatorFixture : testing::Test {
  BuildWorld world;

  std::string refusalOf(const wire::Message& hello) {
    world.send("a", hello);
    const auto refused = world.take("a", wire::Message::kRefused);
    return refused.empty() ? "" : refused[0].refused().reason();
  }
  /// Solves both origins.
  void solveOrigins() {
    world.join("a", 2);
    for (const wire::Job& job : world.takeJobs("a")) world.deliver("a", job);
    world.pass(std::chrono::milliseconds(25));
    world.take("a", wire::Message::kResultAck);
  }
  wire::Message originResult(const std::function<void(wire::Result&)>& change = {}) {
    wire::Message message;
    *message.mutable_result() = solve(world.problem, 0, {0, 0, 0}, {0, 0, 0}).first;
    world.prove("a", *message.mutable_result());
    if (change) change(*message.mutable_result());
    return message;
  }
  std::string originFields() { return solve(world.problem, 0, {0, 0, 0}, {0, 0, 0}).second; }
};

}  // namespace palpate::test
