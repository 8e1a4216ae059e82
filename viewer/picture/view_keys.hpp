#pragma once

#include <vector>

#include "viewer/picture/hand_control.hpp"
#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"

namespace palpate {

/// What the keys and the mouse do, a line each, for the person.
extern const char* const key_help;
/// Changes `choices` and adds to `requests` as the keys ask that went down since the last picture.
/// A dataset or method that is not prepared yet is passed over.
void obeyKeys(const PanelContents& contents, ViewChoices& choices, PictureRequests& requests);
/// What the keys ask of the hand and the camera. keys, strokes: of the Window.
void obeyHandKeys(const std::vector<int>& keys, const std::vector<int>& strokes,
                  PersonsInput& input);

}  // namespace palpate
