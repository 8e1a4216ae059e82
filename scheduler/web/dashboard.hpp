#pragma once

#include "scheduler/web/http_server.hpp"

namespace palpate {

/// Returns the self-contained page dashboard.html, which requests only status.json, events.json and
/// explain.json from its server. Its content security policy allows no scripts but its own, and no
/// frames around it.
HttpAnswer dashboardPage();

}  // namespace palpate
