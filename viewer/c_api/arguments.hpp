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
#include <span>
#include <stdexcept>
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

/// Reason to refuse an argument.
struct InvalidArgument : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

template <class... Args>
[[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) {
  throw InvalidArgument(fmt::format(format, std::forward<Args>(args)...));
}

/// Runs the body of a function of the C API and turns its exceptions into a status with a text. An
/// Error becomes PALPATE_BAD_FILE, because only an opened file causes one.
template <class Body>
palpate_status answered(const char* function, Body&& body) noexcept {
  try {
    std::forward<Body>(body)();
    return PALPATE_OK;
  } catch (const InvalidArgument& reason) {
    return fail(PALPATE_INVALID_ARGUMENT, "{}: {}", function, reason.what());
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

// The following functions refuse invalid arguments. `name` is the caller's name of the argument.

/// Returns the object at a pointer. Refuses NULL.
template <class Object>
Object& need(const char* name, Object* pointer) {
  if (pointer == nullptr) refuse("{} is NULL", name);
  return *pointer;
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

/// Refuses a structure that is NULL or has an unknown size.
template <class Struct>
void needSize(const char* name, const Struct* given) {
  constexpr std::size_t first_size = firstSize(static_cast<Struct*>(nullptr));
  static_assert(first_size <= sizeof(Struct));
  const std::size_t size = need(name, given).size;
  if (size < first_size || size > sizeof(Struct))
    refuse(
        "{}->size is {}, not {}; set it to sizeof(*{}), and use a library at least as new as "
        "palpate.h",
        name, size, sizeof(Struct), name);
}

/// Copies `value` into the caller's structure, as far as the caller's `size` allows; `size` stays
/// the same.
template <class Struct>
void give(const char* name, Struct* to, Struct value) {
  needSize(name, to);
  value.size = to->size;
  std::memcpy(to, &value, value.size);
}

/// Returns `defaults`, overwritten by all members that the caller's version of the structure has.
template <class Struct>
Struct taken(const char* name, const Struct* from, Struct defaults) {
  needSize(name, from);
  std::memcpy(&defaults, from, from->size);
  return defaults;
}

/// The same for the argument `options`, where NULL keeps the defaults.
template <class Struct>
Struct takenOptions(const Struct* options, const Struct& defaults) {
  return options == nullptr ? defaults : taken("options", options, defaults);
}

inline Eigen::Vector3d vectorOf(const double values[3]) noexcept {
  return {values[0], values[1], values[2]};
}
inline Eigen::Vector3d vectorOf(const char* name, const double values[3]) {
  return vectorOf(&need(name, values));
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

/// Returns the caller's number of one of `count` things.
inline std::size_t indexOf(const char* what, std::int32_t number, std::size_t count) {
  if (count == 0) refuse("this dataset has no {}", what);
  if (number < 0 || at(number) >= count)
    refuse("{} {} does not exist; valid numbers are 0 to {}", what, number, count - 1);
  return at(number);
}

/// Returns the part of the caller's buffer that is filled. Refuses a buffer that is too small.
template <class Number>
std::span<Number> roomIn(const char* name, Number* buffer, std::size_t capacity,
                         std::size_t needed) {
  need(name, buffer);
  if (capacity < needed) refuse("the buffer holds {} numbers, but {} are needed", capacity, needed);
  return {buffer, needed};
}

/// Lower limit of a number that has no other limits.
enum class Least { above_zero, zero };
inline double finite(const char* name, double value, Least least) {
  if (!(std::isfinite(value) && (least == Least::zero ? value >= 0 : value > 0)))
    refuse("{} is {}; it must be finite and {} 0", name, value, least == Least::zero ? ">=" : ">");
  return value;
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

/// Copies the caller's structure into the library's options, for all `numbers`.
template <class Given, class Options, class Numbers>
void takeOver(const Given& given, Options& options, const Numbers& numbers) {
  for (const auto& number : numbers)
    options.*number.twin = finite(number.name, given.*number.given, number.least);
}

/// Returns the number of the element with a name. If there is none, the error text lists all names.
template <class Elements, class NameOf>
std::int32_t numberOf(const char* what, const char* name, const Elements& elements, NameOf nameOf) {
  need("name", name);
  const auto found = std::ranges::find(elements, std::string_view(name), nameOf);
  if (found == elements.end())
    refuse("unknown {} \"{}\"; known: {}", what, name, fmt::join(mapped(elements, nameOf), ", "));
  return static_cast<std::int32_t>(found - elements.begin());
}

}  // namespace palpate
