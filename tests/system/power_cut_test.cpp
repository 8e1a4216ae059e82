#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/support/command.hpp"
#include "tests/support/long_tests.hpp"
#include "tests/system/small_build.hpp"

/// Power cuts during a build. Its disk is an ext4 file system in a file, which is copied at some
/// moment. The copy holds what had been written to the disk by then, and nothing that the kernel
/// kept in memory. Mounting the copy corresponds to a restart of the machine.
namespace palpate {
namespace {

using test::contentOf;
using test::Process;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Mounts from now on are visible only to this process and its children, and disappear with them,
/// however they end. Returns empty, or the reason why nothing can be mounted.
std::string whyNothingCanBeMounted() {
  if (geteuid() != 0) return "only root may mount disks";
  if (unshare(CLONE_NEWNS) != 0 || mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0)
    return std::string("mount namespaces are refused here: ") + std::strerror(errno);
  return {};
}

/// An ext4 file system in a file. The loop device ends with the mount.
class Disk {
 public:
  /// The file `name`.img in `directory`; it is mounted at `name`.
  Disk(const std::filesystem::path& directory, const std::string& name)
      : image_(directory / (name + ".img")), root_(directory / name) {
    std::filesystem::create_directory(root_);
  }
  ~Disk() {
    umount2(root_.c_str(), MNT_DETACH);
    std::error_code ignored;
    std::filesystem::remove(image_, ignored);
  }
  Disk(const Disk&) = delete;
  Disk& operator=(const Disk&) = delete;

  const std::filesystem::path& root() const { return root_; }
  const std::filesystem::path& image() const { return image_; }
  /// Returns empty, or the error.
  std::string format() const {
    std::ofstream(image_).close();
    std::filesystem::resize_file(image_, 16u << 20);
    return run("mkfs.ext4 -q -F -b 4096 -J size=4 '" + image_.string() + "'");
  }
  std::string mounted() const {
    return run("mount -t ext4 -o loop '" + image_.string() + "' '" + root_.string() + "'");
  }
  void unmount() const {
    // A process that wrote here may be about to end.
    EXPECT_TRUE(test::eventually([&] { return umount2(root_.c_str(), 0) == 0; }))
        << std::strerror(errno);
  }

 private:
  static std::string run(const std::string& command) {
    const test::CommandResult done = test::runCommand(command);
    return done.exit_code == 0 ? "" : command + ": " + done.output;
  }
  std::filesystem::path image_, root_;
};

/// The contents of a file at one moment, holes as zeros: it is read until two readings agree.
std::string atOneMoment(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const auto size = static_cast<off_t>(std::filesystem::file_size(file));
  const auto read = [&] {
    std::string bytes(static_cast<std::size_t>(size), '\0');
    for (off_t at = 0; (at = lseek(descriptor, at, SEEK_DATA)) >= 0 && at < size;) {
      const off_t end = lseek(descriptor, at, SEEK_HOLE);
      while (at < end) {
        const ssize_t count =
            pread(descriptor, bytes.data() + at, static_cast<std::size_t>(end - at), at);
        if (count <= 0) break;
        at += count;
      }
    }
    return bytes;
  };
  std::string before = read();
  EXPECT_TRUE(test::eventually([&] {
    std::string after = read();
    const bool same = before == after;
    before = std::move(after);
    return same;
  })) << "the file changed during every reading";
  close(descriptor);
  return before;
}

void writeSparse(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  constexpr std::size_t block = 4096;
  for (std::size_t at = 0; at < bytes.size(); at += block) {
    const auto piece = std::string_view(bytes).substr(at, block);
    if (piece.find_first_not_of('\0') == std::string_view::npos) continue;
    out.seekp(static_cast<std::streamoff>(at));
    out << piece;
  }
  out.close();
  std::filesystem::resize_file(file, bytes.size());
}

/// The end of the first `count` records of a journal (docs/internals/state.md), or of all if it has
/// fewer.
std::size_t endOfRecords(const std::string& journal, std::size_t count) {
  std::size_t at = 0;
  constexpr std::size_t preamble = 20;
  for (; count > 0 && at + preamble <= journal.size(); --count) {
    std::uint32_t header = 0, payload = 0;
    std::memcpy(&header, journal.data() + at + 4, 4);
    std::memcpy(&payload, journal.data() + at + 8, 4);
    const std::size_t end = at + preamble + header + payload;
    if (!journal.substr(at).starts_with("PJR3") || end > journal.size()) break;
    at = end;
  }
  return at;
}

std::size_t countRecords(const std::string& journal) {
  std::size_t count = 0;
  while (endOfRecords(journal, count + 1) > endOfRecords(journal, count)) ++count;
  return count;
}

/// A disk after a power cut, and what had been promised by then.
struct PowerCut {
  std::string when;
  std::string disk;
  std::size_t recorded = 0;  ///< results that `status` had counted
  bool sealed = false;       ///< the build had reported it
};

struct DiskTest : test::SmallBuild {
  void SetUp() override {
    std::string why = whyNothingCanBeMounted();
    if (why.empty()) {
      const Disk disk(directory.path(), "trial");
      why = disk.format();
      if (why.empty()) why = disk.mounted();
    }
    if (!why.empty()) GTEST_SKIP() << "disks and power cuts were NOT tested: " << why;
  }

  std::unique_ptr<Process> buildOn(const Disk& disk) {
    const std::string out = disk.root().filename().string() + "/out.h5";
    return start("palpate-scheduler", {"build", "cube.toml", "-o", out, "-j", "2"});
  }

  static std::string journalOn(const Disk& disk) {
    return contentOf(disk.root() / "out.h5.state" / "segment-000001.dat");
  }
};

struct PowerCutTest : DiskTest {
  std::mt19937 dice{test::testSeed()};

  int atMost(int largest) { return std::uniform_int_distribution(0, largest)(dice); }

  /// Results counted by the scheduler on `disk`; 0 if it does not answer yet.
  std::size_t recordedOn(const Disk& disk) {
    const test::CommandResult status =
        test::runCommand(PALPATE_BIN_DIR "/palpate-scheduler status --json '" +
                         disk.root().string() + "/out.h5.state'");
    const auto found = nlohmann::json::parse(status.output, nullptr, false);
    return found.is_object() && found.contains("recorded") ? found["recorded"].get<std::size_t>()
                                                           : 0;
  }

  /// Cuts the power at random moments of one run, which starts with `found` results. The run ends
  /// by itself, or is killed after `longest`. Makes at most `most` cuts, not counting those at its
  /// end.
  void cutsInOneRun(const Disk& disk, std::vector<PowerCut>& cuts, std::size_t most,
                    std::size_t found, milliseconds longest) {
    auto build = buildOn(disk);
    const auto began = Clock::now();
    bool told = false, cut_in_seal = false;
    const auto is_to_be_cut_in_seal = [&] {
      return !cut_in_seal && std::filesystem::exists(disk.root() / "out.h5.tmp");
    };
    while (build->running() && Clock::now() - began < longest) {
      const auto next = Clock::now() + milliseconds(atMost(told ? 100 : 30));
      while (Clock::now() < next && build->running() && !is_to_be_cut_in_seal())
        std::this_thread::sleep_for(std::chrono::microseconds(200));
      if (is_to_be_cut_in_seal()) {
        cut_in_seal = true;
        std::this_thread::sleep_for(std::chrono::microseconds(atMost(5000)));
        cuts.push_back({"while it was sealed", atOneMoment(disk.image()), found, false});
      } else if (cuts.size() < most && build->running()) {
        const std::size_t recorded = recordedOn(disk);
        told = told || recorded > 0;
        const char* when = found > 0 ? "in the second run" : told ? "at work" : "at the start";
        cuts.push_back({when, atOneMoment(disk.image()), recorded + found, false});
      }
    }
    if (build->running()) {
      build->stop(SIGKILL);
      return;
    }
    expectFinished(*build);
    cuts.push_back({"after it was sealed", atOneMoment(disk.image()), found, true});
  }

  /// A build in two runs with about eight power cuts, each followed by a recovery.
  void cutsOfOneBuild(const std::string& undisturbed) {
    std::vector<PowerCut> cuts;
    std::string journal;
    {
      const Disk disk(directory.path(), "live");
      ASSERT_EQ(disk.format(), "");
      ASSERT_EQ(disk.mounted(), "");
      cutsInOneRun(disk, cuts, 3, 0, milliseconds(100 + atMost(600)));
      const std::size_t found = countRecords(journalOn(disk));
      cutsInOneRun(disk, cuts, 6, found, std::chrono::minutes(1));
      ASSERT_EQ(contentOf(disk.root() / "out.h5"), undisturbed);
      journal = journalOn(disk);
      disk.unmount();
    }
    for (const PowerCut& cut : cuts) recoverFrom(cut, journal, undisturbed);
  }

  /// `journal`: the journal of the run without a cut. The disk must hold the beginning of it.
  void recoverFrom(const PowerCut& cut, const std::string& journal,
                   const std::string& undisturbed) {
    SCOPED_TRACE("power cut " + cut.when + ", " + std::to_string(cut.recorded) +
                 " results were recorded");
    const Disk disk(directory.path(), "cut");
    writeSparse(disk.image(), cut.disk);
    ASSERT_EQ(disk.mounted(), "");
    const std::size_t promised = endOfRecords(journal, cut.recorded);
    EXPECT_EQ(countRecords(journal.substr(0, promised)), cut.recorded);
    EXPECT_TRUE(journalOn(disk).starts_with(journal.substr(0, promised)))
        << "a result that had been acknowledged is gone";
    if (cut.sealed) {
      EXPECT_TRUE(contentOf(disk.root() / "out.h5") == undisturbed) << "the sealed dataset is gone";
    }
    auto build = buildOn(disk);
    expectFinished(*build);
    EXPECT_TRUE(contentOf(disk.root() / "out.h5") == undisturbed) << "another dataset";
    disk.unmount();
    ++recovered[cut.when];
  }

  void cutAndRecover(std::size_t wanted) {
    const unsigned seed = test::testSeed();
    dice.seed(seed);
    SCOPED_TRACE("PALPATE_TEST_SEED=" + std::to_string(seed));
    const std::string undisturbed = SmallBuild::undisturbed();
    for (std::size_t done = 0; done < wanted && !HasFailure();) {
      cutsOfOneBuild(undisturbed);
      done = 0;
      for (const auto& [when, count] : recovered) done += count;
    }
    std::cout << "seed " << seed << "; power cuts";
    for (const auto& [when, count] : recovered) std::cout << ", " << when << ": " << count;
    std::cout << std::endl;
  }

  std::map<std::string, std::size_t> recovered;
};

TEST_F(PowerCutTest, ACopyOfTheDiskHoldsExactlyTheSyncedBytes) {
  const Disk disk(directory.path(), "live");
  ASSERT_EQ(disk.format(), "");
  ASSERT_EQ(disk.mounted(), "");
  for (const char* name : {"synced", "not-synced"}) {
    const int file = open((disk.root() / name).c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    EXPECT_EQ(write(file, name, std::strlen(name)), static_cast<ssize_t>(std::strlen(name)));
    if (std::string(name) == "synced") {
      EXPECT_EQ(fdatasync(file), 0);
    }
    close(file);
  }
  const Disk cut(directory.path(), "cut");
  writeSparse(cut.image(), atOneMoment(disk.image()));
  ASSERT_EQ(cut.mounted(), "");
  EXPECT_EQ(contentOf(cut.root() / "synced"), "synced");
  EXPECT_EQ(contentOf(cut.root() / "not-synced"), "");
}

TEST_F(PowerCutTest, NothingAcknowledgedIsLostAndTheDatasetIsTheSame) { cutAndRecover(6); }

TEST_F(PowerCutTest, TwoHundredCutsLoseNothingAcknowledged) {
  if (!test::longTestsAreWanted())
    GTEST_SKIP() << "200 power cuts take minutes and were NOT tested; set PALPATE_LONG_TESTS=1 "
                    "(deploy/test --nightly does)";
  cutAndRecover(200);
}

TEST_F(DiskTest, AFullDiskEndsTheBuildWhichResumesWhenThereIsRoom) {
  const Disk disk(directory.path(), "live");
  ASSERT_EQ(disk.format(), "");
  ASSERT_EQ(disk.mounted(), "");
  const std::filesystem::path filler = disk.root() / "filler";
  // The free space is too small for the tables, the journal, or the dataset.
  for (const std::uintmax_t room : {20u << 10, 60u << 10, 200u << 10, 400u << 10}) {
    SCOPED_TRACE(std::to_string(room) + " bytes are free");
    test::runCommand("dd if=/dev/zero bs=4k of='" + filler.string() + "'");
    std::filesystem::resize_file(filler, std::filesystem::file_size(filler) - room);
    sync();
    auto build = buildOn(disk);
    EXPECT_EQ(build->wait(), 1);
    EXPECT_THAT(build->output(), testing::ContainsRegex("No space left|the disk is full"));
    EXPECT_FALSE(std::filesystem::exists(disk.root() / "out.h5"));
    std::filesystem::remove(filler);
    sync();  // the room is not free before that
  }
  auto build = buildOn(disk);
  expectFinished(*build);
  EXPECT_TRUE(contentOf(disk.root() / "out.h5") == undisturbed());
}

}  // namespace
}  // namespace palpate
