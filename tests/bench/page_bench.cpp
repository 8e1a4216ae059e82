// A page of `palpate share` in Chromium without a screen, 1280 x 800, drawn in software, while a
// finger slides over the organ: ms until the organ is seen, pictures a second, and the processor
// time that a picture takes of each of the browser's processes, which work side by side. Prints one
// JSON object. Nothing here is checked: times belong to the machine.
//
//   page_bench PAGE.html [PICTURES]

#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "tests/system/touchable_pixel.hpp"

namespace palpate {
namespace {

/// So many pictures, between each of which the finger moves. Each move as the browser hands it on,
/// without the way through the protocol. Seconds.
double slide(test::Browser& browser, std::pair<double, double> from, int pictures) {
  return browser.valueOf(fmt::format(
      "(async () => {{ const begin = performance.now();"
      "  for (let n = 0; n < {}; ++n) {{"
      "    document.getElementById('organ').dispatchEvent(new PointerEvent('pointermove',"
      "        {{pointerId: [...palpate.page.pointers.keys()][0],"
      "         clientX: {} + n % 30, clientY: {} + n % 15}}));"
      "    await new Promise(requestAnimationFrame); }}"
      "  return (performance.now() - begin) / 1000; }})()",
      pictures, from.first, from.second));
}

int run(const std::filesystem::path& page, int pictures) {
  test::Browser browser;
  browser.go(std::filesystem::absolute(page));
  if (!browser.becomesTrue("document.body && document.body.dataset.state === 'ready'"))
    throw failure("{}: the page does not get ready", page.string());
  const auto place = test::touchablePixel(browser);
  browser.mouse("mouseMoved", place.first, place.second);
  browser.mouse("mousePressed", place.first, place.second);
  slide(browser, place, 120);  // the field is prepared where the finger is
  const std::map<pid_t, double> begin = browser.processorSeconds();
  const int before = browser.valueOf("palpate.page.frames");
  const double seconds = slide(browser, place, pictures);
  const int drawn = browser.valueOf("palpate.page.frames").get<int>() - before;
  nlohmann::json processor = nlohmann::json::array();
  for (const auto& [pid, end] : browser.processorSeconds())
    if (begin.contains(pid) && end > begin.at(pid))
      processor.push_back(1e3 * (end - begin.at(pid)) / drawn);
  const nlohmann::json out = {{"bytes", std::filesystem::file_size(page)},
                              {"seen_ms", browser.valueOf("palpate.ready")},
                              {"pictures", drawn},
                              {"pictures_a_second", drawn / seconds},
                              {"processor_ms_of_processes", processor}};
  std::puts(out.dump(2).c_str());
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw palpate::failure("page_bench PAGE.html [PICTURES]");
    return palpate::run(argv[1], argc > 2 ? std::atoi(argv[2]) : 300);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
