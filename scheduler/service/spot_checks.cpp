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

Apart apartFrom(const wire::Provenance& a, const wire::Provenance& b) {
  if (a.worker() == b.worker()) return Apart::same_process;
  if (a.key() != b.key()) return Apart::other_key;
  return a.host() == b.host() ? Apart::same_machine : Apart::same_key;
}

bool isOfOneMachine(const wire::Provenance& a, const wire::Provenance& b) {
  return a.host() == b.host() && a.key() == b.key();
}

bool hasKeyOfOneOf(const wire::Provenance& who, const std::vector<wire::Provenance>& others) {
  return std::ranges::any_of(others, [&](const auto& other) { return other.key() == who.key(); });
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
  if (odd && pickOdd()) return Picked::as_odd;
  if (look.failed &&
      pickWithin(settings_.share_of_failed, settings_.failed_at_least, failed_picked_))
    return Picked::as_failed;
  return Picked::no;
}

bool SpotChecks::pickStart(const ResultKey& key) { return !begun_.contains(key) && pickOdd(); }

bool SpotChecks::pickWithin(double share, std::int64_t at_least, std::int64_t& picked) const {
  const auto most = static_cast<std::int64_t>(share * static_cast<double>(results_));
  if (picked >= std::max(at_least, most)) return false;
  ++picked;
  return true;
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

std::optional<ResultKey> SpotChecks::solverOfStart(std::string_view id) const {
  for (const auto& [key, check] : open_)
    if (!id.empty() && check.start.id == id) return check.start.solved_by;
  return std::nullopt;
}

void SpotChecks::open(const ResultKey& key, Opinion first, Start start, bool disputed) {
  const bool fresh =
      open_.emplace(key, Check{{std::move(first)}, std::move(start), disputed}).second;
  PALPATE_ASSERT(fresh, "a result is checked once at a time");
  begun_.insert(key);
}

std::size_t SpotChecks::disputedCount() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(open_, [](const auto& check) { return check.second.disputed; }));
}

Apart SpotChecks::apart(const ResultKey& key, const wire::Provenance& worker) const {
  Apart least = Apart::other_key;
  for (const Opinion& opinion : open_.at(key).opinions)
    least = std::min(least, apartFrom(opinion.giver, worker));
  return least;
}

Apart SpotChecks::wanted(const ResultKey& key, const Crowd& crowd) const {
  std::set<std::string> keys;
  std::set<std::pair<std::string, std::string>> machines;
  for (const Opinion& opinion : open_.at(key).opinions) {
    const wire::Provenance& giver = opinion.giver;
    if (crowd.keys.contains(giver.key())) keys.insert(giver.key());
    if (crowd.machines.contains({giver.key(), giver.host()}))
      machines.emplace(giver.key(), giver.host());
  }
  if (keys.size() < crowd.keys.size()) return Apart::other_key;
  return machines.size() < crowd.machines.size() ? Apart::same_key : Apart::same_machine;
}

bool SpotChecks::contradicts(const ResultKey& key, const Opinion& opinion) const {
  return std::ranges::any_of(open_.at(key).opinions, [&](const Opinion& earlier) {
    return apartFrom(earlier.giver, opinion.giver) == Apart::same_process &&
           earlier.digest != opinion.digest;
  });
}

std::optional<SpotChecks::Verdict> SpotChecks::hear(const ResultKey& key, const Opinion& opinion) {
  PALPATE_ASSERT(apart(key, opinion.giver) != Apart::same_process, "nobody agrees with himself");
  Check& check = open_.at(key);
  check.opinions.push_back(opinion);
  Verdict verdict;
  for (const Opinion& each : check.opinions)
    (each.digest == opinion.digest ? verdict.right : verdict.wrong).push_back(each.giver);
  check.disputed = !isDecided(verdict);
  if (check.disputed) return std::nullopt;
  open_.erase(key);
  return verdict;
}

bool SpotChecks::isDecided(const Verdict& verdict) const {
  const std::vector<wire::Provenance>&right = verdict.right, &wrong = verdict.wrong;
  if (right.size() < 2) return false;
  const auto differ = [&](const auto& who) { return who.key() != right.front().key(); };
  const auto isTrusted = [&](const auto& who) {
    return settings_.trusted_key && PublicKey::fromBytes(who.key()) == settings_.trusted_key;
  };
  return std::ranges::any_of(right, differ) || std::ranges::any_of(right, isTrusted) ||
         std::ranges::none_of(wrong, differ);
}

std::vector<KeptOut> keptOutBy(const SpotChecks::Verdict& verdict,
                               const std::vector<KeptOut>& before, const std::string& reason) {
  using Kind = KeptOut::Kind;
  constexpr std::size_t machines_of_a_key = 2;
  constexpr std::ptrdiff_t processes_of_a_machine = 2;
  std::vector<KeptOut> kept_out;
  for (const wire::Provenance& liar : verdict.wrong) {
    std::set<std::string> others;
    for (const KeptOut& other : before)
      if (other.kind == Kind::machine && other.who.key() == liar.key() &&
          other.who.host() != liar.host())
        others.insert(other.who.host());
    const bool machine_is_right = std::ranges::any_of(
        verdict.right, [&](const wire::Provenance& r) { return isOfOneMachine(r, liar); });
    const auto processes = std::ranges::count_if(
        before, [&](const KeptOut& other) { return isOfOneMachine(other.who, liar); });
    const bool one_of_many = machine_is_right && processes < processes_of_a_machine;
    Kind kind = one_of_many ? Kind::process : Kind::machine;
    if (!liar.key().empty() && others.size() >= machines_of_a_key &&
        !hasKeyOfOneOf(liar, verdict.right))
      kind = Kind::key;
    kept_out.push_back({kind, liar, reason});
  }
  return kept_out;
}

}  // namespace palpate
