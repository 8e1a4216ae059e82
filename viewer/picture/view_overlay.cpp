#include "viewer/picture/view_overlay.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "viewer/picture/label_place.hpp"
#include "viewer/picture/legends.hpp"
#include "viewer/picture/panel_style.hpp"
#include "viewer/picture/touch_words.hpp"
#include "viewer/picture/view_keys.hpp"

namespace palpate {
namespace {

// px
constexpr float margin = 14;
constexpr float label_padding_x = 7, label_padding_y = 4, arrow_width = 6;
constexpr float banner_stripe = 4, banner_left = 12, banner_right = 8, banner_padding = 6,
                banner_gap = 6;
constexpr float sentence_padding = 10, sentence_rounding = 6, sentence_above = 18;
constexpr float help_gap = 18, hint_above_scale = 84;
constexpr float narrow_view = 760;  // in a narrower view, legends and scale are above the hint
constexpr float border_width = 1, ring_width = 2.5F, ring_edge_width = 4.5F;
constexpr double view_edge = 4;
constexpr float widest_name = 0.7F;  // largest width of a name at the upper right, as a share of
                                     // the view; a wider one would end under the messages
constexpr ImU32 sentence_ground = IM_COL32(255, 255, 255, 235);
constexpr ImU32 ring_colour = IM_COL32(255, 196, 92, 255), ring_edge = IM_COL32(60, 36, 8, 150);
constexpr int ring_corners = 40;
constexpr double ring_above_skin = 0.06;  // in radii of the ring: height that keeps triangles from
                                          // hiding it

ImVec2 imPoint(const Eigen::Vector2d& at) {
  return {static_cast<float>(at.x()), static_cast<float>(at.y())};
}

ImDrawList& canvas() { return *ImGui::GetBackgroundDrawList(); }

/// Returns the first line of a text. If it is too wide, cuts it and adds three dots.
std::string shortened(const std::string& text, float widest) {
  constexpr const char* dots = "...";
  std::string line = text.substr(0, text.find('\n'));
  const char* const end = line.data() + line.size();
  const auto endWithin = [&](float width) {
    const char* fits = nullptr;
    ImGui::GetFont()->CalcTextSizeA(ImGui::GetFontSize(), width, 0, line.data(), end, &fits);
    return fits;
  };
  if (endWithin(widest) == end) return line;
  const char* const cut = endWithin(widest - ImGui::CalcTextSize(dots).x);
  line.resize(static_cast<std::size_t>(cut - line.data()));
  return line + dots;
}

/// Draws text on a light background, wrapped at `width`. Returns the height at which the next text
/// may begin.
float banner(ImVec2 at, float width, ImU32 colour, const std::string& text) {
  const float wrap = width - px(banner_left) - px(banner_right);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  const float bottom = at.y + size.y + 2 * px(banner_padding);
  ImDrawList& draw = canvas();
  draw.AddRectFilled(at, {at.x + size.x + px(banner_left) + px(banner_right), bottom}, paper,
                     px(4));
  draw.AddRectFilled(at, {at.x + px(banner_stripe), bottom}, colour, px(2));
  draw.AddText(ImGui::GetFont(), ImGui::GetFontSize(),
               {at.x + px(banner_left), at.y + px(banner_padding)}, colour, text.c_str(), nullptr,
               wrap);
  return bottom + px(banner_gap);
}

/// Draws the help above everything else: the keys in one column, their effects in another. Draws as
/// many pairs of columns as the height of the window requires, and uses smaller letters if the
/// window is too narrow for them.
void drawHelp(ImVec2 at, ImVec2 window) {
  float keys = 0, widest = 0;
  for (const auto& [key, effect] : key_help) {
    keys = std::max(keys, ImGui::CalcTextSize(key).x + px(help_gap));
    widest = std::max(widest, ImGui::CalcTextSize(effect).x);
  }
  const float step = ImGui::GetTextLineHeightWithSpacing(), wide = keys + widest + px(help_gap);
  const float room = (window.y - at.y - px(margin) - 2 * px(banner_padding)) / step;
  const auto rows = static_cast<std::size_t>(
      std::clamp(std::floor(room), 1.0F, static_cast<float>(key_help.size())));
  const std::size_t columns = (key_help.size() + rows - 1) / rows;
  const ImVec2 size = {wide * static_cast<float>(columns) + px(banner_left),
                       step * static_cast<float>(rows) + 2 * px(banner_padding)};
  const float smaller = std::min(1.0F, (window.x - at.x - px(margin)) / size.x);
  ImDrawList& draw = *ImGui::GetForegroundDrawList();
  draw.AddRectFilled(at, {at.x + smaller * size.x, at.y + size.y}, white, px(4));
  const auto write = [&](float x, float y, ImU32 colour, const char* words) {
    draw.AddText(ImGui::GetFont(), smaller * ImGui::GetFontSize(), {at.x + smaller * x, at.y + y},
                 colour, words);
  };
  for (std::size_t n = 0; n < key_help.size(); ++n) {
    const std::size_t column = n / rows;
    const float x = px(banner_left) + wide * static_cast<float>(column),
                y = px(banner_padding) + step * static_cast<float>(n % rows);
    write(x, y, blue, key_help[n][0]);
    write(x + keys, y, ink, key_help[n][1]);
  }
}

void drawBanners(const PanelContents& contents, const ViewChoices& choices, float width) {
  const PictureStatus& status = contents.status;
  float next = px(margin);
  const auto say = [&](ImU32 colour, const std::string& text) {
    if (!text.empty()) next = banner({px(margin), next}, width - 2 * px(margin), colour, text);
  };
  say(red, status.trouble);
  say(blue, status.notice);
  say(blue, status.paused ? "paused" : "");
  if (choices.beside && contents.models.size() == 1)
    say(blue,
        "B compares two datasets, but only one is open (palpate view A.h5 B.h5). Press B to hide "
        "this.");
  if (choices.help) drawHelp({px(margin), next}, ImGui::GetIO().DisplaySize);
}

/// Draws a sentence on a light background, centred and wrapped, `above` units over the lower end of
/// a part of the view. Returns the area that it covers.
ScreenBox drawSentence(const std::string& sentence, const Viewport& part, float above) {
  const float padding = px(sentence_padding);
  const auto width = static_cast<float>(part.width);
  const float most = width - 4 * padding;
  const ImVec2 size = ImGui::CalcTextSize(sentence.c_str(), nullptr, false, most);
  const ImVec2 at = {static_cast<float>(part.x) + (width - size.x) / 2,
                     static_cast<float>(part.height) - above - padding - size.y};
  const ImVec2 from = {at.x - padding, at.y - padding / 2},
               to = {at.x + size.x + padding, at.y + size.y + padding / 2};
  canvas().AddRectFilled(from, to, sentence_ground, px(sentence_rounding));
  canvas().AddText(ImGui::GetFont(), ImGui::GetFontSize(), at, ink, sentence.c_str(), nullptr,
                   most);
  return {{from.x, from.y}, {to.x, to.y}};
}

/// Texts and marks over one body. Each is placed so that it does not cover the earlier ones.
class Overlay {
 public:
  /// part: part of the view in which the camera shows the body. taken: areas that already have
  /// text.
  Overlay(const Viewport& part, const OrbitCamera& camera, std::vector<ScreenBox> taken)
      : camera_(camera),
        from_(part.x, 0),
        size_(part.width, part.height),
        taken_(std::move(taken)) {
    canvas().PushClipRect(imPoint(from_), imPoint(from_ + size_));
  }
  ~Overlay() { canvas().PopClipRect(); }
  Overlay(const Overlay&) = delete;
  Overlay& operator=(const Overlay&) = delete;

  void keepClearOf(const ScreenBox& box) { taken_.push_back(box); }
  void keepClearOf(const ShownTool& tool) {
    if (!tool.pose.tip.allFinite()) return;
    const auto [tip, end] = tool.axis();
    const double pixels = size_.y() / camera_.moveInPlane(tip, 0, 1).norm();  // per metre
    clear_.push_back({seen(tip), seen(tip), pixels * tool.radius()});
    clear_.push_back({seen(tip), seen(end), pixels * tool.handleRadius()});
  }

  /// Draws names at the upper right, one per line.
  void names(const std::vector<std::string>& names) {
    const float line = ImGui::GetTextLineHeightWithSpacing(), width = static_cast<float>(size_.x()),
                right = static_cast<float>(from_.x()) + width - px(margin);
    float y = px(margin), begin = right;
    for (const std::string& name : names) {
      const std::string shown = shortened(name, widest_name * width);
      const float wide = ImGui::CalcTextSize(shown.c_str()).x;
      drawRimmedText(canvas(), {right - wide, y}, &name == names.data() ? ink : faint,
                     shown.c_str());
      begin = std::min(begin, right - wide);
      y += line;
    }
    keepClearOf({{begin, px(margin)}, {right, y}});
  }

  /// Draws a label on a light background, beyond the tip of its arrow.
  void label(const ViewLabel& label) {
    if (label.text.empty() || !(camera_.project(label.at).z() > 0)) return;
    const ThickLine arrow = {seen(label.from), seen(label.at), px(arrow_width)};
    const ImVec2 text = ImGui::CalcTextSize(label.text.c_str());
    const Eigen::Vector2d padding(px(label_padding_x), px(label_padding_y));
    const Eigen::Vector2d edge(view_edge, view_edge);
    const ScreenBox box = placeLabel(arrow, Eigen::Vector2d(text.x, text.y) + 2 * padding,
                                     {from_ + edge, from_ + size_ - edge}, clear_, taken_);
    canvas().AddRectFilled(imPoint(box.from), imPoint(box.to), paper, px(4));
    canvas().AddText(imPoint(box.from + padding), label.uncertain ? amber_ink : ink,
                     label.text.c_str());
    keepClearOf(box);
    clear_.push_back(arrow);
  }

  /// Draws the ring of a hand without a device: a circle around the place, in the plane of the
  /// skin.
  void ring(const PointedPlace& place, double radius) {
    const Eigen::Vector3d across = place.normal.unitOrthogonal(),
                          along = place.normal.cross(across);
    const Eigen::Vector3d middle = place.position + ring_above_skin * radius * place.normal;
    std::array<ImVec2, ring_corners> corners;
    for (int n = 0; n < ring_corners; ++n) {
      const double angle = 2 * std::numbers::pi * n / ring_corners;
      const Eigen::Vector3d corner =
          middle + radius * (std::cos(angle) * across + std::sin(angle) * along);
      if (!(camera_.project(corner).z() > 0)) return;
      corners[static_cast<std::size_t>(n)] = imPoint(seen(corner));
    }
    for (const auto& [colour, width] :
         {std::pair(ring_edge, ring_edge_width), std::pair(ring_colour, ring_width)})
      canvas().AddPolyline(corners.data(), ring_corners, colour, ImDrawFlags_Closed, px(width));
  }

 private:
  /// Returns the screen position of a point of the scene.
  Eigen::Vector2d seen(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d place = camera_.project(point);
    return from_ + size_ / 2 + size_.y() * Eigen::Vector2d(place.x(), -place.y());
  }

  const OrbitCamera& camera_;
  Eigen::Vector2d from_, size_;
  std::vector<ScreenBox> taken_;
  std::vector<ThickLine> clear_;  ///< tools and arrows
};

/// Draws the hint, if there is one. Returns the area that it covers.
std::vector<ScreenBox> drawHint(const PanelContents& contents, const Viewport& view) {
  if (contents.hand.hint.empty()) return {};
  // Stay above the scale bar of the first body, which is between the two bodies.
  return {drawSentence(contents.hand.hint, view,
                       px(contents.beside ? hint_above_scale : sentence_above))};
}

/// part: the part of the view with the touched body.
void drawTouched(const PanelContents& contents, const ViewChoices& choices, const Viewport& part,
                 const std::vector<ScreenBox>& hint) {
  const ImVec2 size = {static_cast<float>(part.width), static_cast<float>(part.height)};
  // If there is no room for legends and scale beside the hint, draw them above it.
  const bool narrow = size.x < px(narrow_view) && !hint.empty() && !contents.beside;
  const float foot = narrow ? static_cast<float>(hint.front().from.y()) : size.y;
  Overlay overlay(part, contents.camera, hint);
  drawScaleAndAxes(canvas(), contents, size, foot);
  // Leave out the legends while the help is shown, because the help would cover a part of them.
  if (!choices.help) overlay.keepClearOf(drawLegends(canvas(), contents, choices, {size.x, foot}));
  const HapticModel& model = contents.body.model();
  overlay.names({model.name(), tissueText(model.regions()), "H: help"});
  overlay.keepClearOf(contents.tool);
  if (contents.held) overlay.keepClearOf(contents.held->tool);
  overlay.label(contents.label);
  if (contents.held) overlay.label(contents.held->label);
  drawBanners(contents, choices, size.x);
  if (contents.hand.ring) overlay.ring(*contents.hand.ring, contents.hand.ring_radius);
}

/// part: the part of the view with the other dataset.
void drawBeside(const PanelContents& contents, const Viewport& part,
                const std::vector<ScreenBox>& hint) {
  const BesideContents& beside = *contents.beside;
  Overlay overlay(part, contents.camera, hint);
  const auto left = static_cast<float>(part.x);
  canvas().AddLine({left, 0}, {left, static_cast<float>(part.height)}, line_grey, px(border_width));
  overlay.names({beside.body.model().name(), tissueText(beside.body.model().regions())});
  if (!beside.sentence.empty())
    overlay.keepClearOf(drawSentence(beside.sentence, part, px(sentence_above)));
  overlay.keepClearOf(contents.tool);
  overlay.label(beside.label);
}

}  // namespace

void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view) {
  const std::vector<ScreenBox> hint = drawHint(contents, view);
  drawTouched(contents, choices, contents.beside ? view.leftHalf() : view, hint);
  if (contents.beside) drawBeside(contents, view.rightHalf(), hint);
}

}  // namespace palpate
