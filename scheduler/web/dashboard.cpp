#include "scheduler/web/dashboard.hpp"

#include <fmt/format.h>

#include "common/base/bytes32.hpp"

namespace palpate {

/// dashboard.html, made into a source by CMakeLists.txt.
extern const char* const dashboard_html;

HttpAnswer dashboardPage() {
  constexpr std::string_view placeholder = "NONCE";
  std::string nonce;
  for (const char byte : randomBytes(16))
    nonce += fmt::format("{:02x}", static_cast<unsigned char>(byte));
  std::string page = dashboard_html;
  for (std::size_t at = 0; (at = page.find(placeholder, at)) != std::string::npos;)
    page.replace(at, placeholder.size(), nonce);
  const std::string policy = fmt::format(
      "default-src 'none'; script-src 'nonce-{0}'; style-src 'nonce-{0}'; connect-src 'self'; "
      "img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
      nonce);
  return {.status = 200,
          .type = "text/html; charset=utf-8",
          .body = std::move(page),
          .headers = {{"Content-Security-Policy", policy}}};
}

}  // namespace palpate
