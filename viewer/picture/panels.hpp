#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/stage.hpp"

struct GLFWwindow;

namespace palpate {

/// The panels beside and over the view (Dear ImGui), with their keys and buttons. Used by the
/// thread of the Window only. Must be destroyed before the Window.
class Panels {
 public:
  explicit Panels(GLFWwindow* window);
  ~Panels();
  Panels(const Panels&) = delete;
  Panels& operator=(const Panels&) = delete;

  /// Begins a frame and updates the input.
  void begin();
  /// Returns the part of the window that no panel covers, pixels. Call after begin().
  Viewport view() const;
  /// Lays out the panels. Changes `choices` according to the user's input, and adds the user's
  /// requests to `requests`.
  void build(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
  /// Draws the panels as build() laid them out. May be called several times.
  void render();

 private:
  void fitScreen();

  GLFWwindow* window_;
  double scale_ = 0, units_ = 0;  ///< as in setPanelStyle()
};

}  // namespace palpate
