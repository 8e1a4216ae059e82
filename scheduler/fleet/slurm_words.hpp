#pragma once

#include <string>
#include <string_view>

namespace palpate {

/// What somebody can do about what Slurm says.
struct SlurmAdvice {
  std::string what;      ///< a clause; empty: nothing is known
  bool lasting = false;  ///< it says the same until an option is changed
};

/// When sbatch ended with `exit_code` and these words.
SlurmAdvice adviceOnRefusal(int exit_code, std::string_view words);
/// When a job stays queued with this reason of squeue. Lasting: it never starts so.
SlurmAdvice adviceOnReason(std::string_view reason);
/// Why a job may have failed that ended so (Launches::Ended::words); empty when nothing is known.
std::string adviceOnEnd(std::string_view words);

}  // namespace palpate
