#pragma once

#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "tests/support/file_bytes.hpp"

/// What the fuzzers share. Each is one source, NAME_fuzzer.cpp, and is linked twice: with
/// libFuzzer, and with all others into the program that reads the corpora once (README.md).
namespace palpate::fuzz {

/// A parser, and what it is given.
struct Fuzzer {
  std::string name;
  /// Reads any bytes. Error is the answer to most of them; anything else that leaves it, a crash,
  /// and what the sanitizers or libFuzzer stop, is a finding.
  void (*read)(std::string_view bytes);
  /// Inputs to begin with, as the program's own writers make them: they do not go out of date.
  std::vector<std::string> (*seeds)();
  /// What all inputs share and takes long: before the first of them, since each has a time limit.
  void (*prepare)() = nullptr;
};

/// Those of this program.
std::vector<Fuzzer>& fuzzers();

/// Adds one to them before main() begins.
struct Registration {
  explicit Registration(Fuzzer fuzzer) { fuzzers().push_back(std::move(fuzzer)); }
};

/// One input. The log is silent meanwhile.
void feed(const Fuzzer& fuzzer, std::string_view bytes);

/// Writes the fuzzer's own seeds into a folder: seed-0, seed-1 and so on.
void writeSeeds(const Fuzzer& fuzzer, const std::filesystem::path& folder);

/// Ends the process, which is a finding, unless the condition holds: for what must be true of
/// everything that a parser accepts.
void require(bool condition, const char* what);

using test::bytesIn, test::putInto;

/// An input that says what to do, for what is more than a file. Where it ends, all is zero.
class Choices {
 public:
  explicit Choices(std::string_view bytes) : rest_(bytes) {}

  bool done() const { return rest_.empty(); }

  template <class Number = unsigned char>
  Number take() {
    static_assert(std::is_trivially_copyable_v<Number>);
    Number number{};
    const std::string_view bytes = takeUpTo(sizeof number);
    std::memcpy(&number, bytes.data(), bytes.size());
    return number;
  }
  /// One of 0 to count-1.
  std::size_t oneOf(std::size_t count) { return take() % count; }
  /// Two bytes say how many.
  std::string_view takeBytes() { return takeUpTo(take<std::uint16_t>()); }
  std::string_view rest() { return takeUpTo(rest_.size()); }

 private:
  std::string_view takeUpTo(std::size_t count) {
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(taken.size());
    return taken;
  }

  std::string_view rest_;
};

/// What Choices takes back: for seeds.
class Script {
 public:
  template <class Number>
  Script& put(Number number) {
    static_assert(std::is_trivially_copyable_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
    return *this;
  }
  Script& op(unsigned char which) { return put(which); }
  /// At most 65535.
  Script& putBytes(std::string_view bytes) {
    put(static_cast<std::uint16_t>(bytes.size()));
    bytes_ += bytes;
    return *this;
  }
  std::string text() const { return bytes_; }

 private:
  std::string bytes_;
};

}  // namespace palpate::fuzz
