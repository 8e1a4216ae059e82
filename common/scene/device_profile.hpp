#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace palpate {

/// Limits of a haptic device, as in CHAI3D 3.3.0 (CPhantomDevices.cpp, CDeltaDevices.cpp).
struct DeviceProfile {
  std::string_view name;        ///< name in the scene file
  double max_force = 0;         ///< N
  double max_stiffness = 0;     ///< N/m, largest stiffness that the device renders stably
  double workspace_radius = 0;  ///< m
  bool operator==(const DeviceProfile&) const = default;
};

/// All known devices.
inline constexpr std::array<DeviceProfile, 10> device_profiles = {{{"touch", 3.3, 400, 0.075},
                                                                   {"omni", 3.3, 700, 0.1},
                                                                   {"desktop", 7.9, 1000, 0.1},
                                                                   {"premium-1.5", 8.5, 800, 0.12},
                                                                   {"premium-3.0", 22, 1000, 0.25},
                                                                   {"falcon", 8, 3000, 0.04},
                                                                   {"omega", 12, 5000, 0.075},
                                                                   {"sigma.7", 12, 4000, 0.075},
                                                                   {"lambda.7", 12, 8000, 0.1125},
                                                                   {"delta.3", 20, 5000, 0.15}}};

/// Names of device_profiles, in the same order.
inline constexpr auto device_words = [] {
  std::array<std::string_view, device_profiles.size()> names{};
  for (std::size_t i = 0; i < device_profiles.size(); ++i) names[i] = device_profiles[i].name;
  return names;
}();

/// Returns the profile of this name, or nullptr.
inline const DeviceProfile* deviceNamed(std::string_view name) {
  const auto* const found = std::ranges::find(device_profiles, name, &DeviceProfile::name);
  return found == device_profiles.end() ? nullptr : found;
}

}  // namespace palpate
