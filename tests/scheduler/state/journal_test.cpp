#include "scheduler/state/journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>

#include "tests/scheduler/state/synced_files.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/scanned_journal.hpp"
#include "tests/support/temporary_directory.hpp"

std::vector<std::string>* palpate::test::synced_files = nullptr;

/// Replaces the function of the C library.
extern "C" int fdatasync(int file) {
  if (palpate::test::synced_files != nullptr)
    palpate::test::synced_files->push_back(
        std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(file)).filename());
  return static_cast<int>(syscall(SYS_fdatasync, file));
}

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::bytesIn;
using test::putInto;
using testing::ElementsAre;
using testing::HasSubstr;

struct JournalTest : testing::Test {
  test::TemporaryDirectory directory;
  const fs::path first = directory / "segment-000001.dat";

  Journal open(std::uint64_t segment_bytes = Journal::default_segment_bytes) {
    return {directory.path(), scan().end, segment_bytes};
  }
  /// Writes and closes a journal of these records, each with a payload.
  void write(std::initializer_list<const char*> records,
             std::uint64_t segment_bytes = Journal::default_segment_bytes,
             const std::string& payload = "payload") {
    Journal journal = open(segment_bytes);
    for (const char* header : records) journal.append(header, payload);
    journal.sync();
  }
  test::ScannedJournal scan() { return test::scanned(JournalReader(directory.path())); }
  std::vector<std::string> headers() {
    std::vector<std::string> headers;
    for (const auto& record : scan().records) headers.push_back(record.header);
    return headers;
  }
  std::vector<std::string> gaps() {
    std::vector<std::string> texts;
    for (const JournalGap& gap : scan().gaps) texts.push_back(gap.text);
    return texts;
  }
};

TEST_F(JournalTest, ReadsAppendedRecordsBack) {
  Journal journal = open();
  const auto a = journal.append("head", std::string(100000, 'x'));
  const auto b = journal.append("", "");
  const auto c = journal.append(std::string("\0nul", 4), "p");
  journal.sync();
  EXPECT_EQ(journal.read(a).header, "head");
  EXPECT_EQ(journal.read(a).payload, std::string(100000, 'x'));
  EXPECT_EQ(journal.read(b).header + journal.read(b).payload, "");
  EXPECT_EQ(journal.read(c).header, std::string("\0nul", 4));
}

TEST_F(JournalTest, IsReadCompletelyFromItsFilesAlone) {
  JournalPosition last;
  {
    Journal journal = open(100);
    for (const char* header : {"a", "b", "c", "d", "e"})
      last = journal.append(header, std::string(60, 'p'));
    journal.sync();
    EXPECT_EQ(journal.end().segment, 3u);
  }
  const test::ScannedJournal found = scan();
  EXPECT_THAT(headers(), ElementsAre("a", "b", "c", "d", "e"));
  EXPECT_EQ(found.records.back().where, last);
  EXPECT_EQ(found.end, (JournalPosition{last.segment, last.offset + last.length}));
  EXPECT_TRUE(found.gaps.empty());
  Journal again = open(100);
  EXPECT_EQ(again.append("f", "").segment, 3u) << "the last segment has room";
  again.sync();
  EXPECT_EQ(headers().size(), 6u);
}

/// Found by the simulation: a killed run may have marked a record as dropped without a sync. After
/// a power cut, a liar's result would be recorded again.
TEST_F(JournalTest, SyncsEverySegmentWhenItIsOpened) {
  write({"a", "b", "c", "d", "e"}, 100, std::string(60, 'p'));
  std::vector<std::string> synced;
  test::synced_files = &synced;
  const Journal again = open(100);
  test::synced_files = nullptr;
  EXPECT_THAT(synced, testing::IsSupersetOf(
                          {"segment-000001.dat", "segment-000002.dat", "segment-000003.dat"}));
}

TEST_F(JournalTest, CutAtAnyLengthItKeepsWholeRecordsAndContinues) {
  std::size_t first_record = 0;
  {
    Journal journal = open();
    first_record = journal.append("first", "payload").length;
    journal.append("second", "payload");
    journal.sync();
  }
  const std::string whole = bytesIn(first);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    putInto(first, whole.substr(0, length));
    EXPECT_TRUE(scan().gaps.empty()) << "leftovers of a crash are not damage";
    Journal journal = open();
    EXPECT_EQ(fs::file_size(first), length < first_record ? 0 : first_record);
    journal.append("third", "");
    journal.sync();
    if (length < first_record)
      EXPECT_THAT(headers(), ElementsAre("third"));
    else
      EXPECT_THAT(headers(), ElementsAre("first", "third"));
  }
}

/// The reader keeps the last segment that it read open, and must notice records that are appended
/// later.
TEST_F(JournalTest, ReadsRecordsAppendedSinceItsSegmentWasRead) {
  Journal journal = open(100);
  const JournalPosition a = journal.append("a", "payload");
  journal.sync();
  EXPECT_EQ(journal.read(a).header, "a");
  const JournalPosition b = journal.append("b", std::string(200, 'b'));
  const JournalPosition c = journal.append("c", "payload");
  journal.sync();
  ASSERT_EQ(b.segment, a.segment);
  ASSERT_NE(c.segment, a.segment);
  EXPECT_EQ(journal.read(b).header, "b");
  EXPECT_EQ(journal.read(c).header, "c");
  EXPECT_EQ(journal.read(a).header, "a");
}

/// Damage in the middle record loses only that record.
TEST_F(JournalTest, DetectsEveryFlippedBitAndLosesOnlyThatRecord) {
  Journal journal = open();
  journal.append("before", "payload");
  const JournalPosition middle = journal.append("middle", "payload");
  const JournalPosition after = journal.append("after", "payload");
  journal.sync();
  const std::string whole = bytesIn(first);
  for (std::size_t bit = 8 * middle.offset; bit < 8 * after.offset; ++bit) {
    putInto(first, whole);
    test::flip(first, bit / 8, 1 << bit % 8);
    EXPECT_THROW(journal.read(middle), DamagedRecord);
    EXPECT_EQ(journal.read(after).header, "after");
    EXPECT_THAT(headers(), ElementsAre("before", "after"));
    EXPECT_THAT(gaps(), ElementsAre(HasSubstr("segment-000001.dat")));
  }
}

TEST_F(JournalTest, FindsRecordsAfterDamageLongerThanAnyBuffer) {
  Journal journal = open();
  journal.append("damaged", std::string(3 << 20, 'P'));
  journal.append("after", "payload");
  journal.sync();
  std::string bytes = bytesIn(first);
  bytes[5] = '\x7f';  // the length of the record's header
  putInto(first, bytes);
  EXPECT_THAT(headers(), ElementsAre("after"));
}

TEST_F(JournalTest, ADamagedPayloadOfAnEarlierSegmentShowsWhenItIsRead) {
  Journal journal = open(100);
  const JournalPosition early = journal.append("early", std::string(200, 'p'));
  const JournalPosition late = journal.append("late", "p");
  journal.sync();
  ASSERT_NE(early.segment, late.segment);
  test::flip(first, early.length - 1);
  EXPECT_THAT(headers(), ElementsAre("early", "late"));
  EXPECT_THROW(journal.read(early), DamagedRecord);
  journal.drop(early);
  EXPECT_THAT(headers(), ElementsAre("late"));
  EXPECT_THAT(gaps(), ElementsAre(HasSubstr("dropped")));
}

/// Any part of the record may be damaged, even its head.
TEST_F(JournalTest, DroppedRecordsAreNotReportedAsDamageAgain) {
  Journal journal = open();
  journal.append("before", "payload");
  const JournalPosition middle = journal.append("middle", "payload");
  journal.append("after", "payload");
  journal.sync();
  const std::string whole = bytesIn(first);
  for (std::uint64_t byte = middle.offset; byte < middle.offset + middle.length; ++byte) {
    putInto(first, whole);
    test::flip(first, byte, 0x20);
    ASSERT_EQ(scan().gaps.size(), 1u);
    EXPECT_EQ(scan().gaps[0].kind, JournalGap::Kind::damaged);
    EXPECT_EQ(scan().gaps[0].where, middle);
    for (int again = 0; again < 2; ++again) {
      journal.drop(middle);
      ASSERT_EQ(scan().gaps.size(), 1u);
      EXPECT_EQ(scan().gaps[0].kind, JournalGap::Kind::dropped);
      EXPECT_EQ(scan().gaps[0].where, middle);
      EXPECT_THAT(headers(), ElementsAre("before", "after"));
    }
    EXPECT_EQ(fs::file_size(first), whole.size());
  }
}

/// Regression: such bytes counted as a record if the head of the surrounding record was damaged.
TEST_F(JournalTest, ACopyOfARecordInAPayloadIsNeverTakenForARecord) {
  Journal journal = open();
  journal.append("record", "payload");
  journal.sync();
  const JournalPosition around = journal.append("around", bytesIn(first) + "more");
  journal.append("after", "payload");
  journal.sync();
  const std::string whole = bytesIn(first);
  for (std::uint64_t byte = around.offset; byte < around.offset + around.length; ++byte) {
    putInto(first, whole);
    test::flip(first, byte, 1);
    EXPECT_THAT(headers(), ElementsAre("record", "after")) << byte;
  }
}

TEST_F(JournalTest, ACopyOfASegmentUnderAnotherNumberHoldsNoRecord) {
  write({"record"});
  fs::copy_file(first, directory / "segment-000002.dat");
  fs::copy_file(first, directory / "segment-000003.dat");
  EXPECT_THAT(headers(), ElementsAre("record"));
  EXPECT_THAT(gaps(), ElementsAre(HasSubstr("segment-000002.dat")));
}

TEST_F(JournalTest, AStretchTooShortForARecordIsDropped) {
  Journal journal = open(10);
  const JournalPosition before = journal.append("before", "payload");
  journal.append("after", "payload");
  journal.sync();
  const std::string whole = bytesIn(first);
  for (const std::uint64_t length : {1, 2, 3, 4, 19}) {
    const JournalPosition stray{1, before.length, length};
    putInto(first, whole + std::string(length, 'x'));
    ASSERT_EQ(scan().gaps.size(), 1u);
    EXPECT_EQ(scan().gaps[0].kind, JournalGap::Kind::damaged);
    EXPECT_EQ(scan().gaps[0].where, stray);
    journal.drop(stray);
    EXPECT_THAT(headers(), ElementsAre("before", "after")) << length;
    ASSERT_EQ(scan().gaps.size(), 1u);
    EXPECT_EQ(scan().gaps[0].kind, JournalGap::Kind::dropped);
    EXPECT_EQ(scan().gaps[0].where, stray);
  }
}

TEST_F(JournalTest, UnreadableFirstRecordsCanBeDroppedTogether) {
  write({"one", "two", "three"});
  std::string bytes = bytesIn(first);
  bytes[0] = bytes[20 + 3 + 7] = 'x';
  putInto(first, bytes);
  ASSERT_EQ(scan().gaps.size(), 1u);
  Journal journal = open();
  journal.drop(scan().gaps[0].where);
  EXPECT_EQ(scan().gaps[0].kind, JournalGap::Kind::dropped);
  EXPECT_THAT(headers(), ElementsAre("three"));
}

TEST_F(JournalTest, EmptyFilesMarkThatSegmentsWereMissing) {
  write({"one", "two", "three"}, 10);
  fs::remove(directory / "segment-000001.dat");
  fs::remove(directory / "segment-000002.dat");
  for (int again = 0; again < 2; ++again) {
    Journal journal = open(10);
    journal.fillMissing();
    journal.checkPresence();
    EXPECT_THAT(gaps(), ElementsAre(HasSubstr("segment-000001.dat"), HasSubstr("missing segment")));
    EXPECT_EQ(scan().gaps[0].kind, JournalGap::Kind::dropped);
    EXPECT_THAT(headers(), ElementsAre("three"));
  }
}

TEST_F(JournalTest, AMissingSegmentLosesOnlyItsRecords) {
  write({"one", "two", "three"}, 10);
  fs::remove(directory / "segment-000002.dat");
  EXPECT_THAT(headers(), ElementsAre("one", "three"));
  EXPECT_THAT(gaps(), ElementsAre(HasSubstr("segment-000002.dat: is missing")));
  open(10).checkPresence();
}

TEST_F(JournalTest, FilesWithForeignNamesAreNotSegments) {
  Journal journal = open();
  journal.append("record", "");
  journal.sync();
  for (const char* name : {"segment-1.dat", "segment-0000002.dat", "segment-4000000000.dat",
                           "segment-1000000.dat", "segment-000000.dat", "segment-.dat"})
    fs::copy_file(first, directory / name);
  EXPECT_THAT(journal.segments(), ElementsAre(1u));
  EXPECT_THAT(headers(), ElementsAre("record"));
  EXPECT_TRUE(scan().gaps.empty());
}

TEST_F(JournalTest, NoticesARemovedOrReplacedSegment) {
  Journal journal = open(10);
  journal.append("one", "payload");
  journal.append("two", "payload");
  journal.sync();
  journal.checkPresence();
  fs::rename(first, directory / "aside");
  test::expectError(ExitCode::failed, [&] { journal.checkPresence(); },
                    {"segment-000001.dat", "removed"});
  fs::rename(directory / "aside", first);
  const fs::path written = directory / "segment-000002.dat";
  fs::rename(written, directory / "aside");
  fs::copy_file(directory / "aside", written);
  test::expectError(ExitCode::failed, [&] { journal.checkPresence(); },
                    {"segment-000002.dat", "replaced"});
}

TEST_F(JournalTest, AFullDiskIsAnErrorThatSaysWhatToDo) {
  Journal journal = open();
  struct rlimit before {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const struct rlimit small = {4096, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  journal.append("h", std::string(10000, 'x'));
  test::expectError(ExitCode::failed, [&] { journal.sync(); },
                    {"segment-000001.dat", "cannot write", "all acknowledged results are kept"});
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
}

}  // namespace
}  // namespace palpate
