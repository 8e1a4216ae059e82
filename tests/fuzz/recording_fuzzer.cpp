#include "tests/fuzz/stored_arrays.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/haptics/recording.hpp"

namespace palpate::fuzz {
namespace {

void makeRecording(const std::filesystem::path& file) {
  RecordedRun run;
  run.models = {{"liver", "liver.h5", {}}};
  run.methods = {"potential"};
  run.device = "hand";
  run.profile = device_profiles.front();
  Recorder recorder(run);
  for (int tick = 1; tick <= 20; ++tick) {
    HapticState state;
    state.time = tick * run.options.period;
    state.reading.position = {0.001 * tick, 0, 0};
    recorder.add(state);
  }
  recorder.save(file);
}

const StoredArrays& recordedArrays() {
  static const StoredArrays arrays = [] {
    const test::TemporaryDirectory directory;
    makeRecording(directory / "run.h5");
    return StoredArrays(
        directory / "run.h5", {"format", "profile"}, {"format_version", "scene_frame"},
        {"period", "profile_max_force", "profile_max_stiffness", "profile_workspace_radius"});
  }();
  return arrays;
}

/// The first byte selects what follows: a file, or changes of a valid one.
void readRecordingFile(std::string_view bytes) {
  static const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "fuzzed.h5";
  Choices choices(bytes);
  if (choices.oneOf(2) == 0) {
    putInto(file, choices.rest());
  } else {
    StoredArrays arrays = recordedArrays();
    for (int changes = 0; changes < 8 && !choices.done(); ++changes) arrays.change(choices);
    arrays.write(file);
  }
  const Recording recording = readRecording(file);
  require(recording.rate > 0, "a recording has no rate");
}

std::vector<std::string> recordingSeeds() {
  const test::TemporaryDirectory directory;
  makeRecording(directory / "run.h5");
  Script lost = Script().op(1), short_list = Script().op(1);
  recordedArrays().overwriteIn(lost, "/device/status", 3, "\2");
  recordedArrays().resizeIn(short_list, "/device/buttons", 3);
  return {Script().op(0).text() + bytesIn(directory / "run.h5"), Script().op(1).text(), lost.text(),
          short_list.text()};
}

const Registration recording_fuzzer({"recording", readRecordingFile, recordingSeeds});

}  // namespace
}  // namespace palpate::fuzz
