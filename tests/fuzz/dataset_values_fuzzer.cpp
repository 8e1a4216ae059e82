#include "common/dataset/dataset.hpp"
#include "common/dataset/dataset_format.hpp"
#include "tests/fuzz/stored_arrays.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate::fuzz {
namespace {

const StoredArrays& sampleArrays(bool refined) {
  static const auto take = [](bool refine) {
    const test::TemporaryDirectory directory;
    // The small model is prepared in a tenth of the time and tests the same code.
    test::SampleDataset sample(PressureSpace::p1_stabilized, DisplacementSpace::p1,
                               test::SampleDataset::Size::small);
    if (refine) sample.refine();
    sample.seal(directory / "sample.h5");
    return StoredArrays(
        directory / "sample.h5",
        {layout::format_attribute, layout::generator_attribute, layout::kernel_attribute,
         layout::scene_attribute, layout::build_attribute},
        {layout::version_attribute}, {});
  };
  static const StoredArrays uniform = take(false), adaptive = take(true);
  return refined ? adaptive : uniform;
}

/// A tool that approaches, sinks in and slides: all forces must be finite.
void touchAll(const HapticModel& model) {
  Contact contact(model, ContactOptions());
  for (std::size_t method = 0; method < model.methods().size(); ++method) {
    contact.use(model, method);
    for (int tick = 0; tick < 40; ++tick) {
      const double depth = 0.0005 * tick - 0.005;
      const Touch touch = contact.update({0.1 - depth, 0.09 - depth, 0.08}, true);
      require(touch.force.allFinite() && touch.stiffness.allFinite(), "a force is not finite");
    }
    for (std::size_t space = 0; space < model.spaces().size(); ++space)
      for (const double x : {0.0, 0.003, -0.02, 1e300}) {
        const ForceSample sample = model.field(method, space).evaluate({x, -x, 0.5 * x});
        require(sample.force.allFinite() && sample.stiffness.allFinite(),
                "an interpolated force is not finite");
      }
  }
}

/// The first byte selects a dataset; its changes follow.
void useDatasetValues(std::string_view bytes) {
  Choices choices(bytes);
  StoredArrays arrays = sampleArrays(choices.oneOf(2) == 1);
  for (int changes = 0; changes < 8 && !choices.done(); ++changes) arrays.change(choices);
  static const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "fuzzed.h5";
  arrays.write(file);
  const Dataset dataset(file);
  dataset.verifyAll();
  for (std::size_t space = 0; space < dataset.spaces().size(); ++space)
    dataset.surfaceFields(space);
  touchAll(HapticModel(dataset));
}

std::vector<std::string> datasetValueSeeds() {
  const StoredArrays& uniform = sampleArrays(false);
  const auto start = [](unsigned char which) { return Script().op(which); };
  Script forces = start(0), rows = start(0), surface = start(0);
  uniform.overwriteIn(forces, "/points/force", 0, std::string(768, '\x7f'));  // 1.4e306 N each
  uniform.resizeIn(rows, "/attempts/cause", 1);
  uniform.overwriteIn(surface, "/mesh/surface", 0, std::string(4, '\0'));
  return {start(0).text(), start(1).text(), forces.text(), rows.text(), surface.text()};
}

void makeSamples() {
  for (const bool refined : {false, true}) sampleArrays(refined);
}

const Registration dataset_values_fuzzer({"dataset_values", useDatasetValues, datasetValueSeeds,
                                          makeSamples});

}  // namespace
}  // namespace palpate::fuzz
