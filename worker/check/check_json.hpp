#pragma once

#include <string>

#include "worker/check/scene_report.hpp"

namespace palpate {

/// A report as one JSON object on one line, lengths in metres.
std::string sceneReportJson(const SceneReport& report);

}  // namespace palpate
