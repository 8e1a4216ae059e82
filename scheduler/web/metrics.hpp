#pragma once

#include <string>

#include "proto/palpate.pb.h"

namespace palpate {

/// A status in Prometheus' text format 0.0.4, the names and labels of docs/metrics.md. `age`: s,
/// since it was made.
std::string metricsOf(const wire::Status& status, double age);

/// As the format wants it between the quotes of a label.
std::string escapedLabel(std::string_view value);

}  // namespace palpate
