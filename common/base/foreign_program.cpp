#include "common/base/foreign_program.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>

#include "common/base/child_process.hpp"
#include "common/base/error.hpp"
#include "common/base/file_descriptor.hpp"
#include "common/base/program.hpp"
#include "common/base/text.hpp"
#include "common/base/whole_file.hpp"

namespace palpate {
namespace {

/// Returns a descriptor of `file` with a number above 2. `file` itself may have a lower number if
/// this process was started with stdin, stdout or stderr closed.
FileDescriptor beyondStandard(FileDescriptor file) {
  if (file.get() > STDERR_FILENO) return file;
  FileDescriptor other(fcntl(file.get(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
  if (!other) throw failure("cannot duplicate a file descriptor: {}", errnoText());
  return other;
}

/// Makes a file in memory. Unlike a pipe, it accepts any amount of data before the data is read.
FileDescriptor memoryFile(const char* name) {
  FileDescriptor file(memfd_create(name, MFD_CLOEXEC));
  if (!file) throw failure("cannot make a file in memory: {}", errnoText());
  return beyondStandard(std::move(file));
}

std::string readWhole(const FileDescriptor& file) {
  std::string text;
  std::array<char, 1 << 16> part{};
  for (;;) {
    const ssize_t read = pread(file.get(), part.data(), part.size(), std::ssize(text));
    if (read < 0 && errno == EINTR) continue;
    if (read < 0) throw failure("cannot read a program's output: {}", errnoText());
    if (read == 0) return text;
    text.append(part.data(), static_cast<std::size_t>(read));
  }
}

/// Waits until exec has succeeded or failed in the child. Returns the errno of a failed exec, or 0
/// if the program runs.
int errorOfStart(const FileDescriptor& pipe) {
  int error = 0;
  ssize_t count = 0;
  do count = read(pipe.get(), &error, sizeof error);
  while (count < 0 && errno == EINTR);
  return count == sizeof error ? error : 0;
}

pid_t start(const ForeignProgram& program, const std::array<int, 3>& files) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw failure("cannot make a pipe: {}", errnoText());
  const FileDescriptor reading = beyondStandard(FileDescriptor(ends[0]));
  FileDescriptor writing = beyondStandard(FileDescriptor(ends[1]));
  const pid_t child = startChild(program.words, {.files = files, .error_pipe = writing.get()});
  writing = FileDescriptor();
  const int error = errorOfStart(reading);
  if (error == 0) return child;
  waitFor(child);
  if (error == ENOENT)
    throw badInput("{} is not installed here, or not in $PATH (Debian: {})", program.words[0],
                   program.package);
  errno = error;
  throw failure("{} cannot be run: {}", program.words[0], errnoText());
}

enum class WhyEnded : std::uint8_t { by_itself, out_of_patience, interrupted };

/// Time for an interrupted program to remove its temporary files.
constexpr std::chrono::seconds time_to_tidy{2};

/// Waits for the end of the child and sets `status` as waitpid does. Kills the child if it takes
/// longer than `patience`. On an interrupt, if `heeds_interrupts` is set, terminates it (SIGTERM)
/// and kills it if it does not end. Returns why the child ended.
WhyEnded endOf(pid_t child, const ForeignProgram& program, int& status) {
  auto deadline = std::chrono::steady_clock::now() + program.patience;
  WhyEnded why = WhyEnded::by_itself;
  for (;;) {
    const pid_t ended = waitpid(child, &status, WNOHANG);
    if (ended == child) return why;
    if (ended < 0 && errno != EINTR) throw failure("cannot wait for a program: {}", errnoText());
    if (why == WhyEnded::by_itself && program.heeds_interrupts && interrupted()) {
      why = WhyEnded::interrupted;
      kill(-child, SIGTERM);  // also ends the child's own children
      deadline = std::chrono::steady_clock::now() + time_to_tidy;
    }
    if (std::chrono::steady_clock::now() > deadline) {
      kill(-child, SIGKILL);
      status = waitFor(child);
      return why == WhyEnded::interrupted ? why : WhyEnded::out_of_patience;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

}  // namespace

Ran runToItsEnd(const ForeignProgram& program) {
  const std::string& name = program.words.at(0);
  const FileDescriptor in = memoryFile("stdin"), out = memoryFile("stdout"),
                       err = memoryFile("stderr");
  if (!writeAt(in.get(), 0, program.input)) throw failure("cannot write stdin: {}", errnoText());
  const pid_t child = start(program, {in.get(), out.get(), err.get()});
  int status = 0;
  switch (endOf(child, program, status)) {
    case WhyEnded::interrupted:
      throw Error(ExitCode::interrupted, fmt::format("interrupted while {} was running", name));
    case WhyEnded::out_of_patience: {
      // Report the program's own messages: sbatch, for example, retries for minutes, and prints
      // why.
      const std::string said = printable(readWhole(err), longest_reason);
      throw failure("{} did not finish within {} s{}{}", name, program.patience.count(),
                    said.empty() ? "" : "; it printed: ", said);
    }
    case WhyEnded::by_itself: break;
  }
  if (!WIFEXITED(status)) throw failure("{} was killed by signal {}", name, WTERMSIG(status));
  return {WEXITSTATUS(status), readWhole(out), readWhole(err)};
}

std::string installedPath(const std::string& program) {
  if (program.find('/') != std::string::npos)
    return access(program.c_str(), X_OK) == 0 ? program : "";
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (std::string file = std::filesystem::path(folder) / program; access(file.c_str(), X_OK) == 0)
      return file;
  return "";
}

}  // namespace palpate
