#include "viewer/picture/panels.hpp"
#include "viewer/picture/sentence.hpp"
#include "viewer/picture/view_overlay.hpp"

namespace palpate {
namespace {

constexpr float sentence_above = 18, line_width = 1;

}  // namespace

void drawBesideOverlay(const BesideContents& contents, const OrbitCamera& camera,
                       const Viewport& part, std::vector<ScreenBox> taken) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = {static_cast<float>(part.width), static_cast<float>(part.height)};
  const auto left = static_cast<float>(part.x);
  draw.PushClipRect({left, 0}, {left + size.x, size.y});
  draw.AddLine({left, 0}, {left, size.y}, line_grey, px(line_width));
  taken.push_back(drawNames(draw, {contents.dataset, contents.tissue}, left, size.x));
  const std::string& sentence = contents.sentence.empty() ? contents.colourless : contents.sentence;
  if (!sentence.empty()) taken.push_back(drawSentence(draw, sentence, part, px(sentence_above)));
  drawLabel(draw, contents.label, camera, left, size, taken);
  draw.PopClipRect();
}

}  // namespace palpate
