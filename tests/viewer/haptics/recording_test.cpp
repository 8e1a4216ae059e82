#include "viewer/haptics/recording.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "common/base/error.hpp"
#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/viewer/haptics/scripted_hand.hpp"

namespace palpate {
namespace {

using test::TemporaryDirectory;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

RecordedRun someRun() {
  RecordedRun run;
  run.models = {{"liver", "soft liver.h5", ContentId::of("soft"), ContentId::of("scene")},
                {"liver", "stiff.h5", ContentId::of("b"), ContentId::of("other")}};
  run.methods = {"potential", "trilinear"};
  run.device = "virtual hand";
  run.profile = {"omega", 12, 5000, 0.075};
  run.scene_frame = true;
  run.options.period = 2e-4;
  run.options.contact = {ContactMode::glued, 0.3, 0.004, 0.001, 0.02};
  run.options.guard = guardFor(run.profile, 2e-4);
  run.options.map.rotation = Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).matrix();
  run.options.map.scale = 1.7;
  run.options.map.origin = {0.1, -0.2, 1.0 / 3};
  return run;
}

HapticState someState(std::uint64_t tick, std::mt19937& random) {
  std::normal_distribution<double> number;
  const auto vector = [&] {
    return Eigen::Vector3d(number(random), number(random), number(random));
  };
  HapticState state;
  state.tick = tick;
  state.time = static_cast<double>(tick) * 2e-4;
  state.reading = {vector(), static_cast<std::uint32_t>(random()),
                   static_cast<DeviceStatus>(random() % 3)};
  if (tick % 7 == 0) state.reading.position.y() = not_a_number;
  state.reading.held = {static_cast<std::uint16_t>(random()), static_cast<std::uint16_t>(random()),
                        number(random), number(random), number(random)};
  state.tool = vector();
  state.touch.touching = random() % 2 == 0;
  state.touch.inside = random() % 2 == 0;
  state.touch.coverage = std::abs(number(random));
  state.touch.force = vector();
  state.touch.anchor_position = vector();
  state.touch.displacement = vector();
  state.touch.energy = tick % 5 == 0 ? not_a_number : number(random);
  state.touch.error_bound = not_a_number;
  state.force = vector();
  state.guards = static_cast<std::uint32_t>(random());
  state.model = static_cast<std::int32_t>(random() % 2);
  state.method = static_cast<std::int32_t>(random() % 2);
  return state;
}

std::vector<HapticState> someStates(std::uint64_t ticks) {
  std::mt19937 random(5);
  std::vector<HapticState> states;
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) states.push_back(someState(tick, random));
  return states;
}

Recorder someRecorder(std::uint64_t ticks) {
  Recorder recorder(someRun());
  for (const HapticState& state : someStates(ticks)) recorder.add(state);
  return recorder;
}

std::string bytesOf(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Compares bit by bit, so that NaN equals NaN.
template <class T>
bool sameBits(const T& a, const T& b) {
  return std::memcmp(static_cast<const void*>(&a), static_cast<const void*>(&b), sizeof(T)) == 0;
}
template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
  return std::ranges::equal(a, b, [](const T& x, const T& y) { return sameBits(x, y); });
}

TEST(Recording, HoldsEveryTickToTheLastBit) {
  const TemporaryDirectory folder;
  const std::vector<HapticState> states = someStates(1000);
  someRecorder(1000).save(folder / "run.h5");
  hdf5::Reader in(folder / "run.h5");
  in.findArrays();
  using State = const HapticState&;
  const auto expect = [&](const char* path, auto value) {
    using Value = std::decay_t<decltype(value(states.front()))>;
    std::vector<Value> wanted;
    for (State state : states) wanted.push_back(value(state));
    EXPECT_TRUE(sameBits(in.readList<Value>(path), wanted)) << path;
  };
  expect("/time", [](State s) { return s.time; });
  expect("/device/position", [](State s) { return s.reading.position; });
  expect("/device/buttons", [](State s) { return s.reading.buttons; });
  expect("/device/status", [](State s) { return s.reading.status; });
  expect("/tool/position", [](State s) { return s.tool; });
  expect("/force/rendered", [](State s) { return s.force; });
  expect("/force/raw", [](State s) { return s.touch.force; });
  expect("/contact/touching", [](State s) { return std::uint8_t{s.touch.touching}; });
  expect("/contact/inside", [](State s) { return std::uint8_t{s.touch.inside}; });
  expect("/contact/coverage", [](State s) { return s.touch.coverage; });
  expect("/contact/followed", [](State s) { return s.touch.followed; });
  expect("/contact/energy", [](State s) { return s.touch.energy; });
  expect("/contact/error_bound", [](State s) { return s.touch.error_bound; });
  expect("/guards", [](State s) { return s.guards; });
  expect("/model", [](State s) { return s.model; });
  expect("/method", [](State s) { return s.method; });
  const auto anchors = in.readList<Eigen::Vector3d>("/contact/anchor"),
             displacements = in.readList<Eigen::Vector3d>("/contact/displacement");
  ASSERT_EQ(anchors.size(), states.size());
  ASSERT_EQ(displacements.size(), states.size());
  for (std::size_t n = 0; n < states.size(); ++n) {
    const Touch& touch = states[n].touch;
    const Eigen::Vector3d nowhere = Eigen::Vector3d::Zero();
    EXPECT_EQ(anchors[n], touch.touching ? touch.anchor_position : nowhere);
    EXPECT_EQ(displacements[n], touch.touching ? touch.displacement : nowhere);
  }
}

TEST(Recording, ReturnsTheReadingsOfTheDeviceToTheLastBit) {
  const TemporaryDirectory folder;
  const Recorder recorder = someRecorder(1000);
  EXPECT_TRUE(recorder.complete());
  recorder.save(folder / "run.h5");
  const Recording read = readRecording(folder / "run.h5");
  EXPECT_EQ(read.rate, 5000);
  EXPECT_TRUE(read.scene_frame);
  EXPECT_EQ(read.profile, someRun().profile);
  const std::vector<HapticState> states = someStates(1000);
  ASSERT_EQ(read.readings.size(), states.size());
  for (std::size_t n = 0; n < states.size(); ++n) {
    EXPECT_TRUE(sameBits(read.readings[n].position, states[n].reading.position)) << n;
    EXPECT_EQ(read.readings[n].buttons, states[n].reading.buttons);
    EXPECT_EQ(read.readings[n].status, states[n].reading.status);
    EXPECT_EQ(read.readings[n].held, states[n].reading.held) << n;
  }
}

TEST(Recording, HoldsTheSecondFingerOfARunThatHasOne) {
  const TemporaryDirectory folder;
  std::vector<HapticState> states = someStates(20);
  for (std::size_t n = 5; n < 10; ++n) {
    states[n].hold = Hold{states[n].tool, states[n].force};
    states[n].hold_force = {states[n].tool, 0.1 * static_cast<double>(n)};
  }
  Recorder recorder(someRun());
  for (const HapticState& state : states) recorder.add(state);
  recorder.save(folder / "run.h5");
  hdf5::Reader in(folder / "run.h5");
  in.findArrays();
  const auto anchors = in.readList<Eigen::Vector3d>("/hold/anchor"),
             displacements = in.readList<Eigen::Vector3d>("/hold/displacement"),
             forces = in.readList<Eigen::Vector3d>("/hold/force");
  const auto bounds = in.readList<double>("/hold/error_bound");
  ASSERT_EQ(anchors.size(), states.size());
  for (std::size_t n = 0; n < states.size(); ++n) {
    if (!states[n].hold) {
      EXPECT_TRUE(anchors[n].hasNaN() && displacements[n].hasNaN() && forces[n].hasNaN()) << n;
      continue;
    }
    EXPECT_EQ(anchors[n], states[n].hold->place);
    EXPECT_EQ(displacements[n], states[n].hold->displacement);
    EXPECT_EQ(forces[n], states[n].hold_force.force);
    EXPECT_EQ(bounds[n], states[n].hold_force.error_bound);
  }
  EXPECT_EQ(readRecording(folder / "run.h5").readings.size(), states.size());
  EXPECT_EQ(
      std::ranges::count(readRecording(folder / "run.h5").touches, true, &RecordedTouch::held), 5);
  someRecorder(20).save(folder / "alone.h5");
  hdf5::Reader alone(folder / "alone.h5");
  alone.findArrays();
  EXPECT_EQ(std::ranges::count_if(
                alone.arrays(),
                [](const hdf5::ArrayInfo& array) { return array.path.starts_with("/hold"); }),
            0);
}

TEST(Recording, MovesASecondFingerLikeItsTool) {
  const test::TouchedCube cube;
  const Eigen::Vector3d place(0.05, 0.05, 0.1), slid(0.055, 0.05, 0.1), deep(0, 0, -0.003);
  Recording recording;
  const auto touchAt = [&](const Eigen::Vector3d& anchor) {
    RecordedTouch touch;
    touch.touching = true;
    touch.anchor = anchor;
    touch.displacement = deep;
    return touch;
  };
  recording.touches = {{}, touchAt(place), touchAt(slid), {}, touchAt(slid)};
  const auto holds = holdsOf(recording, cube.model().surface(), "run.h5");
  ASSERT_EQ(holds.size(), 5u);
  EXPECT_FALSE(holds[0] || holds[3]);
  EXPECT_EQ(holds[1].value().place, place);
  EXPECT_EQ(holds[2].value().place, slid);
  EXPECT_EQ(holds[2]->displacement, deep);
  recording.touches[2].anchor.z() += 0.01;
  test::expectBadInput([&] { holdsOf(recording, cube.model().surface(), "run.h5"); },
                       {"run.h5", "tick 3", "another body"});
}

TEST(Recording, ReturnsTheTouchOfEveryTick) {
  const TemporaryDirectory folder;
  someRecorder(100).save(folder / "run.h5");
  const std::vector<RecordedTouch> read = readRecording(folder / "run.h5").touches;
  const std::vector<HapticState> states = someStates(100);
  ASSERT_EQ(read.size(), states.size());
  for (std::size_t n = 0; n < states.size(); ++n) {
    const Touch& touch = states[n].touch;
    EXPECT_EQ(read[n].time, states[n].time);
    EXPECT_TRUE(sameBits(read[n].tool, states[n].tool)) << n;
    EXPECT_TRUE(sameBits(read[n].force, touch.force)) << n;
    EXPECT_EQ(read[n].touching, touch.touching);
    if (!touch.touching) continue;
    EXPECT_TRUE(sameBits(read[n].anchor, touch.anchor_position)) << n;
    EXPECT_TRUE(sameBits(read[n].displacement, touch.displacement)) << n;
    EXPECT_TRUE(sameBits(read[n].error_bound, touch.error_bound)) << n;
  }
}

TEST(Recording, RecordsTheSettingsOfTheRun) {
  const TemporaryDirectory folder;
  someRecorder(3).save(folder / "run.h5");
  hdf5::Reader in(folder / "run.h5");
  in.findArrays();
  const RecordedRun wanted = someRun();
  EXPECT_EQ(in.text("models"), R"(["liver","liver"])");
  EXPECT_EQ(in.text("datasets"), R"(["soft liver.h5","stiff.h5"])");
  EXPECT_EQ(in.text("content_ids"), fmt::format(R"(["{}","{}"])", wanted.models[0].dataset.hex(),
                                                wanted.models[1].dataset.hex()));
  EXPECT_EQ(readRecording(folder / "run.h5").builds,
            (std::vector{ContentId::of("scene"), ContentId::of("other")}));
  EXPECT_EQ(in.text("methods"), R"(["potential","trilinear"])");
  EXPECT_EQ(in.text("device"), "virtual hand");
  EXPECT_EQ(in.text("profile"), "omega");
  EXPECT_EQ(in.text("contact_mode"), "glued");
  EXPECT_EQ(in.number("rate"), 5000);
  EXPECT_EQ(in.number("period"), wanted.options.period);
  EXPECT_EQ(in.number("profile_max_force"), 12);
  EXPECT_EQ(in.number("contact_friction"), 0.3);
  EXPECT_EQ(in.number("contact_grab_distance"), 0.004);
  EXPECT_EQ(in.number("contact_most_slide"), 0.001);
  EXPECT_EQ(in.number("contact_most_relaxation"), 0.02);
  EXPECT_EQ(in.number("guard_max_slew"), wanted.options.guard.max_slew);
  EXPECT_EQ(in.number("guard_energy_credit"), wanted.options.guard.energy_credit);
  EXPECT_EQ(in.number("workspace_scale"), 1.7);
  const std::vector<double> rotation = in.read<double>("/workspace/rotation", {3, 3});
  EXPECT_EQ(hdf5::RowMajorMatrix3d(rotation.data()), wanted.options.map.rotation);
  EXPECT_EQ(in.read<double>("/workspace/origin", {3}), (std::vector{0.1, -0.2, 1.0 / 3}));
}

TEST(Recording, AnEmptyRunIsARecording) {
  const TemporaryDirectory folder;
  someRecorder(0).save(folder / "run.h5");
  EXPECT_TRUE(readRecording(folder / "run.h5").readings.empty());
}

TEST(Recording, SavesTheSameBytesEveryTimeAndReplacesTheOldFile) {
  const TemporaryDirectory folder;
  someRecorder(10).save(folder / "a.h5");
  someRecorder(100).save(folder / "a.h5");
  someRecorder(100).save(folder / "b.h5");
  EXPECT_EQ(bytesOf(folder / "a.h5"), bytesOf(folder / "b.h5"));
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

TEST(Recording, ReportsMissingTicks) {
  std::mt19937 random(5);
  Recorder recorder(someRun());
  recorder.add(someState(1, random));
  recorder.add(someState(2, random));
  EXPECT_TRUE(recorder.complete());
  recorder.add(someState(4, random));
  EXPECT_FALSE(recorder.complete());
  test::expectError(ExitCode::failed, [&] { recorder.add(someState(3, random)); }, {"added after"});
}

TEST(Recording, IsNotReadFromForeignFiles) {
  const TemporaryDirectory folder;
  test::expectBadInput([&] { readRecording(folder / "none.h5"); },
                       {"none.h5", "no such recording"});
  std::ofstream(folder / "text.h5") << "hello";
  test::expectBadInput([&] { readRecording(folder / "text.h5"); }, {"text.h5", "not an HDF5 file"});
  test::SampleDataset().seal(folder / "dataset.h5");
  test::expectBadInput([&] { readRecording(folder / "dataset.h5"); },
                       {"dataset.h5", "not a recording"});
}

TEST(Recording, IsRefusedInALaterFormat) {
  const TemporaryDirectory folder;
  const std::int32_t version = 2;
  {
    hdf5::Writer out(folder / "run.h5");
    out.setText("/", "format", "palpate-recording");
    out.setIntegers("/", "format_version", std::span(&version, 1));
    out.close();
  }
  test::expectBadInput([&] { readRecording(folder / "run.h5"); }, {"format 2", "format 1"});
}

TEST(Recording, CutAtAnyLengthIsAnErrorThatNamesTheFile) {
  const TemporaryDirectory folder;
  someRecorder(20).save(folder / "run.h5");
  const std::string whole = bytesOf(folder / "run.h5");
  for (std::size_t size = 0; size < whole.size(); size += 97) {
    std::ofstream(folder / "cut.h5", std::ios::binary) << whole.substr(0, size);
    try {
      readRecording(folder / "cut.h5");
      ADD_FAILURE() << "read with " << size << " bytes";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr("cut.h5"));
    }
  }
}

TEST(Recording, AChangedByteIsAnErrorOrGivesTheSameReadings) {
  const TemporaryDirectory folder;
  const std::vector<HapticState> states = someStates(20);
  someRecorder(20).save(folder / "run.h5");
  const std::string whole = bytesOf(folder / "run.h5");
  int refused = 0, tried = 0;
  for (std::size_t at = 0; at < whole.size(); at += 61, ++tried) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x5a);
    std::ofstream(folder / "bad.h5", std::ios::binary) << damaged;
    try {
      const Recording read = readRecording(folder / "bad.h5");
      ASSERT_EQ(read.readings.size(), states.size()) << at;
      for (std::size_t n = 0; n < states.size(); ++n) {
        EXPECT_TRUE(sameBits(read.readings[n].position, states[n].reading.position)) << at;
        EXPECT_EQ(read.readings[n].buttons, states[n].reading.buttons) << at;
      }
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, tried / 4);
}

/// Overwrites an array in place. With an updated hash, a foreign program could have written it;
/// without, it is damage on disk.
template <class T>
void rewrite(const std::filesystem::path& file, const char* path, std::vector<T> values,
             const hdf5::Shape& shape, bool with_hash = true) {
  const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t array = H5Dopen2(opened, path, H5P_DEFAULT);
  ASSERT_GE(array, 0);
  ASSERT_EQ(values.size(), hdf5::countOf(shape));
  const hid_t type = H5Dget_type(array);
  ASSERT_GE(H5Dwrite(array, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  const std::string hash = ContentId::of(palpate::bytesOf(std::span<const T>(values))).hex();
  if (with_hash) {
    const hid_t attribute = H5Aopen(array, hdf5::hash_attribute, H5P_DEFAULT);
    const hid_t text = H5Aget_type(attribute);
    ASSERT_GE(H5Awrite(attribute, text, hash.data()), 0);
    H5Tclose(text);
    H5Aclose(attribute);
  }
  H5Tclose(type);
  H5Dclose(array);
  H5Fclose(opened);
}

TEST(Recording, IsRefusedWithImpossibleValues) {
  const TemporaryDirectory folder;
  someRecorder(3).save(folder / "run.h5");
  rewrite<std::uint8_t>(folder / "run.h5", "/device/status", {0, 4, 0}, {3});
  test::expectError(ExitCode::failed, [&] { readRecording(folder / "run.h5"); },
                    {"run.h5", "/device/status"});
}

TEST(Recording, IsRefusedForDamageThatAReplayWouldNotRead) {
  const TemporaryDirectory folder;
  someRecorder(3).save(folder / "run.h5");
  rewrite<double>(folder / "run.h5", "/time", {1, 3, 2}, {3}, false);
  test::expectError(ExitCode::failed, [&] { readRecording(folder / "run.h5"); },
                    {"run.h5", "/time"});
}

/// Returns 0 if saving to a disk with room for `limit` bytes of a file throws an Error that names
/// the file.
int saveToAFullDisk(const Recorder& recorder, const std::filesystem::path& file,
                    std::size_t limit) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit size_limit = {limit, limit};
  if (setrlimit(RLIMIT_FSIZE, &size_limit) != 0) return 10;
  try {
    recorder.save(file);
    return 11;
  } catch (const Error& error) {
    return std::string(error.what()).find("run.h5") == std::string::npos ? 12 : 0;
  }
}

TEST(Recording, LeavesOnlyTheOldFileOnAFullDisk) {
  const TemporaryDirectory folder;
  const std::filesystem::path file = folder / "run.h5";
  someRecorder(10).save(file);
  const std::string before = bytesOf(file);
  const Recorder recorder = someRecorder(2000);
  // In a child, because the limit applies to a whole process.
  for (std::size_t limit = 0; limit < 300000; limit += 60000) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) _exit(saveToAFullDisk(recorder, file, limit));
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
        << "limit " << limit << ", status " << status;
    EXPECT_EQ(bytesOf(file), before);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  }
}

TEST(Recording, IsNotSavedToADirectory) {
  const TemporaryDirectory folder;
  test::expectBadInput([&] { someRecorder(1).save(folder.path()); }, {"is a directory"});
  test::expectError(ExitCode::failed, [&] { someRecorder(1).save(folder / "no" / "run.h5"); },
                    {"run.h5"});
}

}  // namespace
}  // namespace palpate
