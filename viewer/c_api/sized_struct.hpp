#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstring>

#include "viewer/c_api/last_error.hpp"

namespace palpate {

/// sizeof each structure when it was published first: callers with smaller ones do not exist.
template <class Struct>
inline constexpr std::size_t first_size = 0;
template <>
inline constexpr std::size_t first_size<palpate_open_options> = 32;
template <>
inline constexpr std::size_t first_size<palpate_dataset_info> = 64;
template <>
inline constexpr std::size_t first_size<palpate_space_info> = 72;
template <>
inline constexpr std::size_t first_size<palpate_sample> = 136;
template <>
inline constexpr std::size_t first_size<palpate_contact_options> = 48;
template <>
inline constexpr std::size_t first_size<palpate_touch> = 360;
template <>
inline constexpr std::size_t first_size<palpate_profile> = 40;
template <>
inline constexpr std::size_t first_size<palpate_guard_options> = 64;
template <>
inline constexpr std::size_t first_size<palpate_guarded_force> = 48;

/// Whether a structure of the caller is there and of a size that this library knows; records what
/// is wrong.
template <class Struct>
bool sizeIsKnown(const char* function, const char* name, const Struct* given) noexcept {
  static_assert(first_size<Struct> > 0 && first_size<Struct> <= sizeof(Struct));
  if (given == nullptr) {
    invalid("{}: {} is NULL", function, name);
    return false;
  }
  if (given->size >= first_size<Struct> && given->size <= sizeof(Struct)) return true;
  invalid(
      "{}: {}->size is {}, not {}; set it to sizeof(*{}), and use a library as new as palpate.h",
      function, name, given->size, sizeof(Struct), name);
  return false;
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

}  // namespace palpate
