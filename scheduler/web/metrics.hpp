#pragma once

#include <string>

#include "proto/palpate.pb.h"

namespace palpate {

/// Formats a status in Prometheus' text format 0.0.4, with the names and labels of docs/metrics.md.
/// `age` is the time since the status was made, s.
std::string metricsOf(const wire::Status& status, double age);

/// Escapes the value of a label as the format requires between quotes.
std::string escapedLabel(std::string_view value);

}  // namespace palpate
