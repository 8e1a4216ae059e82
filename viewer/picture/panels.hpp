#pragma once

#include "viewer/picture/hand_control.hpp"
#include "viewer/picture/label_place.hpp"
#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"
#include "viewer/picture/stage.hpp"

struct GLFWwindow;

namespace palpate {

/// The panels beside and over the view (Dear ImGui), keys and buttons. Belongs to the thread of the
/// Window, must go before it.
class Panels {
 public:
  explicit Panels(GLFWwindow* window);
  ~Panels();
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;

  /// Begins a picture: input is up to date afterwards.
  void begin();
  /// The part of the window that panels leave free, pixels. After begin().
  Viewport view() const;
  /// Lays the panels out. Changes `choices` and adds to `requests` as the person asks.
  void build(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
  /// Draws what build() laid out; again after that, the same.
  void render();

 private:
  void fitScreen();

  GLFWwindow* window_;
  double scale_ = 0, units_ = 0;  ///< of the style, setPanelStyle
};

// What Panels::build() puts together, a source each. view: what the panels leave free, in ImGui's
// units.

/// What the keys and the mouse do, a line each, for the person.
extern const char* const key_help;
/// Changes `choices` and adds to `requests` as the keys ask that went down since the last picture.
/// A dataset or method that is not prepared yet is passed over.
void obeyKeys(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
/// What the keys ask of the hand and the camera. keys, strokes: of the Window.
void obeyHandKeys(const std::vector<int>& keys, const std::vector<int>& strokes,
                  PersonsInput& input);
/// The panel at the right of the view, from top to bottom of the window: choices, and the numbers
/// of touch, guards, loop and lattice. Changes `choices` and adds to `requests` as the person
/// clicks.
void buildSidePanel(const PanelContents& contents, const Viewport& view, ViewChoices& choices,
                    PictureRequests& requests);
/// The panel below the view: the force of the last ForceHistory::span seconds, its components and
/// its length, with the error bound as a band around it.
void buildForcePlot(const ForceHistory& history, const Viewport& view);
/// The ring of a hand without a device, over the view.
void drawHandMarks(const HandMarks& marks, const OrbitCamera& camera, const Viewport& view);
/// What a hand without a device can do now, at the lower end of the view. Where it is said, if
/// anything is.
std::vector<ScreenBox> drawHint(const PanelContents& contents, const Viewport& view);
/// Over the other part of the view, where another dataset is shown: names, label, and why nothing
/// is touched there, or seen of what the colours show. part: as layout() counts. taken: what the
/// label keeps clear of.
void drawBesideOverlay(const BesideContents& contents, const OrbitCamera& camera,
                       const Viewport& part, std::vector<ScreenBox> taken);
/// What lies over the part of the view where the touched body is: names, a label, legends, scale
/// and axes, what must be said, the help (which legends make room for). hint: where drawHint() put
/// it, if there is one; the label keeps clear of it, and in a narrow view legends and scale do.
void drawViewOverlay(const PanelContents& contents, const ViewChoices& choices,
                     const Viewport& view, const std::vector<ScreenBox>& hint);

}  // namespace palpate
