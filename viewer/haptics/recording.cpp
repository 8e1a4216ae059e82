#include "viewer/haptics/recording.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>
#include <tuple>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/base/whole_file.hpp"
#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

using hdf5::Reader;
using hdf5::Writer;

constexpr const char* format_word = "palpate-recording";
constexpr std::int32_t format_version = 1;
constexpr hdf5::FileKind recording_kind = {"recording", "palpate view --record FILE makes one",
                                           "copy the recording again, or record again"};

template <class Value>
struct Channel {
  const char *path, *unit;
  Value (*of)(const HapticState&);
  std::vector<Value> values = {};
};
template <class Value>
Channel(const char*, const char*, Value (*)(const HapticState&)) -> Channel<Value>;

/// Returns zero without contact. Anchor and displacement are meaningless then, and plots show zero.
Eigen::Vector3d whileTouching(const Touch& touch, const Eigen::Vector3d& value) {
  return touch.touching ? value : Eigen::Vector3d::Zero().eval();
}

Eigen::Vector3d timesOf(const HeldForces& held) { return {held.delay, held.interval, held.hold}; }
std::uint32_t packedForces(const HeldForces& held) {
  return held.newest | (std::uint32_t{held.oldest} << 16);
}
HeldForces heldForces(std::uint32_t forces, const Eigen::Vector3d& times) {
  return {static_cast<std::uint16_t>(forces), static_cast<std::uint16_t>(forces >> 16), times[0],
          times[1], times[2]};
}

const Hold nobody = {nowhere(), nowhere()};  ///< no second finger

/// Returns all lists of a recording. Each list has the path of its array, its unit, and its value
/// in a state.
auto makeChannels() {
  using State = const HapticState&;
  return std::tuple{
      Channel{"/time", "s", +[](State s) { return s.time; }},
      Channel{"/device/position", "m", +[](State s) { return s.reading.position; }},
      Channel{"/device/buttons", "bits", +[](State s) { return s.reading.buttons; }},
      Channel{"/device/status", "0 fresh, 1 repeated, 2 lost, 3 away",
              +[](State s) { return s.reading.status; }},
      Channel{"/device/held_times", "s", +[](State s) { return timesOf(s.reading.held); }},
      Channel{"/device/held_forces", "ticks ago",
              +[](State s) { return packedForces(s.reading.held); }},
      Channel{"/tool/position", "m", +[](State s) { return s.tool; }},
      Channel{"/force/rendered", "N", +[](State s) { return s.force; }},
      Channel{"/force/raw", "N", +[](State s) { return s.touch.force; }},
      Channel{"/contact/touching", "0 or 1",
              +[](State s) { return std::uint8_t{s.touch.touching}; }},
      Channel{"/contact/anchor", "m",
              +[](State s) { return whileTouching(s.touch, s.touch.anchor_position); }},
      Channel{"/contact/displacement", "m",
              +[](State s) { return whileTouching(s.touch, s.touch.displacement); }},
      Channel{"/contact/inside", "0 or 1", +[](State s) { return std::uint8_t{s.touch.inside}; }},
      Channel{"/contact/coverage", "1", +[](State s) { return s.touch.coverage; }},
      Channel{"/contact/followed", "1", +[](State s) { return s.touch.followed; }},
      Channel{"/contact/energy", "J", +[](State s) { return s.touch.energy; }},
      Channel{"/contact/error_bound", "N", +[](State s) { return s.touch.error_bound; }},
      Channel{"/hold/anchor", "m", +[](State s) { return s.hold.value_or(nobody).place; }},
      Channel{"/hold/displacement", "m",
              +[](State s) { return s.hold.value_or(nobody).displacement; }},
      Channel{"/hold/force", "N", +[](State s) { return s.hold_force.force; }},
      Channel{"/hold/error_bound", "N", +[](State s) { return s.hold_force.error_bound; }},
      Channel{"/guards", "bits", +[](State s) { return s.guards; }},
      Channel{"/model", "1", +[](State s) { return s.model; }},
      Channel{"/method", "1", +[](State s) { return s.method; }}};
}

/// Returns a list of texts as JSON. File names may contain bytes that are not UTF-8; these are
/// replaced.
std::string jsonOf(const std::vector<std::string>& texts) {
  return nlohmann::json(texts).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

void writeRun(Writer& out, const RecordedRun& run) {
  const auto idOf = [](const RecordedModel& model) { return model.dataset.hex(); };
  const auto buildOf = [](const RecordedModel& model) { return model.build.hex(); };
  const auto& [period, contact, guard, map, holds] = run.options;
  out.setText("/", "format", format_word);
  out.setText("/", "datasets", jsonOf(mapped(run.models, &RecordedModel::file)));
  out.setText("/", "content_ids", jsonOf(mapped(run.models, idOf)));
  out.setText("/", "build_ids", jsonOf(mapped(run.models, buildOf)));
  out.setText("/", "models", jsonOf(mapped(run.models, &RecordedModel::name)));
  out.setText("/", "methods", jsonOf(run.methods));
  out.setText("/", "device", run.device);
  out.setText("/", "profile", run.profile.name);
  out.setText("/", "contact_mode", word(contact.mode));
  const std::int32_t scene_frame = run.scene_frame ? 1 : 0;
  out.setIntegers("/", "format_version", std::span(&format_version, 1));
  out.setIntegers("/", "scene_frame", std::span(&scene_frame, 1));
  out.setNumber("/", "rate", 1 / period);
  out.setNumber("/", "period", period);
  out.setNumber("/", "profile_max_force", run.profile.max_force);
  out.setNumber("/", "profile_max_stiffness", run.profile.max_stiffness);
  out.setNumber("/", "profile_workspace_radius", run.profile.workspace_radius);
  out.setNumber("/", "contact_friction", contact.friction);
  out.setNumber("/", "contact_grab_distance", contact.grab_distance);
  out.setNumber("/", "contact_most_slide", contact.most_slide);
  out.setNumber("/", "contact_most_relaxation", contact.most_relaxation);
  out.setNumber("/", "guard_period", guard.period);
  out.setNumber("/", "guard_max_force", guard.max_force);
  out.setNumber("/", "guard_max_slew", guard.max_slew);
  out.setNumber("/", "guard_ramp", guard.ramp);
  out.setNumber("/", "guard_stall", guard.stall);
  out.setNumber("/", "guard_max_stiffness", guard.max_stiffness);
  out.setNumber("/", "guard_energy_credit", guard.energy_credit);
  out.setNumber("/", "workspace_scale", map.scale);
  const Eigen::Matrix3d rows = map.rotation.transpose();
  out.writeList<Eigen::Vector3d>("/workspace/rotation", {rows.col(0), rows.col(1), rows.col(2)},
                                 "1");
  out.writeList<double>("/workspace/origin", {map.origin.begin(), map.origin.end()}, "m");
}

void checkFormat(const Reader& in, const std::filesystem::path& file) {
  if (!in.hasAttribute("format") || in.text("format") != format_word)
    throw badInput("{}: is an HDF5 file but not a recording; {}", file.string(),
                   recording_kind.origin);
  const std::vector<std::int32_t> version = in.integers("format_version");
  if (version.size() != 1) throw in.damaged("format_version", "is not a single number");
  if (version[0] != format_version)
    throw badInput(
        "{}: is a recording of format {}, but this program reads format {}; use the program that "
        "made it",
        file.string(), version[0], format_version);
}

double readNotNegative(const Reader& in, const char* attribute) {
  const double value = in.number(attribute);
  if (!std::isfinite(value) || value < 0) throw in.damaged(attribute, "is not a number >= 0");
  return value;
}

/// Returns the limits of the recorded device. The name in the result lives as long as the program.
DeviceProfile readProfile(const Reader& in) {
  const DeviceProfile* const known = deviceNamed(in.text("profile"));
  return {known == nullptr ? "replay" : known->name, readNotNegative(in, "profile_max_force"),
          readNotNegative(in, "profile_max_stiffness"),
          readNotNegative(in, "profile_workspace_radius")};
}

std::vector<ContentId> readBuilds(const Reader& in) {
  if (!in.hasAttribute("build_ids")) return {};
  std::vector<ContentId> builds;
  const auto list = nlohmann::json::parse(in.text("build_ids"), nullptr, false);
  for (const nlohmann::json& entry : list) {
    const auto id = ContentId::fromHex(entry.is_string() ? entry.get<std::string>() : "");
    if (!id) throw in.damaged("build_ids", "is not a list of ids");
    builds.push_back(*id);
  }
  return builds;
}

std::vector<RecordedTouch> readTouches(const Reader& in, std::size_t ticks) {
  const auto vectors = [&](const char* path) { return in.readList<Eigen::Vector3d>(path, ticks); };
  const auto tools = vectors("/tool/position"), anchors = vectors("/contact/anchor"),
             displacements = vectors("/contact/displacement"), forces = vectors("/force/raw");
  const auto times = in.readList<double>("/time", ticks);
  const auto touching = in.readList<std::uint8_t>("/contact/touching", ticks);
  const auto bounds = in.readList<double>("/contact/error_bound", ticks);
  std::vector<Eigen::Vector3d> holds(ticks, nowhere());
  if (std::ranges::find(in.arrays(), "/hold/anchor", &hdf5::ArrayInfo::path) != in.arrays().end())
    holds = vectors("/hold/anchor");
  std::vector<RecordedTouch> touches(ticks);
  for (std::size_t n = 0; n < ticks; ++n)
    touches[n] = {times[n],   tools[n],         touching[n] != 0, !holds[n].hasNaN(),
                  anchors[n], displacements[n], forces[n],        bounds[n]};
  return touches;
}

}  // namespace

RecordedRun describeRun(const std::vector<const HapticModel*>& models, const HapticDevice& device,
                        const TickOptions& options) {
  PALPATE_ASSERT(!models.empty(), "at least one dataset must be given");
  std::vector<RecordedModel> recorded;
  for (const HapticModel* model : models)
    recorded.push_back({model->name(), model->file(), model->contentId(), model->buildId()});
  return {recorded,         models.front()->methods(), device.name(),
          device.profile(), device.livesInScene(),     options};
}

struct Recorder::Lists {
  decltype(makeChannels()) channels = makeChannels();
  bool held = false;  ///< whether a second finger has held the body
};

Recorder::Recorder(RecordedRun run) : run_(std::move(run)), lists_(std::make_unique<Lists>()) {
  if (!(run_.options.period > 0))
    throw failure("a recording needs a positive period, not {} s", run_.options.period);
}

Recorder::Recorder(Recorder&&) noexcept = default;
Recorder::~Recorder() = default;

void Recorder::add(const HapticState& state) {
  if (size_ > 0 && !(state.time > last_time_))
    throw failure("recording: the state at {} s was added after the one at {} s", state.time,
                  last_time_);
  PALPATE_ASSERT(at(state.model) < run_.models.size() && at(state.method) < run_.methods.size(),
                 "a state must use a dataset and a method of its run");
  last_time_ = state.time;
  ++size_;
  const double tick = std::round(state.time / run_.options.period);
  complete_ = complete_ && tick == static_cast<double>(size_);
  std::apply([&](auto&... channel) { (channel.values.push_back(channel.of(state)), ...); },
             lists_->channels);
  lists_->held = lists_->held || state.hold;
}

void Recorder::save(const std::filesystem::path& file) const {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw badInput("{}: is a directory; give the recording a file name", file.string());
  replaceFile(file, [this](const std::filesystem::path& aside) {
    Writer out(aside);
    for (const char* group : {"/device", "/tool", "/force", "/contact", "/workspace"})
      out.makeGroup(group);
    writeRun(out, run_);
    if (lists_->held) out.makeGroup("/hold");
    const auto write = [&](const auto& channel) {
      PALPATE_ASSERT(channel.values.size() == size_,
                     "each recorded list must have a value per state");
      if (lists_->held || !std::string_view(channel.path).starts_with("/hold"))
        out.writeList(channel.path, channel.values, channel.unit);
    };
    std::apply([&](const auto&... channel) { (write(channel), ...); }, lists_->channels);
    out.close();
  });
}

Recording readRecording(const std::filesystem::path& file) {
  Reader in(file, recording_kind);
  checkFormat(in, file);
  in.findArrays();
  for (const hdf5::ArrayInfo& array : in.arrays()) in.verify(array);
  const double period = readNotNegative(in, "period");
  if (period <= 0) throw in.damaged("period", "is not positive");
  const std::vector<std::int32_t> frame = in.integers("scene_frame");
  if (frame != std::vector{0} && frame != std::vector{1})
    throw in.damaged("scene_frame", "is neither 0 nor 1");
  Recording recording{1 / period, frame[0] == 1, readProfile(in), readBuilds(in), {}, {}};
  const auto positions = in.readList<Eigen::Vector3d>("/device/position");
  const auto buttons = in.readList<std::uint32_t>("/device/buttons", positions.size());
  const auto status = in.readList<DeviceStatus>("/device/status", positions.size());
  const auto times = in.readList<Eigen::Vector3d>("/device/held_times", positions.size());
  const auto forces = in.readList<std::uint32_t>("/device/held_forces", positions.size());
  recording.readings.reserve(positions.size());
  for (std::size_t tick = 0; tick < positions.size(); ++tick) {
    if (status[tick] > DeviceStatus::away)
      throw in.damaged("/device/status", fmt::format("entry {} is not a known status", tick));
    recording.readings.push_back(
        {positions[tick], buttons[tick], status[tick], heldForces(forces[tick], times[tick])});
  }
  recording.touches = readTouches(in, positions.size());
  return recording;
}

void checkReplay(const Recording& recording, double period, const std::string& source) {
  if (recording.readings.empty()) throw badInput("{}: the recording is empty", source);
  if (std::abs(recording.rate * period - 1) > 1e-6)
    throw badInput("{}: recorded at {} Hz; it cannot be replayed at {} Hz: use --rate {}", source,
                   recording.rate, 1 / period, recording.rate);
}

std::vector<std::optional<Hold>> holdsOf(const Recording& recording, const TouchSurface& surface,
                                         const std::string& source) {
  constexpr double rounding = 1e-9;  // m
  std::vector<std::optional<Hold>> holds;
  for (const RecordedTouch& touch : recording.touches) {
    std::optional<Hold> hold;
    if (touch.touching) {
      if (!(surface.tree().nearest(touch.anchor).distance <= rounding) ||
          !touch.displacement.allFinite())
        throw badInput("{}: tick {} touches another body; record the second finger on this mesh",
                       source, holds.size() + 1);
      hold = {touch.anchor, touch.displacement};
    }
    holds.push_back(hold);
  }
  return holds;
}

}  // namespace palpate
