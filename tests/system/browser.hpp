#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <map>
#include <nlohmann/json.hpp>

#include "common/base/error.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/system/process.hpp"

namespace palpate::test {

/// Headless Chromium with real input, controlled over the pipes of its DevTools protocol.
class Browser {
 public:
  /// 1280 x 800 pixels, drawn in software.
  explicit Browser(const std::vector<std::string>& options = {}) {
    for (const char* pipe : {"in", "out"})
      if (mkfifo((directory_ / pipe).c_str(), 0600) != 0) throw failure("mkfifo: {}", errnoText());
    std::string line =
        "exec chromium --headless --no-sandbox --disable-gpu --enable-unsafe-swiftshader "
        "--disable-quic --no-first-run --disable-background-networking --disable-component-update "
        "--disable-sync --remote-debugging-pipe --window-size=1280,800 --user-data-dir=profile";
    for (const std::string& option : options) line += " " + option;
    process_ = std::make_unique<Process>(
        "/bin/sh", std::vector<std::string>{"-c", line + " about:blank 3<in 4>out"},
        directory_.path());
    in_ = open((directory_ / "in").c_str(), O_WRONLY | O_CLOEXEC);
    out_ = open((directory_ / "out").c_str(), O_RDONLY | O_CLOEXEC);
    const nlohmann::json page = send("Target.createTarget", {{"url", "about:blank"}});
    session_ = send("Target.attachToTarget", {{"targetId", page.at("targetId")}, {"flatten", true}})
                   .at("sessionId");
    show({1280, 800});
  }
  ~Browser() {
    process_.reset();
    close(in_);
    close(out_);
  }
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Size of the window in CSS pixels, device pixels per CSS pixel (`scale`), and whether it is a
  /// phone.
  struct Window {
    int width = 0, height = 0;
    double scale = 1;
    bool is_phone = false;
  };
  void show(const Window& window) {
    send("Emulation.setDeviceMetricsOverride", {{"width", window.width},
                                                {"height", window.height},
                                                {"deviceScaleFactor", window.scale},
                                                {"mobile", window.is_phone}});
    send("Emulation.setTouchEmulationEnabled", {{"enabled", window.is_phone}});
  }
  /// Runs a script before all other scripts of pages opened from now on.
  void runFirst(const std::string& script) {
    send("Page.enable");
    send("Page.addScriptToEvaluateOnNewDocument", {{"source", script}});
  }

  nlohmann::json send(const std::string& method,
                      const nlohmann::json& parameters = nlohmann::json::object()) {
    nlohmann::json message = {{"id", ++sent_}, {"method", method}, {"params", parameters}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    if (write(in_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      throw failure("Chromium takes no messages: {}", process_->output());
    for (;;) {
      const nlohmann::json answer = receive();
      if (answer.value("id", 0) != sent_) continue;  // an event
      if (!answer.contains("result")) throw failure("{}: {}", method, answer.dump());
      return answer.at("result");
    }
  }
  void go(const std::string& file) { send("Page.navigate", {{"url", "file://" + file}}); }
  /// The value of an expression in the page; waits for promises.
  nlohmann::json valueOf(const std::string& expression) {
    const nlohmann::json answer =
        send("Runtime.evaluate",
             {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
    if (answer.contains("exceptionDetails")) throw failure("{}", answer.dump());
    return answer.at("result").value("value", nlohmann::json());
  }
  bool becomesTrue(const std::string& expression) {
    return eventually([&] { return valueOf("!!(" + expression + ")") == true; });
  }
  /// `what`: "mouseMoved", "mousePressed" or "mouseReleased" (left button), or "mouseWheel".
  void mouse(const std::string& what, double x, double y, double wheel = 0) {
    send("Input.dispatchMouseEvent", {{"type", what},
                                      {"x", x},
                                      {"y", y},
                                      {"button", what == "mouseWheel" ? "none" : "left"},
                                      {"clickCount", 1},
                                      {"deltaX", 0},
                                      {"deltaY", wheel}});
  }
  /// `what`: "touchStart" or "touchMove" with the fingers' positions, or "touchEnd" for all.
  void touch(const std::string& what, const std::vector<std::pair<double, double>>& fingers = {}) {
    nlohmann::json points = nlohmann::json::array();
    for (const auto& [x, y] : fingers)
      points.push_back({{"x", x}, {"y", y}, {"id", points.size()}});
    send("Input.dispatchTouchEvent", {{"type", what}, {"touchPoints", points}});
  }
  /// Processor time of each process of Chromium (renderer, page, ...), seconds.
  std::map<pid_t, double> processorSeconds() const {
    std::map<pid_t, double> seconds;
    addProcessorSecondsOf(process_->pid(), seconds);
    return seconds;
  }

 private:
  nlohmann::json receive() {
    std::size_t end = 0;
    while ((end = received_.find('\0')) == std::string::npos) {
      char buffer[65536];
      const ssize_t count = read(out_, buffer, sizeof buffer);
      if (count <= 0) throw failure("Chromium went away: {}", process_->output());
      received_.append(buffer, static_cast<std::size_t>(count));
    }
    nlohmann::json message = nlohmann::json::parse(received_.substr(0, end));
    received_.erase(0, end + 1);
    return message;
  }
  static void addProcessorSecondsOf(pid_t pid, std::map<pid_t, double>& seconds) {
    const std::string folder = "/proc/" + std::to_string(pid);
    const std::string stat = contentOf(folder + "/stat");
    std::istringstream fields(stat.substr(std::min(stat.size(), stat.rfind(')') + 2)));
    std::string skipped;
    double user = 0, system = 0;
    for (int n = 0; n < 11; ++n) fields >> skipped;
    fields >> user >> system;
    seconds[pid] = (user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
    for (const auto& task : std::filesystem::directory_iterator(folder + "/task")) {
      std::istringstream children(contentOf(task.path() / "children"));
      for (pid_t child = 0; children >> child;) addProcessorSecondsOf(child, seconds);
    }
  }

  TemporaryDirectory directory_;
  std::unique_ptr<Process> process_;
  int in_ = -1, out_ = -1, sent_ = 0;
  std::string session_, received_;
};

}  // namespace palpate::test
