#include "viewer/answers/force_answers.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::expectBadInput;

TEST(ForceAnswers, UseTheRequestedMethod) {
  const test::TemporaryDirectory directory;
  const test::SampleDataset sample;
  sample.seal(directory / "sample.h5");
  const Dataset dataset(directory / "sample.h5");
  for (const std::string& method : forceFieldMethods()) {
    const ForceAnswers answers(dataset, "edge-2", false, method);
    EXPECT_EQ(answers.method(), method);
    EXPECT_EQ(answers.workspaceRadius(), 0.02);
    const Vector3d p(0.003, -0.004, 0.002);
    const ForceAnswer answer = answers.answer({std::nullopt, p});
    EXPECT_EQ(answer.sample.force, makeForceField(method, sample.spaces[1])->evaluate(p).force);
    EXPECT_FALSE(answer.finger.has_value());
  }
  expectBadInput([&] { ForceAnswers(dataset, "", false, "potential"); }, {"tip, edge-2"});
  expectBadInput([&] { ForceAnswers(dataset, "tip", false, "cubic"); }, {"cubic"});
  expectBadInput([&] { ForceAnswers(dataset, "tip", true, "potential"); }, {"not a finger"});
}

TEST(ForceAnswers, ForAFingerAreThoseOfItsAreaAtTheNearestPoint) {
  const test::TemporaryDirectory directory;
  const test::FingerBody body;
  body.seal(directory / "finger.h5");
  const Dataset dataset(directory / "finger.h5");
  const ForceAnswers answers(dataset, "top", true, "potential");
  const Vector3d s(0.0512, 0.0437, 0.1), p(0.003, -0.002, -0.009);
  const ForceAnswer answer = answers.answer({s + Vector3d(0, 0, 0.004), p});
  EXPECT_TRUE(answer.finger.value().at.isApprox(s, 1e-12));
  EXPECT_TRUE(answer.sample.force.isApprox(test::FingerBody::force(s, p), 0.02));
  EXPECT_TRUE(answer.sample.inside);
  EXPECT_NEAR(answer.finger->distance, 0.004, 1e-12);
  const ForceAnswer away = answers.answer({s + Vector3d(0, 0, 0.01), p});
  EXPECT_EQ(away.sample.force, answer.sample.force);
  EXPECT_FALSE(away.sample.inside);
  EXPECT_EQ(away.finger->fault, FingerPlace::Fault::away);
  EXPECT_EQ(answers.answer({Vector3d(0.05, 0.05, 0), p}).finger->fault,
            FingerPlace::Fault::no_site);
  expectBadInput([&] { ForceAnswers(dataset, "top", false, "potential"); }, {"--at X Y Z"});
  expectBadInput([&] { ForceAnswers(dataset, "top", true, "trilinear"); }, {"only potential"});
}

// Regression: one place prepared all sites of its surface, 280 for a liver.
TEST(ForceAnswers, ForFewPlacesPrepareFewSites) {
  const test::TemporaryDirectory directory;
  test::FingerBody().seal(directory / "finger.h5");
  const Dataset dataset(directory / "finger.h5");
  const ForceAnswers answers(dataset, "top", true, "potential");
  EXPECT_EQ(answers.preparedSites(), 0u);
  std::size_t before = 0;
  for (const Vector3d& s : {Vector3d(0.02, 0.02, 0.1), Vector3d(0.021, 0.02, 0.1)}) {
    answers.answer({s, {0.003, -0.002, -0.009}});
    EXPECT_LT(answers.preparedSites(), dataset.spaces().size());
    EXPECT_GE(answers.preparedSites(), before);
    before = answers.preparedSites();
  }
}

}  // namespace
}  // namespace palpate
