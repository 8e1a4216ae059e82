#include "viewer/share/share_command.hpp"

#include <iostream>

#include "common/base/required_option.hpp"
#include "common/base/whole_file.hpp"
#include "common/dataset/dataset.hpp"
#include "viewer/share/organ_of_dataset.hpp"
#include "viewer/share/organ_page.hpp"

namespace palpate {

void ShareOptions::addTo(CLI::App& app) {
  addRequired(app, "DATASET", dataset, "Sealed dataset from palpate build, OUT.h5", "FILE");
  addRequired(app, "-o,--output", output, "Page to write", "FILE.html");
  app.footer(
      "The page needs no other file, no server and no network: send it, open it, press the organ\n"
      "with the mouse or a finger. Its forces are those of palpate query (docs/sharing.md).");
}

void share(const ShareOptions& options, std::ostream& output) {
  refuseUnwritable(options.output, "-o");
  refuseInput(options.output, "-o", {&options.dataset, 1});
  const Dataset dataset(options.dataset);
  warnIfPartial(dataset);
  requirePageField();  // check this before the slow search for modes
  const std::string page = organPage(organOf(dataset));
  replaceFile(options.output, page, "page");
  output << fmt::format("{}: {:.1f} MB, open it in a browser\n", options.output.string(),
                        static_cast<double>(page.size()) / 1e6);
}

const Verb share_verb = {"share", "Write a dataset as an HTML page to touch by mouse or finger",
                         prepareVerb<ShareOptions, share, std::cout>};

}  // namespace palpate
