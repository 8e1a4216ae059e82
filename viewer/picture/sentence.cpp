#include "viewer/picture/sentence.hpp"

namespace palpate {
namespace {

// px
constexpr float sentence_padding = 10, sentence_rounding = 6;
constexpr ImU32 sentence_ground = IM_COL32(255, 255, 255, 235);

}  // namespace

ScreenBox drawSentence(ImDrawList& draw, const std::string& sentence, const Viewport& part,
                       float above) {
  const float padding = px(sentence_padding);
  const auto width = static_cast<float>(part.width), left = static_cast<float>(part.x);
  const float most = width - 4 * padding;
  const ImVec2 size = ImGui::CalcTextSize(sentence.c_str(), nullptr, false, most);
  const ImVec2 at = {left + (width - size.x) / 2,
                     static_cast<float>(part.height) - above - padding - size.y};
  const ImVec2 from = {at.x - padding, at.y - padding / 2},
               to = {at.x + size.x + padding, at.y + size.y + padding / 2};
  draw.AddRectFilled(from, to, sentence_ground, px(sentence_rounding));
  draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(), at, ink, sentence.c_str(), nullptr, most);
  return {{from.x, from.y}, {to.x, to.y}};
}

}  // namespace palpate
