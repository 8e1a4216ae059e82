#include "scheduler/service/spot_checks.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "common/base/assertion.hpp"
#include "scheduler/service/result_check.hpp"

namespace palpate {
namespace {

/// Results whose oddness is remembered, how many it takes to judge by them, and how often their
/// share is found anew.
constexpr std::size_t remembered_looks = 2048, looks_to_judge_by = 32, looks_between = 16;
/// Before there are enough: three times the worst that was measured (oddnessBeside).
constexpr double odd_at_first = 3;

bool isOfOneMachine(const wire::Provenance& a, const wire::Provenance& b) {
  return a.host() == b.host() && a.key() == b.key();
}

bool isOfOneProcess(const wire::Provenance& a, const wire::Provenance& b) {
  return a.worker() == b.worker();
}

/// Between 0 and 1, from the secret and the transition alone.
double lotOf(const ResultKey& key, const std::string& secret) {
  std::string text;
  const auto add = [&](std::int64_t number) {
    text.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  add(key.space);
  for (const LatticePoint& point : {key.target, key.parent})
    for (const std::int32_t coordinate : point) add(coordinate);
  std::array<unsigned char, crypto_generichash_BYTES_MIN> hash{};
  const auto bytes = [](const std::string& of) {
    return reinterpret_cast<const unsigned char*>(of.data());
  };
  const int failed = crypto_generichash(hash.data(), hash.size(), bytes(text), text.size(),
                                        bytes(secret), secret.size());
  PALPATE_ASSERT(failed == 0, "the lengths are right");
  std::uint64_t number = 0;
  std::memcpy(&number, hash.data(), sizeof number);
  return static_cast<double>(number >> 11) * 0x1p-53;
}

}  // namespace

Opinion opinionOf(const wire::Result& result, const wire::Provenance& giver) {
  const std::string bytes = ResultCheck::reproducibleBytes(result);
  return {giver, std::string(ContentId::of(bytes).bytes())};
}

SpotChecks::SpotChecks(const SpotCheckSettings& settings, std::string secret)
    // The same secret serves others: what they make of it tells nothing of the lots.
    : settings_(settings), secret_("spot checks" + std::move(secret)), odd_from_(odd_at_first) {}

SpotChecks::Picked SpotChecks::pick(const ResultKey& key, std::int64_t nth, const Look& look) {
  PALPATE_ASSERT(nth > 0, "results are counted from 1");
  ++results_;
  const bool odd = !look.failed && isOdd(look.oddness);
  const double share =
      std::max(settings_.share, settings_.share_of_first / static_cast<double>(nth));
  if (lotOf(key, secret_) < share) return Picked::by_lot;
  if (odd) return Picked::as_odd;
  const auto room =
      static_cast<std::int64_t>(settings_.share_of_failed * static_cast<double>(results_));
  if (!look.failed || failed_checked_ >= settings_.failed_at_least + room) return Picked::no;
  ++failed_checked_;
  return Picked::as_failed;
}

/// Beside the latest of this build: what is odd for one organ is not for another.
bool SpotChecks::isOdd(double oddness) {
  if (settings_.share_of_odd <= 0) return false;
  const bool odd = oddness > odd_from_;
  if (oddness_.size() < remembered_looks)
    oddness_.push_back(oddness);
  else
    oddness_[next_] = oddness;
  next_ = (next_ + 1) % remembered_looks;
  if (oddness_.size() >= looks_to_judge_by && next_ % looks_between == 0) {
    std::vector<double> sorted = oddness_;
    const auto rank = static_cast<std::ptrdiff_t>((1 - settings_.share_of_odd) *
                                                  static_cast<double>(sorted.size()));
    std::ranges::nth_element(sorted, sorted.begin() + rank);
    odd_from_ = sorted[static_cast<std::size_t>(rank)];
  }
  return odd;
}

std::optional<TransitionKey> SpotChecks::solverOfStart(std::string_view id) const {
  for (const auto& [key, check] : open_)
    if (!id.empty() && check.start.id == id) return check.start.solved_by;
  return std::nullopt;
}

void SpotChecks::open(const TransitionKey& key, Opinion first, Start start, bool disputed) {
  const bool fresh =
      open_.emplace(key, Check{{std::move(first)}, std::move(start), disputed}).second;
  PALPATE_ASSERT(fresh, "a result is checked once at a time");
  begun_.insert(key);
}

std::size_t SpotChecks::disputedCount() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(open_, [](const auto& check) { return check.second.disputed; }));
}

bool SpotChecks::isNew(const TransitionKey& key, const wire::Provenance& worker) const {
  return std::ranges::none_of(open_.at(key).opinions, [&](const Opinion& opinion) {
    return isOfOneProcess(opinion.giver, worker);
  });
}

bool SpotChecks::isElsewhere(const TransitionKey& key, const wire::Provenance& worker) const {
  return std::ranges::none_of(open_.at(key).opinions, [&](const Opinion& opinion) {
    return isOfOneMachine(opinion.giver, worker);
  });
}

std::optional<SpotChecks::Verdict> SpotChecks::hear(const TransitionKey& key, Opinion opinion) {
  PALPATE_ASSERT(isNew(key, opinion.giver), "nobody agrees with himself");
  Check& check = open_.at(key);
  const auto agrees = [&](const Opinion& other) { return other.digest == opinion.digest; };
  const bool decided = std::ranges::any_of(check.opinions, agrees);
  check.opinions.push_back(opinion);
  check.disputed = !decided;
  if (!decided) return std::nullopt;
  Verdict verdict;
  for (const Opinion& each : check.opinions)
    (agrees(each) ? verdict.right : verdict.wrong).push_back(each.giver);
  open_.erase(key);
  return verdict;
}

std::vector<KeptOut> keptOutBy(const SpotChecks::Verdict& verdict,
                               const std::vector<KeptOut>& before, const std::string& reason) {
  using Kind = KeptOut::Kind;
  constexpr int machines_of_a_key = 2;
  std::vector<KeptOut> kept_out;
  for (const wire::Provenance& liar : verdict.wrong) {
    const auto rightWith = [&](auto same) {
      return std::ranges::any_of(verdict.right,
                                 [&](const wire::Provenance& r) { return same(r, liar); });
    };
    const auto sameKey = [](const auto& a, const auto& b) { return a.key() == b.key(); };
    const auto known = std::ranges::count_if(
        before, [&](const KeptOut& other) { return other.who.key() == liar.key(); });
    Kind kind = rightWith(isOfOneMachine) ? Kind::process : Kind::machine;
    if (!liar.key().empty() && known >= machines_of_a_key && !rightWith(sameKey)) kind = Kind::key;
    kept_out.push_back({kind, liar, reason});
  }
  return kept_out;
}

}  // namespace palpate
