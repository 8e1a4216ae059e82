#pragma once

#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "tests/support/file_bytes.hpp"

/// Common parts of the fuzzers. Each fuzzer is one source, NAME_fuzzer.cpp, and is linked twice:
/// with libFuzzer, and with all others into the program that reads the corpora once (README.md).
namespace palpate::fuzz {

/// A parser with its seeds.
struct Fuzzer {
  std::string name;
  /// Reads any bytes. Most inputs should cause an Error; any other exception, a crash, or a report
  /// of the sanitizers or libFuzzer is a finding.
  void (*read)(std::string_view bytes);
  /// First inputs, made by the program's own writers, so they never become outdated.
  std::vector<std::string> (*seeds)();
  /// Slow preparation shared by all inputs. It runs before the first input, because each input has
  /// a time limit.
  void (*prepare)() = nullptr;
};

/// The fuzzers of this program.
std::vector<Fuzzer>& fuzzers();

/// Registers a fuzzer before main() begins.
struct Registration {
  explicit Registration(Fuzzer fuzzer) { fuzzers().push_back(std::move(fuzzer)); }
};

/// Reads one input with a silent log.
void feed(const Fuzzer& fuzzer, std::string_view bytes);

/// Writes the fuzzer's own seeds into a folder: seed-0, seed-1 and so on.
void writeSeeds(const Fuzzer& fuzzer, const std::filesystem::path& folder);

/// Ends the process, which is a finding, unless the condition holds. For properties of every
/// accepted input.
void require(bool condition, const char* what);

using test::bytesIn, test::putInto;

/// An input read as a sequence of choices, for tests of more than a file. After its end all values
/// are zero.
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
  /// A number from 0 to count-1.
  std::size_t oneOf(std::size_t count) { return take() % count; }
  /// Two bytes give the length.
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

/// Writes what Choices reads, for seeds.
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
