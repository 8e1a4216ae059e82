#include "common/scene/device_profile.hpp"

#include <array>

namespace palpate {
namespace {

constexpr std::array<DeviceProfile, 10> profiles = {{{"touch", 3.3, 400, 0.075},
                                                     {"omni", 3.3, 700, 0.1},
                                                     {"desktop", 7.9, 1000, 0.1},
                                                     {"premium-1.5", 8.5, 800, 0.12},
                                                     {"premium-3.0", 22, 1000, 0.25},
                                                     {"falcon", 8, 3000, 0.04},
                                                     {"omega", 12, 5000, 0.075},
                                                     {"sigma.7", 12, 4000, 0.075},
                                                     {"lambda.7", 12, 8000, 0.1125},
                                                     {"delta.3", 20, 5000, 0.15}}};

constexpr auto words = [] {
  std::array<std::string_view, profiles.size()> names{};
  for (std::size_t i = 0; i < profiles.size(); ++i) names[i] = profiles[i].name;
  return names;
}();

}  // namespace

std::span<const DeviceProfile> deviceProfiles() { return profiles; }

std::span<const std::string_view> deviceWords() { return words; }

}  // namespace palpate
