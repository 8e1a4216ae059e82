#include "common/space/configuration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "common/space/tag.hpp"
#include "tests/support/causes.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using test::expectError;

TEST(NodalFields, RoundTripWithAndWithoutPressure) {
  const NodalFields displaced = {{1, 2, 3, -4, 5e-9F, 6}, {}};
  const NodalFields mixed = {displaced.displacement, {7.5F, -8}};
  for (const NodalFields& fields : {displaced, mixed}) {
    const NodalFields again = NodalFields::decode(fields.encode(), 2, fields.pressure.size());
    EXPECT_EQ(again.displacement, fields.displacement);
    EXPECT_EQ(again.pressure, fields.pressure);
    EXPECT_EQ(again.id(), fields.id());
  }
  EXPECT_NE(displaced.id(), mixed.id());
}

TEST(NodalFields, RefuseEveryOtherLength) {
  const std::string bytes = NodalFields{{1, 2, 3, 4, 5, 6}, {7, 8}}.encode();
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    expectError(ExitCode::failed, [&] { NodalFields::decode(bytes.substr(0, length), 2, 2); },
                {"2 nodes"});
  }
}

TEST(NodalFields, RefuseValuesThatAreNotFinite) {
  const std::string in_displacement = NodalFields{{1, NAN, 3}, {}}.encode();
  const std::string in_pressure = NodalFields{{1, 2, 3}, {INFINITY}}.encode();
  expectError(ExitCode::failed, [&] { NodalFields::decode(in_displacement, 1, 0); },
              {"not finite"});
  expectError(ExitCode::failed, [&] { NodalFields::decode(in_pressure, 1, 1); }, {"not finite"});
}

TEST(Tag, WordsAreTheFourOfThePaper) {
  for (const auto& [tag, word] : {std::pair{Tag::unknown, "unknown"},
                                  {Tag::expandable, "expandable"},
                                  {Tag::terminating, "terminating"},
                                  {Tag::failed, "failed"}}) {
    EXPECT_EQ(name(tag), word);
    EXPECT_EQ(tagOf(static_cast<std::uint32_t>(tag)), tag);
  }
  EXPECT_FALSE(tagOf(4));
}

TEST(Cause, EachHasAUniqueWordThatBeginsItsDescription) {
  std::set<std::string_view> words;
  for (const Cause cause : test::allCauses()) {
    EXPECT_TRUE(words.insert(name(cause)).second) << name(cause);
    const std::string text = describe(Failure{.cause = cause});
    EXPECT_TRUE(cause == Cause::none || text.starts_with(name(cause))) << text;
    EXPECT_FALSE(text.ends_with(": ")) << text;
  }
  EXPECT_EQ(causeOf(10), Cause::limit_point);
  EXPECT_EQ(causeOf(11), Cause::beyond_force);
}

TEST(Cause, UnknownValuesHaveNoCause) {
  for (const std::uint32_t value : {200u, 256u, 266u, ~0u}) EXPECT_FALSE(causeOf(value)) << value;
  EXPECT_EQ(causeNamed("limit_point"), Cause::limit_point);
  EXPECT_FALSE(causeNamed(""));
  EXPECT_FALSE(causeNamed("bad_luck"));
}

TEST(Outcome, AFailureHasNoForcesAndAConfigurationNoCause) {
  const Outcome failed = {Failure{.cause = Cause::step_budget}, {}};
  EXPECT_FALSE(failed.converged());
  EXPECT_THROW(failed.equilibrium(), std::bad_variant_access);
  const Outcome reached = {Configuration{}, {}};
  EXPECT_TRUE(reached.converged());
  EXPECT_THROW(reached.failure(), std::bad_variant_access);
}

}  // namespace
}  // namespace palpate
