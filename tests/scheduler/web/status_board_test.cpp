#include "scheduler/web/status_board.hpp"

#include <gtest/gtest.h>

#include <future>
#include <thread>

namespace palpate {
namespace {

using namespace std::chrono_literals;

struct StatusBoardTest : testing::Test {
  StatusBoard board;
  int made = 0;

  wire::Status make() {
    wire::Status status;
    status.set_recorded(++made);
    return status;
  }
  void offer() {
    board.offer([this] { return make(); });
  }
  /// The answer to a request while the scheduler makes turns.
  std::optional<StatusBoard::Snapshot> askWhileTurning() {
    auto answer = std::async(std::launch::async, [this] { return board.ask(60s); });
    while (answer.wait_for(1ms) != std::future_status::ready) offer();
    return answer.get();
  }
};

TEST_F(StatusBoardTest, CostsNothingWithoutRequests) {
  for (int n = 0; n < 1000; ++n) offer();
  EXPECT_EQ(made, 0);
}

TEST_F(StatusBoardTest, OneStatusServesAllWaitingRequests) {
  const auto first = askWhileTurning();
  ASSERT_TRUE(first);
  EXPECT_EQ(first->status->recorded(), 1);
  std::size_t asked = 0;
  while (first->age + 1ms * asked < 100ms) {
    ASSERT_TRUE(board.ask(0ms));
    offer();
    ++asked;
  }
  EXPECT_LE(made, 2) << "one a second, however slow this machine is";
}

TEST_F(StatusBoardTest, ABusySchedulerLeavesItsLastStatus) {
  EXPECT_FALSE(board.ask(0ms)) << "there was none yet";
  ASSERT_TRUE(askWhileTurning());
  std::this_thread::sleep_for(StatusBoard::good_for_at_least);
  const auto old = board.ask(1ms);
  ASSERT_TRUE(old);
  EXPECT_EQ(old->status->recorded(), 1);
  EXPECT_GE(old->age, StatusBoard::good_for_at_least);
}

TEST_F(StatusBoardTest, AnExpensiveStatusIsMadeLessOften) {
  auto answer = std::async(std::launch::async, [this] { return board.ask(60s); });
  while (answer.wait_for(1ms) != std::future_status::ready)
    board.offer([this] {
      std::this_thread::sleep_for(50ms);
      return make();
    });
  std::this_thread::sleep_for(1200ms);
  static_cast<void>(board.ask(0ms));
  offer();
  EXPECT_EQ(made, 1) << "it takes a hundredth of the interval";
}

}  // namespace
}  // namespace palpate
