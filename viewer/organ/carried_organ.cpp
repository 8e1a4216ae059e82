#include "viewer/organ/carried_organ.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

/// Shares and entries of a mode are stored as integers. In each mode the largest share becomes
/// share_steps, and the largest entry becomes mode_steps. Vertices are then wrong by about a tenth
/// of a millimetre.
constexpr float share_steps = 127;
constexpr float mode_steps = 32767;

/// Number of bytes left out of each rounded double, which keeps 37 significant bits. Single
/// precision, in which the fields store these numbers, would not suffice: with it, forces of stiff
/// organs were wrong by up to 1.7e-6 N.
constexpr std::size_t left_out_bytes = 2;
static_assert(std::endian::native == std::endian::little, "bytes must be little-endian");

// The functions `carry...` describe the format once, for both directions: they visit all numbers of
// an organ. With an OrganWriter they append each number to the bytes; with an OrganReader they read
// it from the bytes.

class OrganWriter {
 public:
  static constexpr bool reads = false;
  void raw(const void* from, std::size_t size) {
    bytes_.append(static_cast<const char*>(from), size);
  }
  /// Writes and returns the length of a list.
  std::size_t size(std::size_t length) {
    const auto written = static_cast<std::uint32_t>(length);
    raw(&written, sizeof written);
    return length;
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class OrganReader {
 public:
  static constexpr bool reads = true;
  explicit OrganReader(std::string_view bytes) : bytes_(bytes) {}
  void raw(void* to, std::size_t size) {
    if (size > bytes_.size())
      throw failure(
          "the organ is cut off: download its page again, or make it again with palpate share");
    std::memcpy(to, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  /// Reads the length of a list.
  std::size_t size(std::size_t) {
    std::uint32_t length = 0;
    raw(&length, sizeof length);
    return length;
  }
  bool done() const { return bytes_.empty(); }

 private:
  std::string_view bytes_;
};

/// Whether copying the bytes of a value carries the whole value.
template <class Value>
constexpr bool is_plain = std::is_trivially_copyable_v<Value> ||
                          (std::is_same_v<Value, Eigen::Vector3d> &&
                           sizeof(Eigen::Vector3d) == 3 * sizeof(double));

template <class Bytes, class... Values>
void carry(Bytes& bytes, Values&... values) {
  static_assert((is_plain<std::remove_const_t<Values>> && ...));
  (bytes.raw(&values, sizeof values), ...);
}

template <class Bytes, class List, class Each>
void carryList(Bytes& bytes, List& list, Each each) {
  const std::size_t size = bytes.size(list.size());
  if constexpr (Bytes::reads) list.resize(size);
  for (auto& one : list) each(one);
}

template <class Bytes, class List>
void carryValues(Bytes& bytes, List& list) {
  carryList(bytes, list, [&](auto& value) { carry(bytes, value); });
}

template <class Bytes, class... Matrices>
void carryRounded(Bytes& bytes, Matrices&... matrices) {
  constexpr std::uint64_t half = std::uint64_t{1} << (8 * left_out_bytes - 1);
  const auto carryOne = [&](auto& values) {
    for (Eigen::Index i = 0; i < values.rows(); ++i)
      for (Eigen::Index j = 0; j < values.cols(); ++j) {
        std::uint64_t bits = 0;
        if constexpr (!Bytes::reads) {
          std::memcpy(&bits, &values(i, j), sizeof bits);
          bits += half;
        }
        bytes.raw(reinterpret_cast<char*>(&bits) + left_out_bytes, sizeof bits - left_out_bytes);
        if constexpr (Bytes::reads) std::memcpy(&values(i, j), &bits, sizeof bits);
      }
  };
  (carryOne(matrices), ...);
}

template <class Bytes, class AnEquilibrium>
void carryEquilibrium(Bytes& bytes, AnEquilibrium& e, bool is_finger) {
  carry(bytes, e.energy, e.force);
  for (const auto& [a, b] : symmetric_axes) {
    carry(bytes, e.stiffness(a, b));
    if constexpr (Bytes::reads) e.stiffness(b, a) = e.stiffness(a, b);
  }
  if (is_finger)
    carryRounded(bytes, e.drive, e.drive_stiffness, e.drive_slope, e.stiffness_by_p,
                 e.stiffness_by_s, e.drive_slope_by_p);
}

template <class Bytes, class Patch>
void carryFinger(Bytes& bytes, Patch& patch) {
  std::uint8_t is_there = patch.finger.has_value() ? 1 : 0;
  carry(bytes, is_there);
  if (is_there == 0) return;
  if constexpr (Bytes::reads) patch.finger.emplace();
  auto& finger = *patch.finger;
  carry(bytes, finger.center, finger.radius, finger.reach.outward, finger.reach.pull,
        finger.reach.width);
}

/// Visits the lattice of a space. Returns the number of its points.
template <class Bytes, class Space>
std::size_t carryLattice(Bytes& bytes, Space& space) {
  auto& lattice = space.lattice;
  double radius = lattice.radius(), spacing = lattice.spacing();
  std::int32_t divisions = lattice.divisions(), uniform = lattice.uniformSize();
  carry(bytes, radius, spacing, divisions);
  carryFinger(bytes, space.patch);
  const std::size_t size = bytes.size(at(lattice.size()));
  carry(bytes, uniform);
  if constexpr (Bytes::reads) {
    const PushedPart part = space.patch.finger ? space.patch.finger->reach : PushedPart{};
    lattice = Lattice(radius, spacing, divisions, part);
    PALPATE_ASSERT(lattice.size() == uniform,
                   "the page must make the same uniform lattice as palpate share, because the "
                   "records follow in its order");
  }
  for (std::int32_t n = uniform; at(n) < size; ++n) {
    LatticePoint point{};
    if constexpr (!Bytes::reads) point = lattice.point(n);
    carry(bytes, point);
    if constexpr (Bytes::reads) lattice.add(point);
  }
  return size;
}

template <class Bytes, class Record>
void carryPoint(Bytes& bytes, Record& point, bool is_finger) {
  carry(bytes, point.tag);
  if (isSolved(point.tag)) carryEquilibrium(bytes, point.equilibrium, is_finger);
}

template <class Bytes, class Space>
void carrySpace(Bytes& bytes, Space& space) {
  const std::size_t size = carryLattice(bytes, space);
  carryList(bytes, space.splits, [&](auto& cell) { carry(bytes, cell.lowest, cell.level); });
  if constexpr (Bytes::reads) space.points.resize(size);
  for (auto& point : space.points) carryPoint(bytes, point, space.patch.finger.has_value());
}

/// Carries the values that each(visit) visits, as integer multiples of a step. The largest
/// magnitude is `most_steps` steps.
template <class Step, class Bytes, class Each>
void carrySteps(Bytes& bytes, float most_steps, Each each) {
  float scale = 0;
  if constexpr (!Bytes::reads) each([&](float x) { scale = std::max(scale, std::abs(x)); });
  scale /= most_steps;
  carry(bytes, scale);
  each([&](auto& value) {
    Step step = 0;
    if constexpr (!Bytes::reads)
      step = static_cast<Step>(scale > 0 ? std::lround(value / scale) : 0);
    carry(bytes, step);
    if constexpr (Bytes::reads) value = scale * static_cast<float>(step);
  });
}

/// width: number of values of a mode, three per vertex.
template <class Bytes, class Shapes>
void carryShapes(Bytes& bytes, Shapes& shapes, std::size_t width,
                 const std::vector<SpaceTable>& spaces) {
  const std::size_t count = bytes.size(shapes.mode_count);
  if constexpr (Bytes::reads) {
    shapes.mode_count = count;
    shapes.modes.resize(count * width);
    for (const SpaceTable& space : spaces) shapes.shares.emplace_back(space.points.size() * count);
  }
  PALPATE_ASSERT(shapes.modes.size() == count * width && shapes.shares.size() == spaces.size(),
                 "each mode must have all vertices, and each space its weights");
  for (std::size_t mode = 0; mode < count; ++mode) {
    carrySteps<std::int16_t>(bytes, mode_steps, [&](auto visit) {
      for (std::size_t i = 0; i < width; ++i) visit(shapes.modes[mode * width + i]);
    });
    carrySteps<std::int8_t>(bytes, share_steps, [&](auto visit) {
      for (auto& of_space : shapes.shares)
        for (std::size_t i = mode; i < of_space.size(); i += count) visit(of_space[i]);
    });
  }
}

template <class Bytes, class Touch>
void carryTouch(Bytes& bytes, Touch& touch) {
  carryValues(bytes, touch.name);
  carryValues(bytes, touch.spaces);
  carry(bytes, touch.finger_radius, touch.rest);
  carryValues(bytes, touch.collocation_points);
}

template <class Bytes, class Organ>
void carryOrgan(Bytes& bytes, Organ& organ) {
  carryValues(bytes, organ.name);
  carry(bytes, organ.max_force, organ.has_fibers);
  carryValues(bytes, organ.vertices);
  const std::size_t triangles = bytes.size(organ.triangles.size());
  if constexpr (Bytes::reads) {
    organ.triangles.resize(triangles);
    organ.touch_of_triangle.resize(triangles);
  }
  PALPATE_ASSERT(organ.touch_of_triangle.size() == triangles,
                 "each triangle must have the number of its part or -1");
  for (std::size_t t = 0; t < triangles; ++t)
    carry(bytes, organ.triangles[t], organ.touch_of_triangle[t]);
  carryList(bytes, organ.touches, [&](auto& touch) { carryTouch(bytes, touch); });
  carryList(bytes, organ.spaces, [&](auto& space) { carrySpace(bytes, space); });
  carryShapes(bytes, organ.shapes, 3 * organ.vertices.size(), organ.spaces);
}

}  // namespace

std::string encode(const CarriedOrgan& organ) {
  OrganWriter out;
  carryOrgan(out, organ);
  return out.take();
}

CarriedOrgan decode(std::string_view bytes) {
  OrganReader in(bytes);
  CarriedOrgan organ;
  carryOrgan(in, organ);
  PALPATE_ASSERT(in.done(), "the functions that encoded an organ must read all of its bytes");
  for (SpaceTable& space : organ.spaces) {
    space.max_force = organ.max_force;
    space.has_fibers = organ.has_fibers;
  }
  return organ;
}

}  // namespace palpate
