#include "viewer/export/export_target.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;

struct ExportTargetTest : testing::Test {
  test::TemporaryDirectory directory;
  std::filesystem::path dataset = directory / "organ.h5";
  ExportTargetTest() { touch(dataset); }
  static void touch(const std::filesystem::path& file) { std::ofstream(file) << "something"; }
};

TEST_F(ExportTargetTest, TheExtensionSelectsTheFormat) {
  EXPECT_EQ(ExportTarget("a.vtu").format(), ExportFormat::vtu);
  EXPECT_EQ(ExportTarget("a.b.pvd").format(), ExportFormat::pvd);
  EXPECT_EQ(ExportTarget("a.csv").format(), ExportFormat::csv);
  for (const char* file : {"a.vtk", "a", ".vtu", "a.h5", "a.vtkhdf", "a.VTU", ""})
    expectBadInput([&] { ExportTarget{file}; },
                   {std::string("-o ") + file, ".vtu", ".pvd", ".csv"});
}

TEST_F(ExportTargetTest, AnExistingFileIsKeptUnlessItMayBeReplaced) {
  const ExportTarget target(directory / "touch.vtu");
  target.refuseWhatIsThere(dataset, false);
  touch(target.file());
  expectBadInput([&] { target.refuseWhatIsThere(dataset, false); },
                 {"touch.vtu already exists", "--replace"});
  target.refuseWhatIsThere(dataset, true);
  for (const char* folder : {"folder.vtu", "folder.pvd"}) {
    std::filesystem::create_directory(directory / folder);
    expectBadInput([&] { ExportTarget(directory / folder).refuseWhatIsThere(dataset, true); },
                   {folder, "folder"});
  }
}

TEST_F(ExportTargetTest, TheDatasetIsNeverReplaced) {
  const std::filesystem::path named_so = directory / "organ.vtu";
  std::filesystem::create_hard_link(dataset, named_so);
  expectBadInput([&] { ExportTarget(named_so).refuseWhatIsThere(dataset, true); },
                 {"which would be overwritten"});
}

TEST_F(ExportTargetTest, ASeriesHasANameThatXmlCanHold) {
  EXPECT_EQ(ExportTarget("new\nway.pvd").nameInSeries(0), "new?way/new?way_0000.vtu");
  EXPECT_EQ(ExportTarget("Weg ä.pvd").nameInSeries(0), "Weg ä/Weg ä_0000.vtu");
}

TEST_F(ExportTargetTest, ASeriesHasAFolderOfItsName) {
  const ExportTarget target(directory / "press.pvd");
  EXPECT_EQ(target.seriesFile(7), directory / "press/press_0007.vtu");
  EXPECT_EQ(target.nameInSeries(12345), "press/press_12345.vtu");
  std::filesystem::create_directory(directory / "press");
  target.refuseWhatIsThere(dataset, false);
  touch(directory / "press/notes.txt");
  expectBadInput([&] { target.refuseWhatIsThere(dataset, false); }, {"press", "--replace"});
  target.refuseWhatIsThere(dataset, true);
  const ExportTarget other(directory / "file.pvd");
  touch(directory / "file");
  test::expectError(ExitCode::failed, [&] { other.beginSeries(); }, {"file", "folder"});
}

TEST_F(ExportTargetTest, AShorterSeriesRemovesOnlyTheFilesOfALongerOne) {
  const ExportTarget target(directory / "press.pvd");
  target.beginSeries();
  for (std::size_t n = 0; n < 4; ++n) touch(target.seriesFile(n));
  touch(directory / "press/press_.vtu");
  touch(directory / "press/press_3b.vtu");
  touch(directory / "press/pressed_0003.vtu");
  touch(target.file());
  target.beginSeries();
  EXPECT_FALSE(std::filesystem::exists(target.file())) << "the list goes first";
  target.endSeries(2);
  EXPECT_TRUE(std::filesystem::exists(target.seriesFile(1)));
  EXPECT_FALSE(std::filesystem::exists(target.seriesFile(2)));
  EXPECT_FALSE(std::filesystem::exists(target.seriesFile(3)));
  for (const char* other : {"press_.vtu", "press_3b.vtu", "pressed_0003.vtu"})
    EXPECT_TRUE(std::filesystem::exists(directory / "press" / other)) << other;
}

}  // namespace
}  // namespace palpate
