#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "common/base/whole_file.hpp"
#include "tests/support/command.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/viewer/c_api/sample_file.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;

constexpr const char* examples = PALPATE_SOURCE_DIR "/deploy/examples";

std::string shellWord(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

std::string outputOf(const std::string& command) {
  const test::CommandResult result = test::runCommand(command);
  EXPECT_EQ(result.exit_code, 0) << command << '\n' << result.output;
  return result.output;
}

/// The sample as a body with the same stiffness in all directions. "tip" is a corner, and the
/// sample's own body is soft to one side, so that a tool would slide off.
test::SampleDataset springs() {
  constexpr double stiffness = 50;  // N/m
  test::SampleDataset sample;
  for (SpaceTable& space : sample.spaces)
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      PointRecord& point = space.points[static_cast<std::size_t>(n)];
      if (!isSolved(point.tag)) continue;
      const Eigen::Vector3d p = space.lattice.displacement(n);
      point.equilibrium.force = -stiffness * p;
      point.equilibrium.stiffness = -stiffness * Eigen::Matrix3d::Identity();
      point.equilibrium.energy = 0.5 * stiffness * p.squaredNorm();
    }
  return sample;
}

/// The examples as seen by a simulator's developer: libpalpate is installed in some folder, without
/// its sources.
class Examples : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    prefix_ = new test::TemporaryDirectory;
    for (const char* component : {"library", "development"})
      outputOf(PALPATE_INSTALL_COMMAND " --component " + std::string(component) + " --prefix " +
               shellWord(prefix_->path()));
  }
  static void TearDownTestSuite() {
    delete prefix_;
    prefix_ = nullptr;
  }

  void SetUp() override {
    if (std::string_view(PALPATE_SANITIZERS) != "")
      GTEST_SKIP() << "programs without the sanitizer cannot load a library with it";
    for (const auto& entry : std::filesystem::recursive_directory_iterator(prefix_->path())) {
      if (entry.path().filename() == "libpalpate.so") library_ = entry.path();
      if (entry.path().filename() == "palpate.pc") package_ = entry.path();
    }
    ASSERT_FALSE(library_.empty());
    ASSERT_FALSE(package_.empty());
    sample_ = std::make_unique<test::SampleFile>(springs());
  }

  /// Expects forces in an example's output; the first must be that of `palpate query`.
  void expectForces(const std::string& output) {
    EXPECT_THAT(output, HasSubstr("touching"));
    std::istringstream in(output);
    std::string line;
    while (std::getline(in, line) && !line.starts_with("query ")) {
    }
    std::istringstream words(line);
    std::string word, name, force;
    std::array<std::string, 3> displacement, forces;
    words >> word >> name >> displacement[0] >> displacement[1] >> displacement[2] >> force >>
        forces[0] >> forces[1] >> forces[2];
    ASSERT_EQ(force, "force") << output;
    const auto answer = nlohmann::json::parse(
        outputOf(PALPATE_BIN_DIR "/palpate query " + shellWord(sample_->path()) +
                 " --json --active " + name + " --displacement " + displacement[0] + " " +
                 displacement[1] + " " + displacement[2]));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_EQ(std::strtod(forces[i].c_str(), nullptr), answer["force"][i].get<double>()) << line;
      EXPECT_EQ(std::strtod(displacement[i].c_str(), nullptr),
                answer["displacement"][i].get<double>());
    }
    EXPECT_NE(answer["force"][0].get<double>(), 0);
  }

  static test::TemporaryDirectory* prefix_;
  test::TemporaryDirectory build_;
  std::filesystem::path library_, package_;
  std::unique_ptr<test::SampleFile> sample_;
};
test::TemporaryDirectory* Examples::prefix_ = nullptr;

TEST_F(Examples, InitializedStructuresCompileWithoutWarningsInCAndCpp) {
  const std::filesystem::path source = build_ / "begin.c";
  std::ofstream(source) << "#include <palpate.h>\n"
                           "int main(void) {\n"
                           "  static palpate_answers answers = PALPATE_INIT(palpate_answers);\n"
                           "  palpate_touch touch = PALPATE_INIT(palpate_touch);\n"
                           "  palpate_sample sample = PALPATE_INIT(palpate_sample);\n"
                           "  return !(answers.size == sizeof answers && !answers.forces &&\n"
                           "           touch.size == sizeof touch && touch.gap == 0 &&\n"
                           "           sample.size == sizeof sample && sample.inside == 0);\n"
                           "}\n";
  for (const char* compiler : {"cc -std=c99", "c++ -std=c++11 -x c++", "c++ -std=c++20 -x c++"})
    outputOf(std::string(compiler) + " -Wall -Wextra -Wpedantic -Wshadow -Werror -I " +
             shellWord(*prefix_ / "include") + " " + shellWord(source) + " -o " +
             shellWord(build_ / "begin") + " && " + shellWord(build_ / "begin"));
}

TEST_F(Examples, CExampleBuildsAndRunsAsDocumented) {
  const std::string manual = readText(PALPATE_SOURCE_DIR "/docs/client.md", "manual");
  const std::size_t line = manual.find("\ncc -std=c99 touch.c"),
                    fence = manual.rfind("```sh\n", line);
  ASSERT_NE(line, std::string::npos);
  std::string lines = manual.substr(fence + 6, manual.find("```", line) - fence - 6);
  for (const auto& [word, path] :
       {std::pair("PREFIX", prefix_->path()), std::pair("liver.h5", sample_->path())})
    for (std::size_t at = lines.find(word); at != std::string::npos; at = lines.find(word))
      lines.replace(at, std::string_view(word).size(), path.string());
  expectForces(outputOf("cd " + shellWord(build_.path()) + " && cp " +
                        shellWord(std::string(examples) + "/c/touch.c") + " . && " + lines));
}

TEST_F(Examples, CExampleBuildsWithCMake) {
  outputOf("cmake -S " + shellWord(std::string(examples) + "/c") + " -B " +
           shellWord(build_.path()) + " -DCMAKE_PREFIX_PATH=" + shellWord(prefix_->path()) +
           " && cmake --build " + shellWord(build_.path()));
  expectForces(outputOf(shellWord(build_ / "touch") + " " + shellWord(sample_->path()) + " 4"));
}

TEST_F(Examples, CExampleBuildsWithPkgConfigAndExplainsABadFile) {
  const std::string config =
      "PKG_CONFIG_PATH=" + shellWord(package_.parent_path()) + " pkg-config ";
  EXPECT_THAT(outputOf(config + "--modversion palpate"), HasSubstr(PALPATE_PROJECT_VERSION));
  outputOf("cc -std=c99 -Wall -Wextra -Wpedantic -Werror " +
           shellWord(std::string(examples) + "/c/touch.c") + " -o " + shellWord(build_ / "touch") +
           " $(" + config + "--cflags --libs palpate) -lm");
  const test::CommandResult result =
      test::runCommand("LD_LIBRARY_PATH=" + shellWord(library_.parent_path()) + " " +
                       shellWord(build_ / "touch") + " " + shellWord(build_ / "absent.h5"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr("absent.h5: there is no such dataset"));
}

TEST_F(Examples, PythonExampleRuns) {
  const std::string python =
      "PALPATE_LIBRARY=" + shellWord(library_) +
      " PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=" + shellWord(PALPATE_SOURCE_DIR "/deploy/python") +
      " /usr/bin/python3 ";
  expectForces(outputOf(python + shellWord(std::string(examples) + "/python/touch.py") + " " +
                        shellWord(sample_->path())));

  const std::string structures =
      outputOf(python +
               "-c 'from palpate import _library as c\n"
               "for n, s in sorted(vars(c).items()):\n"
               "  if isinstance(s, type) and issubclass(s, c._Sized) and s is not c._Sized:\n"
               "    print(n, c.ctypes.sizeof(s))'");
  std::string expected;
  for (const auto& [name, size] : {std::pair("Answers", sizeof(palpate_answers)),
                                   {"AreaInfo", sizeof(palpate_area_info)},
                                   {"ContactOptions", sizeof(palpate_contact_options)},
                                   {"DatasetInfo", sizeof(palpate_dataset_info)},
                                   {"GuardOptions", sizeof(palpate_guard_options)},
                                   {"GuardedForce", sizeof(palpate_guarded_force)},
                                   {"LiveInfo", sizeof(palpate_live_info)},
                                   {"LiveOptions", sizeof(palpate_live_options)},
                                   {"OpenOptions", sizeof(palpate_open_options)},
                                   {"Profile", sizeof(palpate_profile)},
                                   {"SpaceInfo", sizeof(palpate_space_info)},
                                   {"Touch", sizeof(palpate_touch)},
                                   {"Touches", sizeof(palpate_touches)}})
    expected += fmt::format("{} {}\n", name, size);
  EXPECT_EQ(structures, expected);
}

TEST_F(Examples, UnityExamplesRunUnderMono) {
  const std::filesystem::path program = build_ / "unity_sketch.exe", body = build_ / "finger.h5";
  test::FingerBody().seal(body);
  outputOf("mcs -unsafe -out:" + shellWord(program) + " " +
           shellWord(PALPATE_SOURCE_DIR "/tests/viewer/c_api/unity_sketch.cs") + " " +
           shellWord(std::string(examples) + "/unity/Palpate.cs") + " " +
           shellWord(std::string(examples) + "/unity/PalpateOrgan.cs"));
  const std::string output =
      outputOf("LD_LIBRARY_PATH=" + shellWord(library_.parent_path()) + " mono " +
               shellWord(program) + " " + shellWord(sample_->path()) + " " + shellWord(body));
  expectForces(output);
  EXPECT_THAT(output, HasSubstr("outward\n")) << "the winding of Unity's triangles";
  EXPECT_THAT(output, HasSubstr("component pressed\n"));
  const Eigen::Vector3d expected =
      test::FingerBody::force({0.0512, 0.0437, 0.1}, {0.003, -0.002, -0.009});
  Eigen::Vector3d force;
  int inside = 0;
  const std::size_t area = output.find("area ");
  ASSERT_NE(area, std::string::npos) << output;
  ASSERT_EQ(std::sscanf(output.c_str() + area, "area %lf %lf %lf inside %d", &force[0], &force[1],
                        &force[2], &inside),
            4)
      << output;
  EXPECT_TRUE(force.isApprox(expected, 0.02)) << force.transpose();
  EXPECT_EQ(inside, 1);
  for (const auto& [name, size] :
       {std::pair("DatasetInfo", sizeof(palpate_dataset_info)),
        std::pair("AreaInfo", sizeof(palpate_area_info)),
        std::pair("AreaSample", sizeof(palpate_area_sample)),
        std::pair("GuardOptions", sizeof(palpate_guard_options)),
        std::pair("GuardedForce", sizeof(palpate_guarded_force)),
        std::pair("Sample", sizeof(palpate_sample)), std::pair("Touch", sizeof(palpate_touch))})
    EXPECT_THAT(output, HasSubstr(fmt::format("size {} {}\n", name, size)));
}

TEST_F(Examples, AreInstalledWithTheLibraryAndNothingElse) {
  for (const char* file : {"c/touch.c", "c/CMakeLists.txt", "python/touch.py",
                           "python/force_curve.py", "unity/Palpate.cs", "unity/PalpateOrgan.cs"})
    EXPECT_TRUE(std::filesystem::exists(*prefix_ / "share/doc/palpate/examples" / file)) << file;
  const auto program =
      std::filesystem::status(*prefix_ / "share/doc/palpate/examples/python/touch.py");
  EXPECT_NE(program.permissions() & std::filesystem::perms::owner_exec,
            std::filesystem::perms::none);
  EXPECT_TRUE(std::filesystem::exists(*prefix_ / "include/palpate.h"));
  EXPECT_FALSE(std::filesystem::exists(*prefix_ / "bin"));
}

}  // namespace
}  // namespace palpate
