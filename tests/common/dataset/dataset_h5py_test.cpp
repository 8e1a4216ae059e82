#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "common/dataset/dataset.hpp"
#include "tests/support/command.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

/// The ```python blocks of docs/dataset.md in order, so that the examples of the page are tested.
std::vector<std::string> snippetsOfThePage() {
  std::ifstream page(std::filesystem::path(PALPATE_SOURCE_DIR) / "docs/dataset.md");
  std::vector<std::string> snippets;
  bool inside = false;
  for (std::string line; std::getline(page, line);) {
    if (inside && line == "```")
      inside = false;
    else if (inside)
      snippets.back() += line + "\n";
    else if (line == "```python") {
      inside = true;
      snippets.emplace_back();
    }
  }
  return snippets;
}

/// Runs a program on `file` with the distribution's Python, which has h5py (package python3-h5py).
test::CommandResult runPython(const test::TemporaryDirectory& directory, const std::string& program,
                              const std::filesystem::path& file) {
  std::ofstream(directory / "snippet.py") << program;
  return test::runCommand(
      fmt::format("/usr/bin/python3 {} {}", (directory / "snippet.py").string(), file.string()));
}

class DatasetPage : public ::testing::Test {
 protected:
  DatasetPage() { sample.seal(file); }
  test::TemporaryDirectory directory;
  test::SampleDataset sample;
  std::filesystem::path file = directory / "sample.h5";
  std::vector<std::string> snippets = snippetsOfThePage();
};

TEST_F(DatasetPage, ExampleReadsForcesAndShapesWithH5py) {
  ASSERT_THAT(snippets, SizeIs(3));
  const test::CommandResult ran = runPython(directory, snippets[0], file);
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  const Eigen::Vector3d force =
      sample.spaces[0].points[*sample.lattice.indexOf({1, 0, 0})].equilibrium.force;
  EXPECT_THAT(ran.output, HasSubstr("solved: 31 of 33"));
  EXPECT_THAT(ran.output, HasSubstr("displacement: [0.01, 0.0, 0.0]"));
  EXPECT_THAT(ran.output, HasSubstr(fmt::format("force: [{}, ", force.x())));
  EXPECT_THAT(ran.output, HasSubstr("deformed surface nodes: (26, 3)"));
}

TEST_F(DatasetPage, CheckRecomputesEveryHashWithH5py) {
  ASSERT_THAT(snippets, SizeIs(3));
  const test::CommandResult ran = runPython(directory, snippets[2], file);
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_EQ(ran.output, "intact: " + Dataset(file).contentId().hex() + "\n");
}

TEST_F(DatasetPage, FailedPointsReadAsNaNAndTakeNoRoomInH5py) {
  const test::CommandResult ran = runPython(
      directory,
      "import sys, h5py, numpy as np\n"
      "f = h5py.File(sys.argv[1], 'r')\n"
      "u = f['points/displacement']\n"
      "assert np.isnan(u[7]).all() and np.isnan(f['points/energy'][7])\n"
      "assert u.id.get_num_chunks() == 64 and u.chunks == (1, 26, 3) and u.compression == 'gzip'\n",
      file);
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
}

TEST_F(DatasetPage, ExampleReadsQuantizedDisplacementsOfARefinedDataset) {
  ASSERT_THAT(snippets, SizeIs(3));
  sample.refine();
  sample.problem.scene.storage = {StoredNodes::all, StoredPrecision::int16};
  sample.seal(file);
  const test::CommandResult ran = runPython(directory, snippets[1], file);
  EXPECT_EQ(ran.exit_code, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr("edge-2: 33 uniform points, "));
  EXPECT_THAT(ran.output, HasSubstr("displacements of all 27 nodes to "));
  EXPECT_THAT(ran.output, HasSubstr("1 of 2 probes solved in tip"));
  for (const std::size_t snippet : {0u, 2u})
    EXPECT_EQ(runPython(directory, snippets[snippet], file).exit_code, 0);
}

/// A change by h5py, and text of the error that reading then reports.
struct Change {
  std::string python, error = "no error";
};

class ChangedDataset : public DatasetPage {
 protected:
  enum class Hashes { as_they_were, forged };

  /// Applies each change to a copy of the dataset, changed-N.h5. Forged: all hashes are updated to
  /// match, so that only a check of the values can find the change.
  void expectErrors(Hashes hashes, const std::vector<Change>& changes) {
    for (std::size_t n = 0; n < changes.size(); ++n)
      std::ofstream(directory / fmt::format("change-{}.py", n)) << changes[n].python;
    const test::CommandResult ran =
        runPython(directory,
                  fmt::format("changes, forged = {}, {}\n", changes.size(),
                              hashes == Hashes::forged ? "True" : "False") +
                      R"(
import hashlib, os, shutil, sys, h5py, numpy as np
def blake2b(data):
    return hashlib.blake2b(data, digest_size=32).hexdigest()
def forge(f):
    lines = []
    def visit(path, item):
        if isinstance(item, h5py.Dataset):
            digest = blake2b(item[()].tobytes())
            item.attrs['blake2b'] = np.bytes_(digest)
            lines.append(f"/{path} {item.dtype} {'x'.join(map(str, item.shape)) or 'scalar'} {digest}\n")
    f.visititems(visit)
    text = f"scene_toml {blake2b(f.attrs['scene_toml'])}\n" + ''.join(sorted(lines))
    f.attrs['content_hash'] = np.bytes_(blake2b(text.encode()))
os.chdir(os.path.dirname(sys.argv[1]))
for n in range(changes):
    shutil.copy(sys.argv[1], f'changed-{n}.h5')
    with h5py.File(f'changed-{n}.h5', 'a') as f:
        exec(open(f'change-{n}.py').read())
        if forged: forge(f)
)",
                  file);
    ASSERT_EQ(ran.exit_code, 0) << ran.output;
    for (std::size_t n = 0; n < changes.size(); ++n)
      EXPECT_THAT(errorOf(directory / fmt::format("changed-{}.h5", n)), HasSubstr(changes[n].error))
          << changes[n].python;
  }

  static std::string replaced(const std::string& array, const std::string& values) {
    return "del f['" + array + "']\nf['" + array + "'] = " + values;
  }

 private:
  static std::string errorOf(const std::filesystem::path& changed) {
    try {
      Dataset{changed}.verifyAll();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr(changed.filename().string()));
      return error.what();
    }
    return "no error";
  }
};

TEST_F(ChangedDataset, IsReadIfNothingChanged) {
  for (const Hashes hashes : {Hashes::as_they_were, Hashes::forged}) expectErrors(hashes, {{""}});
}

TEST_F(ChangedDataset, IsRefusedIfForeignOrModified) {
  const auto version = [](const char* numbers) {
    return fmt::format("f.attrs['format_version'] = np.array({}, 'int32')", numbers);
  };
  expectErrors(Hashes::as_they_were,
               {{"for key in list(f.attrs): del f.attrs[key]", "not a Palpate dataset"},
                {version("[4, 0]"), "format version 4.0"},
                {version("[1, 1]"), "format version 1.1"},
                {"f['points/force'][3, 0] = 7", "/points/force"},
                {"f['points/displacement'][3, 0, 1] = 7", "/points/displacement"},
                {"del f['points/tag']", "content_hash"},
                {"del f['probes']", "content_hash"},
                {"f['extra'] = np.zeros(3, 'int64')", "/extra"}});
}

TEST_F(ChangedDataset, IsRefusedForWrongShapesAndTypes) {
  expectErrors(Hashes::forged,
               {{replaced("points/tag", "np.ones((66, 2), 'uint8')"),
                 "/points/tag: is uint8 66 x 2 instead of uint8 66"},
                {replaced("mesh/points", "np.zeros((27, 3), 'float32')"),
                 "/mesh/points: is float32 27 x 3 instead of float64 n x 3"},
                {replaced("points/displacement", "np.zeros((66, 25, 3), 'float32')"),
                 "/points/displacement: is float32 66 x 25 x 3"},
                {replaced("points/displacement", "np.zeros((66, 26, 3), 'int16')"),
                 "/points/displacement: is int16"},
                {"del f['probes']", "/probes/position: is missing"},
                {"del f['points/energy']", "/points/energy: is missing"}});
}

/// Rows that were never written take no space in a file; neither do empty rows.
TEST_F(ChangedDataset, IsRefusedForMoreRowsThanItHasBytes) {
  const auto extra = [](const char* shape, const char* type, const char* chunks) {
    return fmt::format(
        "f.create_dataset('extra', {}, '{}', chunks={}).attrs['blake2b'] = np.bytes_('0' * 64)",
        shape, type, chunks);
  };
  expectErrors(
      Hashes::as_they_were,
      {{extra("(2**50, 3)", "<f4", "(64, 3)"), "/extra: has the impossible shape 1125899906842624"},
       {extra("(2**50, 0)", "<f4", "None"), "impossible shape"},
       {extra("(2**31 - 1, 0)", "<i4", "None"), "impossible shape"}});
}

/// In files without finger widths, fingers reach all of their part of the ball.
TEST_F(ChangedDataset, IsReadWithoutAFingerWidth) {
  test::FingerBody().seal(file);
  expectErrors(Hashes::forged, {{"del f['spaces/finger_width']"},
                                {"f['spaces/finger_width'][2] = -1", "/spaces/finger"}});
}

TEST_F(ChangedDataset, IsRefusedForImpossibleValues) {
  expectErrors(Hashes::forged,
               {{"f['points/tag'][3] = 4", "/points/tag: holds 4"},
                {"f['points/parent'][3] = 33", "space tip: point 3 has the invalid parent 33"},
                {"f['attempts/cause'][0] = 99", "attempts/cause: holds 99"},
                {"f['mesh/tetrahedra'][0, 2] = -1", "/mesh/tetrahedra: holds -1"},
                {"f['spaces/active_node'][1] = 2", "active_node"},
                {"f['spaces/name'][1, 0] = 70", "/spaces/name"},
                {"f['spaces/first_point'][1] = 70", "/spaces/first_point"},
                {"f['spaces/first_attempt'][1:] = 1", "/spaces/first_attempt"},
                {"f['mesh/surface_nodes'][0] = 1", "/mesh/surface_nodes"},
                {"f['points/force'][2, 1] = np.nan", "row 2 is solved"},
                {"f['points/ijk'][5, 0] += 1", "/points/ijk"}});
}

/// Only a check of the fields can find a change of the fields with updated hashes.
TEST_F(ChangedDataset, FieldsAreComparedWithTheirOwnHash) {
  expectErrors(Hashes::forged, {{"f['points/displacement'][3, 0, 0] = 7"}});
  const Dataset dataset(directory / "changed-0.h5");
  EXPECT_NO_THROW(dataset.fields(0, 2));
  EXPECT_NO_THROW(dataset.surfaceFields(1));
  test::expectError(ExitCode::failed, [&] { dataset.fields(0, 3); },
                    {"changed-0.h5", "/points/displacement", "point 3 of tip"});
  test::expectError(ExitCode::failed, [&] { dataset.surfaceFields(0); }, {"point 3 of tip"});
}

TEST_F(ChangedDataset, IsRefusedForImpossibleCellsOfARefinedSpace) {
  sample.refine();
  sample.seal(file);
  expectErrors(Hashes::forged, {{""},
                                {"f['splits/level'][1] = 20", "space edge-2: split cell 1"},
                                {"f['splits/lowest'][0, 1] = 100", "split cell 0 is not a cell"},
                                {"f['points/ijk'][-1] = f['points/ijk'][-2]", "/points/ijk"},
                                {"f['points/ijk'][-1] = (90000, 0, 0)", "/points/position"},
                                {"f['probes/position'][0] = (1, 0, 0)", "space tip: probe 0"},
                                {"f['inconsistent_edges'][0, 0] = -2", "an inconsistent edge"}});
}

TEST_F(ChangedDataset, NewerMinorVersionsAndVersion2AreReadWithoutUnknownParts) {
  const std::string version = "f.attrs['format_version'] = np.array(";
  expectErrors(Hashes::forged,
               {{version + "[3, 7], 'int32')\nf['rest/error'] = np.zeros((2, 3))"},
                {version + "[2, 0], 'int32')\nf['rbf/linear'] = np.zeros((66, 3))"}});
}

TEST_F(ChangedDataset, LinksToOtherFilesAreNotFollowed) {
  expectErrors(Hashes::as_they_were, {{"f['extra'] = h5py.ExternalLink('/etc/passwd', '/')"}});
  expectErrors(Hashes::forged, {{"del f['mesh/surface']\nf.create_dataset('mesh/surface', (1, 3), "
                                 "'int32', external=[('/etc/passwd', 0, 12)])",
                                 "/mesh/surface: stores its data in another file"}});
}

}  // namespace
}  // namespace palpate
