#include "scheduler/events/event_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>

#include <fstream>
#include <limits>

#include "common/base/log_lines.hpp"
#include "scheduler/events/event_reader.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;
using testing::SizeIs;

struct EventLogTest : testing::Test {
  test::TemporaryDirectory directory;

  static std::vector<std::string> readOn(EventReader& reader) {
    std::vector<std::string> lines;
    reader.readOn([&](std::string_view line) { lines.emplace_back(line); });
    return lines;
  }
  std::vector<std::string> lines(const WantedEvents& wanted = {}) const {
    EventReader reader(directory.path(), wanted);
    return readOn(reader);
  }
  static Event numbered(std::int64_t number) {
    return Event("retried").with("transitions", number);
  }
  std::filesystem::path file(std::uint32_t number) const {
    return eventFile(directory.path(), number);
  }
};

TEST_F(EventLogTest, WritesOneJsonObjectPerLineWithTimeWordAndFields) {
  EventLog log(directory.path());
  log.add(Event("failed_attempt")
              .with("space", "tip")
              .with("point", {1, -0.5, 0})
              .with("step_reached", 0.25)
              .with("residual", std::numeric_limits<double>::infinity()));
  log.flush();
  EXPECT_THAT(lines(), ElementsAre(MatchesRegex(
                           R"(\{"time":"[0-9]+-[0-9]+-[0-9]+T[0-9:]+\.[0-9]+Z",)"
                           R"("event":"failed_attempt","space":"tip","point":\[1,-0.5,0\],)"
                           R"("step_reached":0.25,"residual":null\})")));
}

TEST_F(EventLogTest, NamesOfPeersBreakNoLine) {
  EventLog log(directory.path());
  log.add(Event("worker_left").with("host", "a\"b\\c\n{}\x1b[2J\xff"));
  log.flush();
  ASSERT_THAT(lines(), SizeIs(1));
  EXPECT_THAT(lines()[0], HasSubstr(R"(a\"b\\c\n{}\u001b[2J)"));
}

TEST_F(EventLogTest, TimesSortAsTexts) {
  using namespace std::chrono_literals;
  const std::chrono::system_clock::time_point when(1795551479s);
  EXPECT_EQ(utcText(when + 7ms), "2026-11-24T20:17:59.007Z");
  EXPECT_LT(utcText(when + 999ms), utcText(when + 1s));
}

TEST_F(EventLogTest, StartsANewFileWhenOneIsFullAndRemovesTheOldest) {
  EventLog log(directory.path(), 1000, 3);
  for (int n = 0; n < 200; ++n) {
    log.add(numbered(n));
    log.flush();
  }
  const auto numbers = eventFiles(directory.path());
  ASSERT_THAT(numbers, SizeIs(3));
  EXPECT_GT(numbers.front(), 1u);
  EXPECT_LT(std::filesystem::file_size(file(numbers.front())), 1100u);
  const auto kept = lines();
  EXPECT_GT(kept.size(), 20u);
  EXPECT_THAT(kept.back(), HasSubstr(":199}"));
}

TEST_F(EventLogTest, ContinuesTheLastRunsFileWhateverItsEnd) {
  for (int run = 0; run < 3; ++run) {
    EventLog log(directory.path());
    log.add(numbered(run));
    log.flush();
    // A crash.
    std::ofstream(file(1), std::ios::app) << R"({"time":"2026-11-24T20)";
  }
  EXPECT_THAT(eventFiles(directory.path()), ElementsAre(1u));
  EXPECT_THAT(lines(), SizeIs(3));
}

TEST_F(EventLogTest, AMissingOrUnwritableLogStopsNothing) {
  const std::filesystem::path state = directory / "state";
  EventLog log(state);
  for (int n = 0; n < 5; ++n) {
    log.add(numbered(n));
    log.flush();
  }
  std::filesystem::create_directory(state);
  log.add(numbered(5));
  log.flush();
  EventReader reader(state);
  EXPECT_THAT(readOn(reader),
              ElementsAre(HasSubstr(R"("event":"left_out","events":5)"), HasSubstr(":5}")));
}

TEST_F(EventLogTest, AFullDiskLosesEventsAndCountsThem) {
  // Mount a small file system over the directory, visible to this process only.
  if (unshare(CLONE_NEWNS) != 0 ||
      mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
      mount("events", directory.path().c_str(), "tmpfs", 0, "size=64k") != 0)
    GTEST_SKIP() << "no root: a full disk was NOT tested";
  constexpr int last = 200;
  {
    EventLog log(directory.path());
    log.add(numbered(0));
    log.flush();
    std::ofstream(directory / "others") << std::string(64 << 10, 'x');
    ASSERT_EQ(std::filesystem::space(directory.path()).available, 0u);
    for (int n = 1; n < last; ++n) {
      log.add(numbered(n));
      log.flush();
    }
    // The last page of the event file is completely used, so the next line needs a new page.
    EXPECT_EQ(std::filesystem::file_size(file(1)) % 4096, 0u);
    std::filesystem::remove(directory / "others");
    log.add(numbered(last));
    log.flush();
  }
  const auto kept = lines();
  const auto told = std::ranges::find_if(
      kept, [](const std::string& line) { return line.find("left_out") != std::string::npos; });
  ASSERT_NE(told, kept.end());
  const int lost = std::stoi(told->substr(told->rfind(':') + 1));
  EXPECT_GT(lost, 100);
  EXPECT_EQ(static_cast<int>(kept.size()) - 1 + lost, last + 1) << "each event is kept or counted";
  EXPECT_THAT(kept.back(), HasSubstr(":200}"));
  EXPECT_EQ(umount(directory.path().c_str()), 0);
}

TEST_F(EventLogTest, AReaderContinuesAcrossFiles) {
  EventLog log(directory.path(), 200, 4);
  EventReader reader(directory.path());
  int seen = 0;
  for (int n = 0; n < 20; ++n) {
    log.add(numbered(n));
    log.flush();
    for (const std::string& line : readOn(reader)) {
      EXPECT_THAT(line, HasSubstr(":" + std::to_string(seen) + "}"));
      ++seen;
    }
  }
  EXPECT_EQ(seen, 20);
}

TEST_F(EventLogTest, AReaderWaitsForTheRestOfALine) {
  std::ofstream out(file(1), std::ios::app);
  const std::string line = Event("paused").line({});
  EventReader reader(directory.path());
  out << line.substr(0, 20) << std::flush;
  EXPECT_THAT(readOn(reader), SizeIs(0));
  out << line.substr(20) << '\n' << std::flush;
  EXPECT_THAT(readOn(reader), ElementsAre(line));
}

TEST_F(EventLogTest, ReadersFilterByWordAndSkipInvalidEvents) {
  std::ofstream out(file(1));
  for (const std::string none : {"", "{", "[]", "1", "{\"time\":1,\"event\":\"paused\"}", "\xff"})
    out << none << '\n';
  const std::string paused = Event("paused").line({}), stage = Event("stage").line({});
  out << paused << '\n' << stage << '\n' << std::flush;
  EXPECT_THAT(lines(), ElementsAre(paused, stage));
  EXPECT_THAT(lines({"stage", "sealed"}), ElementsAre(stage));
  EXPECT_THAT(lastEvents(directory.path(), {"paused"}, 5), ElementsAre(paused));
  EXPECT_THAT(lastEvents(directory.path(), {}, 1), ElementsAre(stage));
}

TEST_F(EventLogTest, DeepNestingUsesNoStack) {
  const std::string line = R"({"time":"2026","event":"paused","a":)" + std::string(1000000, '[') +
                           std::string(1000000, ']') + '}';
  std::ofstream(file(1)) << line << '\n';
  EXPECT_THAT(lines(), ElementsAre(line));
}

}  // namespace
}  // namespace palpate
