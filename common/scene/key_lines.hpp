#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/error.hpp"

namespace palpate {

/// Where a table and its keys stand in the text of a scene, for errors that only the mesh shows.
/// Any two are equal: what a scene means does not depend on where its keys stand.
struct KeyLines {
  int table = 0;  ///< from 1; 0: unknown
  std::vector<std::pair<std::string, int>> keys = {};

  /// The line of the key, or of the table where the key is left out.
  int of(std::string_view key) const {
    for (const auto& [name, line] : keys)
      if (name == key) return line;
    return table;
  }
  bool operator==(const KeyLines&) const { return true; }
};

/// An error about this line of the scene's file. Whoever knows the file puts both before it.
class SceneError : public Error {
 public:
  SceneError(int line, const Error& error) : Error(error), line_(line) {}
  int line() const { return line_; }

 private:
  int line_;
};

/// badInput() about this line.
template <class... Args>
SceneError badInputAt(int line, fmt::format_string<Args...> format, Args&&... args) {
  return {line, badInput(format, std::forward<Args>(args)...)};
}

/// What `work` returns. An Error that it throws becomes one about `line`, unless it has a line.
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
