#include "viewer/haptics/recording.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "common/base/error.hpp"
#include "common/base/replaced_file.hpp"
#include "common/dataset/hdf5_reader.hpp"
#include "common/dataset/hdf5_writer.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

using hdf5::Reader;
using hdf5::Writer;
using Json = nlohmann::json;

constexpr const char* format_word = "palpate-recording";
constexpr std::int32_t format_version = 1;
constexpr hdf5::FileKind recording_kind = {"recording", "palpate view --record FILE makes one",
                                           "copy the recording again, or record again"};

/// Each list of a recording, with its path and unit. Writer and reader go through the same table.
template <class AnyRecording, class Visit>
void forEachList(AnyRecording& recording, const Visit& visit) {
  visit("/time", recording.times, "s");
  visit("/device/position", recording.positions, "m");
  visit("/device/buttons", recording.buttons, "bits");
  visit("/device/status", recording.status, "0 fresh, 1 repeated, 2 lost");
  visit("/tool/position", recording.tools, "m");
  visit("/force/rendered", recording.forces, "N");
  visit("/force/raw", recording.raw_forces, "N");
  visit("/contact/touching", recording.touching, "0 or 1");
  visit("/contact/anchor", recording.anchors, "m");
  visit("/contact/displacement", recording.displacements, "m");
  visit("/contact/energy", recording.energies, "J");
  visit("/contact/error_bound", recording.error_bounds, "N");
  visit("/guards", recording.guards, "bits");
  visit("/model", recording.models, "1");
  visit("/method", recording.methods, "1");
}

/// Each number of a run, with the name of its attribute.
template <class AnyRun, class Visit>
void forEachNumber(AnyRun& run, const Visit& visit) {
  visit("period", run.options.period);
  visit("profile_max_force", run.max_force);
  visit("profile_max_stiffness", run.max_stiffness);
  visit("profile_workspace_radius", run.workspace_radius);
  visit("contact_friction", run.options.contact.friction);
  visit("contact_grab_distance", run.options.contact.grab_distance);
  visit("contact_most_slide", run.options.contact.most_slide);
  visit("contact_most_relaxation", run.options.contact.most_relaxation);
  visit("guard_period", run.options.guard.period);
  visit("guard_max_force", run.options.guard.max_force);
  visit("guard_max_slew", run.options.guard.max_slew);
  visit("guard_ramp", run.options.guard.ramp);
  visit("guard_stall", run.options.guard.stall);
  visit("guard_max_stiffness", run.options.guard.max_stiffness);
  visit("guard_energy_credit", run.options.guard.energy_credit);
  visit("workspace_scale", run.options.map.scale);
}

/// A list of text as JSON; names of files may hold bytes that are not UTF-8.
std::string jsonOf(const std::vector<std::string>& texts) {
  return Json(texts).dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::vector<std::string> readTexts(const Reader& in, const char* attribute) {
  const Json json = Json::parse(in.text(attribute), nullptr, false);
  const auto is_text = [](const Json& item) { return item.is_string(); };
  if (!json.is_array() || !std::all_of(json.begin(), json.end(), is_text))
    throw in.damaged(attribute, "is not a list of text");
  return json.get<std::vector<std::string>>();
}

void writeRun(Writer& out, const RecordedRun& run) {
  std::vector<std::string> names, files, ids;
  for (const RecordedModel& model : run.models) {
    names.push_back(model.name);
    files.push_back(model.file);
    ids.push_back(model.dataset.hex());
  }
  out.setText("/", "datasets", jsonOf(files));
  out.setText("/", "content_ids", jsonOf(ids));
  out.setText("/", "models", jsonOf(names));
  out.setText("/", "methods", jsonOf(run.methods));
  out.setText("/", "device", run.device);
  out.setText("/", "profile", run.profile);
  out.setText("/", "contact_mode", word(run.options.contact.mode));
  const std::int32_t scene_frame = run.scene_frame ? 1 : 0;
  out.setIntegers("/", "scene_frame", std::span(&scene_frame, 1));
  out.setNumber("/", "rate", 1 / run.options.period);
  forEachNumber(run, [&](const char* name, double value) { out.setNumber("/", name, value); });
  const hdf5::RowMajorMatrix3d rotation = run.options.map.rotation;
  out.write("/workspace/rotation", {3, 3}, std::span<const double>(rotation.data(), 9), "1");
  out.write("/workspace/origin", {3}, std::span<const double>(run.options.map.origin.data(), 3),
            "m");
}

void checkFormat(const Reader& in, const std::filesystem::path& file) {
  if (!in.hasAttribute("format") || in.text("format") != format_word)
    throw badInput("{}: is an HDF5 file, but not a recording; {}", file.string(),
                   recording_kind.origin);
  const std::vector<std::int32_t> version = in.integers("format_version");
  if (version.size() != 1) throw in.damaged("format_version", "is not one number");
  if (version[0] != format_version)
    throw badInput(
        "{}: is a recording of format {}, this program reads format {}; "
        "use the program that made it",
        file.string(), version[0], format_version);
}

std::vector<RecordedModel> readModels(const Reader& in) {
  const std::vector<std::string> names = readTexts(in, "models"), files = readTexts(in, "datasets"),
                                 ids = readTexts(in, "content_ids");
  if (files.size() != names.size() || ids.size() != names.size())
    throw in.damaged("models", "models, datasets and content_ids are not equally many");
  std::vector<RecordedModel> models;
  for (std::size_t m = 0; m < names.size(); ++m) {
    const auto id = ContentId::fromHex(ids[m]);
    if (!id) throw in.damaged("content_ids", "is not 64 hexadecimal digits");
    models.push_back({names[m], files[m], *id});
  }
  return models;
}

WorkspaceMap readMap(const Reader& in) {
  WorkspaceMap map;
  const std::vector<double> rotation = in.read<double>("/workspace/rotation", {3, 3});
  map.rotation = Eigen::Map<const hdf5::RowMajorMatrix3d>(rotation.data());
  if (!(map.rotation * map.rotation.transpose()).isIdentity(1e-9))
    throw in.damaged("/workspace/rotation", "is not a rotation");
  const std::vector<double> origin = in.read<double>("/workspace/origin", {3});
  map.origin = Eigen::Map<const Eigen::Vector3d>(origin.data());
  if (!map.origin.allFinite()) throw in.damaged("/workspace/origin", "is not finite");
  return map;
}

RecordedRun readRun(const Reader& in) {
  RecordedRun run;
  run.models = readModels(in);
  run.methods = readTexts(in, "methods");
  run.device = in.text("device");
  run.profile = in.text("profile");
  const auto& modes = words_of<ContactMode>;
  const auto mode = std::find(modes.begin(), modes.end(), in.text("contact_mode"));
  if (mode == modes.end()) throw in.damaged("contact_mode", "is no known mode");
  const std::vector<std::int32_t> scene_frame = in.integers("scene_frame");
  if (scene_frame.size() != 1 || (scene_frame[0] != 0 && scene_frame[0] != 1))
    throw in.damaged("scene_frame", "is neither 0 nor 1");
  run.scene_frame = scene_frame[0] == 1;
  run.options.map = readMap(in);
  run.options.contact.mode = static_cast<ContactMode>(mode - modes.begin());
  forEachNumber(run, [&](const char* name, double& value) {
    value = in.number(name);
    if (!std::isfinite(value) || value < 0) throw in.damaged(name, "is not a number >= 0");
  });
  if (run.options.period <= 0) throw in.damaged("period", "is not positive");
  if (run.options.map.scale <= 0) throw in.damaged("workspace_scale", "is not positive");
  return run;
}

template <class T, class Holds>
void require(const Reader& in, const char* path, const std::vector<T>& list, const char* what,
             const Holds& holds) {
  const auto bad = std::find_if_not(list.begin(), list.end(), holds);
  if (bad != list.end())
    throw in.damaged(path, fmt::format("entry {} {}", bad - list.begin(), what));
}

void checkValues(const Reader& in, const Recording& recording) {
  const auto is_finite = [](const Eigen::Vector3d& v) { return v.allFinite(); };
  const auto counts_in = [](std::size_t size) {
    return [size](std::int32_t n) { return n >= 0 && static_cast<std::size_t>(n) < size; };
  };
  require(in, "/time", recording.times, "is not finite", [](double t) { return std::isfinite(t); });
  if (std::adjacent_find(recording.times.begin(), recording.times.end(), std::greater_equal<>()) !=
      recording.times.end())
    throw in.damaged("/time", "does not increase");
  require(in, "/device/status", recording.status, "is no known status",
          [](DeviceStatus status) { return status <= DeviceStatus::lost; });
  require(in, "/contact/touching", recording.touching, "is neither 0 nor 1",
          [](std::uint8_t touching) { return touching <= 1; });
  require(in, "/force/rendered", recording.forces, "is not finite", is_finite);
  require(in, "/model", recording.models, "is no model", counts_in(recording.run.models.size()));
  require(in, "/method", recording.methods, "is no method",
          counts_in(recording.run.methods.size()));
}

}  // namespace

RecordedRun describeRun(const std::vector<const HapticModel*>& models, const HapticDevice& device,
                        const TickOptions& options) {
  RecordedRun run;
  for (const HapticModel* model : models)
    run.models.push_back({model->name(), model->file(), model->contentId()});
  if (!models.empty()) run.methods = models.front()->methods();
  const DeviceProfile profile = device.profile();
  run.device = device.name();
  run.profile = profile.name;
  run.max_force = profile.max_force;
  run.max_stiffness = profile.max_stiffness;
  run.workspace_radius = profile.workspace_radius;
  run.scene_frame = device.livesInScene();
  run.options = options;
  return run;
}

bool Recording::complete() const {
  for (std::size_t n = 0; n < times.size(); ++n)
    if (std::llround(times[n] * rate) != static_cast<long long>(n) + 1) return false;
  return true;
}

Recorder::Recorder(RecordedRun run) {
  if (!(run.options.period > 0))
    throw failure("a recording needs a positive period, not {} s", run.options.period);
  recording_.rate = 1 / run.options.period;
  recording_.scene_frame = run.scene_frame;
  recording_.run = std::move(run);
}

void Recorder::add(const HapticState& state) {
  Recording& to = recording_;
  if (!to.times.empty() && !(state.time > to.times.back()))
    throw failure("recording: the state of {} s comes after that of {} s", state.time,
                  to.times.back());
  const Touch& touch = state.touch;
  const Eigen::Vector3d nowhere = Eigen::Vector3d::Zero();
  to.times.push_back(state.time);
  to.positions.push_back(state.reading.position);
  to.buttons.push_back(state.reading.buttons);
  to.status.push_back(state.reading.status);
  to.tools.push_back(state.tool);
  to.forces.push_back(state.force);
  to.raw_forces.push_back(touch.force);
  to.touching.push_back(touch.touching ? 1 : 0);
  to.anchors.push_back(touch.touching ? touch.anchor_position : nowhere);
  to.displacements.push_back(touch.touching ? touch.displacement : nowhere);
  to.energies.push_back(touch.energy);
  to.error_bounds.push_back(touch.error_bound);
  to.guards.push_back(state.guards);
  to.models.push_back(state.model);
  to.methods.push_back(state.method);
}

void Recorder::save(const std::filesystem::path& file) const {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw badInput("{}: is a directory; give the recording a file name", file.string());
  replaceFile(file, [this](const std::filesystem::path& aside) {
    Writer out(aside);
    for (const char* group : {"/device", "/tool", "/force", "/contact", "/workspace"})
      out.makeGroup(group);
    out.setText("/", "format", format_word);
    out.setIntegers("/", "format_version", std::span(&format_version, 1));
    writeRun(out, recording_.run);
    forEachList(recording_, [&out](const char* path, const auto& list, const char* unit) {
      out.writeList(path, list, unit);
    });
    out.close();
  });
}

Recording readRecording(const std::filesystem::path& file) {
  Reader in(file, recording_kind);
  checkFormat(in, file);
  in.findArrays();
  Recording recording;
  recording.run = readRun(in);
  recording.rate = 1 / recording.run.options.period;
  recording.scene_frame = recording.run.scene_frame;
  const std::size_t rows = in.array("/time", hdf5::Element::float64, {hdf5::any_extent}).shape[0];
  forEachList(recording, [&](const char* path, auto& list, const char*) {
    using Entry = typename std::remove_reference_t<decltype(list)>::value_type;
    list = in.readList<Entry>(path, rows);
  });
  checkValues(in, recording);
  return recording;
}

}  // namespace palpate
