// A page of `palpate share` in headless Chromium, 1280 x 800, drawn in software, while a finger
// slides over the organ: ms until the organ is visible, frames per second, and the processor time
// per frame of each of the browser's processes, which run in parallel. With the DATASET of the
// page, also compares random touches from all sides and at random depths with `palpate query`.
// Prints one JSON object. Checks nothing, because times depend on the machine.
//
//   page_bench PAGE.html [PICTURES [DATASET.h5 [TOUCHES]]]

#include <Eigen/Core>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/command.hpp"
#include "tests/system/touchable_pixel.hpp"

namespace palpate {
namespace {

/// Draws this many frames and moves the finger between them. Moves are dispatched inside the page,
/// without the protocol. Seconds.
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

/// Presses at once at a pixel from a random side to a random depth, and waits for the answer of the
/// field; null outside the organ. The random numbers are the same in every run.
constexpr const char* press_somewhere = R"((async () => {
  const {page} = palpate, {hand, camera} = page;
  let state = page.benchState || 1;
  const random = () => (state = (48271 * state) % 2147483647) / 2147483647;
  camera.turn = 2 * Math.PI * random();
  camera.tilt = 2.4 * random() - 1.2;
  page.look();
  const hit = page.hit(innerWidth * random(), innerHeight * random());
  const depth = page.reach * random();
  page.benchState = state;
  if (!hit || hit.touch < 0) return null;
  hand.begin(hit);
  page.setDepth(depth);
  hand.depth = hand.wanted;
  const p = hand.displacement(page.touches[hit.touch].radius);
  const isAnswered = ({answer}) => answer && answer.triangle === hit.triangle && answer.u === hit.u &&
      answer.v === hit.v && answer.p.every((x, i) => x === p[i]);
  for (const end = performance.now() + 30000; !isAnswered(page);) {
    if (performance.now() > end) throw new Error('the field does not answer');
    await new Promise(requestAnimationFrame);
  }
  const {s, force, bound} = palpate.touched, {fingerRadius} = page.touches[hit.touch];
  const name = JSON.parse(document.getElementById('facts').textContent).touches[hit.touch].name;
  hand.letGo();
  hand.place = null;
  hand.depth = 0;
  page.letGo();
  return {s: fingerRadius > 0 ? s : null, p, force, bound, name};
})())";

std::string numbersOf(const nlohmann::json& vector) {
  std::string text;
  for (const nlohmann::json& number : vector) text += " " + number.dump();
  return text;
}

/// The answers of `palpate query` to touches of the same name, in order.
std::vector<nlohmann::json> askedOfQuery(const std::filesystem::path& dataset,
                                         const std::string& name,
                                         const std::vector<nlohmann::json>& touches) {
  const test::TemporaryDirectory directory;
  const bool is_finger = !touches.front().at("s").is_null();
  {
    std::ofstream lines(directory / "touches");
    for (const nlohmann::json& touch : touches)
      lines << (is_finger ? numbersOf(touch.at("s")) : "") << numbersOf(touch.at("p")) << "\n";
    if (!lines.flush()) throw failure("{} cannot be written", (directory / "touches").string());
  }
  const test::CommandResult asked = test::runCommand(fmt::format(
      PALPATE_BIN_DIR "/palpate query '{}' --json -q --active '{}'{} --displacement - < '{}'",
      dataset.string(), name, is_finger ? " --at -" : "", (directory / "touches").string()));
  if (asked.exit_code != 0 && asked.exit_code != 3) throw failure("{}", asked.output);
  std::vector<nlohmann::json> answers;
  std::istringstream lines(asked.output);
  for (std::string line; std::getline(lines, line);) answers.push_back(nlohmann::json::parse(line));
  if (answers.size() != touches.size()) throw failure("{}", asked.output);
  return answers;
}

Eigen::Vector3d forceOf(const nlohmann::json& said) {
  const nlohmann::json& force = said.at("force");
  return {force.at(0).get<double>(), force.at(1).get<double>(), force.at(2).get<double>()};
}

/// The largest differences from `palpate query` for the same touches.
nlohmann::json differencesFrom(test::Browser& browser, const std::filesystem::path& dataset,
                               int count) {
  std::map<std::string, std::vector<nlohmann::json>> touches;
  for (int n = 0, tries = 0; n < count; ++tries) {
    if (tries > 100 * count) throw failure("nothing of the organ can be touched");
    nlohmann::json touched = browser.valueOf(press_somewhere);
    if (touched.is_null()) continue;
    touches[touched.at("name")].push_back(std::move(touched));
    ++n;
  }
  double largest = 0, of_bound = 0, strongest = 0;
  for (const auto& [name, felt] : touches) {
    const std::vector<nlohmann::json> answers = askedOfQuery(dataset, name, felt);
    for (std::size_t n = 0; n < felt.size(); ++n) {
      const Eigen::Vector3d force = forceOf(answers[n]);
      const Eigen::Vector3d difference = forceOf(felt[n]) - force;
      if (!difference.allFinite()) throw failure("a force is no number: {}", felt[n].dump());
      strongest = std::max(strongest, force.norm());
      largest = std::max(largest, difference.cwiseAbs().maxCoeff());
      const nlohmann::json &bound = felt[n].at("bound"), &of_query = answers[n].at("error_bound");
      if (bound.is_number() && of_query.is_number())
        of_bound = std::max(of_bound, std::abs(bound.get<double>() - of_query.get<double>()));
    }
  }
  return {{"touches", count},
          {"largest_force", strongest},
          {"largest_difference", largest},
          {"largest_difference_of_bound", of_bound}};
}

int run(const std::filesystem::path& page, int pictures, const std::filesystem::path& dataset,
        int touches) {
  test::Browser browser;
  browser.go(std::filesystem::absolute(page));
  if (!browser.becomesTrue("document.body && document.body.dataset.state === 'ready'"))
    throw failure("{}: the page does not get ready", page.string());
  const auto place = test::touchablePixel(browser);
  browser.mouse("mouseMoved", place.first, place.second);
  browser.mouse("mousePressed", place.first, place.second);
  slide(browser, place, 120);  // prepares the field around the finger
  const std::map<pid_t, double> begin = browser.processorSeconds();
  const int before = browser.valueOf("palpate.page.frames");
  const double seconds = slide(browser, place, pictures);
  const int drawn = browser.valueOf("palpate.page.frames").get<int>() - before;
  nlohmann::json processor = nlohmann::json::array();
  for (const auto& [pid, end] : browser.processorSeconds())
    if (begin.contains(pid) && end > begin.at(pid))
      processor.push_back(1e3 * (end - begin.at(pid)) / drawn);
  browser.mouse("mouseReleased", place.first, place.second);
  nlohmann::json out = {{"bytes", std::filesystem::file_size(page)},
                        {"seen_ms", browser.valueOf("palpate.ready")},
                        {"pictures", drawn},
                        {"pictures_a_second", drawn / seconds},
                        {"processor_ms_of_processes", processor}};
  if (!dataset.empty()) out["beside_query"] = differencesFrom(browser, dataset, touches);
  std::puts(out.dump(2).c_str());
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw palpate::failure("page_bench PAGE.html [PICTURES [DATASET.h5 [TOUCHES]]]");
    return palpate::run(argv[1], argc > 2 ? std::atoi(argv[2]) : 300, argc > 3 ? argv[3] : "",
                        argc > 4 ? std::atoi(argv[4]) : 100);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
