#include "viewer/picture/body_view.hpp"

#include <gtest/gtest.h>

#include "tests/viewer/haptics/touched_model.hpp"

namespace palpate {
namespace {

TEST(VertexErrors, AreKnownOnTheTouchableSurfaceOnly) {
  const test::TemporaryDirectory directory;
  test::TouchableBody(test::cubeMesh(0.1, 4), {{112}}).seal(directory / "body.h5");
  const HapticModel model{Dataset(directory / "body.h5")};
  const std::vector<double> errors = vertexErrors(model, 0);
  ASSERT_EQ(errors.size(), model.surface().vertices().size());
  int known = 0;
  for (std::size_t v = 0; v < errors.size(); ++v) {
    bool touchable = false;
    for (const std::int32_t t : model.surface().trianglesAt(static_cast<std::int32_t>(v)))
      touchable |= model.surface().touchable(t);
    EXPECT_EQ(std::isfinite(errors[v]), touchable) << v;
    if (!touchable) continue;
    EXPECT_GE(errors[v], 0);
    ++known;
  }
  EXPECT_GT(known, 3);
  EXPECT_LT(known, std::ssize(errors));
}

}  // namespace
}  // namespace palpate
