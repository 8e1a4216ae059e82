#include "common/keys/admission.hpp"

#include <spdlog/spdlog.h>

#include "common/base/error.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds read_again_after{1};

}  // namespace

Admission::Admission(KeyFolder folder) : folder_(std::move(folder)), own_(folder_.own().open()) {
  read();
}

void Admission::read() {
  read_at_ = Clock::now();
  std::map<PublicKey, Roles> roles;
  for (const AllowedKey& key : folder_.allowed()) roles[key.key] = key.roles;
  roles[own_] = Roles::all;
  roles_ = std::move(roles);
}

Roles Admission::rolesOf(const PublicKey& key) {
  const std::lock_guard lock(mutex_);
  if (Clock::now() - read_at_ >= read_again_after) {
    std::string trouble;
    try {
      read();
    } catch (const Error& error) {
      trouble = error.what();
    }
    if (!trouble.empty() && trouble != trouble_)
      spdlog::warn("{}; those who were let in before still are", trouble);
    trouble_ = trouble;
  }
  const auto found = roles_.find(key);
  return found == roles_.end() ? Roles::none : found->second;
}

}  // namespace palpate
