#include <array>
#include <cmath>

#include "common/scene/device_profile.hpp"
#include "viewer/c_api/arguments.hpp"
#include "viewer/c_api/touch_struct.hpp"
#include "viewer/haptics/force_guard.hpp"

using namespace palpate;

struct palpate_guard {
  ForceGuard guard;
};

static_assert(guard_count == 9 &&
              PALPATE_GUARD_RAMPED == static_cast<std::uint32_t>(Guarded::ramped) &&
              PALPATE_GUARD_DAMPED == static_cast<std::uint32_t>(Guarded::damped) &&
              PALPATE_GUARD_CLAMPED == static_cast<std::uint32_t>(Guarded::clamped) &&
              PALPATE_GUARD_SLEWED == static_cast<std::uint32_t>(Guarded::slewed) &&
              PALPATE_GUARD_STALLED == static_cast<std::uint32_t>(Guarded::stalled) &&
              PALPATE_GUARD_LOST == static_cast<std::uint32_t>(Guarded::lost) &&
              PALPATE_GUARD_NOT_FINITE == static_cast<std::uint32_t>(Guarded::not_finite) &&
              PALPATE_GUARD_LATE == static_cast<std::uint32_t>(Guarded::late) &&
              PALPATE_GUARD_BEYOND == static_cast<std::uint32_t>(Guarded::beyond));

namespace {

constexpr std::uint32_t known_flags =
    PALPATE_READING_FRESH | PALPATE_READING_LOST | PALPATE_LOOP_LATE;

const DeviceProfile& profileNamed(std::string_view name) {
  const DeviceProfile* const found = deviceNamed(name);
  if (found == nullptr)
    refuse("unknown device \"{}\"; known: {}", name, fmt::join(device_words, ", "));
  return *found;
}

/// Largest delay that ForceGuard accepts, periods.
constexpr std::uint32_t most_delay = EnergyLimit::remembered - 2;

using Options = palpate_guard_options;
constexpr std::array<OptionNumber<Options, GuardOptions>, 8> limits = {
    {{"options->period", Least::above_zero, &Options::period, &GuardOptions::period},
     {"options->max_force", Least::above_zero, &Options::max_force, &GuardOptions::max_force},
     {"options->max_slew", Least::zero, &Options::max_slew, &GuardOptions::max_slew},
     {"options->ramp", Least::above_zero, &Options::ramp, &GuardOptions::ramp},
     {"options->stall", Least::above_zero, &Options::stall, &GuardOptions::stall},
     {"options->max_stiffness", Least::above_zero, &Options::max_stiffness,
      &GuardOptions::max_stiffness},
     {"options->energy_credit", Least::zero, &Options::energy_credit, &GuardOptions::energy_credit},
     {"options->delay", Least::zero, &Options::delay, &GuardOptions::delay}}};

Options toStruct(const GuardOptions& options) noexcept {
  Options given{};
  given.size = sizeof given;
  fillIn(given, options, limits);
  return given;
}

}  // namespace

palpate_status palpate_device_profile(const char* name, palpate_profile* device) {
  return answered(__func__, [&] {
    const DeviceProfile& profile = profileNamed(&need("name", name));
    give("device", device,
         palpate_profile{.size = sizeof(palpate_profile),
                         .name = profile.name.data(),  // a literal ends with a zero
                         .max_force = profile.max_force,
                         .max_stiffness = profile.max_stiffness,
                         .workspace_radius = profile.workspace_radius});
  });
}

palpate_status palpate_guard_defaults(const char* device, double period,
                                      palpate_guard_options* options) {
  return answered(__func__, [&] {
    finite("period", period, Least::above_zero);
    GuardOptions chosen =
        device != nullptr ? guardFor(profileNamed(device), period) : GuardOptions{};
    chosen.period = period;
    give("options", options, toStruct(chosen));
  });
}

palpate_status palpate_guard_create(const palpate_guard_options* options, palpate_guard** guard) {
  return answered(__func__, [&] {
    need("guard", guard) = nullptr;
    GuardOptions chosen;
    palpate_guard_options given = takenOptions(options, toStruct(chosen));
    if (std::isnan(given.max_slew)) given.max_slew = 0;
    takeOver(given, chosen, limits);
    if (chosen.delay > most_delay * chosen.period)
      refuse("options->delay is {}; it must be at most {} periods", chosen.delay, most_delay);
    *guard = new palpate_guard{ForceGuard(chosen)};
  });
}

void palpate_guard_destroy(palpate_guard* guard) { delete guard; }

palpate_status palpate_guard_limit(palpate_guard* guard, const double tool[3],
                                   const palpate_touch* touch, std::uint32_t flags,
                                   palpate_guarded_force* guarded) {
  const palpate_status status = answered(__func__, [&] {
    palpate_guarded_force given{};
    // Set the force to zero first, so that a caller that ignores the status does no harm.
    give("guarded", guarded, given);
    ForceGuard& limiter = need("guard", guard).guard;
    const Eigen::Vector3d position = vectorOf("tool", tool);
    const palpate_touch touched = taken("touch", touch, toStruct(Touch{}));
    // A flag of a later version may mean "stop", so giving no force is safer than ignoring the
    // flag.
    if ((flags & ~known_flags) != 0)
      refuse("flags {:#x} contains unknown bits; see palpate.h", flags);
    const GuardedForce limited = limiter.limit({.tool = position,
                                                .touch = toTouch(touched),
                                                .fresh = (flags & PALPATE_READING_FRESH) != 0,
                                                .lost = (flags & PALPATE_READING_LOST) != 0,
                                                .late = (flags & PALPATE_LOOP_LATE) != 0});
    give(given.force, limited.force);
    given.passivity = limited.passivity;
    given.guards = limited.guards;
    give("guarded", guarded, given);
  });
  // After a failure the hand gets zero force, so the next force must start from zero.
  if (status != PALPATE_OK && guard != nullptr) guard->guard.reset();
  return status;
}

palpate_status palpate_guard_reset(palpate_guard* guard) {
  return answered(__func__, [&] { need("guard", guard).guard.reset(); });
}
