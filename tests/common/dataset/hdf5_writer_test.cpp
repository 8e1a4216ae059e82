#include "common/dataset/hdf5_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <limits>
#include <thread>

#include "common/dataset/hdf5_reader.hpp"
#include "tests/support/child.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::hdf5 {
namespace {

using test::expectError;
using testing::Each;
using testing::ElementsAre;

/// Needed by all tests of this program that fill a disk.
[[maybe_unused]] const bool exit_leaves_files = (leaveOpenFilesAtExit(), true);

/// A RowWriter passes on a mebibyte at a time: rows of 24 bytes do not end there, rows of 32 do.
constexpr std::size_t mebibyte = std::size_t{1} << 20;

struct Hdf5WriterTest : testing::Test {
  test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "list.h5";

  static std::vector<Eigen::Vector3d> vectors(std::size_t count) {
    std::vector<Eigen::Vector3d> list(count);
    for (std::size_t n = 0; n < count; ++n)
      list[n] = {static_cast<double>(n), -static_cast<double>(n) / 7, 1e-300};
    return list;
  }
  Reader read() const {
    Reader reader(file);
    reader.findArrays();
    return reader;
  }
  /// Runs `action` in a process that may write at most `most` bytes to a file. Expects it to exit
  /// normally with 0; reports what it throws.
  static void expectToEndWell(rlim_t most, const std::function<int()>& action) {
    const pid_t child = test::startChild([&] {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit = {most, most};
      if (most != RLIM_INFINITY && setrlimit(RLIMIT_FSIZE, &limit) != 0) return 100;
      return action();
    });
    EXPECT_EQ(test::codeOf(child), 0);
  }
};

template <class T>
void writeRowByRow(Writer& writer, const std::string& path, const std::vector<T>& list) {
  RowWriter rows = writer.list<T>(path, list.size(), "m");
  for (const T& row : list) rows.add(row);
  rows.finish();
}

TEST_F(Hdf5WriterTest, AListWrittenByRowsHasTheSameBytesAsAWholeOne) {
  std::vector<std::int32_t> numbers(300001);
  std::vector<ContentId> ids(mebibyte / 32 + 1);
  for (std::size_t n = 0; n < numbers.size(); ++n) numbers[n] = static_cast<std::int32_t>(n * n);
  for (std::size_t n = 0; n < ids.size(); ++n) ids[n] = ContentId::of(std::to_string(n));
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{1000}, mebibyte / 24,
                                  mebibyte / 24 + 1, 3 * mebibyte / 24 + 100}) {
    const auto list = vectors(count);
    Writer whole(directory / "whole.h5");
    whole.makeGroup("/points");
    whole.writeList("/points/force", list, "m");
    whole.writeList("/points/number", numbers, "m");
    whole.writeList("/points/fields", ids, "m");
    whole.close();
    Writer rows(file);
    rows.makeGroup("/points");
    writeRowByRow(rows, "/points/force", list);
    writeRowByRow(rows, "/points/number", numbers);
    writeRowByRow(rows, "/points/fields", ids);
    rows.close();
    EXPECT_TRUE(test::bytesIn(file) == test::bytesIn(directory / "whole.h5")) << count << " rows";
    ASSERT_EQ(rows.arrays().size(), 3u);
    for (std::size_t n = 0; n < 3; ++n) {
      EXPECT_EQ(rows.arrays()[n].path, whole.arrays()[n].path);
      EXPECT_EQ(rows.arrays()[n].shape, whole.arrays()[n].shape);
      EXPECT_EQ(rows.arrays()[n].hash, whole.arrays()[n].hash);
    }
  }
}

/// The points of a space are written like this: each point adds its numbers to twenty lists.
TEST_F(Hdf5WriterTest, InterleavedListsDoNotMix) {
  const auto list = vectors(100000);
  std::vector<double> lengths;
  Writer writer(file);
  RowWriter forces = writer.list<Eigen::Vector3d>("/force", list.size(), "N");
  RowWriter norms = writer.list<double>("/norm", list.size(), "N");
  for (const Eigen::Vector3d& force : list) {
    forces.add(force);
    lengths.push_back(force.norm());
    norms.add(lengths.back());
  }
  norms.finish();
  forces.finish();
  writer.close();
  EXPECT_TRUE(read().readList<Eigen::Vector3d>("/force") == list);
  EXPECT_TRUE(read().readList<double>("/norm") == lengths);
}

/// A build may have ten million points.
TEST_F(Hdf5WriterTest, TheMemoryOfAListDoesNotGrowWithItsLength) {
  expectToEndWell(RLIM_INFINITY, [&] {
    constexpr hsize_t rows = 64 * mebibyte / 32;
    const auto peak = [] {
      rusage usage{};
      getrusage(RUSAGE_SELF, &usage);
      return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
    };
    Writer writer(file);
    RowWriter list(writer, "/rows", Element::uint8, {rows, 32}, "1");
    const std::size_t before = peak();
    const std::string row(32, 'r');
    for (hsize_t n = 0; n < rows; ++n) list.addBytes(row);
    list.finish();
    writer.close();
    const std::size_t grown = peak() - before;
    if (grown > 16 * mebibyte) std::fprintf(stderr, "by %zu bytes\n", grown);
    return grown > 16 * mebibyte ? 1 : 0;
  });
  EXPECT_GT(std::filesystem::file_size(file), 64 * mebibyte);
}

TEST_F(Hdf5WriterTest, AnOpenListOfAClosedFileIsAnErrorThatNamesBoth) {
  const auto addTo = [&](std::size_t before, std::size_t after) {
    Writer writer(file);
    RowWriter list = writer.list<double>("/energy", before + after, "J");
    for (std::size_t n = 0; n < before; ++n) list.add(1.0);
    writer.close();
    for (std::size_t n = 0; n < after; ++n) list.add(2.0);
    list.finish();
  };
  expectError(ExitCode::failed, [&] { addTo(5, 0); }, {"list.h5", "/energy"});
  expectError(ExitCode::failed, [&] { addTo(0, 300000); }, {"list.h5", "/energy"});
  expectError(ExitCode::failed, [&] { addTo(0, 0); }, {"list.h5", "blake2b"});
}

/// Regression: the whole list was computed before the error was reported. After the error, the
/// process can write another file.
TEST_F(Hdf5WriterTest, AFullDiskIsReportedSoonAndSurvived) {
  for (const rlim_t room : {0 * mebibyte, mebibyte / 2, 3 * mebibyte}) {
    SCOPED_TRACE(room);
    expectToEndWell(room, [&] {
      constexpr hsize_t rows = 16 * mebibyte / 8;
      hsize_t added = 0;
      expectError(ExitCode::failed,
                  [&] {
                    Writer writer(file);
                    RowWriter list = writer.list<double>("/energy", rows, "J");
                    for (; added < rows; ++added) list.add(1.0);
                  },
                  {"list.h5", "ulimit -f"});
      EXPECT_LE(8 * added, room + 3 * mebibyte);
      const rlimit enough = {RLIM_INFINITY, RLIM_INFINITY};
      if (setrlimit(RLIMIT_FSIZE, &enough) == 0) {  // as root
        Writer writer(file);
        writeRowByRow(writer, "/force", vectors(3));
        writer.close();
        EXPECT_EQ(read().readList<Eigen::Vector3d>("/force"), vectors(3));
      }
      return HasFailure() ? 1 : 0;
    });
  }
}

TEST_F(Hdf5WriterTest, AFullDeviceIsReportedWithTheSystemsMessage) {
  expectToEndWell(RLIM_INFINITY, [] {
    expectError(ExitCode::failed,
                [] {
                  Writer writer("/dev/full");
                  writeRowByRow(writer, "/force", vectors(3));
                  writer.close();
                },
                {"/dev/full", "No space left on device"});
    return HasFailure() ? 1 : 0;
  });
}

/// The last bytes are written when the file is closed.
TEST_F(Hdf5WriterTest, ADiskThatFillsAtTheEndIsReportedByClosing) {
  const auto write = [&] {
    Writer writer(file);
    writeRowByRow(writer, "/force", vectors(1000));
    writer.close();
  };
  write();
  const std::size_t size = std::filesystem::file_size(file);
  for (const std::size_t less : {std::size_t{1}, std::size_t{100}, size / 2, size})
    expectToEndWell(size - less, [&] {
      expectError(ExitCode::failed, write, {"list.h5", "ulimit -f"});
      return HasFailure() ? 1 : 0;
    });
  expectToEndWell(size, [&] {
    write();
    return 0;
  });
}

TEST_F(Hdf5WriterTest, SkippedRowsReadAsNaN) {
  Writer writer(file);
  RowWriter floats(writer, "/displacement", Element::float32, {3, 2}, "m", RowLayout::compressed);
  RowWriter integers(writer, "/quantized", Element::int16, {2, 2}, "1", RowLayout::compressed);
  const std::vector<float> first = {1.5F, -2}, third = {0.F, 4.F};
  const std::vector<std::int16_t> second = {7, -8};
  floats.addBytes(bytesOf(std::span(first)));
  floats.skip();
  integers.skip();
  floats.addBytes(bytesOf(std::span(third)));
  integers.addBytes(bytesOf(std::span(second)));
  floats.finish();
  integers.finish();
  writer.close();
  const Reader reader = read();
  const auto stored = reader.read<float>("/displacement", {3, 2});
  EXPECT_EQ((std::vector(stored.begin(), stored.begin() + 2)), first);
  EXPECT_TRUE(std::isnan(stored[2]) && std::isnan(stored[3]));
  EXPECT_EQ((std::vector(stored.begin() + 4, stored.end())), third);
  constexpr std::int16_t lowest = std::numeric_limits<std::int16_t>::lowest();
  EXPECT_THAT(reader.read<std::int16_t>("/quantized", {2, 2}), ElementsAre(lowest, lowest, 7, -8));
  for (const ArrayInfo& info : reader.arrays()) EXPECT_NO_THROW(reader.verify(info));
}

TEST_F(Hdf5WriterTest, EveryRowIsWrittenOrSkippedOnce) {
  const std::string row(8, '\0');
  Writer writer(file);
  RowWriter rows(writer, "/a", Element::float32, {2, 2}, "m", RowLayout::compressed);
  EXPECT_THROW(rows.addBytes(row + row), std::logic_error);
  rows.addBytes(row);
  EXPECT_THROW(rows.finish(), std::logic_error);
  rows.skip();
  EXPECT_THROW(rows.addBytes(row), std::logic_error);
  rows.finish();
  RowWriter more(writer, "/b", Element::float32, {1, 2}, "m", RowLayout::compressed);
  more.skip();
  EXPECT_THROW(more.skip(), std::logic_error);
  more.finish();
  RowWriter whole(writer, "/whole", Element::float64, {1}, "m");
  EXPECT_THROW(whole.skip(), std::logic_error) << "it would not read as NaN";
  EXPECT_THROW(RowWriter(writer, "/c", Element::float64, {1, 2}, "m", RowLayout::compressed),
               std::logic_error)
      << "readers would take it for a table";
}

TEST_F(Hdf5WriterTest, AListIsWrittenOnceUnderItsFullPath) {
  Writer writer(file);
  const std::vector<double> six(6);
  EXPECT_THROW(writer.writeList("a", six, "m"), std::logic_error);
  expectError(ExitCode::failed, [&] { writer.writeList("/no/group", six, "m"); },
              {"list.h5", "/no/group"});
  writer.writeList("/a", six, "m");
  expectError(ExitCode::failed, [&] { writer.writeList("/a", six, "m"); }, {"list.h5", "/a"});
  writer.close();
  EXPECT_THAT(read().read<double>("/a", {6}), Each(0));
}

TEST_F(Hdf5WriterTest, AttributesAreReadBack) {
  Writer writer(file);
  const std::vector<std::int32_t> numbers = {1, -2, 3};
  writer.setText("/", "scene", "name = \"Leber, gr\u00f6\u00dfer\"\n");
  writer.setText("/", "empty", "");
  writer.setText("/", "long", std::string(200000, 'x'));
  writer.setIntegers("/", "version", numbers);
  writer.setNumber("/", "spacing", 0.0125);
  writer.close();
  const Reader reader(file);
  EXPECT_EQ(reader.text("scene"), "name = \"Leber, gr\u00f6\u00dfer\"\n");
  EXPECT_EQ(reader.text("empty"), "");
  EXPECT_EQ(reader.text("long"), std::string(200000, 'x'));
  EXPECT_EQ(reader.integers("version"), numbers);
  EXPECT_EQ(reader.number("spacing"), 0.0125);
  EXPECT_FALSE(reader.hasAttribute("other"));
}

/// By default HDF5 stores timestamps in seconds.
TEST_F(Hdf5WriterTest, EqualCallsGiveEqualBytesAtAnyTime) {
  const auto write = [&](const char* name) {
    Writer writer(directory / name);
    writer.makeGroup("/group");
    writer.setText("/group", "what", "a group");
    writeRowByRow(writer, "/group/force", vectors(100));
    const std::vector<float> row = {1, 2};
    RowWriter rows(writer, "/group/displacement", Element::float32, {2, 2}, "m",
                   RowLayout::compressed);
    rows.addBytes(bytesOf(std::span(row)));
    rows.skip();
    rows.finish();
    writer.close();
  };
  write("first.h5");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  write("second.h5");
  EXPECT_TRUE(test::bytesIn(directory / "first.h5") == test::bytesIn(directory / "second.h5"));
}

TEST_F(Hdf5WriterTest, ExistingFilesAreReplacedAndImpossiblePathsReported) {
  std::ofstream(file) << std::string(3 * mebibyte, 'x');
  Writer writer(file);
  writeRowByRow(writer, "/force", vectors(2));
  writer.close();
  EXPECT_LT(std::filesystem::file_size(file), 10000u);
  EXPECT_EQ(read().readList<Eigen::Vector3d>("/force"), vectors(2));
  expectError(ExitCode::failed, [&] { Writer(directory / "no" / "such.h5"); },
              {"such.h5", "cannot be created", "No such file"});
  expectError(ExitCode::failed, [&] { Writer{directory.path()}; },
              {directory.path().string(), "cannot be created", "directory"});
}

}  // namespace
}  // namespace palpate::hdf5
