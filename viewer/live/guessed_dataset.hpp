#pragma once

#include "common/base/scratch_folder.hpp"
#include "common/problem/problem.hpp"

namespace palpate {

/// A dataset of guesses for a scene that nobody has computed: a spring at every site of a finger,
/// about as stiff as the softest material. A hand feels it for the first hundredths of a second of
/// a contact, until a follower has answered, and where the follower does not keep up (LiveTouch
/// with `guessed`). The file is removed with this object.
class GuessedDataset {
 public:
  /// Error (bad input) if no finger touches the scene. Error if the file cannot be written, in the
  /// directory for temporary files.
  explicit GuessedDataset(Problem problem);

  const std::filesystem::path& file() const { return file_; }

 private:
  ScratchFolder folder_;
  std::filesystem::path file_;
};

}  // namespace palpate
