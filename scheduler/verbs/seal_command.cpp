
#include "common/base/required_option.hpp"
#include "common/base/whole_file.hpp"
#include "scheduler/builds/recorded_build.hpp"
#include "scheduler/verbs/status_text.hpp"
#include "scheduler/verbs/verbs.hpp"

// `palpate seal`: writes a dataset of the results in a state directory, whether or not a scheduler
// runs there.

namespace palpate {
namespace {

/// Returns what a partial dataset lacks, as text for users.
const char* whatIsMissing(const SpaceRowsList& spaces) {
  for (const auto& space : spaces)
    for (std::int32_t n = 0; n < space->points(); ++n)
      if (space->tag(n) == Tag::unknown) return "it gives no force where points are unknown";
  return "some of its points may still be solved again";
}

struct SealOptions {
  std::string state, out;
  bool replace = false;

  void addTo(CLI::App& app) {
    addRequired(app, "STATE", state, "State directory, with or without a running scheduler");
    addRequired(app, "-o,--output", out, "Dataset to write");
    app.add_flag("--replace", replace, "Replace OUTPUT if it holds something else");
    app.footer(
        "Until the build is complete, the dataset is partial, and marked as such: you can touch "
        "and\nquery it where points are solved. Other workers may still check its results.");
  }
};

void sealNow(const SealOptions& options) {
  RecordedBuild build(options.state);
  if (isSealed(options.out, build.problem(), options.replace)) {
    fmt::print("{}: is already the complete dataset of this build; nothing to do\n", options.out);
    return;
  }
  refuseUnwritable(options.out, "-o");
  const bool partial = !build.complete();
  const SpaceRowsList rows = build.seal(options.out);
  fmt::print("{}\n{}: sealed{}\n", summaryOf(rows, build.problem().scene, partial), options.out,
             partial ? fmt::format(", partial: {}", whatIsMissing(rows)) : "");
}

}  // namespace

const Verb seal_verb = {"seal", "Write a dataset of the results so far, while the build continues",
                        prepareVerb<SealOptions, sealNow>};

}  // namespace palpate
