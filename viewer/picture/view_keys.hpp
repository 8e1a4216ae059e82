#pragma once

#include "viewer/picture/panel_contents.hpp"
#include "viewer/picture/picture_requests.hpp"

namespace palpate {

/// What the keys and the mouse do, a line each, for the person.
extern const char* const key_help;

/// Changes `view` and adds to `requests` as the keys ask that went down since the last picture. A
/// dataset or method that is not prepared yet is passed over.
void obeyKeys(const PanelContents& contents, ViewChoices& view, PictureRequests& requests);

}  // namespace palpate
