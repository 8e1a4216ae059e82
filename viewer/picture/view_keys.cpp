#include "viewer/picture/view_keys.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <optional>

namespace palpate {
namespace {

/// Returns the next prepared choice after `current`, in a cycle; nullopt if there is no other.
std::optional<std::int32_t> following(const std::vector<Choice>& choices, std::int32_t current) {
  for (std::size_t step = 1; step < choices.size(); ++step) {
    const std::size_t next = (static_cast<std::size_t>(current) + step) % choices.size();
    if (choices[next].prepared == 1) return static_cast<std::int32_t>(next);
  }
  return std::nullopt;
}

}  // namespace

void obeyKeys(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests) {
  const HapticState& state = contents.state;
  const auto pressed = [&](int key) { return std::ranges::count(contents.keys, key) > 0; };
  if (ImGui::GetIO().WantTextInput) return;
  if (pressed(GLFW_KEY_G)) choices.ghost = !choices.ghost;
  if (pressed(GLFW_KEY_L)) choices.lattice = !choices.lattice;
  if (pressed(GLFW_KEY_E)) choices.errors = !choices.errors;
  if (pressed(GLFW_KEY_C)) choices.colour = following(choices.colour);
  if (pressed(GLFW_KEY_B)) choices.beside = !choices.beside;
  if (pressed(GLFW_KEY_H)) choices.help = !choices.help;
  if (pressed(GLFW_KEY_R) || pressed(GLFW_KEY_ESCAPE)) requests.release = true;
  if (pressed(GLFW_KEY_T)) requests.hold = true;
  if (pressed(GLFW_KEY_SPACE)) requests.pause = true;
  if (pressed(GLFW_KEY_F5)) requests.reload = true;
  if (pressed(GLFW_KEY_Q)) requests.quit = true;
  const auto method = following(contents.methods, state.method);
  if (pressed(GLFW_KEY_M) && method) requests.use = {state.model, *method};
  const auto model = following(contents.models, state.model);
  if (pressed(GLFW_KEY_D) && model) requests.use = {*model, state.method};
}

void obeyHandKeys(const std::vector<int>& keys, const std::vector<int>& strokes,
                  PersonsInput& input) {
  if (ImGui::GetIO().WantTextInput) return;
  const auto pressed = [&](int key) { return std::ranges::count(keys, key) > 0; };
  const auto more = [&](int key, int opposite) {
    return static_cast<double>(std::ranges::count(strokes, key) -
                               std::ranges::count(strokes, opposite));
  };
  const Eigen::Vector2d arrows = {more(GLFW_KEY_RIGHT, GLFW_KEY_LEFT),
                                  more(GLFW_KEY_UP, GLFW_KEY_DOWN)};
  (ImGui::GetIO().KeyShift ? input.motion.turns : input.hand.strokes) = arrows;
  input.motion.closer =
      more(GLFW_KEY_EQUAL, GLFW_KEY_MINUS) + more(GLFW_KEY_KP_ADD, GLFW_KEY_KP_SUBTRACT);
  input.hand.deeper = more(GLFW_KEY_PAGE_DOWN, GLFW_KEY_PAGE_UP);
  input.hand.take = pressed(GLFW_KEY_ENTER) || pressed(GLFW_KEY_KP_ENTER);
  input.hand.out = pressed(GLFW_KEY_R) || pressed(GLFW_KEY_ESCAPE);
}

}  // namespace palpate
