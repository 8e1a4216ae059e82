#include "worker/link/mailbox.hpp"

#include <gtest/gtest.h>
#include <poll.h>

namespace palpate {
namespace {

using namespace std::chrono_literals;

bool isAwake(const Mailbox& mailbox) {
  struct pollfd descriptor = {mailbox.wakeUpDescriptor(), POLLIN, 0};
  return poll(&descriptor, 1, 0) == 1;
}

/// Starts a job.
void begin(Mailbox& mailbox) {
  mailbox.put({std::make_shared<Problem>(), {}, nullptr});
  ASSERT_TRUE(mailbox.next(false));
}

void finish(Mailbox& mailbox, bool last = false) {
  FinishedTarget target;
  target.last_of_job = last;
  mailbox.finish(std::move(target));
}

/// Each message costs the scheduler time beyond that for its bytes.
TEST(Mailbox, SendsTargetsThatFollowFastTogether) {
  Mailbox mailbox(1h);
  begin(mailbox);
  finish(mailbox);
  EXPECT_TRUE(isAwake(mailbox)) << "of the first";
  EXPECT_EQ(mailbox.takeFinished().size(), 1u);
  finish(mailbox);
  finish(mailbox);
  EXPECT_FALSE(isAwake(mailbox));
  finish(mailbox, true);
  EXPECT_TRUE(isAwake(mailbox)) << "of the last one of a job";
  EXPECT_EQ(mailbox.takeFinished().size(), 3u);
}

TEST(Mailbox, WakesTheNetworkForEachSlowTarget) {
  Mailbox mailbox(0ms);
  begin(mailbox);
  for (int n = 0; n < 3; ++n) {
    finish(mailbox);
    EXPECT_TRUE(isAwake(mailbox));
    EXPECT_EQ(mailbox.takeFinished().size(), 1u);
  }
}

}  // namespace
}  // namespace palpate
