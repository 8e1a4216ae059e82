#include "scheduler/fleet/slurm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::Pair;
using testing::SizeIs;
using How = Launches::Ended::How;

TEST(SlurmScript, IsAnArrayOfWorkersSignalledBeforeTheirTimeLimit) {
  const Slurm slurm({.name = "palpate-0123",
                     .command = {"/opt/palpate-worker", "work", "--keys", "/home/o'neil/keys"},
                     .endpoint = "tcp://head:7411",
                     .minutes = 90,
                     .constraint = "avx2",
                     .more = {"--partition=short"}});
  const std::string script = slurm.script(3);
  for (const char* line :
       {"#!/bin/sh\n", "#SBATCH --job-name=palpate-0123\n", "#SBATCH --array=1-3\n",
        "#SBATCH --ntasks=1 --cpus-per-task=1\n", "#SBATCH --time=90\n",
        "#SBATCH --signal=B:TERM@60\n", "#SBATCH --constraint=avx2\n",
        "#SBATCH --comment=\"palpate at tcp://head:7411\"\n", "#SBATCH --partition=short\n",
        "exec '/opt/palpate-worker' 'work' '--keys' '/home/o'\\''neil/keys'\n"})
    EXPECT_THAT(script, HasSubstr(line));
}

TEST(SlurmScript, LeavesShortJobsTimeToWork) {
  SlurmOptions options;
  options.minutes = 1;
  EXPECT_THAT(Slurm(options).script(1), HasSubstr("--signal=B:TERM@15\n"));
  options.minutes = 4;
  EXPECT_THAT(Slurm(options).script(1), HasSubstr("--signal=B:TERM@60\n"));
}

TEST(SlurmScript, ExcludesNodesInAdditionToTheUsersExclusions) {
  SlurmOptions options;
  options.more = {"--exclude=n7", "--partition=short"};
  const std::string script = Slurm(options).script(1, {"n1", "n2"});
  EXPECT_THAT(script, HasSubstr("#SBATCH --exclude=n1,n2,n7\n"));
  EXPECT_GT(script.find("n1,n2,n7"), script.find("--exclude=n7")) << "the last one counts";
  EXPECT_THAT(Slurm(options).script(1), Not(HasSubstr("n1")));
}

TEST(SlurmScript, NamesTheLogOfAJob) {
  SlurmOptions options;
  options.log = "/logs/%A/job-%a-%x.log";
  EXPECT_EQ(Slurm(options).logOf("12_3"), "/logs/12/job-3-%x.log");
  options.log = "100%";
  EXPECT_EQ(Slurm(options).logOf("12"), "100%");
}

/// Output of squeue of Slurm 22.05; spaces pad cells to their width.
std::string cells(const std::vector<std::string>& line) {
  const std::vector<std::size_t> widths = {20, 40, 100, 12, 20, 24, 200, 200};
  std::string text;
  for (std::size_t n = 0; n < line.size(); ++n)
    text += line[n] + std::string(widths[n] - line[n].size(), ' ');
  return text + '\n';
}
const std::string here = "palpate at tcp://10.78.0.1:99";

SlurmJobs parsed(const std::vector<std::vector<std::string>>& lines) {
  std::string text;
  for (const auto& line : lines) text += cells(line);
  return SlurmJobs::parsed(text, "tcp://10.78.0.1:99");
}

TEST(SlurmJobs, EndedJobsAreListedByOutcomeInOrder) {
  const SlurmJobs jobs = parsed({
      {"FAILED", "27_3", "there", "15", "0:03", "2026-11-25T00:54:10", here, "JobLaunchFailure"},
      {"FAILED", "26_1", "here", "32512", "1-01:00:02", "2026-11-25T00:54:06", here,
       "NonZeroExitCode"},
      {"FAILED", "29", "there", "4021", "0:00", "2026-11-25T00:54:11", "(null)",
       "JobLaunchFailure"},
      {"FAILED", "30", "there", "33280", "59:01", "2026-11-25T00:54:12", here, "NonZeroExitCode"},
      {"CANCELLED", "8", "", "0", "0:00", "2026-11-25T00:54:13", here, "JobHeldUser"},
      {"COMPLETED", "9", "here", "0", "10:00", "2026-11-25T00:54:14", here, "None"},
      {"COMPLETING", "17", "there", "15", "0:02", "2026-11-25T00:43:01", here, "None"},
  });
  ASSERT_THAT(jobs.ended, SizeIs(6));
  const Launches::Ended& first = jobs.ended[0];
  EXPECT_EQ(first.id, "26_1");
  EXPECT_EQ(first.node, "here");
  EXPECT_EQ(first.how, How::failed);
  EXPECT_EQ(first.words, "exit code 127");
  EXPECT_EQ(first.age, std::chrono::seconds(25 * 3600 + 2));
  EXPECT_EQ(jobs.ended[1].how, How::from_outside) << "told to end before it listened";
  EXPECT_EQ(jobs.ended[2].how, How::failed);
  EXPECT_EQ(jobs.ended[2].words, "JobLaunchFailure, signal 53");
  EXPECT_EQ(jobs.ended[3].how, How::from_outside) << "exit code 130: its time limit";
  EXPECT_EQ(jobs.ended[4].how, How::from_outside);
  EXPECT_EQ(jobs.ended[5].how, How::well);
}

TEST(SlurmJobs, OwnWaitingJobsAreListedByReason) {
  const SlurmJobs jobs = parsed({
      {"PENDING", "28_1", "", "0", "0:00", "N/A", "palpate at tcp://10.78.0.1:7", "JobHeldUser"},
      {"PENDING", "29_1", "", "0", "0:00", "N/A", here, "QOSMaxJobsPerUserLimit"},
      {"PENDING", "29_2", "", "0", "0:00", "N/A", here, "launch failed requeued held"},
      {"PENDING", "29_3", "", "0", "0:00", "N/A", "somebody's own", "QOSMaxJobsPerUserLimit"},
      {"RUNNING", "27_5", "here", "0", "0:07", "NONE", here, "None"},
      {"RUNNING", "27_6", "here", "0", "0:07", "NONE", "palpate at tcp://10.78.0.1:7", "None"},
  });
  EXPECT_THAT(jobs.reasons(), ElementsAre(Pair("QOSMaxJobsPerUserLimit", 2),
                                          Pair("launch failed requeued held", 1)));
  EXPECT_THAT(jobs.elsewhere, ElementsAre("28_1", "27_6"));
  ASSERT_THAT(jobs.running, SizeIs(1));
  EXPECT_EQ(jobs.running[0].age, std::chrono::seconds(7));
}

TEST(SlurmJobs, InvalidOutputHasNone) {
  for (const char* text : {"", "\n\n", "slurm_load_jobs error: Unable to contact", "RUNNING\n"}) {
    const SlurmJobs jobs = SlurmJobs::parsed(text, "tcp://head:7411");
    EXPECT_TRUE(jobs.queued.empty() && jobs.running.empty()) << text;
  }
}

}  // namespace
}  // namespace palpate
