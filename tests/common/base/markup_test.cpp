#include "common/base/markup.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Markup, TextCannotBecomeTags) {
  EXPECT_EQ(escaped("<a href=\"x\">&'"), "&lt;a href=&quot;x&quot;&gt;&amp;&#39;");
}

TEST(Markup, TextInJsonCannotEndItsScript) {
  EXPECT_EQ(scriptJson("[\"</script><b>\"]"), "[\"\\u003c/script>\\u003cb>\"]");
}

TEST(Markup, ValuesReplaceTheirNamesAndAreNotExpandedAgain) {
  EXPECT_EQ(filledMarkup("<p>{{a}} and {{b}}</p>{}", {{"a", "{{b}}"}, {"b", "2"}}),
            "<p>{{b}} and 2</p>{}");
}

}  // namespace
}  // namespace palpate
