#include "tests/simulation/network.hpp"

#include <algorithm>
#include <limits>

namespace palpate::simulation {
namespace {

constexpr Seconds latency = 0.0005;
constexpr Seconds connect_every = 1;

}  // namespace

void Network::join(const std::string& worker, Seconds now) {
  lines_[worker] = {};
  lines_[worker].connects_at = now;
}

void Network::breakLine(Line& line, Seconds now) {
  line.to_worker.clear();
  line.to_scheduler.clear();
  line.connected = line.known = line.dead_end = false;
  line.connects_at = now + connect_every;
}

void Network::leave(const std::string& worker, Seconds now) {
  Line& line = lines_.at(worker);
  line.gone = true;
  line.connected = false;
  line.to_worker.clear();
  // Messages that were sent before still arrive; the end of the connection arrives after them, or
  // never.
  const bool seen = !cut(false, worker, now) && !line.dead_end;
  if (seen && line.to_scheduler.empty()) line.known = false;
}

void Network::reconnect(const std::string& worker, Seconds now) {
  Line& line = lines_.at(worker);
  breakLine(line, now);
  line.connects_at = now;
}

void Network::schedulerEnds() {
  scheduler_up_ = false;
  for (auto& [worker, line] : lines_) breakLine(line, 0);
}

const Network::Trouble* Network::trouble(Accident accident, const std::string& worker,
                                         Seconds now) const {
  for (const Trouble& trouble : troubles_)
    if (trouble.event.accident == accident && now >= trouble.event.at &&
        now < trouble.event.at + trouble.event.length &&
        (trouble.worker.empty() || trouble.worker == worker))
      return &trouble;
  return nullptr;
}

bool Network::troubled(Accident accident, const std::string& worker, Seconds now) {
  const Trouble* found = trouble(accident, worker, now);
  if (found == nullptr || !random_.chance(found->event.how_much)) return false;
  ++felt_[accident];
  return true;
}

bool Network::cut(bool to_worker, const std::string& worker, Seconds now) {
  for (const Accident kind :
       {to_worker ? Accident::cut_to_worker : Accident::cut_to_scheduler, Accident::cut_both_ways})
    if (trouble(kind, worker, now) != nullptr) {
      ++felt_[kind];
      return true;
    }
  return false;
}

void Network::connectAgain(const std::string& worker, Line& line, Seconds now) {
  if (line.connected || line.gone || now < line.connects_at) return;
  line.connects_at = now + connect_every;
  // A handshake needs both directions.
  if (!scheduler_up_ || cut(true, worker, now) || cut(false, worker, now)) return;
  line.connected = true;
  line.dead_end = false;
}

void Network::post(Queue& queue, Seconds& last, Incoming letter, const std::string& worker,
                   Seconds now) {
  if (troubled(Accident::lost_messages, worker, now)) return;
  const int copies = troubled(Accident::doubled_messages, worker, now) ? 2 : 1;
  for (int n = 0; n < copies; ++n) {
    Seconds arrives = now + latency * random_.between(0.5, 1.5);
    if (troubled(Accident::slow_network, worker, now)) arrives += random_.between(0, 5);
    if (troubled(Accident::narrow_link, worker, now))
      arrives += static_cast<double>(letter.payload.size() + 100) / 2000;
    if (troubled(Accident::reordered_messages, worker, now))
      arrives += random_.between(0, 2);
    else
      arrives = last = std::max(arrives, last);
    queue.emplace(arrives, letter);
  }
  most_waiting_ = std::max(most_waiting_, queue.size());
}

Sent Network::toWorker(const std::string& worker, const wire::Message& message, std::string payload,
                       Seconds now) {
  const auto found = lines_.find(worker);
  if (found == lines_.end() || !found->second.known) return Sent::unroutable;
  Line& line = found->second;
  if (line.gone) {
    // If the system of the other end is reachable, it answers that nobody listens: this message is
    // lost, and the next one has no route.
    if (!cut(true, worker, now) && !cut(false, worker, now)) line.known = false;
    return Sent::yes;
  }
  if (line.dead_end) {
    ++felt_[Accident::half_open];
    return Sent::yes;
  }
  if (cut(true, worker, now)) return Sent::yes;
  post(line.to_worker, line.last_to_worker, {"", message, std::move(payload)}, worker, now);
  return Sent::yes;
}

void Network::toScheduler(const std::string& worker, const wire::Message& message,
                          std::string_view payload, Seconds now) {
  Line& line = lines_.at(worker);
  connectAgain(worker, line, now);
  if (!line.connected || cut(false, worker, now)) return;
  post(line.to_scheduler, line.last_to_scheduler, {worker, message, std::string(payload)}, worker,
       now);
}

std::optional<Incoming> Network::forScheduler(Seconds now) {
  Line* first = nullptr;
  for (auto& [worker, line] : lines_)
    if (!line.to_scheduler.empty() && line.to_scheduler.begin()->first <= now &&
        (first == nullptr || line.to_scheduler.begin()->first < first->to_scheduler.begin()->first))
      first = &line;
  if (first == nullptr) return std::nullopt;
  Incoming letter = std::move(first->to_scheduler.begin()->second);
  first->to_scheduler.erase(first->to_scheduler.begin());
  first->known = true;
  if (first->gone && first->to_scheduler.empty() && !first->dead_end) first->known = false;
  return letter;
}

std::optional<Incoming> Network::forWorker(const std::string& worker, Seconds now) {
  Line& line = lines_.at(worker);
  connectAgain(worker, line, now);
  if (line.to_worker.empty() || line.to_worker.begin()->first > now) return std::nullopt;
  Incoming letter = std::move(line.to_worker.begin()->second);
  line.to_worker.erase(line.to_worker.begin());
  return letter;
}

Seconds Network::nextForScheduler() const {
  Seconds next = never;
  for (const auto& [worker, line] : lines_)
    if (!line.to_scheduler.empty()) next = std::min(next, line.to_scheduler.begin()->first);
  return next;
}

Seconds Network::nextForWorker(const std::string& worker) const {
  const Line& line = lines_.at(worker);
  return line.to_worker.empty() ? never : line.to_worker.begin()->first;
}

void Network::happen(const Event& event, const std::string& worker) {
  if (event.accident != Accident::reset && event.accident != Accident::half_open) {
    troubles_.push_back({event, worker});
    return;
  }
  for (auto& [name, line] : lines_) {
    if (line.gone || !line.connected || (!worker.empty() && name != worker)) continue;
    if (event.accident == Accident::half_open) {
      line.dead_end = true;
      continue;
    }
    ++felt_[event.accident];
    breakLine(line, event.at);
  }
}

}  // namespace palpate::simulation
