#include "scheduler/fleet/slurm_words.hpp"

#include <array>
#include <span>

namespace palpate {
namespace {

struct Line {
  std::string_view words;
  const char* what;
  bool lasting;
};

constexpr const char* other_partition = "-- --partition=NAME asks for another; sinfo lists them";
constexpr const char* your_limit =
    "a limit of your account: a smaller --most, --backlog or --minutes keeps within it";
constexpr const char* time_limit =
    "the partition allows less time: a smaller --minutes (sinfo -o '%P %l' shows how much)";
constexpr const char* no_such_node =
    "no node has what is asked for: look at --constraint and the options behind --";
constexpr const char* held =
    "somebody, or a node that could not start it, holds it: scontrol release JOB when the reason "
    "is gone, or scancel JOB";

// As Slurm 22.05 says it (slurm_errno.c); beginnings and parts, since versions add to them.
constexpr std::array refusals = {
    Line{"nvalid partition", other_partition, true},
    Line{"Required partition not available", other_partition, false},
    Line{"not permitted to use this partition", other_partition, true},
    Line{"nvalid account", "-- --account=NAME; sacctmgr show associations user=$USER lists them",
         true},
    Line{"nvalid qos", "-- --qos=NAME; sacctmgr show qos lists them", true},
    Line{"Requested time limit is invalid", time_limit, true},
    Line{"Invalid feature specification", "--constraint: sinfo -o '%N %f' shows what nodes have",
         true},
    Line{"Invalid node name", "-- --exclude and --nodelist: sinfo -N lists the nodes", true},
    Line{"node configuration is not available", no_such_node, true},
    Line{"ore processors requested than permitted", no_such_node, true},
    Line{"Requested reservation is invalid", "-- --reservation: scontrol show reservation", true},
    Line{"Invalid job array specification",
         "this Slurm takes no array jobs (MaxArraySize): ask who runs it", true},
    Line{"violates accounting/QOS policy", your_limit, false},
    Line{
        "temporarily unable to accept job",
        "it holds as many jobs as it may (MaxJobCount): it is asked again, and a smaller --backlog "
        "asks for fewer",
        false},
    Line{"Unable to contact slurm controller", "it is asked again", false},
    // Heard when the clock of munged was ten minutes off.
    Line{"Zero Bytes were transmitted",
         "it does not believe who asks: does munged run here with its key, and do the clocks agree "
         "to 5 minutes?",
         false},
};

constexpr std::array reasons = {
    Line{"JobHeld", held, true},
    Line{"launch failed requeued held", held, true},
    Line{"job requeued in held state", held, true},
    Line{"BadConstraints", no_such_node, true},
    Line{"PartitionTimeLimit", time_limit, true},
    Line{"PartitionNodeLimit", other_partition, true},
    Line{"PartitionDown", other_partition, false},
    Line{"PartitionInactive", other_partition, false},
    Line{"AccountNotAllowed", "-- --account=NAME, or another partition", true},
    Line{"InvalidAccount", "-- --account=NAME", true},
    Line{"QOSNotAllowed", "-- --qos=NAME, or another partition", true},
    Line{"InvalidQOS", "-- --qos=NAME", true},
    Line{"AssocMaxWallDurationPerJobLimit", your_limit, true},
    Line{"QOSMaxWallDurationPerJobLimit", your_limit, true},
    Line{"Assoc", "a limit of your account: they start when others end", false},
    Line{"QOS", "a limit of your account: they start when others end", false},
    Line{"ReqNodeNotAvail", "nodes are down, drained or reserved: sinfo -R tells why", false},
};

/// The last numbers are those of shells; 53 is how Slurm says that a file could not be opened.
constexpr std::array ends = {
    Line{"JobLaunchFailure, signal 53", "the node cannot write --log: name a folder that is there",
         true},
    Line{"signal 4", "its CPU does not know an instruction: --constraint=FEATURE, or -- --exclude",
         true},
    Line{"OUT_OF_MEMORY", "it had too little memory: -- --mem-per-cpu=SIZE asks for more", false},
    Line{"exit code 126", "its program cannot be run there", true},
    Line{"exit code 127",
         "its program, or a library of that, is not there: install it on the node, or in a folder "
         "that all share",
         true},
};

const Line* lineIn(std::span<const Line> lines, std::string_view words) {
  for (const Line& line : lines)
    if (words.find(line.words) != std::string_view::npos) return &line;
  return nullptr;
}

}  // namespace

SlurmAdvice adviceOnRefusal(int exit_code, std::string_view words) {
  if (const Line* line = lineIn(refusals, words)) return {line->what, line->lasting};
  // Of a command line that it does not understand, whatever the word.
  constexpr int not_understood = 255;
  if (exit_code == not_understood)
    return {"what stands behind -- must be options of sbatch, each one word: --partition=short",
            true};
  return {};
}

SlurmAdvice adviceOnReason(std::string_view reason) {
  const Line* line = lineIn(reasons, reason);
  return line != nullptr ? SlurmAdvice{line->what, line->lasting} : SlurmAdvice{};
}

std::string adviceOnEnd(std::string_view words) {
  const Line* line = lineIn(ends, words);
  return line != nullptr ? line->what : "";
}

}  // namespace palpate
