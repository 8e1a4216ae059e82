#include "scheduler/service/result_check.hpp"

#include <gtest/gtest.h>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/causes.hpp"

namespace palpate {
namespace {

/// limit_point was appended once and the largest cause that is let through was not: a result with
/// it would have been dropped, and asked for again, for ever.
TEST(ResultCheck, TakesFailuresOfEveryCauseThatStopsTransitions) {
  const Problem problem = test::cubeProblem();
  const ResultCheck check(problem);
  wire::Result result;
  result.set_build(std::string(problemId(problem).bytes()));
  result.set_kernel_family("baseline");
  for (const Cause cause : test::allCauses()) {
    result.mutable_failure()->set_cause(static_cast<std::uint32_t>(cause));
    EXPECT_EQ(check.objectionTo(result, "", "baseline").empty(), stopsTransitions(cause))
        << name(cause);
  }
}

}  // namespace
}  // namespace palpate
