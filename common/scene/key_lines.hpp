#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

namespace palpate {

/// Line numbers of a table and its keys in the scene file. They are kept for errors that are found
/// only after the mesh is read. Two objects always compare equal, because line numbers do not
/// change the meaning of a scene.
struct KeyLines {
  int table = 0;  ///< from 1; 0 if unknown
  std::vector<std::pair<std::string, int>> keys = {};

  /// Returns the line of the key, or of the table if the key is absent.
  int of(std::string_view key) const {
    for (const auto& [name, line] : keys)
      if (name == key) return line;
    return table;
  }
  bool operator==(const KeyLines&) const { return true; }
};

/// An error about a line of the scene file. Code that knows the file catches it and adds file and
/// line to the message.
class SceneError : public Error {
 public:
  SceneError(int line, const Error& error) : Error(error), line_(line) {}
  int line() const { return line_; }

 private:
  int line_;
};

/// Returns a badInput() error about this line.
template <class... Args>
SceneError badInputAt(int line, fmt::format_string<Args...> format, Args&&... args) {
  return {line, badInput(format, std::forward<Args>(args)...)};
}

/// Returns the result of `work`. If `work` throws an Error without a line, throws it as a
/// SceneError with this line.
template <class Work>
auto atLine(int line, const Work& work) {
  try {
    return work();
  } catch (const SceneError&) {
    throw;
  } catch (const Error& error) {
    throw SceneError(line, error);
  }
}

}  // namespace palpate
