#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/touchable_body.hpp"
#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate::test {

/// A device whose readings are a function of the tick, counted from 1. It keeps the forces that it
/// receives, up to the reserved number.
class ScriptedHand : public HapticDevice {
 public:
  using Script = std::function<DeviceReading(std::uint64_t tick)>;
  explicit ScriptedHand(Script script, bool in_scene = true, std::size_t most_forces = 100000)
      : script_(std::move(script)), in_scene_(in_scene) {
    forces.reserve(most_forces);
  }
  DeviceReading read() noexcept override { return script_(++reads); }
  void write(const Eigen::Vector3d& force) noexcept override {
    last_force = force;
    if (forces.size() < forces.capacity()) forces.push_back(force);
  }
  void halt() noexcept override { ++halts; }
  void resume() noexcept override { ++resumes; }
  DeviceProfile profile() const override { return limits; }
  bool livesInScene() const override { return in_scene_; }
  std::string name() const override { return "scripted hand"; }

  DeviceProfile limits = {"omega", 12, 5000, 0.075};
  std::vector<Eigen::Vector3d> forces;
  Eigen::Vector3d last_force = Eigen::Vector3d::Constant(-1);
  std::uint64_t reads = 0;
  std::atomic<int> halts = 0, resumes = 0;

 private:
  Script script_;
  bool in_scene_;
};

inline DeviceReading fresh(const Eigen::Vector3d& position) {
  return {position, 0, DeviceStatus::fresh};
}

/// Once a second: approaches from 4 mm above the middle of the top of TouchedCube, presses 8 mm
/// deep, slides in a circle of 15 mm and leaves.
inline Eigen::Vector3d pressAndSlide(double time) {
  const double turn = 2 * std::numbers::pi;
  return {0.05 + 0.015 * std::cos(0.7 * turn * time), 0.05 + 0.015 * std::sin(0.7 * turn * time),
          0.104 - 0.006 * (1 - std::cos(turn * time))};
}
inline ScriptedHand::Script pressingAndSliding(double period = 1e-3) {
  return [period](std::uint64_t tick) {
    return fresh(pressAndSlide(period * static_cast<double>(tick)));
  };
}

/// A cube of 100 mm with a fixed bottom, touchable around the middle of its top, where nine nodes
/// are active; it is stiffer on one side.
class TouchedCube {
 public:
  TouchedCube() : dataset_(sealed(directory_ / "cube.h5")), model_(dataset_) {}
  const Dataset& dataset() const { return dataset_; }
  const HapticModel& model() const { return model_; }

 private:
  static Dataset sealed(const std::filesystem::path& file) {
    const Mesh cube = cubeMesh(0.1, 4);
    std::vector<TouchableBody::Active> active;
    for (const TouchableBody::Active& node :
         wholeSurface(cube, [](const Eigen::Vector3d& x) { return 1 + 5 * x.x(); }))
      if ((cube.nodes[static_cast<std::size_t>(node.node)] - Eigen::Vector3d(0.05, 0.05, 0.1))
              .norm() < 0.04)
        active.push_back(node);
    TouchableBody(cube, active).seal(file);
    return Dataset(file);
  }
  TemporaryDirectory directory_;
  Dataset dataset_;
  HapticModel model_;
};

}  // namespace palpate::test
