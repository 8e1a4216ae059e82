#include "common/scene/key_line.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

constexpr const char* text = R"(name = "organ"
mesh = "organ.msh"   # [fixed]

[material]
c10 = 1300
[[region]]
group = "vessel"
[ fixed ]
below.fraction = 0.15
group = "base"
[[active]]
name = "tip"
radius = 3
[[active]]
name = "rim"
radius = 4
[workspace]
radius = 5
)";

TEST(KeyLine, IsThatOfTheTableOrKeyThatASentenceBeginsWith) {
  EXPECT_EQ(lineOfKey(text, "[fixed] selects no node"), 8u);
  EXPECT_EQ(lineOfKey(text, "fixed.group: there is no \"base\""), 10u);
  EXPECT_EQ(lineOfKey(text, "fixed.below selects no node"), 9u);
  EXPECT_EQ(lineOfKey(text, "region.group: there is no \"vessel\""), 7u);
  EXPECT_EQ(lineOfKey(text, "workspace.radius = 5 m is more than"), 18u);
  EXPECT_EQ(lineOfKey(text, "mesh = \"organ.msh\": there is no such file"), 2u);
  EXPECT_EQ(lineOfKey(text, "the mesh is 200 m wide"), 2u);
}

TEST(KeyLine, FindsNamesInEitherKindOfQuotes) {
  const char* const single = "[[active]]\nname = 'tip'\n[[active]]\nname = 'rim'\n";
  EXPECT_EQ(lineOfKey(single, "active \"rim\": node 3 is fixed"), 4u);
}

TEST(KeyLine, IsThatOfTheActiveNodeOfThatName) {
  EXPECT_EQ(lineOfKey(text, "active \"rim\": node 3 is fixed"), 15u);
  EXPECT_EQ(lineOfKey(text, "active \"skin-12\": node 3 is fixed"), 11u) << "the first table";
}

TEST(KeyLine, OfSeveralTablesIsThatWhoseValueIsNamedOrNone) {
  constexpr const char* two =
      "[[region]]\ngroup = \"body\"\nmu = 1\n[[region]]\ngroup = \"tumour\"\nmu = -1\n";
  EXPECT_EQ(lineOfKey(two, "region.group: there is no \"tumour\", there is \"liver\""), 5u);
  EXPECT_EQ(lineOfKey(two, "region.mu = -1: must be positive"), 0u);
}

TEST(KeyLine, IsThatOfTheTableWhereTheKeyIsLeftOut) {
  EXPECT_EQ(lineOfKey(text, "workspace.spacing: 3"), 17u);
}

TEST(KeyLine, IsNoneOfWhatIsNotThere) {
  EXPECT_EQ(lineOfKey(text, "gravity.acceleration: 3"), 0u);
  EXPECT_EQ(lineOfKey(text, "something else: happened"), 0u);
  EXPECT_EQ(lineOfKey("", "[fixed] selects no node"), 0u);
  EXPECT_EQ(lineOfKey(text, ""), 0u);
}

}  // namespace
}  // namespace palpate
