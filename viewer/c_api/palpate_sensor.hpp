/// A force sensor for soft tissue, in the loop of a physics engine in C++17: pose in, force and
/// error bound out, in the frame and units of the engine. Header only, over palpate.h. The class
/// palpate.Sensor of the Python package does the same for many tools.
///
/// Units: a length is in the engine's unit, of `metres` metres. Forces and energies are in the
/// engine's units for masses in kg and times in s: N and J if metres is 1. Frames: the engine's
/// axes must be right-handed.
///
/// Errors: constructors and functions throw std::runtime_error or std::invalid_argument, with a
/// sentence. A tool whose position is not finite is no error; it feels nothing.
#ifndef PALPATE_SENSOR_HPP
#define PALPATE_SENSOR_HPP

#include <palpate.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace palpate {

using Vector = std::array<double, 3>;

inline double dot(const Vector& a, const Vector& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Vector sum(const Vector& a, const Vector& b, double factor = 1) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

/// Where a body is in the world: its origin, and its axes as unit vectors.
struct Pose {
  Vector position{0, 0, 0};
  std::array<Vector, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
};

/// What the tissue does after a time step.
struct Wrench {
  Vector force{};          // on the tool; the organ gets the opposite force
  Vector point{};          // where both act: the tip of the tool
  double error_bound = 0;  // of the force; NaN: unknown
  bool touching = false;
  bool inside = false;  // as in palpate_touch
  bool jumped = false;  // faster than 5 m/s: the contact ended, as for a reset
  double gap = 0;       // without contact: distance to the organ, negative inside
  double energy = 0;    // stored in the tissue
  double work = 0;      // done by the tool since the start; work - energy was lost to friction

  /// Returns the torque on the tool about a point.
  Vector torque(const Vector& about) const {
    return touching ? cross(sum(point, about, -1), force) : Vector{};
  }
};

/// One tool with a round tip that touches an organ. One thread at a time.
class Sensor {
 public:
  /// Opens a dataset. metres: per unit of length of the engine.
  explicit Sensor(const std::string& file, double metres = 1) : metres_(metres) {
    if (!(metres > 0 && std::isfinite(metres)))
      throw std::invalid_argument("metres must be the length of the engine's unit in metres");
    palpate_dataset* dataset = nullptr;
    need(palpate_dataset_open(file.c_str(), nullptr, &dataset));
    dataset_.reset(dataset);
    palpate_contact* contact = nullptr;
    need(palpate_contact_create(dataset, nullptr, &contact));
    contact_.reset(contact);
    auto info = PALPATE_INIT(palpate_dataset_info);
    need(palpate_dataset_describe(dataset, &info));
    vertices_.resize(static_cast<std::size_t>(info.vertex_count));
    triangles_.resize(static_cast<std::size_t>(info.triangle_count));
    need(palpate_dataset_vertices(dataset, vertices_.data()->data(), 3 * vertices_.size()));
    need(palpate_dataset_triangles(dataset, triangles_.data()->data(), 3 * triangles_.size()));
    double size = 0;
    for (int i = 0; i < 3; ++i) {
      const auto less = [i](const Vector& a, const Vector& b) { return a[i] < b[i]; };
      const auto ends = std::minmax_element(vertices_.begin(), vertices_.end(), less);
      size = std::max(size, (*ends.second)[i] - (*ends.first)[i]);
    }
    if (!(size >= 0.001 && size <= 5))
      throw std::invalid_argument(file + ": the organ is " + std::to_string(size) +
                                  " m long; build it again with the length_unit of its mesh");
  }

  /// Places the organ: the frame of its dataset in the world of the engine. Call it again whenever
  /// the engine moves the organ.
  void place(const Pose& organ) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (!(std::abs(dot(organ.axes[i], organ.axes[j]) - (i == j)) < 1e-3))
          throw std::invalid_argument("the organ's axes are not perpendicular unit vectors");
    if (dot(cross(organ.axes[0], organ.axes[1]), organ.axes[2]) < 0)
      throw std::invalid_argument("the organ's axes are left-handed; negate one of them");
    organ_ = organ;
  }

  /// Places the organ so that the rest position of an active node or site of a finger is `at`, and
  /// the surface there faces +z.
  void placeFacingUp(int32_t space, const Vector& at) {
    auto info = PALPATE_INIT(palpate_space_info);
    need(palpate_dataset_space(dataset_.get(), space, &info));
    Vector z{};
    for (const auto& t : triangles_)
      if (std::find(t.begin(), t.end(), info.vertex) != t.end())
        z = sum(z, cross(sum(vertices_[t[1]], vertices_[t[0]], -1),
                         sum(vertices_[t[2]], vertices_[t[0]], -1)));
    z = sum({}, z, 1 / std::sqrt(dot(z, z)));
    Vector x = cross(std::abs(z[1]) < 0.9 ? Vector{0, 1, 0} : Vector{0, 0, 1}, z);
    x = sum({}, x, 1 / std::sqrt(dot(x, x)));
    const Vector y = cross(z, x);
    Pose organ;
    for (int i = 0; i < 3; ++i) organ.axes[i] = {x[i], y[i], z[i]};
    const Vector rest = {info.rest_position[0], info.rest_position[1], info.rest_position[2]};
    organ.position = sum(at, {dot(x, rest), dot(y, rest), dot(z, rest)}, -1 / metres_);
    place(organ);
  }

  /// Moves the tip of the tool to `tip`, its position at the end of a time step of `dt` seconds,
  /// and returns what it feels there. The contact is updated at least every 1 ms and every 0.5 mm
  /// on a straight line from the last position.
  Wrench step(double dt, const Vector& tip) {
    if (!(dt > 0 && dt <= 0.1))
      throw std::invalid_argument("dt must be the time step in seconds, at most 0.1");
    const Vector from = sum(tip, organ_.position, -1);
    Vector here;
    for (int i = 0; i < 3; ++i) here[i] = metres_ * dot(organ_.axes[i], from);
    Vector way = sum(here, last_, -1);
    const double length = std::sqrt(dot(way, way));
    const bool jumped = length > 5 * dt;
    if (jumped) need(palpate_contact_release(contact_.get()));
    if (jumped || !std::isfinite(length)) way = {};
    const int strides = static_cast<int>(
        std::max(std::ceil(1000 * dt - 1e-6), std::ceil(std::sqrt(dot(way, way)) / 0.0005)));
    auto touch = PALPATE_INIT(palpate_touch);
    for (int stride = 1; stride <= strides; ++stride) {
      const Vector at = sum(here, way, double(stride) / strides - 1);
      need(palpate_contact_update(contact_.get(), at.data(), 1, &touch));
      const Vector force = {touch.force[0], touch.force[1], touch.force[2]};
      work_ -= dot(sum(force, force_), way) / (2 * strides);
      force_ = force;
    }
    last_ = here;

    Wrench felt;
    for (int i = 0; i < 3; ++i) felt.force = sum(felt.force, organ_.axes[i], force_[i] / metres_);
    felt.point = tip;
    felt.error_bound = touch.error_bound / metres_;
    felt.touching = touch.touching;
    felt.inside = touch.inside;
    felt.jumped = jumped;
    felt.gap = touch.gap / metres_;
    felt.energy = touch.energy / metres_ / metres_;
    felt.work = work_ / metres_ / metres_;
    return felt;
  }

 private:
  static void need(palpate_status status) {
    if (status != PALPATE_OK) throw std::runtime_error(palpate_last_error());
  }

  std::unique_ptr<palpate_dataset, void (*)(palpate_dataset*)> dataset_{nullptr,
                                                                        palpate_dataset_close};
  std::unique_ptr<palpate_contact, void (*)(palpate_contact*)> contact_{nullptr,
                                                                        palpate_contact_destroy};
  std::vector<Vector> vertices_;
  std::vector<std::array<int32_t, 3>> triangles_;
  double metres_, work_ = 0;
  Pose organ_;
  Vector last_{std::numeric_limits<double>::quiet_NaN(), 0, 0}, force_{};
};

}  // namespace palpate

#endif
