#pragma once

#include "worker/check/scene_report.hpp"

namespace palpate {

/// Prints a report for people on standard output: a word for the topic, then numbers in SI units.
void printSceneReport(const SceneReport& report);

}  // namespace palpate
