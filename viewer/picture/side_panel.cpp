#include "viewer/picture/side_panel.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "viewer/picture/panel_style.hpp"

namespace palpate {
namespace {

// px; value_column and choice_column are measured from the left of the panel.
constexpr float value_column = 84, choice_column = 66, heading_gap = 4;
constexpr float second_quantile = 76, share_width = 46;  // measured from the first value
constexpr int lamp_corners = 12;
constexpr float lamp_radius = 5, lamp_text_offset = 15;
constexpr ImU32 lamp_lit = IM_COL32(240, 130, 0, 255), lamp_dark = IM_COL32(208, 213, 221, 255);
constexpr double smallest_weight = 0.005;  // a space with a smaller weight is not listed

void heading(const char* text) {
  ImGui::Dummy({0, px(heading_gap)});
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImGui::TextDisabled("%s", text);
  const float y = at.y + ImGui::GetTextLineHeight() + 2,
              right = at.x + ImGui::GetContentRegionAvail().x;
  ImGui::GetWindowDrawList()->AddLine({at.x, y}, {right, y}, line_grey);
}

/// Draws a name, and its value in the value column.
void row(const char* label, const std::string& value) {
  ImGui::TextUnformatted(label);
  ImGui::SameLine(px(value_column));
  ImGui::TextUnformatted(value.c_str());
}

std::string newtons(double force) {
  return std::isfinite(force) ? fmt::format("{:.3f} N", force) : "none";
}

std::string microseconds(double seconds) {
  return seconds < 0.01 ? fmt::format("{:.0f} µs", 1e6 * seconds)
                        : fmt::format("{:.1f} ms", 1e3 * seconds);
}

/// Draws a combo box of `choices`. Returns the index that the user chose if it differs from
/// `current`. The choices that are still being prepared are listed below the box and cannot be
/// chosen.
std::optional<std::int32_t> choose(const char* label, const std::vector<Choice>& choices,
                                   std::int32_t current) {
  std::optional<std::int32_t> chosen;
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(label);
  ImGui::SameLine(px(choice_column));
  ImGui::SetNextItemWidth(-1);
  const auto now = static_cast<std::size_t>(current);
  if (ImGui::BeginCombo(fmt::format("##{}", label).c_str(),
                        now < choices.size() ? choices[now].name.c_str() : "")) {
    for (std::size_t n = 0; n < choices.size(); ++n) {
      const ImGuiSelectableFlags flags =
          choices[n].prepared < 1 ? ImGuiSelectableFlags_Disabled : ImGuiSelectableFlags_None;
      // Two datasets may have the same name. The text after ## makes entries distinct and is not
      // shown.
      const std::string entry = fmt::format("{}##{}", choices[n].name, n);
      if (ImGui::Selectable(entry.c_str(), n == now, flags) && n != now)
        chosen = static_cast<std::int32_t>(n);
    }
    ImGui::EndCombo();
  }
  for (const Choice& choice : choices)
    if (choice.prepared < 1)
      ImGui::TextDisabled("preparing %s: %.0f %%", choice.name.c_str(), 100 * choice.prepared);
  return chosen;
}

/// Places the next check box, whose text is `words`, on the same line if the panel is wide enough.
void sameLineIfFits(const char* words) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float wide = ImGui::GetFrameHeight() + style.ItemInnerSpacing.x +
                     ImGui::CalcTextSize(words).x + style.ItemSpacing.x;
  const float end = ImGui::GetItemRectMax().x - ImGui::GetWindowPos().x + wide;
  if (end < ImGui::GetWindowContentRegionMax().x) ImGui::SameLine();
}

void choices(const PanelContents& contents, ViewChoices& view, PictureRequests& requests) {
  const HapticState& state = contents.state;
  heading("View");
  if (const auto model = choose("dataset", contents.models, state.model))
    requests.use = {*model, state.method};
  if (const auto method = choose("method", contents.methods, state.method))
    requests.use = {state.model, *method};
  std::vector<Choice> colours;
  for (const char* const name : surface_colours) colours.push_back({name});
  if (const auto colour = choose("colour", colours, static_cast<std::int32_t>(view.colour)))
    view.colour = static_cast<SurfaceColour>(*colour);
  // In a narrow panel the labels of the buttons need its full width.
  ImGui::PushStyleVar(ImGuiStyleVar_FramePadding, {1, ImGui::GetStyle().FramePadding.y});
  const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  if (ImGui::Button("Release", {width, 0})) requests.release = true;
  ImGui::SameLine();
  if (ImGui::Button(contents.status.paused ? "Resume" : "Pause", {width, 0})) requests.pause = true;
  ImGui::SameLine();
  if (ImGui::Button("Reload", {width, 0})) requests.reload = true;
  ImGui::PopStyleVar();
  ImGui::Checkbox("ghost", &view.ghost);
  sameLineIfFits("lattice");
  ImGui::Checkbox("lattice", &view.lattice);
  sameLineIfFits("help");
  ImGui::Checkbox("help", &view.help);
  if (contents.models.size() > 1) ImGui::Checkbox("compare datasets", &view.beside);
}

void latticeChoices(const PanelContents& contents, ViewChoices& view) {
  if (!view.lattice) return;
  heading(fmt::format("Lattice of \"{}\"", contents.space.patch.name).c_str());
  if (ImGui::RadioButton("by tag", !view.errors)) view.errors = false;
  ImGui::SameLine();
  if (ImGui::RadioButton("by error", view.errors)) view.errors = true;
  ImGui::Checkbox("cut", &view.cut);
  for (int axis = 0; axis < 3; ++axis) {
    ImGui::SameLine();
    ImGui::RadioButton(std::array{"x", "y", "z"}[static_cast<std::size_t>(axis)], &view.plane.axis,
                       axis);
  }
  const auto reach = static_cast<float>(1e3 * contents.space.lattice.radius());
  auto offset = static_cast<float>(1e3 * view.plane.offset);
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderFloat("##offset", &offset, -reach, reach, "at %.1f mm")) {
    view.plane.offset = 1e-3 * offset;
    view.cut = true;
  }
}

std::string stiffnessText(const Eigen::Matrix3d& stiffness) {
  if (!stiffness.allFinite()) return "none";
  // Stiffness of the tissue: minus the derivative of the force on the tool.
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(-0.5 * (stiffness + stiffness.transpose()), Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& k = solver.eigenvalues();
  return fmt::format("{:.0f}, {:.0f}, {:.0f} N/m", k[2], k[1], k[0]);
}

/// Lists the force and the contact. A touch does not change the number of rows, so the rows below
/// do not move.
void touchNumbers(const PanelContents& contents) {
  const Touch& touch = contents.state.touch;
  heading("Touch");
  row("force", newtons(contents.state.force.norm()));
  if (contents.beside) row("beside", newtons(contents.beside->force));
  const double bound = touch.error_bound;
  row("error", std::isfinite(bound) ? fmt::format("± {:.2g} N", bound) : "unknown");
  if (contents.held) {
    const Touch& held = contents.held->touch;
    row("held", std::isfinite(held.error_bound)
                    ? fmt::format("{:.3f} ± {:.2g} N", held.force.norm(), held.error_bound)
                    : "unknown");
  }
  if (touch.touching)
    row("pressed", fmt::format("{:.1f} mm", 1e3 * touch.displacement.norm()));
  else
    row("gap", fmt::format("{:.1f} mm", 1e3 * touch.gap));
}

void tissueNumbers(const PanelContents& contents) {
  const Touch& touch = contents.state.touch;
  heading("Tissue");
  row("force", newtons(touch.force.norm()));
  row("passivity", fmt::format("{:.2f} mJ", 1e3 * contents.state.passivity));
  if (!touch.touching) return;
  const Eigen::Vector3d u = 1e3 * touch.displacement;
  // Leave out the unit: a narrow panel has no room for it.
  row("pressed", fmt::format("({:.1f}, {:.1f}, {:.1f})", u.x(), u.y(), u.z()));
  row("stiffness", stiffnessText(touch.stiffness));
  row("coverage", fmt::format("{:.0f} %{}", 100 * touch.coverage, touch.inside ? "" : ", outside"));
  const std::vector<SpaceTable>& spaces = contents.body.model().spaces();
  for (const char* label = "spaces"; const SpaceWeight& share : touch.blend.used()) {
    const auto space = static_cast<std::size_t>(share.space);
    if (share.weight <= smallest_weight || space >= spaces.size()) continue;
    row(std::exchange(label, ""), fmt::format("{:.0f} %", 100 * share.weight));
    ImGui::SameLine(px(value_column + share_width));
    ImGui::TextUnformatted(spaces[space].patch.name.c_str());
  }
}

void lampField(const GuardLamps& lamps) {
  heading("Force limits");
  const ImVec2 origin = ImGui::GetCursorScreenPos();
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  float widest = 0;
  for (const LampText& text : lamp_texts)
    widest = std::max(widest, ImGui::CalcTextSize(text.words).x + px(lamp_text_offset));
  const float wide = ImGui::GetContentRegionAvail().x;
  const int columns = wide < 2 * widest ? 1 : 2;
  const float column = wide / static_cast<float>(columns);
  const float text = ImGui::GetTextLineHeight(), line = text + ImGui::GetStyle().ItemSpacing.y;
  for (int bit = 0; bit < guard_count; ++bit) {
    const int row = bit / columns;
    const ImVec2 at = {origin.x + column * static_cast<float>(bit - row * columns),
                       origin.y + line * static_cast<float>(row)};
    const bool lit = lamps.lit(bit);
    const auto& [words, sentence] = lamp_texts[static_cast<std::size_t>(bit)];
    draw.AddCircleFilled({at.x + px(lamp_radius), at.y + text / 2}, px(lamp_radius),
                         lit ? lamp_lit : lamp_dark, lamp_corners);
    draw.AddText({at.x + px(lamp_text_offset), at.y}, lit ? ink : faint, words);
    if (ImGui::IsMouseHoveringRect(at, {at.x + column, at.y + line}))
      ImGui::SetTooltip("%s\nIn the log: %s", sentence, guardWord(bit));
  }
  const int lines = (guard_count + columns - 1) / columns;
  ImGui::Dummy({0, line * static_cast<float>(lines) - px(heading_gap)});
}

void loopNumbers(const PictureStatus& status) {
  const LoopStatistics& loop = status.loop;
  const auto quantiles = [](const char* label, const TimeHistogram& times) {
    row(label, microseconds(times.quantile(0.5)));
    ImGui::SameLine(px(value_column + second_quantile));
    ImGui::TextUnformatted(microseconds(times.quantile(0.999)).c_str());
  };
  heading("Loop");
  row("device", status.device.empty() ? "none" : status.device);
  if (loop.rate <= 0) return;
  row("rate", fmt::format("{:.0f} Hz{}", loop.rate, status.recording ? ", recording" : ""));
  ImGui::TextDisabled("%s", "");
  ImGui::SameLine(px(value_column));
  ImGui::TextDisabled("median");
  ImGui::SameLine(px(value_column + second_quantile));
  ImGui::TextDisabled("99.9 %%");
  quantiles("period", loop.period);
  quantiles("compute", loop.compute);
  row("missed", fmt::format("{} own, {} system", loop.missed_program, loop.missed_system));
  if (loop.halts > 0) row("halts", fmt::format("{}", loop.halts));
}

}  // namespace

void buildSidePanel(const PanelContents& contents, const Viewport& view, ViewChoices& chosen,
                    PictureRequests& requests) {
  ImGui::SetNextWindowPos({static_cast<float>(view.width), 0});
  ImGui::SetNextWindowSize(
      {static_cast<float>(view.window_width - view.width), static_cast<float>(view.window_height)});
  ImGui::Begin("##side", nullptr, fixed_panel);
  touchNumbers(contents);
  lampField(contents.lamps);
  choices(contents, chosen, requests);
  latticeChoices(contents, chosen);
  tissueNumbers(contents);
  loopNumbers(contents.status);
  ImGui::End();
}

}  // namespace palpate
