#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/number_in.hpp"

namespace palpate {

/// Reads text line by line and word by word. Skips blank lines. Errors carry file and line.
class TextLines {
 public:
  /// `source` names the file in errors. Skips a UTF-8 byte order mark, which Windows programs may
  /// write.
  TextLines(std::string text, std::string source)
      : text_(std::move(text)),
        source_(std::move(source)),
        at_(text_.starts_with("\xEF\xBB\xBF") ? 3 : 0) {}

  /// Advances to the next line that is not blank; returns false at the end of the text.
  bool advance() {
    while (nextLine())
      if (!rest_.empty()) return true;
    return false;
  }

  /// Like advance(), but the end of the text is an error: the file is truncated inside `section`.
  void advanceIn(std::string_view section) {
    if (!advance())
      throw badInput("{}:{}: the file is truncated: it ends inside {}", source_, number_, section);
  }

  std::string_view rest() const { return rest_; }
  std::size_t number() const { return number_; }
  bool atEndOfLine() const { return rest_.empty(); }

  /// Reads the next number of the line; `what` names it in errors.
  template <class Number>
  Number take(const char* what) {
    const std::string_view token = takeWord();
    if (token.empty()) throw wrong("the line ends where {} is expected", what);
    const auto value = numberIn<Number>(token.front() == '+' ? token.substr(1) : token);
    if (!value) throw wrong("\"{}\" where {} is expected", token, what);
    return *value;
  }

  double takeFinite(const char* what) {
    const auto value = take<double>(what);
    if (!std::isfinite(value)) throw wrong("{} is not finite", what);
    return value;
  }

  /// Returns the next word of the line, or an empty word at the end of the line.
  std::string_view takeWord() {
    const std::string_view word = rest_.substr(0, rest_.find_first_of(blanks));
    rest_.remove_prefix(word.size());
    skipBlanks();
    return word;
  }

  /// Reads the count of the items that follow. The count may be wrong, so pass it through
  /// reserveFor() before memory is allocated for the items.
  std::size_t takeCount(const char* what) {
    const auto count = take<std::int64_t>(what);
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    if (count < 0 || count > most) throw wrong("{} is {}, but must be 0 to {}", what, count, most);
    return static_cast<std::size_t>(count);
  }

  /// Limits a count from the file to the number of items that a text of this length can hold. The
  /// shortest item, a point, takes six characters.
  std::size_t reserveFor(std::size_t announced) const {
    return std::min(announced, text_.size() / 6);
  }

  void expectEndOfLine() const {
    if (!rest_.empty()) throw wrong("unexpected \"{}\" at the end of the line", rest_);
  }

  template <class... Args>
  Error wrong(fmt::format_string<Args...> format, Args&&... args) const {
    return badInput("{}:{}: {}", source_, number_,
                    fmt::format(format, std::forward<Args>(args)...));
  }

  const std::string& source() const { return source_; }

 private:
  static constexpr const char* blanks = " \t\r";

  /// Advances to the next line, stripped of blanks; returns false at the end of the text.
  bool nextLine() {
    rest_ = {};
    if (at_ >= text_.size()) return false;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    rest_ = std::string_view(text_).substr(at_, end - at_);
    at_ = end + 1;
    ++number_;
    rest_ = rest_.substr(0, rest_.find_last_not_of(blanks) + 1);
    skipBlanks();
    return true;
  }

  void skipBlanks() {
    rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
  }

  std::string text_;
  std::string source_;
  std::size_t at_;
  std::size_t number_ = 0;
  std::string_view rest_;
};

}  // namespace palpate
