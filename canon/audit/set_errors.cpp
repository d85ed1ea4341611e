#include "canon/audit/set_errors.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/base/median.h"

namespace mocurate {
namespace {

AuditFinding OfSet(const char* code, const std::string& message) {
  AuditFinding found;
  found.finding.code = code;
  found.finding.message = message;
  found.finding.action = FindingAction::kFlagged;
  return found;
}

/// A name without blanks and case.
std::string Plain(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isspace(byte) == 0) plain += static_cast<char>(std::tolower(byte));
  }
  return plain;
}

std::set<std::string> LabelsOf(const Dataset& dataset, const std::vector<int>& rows) {
  std::set<std::string> labels;
  for (const int row : rows) labels.insert(dataset.clips[static_cast<std::size_t>(row)].label);
  return labels;
}

}  // namespace

std::vector<AuditFinding> FindSetErrors(const Dataset& dataset) {
  std::vector<AuditFinding> findings;
  for (const Split& split : dataset.splits) {
    const std::set<std::string> trained = LabelsOf(dataset, split.train);
    for (const auto& [part, rows] : {std::pair("validates", &split.validation), std::pair("tests", &split.test)}) {
      for (const std::string& label : LabelsOf(dataset, *rows)) {
        if (trained.count(label) > 0) continue;
        findings.push_back(
            OfSet("class_not_trained", "split '" + split.name + "' " + part + " class '" + label +
                                           "', which has no training clip: change the split, or remove it "
                                           "from assemble.classes"));
      }
    }
  }
  std::map<std::string, std::set<std::string>> persons;
  for (const Clip& clip : dataset.clips)
    persons[clip.identity.source + '\n' + Plain(clip.identity.person)].insert(clip.identity.person);
  for (const auto& [plain, names] : persons) {
    if (names.size() < 2) continue;
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "'" : ", '") + name + "'";
    findings.push_back(
        OfSet("names_alike", "persons " + all +
                                 " differ in case or blanks only: if they are the same, a split by person separates "
                                 "them; unify the names in the source"));
  }
  return findings;
}

nlohmann::json CoverageOf(const Dataset& dataset) {
  std::map<std::string, std::set<std::string>> persons;
  std::map<std::string, std::vector<double>> seconds;
  for (const Clip& clip : dataset.clips) {
    persons[clip.label].insert(clip.identity.person);
    if (clip.motion) seconds[clip.label].push_back(clip.motion->duration());
  }
  nlohmann::json coverage = {{"persons_of_class", nlohmann::json::object()},
                             {"seconds_of_class", nlohmann::json::object()},
                             {"empty_classes", nlohmann::json::array()}};
  std::size_t least = dataset.clips.size(), most = 0;
  for (const auto& [label, own] : seconds) {
    coverage["persons_of_class"][label] = persons[label].size();
    coverage["seconds_of_class"][label] = {{"least", *std::min_element(own.begin(), own.end())},
                                           {"median", Median(own)},
                                           {"most", *std::max_element(own.begin(), own.end())}};
    least = std::min(least, own.size());
    most = std::max(most, own.size());
  }
  for (const std::string& label : dataset.labels) {
    if (persons.count(label) == 0) coverage["empty_classes"].push_back(label);
  }
  coverage["imbalance"] = least > 0 ? static_cast<double>(most) / static_cast<double>(least) : 0.0;
  return coverage;
}

}  // namespace mocurate
