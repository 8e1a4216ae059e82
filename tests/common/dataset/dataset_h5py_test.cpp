#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

#include "common/dataset/dataset.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

/// The ```python blocks of docs/dataset.md, in order: what the page promises is what runs here.
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

struct Ran {
  int status = -1;
  std::string output;
};

/// Runs a Python program of the distribution, which has h5py as package python3-h5py, on `file`.
Ran runPython(const test::TemporaryDirectory& directory, const std::string& program,
              const std::filesystem::path& file) {
  const std::filesystem::path script = directory / "snippet.py";
  std::ofstream(script) << program;
  const std::string command = "/usr/bin/python3 " + script.string() + " " + file.string() + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) throw failure("cannot run {}", command);
  Ran ran;
  for (int c; (c = std::fgetc(pipe)) != EOF;) ran.output += static_cast<char>(c);
  ran.status = pclose(pipe);
  return ran;
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
  const Ran ran = runPython(directory, snippets[0], file);
  EXPECT_EQ(ran.status, 0) << ran.output;
  const Eigen::Vector3d force =
      sample.spaces[0].points[*sample.lattice.indexOf({1, 0, 0})].equilibrium.force;
  EXPECT_THAT(ran.output, HasSubstr("solved: 31 of 33"));
  EXPECT_THAT(ran.output, HasSubstr("displacement: [0.01, 0.0, 0.0]"));
  EXPECT_THAT(ran.output, HasSubstr(fmt::format("force: [{}, ", force.x())));
  EXPECT_THAT(ran.output, HasSubstr("deformed surface nodes: (26, 3)"));
}

TEST_F(DatasetPage, CheckRecomputesEveryHashWithH5py) {
  ASSERT_THAT(snippets, SizeIs(3));
  const Ran ran = runPython(directory, snippets[2], file);
  EXPECT_EQ(ran.status, 0) << ran.output;
  EXPECT_EQ(ran.output, "intact: " + Dataset(file).contentId().hex() + "\n");
}

TEST_F(DatasetPage, FailedPointsReadAsNaNAndTakeNoRoomInH5py) {
  const Ran ran = runPython(
      directory,
      "import sys, h5py, numpy as np\n"
      "f = h5py.File(sys.argv[1], 'r')\n"
      "u = f['points/displacement']\n"
      "assert np.isnan(u[7]).all() and np.isnan(f['points/energy'][7])\n"
      "assert u.id.get_num_chunks() == 64 and u.chunks == (1, 26, 3) and u.compression == 'gzip'\n",
      file);
  EXPECT_EQ(ran.status, 0) << ran.output;
}

TEST_F(DatasetPage, ExampleReadsQuantizedDisplacementsOfARefinedDataset) {
  ASSERT_THAT(snippets, SizeIs(3));
  sample.refine();
  sample.problem.scene.storage = {StoredNodes::all, StoredPrecision::int16};
  sample.seal(file);
  const Ran ran = runPython(directory, snippets[1], file);
  EXPECT_EQ(ran.status, 0) << ran.output;
  EXPECT_THAT(ran.output, HasSubstr("edge-2: 33 uniform points, "));
  EXPECT_THAT(ran.output, HasSubstr("displacements of all 27 nodes to "));
  EXPECT_THAT(ran.output, HasSubstr("1 of 2 probes solved in tip"));
  for (const std::size_t snippet : {0u, 2u})
    EXPECT_EQ(runPython(directory, snippets[snippet], file).status, 0);
}

/// Lets h5py change a copy of the dataset and says what reading it then ends with.
class ChangedDataset : public DatasetPage {
 protected:
  std::string errorAfter(const std::string& change) {
    const std::string program =
        "import hashlib, shutil, sys, h5py, numpy as np\nshutil.copy('" + file.string() +
        "', sys.argv[1])\nf = h5py.File(sys.argv[1], 'a')\n" + change + "\nf.close()\n";
    const std::filesystem::path changed = directory / "changed.h5";
    const Ran ran = runPython(directory, program, changed);
    EXPECT_EQ(ran.status, 0) << ran.output;
    try {
      Dataset{changed}.verifyAll();
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), HasSubstr("changed.h5"));
      return error.what();
    }
    return "no error";
  }

  /// The same when all hashes are made to match afterwards: what only looking at the values can
  /// find.
  std::string errorAfterForging(const std::string& change) {
    return errorAfter(change + R"(
def blake2b(data):
    return hashlib.blake2b(data, digest_size=32).hexdigest()
lines = []
def visit(path, item):
    if isinstance(item, h5py.Dataset):
        digest = blake2b(item[()].tobytes())
        item.attrs['blake2b'] = np.bytes_(digest)
        lines.append(f"/{path} {item.dtype} {'x'.join(map(str, item.shape)) or 'scalar'} {digest}\n")
f.visititems(visit)
text = f"scene_toml {blake2b(f.attrs['scene_toml'])}\n" + ''.join(sorted(lines))
f.attrs['content_hash'] = np.bytes_(blake2b(text.encode())))");
  }

  static std::string replaced(const std::string& array, const std::string& values) {
    return "del f['" + array + "']\nf['" + array + "'] = " + values;
  }
};

TEST_F(ChangedDataset, IsReadAsLongAsNothingChanged) {
  EXPECT_EQ(errorAfter(""), "no error");
  EXPECT_EQ(errorAfterForging(""), "no error");
}

TEST_F(ChangedDataset, IsRefusedWhenOthersMadeOrChangedIt) {
  EXPECT_THAT(errorAfter("for key in list(f.attrs): del f.attrs[key]"),
              HasSubstr("not a Palpate dataset"));
  EXPECT_THAT(errorAfter("f.attrs['format_version'] = np.array([4, 0], 'int32')"),
              HasSubstr("format version 4.0, this program reads 2.x to 3.x"));
  EXPECT_THAT(
      errorAfter("f.attrs['format_version'] = np.array([1, 1], 'int32')"),
      HasSubstr("format version 1.1, which is no longer read; seal it again with `palpate build"));
  EXPECT_THAT(errorAfter("f['points/force'][3, 0] = 7"), HasSubstr("/points/force"));
  EXPECT_THAT(errorAfter("f['points/displacement'][3, 0, 1] = 7"),
              HasSubstr("/points/displacement"));
  EXPECT_THAT(errorAfter("del f['points/tag']"), HasSubstr("content_hash"));
  EXPECT_THAT(errorAfter("del f['probes']"), HasSubstr("content_hash"));
  EXPECT_THAT(errorAfter("f['extra'] = np.zeros(3, 'int64')"), HasSubstr("/extra"));
}

TEST_F(ChangedDataset, IsRefusedForWrongShapesAndTypes) {
  EXPECT_THAT(errorAfterForging(replaced("points/tag", "np.ones((66, 2), 'uint8')")),
              HasSubstr("/points/tag: is uint8 66 x 2 instead of uint8 66"));
  EXPECT_THAT(errorAfterForging(replaced("mesh/points", "np.zeros((27, 3), 'float32')")),
              HasSubstr("/mesh/points: is float32 27 x 3 instead of float64 n x 3"));
  EXPECT_THAT(
      errorAfterForging(replaced("points/displacement", "np.zeros((66, 25, 3), 'float32')")),
      HasSubstr("/points/displacement: is float32 66 x 25 x 3"));
  EXPECT_THAT(errorAfterForging(replaced("points/displacement", "np.zeros((66, 26, 3), 'int16')")),
              HasSubstr("/points/displacement: is int16"));
  EXPECT_THAT(errorAfterForging("del f['probes']"), HasSubstr("/probes/position: is missing"));
  EXPECT_THAT(errorAfterForging("del f['points/energy']"), HasSubstr("/points/energy: is missing"));
}

/// Rows that were never written take no room in a file, and empty ones never do.
TEST_F(ChangedDataset, IsRefusedForMoreRowsThanItHasBytes) {
  const auto extra = [](const char* shape, const char* type, const char* chunks) {
    return fmt::format(
        "f.create_dataset('extra', {}, '{}', chunks={}).attrs['blake2b'] = np.bytes_('0' * 64)",
        shape, type, chunks);
  };
  EXPECT_THAT(errorAfter(extra("(2**50, 3)", "<f4", "(64, 3)")),
              HasSubstr("/extra: impossible shape 1125899906842624 x 3"));
  EXPECT_THAT(errorAfter(extra("(2**50, 0)", "<f4", "None")), HasSubstr("impossible shape"));
  EXPECT_THAT(errorAfter(extra("(2**31 - 1, 0)", "<i4", "None")), HasSubstr("impossible shape"));
}

/// Files from before fingers had a width reach all of their part of the ball.
TEST_F(ChangedDataset, OfFingersNeedsNoWidth) {
  test::FingerBody().seal(file);
  EXPECT_EQ(errorAfterForging("del f['spaces/finger_width']"), "no error");
  EXPECT_THAT(errorAfterForging("f['spaces/finger_width'][2] = -1"), HasSubstr("/spaces/finger"));
}

TEST_F(ChangedDataset, IsRefusedForImpossibleValues) {
  EXPECT_THAT(errorAfterForging("f['points/tag'][3] = 4"), HasSubstr("/points/tag: holds 4"));
  EXPECT_THAT(errorAfterForging("f['points/parent'][3] = 33"),
              HasSubstr("space tip: point 3 has parent 33"));
  EXPECT_THAT(errorAfterForging("f['attempts/cause'][0] = 99"),
              HasSubstr("attempts/cause: holds 99"));
  EXPECT_THAT(errorAfterForging("f['mesh/tetrahedra'][0, 2] = -1"),
              HasSubstr("/mesh/tetrahedra: holds -1"));
  EXPECT_THAT(errorAfterForging("f['spaces/active_node'][1] = 2"), HasSubstr("active_node"));
  EXPECT_THAT(errorAfterForging("f['spaces/name'][1, 0] = 70"), HasSubstr("/spaces/name"));
  EXPECT_THAT(errorAfterForging("f['spaces/first_point'][1] = 70"),
              HasSubstr("/spaces/first_point"));
  EXPECT_THAT(errorAfterForging("f['spaces/first_attempt'][1:] = 1"),
              HasSubstr("/spaces/first_attempt"));
  EXPECT_THAT(errorAfterForging("f['mesh/surface_nodes'][0] = 1"),
              HasSubstr("/mesh/surface_nodes"));
  EXPECT_THAT(errorAfterForging("f['points/force'][2, 1] = np.nan"), HasSubstr("row 2 is solved"));
  EXPECT_THAT(errorAfterForging("f['points/ijk'][5, 0] += 1"), HasSubstr("/points/ijk"));
}

/// What only a look at the fields can find.
TEST_F(ChangedDataset, FieldsAreComparedWithTheirOwnHash) {
  const std::string change = "f['points/displacement'][3, 0, 0] = 7";
  EXPECT_EQ(errorAfterForging(change), "no error");
  const Dataset dataset(directory / "changed.h5");
  EXPECT_NO_THROW(dataset.fields(0, 2));
  EXPECT_NO_THROW(dataset.surfaceDisplacements(1));
  test::expectError(ExitCode::failed, [&] { dataset.fields(0, 3); },
                    {"changed.h5", "/points/displacement", "point 3 of tip", "stored_id"});
  test::expectError(ExitCode::failed, [&] { dataset.surfaceDisplacements(0); }, {"point 3 of tip"});
}

TEST_F(ChangedDataset, OfARefinedSpaceIsRefusedForImpossibleCells) {
  sample.refine();
  sample.seal(file);
  EXPECT_EQ(errorAfterForging(""), "no error");
  EXPECT_THAT(errorAfterForging("f['splits/level'][1] = 20"), HasSubstr("space edge-2: split 1"));
  EXPECT_THAT(errorAfterForging("f['splits/lowest'][0, 1] = 100"),
              HasSubstr("no cell of the lattice"));
  EXPECT_THAT(errorAfterForging("f['points/ijk'][-1] = f['points/ijk'][-2]"),
              HasSubstr("/points/ijk"));
  EXPECT_THAT(errorAfterForging("f['points/ijk'][-1] = (90000, 0, 0)"),
              HasSubstr("/points/position"));
  EXPECT_THAT(errorAfterForging("f['probes/position'][0] = (1, 0, 0)"),
              HasSubstr("space tip: probe 0"));
  EXPECT_THAT(errorAfterForging("f['inconsistent_edges'][0, 0] = -2"),
              HasSubstr("an inconsistent edge joins"));
}

TEST_F(ChangedDataset, OfANewerMinorVersionIsReadWithoutItsNewArrays) {
  EXPECT_EQ(errorAfterForging("f.attrs['format_version'] = np.array([3, 7], "
                              "'int32')\nf['rest/error'] = np.zeros((2, 3))"),
            "no error");
}

TEST_F(ChangedDataset, OfVersion2IsReadWithoutItsRadialFunctions) {
  EXPECT_EQ(errorAfterForging("f.attrs['format_version'] = np.array([2, 0], "
                              "'int32')\nf['rbf/linear'] = np.zeros((66, 3))"),
            "no error");
}

TEST_F(ChangedDataset, LinksToOtherFilesAreNotFollowed) {
  EXPECT_EQ(errorAfter("f['extra'] = h5py.ExternalLink('/etc/passwd', '/')"), "no error");
  EXPECT_THAT(
      errorAfterForging("del f['mesh/surface']\nf.create_dataset('mesh/surface', (1, 3), 'int32', "
                        "external=[('/etc/passwd', 0, 12)])"),
      HasSubstr("lies in another file"));
}

}  // namespace
}  // namespace palpate
