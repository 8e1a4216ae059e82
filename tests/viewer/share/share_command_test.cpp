#include "viewer/share/share_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "common/base/whole_file.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/touchable_body.hpp"
#include "viewer/fields/relative_error.hpp"
#include "viewer/share/organ_page.hpp"

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

struct ShareCommandTest : testing::Test {
  test::TemporaryDirectory directory;
  ShareOptions options{directory / "cube.h5", directory / "cube.html"};

  void seal(const std::string& name) const {
    const Mesh mesh = test::cubeMesh(0.1, 2);
    test::TouchableBody body(mesh, {{mesh.node_groups.at("zmax").front(), 1.0}});
    body.problem.scene.name = name;
    body.seal(options.dataset);
  }
  std::string told() const {
    std::ostringstream output;
    share(options, output);
    return output.str();
  }
};

TEST_F(ShareCommandTest, ThePageNeedsNoOtherFiles) {
  if (!hasPageField()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  seal("cube");
  EXPECT_THAT(told(), AllOf(HasSubstr("cube.html"), HasSubstr("MB")));
  const std::string page = readText(options.output, "page");
  EXPECT_THAT(page, AllOf(HasSubstr("<title>cube: touch it</title>"), Not(HasSubstr("http:")),
                          Not(HasSubstr("https:")), Not(HasSubstr(" src=")), Not(HasSubstr("{{"))));
}

TEST_F(ShareCommandTest, NamesAreEscaped) {
  if (!hasPageField()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  CarriedOrgan organ;
  organ.name = "</script><b>";
  EXPECT_THAT(organPage(organ), AllOf(HasSubstr("&lt;/script&gt;"), HasSubstr("\\u003c/script>"),
                                      Not(HasSubstr("</script><b>"))));
}

TEST_F(ShareCommandTest, ThePageContainsTheErrorThatAHandNotices) {
  if (!hasPageField()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  const std::string page = organPage({});
  const std::string begin = R"(<script id="facts" type="application/json">)";
  const std::size_t at = page.find(begin) + begin.size();
  const auto facts = nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
  EXPECT_EQ(facts.at("error").at("noticeable"), noticeable_force_error);
  EXPECT_EQ(facts.at("error").at("floor"), relative_error_floor);
}

TEST_F(ShareCommandTest, WithoutEmscriptenItSaysWhatToInstall) {
  if (hasPageField()) GTEST_SKIP() << "requires a build without Emscripten";
  seal("cube");
  test::expectError(ExitCode::failed, [&] { told(); },
                    {"Emscripten", "apt install emscripten", "build palpate"});
  EXPECT_FALSE(std::filesystem::exists(options.output));
}

TEST_F(ShareCommandTest, APageReportsAFailedStartWithoutItsOwnScript) {
  if (!hasPageField()) GTEST_SKIP() << "NOT TESTED: built without Emscripten (Debian: emscripten)";
  seal("cube");
  told();
  const std::string page = readText(options.output, "page");
  const std::string trouble = page.substr(0, page.find("<body>"));
  EXPECT_THAT(trouble, HasSubstr("window.onerror"));
  // Syntax that browsers of 1999 do not read.
  for (const char* newer : {"=>", "`", "const ", "let ", "class ", "..."})
    EXPECT_THAT(trouble.substr(trouble.find("<script>")), Not(HasSubstr(newer)));
}

TEST_F(ShareCommandTest, ThePageDoesNotReplaceTheDataset) {
  seal("cube");
  const std::string before = readText(options.dataset, "dataset");
  options.output = directory / "." / "cube.h5";
  test::expectError(ExitCode::usage, [&] { told(); },
                    {"-o", "cube.h5, which would be overwritten", "name another file"});
  EXPECT_EQ(readText(options.dataset, "dataset"), before);
}

TEST_F(ShareCommandTest, AFileThatIsNotADatasetIsRefusedAndLeavesNoPage) {
  std::ofstream(options.dataset) << "nothing";
  test::expectError(ExitCode::usage, [&] { told(); }, {"cube.h5"});
  EXPECT_FALSE(std::filesystem::exists(options.output));
  options.output = directory / "nowhere" / "cube.html";
  test::expectError(ExitCode::failed, [&] { told(); }, {"nowhere"});
}

}  // namespace
}  // namespace palpate
