#include "viewer/organ/carried_organ.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "common/base/error.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

// Together the first line.
constexpr std::string_view organ_mark = "palpate-organ-";
constexpr std::string_view organ_version = "3";
/// Of shares: this many steps on each side of zero for the largest of a mode. A vertex is off by
/// some tenth of a millimetre then.
constexpr float share_steps = 127;
constexpr float mode_steps = 32767;

/// Of a double that is rounded: 37 bits of it stay significant. In single precision, which is what
/// fields make of these numbers in the end, forces were up to 1.7e-6 N off where an organ is stiff.
constexpr std::size_t left_out_bytes = 2;
static_assert(std::endian::native == std::endian::little, "the least significant bytes are first");

// More than any page has, and far enough from where products of numbers of a lattice overflow.
constexpr std::int32_t most_divisions = 4096;
/// What a finger reaches by pushing is about half of its ball, and no smaller share.
constexpr double least_share_of_ball = 1.0 / 64;
/// Of the radius: a narrower part counts as this wide, so that few bytes never make a large ball.
constexpr double least_narrow = 1.0 / 8;

Error damaged(std::string_view how) {
  return failure(
      "the organ is damaged ({}): get its page again, or make it again with palpate share", how);
}

class OrganWriter {
 public:
  template <class Number>
  void put(const Number& number) {
    static_assert(std::is_trivially_copyable_v<Number>);
    bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  void putSize(std::size_t size) { put(static_cast<std::uint32_t>(size)); }
  void putText(std::string_view text) {
    putSize(text.size());
    bytes_ += text;
  }
  void putVector(const Eigen::Vector3d& v) {
    for (const double x : v) put(x);
  }
  template <class Values>
  void putRounded(const Eigen::DenseBase<Values>& values) {
    constexpr std::uint64_t half = std::uint64_t{1} << (8 * left_out_bytes - 1);
    for (Eigen::Index i = 0; i < values.rows(); ++i)
      for (Eigen::Index j = 0; j < values.cols(); ++j) {
        const double value = values(i, j);
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        bits += half;
        bytes_.append(reinterpret_cast<const char*>(&bits) + left_out_bytes,
                      sizeof bits - left_out_bytes);
      }
  }
  std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

class OrganReader {
 public:
  explicit OrganReader(std::string_view bytes) : bytes_(bytes) {}
  template <class Number>
  Number get() {
    Number number;
    std::memcpy(&number, take(sizeof number).data(), sizeof number);
    return number;
  }
  bool done() const { return bytes_.empty(); }
  /// Of things that take at least so many bytes each.
  std::size_t getSize(std::size_t least = 1) {
    const auto size = get<std::uint32_t>();
    if (size > bytes_.size() / least) throw damaged("it is cut off");
    return size;
  }
  std::string getText() { return std::string(take(getSize())); }
  Eigen::Vector3d getVector() {
    const double x = get<double>(), y = get<double>(), z = get<double>();
    return {x, y, z};
  }
  template <class Values>
  void getRounded(Values& values) {
    constexpr std::size_t kept = sizeof(double) - left_out_bytes;
    for (Eigen::Index i = 0; i < values.rows(); ++i)
      for (Eigen::Index j = 0; j < values.cols(); ++j) {
        std::array<char, sizeof(double)> bytes{};
        std::memcpy(bytes.data() + left_out_bytes, take(kept).data(), kept);
        std::memcpy(&values(i, j), bytes.data(), sizeof(double));
      }
  }
  std::string_view take(std::size_t count) {
    if (count > bytes_.size()) throw damaged("it is cut off");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }

 private:
  std::string_view bytes_;
};

/// What only a finger has of an equilibrium, one after the other.
template <class OfFinger, class Each>
void eachOfFinger(OfFinger& e, Each each) {
  each(e.drive);
  each(e.drive_stiffness);
  each(e.drive_slope);
  each(e.stiffness_by_p);
  each(e.stiffness_by_s);
  each(e.drive_slope_by_p);
}

void putEquilibrium(OrganWriter& out, const Equilibrium& e, bool is_finger) {
  out.put(e.energy);
  out.putVector(e.force);
  for (const auto& [a, b] : symmetric_axes) out.put(e.stiffness(a, b));
  if (is_finger) eachOfFinger(e, [&out](const auto& values) { out.putRounded(values); });
}

Equilibrium getEquilibrium(OrganReader& in, bool is_finger) {
  Equilibrium e;
  e.energy = in.get<double>();
  e.force = in.getVector();
  for (const auto& [a, b] : symmetric_axes)
    e.stiffness(a, b) = e.stiffness(b, a) = in.get<double>();
  if (is_finger) eachOfFinger(e, [&in](auto& values) { in.getRounded(values); });
  return e;
}

void putSpace(OrganWriter& out, const SpaceTable& space) {
  const Lattice& lattice = space.lattice;
  out.put(lattice.radius());
  out.put(lattice.spacing());
  out.put(lattice.divisions());
  const auto& finger = space.patch.finger;
  out.put(static_cast<std::uint8_t>(finger.has_value()));
  if (finger) {
    out.putVector(finger->center);
    out.put(finger->radius);
    out.putVector(finger->reach.outward);
    out.put(finger->reach.pull);
    out.put(finger->reach.width);
  }
  out.putSize(at(lattice.size()));
  out.put(lattice.uniformSize());
  for (std::int32_t n = lattice.uniformSize(); n < lattice.size(); ++n) out.put(lattice.point(n));
  out.putSize(space.splits.size());
  for (const LatticeCell& cell : space.splits) {
    out.put(cell.lowest);
    out.put(cell.level);
  }
  for (const PointRecord& point : space.points) {
    out.put(static_cast<std::uint8_t>(point.tag));
    if (isSolved(point.tag)) putEquilibrium(out, point.equilibrium, finger.has_value());
  }
}

Finger getFinger(OrganReader& in) {
  Finger finger;
  finger.center = in.getVector();
  finger.radius = in.get<double>();
  finger.reach.outward = in.getVector();
  finger.reach.pull = in.get<double>();
  finger.reach.width = in.get<double>();
  const double length = finger.reach.outward.norm();
  if (!((finger.center.array().abs() <= farthest_node).all() &&
        (length == 0 || std::abs(length - 1) < 1e-12) && std::abs(finger.reach.pull) <= 1 &&
        finger.reach.width > 0))
    throw damaged("a finger is none");
  return finger;
}

/// Before its points are made: bytes that claim many must have them.
void checkLattice(double radius, double spacing, std::int32_t divisions, std::size_t points,
                  const PushedPart& part) {
  const double ratio = radius / spacing, in_ball = 4.0 / 3.0 * M_PI * ratio * ratio * ratio;
  const bool is_power_of_two = divisions > 0 && (divisions & (divisions - 1)) == 0;
  // Negated, so that NaN is refused.
  if (!(spacing > 0 && radius >= spacing && radius <= farthest_node && is_power_of_two &&
        divisions <= most_divisions))
    throw damaged("a lattice is none");
  const double narrow = std::clamp(part.width / radius, least_narrow, 1.0);
  if (in_ball * least_share_of_ball * narrow * narrow > static_cast<double>(points))
    throw damaged(fmt::format("a lattice of about {:.0f} points has {}", in_ball, points));
}

LatticePoint getAddedPoint(OrganReader& in, const Lattice& lattice) {
  const auto point = in.get<LatticePoint>();
  const auto farthest = static_cast<std::int32_t>(2 + lattice.radius() / lattice.spacing());
  for (const std::int32_t x : point)
    if (x < -farthest * lattice.divisions() || x > farthest * lattice.divisions())
      throw damaged("a point lies far outside of its ball");
  return point;
}

PointRecord getPoint(OrganReader& in, bool is_finger) {
  const auto tag = tagOf(in.get<std::uint8_t>());
  if (!tag) throw damaged("a point has no known tag");
  PointRecord point;
  point.tag = *tag;
  if (isSolved(*tag)) point.equilibrium = getEquilibrium(in, is_finger);
  return point;
}

SpaceTable getSpace(OrganReader& in) {
  SpaceTable space;
  const auto radius = in.get<double>(), spacing = in.get<double>();
  const auto divisions = in.get<std::int32_t>();
  if (in.get<std::uint8_t>() != 0) space.patch.finger = getFinger(in);
  const std::size_t size = in.getSize();
  const auto uniform = in.get<std::int32_t>();
  const PushedPart part = space.patch.finger ? space.patch.finger->reach : PushedPart{};
  checkLattice(radius, spacing, divisions, size, part);
  space.lattice = Lattice(radius, spacing, divisions, part);
  if (space.lattice.size() != uniform || at(uniform) > size)
    throw damaged(fmt::format("a lattice has {} uniform points where {} are made", uniform,
                              space.lattice.size()));
  while (at(space.lattice.size()) < size) space.lattice.add(getAddedPoint(in, space.lattice));
  space.splits.resize(in.getSize(sizeof(LatticeCell)));
  for (LatticeCell& cell : space.splits) {
    cell.lowest = in.get<LatticePoint>();
    cell.level = in.get<std::int32_t>();
  }
  for (std::size_t n = 0; n < size; ++n)
    space.points.push_back(getPoint(in, space.patch.finger.has_value()));
  return space;
}

/// Rounded to steps of the largest magnitude: `scale` is one step.
template <class Step>
void putSteps(OrganWriter& out, float value, float scale) {
  out.put(static_cast<Step>(scale > 0 ? std::lround(value / scale) : 0));
}

void putShapes(OrganWriter& out, const CarriedShapes& shapes) {
  out.putSize(shapes.mode_count);
  const std::size_t width = shapes.mode_count > 0 ? shapes.modes.size() / shapes.mode_count : 0;
  for (std::size_t mode = 0; mode < shapes.mode_count; ++mode) {
    float largest = 0, largest_share = 0;
    for (std::size_t i = 0; i < width; ++i)
      largest = std::max(largest, std::abs(shapes.modes[mode * width + i]));
    for (const std::vector<float>& of_space : shapes.shares)
      for (std::size_t i = mode; i < of_space.size(); i += shapes.mode_count)
        largest_share = std::max(largest_share, std::abs(of_space[i]));
    out.put(largest / mode_steps);
    for (std::size_t i = 0; i < width; ++i)
      putSteps<std::int16_t>(out, shapes.modes[mode * width + i], largest / mode_steps);
    const float step = largest_share / share_steps;
    out.put(step);
    for (const std::vector<float>& of_space : shapes.shares)
      for (std::size_t i = mode; i < of_space.size(); i += shapes.mode_count)
        putSteps<std::int8_t>(out, of_space[i], step);
  }
}

CarriedShapes getShapes(OrganReader& in, std::size_t width, const std::vector<SpaceTable>& spaces) {
  CarriedShapes shapes;
  std::size_t bytes_of_mode = 2 * sizeof(float) + 2 * width;
  for (const SpaceTable& space : spaces) bytes_of_mode += space.points.size();
  shapes.mode_count = in.getSize(bytes_of_mode);
  for (const SpaceTable& space : spaces)
    shapes.shares.emplace_back(space.points.size() * shapes.mode_count);
  for (std::size_t mode = 0; mode < shapes.mode_count; ++mode) {
    const auto mode_step = in.get<float>();
    for (std::size_t i = 0; i < width; ++i)
      shapes.modes.push_back(mode_step * static_cast<float>(in.get<std::int16_t>()));
    const auto step = in.get<float>();
    for (std::vector<float>& of_space : shapes.shares)
      for (std::size_t i = mode; i < of_space.size(); i += shapes.mode_count)
        of_space[i] = step * static_cast<float>(in.get<std::int8_t>());
  }
  return shapes;
}

void putTouch(OrganWriter& out, const CarriedTouch& touch) {
  out.putText(touch.name);
  out.putSize(touch.spaces.size());
  for (const std::int32_t space : touch.spaces) out.put(space);
  out.put(touch.finger_radius);
  out.putVector(touch.rest);
  out.putSize(touch.stations.size());
  for (const Eigen::Vector3d& station : touch.stations) out.putVector(station);
}

CarriedTouch getTouch(OrganReader& in) {
  CarriedTouch touch;
  touch.name = in.getText();
  touch.spaces.resize(in.getSize(sizeof(std::int32_t)));
  for (std::int32_t& space : touch.spaces) space = in.get<std::int32_t>();
  touch.finger_radius = in.get<double>();
  touch.rest = in.getVector();
  touch.stations.resize(in.getSize(sizeof(Eigen::Vector3d)));
  for (Eigen::Vector3d& station : touch.stations) station = in.getVector();
  return touch;
}

/// What follows the first line.
OrganReader behindVersion(std::string_view bytes) {
  constexpr std::size_t longest = 10;  // so that what is no organ is not quoted
  if (!bytes.starts_with(organ_mark))
    throw failure("there is no organ here: get its page again, or make it again with {}",
                  "palpate share");
  bytes.remove_prefix(organ_mark.size());
  const std::size_t end = bytes.find('\n');
  if (end > longest) throw damaged("it has no version");
  const std::string_view version = bytes.substr(0, end);
  if (version != organ_version)
    throw failure(
        "this organ is of version {}, and what reads it of version {}: make its page again with "
        "palpate share",
        version, organ_version);
  return OrganReader(bytes.substr(end + 1));
}

}  // namespace

std::string encode(const CarriedOrgan& organ) {
  OrganWriter out;
  for (const char c : fmt::format("{}{}\n", organ_mark, organ_version)) out.put(c);
  out.putText(organ.name);
  out.put(organ.max_force);
  out.putSize(organ.vertices.size());
  for (const Eigen::Vector3d& vertex : organ.vertices) out.putVector(vertex);
  out.putSize(organ.triangles.size());
  for (std::size_t t = 0; t < organ.triangles.size(); ++t) {
    out.put(organ.triangles[t]);
    out.put(organ.touch_of_triangle[t]);
  }
  out.putSize(organ.touches.size());
  for (const CarriedTouch& touch : organ.touches) putTouch(out, touch);
  out.putSize(organ.spaces.size());
  for (const SpaceTable& space : organ.spaces) putSpace(out, space);
  putShapes(out, organ.shapes);
  return out.take();
}

CarriedOrgan decode(std::string_view bytes) {
  OrganReader in = behindVersion(bytes);
  CarriedOrgan organ;
  organ.name = in.getText();
  organ.max_force = in.get<double>();
  organ.vertices.resize(in.getSize(sizeof(Eigen::Vector3d)));
  for (Eigen::Vector3d& vertex : organ.vertices) vertex = in.getVector();
  organ.triangles.resize(in.getSize(sizeof(Triangle)));
  for (Triangle& triangle : organ.triangles) {
    triangle = in.get<Triangle>();
    organ.touch_of_triangle.push_back(in.get<std::int32_t>());
  }
  const std::size_t touches = in.getSize();
  for (std::size_t n = 0; n < touches; ++n) organ.touches.push_back(getTouch(in));
  const std::size_t spaces = in.getSize();
  for (std::size_t n = 0; n < spaces; ++n) organ.spaces.push_back(getSpace(in));
  for (SpaceTable& space : organ.spaces) space.max_force = organ.max_force;
  organ.shapes = getShapes(in, 3 * organ.vertices.size(), organ.spaces);
  if (!in.done()) throw damaged("something follows it");
  if (const std::string fault = faultOf(organ); !fault.empty()) throw damaged(fault);
  return organ;
}

}  // namespace palpate
