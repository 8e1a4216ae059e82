#pragma once

#include "scheduler/web/http_server.hpp"

namespace palpate {

/// The page (dashboard.html), whole: it asks for status.json, events.json and explain.json beside
/// it, and for nothing else. Its browser runs no script but the page's own, and shows it in no
/// frame.
HttpAnswer dashboardPage();

}  // namespace palpate
