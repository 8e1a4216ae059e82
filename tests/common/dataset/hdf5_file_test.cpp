#include "common/dataset/hdf5_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>

#include "common/dataset/hdf5_handle.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::hdf5 {
namespace {

using testing::HasSubstr;

/// An array of bytes in a file on disk that HDF5 writes by way of a NewFile, as its own driver does
/// by itself.
class BytesInFile {
 public:
  /// So many bytes, of which nothing is written yet.
  BytesInFile(NewFile& disk, const std::filesystem::path& path, hsize_t size) {
    silenceErrorStack();
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    // All that is asked of HDF5 goes to the driver at once.
    EXPECT_GE(H5Pset_sieve_buf_size(access.get(), 1), 0);
    EXPECT_GE(H5Pset_fclose_degree(access.get(), H5F_CLOSE_STRONG), 0);
    disk.use(access.get());
    file_ = {H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose};
    const Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    EXPECT_GE(H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_EARLY), 0);
    EXPECT_GE(H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER), 0);
    bytes_ = {H5Dcreate2(file_.get(), "bytes", H5T_STD_U8LE, space.get(), H5P_DEFAULT,
                         creation.get(), H5P_DEFAULT),
              H5Dclose};
    EXPECT_GE(bytes_.get(), 0);
  }

  void write(hsize_t at, const std::string& bytes) {
    const hsize_t count = bytes.size();
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    EXPECT_GE(H5Dwrite(bytes_.get(), H5T_STD_U8LE, memory.get(), selected(at, count).get(),
                       H5P_DEFAULT, bytes.data()),
              0);
  }
  std::string read(hsize_t at, hsize_t count) const {
    std::string bytes(count, '?');
    const Handle memory(H5Screate_simple(1, &count, nullptr), H5Sclose);
    EXPECT_GE(H5Dread(bytes_.get(), H5T_STD_U8LE, memory.get(), selected(at, count).get(),
                      H5P_DEFAULT, bytes.data()),
              0);
    return bytes;
  }
  void close() {
    EXPECT_GE(bytes_.close(), 0);
    EXPECT_GE(file_.close(), 0);
  }

 private:
  Handle selected(hsize_t at, hsize_t count) const {
    Handle space(H5Dget_space(bytes_.get()), H5Sclose);
    EXPECT_GE(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &at, nullptr, &count, nullptr), 0);
    return space;
  }

  Handle file_, bytes_;
};

struct Hdf5FileTest : testing::Test {
  test::TemporaryDirectory directory;
  const std::filesystem::path path = directory / "new.h5";

  /// What is in the array, as HDF5's own driver reads it.
  std::string found() const {
    const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    const Handle array(H5Dopen2(file.get(), "bytes", H5P_DEFAULT), H5Dclose);
    const Handle space(H5Dget_space(array.get()), H5Sclose);
    const hssize_t size = H5Sget_simple_extent_npoints(space.get());
    if (size < 0) return "no array";
    std::string bytes(static_cast<std::size_t>(size), '?');
    EXPECT_GE(H5Dread(array.get(), H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()), 0);
    return bytes;
  }
  std::string raw() const {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
};

/// Pieces of any size at any place, over each other, a few of them longer than what is kept back.
struct RandomPieces {
  static constexpr hsize_t size = hsize_t{5} << 20;
  std::string model = std::string(size, '\0');
  std::mt19937 random{11};
  hsize_t place = 0;

  std::uint32_t below(hsize_t limit) { return random() % static_cast<std::uint32_t>(limit); }
  void writeOne(BytesInFile& file) {
    constexpr std::array longest = {hsize_t{10}, hsize_t{1000}, hsize_t{100000}, hsize_t{2} << 20};
    const hsize_t most = longest.at(below(16) / 5);
    // Mostly where the last one ended, as HDF5 does, or a little before.
    if (below(4) == 0) place = below(size);
    if (below(4) == 0) place -= std::min<hsize_t>(place, below(200));
    place = place >= size ? 0 : place;
    const std::string piece(std::min<hsize_t>(1 + below(most), size - place),
                            static_cast<char>(1 + below(100)));
    file.write(place, piece);
    model.replace(place, piece.size(), piece);
    place += piece.size();
  }
  void expectIn(const BytesInFile& file) const { EXPECT_TRUE(file.read(0, size) == model); }
};

TEST_F(Hdf5FileTest, HoldsWhatWasWrittenLastWhateverTheOrder) {
  RandomPieces pieces;
  NewFile disk(path);
  BytesInFile file(disk, path, RandomPieces::size);
  for (int turn = 0; turn < 500; ++turn) {
    pieces.writeOne(file);
    if (turn % 10 == 0) pieces.expectIn(file);
  }
  file.close();
  disk.close();
  EXPECT_EQ(disk.error(), "");
  EXPECT_TRUE(found() == pieces.model);
}

TEST_F(Hdf5FileTest, WhatIsLeftUnusedIsZeroWhateverWasThere) {
  std::ofstream(path) << std::string(300000, 'x');
  NewFile disk(path);
  BytesInFile file(disk, path, 100000);
  file.write(99000, "there");
  EXPECT_EQ(file.read(50000, 10), std::string(10, '\0'));
  EXPECT_EQ(file.read(98999, 6), std::string("\0there", 6));
  file.close();
  disk.close();
  std::string expected(100000, '\0');
  EXPECT_TRUE(found() == expected.replace(99000, 5, "there"));
  EXPECT_THAT(raw(), testing::Not(HasSubstr("xx")));
}

/// HDF5 sets aside more than it uses in the end.
TEST_F(Hdf5FileTest, EndsWhereHdf5SaysThatItEnds) {
  NewFile disk(path);
  BytesInFile file(disk, path, 1000);
  file.write(0, std::string(1000, 'y'));
  file.close();
  disk.close();
  const Handle again(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  ASSERT_GE(again.get(), 0);
  hsize_t size = 0;
  EXPECT_GE(H5Fget_filesize(again.get(), &size), 0);
  EXPECT_EQ(std::filesystem::file_size(path), size);
  EXPECT_LT(size, 10000u);
}

TEST_F(Hdf5FileTest, IsEmptyUntilSomethingIsWrittenAndWholeWhenItIsClosed) {
  std::ofstream(path) << "something else";
  NewFile disk(path);
  EXPECT_EQ(std::filesystem::file_size(path), 0u);
  BytesInFile file(disk, path, 10);
  file.write(0, "0123456789");
  file.close();
  disk.close();
  EXPECT_EQ(found(), "0123456789");
}

/// Whatever HDF5 asks for on a disk that takes no more than `most` bytes of a file: 0 when it is
/// answered as if all had been written, and the file says what happened.
int writeBeyond(rlim_t most, const std::filesystem::path& path) {
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit = {most, most};
  if (setrlimit(RLIMIT_FSIZE, &limit) != 0) return 100;
  RandomPieces pieces;
  NewFile disk(path);
  BytesInFile file(disk, path, RandomPieces::size);
  for (int turn = 0; turn < 200; ++turn) {
    pieces.writeOne(file);
    if (turn % 10 == 0) pieces.expectIn(file);
  }
  pieces.expectIn(file);
  EXPECT_THAT(disk.error(), HasSubstr("ulimit -f"));
  file.close();
  disk.close();
  EXPECT_THAT(disk.error(), HasSubstr("ulimit -f"));
  return testing::Test::HasFailure() ? 1 : 0;
}

/// HDF5 1.10.8 cannot close a file otherwise, and dies when the process ends.
TEST_F(Hdf5FileTest, Hdf5GoesOnToItsEndOnADiskThatTakesNoMore) {
  for (const rlim_t most : {0, 1000, 3000000}) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    // In the ordinary way: HDF5 looks after its files then.
    if (child == 0) std::exit(writeBeyond(most, path));
    int status = -1;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0)
        << "of " << most << " bytes, status " << status;
    EXPECT_LE(std::filesystem::file_size(path), most);
  }
}

TEST_F(Hdf5FileTest, SaysWhyItCannotBeMade) {
  test::expectError(ExitCode::failed, [&] { NewFile(directory / "no" / "such.h5"); },
                    {"such.h5", "cannot be created", "No such file or directory"});
  test::expectError(ExitCode::failed, [&] { NewFile{directory.path()}; },
                    {directory.path().string(), "cannot be created", "Is a directory"});
}

}  // namespace
}  // namespace palpate::hdf5
