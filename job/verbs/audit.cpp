#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "canon/options.h"
#include "canon/review/review.h"
#include "canon/stages.h"
#include "canon/values/set_files.h"
#include "core/base/config.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/links.h"
#include "core/base/log.h"
#include "core/base/table_text.h"
#include "core/base/terminal.h"
#include "core/base/text.h"
#include "core/store/dataset_clips.h"
#include "job/run_folder.h"
#include "job/verbs/inputs_and_outputs.h"
#include "job/verbs/verbs.h"
#include "report/options.h"
#include "report/stages.h"

namespace mocurate {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostShown = 20;

/// The shown part of a text, truncated at its end.
std::string Shortened(const std::string& text, std::size_t most) {
  return text.size() <= most ? text : text.substr(0, most - 3) + "...";
}

void PrintAudit(const nlohmann::json& audit, const std::string& written) {
  const nlohmann::json &findings = audit.at("findings"), &summary = audit.at("summary");
  Print("%s, %s, %s\n", Counted(summary.at("clips").get<long long>(), "clip").c_str(),
        Counted(static_cast<long long>(summary.at("per_label").size()), "label").c_str(),
        Counted(static_cast<long long>(summary.at("per_person").size()), "person").c_str());
  for (const nlohmann::json& split : summary.at("splits")) {
    const auto leaks = split.at("leaks").get<long long>();
    Print("split %s: %s\n", split.at("name").get<std::string>().c_str(),
          leaks == 0 ? "no leak" : Counted(leaks, "leak").c_str());
  }
  if (const int accepted = summary.value("accepted", 0); accepted > 0) {
    Print("%s accepted by the review\n", Counted(accepted, "finding").c_str());
  }
  if (findings.empty()) Print("nothing was found\n");
  for (const auto& [code, count] : summary.at("findings").items()) {
    Print("%-16s %d\n", code.c_str(), count.get<int>());
  }
  for (std::size_t i = 0; i < std::min(kMostShown, findings.size()); ++i) {
    const nlohmann::json& finding = findings[i];
    Print("%-8s %-15s %s: %s\n", finding.at("severity").get<std::string>().c_str(),
          finding.at("code").get<std::string>().c_str(), finding.at("clip").get<std::string>().c_str(),
          Shortened(finding.at("message").get<std::string>(), 120).c_str());
  }
  if (findings.size() > kMostShown) {
    Print("and %s%s\n", Counted(static_cast<long long>(findings.size() - kMostShown), "more finding").c_str(),
          written.empty() ? ": -o FOLDER or --json lists all" : (": " + written + " lists all").c_str());
  }
}

/// The findings that --fail-on counts.
long long Counting(const nlohmann::json& findings, const std::string& severity) {
  return std::count_if(findings.begin(), findings.end(), [&](const nlohmann::json& finding) {
    return finding.at("severity") == "error" || (severity == "warning" && finding.at("severity") == "warning");
  });
}

/// The audit, as the file audit.json. `decisions` and `probabilities` may be empty.
Expected<fs::path> AuditOf(VerbStages& stages, const fs::path& dataset, const std::vector<std::string>& assignments,
                           const fs::path& decisions, const fs::path& probabilities) {
  const Expected<ConfigNode> node = LoadConfig(ConfigSource{"", "audit", {}}, assignments);
  if (!node) return Forward(node);
  const auto options = OptionsFromConfig<AuditOptions>(*node);
  if (!options) return Forward(options);
  ItemSpec item{"audit", OptionsToJson(*options), {{"dataset", DisplayPath(dataset), dataset, ""}}};
  const std::pair<const char*, const fs::path*> more[] = {{"probabilities", &probabilities}, {kReviewRole, &decisions}};
  for (const auto& [role, path] : more) {
    if (!path->empty()) item.inputs.push_back({role, DisplayPath(*path), *path, ""});
  }
  const auto made = stages.One(AuditDeclaration(), std::move(item));
  if (!made) return Forward(made);
  return made->artifact;
}

/// The page of an audit's findings, at most `most` of them.
Expected<fs::path> ReviewPage(VerbStages& stages, const fs::path& dataset, const fs::path& audit, std::int64_t most,
                              const std::vector<Decision>& decisions) {
  ReviewOptions options;
  options.most = most;
  nlohmann::json list = nlohmann::json::array();
  for (const Decision& decision : decisions) list.push_back(OptionsToJson(decision));
  const fs::path file = stages.folder() / "decisions.json";
  if (Status written = WriteFile(file, list.dump()); !written) return Forward(written);
  const auto made = stages.One(ReviewDeclaration(), {"review",
                                                     OptionsToJson(options),
                                                     {{"dataset", DisplayPath(dataset), dataset, ""},
                                                      {"audit", DisplayPath(audit), audit, ""},
                                                      {"decisions", "decisions", file, ""}}});
  if (!made) return Forward(made);
  return made->artifact;
}

Expected<nlohmann::json> ReadAudit(const fs::path& path) {
  auto audit = ReadJson(path);
  if (!audit || (audit->is_object() && audit->contains("findings"))) return audit;
  return Fail(ErrorCode::kMalformed, "the file is not an audit: it has no list of findings", DisplayPath(path),
              "write one with `mocurate audit DATASET -o FOLDER`");
}

/// The dataset with the audit's findings in /findings, which replace those of an earlier audit.
Status WriteWithFindings(const fs::path& from, const nlohmann::json& audit, const fs::path& to) {
  const auto files = OpenDatasetFiles({from});
  if (!files) return Forward(files);
  Dataset dataset = files->front().outline;
  std::vector<Finding>& all = dataset.findings;
  all.erase(std::remove_if(all.begin(), all.end(),
                           [](const Finding& found) { return found.action == FindingAction::kAudited; }),
            all.end());
  for (const nlohmann::json& json : audit.at("findings")) {
    nlohmann::json whole = json;
    whole.update({{"joint", ""}, {"action", Name(FindingAction::kAudited)}});
    all.push_back(whole.get<Finding>());
  }
  const auto dropped = WriteFromFiles(dataset, WholeClips(*files), *files, to);
  if (!dropped) return Forward(dropped);
  WarnOf(*dropped);
  return {};
}

/// The measures of all clips: a line each, texts in quotes, an empty cell for a missing measure.
Status WriteClipMeasures(const nlohmann::json& audit, const fs::path& path) {
  const nlohmann::json& clips = audit.at("clips");
  std::string csv;
  const auto line = [&](const auto& cell_of) {
    const char* mark = "";
    for (const auto& [key, value] : clips.front().items()) {
      csv += mark + cell_of(key);
      mark = ",";
    }
    csv += "\n";
  };
  if (!clips.empty()) line([](const std::string& key) { return key; });
  for (const nlohmann::json& clip : clips) {
    line([&](const std::string& key) -> std::string {
      const nlohmann::json& value = clip.at(key);
      if (value.is_null()) return "";
      if (value.is_array()) {
        std::string names;
        for (const nlohmann::json& name : value) names += (names.empty() ? "" : "; ") + name.get<std::string>();
        return QuotedCsvCell(names);
      }
      if (!value.is_string()) return FormatDouble(value.get<double>());
      return QuotedCsvCell(value.get_ref<const std::string&>());
    });
  }
  return WriteFile(path, csv);
}

/// Decisions to drop exact repeats of another clip.
Status WriteFixes(const fs::path& dataset, const nlohmann::json& audit, const fs::path& to, std::size_t& count) {
  std::set<std::string> dropped;
  for (const nlohmann::json& finding : audit.at("findings")) {
    if (finding.at("safe_to_drop").is_string()) dropped.insert(finding.at("safe_to_drop").get<std::string>());
  }
  const auto clips = DatasetClips::Open(dataset, DatasetClips::Check::kNone);
  if (!clips) return Forward(clips);
  Review review{DisplayPath(dataset), {}};
  for (std::size_t row = 0; row < clips->size(); ++row) {
    if (dropped.count(clips->Id(row)) == 0) continue;
    const auto clip = clips->Read(row);
    if (!clip) return Forward(clip);
    Decision decision;
    decision.clip = clip->id();
    decision.content = MotionFingerprint(*clip->motion);
    decision.finding = "duplicate";
    decision.verdict = Verdict::kDrop;
    decision.note = "repeats another clip to 0.01 mm";
    review.decisions.push_back(std::move(decision));
  }
  count = review.decisions.size();
  return WriteFile(to, ReviewText(review));
}

void PrintWritten(const CommonArguments& common, const std::string& what, const fs::path& path) {
  if (!common.json && !common.quiet) Print("%s %s\n", what.c_str(), DisplayPath(path).c_str());
}

}  // namespace

Status AuditVerb(CommonArguments& common, const AuditArguments& arguments) {
  if (Status sound = CheckIsDataset(arguments.path); !sound) return sound;
  const bool keeps = !arguments.output.empty();
  const fs::path json_file = keeps ? arguments.output / "audit.json" : fs::path();
  const fs::path page_file = keeps ? arguments.output / "audit.html" : fs::path();
  const fs::path csv_file = keeps ? arguments.output / "clips.csv" : fs::path();
  if (Status free = CheckOutputs({json_file, page_file, csv_file, arguments.with_findings, arguments.fixes},
                                 {arguments.path, arguments.review, arguments.probabilities}, arguments.force);
      !free) {
    return free;
  }
  for (const fs::path& file : {json_file, page_file, csv_file}) {
    if (Status plain = CheckNotLink(file); !plain) return plain;
  }
  auto stages = VerbStages::Make(common);
  if (!stages) return Forward(stages);
  const auto made = AuditOf(**stages, arguments.path, arguments.assignments, arguments.review, arguments.probabilities);
  if (!made) return Forward(made);
  const auto audit = ReadAudit(*made);
  if (!audit) return Forward(audit);
  if (keeps) {
    const auto page = ReviewPage(**stages, arguments.path, *made, kMostShown, {});
    if (!page) return Forward(page);
    if (Status folder = MakeFolder(arguments.output); !folder) return folder;
    if (Status copied = CopyWhole(*made, json_file); !copied) return copied;
    if (Status copied = CopyWhole(*page, page_file); !copied) return copied;
    if (Status written = WriteClipMeasures(*audit, csv_file); !written) return written;
  }
  if (AnswersInText(common, *audit)) {
    PrintAudit(*audit, keeps ? DisplayPath(json_file) : "");
  }
  if (keeps) PrintWritten(common, "the worst findings are shown in", page_file);
  if (!arguments.with_findings.empty()) {
    if (Status written = WriteWithFindings(arguments.path, *audit, arguments.with_findings); !written) return written;
    PrintWritten(common, "the dataset with its findings:", arguments.with_findings);
  }
  if (!arguments.fixes.empty()) {
    std::size_t count = 0;
    if (Status written = WriteFixes(arguments.path, *audit, arguments.fixes, count); !written) return written;
    PrintWritten(common, Counted(static_cast<long long>(count), "safe decision") + " in", arguments.fixes);
  }
  if (arguments.fail_on.empty()) return {};
  const long long count = Counting(audit->at("findings"), arguments.fail_on);
  if (count == 0) return {};
  return Fail(ErrorCode::kTooManyFailures, Counted(count, "finding") + " of at least severity " + arguments.fail_on,
              DisplayPath(arguments.path),
              "use -o FOLDER to write them to audit.json; without --fail-on the exit code is 0");
}

Status ReviewVerb(CommonArguments& common, const ReviewArguments& arguments) {
  if (Status sound = CheckIsDataset(arguments.path); !sound) return sound;
  if (Status free =
          CheckOutputs({arguments.output}, {arguments.path, arguments.audit, arguments.decisions}, arguments.force);
      !free) {
    return free;
  }
  Review earlier;
  if (!arguments.decisions.empty()) {
    auto read = ReadReview(arguments.decisions);
    if (!read) return Forward(read);
    earlier = std::move(*read);
  }
  auto stages = VerbStages::Make(common);
  if (!stages) return Forward(stages);
  Expected<fs::path> audit = arguments.audit;
  if (arguments.audit.empty()) {
    audit = AuditOf(**stages, arguments.path, arguments.assignments, {}, arguments.probabilities);
  }
  if (!audit) return Forward(audit);
  const auto page = ReviewPage(**stages, arguments.path, *audit, arguments.most, earlier.decisions);
  if (!page) return Forward(page);
  if (Status copied = CopyWhole(*page, arguments.output); !copied) return copied;
  if (AnswersInText(common, {{"page", DisplayPath(arguments.output)}})) {
    Print("%s: open it in a browser, decide, save decisions.yaml\n", DisplayPath(arguments.output).c_str());
  }
  return {};
}

}  // namespace mocurate
