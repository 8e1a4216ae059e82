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

/// Text of the last failure of this thread, for palpate_last_error; cut where it does not fit.
using ErrorText = std::array<char, 1024>;
ErrorText& lastErrorText() noexcept;

/// Records a failure of this thread and gives back its status. Does not allocate (the first failure
/// of a thread may: its text comes to be).
template <class... Args>
palpate_status fail(palpate_status status, fmt::format_string<Args...> format,
                    Args&&... args) noexcept {
  ErrorText& text = lastErrorText();
  try {
    const auto written =
        fmt::format_to_n(text.data(), text.size() - 1, format, std::forward<Args>(args)...).size;
    text[std::min(written, text.size() - 1)] = '\0';
  } catch (...) {
    constexpr std::string_view unknown = "failed, and the text that says why could not be made";
    text[unknown.copy(text.data(), text.size() - 1)] = '\0';
  }
  return status;
}

/// Records that an argument cannot be used. False, as checks of arguments tell it.
template <class... Args>
bool refuse(fmt::format_string<Args...> format, Args&&... args) noexcept {
  fail(PALPATE_INVALID_ARGUMENT, format, std::forward<Args>(args)...);
  return false;
}

/// Runs what may throw. An Error is about the file that is being opened: arguments were looked at
/// before.
template <class Work>
palpate_status withoutExceptions(const char* function, Work&& work) noexcept {
  try {
    std::forward<Work>(work)();
    return PALPATE_OK;
  } catch (const std::bad_alloc&) {
    return fail(PALPATE_OUT_OF_MEMORY, "{}: there is not enough memory; prepare fewer methods",
                function);
  } catch (const Error& error) {
    return fail(PALPATE_BAD_FILE, "{}: {}", function, error.what());
  } catch (const std::exception& error) {
    return fail(PALPATE_FAILED, "{}: {}", function, error.what());
  } catch (...) {
    return fail(PALPATE_FAILED, "{}: an exception of an unknown kind", function);
  }
}

// Checks of arguments. Each tells whether the argument can be used, and records what is wrong with
// it.

inline bool isThere(const char* function, const char* name, const void* pointer) noexcept {
  return pointer != nullptr || refuse("{}: {} is NULL", function, name);
}

/// sizeof each structure when it was published first: callers with smaller ones do not exist.
constexpr std::size_t firstSize(const palpate_open_options*) { return 32; }
constexpr std::size_t firstSize(const palpate_dataset_info*) { return 64; }
constexpr std::size_t firstSize(const palpate_space_info*) { return 72; }
constexpr std::size_t firstSize(const palpate_sample*) { return 136; }
constexpr std::size_t firstSize(const palpate_answers*) { return 80; }
constexpr std::size_t firstSize(const palpate_area_info*) { return 40; }
constexpr std::size_t firstSize(const palpate_area_sample*) { return 184; }
constexpr std::size_t firstSize(const palpate_contact_options*) { return 48; }
constexpr std::size_t firstSize(const palpate_touch*) { return 360; }
constexpr std::size_t firstSize(const palpate_profile*) { return 40; }
constexpr std::size_t firstSize(const palpate_guard_options*) { return 64; }
constexpr std::size_t firstSize(const palpate_guarded_force*) { return 48; }

/// Whether a structure of the caller is there and of a size that this library knows; records what
/// is wrong.
template <class Struct>
bool sizeIsKnown(const char* function, const char* name, const Struct* given) noexcept {
  constexpr std::size_t first_size = firstSize(static_cast<Struct*>(nullptr));
  static_assert(first_size <= sizeof(Struct));
  if (!isThere(function, name, given)) return false;
  return (given->size >= first_size && given->size <= sizeof(Struct)) ||
         refuse(
             "{}: {}->size is {}, not {}; "
             "set it to sizeof(*{}), and use a library as new as palpate.h",
             function, name, given->size, sizeof(Struct), name);
}

/// Copies what the caller's structure has of `value`, and keeps its size. Its size is known.
template <class Struct>
void give(Struct* to, Struct value) noexcept {
  value.size = to->size;
  std::memcpy(to, &value, value.size);
}

/// `defaults` overwritten by what the caller's structure has. Its size is known.
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

/// What a sample and a touch of the caller both say of a force. Does not set their sizes.
template <class Struct>
void giveForce(Struct& to, const ForceSample& sample) noexcept {
  give(to.force, sample.force);
  give(to.stiffness, sample.stiffness);
  to.energy = sample.energy;
  to.error_bound = sample.error_bound;
  to.coverage = sample.coverage;
  to.inside = sample.inside ? 1 : 0;
}

/// What a sample says of a force, as answer n of the caller's arrays.
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
  if (count == 0) return refuse("{}: there is no {} in this dataset", function, what);
  return (number >= 0 && number < count) ||
         refuse("{}: there is no {} {}; they are numbered 0 to {}", function, what, number,
                count - 1);
}

inline bool isEnough(const char* function, std::size_t capacity, std::size_t needed) noexcept {
  return capacity >= needed ||
         refuse("{}: the buffer holds {} numbers, {} are needed", function, capacity, needed);
}

/// Whether a number that has no other limits is above zero, or zero.
enum class Least { above_zero, zero };
inline bool isFinite(const char* function, const char* name, double value, Least least) noexcept {
  return (std::isfinite(value) && (least == Least::zero ? value >= 0 : value > 0)) ||
         refuse("{}: {} is {}; it must be finite and {} 0", function, name, value,
                least == Least::zero ? ">=" : ">");
}

/// A number that a structure of options has, and its twin inside of the library.
template <class Given, class Options>
struct OptionNumber {
  const char* name;  ///< "options->friction"
  Least least;
  double Given::*given;
  double Options::*twin;
};

/// Copies all `numbers` of the library's options into the structure.
template <class Given, class Options, class Numbers>
void fillIn(Given& given, const Options& options, const Numbers& numbers) noexcept {
  for (const auto& number : numbers) given.*number.given = options.*number.twin;
}

/// Copies them back. False when one of them cannot be used.
template <class Given, class Options, class Numbers>
bool takeOver(const char* function, const Given& given, Options& options,
              const Numbers& numbers) noexcept {
  for (const auto& number : numbers) {
    if (!isFinite(function, number.name, given.*number.given, number.least)) return false;
    options.*number.twin = given.*number.given;
  }
  return true;
}

/// Overwrites `chosen`, which holds the defaults, by what the caller's structure has; NULL is one
/// that has nothing.
template <class Struct>
bool takeOptions(const char* function, const Struct* options, Struct& chosen) noexcept {
  if (options == nullptr) return true;
  if (!sizeIsKnown(function, "options", options)) return false;
  chosen = taken(options, chosen);
  return true;
}

/// Number of the element with a name; when there is none that is recorded with all names.
template <class Elements, class NameOf>
palpate_status findNamed(const char* function, const char* what, std::string_view name,
                         const Elements& elements, NameOf nameOf, std::int32_t* number) noexcept {
  const auto found = std::ranges::find(elements, name, nameOf);
  if (found != elements.end()) {
    *number = static_cast<std::int32_t>(found - elements.begin());
    return PALPATE_OK;
  }
  // Only now: what is found needs no memory, so that looking up is cheap.
  std::string names;
  const palpate_status status = withoutExceptions(function, [&] {
    for (const auto& element : elements)
      names += (names.empty() ? "" : ", ") + std::string(nameOf(element));
  });
  if (status != PALPATE_OK) return status;
  return fail(PALPATE_INVALID_ARGUMENT, "{}: there is no {} \"{}\"; there are: {}", function, what,
              name, names);
}

/// Numbers in `triples` vertices or triangles.
inline std::size_t countOf(std::int32_t triples) noexcept { return 3 * at(triples); }

}  // namespace palpate
