#include "common/keys/admission.hpp"

#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include "common/base/error.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds look_again_after{1};

}  // namespace

Admission::Admission(KeyFolder folder, bool tells)
    : folder_(std::move(folder)), tells_(tells), own_(folder_.own().open()), looked_(Clock::now()) {
  read();
}

Admission::Stamp Admission::stamp() const {
  struct stat info {};
  if (stat(folder_.allowedFile().c_str(), &info) != 0) return {};
  return {info.st_ino, info.st_size, info.st_mtim.tv_sec, info.st_mtim.tv_nsec};
}

void Admission::read() {
  // Before the file: what changes meanwhile is seen the next time.
  read_ = stamp();
  std::map<PublicKey, Roles> roles;
  for (const AllowedKey& key : folder_.allowed()) roles[key.key] = key.roles;
  roles[own_] = Roles::all();
  roles_ = std::move(roles);
}

Roles Admission::rolesOf(const PublicKey& key) {
  if (const auto now = Clock::now(); now - looked_ >= look_again_after) {
    looked_ = now;
    try {
      if (stamp() != read_) read();
    } catch (const Error& error) {
      if (tells_) spdlog::warn("{}; those who were let in before still are", error.what());
    }
  }
  const auto found = roles_.find(key);
  return found == roles_.end() ? Roles() : found->second;
}

}  // namespace palpate
