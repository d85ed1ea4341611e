#include <algorithm>
#include <cmath>
#include <map>

#include "canon/audit/audit.h"
#include "canon/options.h"
#include "canon/review/review.h"
#include "canon/splits/leaks.h"
#include "canon/stages.h"
#include "core/base/file.h"
#include "core/base/text.h"
#include "core/store/feature_file.h"
#include "core/store/store.h"

namespace mocurate {
namespace {

/// The best other class of a clip, and the margin of its own class over it.
struct NearestClass {
  double margin = 0.0;
  std::string label;
};

/// Clips that resemble another class, the lowest margin first. `input`: probabilities of another classifier, or null.
Expected<std::vector<AuditFinding>> LabelFindings(const Dataset& dataset, const LabelNoiseOptions& options,
                                                  const StageInput* input, nlohmann::json& summary,
                                                  std::map<std::string, NearestClass>& nearest) {
  std::vector<AuditFinding> findings;
  if (!options.enabled) return findings;
  LabelAudit audit;
  if (input == nullptr) {
    audit = AuditLabels(dataset, options);
  } else {
    const auto features = ReadFeatures(input->path);
    if (!features) return Forward(features);
    auto judged = AuditLabelsBy(*features, dataset, options);
    if (!judged) return Fail(judged.error().code, judged.error().what, input->name, judged.error().hint);
    audit = std::move(*judged);
  }
  summary = {{"checked", audit.rows.size()},
             {"not_checked", dataset.clips.size() - audit.rows.size()},
             {"classes_of_one_person", audit.unchecked}};
  for (std::size_t i = 0; i < audit.rows.size(); ++i) {
    const JudgedLabel& judged = audit.judged[i];
    if (judged.suggested >= 0) {
      nearest[dataset.clips[static_cast<std::size_t>(audit.rows[i])].id()] = {
          judged.margin, dataset.labels[static_cast<std::size_t>(judged.suggested)]};
    }
    if (!judged.suspect && !judged.fits_none) continue;
    const Clip& clip = dataset.clips[static_cast<std::size_t>(audit.rows[i])];
    const std::string near =
        judged.suspect ? dataset.labels[static_cast<std::size_t>(judged.suggested)] : std::string();
    const std::string resembles = judged.suspect ? "'" + near + "' (margin " + RoundedText(judged.margin, 2) + ")"
                                                 : "no class that other people perform";
    findings.push_back(
        {MakeFinding(judged.suspect ? "label_suspect" : "fits_no_class",
                     judged.suspect ? Severity::kWarning : Severity::kInfo, judged.margin,
                     "labelled '" + clip.label + "', resembles " + resembles, FindingAction::kFlagged, clip.id()),
         near,
         "",
         {}});
    findings.back().finding.frame_end = clip.motion->frame_count();
  }
  std::stable_sort(findings.begin(), findings.end(),
                   [](const AuditFinding& a, const AuditFinding& b) { return a.finding.value < b.finding.value; });
  return findings;
}

/// Removes the findings that a review rejects; returns their number.
Expected<std::size_t> DropAccepted(const StageInput& input, const Dataset& dataset,
                                   std::vector<AuditFinding>& findings) {
  const auto review = ReadReview(input.path);
  if (!review) return Forward(review);
  std::map<std::string, std::string> content;
  for (const Clip& clip : dataset.clips) {
    if (clip.motion) content[clip.id()] = MotionFingerprint(*clip.motion);
  }
  const std::size_t all = findings.size();
  findings.erase(std::remove_if(findings.begin(), findings.end(),
                                [&](const AuditFinding& found) {
                                  return IsAccepted(*review, content, found.finding.clip, found.suggested,
                                                    found.finding.code);
                                }),
                 findings.end());
  return all - findings.size();
}

/// Whether a finding is an error about this split.
bool IsLeakOf(const Split& split, const AuditFinding& found) {
  return found.finding.severity == Severity::kError &&
         std::any_of(found.parts.begin(), found.parts.end(),
                     [&](const SplitParts& parts) { return parts.split == split.name; });
}

/// Leaks that the file itself states and the clips do not show, as after a change of the clips.
void AddStatedLeaks(const Dataset& dataset, std::vector<AuditFinding>& findings) {
  for (const Split& split : dataset.splits) {
    const bool stated = !split.leak_check.empty() && split.leak_check.rfind("ok", 0) != 0;
    const bool found = std::any_of(findings.begin(), findings.end(),
                                   [&](const AuditFinding& finding) { return IsLeakOf(split, finding); });
    if (!stated || found) continue;
    findings.push_back({MakeFinding("split_leak", Severity::kWarning, 0.0,
                                    "split '" + split.name + "' states '" + split.leak_check +
                                        "'; its clips do not show it: assemble the dataset again"),
                        "",
                        "",
                        {}});
  }
}

nlohmann::json JsonOf(const AuditFinding& found) {
  nlohmann::json parts = nlohmann::json::array();
  for (const SplitParts& in : found.parts) {
    parts.push_back({{"split", in.split}, {"part", in.part}, {"other", in.other}});
  }
  nlohmann::json json = found.finding;
  json["suggested"] = found.suggested.empty() ? nlohmann::json() : nlohmann::json(found.suggested);
  json["safe_to_drop"] = found.safe_to_drop.empty() ? nlohmann::json() : nlohmann::json(found.safe_to_drop);
  json["parts"] = std::move(parts);
  return json;
}

constexpr std::size_t kNearest = 4;  ///< listed of each clip

/// A line per clip: id, label, person, fingerprint, margin of its label, its measures, place in the map of the set and
/// ids of the nearest clips; null where it lacks one.
nlohmann::json ClipsJson(const Dataset& dataset, const std::vector<std::vector<double>>& measures,
                         const std::map<std::string, NearestClass>& nearest) {
  nlohmann::json clips = nlohmann::json::array();
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Clip& clip = dataset.clips[i];
    nlohmann::json line = {{"clip", clip.id()}, {"label", clip.label}, {"person", clip.identity.person}};
    line["content"] = clip.motion ? MotionFingerprint(*clip.motion) : "";
    const auto near = nearest.find(clip.id());
    line["label_margin"] = near == nearest.end() ? nlohmann::json() : nlohmann::json(near->second.margin);
    line["nearest_class"] = near == nearest.end() ? nlohmann::json() : nlohmann::json(near->second.label);
    for (std::size_t k = 0; k < measures[i].size(); ++k) {
      const double value = measures[i][k];
      line[MeasuresOfClips()[k].name] = std::isfinite(value) ? nlohmann::json(value) : nlohmann::json();
    }
    line["map_x"] = line["map_y"] = line["nearest"] = nullptr;
    clips.push_back(std::move(line));
  }
  const ClipMap map = MapClips(dataset, kNearest);
  for (std::size_t i = 0; i < map.rows.size(); ++i) {
    nlohmann::json& line = clips[static_cast<std::size_t>(map.rows[i])];
    const auto rounded = [](float value) { return std::round(1e4 * static_cast<double>(value)) / 1e4; };
    line["map_x"] = rounded(map.places[i].x());
    line["map_y"] = rounded(map.places[i].y());
    line["nearest"] = nlohmann::json::array();
    for (const int near : map.nearest[i]) line["nearest"].push_back(dataset.clips[static_cast<std::size_t>(near)].id());
  }
  return clips;
}

}  // namespace

Expected<StageOutcome> AuditStage(const StageRequest& request) {
  const auto options = OptionsFromJson<AuditOptions>(request.options, "audit");
  if (!options) return Forward(options);
  const StageInput* input = FindInput(request, "dataset");
  if (input == nullptr) return Fail(ErrorCode::kInternal, "the stage audit has no dataset", request.item);
  const auto dataset = ReadDataset(input->path);
  if (!dataset) return Forward(dataset);

  if (!(dataset->axes == AxisConvention())) {
    return Fail(ErrorCode::kUnsupported, "the dataset's axes are " + dataset->axes.Text() + ", not +x +y +z",
                input->name, "declare it as a source and write it again: mocurate run CONFIG --to assemble");
  }
  std::map<std::string, int> per_label;
  std::map<std::string, int> per_person;
  std::int64_t frames = 0;
  double seconds = 0.0;
  for (const Clip& clip : dataset->clips) {
    ++per_label[clip.label];
    ++per_person[clip.identity.person];
    if (!clip.motion) continue;
    frames += clip.motion->frame_count();
    seconds += clip.motion->duration();
  }
  nlohmann::json audit = {
      {"clips", dataset->clips.size()}, {"frames", frames},         {"seconds", seconds},
      {"per_label", per_label},         {"per_person", per_person}, {"splits", nlohmann::json::array()}};
  for (const Split& split : dataset->splits) audit["splits"].push_back(SplitSummary(split));
  const Split* chosen = options->split.empty() ? (dataset->splits.empty() ? nullptr : &dataset->splits.front())
                                               : dataset->FindSplit(options->split);
  if (!options->split.empty() && chosen == nullptr) {
    std::string known;
    for (const Split& split : dataset->splits) known += (known.empty() ? "it has: " : ", ") + split.name;
    return Fail(ErrorCode::kConfig, "the dataset has no split '" + options->split + "'", "audit.split",
                known.empty() ? "it has none" : known);
  }
  if (chosen != nullptr) {
    const NearestNeighbourResult result = NearestNeighbour(*dataset, *chosen);
    audit["nearest_neighbour"] = {
        {"split", chosen->name}, {"accuracy", result.accuracy()}, {"correct", result.correct}, {"count", result.count}};
  }
  std::vector<AuditFinding> findings = FindRepeatedClips(*dataset, options->repeated_distance_m);
  for (AuditFinding& found : FindClipErrors(*dataset)) findings.push_back(std::move(found));
  std::map<std::string, NearestClass> nearest;
  auto labels = LabelFindings(*dataset, options->labels, FindInput(request, "probabilities"), audit["labels"], nearest);
  if (!labels) return Forward(labels);
  for (AuditFinding& found : *labels) findings.push_back(std::move(found));
  const std::vector<std::vector<double>> measures = MeasureClips(*dataset);
  for (AuditFinding& found : FindOutliers(*dataset, measures, options->outliers)) findings.push_back(std::move(found));
  for (AuditFinding& found : FindSetErrors(*dataset)) findings.push_back(std::move(found));
  AddStatedLeaks(*dataset, findings);
  std::stable_sort(findings.begin(), findings.end(), [](const AuditFinding& a, const AuditFinding& b) {
    return a.finding.severity > b.finding.severity;
  });
  if (const StageInput* review = FindInput(request, kReviewRole)) {
    const auto accepted = DropAccepted(*review, *dataset, findings);
    if (!accepted) return Forward(accepted);
    audit["accepted"] = *accepted;
  }
  std::map<std::string, int> per_code;
  nlohmann::json list = nlohmann::json::array();
  for (const AuditFinding& found : findings) {
    ++per_code[found.finding.code];
    list.push_back(JsonOf(found));
  }
  for (std::size_t s = 0; s < dataset->splits.size(); ++s) {
    audit["splits"][s]["leaks"] = std::count_if(findings.begin(), findings.end(), [&](const AuditFinding& found) {
      return IsLeakOf(dataset->splits[s], found);
    });
  }
  audit["findings"] = per_code;
  StageOutcome outcome;
  outcome.summary = audit;
  const nlohmann::json file = {
      {"findings", std::move(list)}, {"summary", std::move(audit)}, {"clips", ClipsJson(*dataset, measures, nearest)}};
  if (Status written =
          WriteFile(request.output, file.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
      !written)
    return Forward(written);
  return outcome;
}

}  // namespace mocurate
