#include "viewer/answers/force_answers.hpp"

#include <gtest/gtest.h>

#include "common/problem/sites.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::expectBadInput;

TEST(ForceAnswers, AreThoseOfTheMethodThatWasAskedFor) {
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
  expectBadInput([&] { ForceAnswers(dataset, "tip", true, "potential"); }, {"no finger"});
}

TEST(ForceAnswers, OfAFingerAreThoseOfItsAreaAtThePlaceNearest) {
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

// A place once had all sites of its surface prepared, 280 of a liver.
TEST(ForceAnswers, OfFewPlacesPrepareFewSitesAndSayWhatTheWholeAreaDoes) {
  const test::TemporaryDirectory directory;
  const test::FingerBody body;
  body.seal(directory / "finger.h5");
  const Dataset dataset(directory / "finger.h5");
  const auto sites = chosenOf(dataset.spaces(), chooseActive(dataset.scene(), "top").spaces);
  const auto surface = placesAround(dataset.mesh(), centersOf(sites), 0.02);
  const AreaField whole(sites, surface);
  const ForceAnswers answers(dataset, "top", true, "potential");
  EXPECT_EQ(answers.preparedSites(), 0u);
  const Vector3d p(0.003, -0.002, -0.009);
  std::size_t before = 0;
  for (const Vector3d& s : {Vector3d(0.02, 0.02, 0.1), Vector3d(0.021, 0.02, 0.1)}) {
    const ForceAnswer answer = answers.answer({s, p});
    const AreaSample expected = whole.evaluate(answer.finger.value().at, p);
    EXPECT_EQ(answer.sample.force, expected.force);
    EXPECT_EQ(answer.sample.stiffness, expected.stiffness);
    EXPECT_EQ(answer.sample.energy, expected.energy);
    EXPECT_EQ(answer.sample.error_bound, expected.error_bound);
    EXPECT_EQ(answer.sample.coverage, expected.coverage);
    EXPECT_LT(answers.preparedSites(), sites.size());
    EXPECT_GE(answers.preparedSites(), before);
    before = answers.preparedSites();
  }
}

}  // namespace
}  // namespace palpate
