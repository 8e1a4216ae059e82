#pragma once

#include "common/base/scratch_folder.hpp"
#include "common/problem/problem.hpp"

namespace palpate {

/// A dataset of guesses for a scene without a dataset: a spring at every site of a finger, about as
/// stiff as the softest material. A hand feels the guess in the first hundredths of a second of a
/// contact, until the live solver has answered, and whenever the live solver does not keep up
/// (LiveTouch with `guessed`). The destructor removes the file.
class GuessedDataset {
 public:
  /// Error (bad input) if a tool of the scene is not a finger. Error if the file cannot be written
  /// in the directory for temporary files.
  explicit GuessedDataset(Problem problem);

  const std::filesystem::path& file() const { return file_; }

 private:
  ScratchFolder folder_;
  std::filesystem::path file_;
};

}  // namespace palpate
