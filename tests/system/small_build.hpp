#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/command.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/system/process.hpp"

namespace palpate::test {

/// A build that takes a few seconds, with the real programs.
struct SmallBuild : testing::Test {
  TemporaryDirectory directory;

  /// `cells`: number of cells along an edge of the cube.
  explicit SmallBuild(int cells = 3) : cells_(cells) { writeScene(directory.path(), 1300); }

  /// A cube with two active nodes and 257 lattice points around each. Tool forces grow beyond
  /// max_force on one side.
  void writeScene(const std::filesystem::path& where, double c10) const {
    writeGmsh22(cubeMesh(0.1, cells_), where / "cube.msh");
    std::ofstream(where / "cube.toml")
        << "name = \"cube\"\nmesh = \"cube.msh\"\n"
        << "[material]\nlaw = \"mooney-rivlin\"\nc10 = " << c10 << "\nc01 = 1280.0\n"
        << "[fixed]\nbelow = { axis = \"x\", fraction = 0.15 }\n"
        << "[[active]]\nname = \"tip\"\nnear = [0.1, 0.0667, 0.0667]\n"
        << "[[active]]\nname = \"corner\"\nnear = [0.1, 0.1, 0.1]\n"
        << "[workspace]\nradius = 0.04\nspacing = 0.01\nmax_force = 2.0\n";
  }

  std::unique_ptr<Process> start(const std::string& program, std::vector<std::string> arguments) {
    return std::make_unique<Process>(program, std::move(arguments), directory.path());
  }
  std::unique_ptr<Process> startBuild(const std::string& out, const std::string& workers) {
    return start("palpate-scheduler", {"build", "cube.toml", "-o", out, "-j", workers});
  }
  /// Expects the exit code of a finished build, in which some points may have failed.
  static void expectFinished(Process& process) {
    const int code = process.wait();
    EXPECT_TRUE(code == 0 || code == 3) << code << "\n" << process.output();
  }
  /// The dataset of an undisturbed build of the scene. Tests of a program share it for equal
  /// scenes, meshes and kernel families.
  std::string undisturbed() {
    static std::map<std::string, std::string> known;
    std::string key = contentOf(directory / "cube.toml") + contentOf(directory / "cube.msh");
    for (const char* chosen : {"PALPATE_KERNELS", "OPENBLAS_CORETYPE"})
      if (const char* value = std::getenv(chosen)) key += value + std::string(" ");
    std::string& dataset = known[key];
    if (!dataset.empty()) return dataset;
    auto build = startBuild("undisturbed.h5", "1");
    expectFinished(*build);
    return dataset = contentOf(directory / "undisturbed.h5");
  }
  /// Runs `palpate` with these arguments in the folder of the build.
  CommandResult palpate(const std::string& arguments) const {
    return runCommand("(cd '" + directory.path().string() + "' && PALPATE_KEYS='" +
                      (directory / "keys").string() + "' " PALPATE_BIN_DIR "/palpate " + arguments +
                      ")");
  }
  /// Returns the output of `palpate`; expects exit code `code`.
  std::string told(const std::string& arguments, int code = 0) const {
    const CommandResult done = palpate(arguments);
    EXPECT_EQ(done.exit_code, code) << arguments << ": " << done.output;
    return done.output;
  }
  /// A scheduler, on a free port of this machine by default.
  std::unique_ptr<Process> serve(const std::string& state, const std::string& out,
                                 const std::vector<std::string>& more = {},
                                 const std::string& listen = "tcp://127.0.0.1:*") {
    std::vector<std::string> words = {"serve",   "cube.toml", "--listen", listen,
                                      "--state", state,       "-o",       out};
    words.insert(words.end(), more.begin(), more.end());
    return start("palpate-scheduler", words);
  }
  std::uintmax_t journaled(const std::string& state) const {
    std::error_code none_yet;
    const auto size =
        std::filesystem::file_size(directory / state / "segment-000001.dat", none_yet);
    return none_yet ? 0 : size;
  }
  /// Waits until the journal has grown by `bytes`. False if the process ended before.
  bool journalGrows(Process& process, const std::string& state, std::uintmax_t bytes) const {
    const std::uintmax_t goal = journaled(state) + bytes;
    EXPECT_TRUE(eventually([&] { return !process.running() || journaled(state) >= goal; }));
    return process.running();
  }
  std::string endpointIn(const std::string& state) const {
    EXPECT_TRUE(eventually([&] { return !endpointAnnouncedIn(directory / state).empty(); }));
    return endpointAnnouncedIn(directory / state);
  }
  /// Worker processes that have the keys of this test in their environment, whoever started them.
  std::vector<pid_t> workers() const {
    const std::string keys = "PALPATE_KEYS=" + (directory / "keys").string();
    std::vector<pid_t> all;
    for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
      const int pid = std::atoi(entry.path().filename().c_str());
      if (pid <= 0 || contentOf(entry.path() / "comm") != "palpate-worker\n") continue;
      const std::string environment = '\0' + contentOf(entry.path() / "environ");
      if (environment.find('\0' + keys + '\0') != std::string::npos) all.push_back(pid);
    }
    return all;
  }

 private:
  int cells_;
};

}  // namespace palpate::test
