#include "scheduler/fleet/ssh.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/error.hpp"
#include "common/base/number_in.hpp"

namespace palpate {
namespace {

/// A connection that lasted at least this long counts as a success.
constexpr std::chrono::minutes long_enough{2};

struct HostWords {
  std::string name;
  std::string workers;  ///< a number, or a shell expression that gives one
};

HostWords parsed(const std::string& host) {
  HostWords words{host, "$(nproc)"};
  if (const auto colon = host.rfind(':'); colon != std::string::npos) {
    const std::string number = host.substr(colon + 1);
    if (numberIn<int>(number).value_or(0) < 1)
      throw badInput("{}: give a number of workers, at least 1, after the colon", host);
    words = {host.substr(0, colon), number};
  }
  // Refuse a name that begins with a dash, because ssh would read it as an option.
  if (words.name.empty() || words.name.front() == '-')
    throw badInput("\"{}\" is not a machine: give HOST, USER@HOST or HOST:WORKERS", host);
  return words;
}

std::vector<std::string> wordsFor(const SshOptions& options, const std::string& host) {
  const HostWords words = parsed(host);
  // -tt forces a terminal, so that the remote programs get a signal when the connection is lost.
  std::vector<std::string> command = {
      "/usr/bin/env", "ssh", "-n", "-tt", "-o", "BatchMode=yes", "-o", "ServerAliveInterval=15"};
  command.insert(command.end(), options.more.begin(), options.more.end());
  command.push_back(words.name);
  command.push_back(fmt::format("exec {} -j {}", fmt::join(options.command, " "), words.workers));
  return command;
}

/// Returns the likely cause of an exit code, as a prefix for the log.
const char* meaningOf(const std::string& how) {
  if (how == "exit code 255") return "ssh cannot connect; ";
  if (how == "exit code 127")
    return "palpate (option --program) or one of its libraries is missing on this machine; ";
  return "";
}

}  // namespace

SshHosts::SshHosts(const SshOptions& options, const std::vector<std::string>& hosts) {
  for (const std::string& host : hosts)
    hosts_.push_back({.name = host, .command = wordsFor(options, host)});
}

void SshHosts::checkHost(const std::string& host) { parsed(host); }

std::string SshHosts::told(const SshOptions& options, const std::string& host) {
  std::string text;
  for (const std::string& word : wordsFor(options, host))
    text += (text.empty() ? "" : " ") +
            (word.find(' ') == std::string::npos ? word : '\'' + word + '\'');
  return text;
}

void SshHosts::keep(Time now) {
  for (Host& host : hosts_) {
    if (host.connection && !host.connection->running()) {
      const std::string how = host.connection->how();
      host.connection.reset();
      host.done = how == "exit code 0";
      if (host.done) continue;
      if (now - host.begun > long_enough) host.retry.succeeded();
      host.retry.failed(now);
      spdlog::warn("{}: ssh ended with {} ({}see its messages above); trying again in {} s",
                   host.name, how, meaningOf(how), host.retry.pause().count());
    }
    if (host.connection || host.done || !host.retry.over(now)) continue;
    host.connection = std::make_unique<ChildProcess>(host.command);
    host.begun = now;
    spdlog::info("{}: starting workers", host.name);
  }
}

std::size_t SshHosts::running() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(hosts_, [](const Host& host) { return host.connection != nullptr; }));
}

bool SshHosts::done() const {
  return std::ranges::all_of(hosts_, [](const Host& host) { return host.done; });
}

void SshHosts::terminate(std::chrono::milliseconds grace) {
  for (Host& host : hosts_) {
    if (host.connection) host.connection->terminate(grace);
    host.connection.reset();
  }
}

}  // namespace palpate
