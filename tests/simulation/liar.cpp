#include "tests/simulation/liar.hpp"

#include "common/wire/wire.hpp"
#include "scheduler/service/result_check.hpp"
#include "scheduler/state/job_store.hpp"
#include "tests/support/lies.hpp"

namespace palpate::simulation {
namespace {

constexpr double share_of_lies = 0.02;

}  // namespace

bool Liar::falsify(wire::Result& result, std::string& payload) {
  // The rest state is known exactly, so a lie about it is refused at once.
  if (fromWire(result.target()) == LatticePoint{} || !random_.chance(share_of_lies)) return false;
  test::lies()[random_.below(test::lies().size())](result, payload);
  return true;
}

void Lies::note(const std::string& host, const wire::Result& lie) {
  told_.emplace(keyOf(lie), ResultCheck::reproducibleBytes(lie));
  hosts_.insert(host);
}

bool Lies::contain(const wire::Result& result) const {
  return !told_.empty() && told_.contains({keyOf(result), ResultCheck::reproducibleBytes(result)});
}

}  // namespace palpate::simulation
