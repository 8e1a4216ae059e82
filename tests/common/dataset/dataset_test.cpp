#include "common/dataset/dataset.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>

#include "common/dataset/hdf5_reader.hpp"
#include "common/interpolation/branch_check.hpp"
#include "tests/support/causes.hpp"
#include "tests/support/child.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/left_open.hpp"
#include "tests/support/same_records.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::bytesIn;
using test::expectBadInput;
using test::expectError;
using test::putInto;
using test::SampleDataset;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

void expectSealed(const SpaceTable& read, const SpaceTable& written) {
  test::expectSame(read, written);
  EXPECT_EQ(read.inconsistent_edges, inconsistentEdges(written));
}

/// The displacements of `nodes` in `fields`.
std::vector<float> displacementsOf(const std::vector<std::int32_t>& nodes,
                                   const NodalFields& fields) {
  std::vector<float> values;
  for (const std::int32_t node : nodes)
    for (int axis = 0; axis < 3; ++axis) values.push_back(fields.displacement[3 * node + axis]);
  return values;
}

/// The sites of a finger and five probes. They are created once, because this takes a second.
const test::FingerBody& fingers() {
  static const test::FingerBody body(5);
  return body;
}

/// A sealed sample and a folder for damaged copies of it.
class SealedDataset : public ::testing::Test {
 protected:
  SealedDataset() { sample.seal(file); }

  /// Opens and reads everything, as a client and `verifyAll` would.
  static void readAll(const std::filesystem::path& path) { Dataset(path).verifyAll(); }

  /// The position of `values` in the file, where they must occur exactly once.
  std::size_t placeOf(const std::string& bytes, std::string_view values) const {
    const std::size_t at = bytes.find(values);
    EXPECT_NE(at, std::string::npos);
    EXPECT_EQ(bytes.find(values, at + 1), std::string::npos);
    return at;
  }

  test::TemporaryDirectory directory;
  SampleDataset sample;
  std::filesystem::path file = directory / "sample.h5";
  std::filesystem::path aside = directory / "sample.h5.tmp";
  std::filesystem::path copy = directory / "copy.h5";
};

TEST_F(SealedDataset, ReturnsEveryRecord) {
  const Dataset dataset(file);
  ASSERT_EQ(dataset.spaces().size(), 2u);
  for (std::size_t s = 0; s < 2; ++s) expectSealed(dataset.spaces()[s], sample.spaces[s]);
}

TEST_F(SealedDataset, ReturnsEveryCause) {
  const auto failed = std::find_if(sample.spaces[0].points.begin(), sample.spaces[0].points.end(),
                                   [](const PointRecord& p) { return p.tag == Tag::failed; });
  sample.spaces[0].attempts.clear();
  for (const Cause cause : test::allCauses()) {
    failed->cause = cause;
    sample.spaces[0].attempts.push_back({7, 0, {.cause = cause}});
    sample.seal(file);
    expectSealed(Dataset(file).spaces()[0], sample.spaces[0]);
  }
}

TEST_F(SealedDataset, ReturnsRefinedLatticesProbesAndInconsistentEdges) {
  sample.refine();
  sample.seal(file);
  const Dataset dataset(file);
  for (std::size_t s = 0; s < 2; ++s) expectSealed(dataset.spaces()[s], sample.spaces[s]);
  const SpaceTable& edge = dataset.spaces()[1];
  EXPECT_EQ(edge.lattice.divisions(), 1024);
  EXPECT_GT(edge.lattice.size(), 33 + 20);
  EXPECT_FALSE(edge.inconsistent_edges.empty());
  EXPECT_EQ(dataset.scene().accuracy.force_error, 0.03);
  EXPECT_EQ(dataset.fields(1, edge.lattice.size() - 1).displacement,
            displacementsOf(dataset.storedNodes(), sample.fields(1, edge.lattice.size() - 1)));
}

TEST_F(SealedDataset, ReturnsQuadraticMeshesAndWeightedPatches) {
  for (const PressureSpace pressure : {PressureSpace::none, PressureSpace::p1, PressureSpace::p2}) {
    SampleDataset quadratic(pressure, DisplacementSpace::p2);
    quadratic.problem.scene.storage.displacement = StoredNodes::all;
    quadratic.seal(file);
    const Dataset dataset(file);
    EXPECT_EQ(dataset.mesh().nodes, quadratic.problem.mesh.nodes);
    EXPECT_EQ(dataset.mesh().edges, quadratic.problem.mesh.edges);
    EXPECT_EQ(dataset.mesh().mid_edge_nodes, quadratic.problem.mesh.mid_edge_nodes);
    EXPECT_EQ(dataset.spaces()[0].patch.weights, quadratic.problem.active[0].weights);
    EXPECT_EQ(dataset.spaces()[1].patch.nodes, quadratic.problem.active[1].nodes);
    EXPECT_EQ(dataset.spaces()[1].patch.weights, quadratic.problem.active[1].weights);
    const NodalFields fields = dataset.fields(1, 3);
    EXPECT_EQ(fields.displacement, quadratic.fields(1, 3).displacement);
    EXPECT_EQ(fields.pressure.size(), quadratic.problem.pressures.count());
    EXPECT_EQ(fields.pressure, quadratic.fields(1, 3).pressure);
  }
}

TEST_F(SealedDataset, ReturnsFingersAndTheirConfigurationalForces) {
  const test::FingerBody& body = fingers();
  body.seal(file);
  const Dataset dataset(file);
  EXPECT_EQ(dataset.scene().active.at(2).area, "top");
  EXPECT_EQ(dataset.spaces()[2].patch.finger, body.spaces[2].patch.finger);
  test::expectSame(dataset.spaces()[2].points.at(5), body.spaces[2].points.at(5));
}

TEST_F(SealedDataset, KeepsProbePlacesApartFromTouchedSpaces) {
  const test::FingerBody& body = fingers();
  body.seal(directory / "probed.h5");
  const Dataset dataset(directory / "probed.h5");
  ASSERT_EQ(dataset.spaces().size(), body.spaces.size() - 5);
  ASSERT_EQ(dataset.probePlaces().size(), 5u);
  const SpaceTable &place = dataset.probePlaces()[3],
                   &sealed = body.spaces[dataset.spaces().size() + 3];
  EXPECT_EQ(place.patch.probe, sealed.patch.probe);
  EXPECT_EQ(place.lattice.size(), 1);
  EXPECT_EQ(place.probes.at(0).record.equilibrium.force,
            sealed.probes.at(0).record.equilibrium.force);
  EXPECT_TRUE(dataset.spaces().back().probes.empty());
  EXPECT_EQ(dataset.fields(dataset.spaces().size() - 1, 7).displacement.size(),
            3 * dataset.storedNodes().size());
  EXPECT_NO_THROW(dataset.verifyAll());
}

TEST_F(SealedDataset, RefusesFieldsWithPressuresOfAnotherSpace) {
  SampleDataset quadratic(PressureSpace::p1, DisplacementSpace::p2);
  quadratic.problem.scene.discretization.pressure = PressureSpace::p2;
  quadratic.problem.pressures = pressureSlots(quadratic.problem);
  expectError(ExitCode::failed, [&] { quadratic.seal(copy); }, {"copy.h5", "nodal fields"});
}

TEST_F(SealedDataset, ReturnsMeshLatticeSceneAndNames) {
  const Dataset dataset(file);
  EXPECT_EQ(dataset.mesh().nodes, sample.problem.mesh.nodes);
  EXPECT_EQ(dataset.mesh().tetrahedra, sample.problem.mesh.tetrahedra);
  EXPECT_EQ(dataset.mesh().surface, sample.problem.mesh.surface);
  EXPECT_EQ(dataset.fixedNodes(), sample.problem.fixed);
  EXPECT_EQ(dataset.spaces()[0].lattice.size(), sample.lattice.size());
  EXPECT_EQ(dataset.spaces()[0].lattice.spacing(), sample.lattice.spacing());
  EXPECT_EQ(dataset.sceneToml(), resolvedToml(sample.problem.scene));
  EXPECT_EQ(dataset.scene().active.size(), 2u);
  EXPECT_EQ(dataset.kernelFamily(), "portable");
  EXPECT_EQ(dataset.buildId(), problemId(sample.problem));
  EXPECT_NO_THROW(dataset.verifyAll());
}

TEST_F(SealedDataset, ReturnsTheSurfaceOfSolvedPoints) {
  const Dataset dataset(file);
  EXPECT_EQ(dataset.surfaceNodes(), surfaceNodes(sample.problem.mesh));
  EXPECT_EQ(dataset.storedNodes(), dataset.surfaceNodes());
  EXPECT_EQ(dataset.surfaceNodes().size(), 26u) << "the middle of the cube is not on the surface";
  for (std::size_t s = 0; s < 2; ++s) {
    const std::vector<float> all = dataset.surfaceFields(s).displacement;
    ASSERT_EQ(all.size(), 33 * 26 * 3u);
    for (const std::int32_t point : {0, 1, 20, 31}) {
      const auto expected = displacementsOf(dataset.surfaceNodes(), sample.fields(s, point));
      EXPECT_EQ(dataset.fields(s, point).displacement, expected);
      EXPECT_TRUE(dataset.fields(s, point).pressure.empty());
      EXPECT_TRUE(std::equal(expected.begin(), expected.end(), all.begin() + point * 26 * 3));
    }
  }
  EXPECT_TRUE(std::isnan(dataset.surfaceFields(0).displacement[7 * 26 * 3]));
  expectBadInput([&] { dataset.fields(0, 7); }, {"sample.h5", "tip", "failed"});
}

TEST_F(SealedDataset, KeepsAllNodesAndPressuresOnRequest) {
  sample.problem.scene.storage.displacement = StoredNodes::all;
  sample.seal(copy);
  const Dataset all(copy), surface(file);
  EXPECT_EQ(all.storedNodes().size(), 27u);
  EXPECT_EQ(all.fields(1, 9).displacement, sample.fields(1, 9).displacement);
  EXPECT_EQ(all.fields(1, 9).pressure, sample.fields(1, 9).pressure);
  EXPECT_EQ(all.surfaceFields(1).displacement, surface.surfaceFields(1).displacement);
  const std::vector<float> pressures = all.surfaceFields(0).pressure;
  ASSERT_EQ(pressures.size(), 33 * 26u);
  for (std::size_t n = 0; n < 26; ++n) {
    const auto node = static_cast<std::size_t>(all.surfaceNodes()[n]);
    EXPECT_EQ(pressures[9 * 26 + n], sample.fields(0, 9).pressure[node]);
    EXPECT_TRUE(std::isnan(pressures[7 * 26 + n])) << "it is not solved";
  }
  EXPECT_TRUE(surface.surfaceFields(0).pressure.empty());
  EXPECT_EQ(all.buildId(), surface.buildId());
}

TEST_F(SealedDataset, QuantizesWithinItsBound) {
  for (const StoredNodes nodes : {StoredNodes::surface, StoredNodes::all}) {
    sample.problem.scene.storage = {nodes, StoredPrecision::int16};
    sample.seal(copy);
    const Dataset dataset(copy);
    EXPECT_NO_THROW(dataset.verifyAll());
    for (const std::int32_t point : {0, 1, 20, 31}) {
      const auto exact = displacementsOf(dataset.storedNodes(), sample.fields(0, point));
      const auto stored = dataset.fields(0, point).displacement;
      ASSERT_EQ(stored.size(), exact.size());
      const float largest = *std::max_element(exact.begin(), exact.end());
      for (std::size_t i = 0; i < exact.size(); ++i)
        EXPECT_LE(std::abs(stored[i] - exact[i]), 0.51 / 32767 * largest) << i;
    }
    EXPECT_TRUE(std::isnan(dataset.surfaceFields(0).displacement[7 * 26 * 3]));
  }
}

TEST_F(SealedDataset, IsReadWithoutASolvedPoint) {
  for (PointRecord& point : sample.spaces[1].points) {
    point = {};
    point.tag = Tag::failed;
    point.cause = Cause::unreachable;
  }
  sample.seal(copy);
  const Dataset dataset(copy);
  EXPECT_EQ(dataset.spaces()[1].points[0].cause, Cause::unreachable);
  EXPECT_THAT(dataset.surfaceFields(1).displacement, testing::Each(testing::IsNan()));
}

TEST_F(SealedDataset, WithoutPressureSpaceHasNoPressures) {
  SampleDataset plain(PressureSpace::none);
  plain.seal(copy);
  const Dataset dataset(copy);
  EXPECT_NO_THROW(dataset.verifyAll());
  EXPECT_TRUE(dataset.fields(1, 3).pressure.empty());
  EXPECT_EQ(dataset.fields(1, 3).displacement,
            displacementsOf(dataset.storedNodes(), plain.fields(1, 3)));
}

TEST_F(SealedDataset, HasTheSameBytesForTheSameArguments) {
  SampleDataset().seal(copy);
  EXPECT_TRUE(bytesIn(file) == bytesIn(copy));
}

TEST_F(SealedDataset, ContentHashFollowsResultsAndNotTheMachine) {
  const ContentId original = Dataset(file).contentId();
  sample.kernel_family = "avx2";
  sample.seal(copy);
  EXPECT_EQ(Dataset(copy).contentId(), original);
  sample.spaces[1].points[5].equilibrium.force.x() += 1e-12;
  sample.seal(copy);
  EXPECT_NE(Dataset(copy).contentId(), original);
}

TEST_F(SealedDataset, KeepsAVeryLongScene) {
  sample.problem.scene.fixed.nodes.assign(40000, 26);
  sample.seal(copy);
  EXPECT_EQ(Dataset(copy).sceneToml(), resolvedToml(sample.problem.scene));
  EXPECT_GT(Dataset(copy).sceneToml().size(), 150000u);
}

TEST_F(SealedDataset, IsReadWhileOpenInThisProcessWithOtherLocking) {
  for (const auto& [locks, without] :
       {std::pair(false, false), {false, true}, {true, false}, {true, true}}) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    ASSERT_GE(H5Pset_file_locking(access, locks, without), 0);
    const hid_t theirs = H5Fopen(file.c_str(), H5F_ACC_RDONLY, access);
    ASSERT_GE(theirs, 0);
    EXPECT_EQ(Dataset(file).spaces().size(), sample.spaces.size());
    EXPECT_GT(H5Lexists(theirs, "points", H5P_DEFAULT), 0);  // our reader closes nothing of this
                                                             // handle
    H5Fclose(theirs);
    H5Pclose(access);
  }
}

TEST_F(SealedDataset, IsNotCalledDamagedIfLeftOpenForWriting) {
  EXPECT_FALSE(hdf5::isOpenForWriting(file));
  std::filesystem::copy_file(file, copy);
  test::leaveOpenForWriting(copy);
  EXPECT_TRUE(hdf5::isOpenForWriting(copy));
  expectError(ExitCode::failed, [&] { readAll(copy); }, {"copy.h5", "h5clear -s"});
}

TEST_F(SealedDataset, IsRefusedWhenCutAtAnyLength) {
  const std::string whole = bytesIn(file);
  const std::size_t step = whole.size() / 150;
  for (std::size_t length = 0; length < whole.size(); length += length < 600 ? 37 : step) {
    putInto(copy, whole.substr(0, length));
    EXPECT_THROW(readAll(copy), Error) << length << " of " << whole.size() << " bytes";
  }
  putInto(copy, whole.substr(0, whole.size() - 1));
  expectError(ExitCode::failed, [&] { readAll(copy); }, {"copy.h5", "truncated"});
}

TEST_F(SealedDataset, NeverAnswersWronglyWhenAByteIsDamaged) {
  const std::string whole = bytesIn(file);
  const ContentId original = Dataset(file).contentId();
  int refused = 0, unharmed = 0;
  for (std::size_t at = 0; at < whole.size(); at += 101) {
    std::string bytes = whole;
    bytes[at] = static_cast<char>(bytes[at] ^ 0x10);
    putInto(copy, bytes);
    try {
      const Dataset dataset(copy);
      dataset.verifyAll();
      EXPECT_EQ(dataset.contentId(), original) << "byte " << at;
      ++unharmed;  // unused room between HDF5's structures, or generator and kernel_family
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 20 * unharmed / 10);
}

TEST_F(SealedDataset, NamesTheDamagedTable) {
  std::string bytes = bytesIn(file);
  const double energy = sample.spaces[0].points[9].equilibrium.energy;
  sample.spaces[0].points[9].equilibrium.energy = 0.1234567890123;
  sample.seal(copy);
  bytes = bytesIn(copy);
  const double marker = 0.1234567890123;
  bytes.replace(placeOf(bytes, {reinterpret_cast<const char*>(&marker), 8}), 8,
                reinterpret_cast<const char*>(&energy), 8);
  putInto(copy, bytes);
  expectError(ExitCode::failed, [&] { readAll(copy); }, {"copy.h5", "/points/energy", "blake2b"});
}

// sealDataset() reads the new file before it is renamed, and the reader refuses it.
TEST_F(SealedDataset, IsRefusedIfInterpolatingItsNumbersOverflows) {
  const auto refused = [&](auto&& forge) {
    SampleDataset forged = sample;
    forge(forged);
    expectError(ExitCode::failed, [&] { forged.seal(copy); },
                {"copy.h5.tmp", "/points/force", "exceeds 1e+30"});
  };
  refused([](SampleDataset& s) { s.spaces[0].points[3].equilibrium.force[1] = 1e303; });
  refused([](SampleDataset& s) { s.spaces[1].points[4].equilibrium.stiffness(2, 0) = -1.1e30; });
  refused([](SampleDataset& s) { s.spaces[0].points[3].equilibrium.energy = NAN; });
  sample.spaces[0].points[3].equilibrium.force[1] = 1e29;
  sample.seal(copy);
  readAll(copy);
  sample.problem.mesh.nodes[4][0] = 1e200;
  expectError(ExitCode::failed, [&] { sample.seal(copy); }, {"/mesh/points", "far too large"});
}

TEST_F(SealedDataset, AFileThatIsNotADatasetIsNamed) {
  expectBadInput([&] { Dataset(directory / "none.h5"); }, {"none.h5", "no such"});
  expectBadInput([&] { Dataset(directory.path()); }, {directory.path().string(), "not a file"});
  putInto(copy, "name = \"liver\"\n");
  expectBadInput([&] { Dataset{copy}; }, {"copy.h5", "not an HDF5 file"});
  putInto(copy, "");
  expectBadInput([&] { Dataset{copy}; }, {"copy.h5", "not an HDF5 file"});
}

TEST_F(SealedDataset, IsReplacedAsAWholeDespiteLeftoversOfAKilledSealing) {
  const std::string before = bytesIn(file);
  putInto(aside, before.substr(0, before.size() / 2));
  EXPECT_NO_THROW(readAll(file));
  sample.spaces[1].points[5].equilibrium.energy += 1;
  sample.seal(file);
  EXPECT_FALSE(std::filesystem::exists(aside));
  EXPECT_EQ(Dataset(file).spaces()[1].points[5].equilibrium.energy,
            sample.spaces[1].points[5].equilibrium.energy);
}

TEST_F(SealedDataset, IsKeptIfItsReplacementCannotBeSealed) {
  const std::string before = bytesIn(file);
  const FieldsSource broken = [this](std::size_t space, std::int32_t point) {
    return point == 30 ? throw failure("journal segment 3 is damaged")
                       : sample.fields(space, point);
  };
  expectError(ExitCode::failed,
              [&] { sealDataset(file, sample.problem, rowsOf(sample.spaces), "portable", broken); },
              {"segment 3"});
  sample.spaces[1].points[4].fields = ContentId::of("another result");
  expectError(ExitCode::failed, [&] { sample.seal(file); }, {"edge-2", "lattice point 4"});
  EXPECT_TRUE(bytesIn(file) == before);
  EXPECT_FALSE(std::filesystem::exists(aside));
}

TEST_F(SealedDataset, IsNotSealedFromMismatchedArguments) {
  const auto seal = [&](const std::vector<SpaceTable>& spaces) {
    sealDataset(
        directory / "no.h5", sample.problem, rowsOf(spaces), "portable",
        [this](std::size_t space, std::int32_t point) { return sample.fields(space, point); });
  };
  const std::vector<SpaceTable> exchanged = {sample.spaces[1], sample.spaces[0]},
                                one = {sample.spaces[0]};
  std::vector<SpaceTable> shorter = sample.spaces, finer = sample.spaces;
  finer[0].lattice = Lattice(0.02, 0.005);
  shorter[1].points.pop_back();
  for (const auto& spaces : {finer, one, exchanged, shorter})
    EXPECT_THROW(seal(spaces), std::logic_error);
  EXPECT_FALSE(std::filesystem::exists(directory / "no.h5"));
}

TEST_F(SealedDataset, IsNotSealedFromInconsistentTables) {
  sample.refine();
  const auto refused = [&](auto&& spoil, const std::string& fault) {
    SampleDataset spoiled = sample;
    spoil(spoiled.spaces[1]);
    EXPECT_THAT(faultOf(spoiled.spaces[1]), HasSubstr(fault));
    expectError(ExitCode::failed, [&] { spoiled.seal(directory / "no.h5"); },
                {"no.h5", "edge-2", fault});
  };
  EXPECT_EQ(faultOf(sample.spaces[1]), "");
  const std::int32_t size = sample.spaces[1].lattice.size();
  refused([](SpaceTable& t) { std::swap(t.splits[0], t.splits[1]); }, "not sorted");
  refused([](SpaceTable& t) { t.splits.erase(t.splits.begin()); }, "in a cell that is not split");
  refused([](SpaceTable& t) { t.splits[1].lowest[0] += 1; }, "split cell 1 is not a cell");
  refused([](SpaceTable& t) { t.splits[0].lowest[2] = 1024 * 5; }, "split cell 0 is not a cell");
  refused([](SpaceTable& t) { t.splits[1].level = 10; }, "split cell 1");
  refused([](SpaceTable& t) { t.probes[0].displacement[1] = NAN; }, "probe 0 lies outside");
  refused([](SpaceTable& t) { t.probes[1].displacement[1] = 0.0201; }, "probe 1 lies outside");
  refused([&](SpaceTable& t) { t.probes[1].record.parent = size; },
          "probe 1 has the invalid parent");
  refused([&](SpaceTable& t) { t.points[4].parent = size; }, "point 4 has the invalid parent");
  refused([](SpaceTable& t) { t.attempts = {{3, -1, {}}}; }, "-1 to 3");
  refused(
      [](SpaceTable& t) {
        t.lattice.add({4097, 0, 0});
        t.points.push_back(t.points[3]);
      },
      "far outside");
  EXPECT_FALSE(std::filesystem::exists(directory / "no.h5"));
}

TEST_F(SealedDataset, IsKeptIfTheDiskIsFull) {
  const std::string before = bytesIn(file);
  // A file size limit makes write() fail like a full disk. The limit applies to a whole process, so
  // a child sets it.
  for (std::size_t limit = 0; limit < before.size(); limit += before.size() / 12) {
    const pid_t child = test::startChild([&] {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit size_limit = {limit, limit};
      if (setrlimit(RLIMIT_FSIZE, &size_limit) != 0) return 10;
      expectError(ExitCode::failed, [&] { sample.seal(file); }, {"sample.h5"});
      return HasFailure() ? 11 : 0;
    });
    EXPECT_EQ(test::codeOf(child), 0) << "limit " << limit;
    EXPECT_FALSE(std::filesystem::exists(aside));
    EXPECT_TRUE(bytesIn(file) == before);
  }
}

TEST_F(SealedDataset, IsNotSealedToADirectoryOrAMissingFolder) {
  expectBadInput([&] { sample.seal(directory.path()); }, {directory.path().string(), "directory"});
  expectError(ExitCode::failed, [&] { sample.seal(directory / "no" / "such" / "x.h5"); },
              {"x.h5", "No such file"});
}

}  // namespace
}  // namespace palpate
