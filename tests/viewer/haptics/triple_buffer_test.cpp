#include "viewer/haptics/triple_buffer.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "viewer/haptics/haptic_tick.hpp"

namespace palpate {
namespace {

TEST(TripleBuffer, GivesTheFirstValueUntilOneIsWritten) {
  TripleBuffer<int> buffer(7);
  EXPECT_EQ(buffer.read(), 7);
  buffer.write(8);
  EXPECT_EQ(buffer.read(), 8);
  EXPECT_EQ(buffer.read(), 8);
}

TEST(TripleBuffer, GivesTheLastOfManyValues) {
  TripleBuffer<int> buffer;
  for (int round = 1; round < 10; ++round) {
    for (int n = 1; n <= round; ++n) buffer.write(100 * round + n);
    EXPECT_EQ(buffer.read(), 101 * round);
  }
}

TEST(TripleBuffer, DoesNotOverwriteTheValueBeingRead) {
  TripleBuffer<int> buffer;
  buffer.write(1);
  const int& held = buffer.read();
  for (int n = 2; n < 100; ++n) buffer.write(n);
  EXPECT_EQ(held, 1);
  EXPECT_EQ(buffer.read(), 99);
}

/// A state whose numbers all follow from the tick.
HapticState stateOf(std::uint64_t tick) {
  const auto number = static_cast<double>(tick);
  HapticState state;
  state.tick = tick;
  state.time = number;
  state.force = state.tool = Eigen::Vector3d::Constant(number);
  state.touch.stiffness = Eigen::Matrix3d::Constant(number);
  state.passivity = number;
  return state;
}

TEST(TripleBuffer, NeverTearsAndNeverGoesBackBetweenTwoThreads) {
  TripleBuffer<HapticState> buffer(stateOf(0));
  constexpr std::uint64_t last = 300000;
  std::thread writer([&buffer] {
    for (std::uint64_t tick = 1; tick <= last; ++tick) buffer.write(stateOf(tick));
  });
  std::uint64_t seen = 0, torn = 0, back = 0;
  while (seen < last) {
    const HapticState& state = buffer.read();
    const HapticState whole = stateOf(state.tick);
    if (state.time != whole.time || state.force != whole.force || state.tool != whole.tool ||
        state.touch.stiffness != whole.touch.stiffness || state.passivity != whole.passivity)
      ++torn;
    if (state.tick < seen) ++back;
    seen = state.tick;
  }
  writer.join();
  EXPECT_EQ(torn, 0U);
  EXPECT_EQ(back, 0U);
}

}  // namespace
}  // namespace palpate
