#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <numeric>
#include <type_traits>

#include "common/dataset/hdf5_handle.hpp"

namespace palpate::hdf5 {

/// How a list of T lies in an array: one row for each, of `extents` numbers of type Number. The
/// bytes are those of T in memory. Enumerators are their values; int32 holds the bits of uint32,
/// which the file does not have.
template <class T>
struct Stored {
  using Number = T;
  static constexpr std::array<hsize_t, 0> extents = {};
};
template <class T>
requires std::is_enum_v<T>
struct Stored<T> {
  using Number = std::underlying_type_t<T>;
  static constexpr std::array<hsize_t, 0> extents = {};
};
template <>
struct Stored<std::uint32_t> {
  using Number = std::int32_t;
  static constexpr std::array<hsize_t, 0> extents = {};
};
template <std::size_t n>
struct Stored<std::array<std::int32_t, n>> {
  using Number = std::int32_t;
  static constexpr std::array<hsize_t, 1> extents = {n};
};
template <>
struct Stored<ContentId> {
  using Number = std::uint8_t;
  static constexpr std::array<hsize_t, 1> extents = {32};
};
template <>
struct Stored<Eigen::Vector3d> {
  using Number = double;
  static constexpr std::array<hsize_t, 1> extents = {3};
};
using RowMajorMatrix3d = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
template <>
struct Stored<RowMajorMatrix3d> {
  using Number = double;
  static constexpr std::array<hsize_t, 2> extents = {3, 3};
};

/// Numbers in a row of a list of T.
template <class T>
constexpr std::size_t numbersPerRow() {
  constexpr auto extents = Stored<T>::extents;
  constexpr std::size_t count =
      std::accumulate(extents.begin(), extents.end(), std::size_t{1}, std::multiplies<>());
  static_assert(sizeof(T) == count * sizeof(typename Stored<T>::Number));
  return count;
}

/// Shape of a list of T with so many rows.
template <class T>
Shape shapeOfList(hsize_t rows) {
  Shape shape = {rows};
  shape.insert(shape.end(), Stored<T>::extents.begin(), Stored<T>::extents.end());
  return shape;
}

}  // namespace palpate::hdf5
