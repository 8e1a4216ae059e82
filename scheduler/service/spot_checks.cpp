#include "scheduler/service/spot_checks.hpp"

#include <algorithm>
#include <cstring>

#include "common/base/assertion.hpp"
#include "scheduler/service/lease_seal.hpp"
#include "scheduler/service/result_check.hpp"

namespace palpate {
namespace {

/// Number of results whose oddness is remembered, number that is needed to set the threshold, and
/// number between two updates of the threshold.
constexpr std::size_t remembered_looks = 2048, looks_to_judge_by = 32, looks_between = 16;
/// Threshold before the first update: three times the largest measured oddness (oddnessBeside).
constexpr double odd_at_first = 3;

Apart apartFrom(const wire::Provenance& a, const wire::Provenance& b) {
  if (a.worker() == b.worker()) return Apart::same_process;
  if (a.key() != b.key()) return Apart::other_key;
  return a.host() == b.host() ? Apart::same_machine : Apart::other_machine;
}

bool isOfOneMachine(const wire::Provenance& a, const wire::Provenance& b) {
  return a.host() == b.host() && a.key() == b.key();
}

/// Returns a pseudo-random number in [0, 1) that depends only on the secret and the transition.
double lotOf(const ResultKey& key, const std::string& secret) {
  std::uint64_t number = 0;
  std::memcpy(&number, keyedHash(bytesOf(key), secret).data(), sizeof number);
  return static_cast<double>(number >> 11) * 0x1p-53;
}

KeptOut::Kind kindKeptOut(const wire::Provenance& liar, const SpotChecks::Verdict& verdict,
                          const std::vector<KeptOut>& before,
                          const std::optional<PublicKey>& trusted_key) {
  using Kind = KeptOut::Kind;
  constexpr std::size_t machines_of_a_key = 2;
  constexpr std::ptrdiff_t processes_of_a_machine = 2, any_of_a_key = 4;
  std::set<std::string> machines;
  for (const KeptOut& other : before)
    if (other.kind == Kind::machine && other.who.key() == liar.key() &&
        other.who.host() != liar.host())
      machines.insert(other.who.host());
  const auto of_key = std::ranges::count_if(
      before, [&](const KeptOut& other) { return other.who.key() == liar.key(); });
  const bool is_trusted = trusted_key && PublicKey::fromBytes(liar.key()) == trusted_key;
  const bool has_key = !liar.key().empty() && !is_trusted;
  const bool nobody_is_right = std::ranges::none_of(
      verdict.right, [&](const wire::Provenance& r) { return r.key() == liar.key(); });
  if (has_key &&
      (of_key >= any_of_a_key || (machines.size() >= machines_of_a_key && nobody_is_right)))
    return Kind::key;
  const bool machine_is_right = std::ranges::any_of(
      verdict.right, [&](const wire::Provenance& r) { return isOfOneMachine(r, liar); });
  const auto processes = std::ranges::count_if(
      before, [&](const KeptOut& other) { return isOfOneMachine(other.who, liar); });
  return machine_is_right && processes < processes_of_a_machine ? Kind::process : Kind::machine;
}

}  // namespace

Opinion opinionOf(const wire::Result& result, const wire::Provenance& giver) {
  const std::string bytes = ResultCheck::reproducibleBytes(result);
  return {giver, std::string(ContentId::of(bytes).bytes())};
}

SpotChecks::SpotChecks(const SpotCheckSettings& settings, std::string secret)
    // The secret has other uses too. Because of the prefix, their outputs do not reveal which
    // results are drawn by lot.
    : settings_(settings), secret_("spot checks" + std::move(secret)), odd_from_(odd_at_first) {}

bool SpotChecks::pick(const ResultKey& key, const Look& look) {
  ++results_;
  if (settings_.share <= 0) return false;
  if (isSuspect(look)) return true;
  const auto results = static_cast<double>(results_);
  const auto suspects = static_cast<double>(failed_picked_ + odd_picked_);
  // Failures and odd results use up part of the share. The rest is drawn by lot, but at least half
  // of the share.
  const double left = (settings_.share * results - suspects) / (results - suspects);
  return lotOf(key, secret_) < std::max(settings_.share / 2, left);
}

/// Returns true for a failure or an odd result, unless enough results of its kind were picked.
/// Without this limit, a body with many failures or odd results would be solved twice, and failures
/// would leave no room for odd results.
bool SpotChecks::isSuspect(const Look& look) {
  if (!look.failed && !isOdd(look.oddness)) return false;
  std::int64_t& picked = look.failed ? failed_picked_ : odd_picked_;
  const double most = std::max(static_cast<double>(settings_.suspects_at_least),
                               settings_.share / 4 * static_cast<double>(results_));
  if (static_cast<double>(picked) + 1 > most) return false;
  ++picked;
  return true;
}

/// Compares an oddness with those of the latest results, because organs differ in how odd their
/// results are. The threshold is exceeded by share / 8 of the results, half of the share / 4 that
/// may be picked. This leaves room for the results of a worker that lies.
bool SpotChecks::isOdd(double oddness) {
  const bool odd = oddness > odd_from_;
  if (oddness_.size() < remembered_looks)
    oddness_.push_back(oddness);
  else
    oddness_[next_] = oddness;
  next_ = (next_ + 1) % remembered_looks;
  if (oddness_.size() >= looks_to_judge_by && next_ % looks_between == 0) {
    std::vector<double> sorted = oddness_;
    const auto rank = std::min(
        static_cast<std::size_t>((1 - settings_.share / 8) * static_cast<double>(sorted.size())),
        sorted.size() - 1);
    std::ranges::nth_element(sorted, sorted.begin() + static_cast<std::ptrdiff_t>(rank));
    odd_from_ = sorted[rank];
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
  PALPATE_ASSERT(fresh, "a result must have only one check at a time");
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

/// Returns the members of the crowd that gave an opinion.
Crowd SpotChecks::giversAmong(const ResultKey& key, const Crowd& crowd) const {
  Crowd givers;
  for (const Opinion& opinion : open_.at(key).opinions) {
    const wire::Provenance& giver = opinion.giver;
    if (crowd.keys.contains(giver.key())) givers.keys.insert(giver.key());
    if (crowd.machines.contains({giver.key(), giver.host()}))
      givers.machines.emplace(giver.key(), giver.host());
  }
  return givers;
}

Apart SpotChecks::wanted(const ResultKey& key, const Crowd& at_work, const Crowd& may_come) const {
  if (giversAmong(key, at_work).keys.size() < at_work.keys.size()) return Apart::other_key;
  const bool all_asked = giversAmong(key, may_come).machines.size() == may_come.machines.size();
  return isDisputed(key) && all_asked ? Apart::same_machine : Apart::other_machine;
}

bool SpotChecks::contradicts(const ResultKey& key, const Opinion& opinion) const {
  return std::ranges::any_of(open_.at(key).opinions, [&](const Opinion& earlier) {
    return apartFrom(earlier.giver, opinion.giver) == Apart::same_process &&
           earlier.digest != opinion.digest;
  });
}

std::optional<SpotChecks::Verdict> SpotChecks::hear(const ResultKey& key, const Opinion& opinion) {
  PALPATE_ASSERT(apart(key, opinion.giver) != Apart::same_process,
                 "a worker must solve a checked transition only once");
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
                               const std::vector<KeptOut>& before, const std::string& reason,
                               const std::optional<PublicKey>& trusted_key) {
  std::vector<KeptOut> kept_out;
  for (const wire::Provenance& liar : verdict.wrong)
    kept_out.push_back({kindKeptOut(liar, verdict, before, trusted_key), liar, reason});
  return kept_out;
}

}  // namespace palpate
