#include "scheduler/verbs/served_pages.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/number_in.hpp"
#include "common/base/text.hpp"
#include "scheduler/events/event_reader.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/verbs/explanation.hpp"
#include "scheduler/web/dashboard.hpp"
#include "scheduler/web/metrics.hpp"

namespace palpate {
namespace {

/// Longest wait for a fresh status. If the scheduler is busy for longer, reading results or
/// sealing, the last status is used.
constexpr std::chrono::milliseconds patience{2000};
constexpr std::size_t most_events = 1000, usual_events = 100;
/// Limit for explanations, which take about 1 kB and a few microseconds per point in the
/// scheduler's own process.
constexpr std::int64_t most_points_explained = 100'000;

std::string valueIn(const HttpQuery& query, const char* name) {
  const auto found = query.find(name);
  return found == query.end() ? "" : found->second;
}

template <class Number>
Number numberOf(const HttpQuery& query, const char* name) {
  const std::string text = valueIn(query, name);
  if (const auto number = numberIn<Number>(text)) return *number;
  throw badInput("{}=\"{}\" is not a number", name, text);
}

HttpAnswer jsonAnswer(std::string body) {
  return {.type = "application/json", .body = std::move(body)};
}

}  // namespace

void PageOptions::addTo(CLI::App& app) {
  app.add_option("--metrics", metrics,
                 "Serve Prometheus metrics at PORT (local) or HOST:PORT (docs/metrics.md) [none]")
      ->type_name("ADDRESS");
  app.add_flag(
      "--dashboard{0}", dashboard,
      "Serve a status page for browsers on this machine; --dashboard=PORT sets the port [none]");
}

ServedPages::ServedPages(const PageOptions& options, std::filesystem::path state)
    : state_(std::move(state)) {
  if (!options.metrics.empty()) {
    const HttpAddress address = HttpAddress::parse(options.metrics, "--metrics");
    servers_.emplace_back(address,
                          std::map<std::string, HttpHandler>{
                              {"/metrics", [this](const HttpQuery&) { return metrics(); }}},
                          "--metrics");
    spdlog::info("metrics: {}metrics", servers_.back().url());
    if (!address.isLoopback())
      spdlog::warn("anyone can read the metrics at {}", servers_.back().address().text());
  }
  if (options.dashboard.empty()) return;
  if (options.dashboard.find_first_not_of("0123456789") != std::string::npos)
    throw badInput("--dashboard={}: give a port of this machine, for instance --dashboard=7412",
                   options.dashboard);
  servers_.emplace_back(
      HttpAddress::parse(options.dashboard, "--dashboard"),
      std::map<std::string, HttpHandler>{
          {"/", [](const HttpQuery&) { return dashboardPage(); }},
          {"/metrics", [this](const HttpQuery&) { return metrics(); }},
          {"/status.json", [this](const HttpQuery&) { return status(); }},
          {"/events.json", [this](const HttpQuery& query) { return events(query); }},
          {"/explain.json", [this](const HttpQuery& query) { return explain(query); }}},
      "--dashboard");
  spdlog::info("dashboard: {}", servers_.back().url());
}

void ServedPages::offer(const Coordinator& coordinator) {
  board_.offer([&] { return coordinator.status(StatusBoard::Clock::now()); });
}

StatusBoard::Snapshot ServedPages::snapshot() {
  if (auto snapshot = board_.ask(patience)) return std::move(*snapshot);
  throw failure("the scheduler is still reading the recorded results; ask again later");
}

HttpAnswer ServedPages::metrics() {
  const StatusBoard::Snapshot snapshot = this->snapshot();
  return {.type = "text/plain; version=0.0.4; charset=utf-8",
          .body = metricsOf(*snapshot.status, snapshot.age.count())};
}

HttpAnswer ServedPages::status() {
  const StatusBoard::Snapshot snapshot = this->snapshot();
  HttpAnswer answer = jsonAnswer(toJson(*snapshot.status));
  answer.headers.emplace_back("Age", fmt::format("{:.0f}", snapshot.age.count()));
  return answer;
}

HttpAnswer ServedPages::events(const HttpQuery& query) {
  const std::size_t last =
      valueIn(query, "last").empty() ? usual_events : numberOf<std::size_t>(query, "last");
  WantedEvents wanted;
  for (const std::string& word : CLI::detail::split(valueIn(query, "event"), ','))
    if (!word.empty()) wanted.insert(word);
  const std::lock_guard lock(reading_);
  const std::vector<std::string> lines = lastEvents(state_, wanted, std::min(last, most_events));
  return jsonAnswer(fmt::format("{{\"events\":[{}]}}", fmt::join(lines, ",")));
}

HttpAnswer ServedPages::explain(const HttpQuery& query) {
  const Eigen::Vector3d point(numberOf<double>(query, "i"), numberOf<double>(query, "j"),
                              numberOf<double>(query, "k"));
  std::int64_t points = 0;
  for (const wire::SpaceStatus& space : snapshot().status->spaces()) points += space.points();
  if (points > most_points_explained)
    return httpError(
        413, fmt::format("{} points are too many to read in the scheduler; run instead: "
                         "palpate explain {} --active {} {:g} {:g} {:g}",
                         points, shellWord(state_.string()), shellWord(valueIn(query, "active")),
                         point[0], point[1], point[2]));
  // Explain for one request at a time, because this takes the time and memory of a scheduler's
  // start.
  const std::unique_lock lock(reading_, std::try_to_lock);
  if (!lock) return httpError(503, "the scheduler is answering another request; ask again");
  const KnownSpaces known = spacesIn(state_.string());
  return jsonAnswer(toJson(palpate::explain(known.named(valueIn(query, "active")), point)));
}

}  // namespace palpate
