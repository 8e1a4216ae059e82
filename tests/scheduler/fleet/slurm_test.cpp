#include "scheduler/fleet/slurm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using testing::HasSubstr;

TEST(SlurmScript, IsAnArrayOfWorkersThatAreToldBeforeTheirTimeIsUp) {
  const Slurm slurm({.name = "palpate-0123",
                     .command = {"/opt/palpate-worker", "work", "--keys", "/home/o'neil/keys"},
                     .minutes = 90,
                     .constraint = "avx2",
                     .more = {"--partition=short"}});
  const std::string script = slurm.script(3);
  for (const char* line : {"#!/bin/sh\n", "#SBATCH --job-name=palpate-0123\n",
                           "#SBATCH --array=1-3\n", "#SBATCH --ntasks=1 --cpus-per-task=1\n",
                           "#SBATCH --time=90\n", "#SBATCH --signal=B:TERM@60\n",
                           "#SBATCH --constraint=avx2\n", "#SBATCH --partition=short\n",
                           "exec '/opt/palpate-worker' 'work' '--keys' '/home/o'\\''neil/keys'\n"})
    EXPECT_THAT(script, HasSubstr(line));
}

TEST(SlurmScript, OfShortJobsLeavesTimeToWork) {
  SlurmOptions options;
  options.minutes = 1;
  EXPECT_THAT(Slurm(options).script(1), HasSubstr("--signal=B:TERM@15\n"));
  options.minutes = 4;
  EXPECT_THAT(Slurm(options).script(1), HasSubstr("--signal=B:TERM@60\n"));
}

}  // namespace
}  // namespace palpate
