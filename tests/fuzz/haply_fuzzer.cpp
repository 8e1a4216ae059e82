#include "tests/fuzz/fuzzer.hpp"
#include "viewer/devices/haply_message.hpp"

namespace palpate::fuzz {
namespace {

void readHaplyText(std::string_view bytes) {
  for (const char* id : {"", "049D"}) {
    const HaplyState state = readHaplyState(bytes, id);
    if (state.kind != HaplyState::Kind::reading) continue;
    require(state.reading.position.allFinite(), "JSON has no numbers that are not finite");
    haplyForceMessage(state.id, state.reading.position);
  }
}

std::vector<std::string> haplySeeds() {
  return {
      R"({"inverse3":[{"device_id":"049D","state":{"cursor_position":{"x":0.1,"y":-0.2,"z":3}},)"
      R"("status":{"calibrated":false,"power_supply":true}}],)"
      R"("wireless_verse_grip":[{"state":{"buttons":{"a":true,"b":false,"c":true}}}]})",
      R"({"session_id":1,"inverse3":[{"device_id":"04A1","status":{"power_supply":false}}],)"
      R"("verse_grip":[{"state":{"button":true}}]})",
      haplyForceMessage("049D", {1, 2, 3})};
}

const Registration haply_fuzzer({"haply", readHaplyText, haplySeeds});

}  // namespace
}  // namespace palpate::fuzz
