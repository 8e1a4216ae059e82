#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <sstream>

#include "common/dataset.hpp"
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
  ASSERT_THAT(snippets, SizeIs(2));
  const Ran ran = runPython(directory, snippets[0], file);
  EXPECT_EQ(ran.status, 0) << ran.output;
  const Eigen::Vector3d force = sample.spaces[0].points[*sample.lattice.indexOf({1, 0, 0})].equilibrium.force;
  EXPECT_THAT(ran.output, HasSubstr("solved: 31 of 33"));
  EXPECT_THAT(ran.output, HasSubstr("displacement: [0.01, 0.0, 0.0]"));
  EXPECT_THAT(ran.output, HasSubstr(fmt::format("force: [{}, ", force.x())));
  EXPECT_THAT(ran.output, HasSubstr("deformed nodes: (27, 3)"));
}

TEST_F(DatasetPage, CheckRecomputesEveryHashWithH5py) {
  ASSERT_THAT(snippets, SizeIs(2));
  const Ran ran = runPython(directory, snippets[1], file);
  EXPECT_EQ(ran.status, 0) << ran.output;
  EXPECT_EQ(ran.output, "intact: " + Dataset(file).contentId().hex() + "\n");
}

TEST_F(DatasetPage, FailedPointsReadAsNaNAndTakeNoRoomInH5py) {
  const Ran ran =
      runPython(directory,
                "import sys, h5py, numpy as np\n"
                "f = h5py.File(sys.argv[1], 'r')\n"
                "u = f['spaces/tip/displacement']\n"
                "assert np.isnan(u[7]).all() and np.isnan(f['spaces/tip/energy'][7])\n"
                "assert u.id.get_num_chunks() == 31 and u.chunks == (1, 27, 3) and u.compression == 'gzip'\n",
                file);
  EXPECT_EQ(ran.status, 0) << ran.output;
}

TEST_F(DatasetPage, FilesThatOthersMadeAreRefused) {
  const std::filesystem::path other = directory / "other.h5";
  const auto open = [&](const std::string& program) {
    const Ran ran = runPython(directory, "import sys, h5py, numpy as np\n" + program, other);
    EXPECT_EQ(ran.status, 0) << ran.output;
    try {
      Dataset{other}.verifyAll();
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const std::string copied =
      "import shutil; shutil.copy('" + file.string() + "', sys.argv[1])\nf = h5py.File(sys.argv[1], 'a')\n";
  EXPECT_THAT(open("h5py.File(sys.argv[1], 'w')['force'] = 1.0\n"), HasSubstr("not a Palpate dataset"));
  EXPECT_THAT(open(copied + "f.attrs['format_version'] = np.array([2, 0], 'int32')\n"),
              HasSubstr("format version 2.0"));
  EXPECT_THAT(open(copied + "f['spaces/tip/force'][3, 0] = 7\n"), HasSubstr("/spaces/tip/force"));
  EXPECT_THAT(open(copied + "f['spaces/tip/pressure'][3, 0] = 7\n"), HasSubstr("/spaces/tip/pressure"));
  EXPECT_THAT(open(copied + "del f['spaces/tip/tag']\n"), HasSubstr("content_hash"));
  EXPECT_THAT(open(copied + "del f['spaces/edge-2']\n"), HasSubstr("content_hash"));
  EXPECT_THAT(open(copied + "f['extra'] = np.zeros(3, 'int64')\n"), HasSubstr("/extra"));
  EXPECT_THAT(open(copied + "f['extra'] = h5py.ExternalLink('/etc/passwd', '/')\n"), HasSubstr("no error"));
  EXPECT_THAT(open(copied + "d = f['spaces/tip/tag']; a = dict(d.attrs); del f['spaces/tip/tag']\n"
                            "d = f.create_dataset('spaces/tip/tag', data=np.ones((33, 2), 'uint8'))\n"
                            "for k in a: d.attrs[k] = a[k]\n"),
              HasSubstr("content_hash"));
}

}  // namespace
}  // namespace palpate
