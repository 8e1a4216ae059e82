#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/mesh/mesh_reader.hpp"
#include "common/scene/scene.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/shell_script.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/worker/meshing/surfaces.hpp"

// `palpate mesh` and `palpate new`, called as by users.

namespace palpate {
namespace {

using test::CommandResult;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class MeshCommand : public ::testing::Test {
 protected:
  CommandResult worker(const std::string& arguments, const std::string& environment = "") {
    return test::runCommand("cd '" + directory.path().string() + "' && " + environment +
                            " '" PALPATE_BIN_DIR "/palpate-worker' " + arguments);
  }
  std::string content(const std::string& name) const { return test::bytesIn(directory / name); }
  /// Expects `palpate check` to print the summary of a scene without warnings.
  void expectSoundScene(const std::string& scene) {
    const CommandResult checked =
        worker("check " + scene, "env -u OPENBLAS_CORETYPE -u OPENBLAS_L2_SIZE");
    EXPECT_EQ(checked.exit_code, 0) << checked.output;
    EXPECT_THAT(checked.output, Not(HasSubstr("warning")));
    EXPECT_THAT(checked.output, HasSubstr("sites of a finger"));
  }
  test::TemporaryDirectory directory;
};

TEST_F(MeshCommand, MakesASceneFromAnStlThatCheckFindsSound) {
  PALPATE_NEEDS(test::hasProgram("gmsh"), "gmsh");
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  test::writeStl(test::sphereSurface(60, 8), directory / "organ.stl");
  const CommandResult meshed = worker("mesh organ.stl -o organ.msh --nodes 500");
  EXPECT_EQ(meshed.exit_code, 0) << meshed.output;
  EXPECT_THAT(meshed.output,
              AllOf(HasSubstr("768 triangles, closed"), HasSubstr("group      \"body\""),
                    HasSubstr("unit       millimetres, guessed"),
                    HasSubstr("next: palpate new organ --mesh organ.msh")));
  const CommandResult made = worker("new organ --mesh organ.msh");
  EXPECT_EQ(made.exit_code, 0) << made.output;
  EXPECT_THAT(made.output, AllOf(HasSubstr("finger     radius"), Not(HasSubstr("warning")),
                                 HasSubstr("next: palpate check organ/scene.toml")));
  EXPECT_EQ(content("organ/organ.msh"), content("organ.msh"));
  EXPECT_THAT(content("organ/scene.toml"), HasSubstr("length_unit = \"mm\""));
  expectSoundScene("organ/scene.toml");
}

TEST_F(MeshCommand, ProposesSoundScenesForABoxAndTheShippedLiver) {
  test::writeGmsh22(test::boxMesh({0.12, 0.08, 0.06}, {9, 6, 5}), directory / "box.msh");
  std::filesystem::copy_file(std::string(PALPATE_SOURCE_DIR) + "/deploy/scenes/liver/liver-500.msh",
                             directory / "liver.msh");
  for (const char* name : {"box", "liver"}) {
    SCOPED_TRACE(name);
    const CommandResult made =
        worker("new " + std::string(name) + " --mesh " + name + ".msh --unit m");
    EXPECT_EQ(made.exit_code, 0) << made.output;
    expectSoundScene(std::string(name) + "/scene.toml");
  }
}

TEST_F(MeshCommand, WarnsOfTriangleCountsThatTakeAMinute) {
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  test::writeBinaryStl(test::sphereSurface(60, 130), directory / "organ.stl");
  // The warning comes before the meshing, which is impossible with this size.
  const CommandResult meshed = worker("mesh organ.stl -o organ.msh --size 1000");
  EXPECT_EQ(meshed.exit_code, 2) << meshed.output;
  EXPECT_THAT(meshed.output,
              AllOf(HasSubstr("organ.stl: filling 202800 triangles"), HasSubstr("MeshLab")));
}

TEST_F(MeshCommand, ConvertsAMeshAndKeepsItsNumbers) {
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  std::ofstream(directory / "one.inp") << "*NODE\n1, 0, 0, 0\n2, 30, 0, 0\n3, 0, 30, 0\n"
                                          "4, 0, 0, 30\n*ELEMENT, TYPE=C3D4, ELSET=all\n"
                                          "1, 1, 2, 3, 4\n";
  const CommandResult converted = worker("mesh one.inp -o one.msh");
  EXPECT_EQ(converted.exit_code, 0) << converted.output;
  EXPECT_THAT(converted.output, AllOf(HasSubstr("(30 cm wide in centimetres, and 3 cm"),
                                      HasSubstr("change with --unit")));
  EXPECT_EQ(readGmsh(directory / "one.msh").nodes[1], Eigen::Vector3d(30, 0, 0));
  EXPECT_THAT(worker("mesh one.inp -o one.msh --unit mm").output,
              AllOf(HasSubstr("to (0.03, 0.03, 0.03) m"),
                    HasSubstr("next: palpate new one --mesh one.msh --unit mm\n")));
  EXPECT_THAT(worker("mesh one.inp -o 'my one.msh'").output,
              HasSubstr("next: palpate new 'my one' --mesh 'my one.msh'\n"));
  EXPECT_THAT(worker("mesh one.inp -o one.msh --unit m").output,
              AllOf(HasSubstr("30 wide, which in metres is not"), HasSubstr("--unit cm fits"),
                    Not(HasSubstr("next:"))));
  const CommandResult refused = worker("mesh one.inp -o other.msh --nodes 100");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("has tetrahedra, which are not changed"));
}

TEST_F(MeshCommand, RefusesImpossibleOptionsBeforeMeshing) {
  test::writeStl(test::sphereSurface(60, 2), directory / "organ.stl");
  for (const auto& [arguments, words] :
       {std::pair("mesh organ.stl -o organ.vtu", "give it the extension .msh"),
        std::pair("mesh none.stl -o organ.msh", "none.stl: there is no such file"),
        std::pair("mesh . -o organ.msh", "is a folder"),
        std::pair("mesh organ.stl -o organ.msh --unit inch", "m, cm or mm"),
        std::pair("mesh organ.stl -o organ.msh --nodes 2", "--nodes"),
        std::pair("mesh organ.stl -o organ.msh --nodes 100 --size 3", "--nodes"),
        std::pair("mesh organ.stl -o organ.msh --mesher netgen", "--mesher"),
        std::pair("new organ --mesh organ.stl", "palpate mesh organ.stl -o organ.msh"),
        std::pair("new organ --mesh 'my organ.stl'",
                  "palpate mesh 'my organ.stl' -o 'my organ.msh'"),
        std::pair("new organ --mesh none.msh", "No such file"),
        std::pair("new organ.stl --mesh none.msh", "is a file")}) {
    const CommandResult refused = worker(arguments);
    EXPECT_EQ(refused.exit_code, 2) << arguments;
    EXPECT_THAT(refused.output, HasSubstr(words)) << arguments;
  }
  std::filesystem::create_directory(directory / "made");
  std::ofstream(directory / "made/scene.toml") << "mine";
  EXPECT_THAT(worker("new made --mesh none.msh").output, HasSubstr("this scene exists already"));
  EXPECT_EQ(content("made/scene.toml"), "mine");
  EXPECT_EQ(worker("mesh organ.stl -o nowhere/organ.msh").exit_code, 1);
  std::filesystem::create_directory(directory / "folder.msh");
  EXPECT_THAT(worker("mesh organ.stl -o folder.msh").output, HasSubstr("is a folder"));
  EXPECT_THAT(worker("mesh organ.stl -o organ.msh --straight").output, HasSubstr("is a surface"));
}

TEST_F(MeshCommand, LeavesNoFileAndKeepsAnOlderMeshIfItRefusesTheInput) {
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  std::ofstream(directory / "open.off") << "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  std::ofstream(directory / "brick.inp") << "*NODE\n1, 0, 0, 0\n"
                                            "*ELEMENT, TYPE=C3D8\n1, 1, 1, 1, 1, 1, 1, 1, 1\n";
  std::ofstream(directory / "flat.inp") << "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n"
                                           "4, 1, 1, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";
  std::ofstream(directory / "old.msh") << "mine";
  for (const std::string input : {"open.off", "brick.inp", "flat.inp"}) {
    for (const char* output : {"new.msh", "old.msh"})
      EXPECT_EQ(worker("mesh " + input + " -o " + output).exit_code, 2) << input;
    EXPECT_FALSE(std::filesystem::exists(directory / "new.msh")) << input;
    EXPECT_EQ(content("old.msh"), "mine") << input;
  }
}

TEST_F(MeshCommand, ProposesNoOtherFingerForABodyThatIsThinEverywhere) {
  test::writeGmsh22(test::boxMesh({0.06, 0.06, 0.004}, {6, 6, 1}), directory / "plate.msh");
  const CommandResult made = worker("new plate --mesh plate.msh");
  EXPECT_EQ(made.exit_code, 0) << made.output;
  EXPECT_THAT(made.output,
              AllOf(HasSubstr("around a thin lobe"), Not(HasSubstr("another finger"))));
}

TEST_F(MeshCommand, ProposesNoOtherFingerForAReportedPatch) {
  PALPATE_REFERENCE_FILE(patch, "cases/reports/k17_patch.msh");
  const CommandResult made = worker("new patch --mesh '" + patch.string() + "'");
  EXPECT_EQ(made.exit_code, 0) << made.output;
  EXPECT_THAT(made.output,
              AllOf(HasSubstr("around a thin lobe"), Not(HasSubstr("another finger"))));
}

/// Without this note, users would not see why the scene fixes another part than their group
/// "fixed".
TEST_F(MeshCommand, NamesGroupsWithoutElementsInANewScene) {
  Mesh box = test::boxMesh({0.12, 0.08, 0.06}, {4, 3, 2});
  box.node_groups["fixed"] = {};
  test::writeGmsh22(box, directory / "old.msh");
  test::writeGmsh41(box, directory / "box.msh");
  for (const char* name : {"old", "box"}) {
    const CommandResult made = worker("new " + std::string(name) + " --mesh " + name + ".msh");
    EXPECT_EQ(made.exit_code, 0) << made.output;
    EXPECT_THAT(made.output, AllOf(HasSubstr("\"fixed\""), Not(HasSubstr("\"xmin\"")))) << name;
  }
}

TEST_F(MeshCommand, DoesNotChangeAMeshInTheFolderOfANewScene) {
  test::writeGmsh22(test::boxMesh({0.12, 0.08, 0.06}, {9, 6, 5}), directory / "box.msh");
  std::filesystem::create_directory(directory / "organ");
  std::ofstream(directory / "organ/box.msh") << "mine";
  const CommandResult refused = worker("new organ --mesh box.msh");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("organ/box.msh: a different mesh"));
  EXPECT_EQ(content("organ/box.msh"), "mine");
  std::filesystem::copy_file(directory / "box.msh", directory / "organ/box.msh",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(worker("new organ --mesh box.msh").exit_code, 0);
}

TEST_F(MeshCommand, WritesASceneUnderAGivenName) {
  test::writeGmsh22(test::boxMesh({0.12, 0.08, 0.06}, {4, 3, 2}), directory / "box.msh");
  EXPECT_THAT(worker("new skin.toml --mesh box.msh").output,
              HasSubstr("next: palpate check skin.toml"));
  EXPECT_EQ(readScene(directory / "skin.toml").name, "skin");
  EXPECT_EQ(worker("new made/skin.toml --mesh box.msh").exit_code, 0);
  EXPECT_EQ(content("made/box.msh"), content("box.msh"));
  EXPECT_THAT(worker("new skin.toml --mesh box.msh").output,
              HasSubstr("skin.toml: this scene exists already"));
}

TEST_F(MeshCommand, RefusesFilesThatASceneCannotName) {
  test::writeGmsh22(test::boxMesh({0.12, 0.08, 0.06}, {9, 6, 5}), directory / "a\"b.msh");
  EXPECT_THAT(worker("mesh a.inp -o 'a\"b.msh'").output,
              HasSubstr("-o a\"b.msh: a scene cannot name this file"));
  const CommandResult refused = worker("new organ --mesh 'a\"b.msh'");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, HasSubstr("a scene cannot name this file; rename it"));
  std::filesystem::rename(directory / "a\"b.msh", directory / "Nierenlänge 1.msh");
  EXPECT_EQ(worker("new organ --mesh 'Nierenlänge 1.msh'").exit_code, 0);
  EXPECT_EQ(readScene(directory / "organ/scene.toml").mesh, directory / "organ/Nierenlänge 1.msh");
}

TEST_F(MeshCommand, NamesThePackagesOfMissingPrograms) {
  test::writeStl(test::sphereSurface(60, 2), directory / "organ.stl");
  if (test::runCommand("test -x /usr/bin/python3").exit_code == 0) {
    PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
    const CommandResult refused =
        worker("mesh organ.stl -o organ.msh", "env PATH=" + directory.path().string());
    EXPECT_EQ(refused.exit_code, 1) << refused.output;
    EXPECT_THAT(refused.output, AllOf(HasSubstr("(Debian: gmsh)"), HasSubstr("(Debian: tetgen)"),
                                      HasSubstr("Install one of them"), Not(HasSubstr("MeshLab"))));
  }
  EXPECT_FALSE(std::filesystem::exists(directory / "organ.msh"));
}

TEST_F(MeshCommand, ReportsAMesherThatEndedSilently) {
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  test::writeStl(test::sphereSurface(60, 2), directory / "organ.stl");
  test::writeScript(directory / "gmsh", "exit 7");
  const CommandResult refused =
      worker("mesh organ.stl -o organ.msh --mesher gmsh", "env PATH=\"$PWD:$PATH\"");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.output,
              AllOf(HasSubstr("gmsh: ended with exit code 7"), HasSubstr("MeshLab")));
}

TEST_F(MeshCommand, NamesThePlausibleUnitOfAMesh) {
  test::writeGmsh22(test::boxMesh({120, 80, 60}, {9, 6, 5}), directory / "box.msh");
  const CommandResult refused = worker("new organ --mesh box.msh --unit m");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("box.msh: the body is 120 wide, which in metres"),
                                    HasSubstr("give --unit mm")));
  EXPECT_FALSE(std::filesystem::exists(directory / "organ"));
}

TEST_F(MeshCommand, WithoutATemporaryFolderSaysHowToSetOne) {
  test::writeStl(test::sphereSurface(60, 2), directory / "organ.stl");
  const CommandResult refused = worker("mesh organ.stl -o organ.msh", "env TMPDIR=gone");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.output, HasSubstr("set TMPDIR"));
}

TEST_F(MeshCommand, LeavesNothingBehindWhenItIsInterrupted) {
  PALPATE_NEEDS(test::hasMeshio(), "python3-meshio");
  test::writeStl(test::sphereSurface(60, 2), directory / "organ.stl");
  std::filesystem::create_directory(directory / "tmp");
  test::writeScript(directory / "gmsh", "touch started\nexec sleep 300");
  // A signal may reach only the command, or, from a terminal, the whole process group.
  for (const auto& [starter, kill] :
       {std::pair("", "kill -TERM $!"), std::pair("setsid -w", "pkill -TERM -g $!")}) {
    const CommandResult stopped = test::runCommand(
        fmt::format("cd '{}'; (export TMPDIR=$PWD/tmp PATH=$PWD:$PATH && exec {} '" PALPATE_BIN_DIR
                    "/palpate-worker' mesh organ.stl -o organ.msh 2>&1) & "
                    "while ! test -e started; do sleep 0.05; done; {}; wait $!",
                    directory.path().string(), starter, kill));
    EXPECT_EQ(stopped.exit_code, 130) << stopped.output;
    EXPECT_THAT(stopped.output, HasSubstr("interrupted"));
    std::filesystem::remove(directory / "started");
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory / "tmp"));
  EXPECT_FALSE(std::filesystem::exists(directory / "organ.msh"));
}

}  // namespace
}  // namespace palpate
