#include "viewer/picture/panels.hpp"
#include "viewer/picture/view_overlay.hpp"

namespace palpate {
namespace {

constexpr float sentence_margin = 24, line_width = 1;

}  // namespace

void drawBesideOverlay(const BesideContents& contents, const OrbitCamera& camera,
                       const Viewport& part) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = {static_cast<float>(part.width), static_cast<float>(part.height)};
  const auto left = static_cast<float>(part.x);
  draw.PushClipRect({left, 0}, {left + size.x, size.y});
  draw.AddLine({left, 0}, {left, size.y}, line_grey, px(line_width));
  const ScreenBox names = drawNames(draw, {contents.dataset, contents.tissue}, left, size.x);
  drawLabel(draw, contents.label, camera, left, size, std::span(&names, 1));
  const std::string& sentence = contents.sentence.empty() ? contents.colourless : contents.sentence;
  if (!sentence.empty()) {
    const float wrap = size.x - 2 * px(sentence_margin);
    const ImVec2 text = ImGui::CalcTextSize(sentence.c_str(), nullptr, false, wrap);
    draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(),
                 {left + (size.x - text.x) / 2, size.y - px(sentence_margin) - text.y}, ink,
                 sentence.c_str(), nullptr, wrap);
  }
  draw.PopClipRect();
}

}  // namespace palpate
