#include "viewer/organ/carried_organ.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

// The first line of the bytes is organ_mark followed by organ_version.
constexpr std::string_view organ_mark = "palpate-organ-";
constexpr std::string_view organ_version = "3";
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

// Largest Lattice::divisions that is accepted: more than the lattice of any page has, but small
// enough that products of lattice coordinates do not overflow.
constexpr std::int32_t most_divisions = 4096;
/// Smallest accepted share of the workspace ball that pushing reaches (PushedPart). Usually it is
/// about half.
constexpr double least_share_of_ball = 1.0 / 64;
/// Least width of the pushed part (PushedPart::width) that checkLattice() assumes, as a share of
/// the radius. With a smaller width, few bytes could make the reader allocate a very large lattice.
constexpr double least_narrow = 1.0 / 8;

Error damaged(std::string_view how) {
  return failure(
      "the organ is damaged ({}): download its page again, or make it again with palpate share",
      how);
}

// The functions `carry...` describe the format once, for both directions: they visit all numbers of
// an organ. With an OrganWriter they append each number to the bytes; with an OrganReader they read
// it from the bytes. The reader checks numbers that could make it allocate too much memory.

class OrganWriter {
 public:
  static constexpr bool reads = false;
  void raw(const void* from, std::size_t size) {
    bytes_.append(static_cast<const char*>(from), size);
  }
  /// Writes and returns the length of a list.
  std::size_t size(std::size_t length, std::size_t = 1) {
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
    if (size > bytes_.size()) throw damaged("truncated data");
    std::memcpy(to, bytes_.data(), size);
    bytes_.remove_prefix(size);
  }
  /// Reads the length of a list. Error if too few bytes follow for a list of this length. least:
  /// smallest number of bytes of an element.
  std::size_t size(std::size_t, std::size_t least = 1) {
    std::uint32_t length = 0;
    raw(&length, sizeof length);
    if (length > bytes_.size() / least) throw damaged("truncated data");
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

/// Visits a list. least: smallest number of bytes of an element.
template <class Bytes, class List, class Each>
void carryList(Bytes& bytes, List& list, std::size_t least, Each each) {
  const std::size_t size = bytes.size(list.size(), least);
  if constexpr (Bytes::reads) list.resize(size);
  for (auto& one : list) each(one);
}

template <class Bytes, class List>
void carryValues(Bytes& bytes, List& list) {
  carryList(bytes, list, sizeof list[0], [&](auto& value) { carry(bytes, value); });
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
  const double length = finger.reach.outward.norm();
  if (Bytes::reads && !((finger.center.array().abs() <= farthest_node).all() &&
                        (length == 0 || std::abs(length - 1) < 1e-12) &&
                        std::abs(finger.reach.pull) <= 1 && finger.reach.width > 0))
    throw damaged("invalid finger");
}

/// Checks a lattice before its points are made. A lattice with many points is accepted only if the
/// bytes contain many points.
void checkLattice(double radius, double spacing, std::int32_t divisions, std::size_t points,
                  const PushedPart& part) {
  const double ratio = radius / spacing, in_ball = 4.0 / 3.0 * M_PI * ratio * ratio * ratio;
  const bool is_power_of_two = divisions > 0 && (divisions & (divisions - 1)) == 0;
  // The condition is negated, so that NaN is refused.
  if (!(spacing > 0 && radius >= spacing && radius <= farthest_node && is_power_of_two &&
        divisions <= most_divisions))
    throw damaged("invalid lattice");
  const double narrow = std::clamp(part.width / radius, least_narrow, 1.0);
  if (in_ball * least_share_of_ball * narrow * narrow > static_cast<double>(points))
    throw damaged(fmt::format("a lattice has {1} points instead of {0:.0f}", in_ball, points));
}

void checkAdded(const LatticePoint& point, const Lattice& lattice) {
  const auto farthest = static_cast<std::int32_t>(2 + lattice.radius() / lattice.spacing());
  for (const std::int32_t x : point)
    if (x < -farthest * lattice.divisions() || x > farthest * lattice.divisions())
      throw damaged("a lattice point far outside its ball");
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
    checkLattice(radius, spacing, divisions, size, part);
    lattice = Lattice(radius, spacing, divisions, part);
    if (lattice.size() != uniform || at(uniform) > size)
      throw damaged(
          fmt::format("a lattice has {} uniform points instead of {}", uniform, lattice.size()));
  }
  for (std::int32_t n = uniform; at(n) < size; ++n) {
    LatticePoint point{};
    if constexpr (!Bytes::reads) point = lattice.point(n);
    carry(bytes, point);
    if constexpr (Bytes::reads) {
      checkAdded(point, lattice);
      lattice.add(point);
    }
  }
  return size;
}

template <class Bytes, class Record>
void carryPoint(Bytes& bytes, Record& point, bool is_finger) {
  auto tag = static_cast<std::uint8_t>(point.tag);
  carry(bytes, tag);
  if constexpr (Bytes::reads) {
    const auto known = tagOf(tag);
    if (!known) throw damaged("a point with an unknown tag");
    point.tag = *known;
  }
  if (isSolved(point.tag)) carryEquilibrium(bytes, point.equilibrium, is_finger);
}

template <class Bytes, class Space>
void carrySpace(Bytes& bytes, Space& space) {
  const std::size_t size = carryLattice(bytes, space);
  carryList(bytes, space.splits, sizeof(LatticeCell),
            [&](auto& cell) { carry(bytes, cell.lowest, cell.level); });
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
  std::size_t bytes_of_mode = 2 * sizeof(float) + 2 * width;
  for (const SpaceTable& space : spaces) bytes_of_mode += space.points.size();
  const std::size_t count = bytes.size(shapes.mode_count, bytes_of_mode);
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
  constexpr std::size_t least_touch = 44, least_space = 33;  // bytes of an empty touch or space
  carryValues(bytes, organ.name);
  carry(bytes, organ.max_force);
  carryValues(bytes, organ.vertices);
  const std::size_t triangles =
      bytes.size(organ.triangles.size(), sizeof(Triangle) + sizeof(std::int32_t));
  if constexpr (Bytes::reads) {
    organ.triangles.resize(triangles);
    organ.touch_of_triangle.resize(triangles);
  }
  PALPATE_ASSERT(organ.touch_of_triangle.size() == triangles,
                 "each triangle must have the number of its part or -1");
  for (std::size_t t = 0; t < triangles; ++t)
    carry(bytes, organ.triangles[t], organ.touch_of_triangle[t]);
  carryList(bytes, organ.touches, least_touch, [&](auto& touch) { carryTouch(bytes, touch); });
  carryList(bytes, organ.spaces, least_space, [&](auto& space) { carrySpace(bytes, space); });
  carryShapes(bytes, organ.shapes, 3 * organ.vertices.size(), organ.spaces);
}

/// Returns a reader of the bytes after the first line.
OrganReader behindVersion(std::string_view bytes) {
  constexpr std::size_t longest = 10;  // avoids quoting bytes that are not an organ
  if (!bytes.starts_with(organ_mark))
    throw failure("no organ found: download its page again, or make it again with {}",
                  "palpate share");
  bytes.remove_prefix(organ_mark.size());
  const std::size_t end = bytes.find('\n');
  if (end > longest) throw damaged("no version");
  const std::string_view version = bytes.substr(0, end);
  if (version != organ_version)
    throw failure(
        "this organ has version {}, but this program reads version {}: make its page again with "
        "palpate share",
        version, organ_version);
  return OrganReader(bytes.substr(end + 1));
}

bool isPlace(const Eigen::Vector3d& v) { return (v.array().abs() <= farthest_node).all(); }
bool isNumberOf(std::int32_t n, std::size_t count) { return n >= 0 && at(n) < count; }
/// False for NaN.
bool isLength(double metres) { return metres > 0 && metres <= farthest_node; }

std::string faultOfSurface(const CarriedOrgan& organ) {
  if (organ.vertices.empty() || organ.vertices.size() > most_carried_vertices)
    return fmt::format("invalid number of vertices: {}", organ.vertices.size());
  for (std::size_t v = 0; v < organ.vertices.size(); ++v)
    if (!isPlace(organ.vertices[v])) return fmt::format("vertex {} has no valid position", v);
  if (organ.triangles.empty() || organ.touch_of_triangle.size() != organ.triangles.size())
    return fmt::format("invalid number of triangles: {}", organ.triangles.size());
  for (std::size_t t = 0; t < organ.triangles.size(); ++t) {
    const auto& [a, b, c] = organ.triangles[t];
    for (const std::int32_t corner : {a, b, c})
      if (!isNumberOf(corner, organ.vertices.size()))
        return fmt::format("triangle {} has an invalid corner {}", t, corner);
    if (a == b || b == c || c == a) return fmt::format("triangle {} has the same corner twice", t);
    const std::int32_t touch = organ.touch_of_triangle[t];
    if (touch != -1 && !isNumberOf(touch, organ.touches.size()))
      return fmt::format("triangle {} belongs to invalid part {}", t, touch);
  }
  return {};
}

std::string faultOfArea(const CarriedTouch& touch, const std::vector<SpaceTable>& spaces) {
  if (!isLength(touch.finger_radius)) return "invalid radius of the finger";
  if (touch.collocation_points.empty()) return "no collocation points";
  for (const Eigen::Vector3d& collocation_point : touch.collocation_points)
    if (!isPlace(collocation_point)) return "a collocation point has no valid position";
  const Lattice& first = spaces[at(touch.spaces.front())].lattice;
  for (const std::int32_t space : touch.spaces) {
    const auto& finger = spaces[at(space)].patch.finger;
    if (!finger || finger->radius != touch.finger_radius)
      return fmt::format("space {} belongs to another finger", space);
    const Lattice& lattice = spaces[at(space)].lattice;
    if (lattice.radius() != first.radius() || lattice.spacing() != first.spacing() ||
        lattice.divisions() != first.divisions())
      return fmt::format("the lattice of space {} differs from the others", space);
  }
  return {};
}

std::string faultOfTouch(const CarriedTouch& touch, const std::vector<SpaceTable>& spaces) {
  if (touch.spaces.empty()) return "no spaces";
  for (const std::int32_t space : touch.spaces)
    if (!isNumberOf(space, spaces.size())) return fmt::format("invalid space {}", space);
  if (!isPlace(touch.rest)) return "no valid rest position";
  return touch.finger_radius == 0 ? "" : faultOfArea(touch, spaces);
}

std::string faultOfPoints(const SpaceTable& space) {
  const std::vector<PointRecord>& points = space.points;
  for (std::size_t n = 0; n < points.size(); ++n)
    if (isSolved(points[n].tag) && !isUsable(points[n].equilibrium))
      return fmt::format("point {} has a number that is not finite or exceeds {:g}", n,
                         largest_stored);
  return faultOf(space);
}

/// Returns the fault of these shapes; empty if there is none. Factors of modes
/// (CarriedShapes::shares) above a million radii of the workspace are a fault. Real factors are
/// smaller, because modes are orthonormal and displacements are about as large as that of the tool.
/// With such large factors, interpolated shapes would be nothing but rounding errors.
std::string faultOfShapes(const CarriedShapes& shapes, const std::vector<SpaceTable>& spaces) {
  // False for NaN.
  const auto areWithin = [](const std::vector<float>& values, double most) {
    return std::ranges::all_of(values, [most](float x) { return std::abs(x) <= most; });
  };
  if (shapes.mode_count == 0 || shapes.mode_count % 3 != 0)
    return fmt::format("its number of modes is {}, not a positive multiple of three",
                       shapes.mode_count);
  if (!areWithin(shapes.modes, 1.001)) return "a mode has an entry that is not between -1 and 1";
  for (std::size_t n = 0; n < spaces.size(); ++n)
    if (!areWithin(shapes.shares[n], 1e6 * spaces[n].lattice.radius()))
      return fmt::format("space {} has a shape that is not finite or far too large", n);
  return {};
}

}  // namespace

std::string faultOf(const CarriedOrgan& organ) {
  if (!(organ.max_force > 0 && organ.max_force <= largest_stored))
    return fmt::format("invalid force limit of {} N", organ.max_force);
  if (std::string fault = faultOfSurface(organ); !fault.empty()) return fault;
  for (std::size_t n = 0; n < organ.touches.size(); ++n)
    if (const std::string fault = faultOfTouch(organ.touches[n], organ.spaces); !fault.empty())
      return fmt::format("touchable part {}: {}", n, fault);
  for (std::size_t n = 0; n < organ.spaces.size(); ++n)
    if (const std::string fault = faultOfPoints(organ.spaces[n]); !fault.empty())
      return fmt::format("space {}: {}", n, fault);
  return faultOfShapes(organ.shapes, organ.spaces);
}

std::string encode(const CarriedOrgan& organ) {
  OrganWriter out;
  const std::string first_line = fmt::format("{}{}\n", organ_mark, organ_version);
  out.raw(first_line.data(), first_line.size());
  carryOrgan(out, organ);
  return out.take();
}

CarriedOrgan decode(std::string_view bytes) {
  OrganReader in = behindVersion(bytes);
  CarriedOrgan organ;
  carryOrgan(in, organ);
  for (SpaceTable& space : organ.spaces) space.max_force = organ.max_force;
  if (!in.done()) throw damaged("extra bytes at its end");
  if (const std::string fault = faultOf(organ); !fault.empty()) throw damaged(fault);
  return organ;
}

}  // namespace palpate
