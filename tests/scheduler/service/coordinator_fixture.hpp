#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scheduler/service/coordinator.hpp"
#include "tests/scheduler/build_world.hpp"

namespace palpate::test {

/// A coordinator with its state directory, and workers that send what a test tells them to.
struct CoordinatorFixture : testing::Test {
  BuildWorld world;

  std::string refusalOf(const wire::Message& hello) {
    world.send("a", hello);
    const auto refused = world.take("a", wire::Message::kRefused);
    return refused.empty() ? "" : refused[0].refused().reason();
  }
  void solveOrigins() { world.solveOrigins(); }
  /// Sends an operator's retry. Returns the number of transitions to solve again.
  std::uint32_t retryFailed(const char* cause = "") {
    wire::Message order;
    order.mutable_retry_request()->set_cause(cause);
    world.send("operator", order);
    return world.take("operator", wire::Message::kRetryReply).at(0).retry_reply().transitions();
  }
  /// A machine that runs out of memory in every solve but the rest state.
  void failWithoutMemory() {
    world.solver = [](const Problem& problem, std::uint32_t space, const LatticePoint& target,
                      const LatticePoint& parent) {
      if (target == LatticePoint{}) return solve(problem, space, target, parent);
      return resultOf(problemId(problem), space, target, parent,
                      {Failure{.cause = Cause::factorization_failed}, {}});
    };
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
