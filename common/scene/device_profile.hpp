#pragma once

#include <span>
#include <string_view>

namespace palpate {

/// What a haptic device can do, as CHAI3D 3.3.0 has it (CPhantomDevices.cpp, CDeltaDevices.cpp).
struct DeviceProfile {
  std::string_view name;        ///< word of the scene file
  double max_force = 0;         ///< N
  double max_stiffness = 0;     ///< N/m, of what the closed loop renders stably
  double workspace_radius = 0;  ///< m
  bool operator==(const DeviceProfile&) const = default;
};

/// All that are known: touch, omni, desktop, premium-1.5, premium-3.0, falcon, omega, sigma.7,
/// lambda.7, delta.3.
std::span<const DeviceProfile> deviceProfiles();
/// Their names, in the same order.
std::span<const std::string_view> deviceWords();

}  // namespace palpate
