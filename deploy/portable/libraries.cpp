// Compiles the libraries that Debian has only as shared ones: their inline functions become those
// of a static library
// (-fkeep-inline-functions).
#define FMT_HEADER_ONLY
#define SPDLOG_HEADER_ONLY
#define SPDLOG_FMT_EXTERNAL
#define TOML_HEADER_ONLY 1
#include <fmt/chrono.h>
#include <fmt/ranges.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <toml++/toml.h>

template std::locale fmt::detail::locale_ref::get<std::locale>() const;
template std::shared_ptr<spdlog::logger> spdlog::stderr_color_mt<spdlog::synchronous_factory>(
    const std::string&, spdlog::color_mode);
