#pragma once

#include <string>

#include "viewer/picture/label_place.hpp"
#include "viewer/picture/panel_style.hpp"
#include "viewer/picture/stage.hpp"

namespace palpate {

/// Draws a sentence on a light ground in the middle of the lower end of a part of the view, `above`
/// pixels over it, in as many lines as it needs. part: as layout() counts. The place that it takes.
ScreenBox drawSentence(ImDrawList& draw, const std::string& sentence, const Viewport& part,
                       float above);

}  // namespace palpate
