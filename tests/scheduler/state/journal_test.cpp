#include "scheduler/state/journal.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <iterator>
#include <random>

#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

struct JournalTest : testing::Test {
  test::TemporaryDirectory directory;
  const fs::path first = directory / "segment-000001.dat";

  static std::string contentOf(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  static void writeFile(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  }
};

TEST_F(JournalTest, ReadsBackWhatWasAppended) {
  Journal journal(directory.path(), {});
  const auto a = journal.append("head", std::string(100000, 'x'));
  const auto b = journal.append("", "");
  const auto c = journal.append(std::string("\0nul", 4), "p");
  journal.sync();
  EXPECT_EQ(journal.read(a).header, "head");
  EXPECT_EQ(journal.read(a).payload, std::string(100000, 'x'));
  EXPECT_EQ(journal.read(b).header + journal.read(b).payload, "");
  EXPECT_EQ(journal.read(c).header, std::string("\0nul", 4));
}

TEST_F(JournalTest, GoesOnAfterTheCommittedEndAndForgetsWhatLiesBehindIt) {
  JournalPosition kept, again;
  JournalEnd committed;
  {
    Journal journal(directory.path(), {});
    kept = journal.append("kept", "1");
    committed = journal.end();
    journal.append("not committed", "2");
    journal.sync();
  }
  Journal journal(directory.path(), committed);
  EXPECT_EQ(fs::file_size(first), committed.offset);
  again = journal.append("again", "3");
  EXPECT_EQ(again.offset, committed.offset);
  EXPECT_EQ(journal.read(kept).header, "kept");
  EXPECT_EQ(journal.read(again).header, "again");
}

TEST_F(JournalTest, RollsToANewSegmentAndRemovesUncommittedOnes) {
  JournalEnd committed;
  std::vector<JournalPosition> positions;
  {
    Journal journal(directory.path(), {}, 100);
    for (int n = 0; n < 10; ++n)
      positions.push_back(journal.append("h", std::string(60, static_cast<char>('a' + n))));
    journal.sync();
    EXPECT_EQ(journal.end().segment, 5u);
    for (int n = 0; n < 10; ++n) EXPECT_EQ(journal.read(positions[n]).payload[0], 'a' + n);
    committed = {positions[3].segment, positions[3].offset + positions[3].length};
  }
  Journal journal(directory.path(), committed, 100);
  EXPECT_FALSE(fs::exists(directory / "segment-000003.dat"));
  EXPECT_FALSE(fs::exists(directory / "segment-000005.dat"));
  EXPECT_EQ(journal.read(positions[3]).payload[0], 'd');
  EXPECT_EQ(journal.append("h", "p").segment, 3u);
}

TEST_F(JournalTest, CutAtEveryLengthItSaysWhatIsMissing) {
  JournalPosition last;
  JournalEnd committed;
  {
    Journal journal(directory.path(), {});
    journal.append("first", "payload");
    last = journal.append("second", "payload");
    journal.sync();
    committed = journal.end();
  }
  const std::string whole = contentOf(first);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    writeFile(first, whole.substr(0, length));
    test::expectError(ExitCode::failed, [&] { Journal(directory.path(), committed); },
                      {"segment-000001.dat", "damaged"});
  }
  writeFile(first, whole + "torn tail");
  EXPECT_EQ(Journal(directory.path(), committed).read(last).header, "second");
}

TEST_F(JournalTest, NoticesEveryFlippedBit) {
  Journal journal(directory.path(), {});
  const auto position = journal.append("header", "payload");
  journal.sync();
  const std::string whole = contentOf(first);
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    writeFile(first, damaged);
    test::expectError(ExitCode::failed, [&] { journal.read(position); },
                      {"segment-000001.dat", "damaged"});
  }
}

TEST_F(JournalTest, AFullDiskIsAnErrorThatSaysWhatToDo) {
  Journal journal(directory.path(), {});
  struct rlimit before {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small = {4096, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  test::expectError(ExitCode::failed, [&] { journal.append("h", std::string(10000, 'x')); },
                    {"segment-000001.dat", "cannot write", "everything acknowledged is kept"});
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
}

}  // namespace
}  // namespace palpate
