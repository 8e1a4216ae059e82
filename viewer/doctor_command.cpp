#include "viewer/doctor_command.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

#include "viewer/doctor.hpp"

namespace palpate {

Verb doctorVerb() {
  return {"doctor", "Whether this machine can run the haptic client, and what to change",
          [](CLI::App& app) {
            auto json = std::make_shared<bool>(false);
            app.add_flag("--json", *json, "One JSON object per finding and line");
            app.footer(
                "Changes nothing and opens no device. Exit 0, or 1 when something will not work.");
            return std::function<ExitCode()>([json] {
              const std::vector<Finding> findings = examineMachine();
              std::cout << (*json ? describeJson(findings) : describe(findings)) << std::flush;
              if (!std::cout) throw failure("cannot write the findings to standard output");
              const bool bad = std::any_of(
                  findings.begin(), findings.end(),
                  [](const Finding& finding) { return finding.verdict == Finding::Verdict::bad; });
              return bad ? ExitCode::failed : ExitCode::done;
            });
          }};
}

}  // namespace palpate
