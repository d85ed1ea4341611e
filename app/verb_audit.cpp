#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/motion_files.h"
#include "app/run_outputs.h"
#include "app/scratch_folder.h"
#include "app/stage_runs.h"
#include "app/verbs.h"
#include "canon/options.h"
#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostShown = 20;

/// The shown part of a text, its end left out.
std::string Shortened(const std::string& text, std::size_t most) {
  return text.size() <= most ? text : text.substr(0, most - 3) + "...";
}

void PrintAudit(const nlohmann::json& audit, const std::string& written) {
  const nlohmann::json &findings = audit.at("findings"), &summary = audit.at("summary");
  std::printf("%s, %s, %s\n", Counted(summary.at("clips").get<long long>(), "clip").c_str(),
              Counted(static_cast<long long>(summary.at("per_label").size()), "label").c_str(),
              Counted(static_cast<long long>(summary.at("per_person").size()), "person").c_str());
  for (const nlohmann::json& split : summary.at("splits")) {
    std::printf("split %s: %s\n", split.at("name").get<std::string>().c_str(),
                split.at("leak_check").get<std::string>().c_str());
  }
  if (findings.empty()) std::printf("nothing was found\n");
  for (const auto& [code, count] : summary.at("findings").items()) {
    std::printf("%-16s %d\n", code.c_str(), count.get<int>());
  }
  for (std::size_t i = 0; i < std::min(kMostShown, findings.size()); ++i) {
    const nlohmann::json& finding = findings[i];
    std::printf("%-8s %-15s %s: %s\n", finding.at("severity").get<std::string>().c_str(),
                finding.at("code").get<std::string>().c_str(), finding.at("clip").get<std::string>().c_str(),
                Shortened(finding.at("message").get<std::string>(), 120).c_str());
  }
  if (findings.size() > kMostShown) {
    std::printf("and %s%s\n", Counted(static_cast<long long>(findings.size() - kMostShown), "more finding").c_str(),
                written.empty() ? ": -o FOLDER or --json lists all" : (": " + written + " lists all").c_str());
  }
}

/// The findings that --fail-on counts.
long long Counting(const nlohmann::json& findings, const std::string& severity) {
  return std::count_if(findings.begin(), findings.end(), [&](const nlohmann::json& finding) {
    return finding.at("severity") == "error" || (severity == "warning" && finding.at("severity") == "warning");
  });
}

Expected<AuditOptions> OptionsOfAudit(const AuditArguments& arguments) {
  const Expected<ConfigNode> node = LoadConfig(ConfigSource{"", "audit", {}}, arguments.assignments);
  if (!node) return Forward(node);
  return OptionsFromConfig<AuditOptions>(*node);
}

}  // namespace

Status AuditVerb(CommonArguments& common, const AuditArguments& arguments) {
  const auto options = OptionsOfAudit(arguments);
  if (!options) return Forward(options);
  std::error_code unknown;
  if (!fs::exists(arguments.path, unknown)) {
    return Fail(ErrorCode::kNotFound, "no such file", DisplayPath(arguments.path),
                "give a dataset: RUN/dataset.h5, or what `mocurate fit` wrote");
  }
  if (!IsMotionStore(arguments.path)) {
    return Fail(ErrorCode::kInconsistent, "the file is no dataset of mocurate", DisplayPath(arguments.path),
                "make one of it: `mocurate config init`, then `mocurate run CONFIG --to assemble`");
  }
  const fs::path written = arguments.output.empty() ? fs::path() : arguments.output / "audit.json";
  if (!written.empty() && fs::exists(written, unknown) && !arguments.force) {
    return Fail(ErrorCode::kUsage, "the file exists", DisplayPath(written), "--force overwrites it");
  }
  const ScratchFolder scratch;
  if (scratch.path().empty()) return scratch.Missing();
  RunnerOptions settings;
  settings.run_folder = scratch.path();
  settings.quiet = common.quiet;
  settings.tell_failures = false;
  auto runner = Runner::Make(settings);
  if (!runner) return Forward(runner);
  ItemSpec item{"audit", OptionsToJson(*options), {{"dataset", DisplayPath(arguments.path), arguments.path, ""}}};
  if (!arguments.probabilities.empty()) {
    item.inputs.push_back({"probabilities", DisplayPath(arguments.probabilities), arguments.probabilities, ""});
  }
  std::vector<StageReport> reports;
  const auto done = StageRuns(**runner, reports).One(AuditDeclaration(), std::move(item));
  if (!done) return Forward(done);
  const auto text = ReadFile(done->artifact);
  if (!text) return Forward(text);
  const nlohmann::json audit = nlohmann::json::parse(*text, nullptr, false);
  if (!written.empty()) {
    if (Status made = MakeFolder(arguments.output); !made) return made;
    if (Status copied = CopyWhole(done->artifact, written); !copied) return copied;
  }
  if (common.json) {
    common.answered = true;
    std::printf("%s\n", audit.dump(1, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else if (!common.quiet) {
    PrintAudit(audit, written.empty() ? "" : DisplayPath(written));
  }
  if (arguments.fail_on.empty()) return {};
  const long long count = Counting(audit.at("findings"), arguments.fail_on);
  if (count == 0) return {};
  return Fail(ErrorCode::kTooManyFailures, Counted(count, "finding") + " of severity " + arguments.fail_on + " or more",
              DisplayPath(arguments.path), "-o FOLDER writes them to audit.json; without --fail-on the exit code is 0");
}

}  // namespace mocurate
