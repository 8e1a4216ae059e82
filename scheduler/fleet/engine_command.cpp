#include "scheduler/fleet/engine_command.hpp"

#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <optional>
#include <thread>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/printable.hpp"
#include "scheduler/state/file_descriptor.hpp"

extern char** environ;

namespace palpate {
namespace {

/// In memory: what is written to it waits, however much it is, until somebody reads.
FileDescriptor memoryFile(const char* name) {
  FileDescriptor file(memfd_create(name, MFD_CLOEXEC));
  if (!file) throw failure("memfd_create: {}", errnoText());
  return file;
}

void writeWhole(const FileDescriptor& file, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = write(file.get(), text.data() + at, text.size() - at);
    if (written < 0 && errno != EINTR) throw failure("a file in memory: {}", errnoText());
    if (written > 0) at += static_cast<std::size_t>(written);
  }
  if (lseek(file.get(), 0, SEEK_SET) != 0) throw failure("a file in memory: {}", errnoText());
}

std::string readWhole(const FileDescriptor& file) {
  const off_t size = lseek(file.get(), 0, SEEK_END);
  if (size < 0) throw failure("a file in memory: {}", errnoText());
  std::string text(static_cast<std::size_t>(size), '\0');
  std::size_t length = 0;
  while (length < text.size()) {
    const ssize_t read =
        pread(file.get(), text.data() + length, text.size() - length, static_cast<off_t>(length));
    if (read < 0 && errno != EINTR) throw failure("a file in memory: {}", errnoText());
    if (read == 0) break;
    if (read > 0) length += static_cast<std::size_t>(read);
  }
  text.resize(length);
  return text;
}

/// The program's process, with these three files as its standard ones.
pid_t spawn(const std::vector<std::string>& words, const FileDescriptor& in,
            const FileDescriptor& out, const FileDescriptor& err) {
  std::vector<std::string> copies = words;
  std::vector<char*> arguments;
  for (std::string& word : copies) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  if (posix_spawn_file_actions_init(&files) != 0) throw failure("posix_spawn: no memory");
  int error = 0, number = 0;
  for (const FileDescriptor* file : {&in, &out, &err})
    if (error == 0) error = posix_spawn_file_actions_adddup2(&files, file->get(), number++);
  pid_t child = -1;
  if (error == 0)
    error = posix_spawnp(&child, arguments[0], &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (error == ENOENT)
    throw badInput("{} is not installed here, or not in $PATH (Debian: slurm-client)", words[0]);
  errno = error;
  if (error != 0) throw failure("{} cannot be run: {}", words[0], errnoText());
  return child;
}

/// Its status as waitpid has it; nothing when it did not end in time.
std::optional<int> endOf(pid_t child, std::chrono::seconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  for (;;) {
    int status = 0;
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return status;
    if (ended < 0 && errno != EINTR) throw failure("waitpid: {}", errnoText());
    if (std::chrono::steady_clock::now() > deadline) return std::nullopt;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace

Ran runOfEngine(const std::vector<std::string>& words, const std::string& input,
                std::chrono::seconds patience) {
  PALPATE_ASSERT(!words.empty(), "the first word is the program");
  const FileDescriptor in = memoryFile("stdin"), out = memoryFile("stdout"),
                       err = memoryFile("stderr");
  writeWhole(in, input);
  const pid_t child = spawn(words, in, out, err);
  const auto status = endOf(child, patience);
  if (!status) {
    kill(child, SIGKILL);
    while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
    // sbatch tries again by itself, for minutes, and says why.
    const std::string said = printable(readWhole(err), longest_reason);
    throw failure("{} did not answer within {} s{}{}", words[0], patience.count(),
                  said.empty() ? "" : " but: ", said);
  }
  if (!WIFEXITED(*status)) throw failure("{} was ended by signal {}", words[0], WTERMSIG(*status));
  return {WEXITSTATUS(*status), readWhole(out), readWhole(err)};
}

}  // namespace palpate
