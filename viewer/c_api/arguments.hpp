#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "viewer/c_api/palpate.h"
#include "viewer/fields/force_field.hpp"

namespace palpate {

/// Text of the last failure of this thread, for palpate_last_error; truncated if too long.
using ErrorText = std::array<char, 1024>;
ErrorText& lastErrorText() noexcept;

/// Records a failure of this thread and returns its status. Does not allocate, except that the
/// first failure of a thread may allocate its text.
template <class... Args>
palpate_status fail(palpate_status status, fmt::format_string<Args...> format,
                    Args&&... args) noexcept {
  ErrorText& text = lastErrorText();
  try {
    const auto written =
        fmt::format_to_n(text.data(), text.size() - 1, format, std::forward<Args>(args)...).size;
    text[std::min(written, text.size() - 1)] = '\0';
  } catch (...) {
    constexpr std::string_view unknown = "failed, and the error text could not be formatted";
    text[unknown.copy(text.data(), text.size() - 1)] = '\0';
  }
  return status;
}

/// Records that an argument is invalid. Returns false, as the checks of arguments do on failure.
template <class... Args>
bool refuse(fmt::format_string<Args...> format, Args&&... args) noexcept {
  fail(PALPATE_INVALID_ARGUMENT, format, std::forward<Args>(args)...);
  return false;
}

/// Runs `work` and turns its exceptions into a status. An Error becomes PALPATE_BAD_FILE, because
/// arguments were checked before and only the opened file can be wrong.
template <class Work>
palpate_status withoutExceptions(const char* function, Work&& work) noexcept {
  try {
    std::forward<Work>(work)();
    return PALPATE_OK;
  } catch (const std::bad_alloc&) {
    return fail(PALPATE_OUT_OF_MEMORY, "{}: out of memory; prepare fewer methods", function);
  } catch (const Error& error) {
    return fail(PALPATE_BAD_FILE, "{}: {}", function, error.what());
  } catch (const std::exception& error) {
    return fail(PALPATE_FAILED, "{}: {}", function, error.what());
  } catch (...) {
    return fail(PALPATE_FAILED, "{}: unknown exception", function);
  }
}

// Checks of arguments. Each returns whether the argument is valid, and records the failure if not.

inline bool isThere(const char* function, const char* name, const void* pointer) noexcept {
  return pointer != nullptr || refuse("{}: {} is NULL", function, name);
}

/// Sizes of the structures in their first published version; no caller has a smaller one. Only the
/// structures below have grown since.
template <class Struct>
constexpr std::size_t firstSize(const Struct*) {
  return sizeof(Struct);
}
constexpr std::size_t firstSize(const palpate_answers*) { return 80; }
constexpr std::size_t firstSize(const palpate_area_sample*) { return 184; }
constexpr std::size_t firstSize(const palpate_contact_options*) { return 48; }
constexpr std::size_t firstSize(const palpate_touch*) { return 360; }
constexpr std::size_t firstSize(const palpate_guard_options*) { return 64; }

/// Records a failure and returns false if the caller's structure is NULL or has an unknown size.
template <class Struct>
bool sizeIsKnown(const char* function, const char* name, const Struct* given) noexcept {
  constexpr std::size_t first_size = firstSize(static_cast<Struct*>(nullptr));
  static_assert(first_size <= sizeof(Struct));
  if (!isThere(function, name, given)) return false;
  return (given->size >= first_size && given->size <= sizeof(Struct)) ||
         refuse(
             "{}: {}->size is {}, not {}; set it to sizeof(*{}), and use a library at least as "
             "new as palpate.h",
             function, name, given->size, sizeof(Struct), name);
}

/// Copies `value` into the caller's structure, as far as the caller's `size` allows; `size` was
/// checked before and stays the same.
template <class Struct>
void give(Struct* to, Struct value) noexcept {
  value.size = to->size;
  std::memcpy(to, &value, value.size);
}

/// Returns `defaults`, overwritten by all members that the caller's version of the structure has.
/// The structure's size was checked before.
template <class Struct>
Struct taken(const Struct* from, Struct defaults) noexcept {
  std::memcpy(&defaults, from, from->size);
  return defaults;
}

inline Eigen::Vector3d vectorOf(const double values[3]) noexcept {
  return {values[0], values[1], values[2]};
}
inline Eigen::Matrix3d matrixOf(const double values[9]) noexcept {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values);
}
inline void give(double to[3], const Eigen::Vector3d& values) noexcept {
  Eigen::Map<Eigen::Vector3d>{to} = values;
}
inline void give(double to[9], const Eigen::Matrix3d& values) noexcept {
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{to} = values;
}

/// Copies a sample into the members that the structures of samples and touches have in common. Does
/// not set `size`.
template <class Struct>
void giveForce(Struct& to, const ForceSample& sample) noexcept {
  give(to.force, sample.force);
  give(to.stiffness, sample.stiffness);
  to.energy = sample.energy;
  to.error_bound = sample.error_bound;
  to.coverage = sample.coverage;
  to.inside = sample.inside ? 1 : 0;
}

/// Copies a sample into element n of each of the caller's arrays that is not NULL.
template <class Struct>
void giveAnswer(const palpate_answers& to, std::size_t n, const Struct& sample) noexcept {
  if (to.forces != nullptr) std::copy_n(sample.force, 3, to.forces + 3 * n);
  if (to.stiffnesses != nullptr) std::copy_n(sample.stiffness, 9, to.stiffnesses + 9 * n);
  if (to.energies != nullptr) to.energies[n] = sample.energy;
  if (to.error_bounds != nullptr) to.error_bounds[n] = sample.error_bound;
  if (to.coverages != nullptr) to.coverages[n] = sample.coverage;
  if (to.inside != nullptr) to.inside[n] = static_cast<std::uint8_t>(sample.inside);
}

inline bool isNumber(const char* function, const char* what, std::int32_t number,
                     std::ptrdiff_t count) noexcept {
  if (count == 0) return refuse("{}: this dataset has no {}", function, what);
  return (number >= 0 && number < count) ||
         refuse("{}: {} {} does not exist; valid numbers are 0 to {}", function, what, number,
                count - 1);
}

inline bool isEnough(const char* function, std::size_t capacity, std::size_t needed) noexcept {
  return capacity >= needed ||
         refuse("{}: the buffer holds {} numbers, but {} are needed", function, capacity, needed);
}

/// Lower limit of a number that has no other limits.
enum class Least { above_zero, zero };
inline bool isFinite(const char* function, const char* name, double value, Least least) noexcept {
  return (std::isfinite(value) && (least == Least::zero ? value >= 0 : value > 0)) ||
         refuse("{}: {} is {}; it must be finite and {} 0", function, name, value,
                least == Least::zero ? ">=" : ">");
}

/// Links a number in an options structure of the C API to its counterpart in the library's options.
template <class Given, class Options>
struct OptionNumber {
  const char* name;  ///< "options->friction"
  Least least;
  double Given::*given;
  double Options::*twin;
};

/// Copies the library's options into the caller's structure, for all `numbers`.
template <class Given, class Options, class Numbers>
void fillIn(Given& given, const Options& options, const Numbers& numbers) noexcept {
  for (const auto& number : numbers) given.*number.given = options.*number.twin;
}

/// Copies the caller's structure into the library's options, for all `numbers`. Records the failure
/// and returns false if a number is invalid.
template <class Given, class Options, class Numbers>
bool takeOver(const char* function, const Given& given, Options& options,
              const Numbers& numbers) noexcept {
  for (const auto& number : numbers) {
    if (!isFinite(function, number.name, given.*number.given, number.least)) return false;
    options.*number.twin = given.*number.given;
  }
  return true;
}

/// Overwrites `chosen`, which holds the defaults, with the members of the caller's structure. NULL
/// keeps the defaults. Returns false if the structure is invalid.
template <class Struct>
bool takeOptions(const char* function, const Struct* options, Struct& chosen) noexcept {
  if (options == nullptr) return true;
  if (!sizeIsKnown(function, "options", options)) return false;
  chosen = taken(options, chosen);
  return true;
}

/// Finds the element with a name. If there is none, records an error text that lists all names.
template <class Elements, class NameOf>
palpate_status findNamed(const char* function, const char* what, const char* name,
                         const Elements& elements, NameOf nameOf, const char* result,
                         std::int32_t* number) noexcept {
  if (!isThere(function, "name", name) || !isThere(function, result, number))
    return PALPATE_INVALID_ARGUMENT;
  const auto found = std::ranges::find(elements, std::string_view(name), nameOf);
  if (found != elements.end()) {
    *number = static_cast<std::int32_t>(found - elements.begin());
    return PALPATE_OK;
  }
  // Only a failed search allocates, to keep successful ones cheap.
  const palpate_status failed = withoutExceptions(function, [&] {
    refuse("{}: unknown {} \"{}\"; known: {}", function, what, name,
           fmt::join(mapped(elements, nameOf), ", "));
  });
  return failed == PALPATE_OK ? PALPATE_INVALID_ARGUMENT : failed;
}

/// Returns the number of indices in `triples` triangles, or of coordinates in `triples` vertices.
inline std::size_t countOf(std::int32_t triples) noexcept { return 3 * at(triples); }

}  // namespace palpate
