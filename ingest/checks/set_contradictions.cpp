#include "ingest/checks/set_contradictions.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/base/text.h"
#include "ingest/inspect/comparison.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

struct Votes {
  std::size_t decided = 0;
  std::size_t against = 0;
  double weight = 0.0;
  double weight_against = 0.0;
  std::string message;  ///< of the first clip that contradicts
};

std::map<std::string, Votes> CountVotes(const std::vector<ItemResult>& clips) {
  std::map<std::string, Votes> all;
  for (const ItemResult& clip : clips) {
    const nlohmann::json shown = clip.summary.value("shown", nlohmann::json::object());
    for (const auto& [code, said] : shown.items()) {
      Votes& votes = all[code];
      const double weight = said.value("weight", 0.0);
      ++votes.decided;
      votes.weight += weight;
      if (!said.value("contradicts", false)) continue;
      ++votes.against;
      votes.weight_against += weight;
      for (const Finding& finding : clip.outcome.findings) {
        if (votes.message.empty() && finding.code == code) votes.message = finding.message;
      }
    }
  }
  return all;
}

Finding Together(const std::string& code, const Votes& votes, std::size_t clips, const SourceOptions& source) {
  const double share = votes.weight_against / votes.weight;
  return Contradiction(source, code, FourDecimals(share),
                       "the whole source contradicts its declaration: " + std::to_string(votes.against) + " of the " +
                           Counted(static_cast<long long>(votes.decided), "clip") + " that decide it, of " +
                           std::to_string(clips) + " in all (" + RoundedText(100.0 * share) +
                           " % of what they say); the first: " + votes.message);
}

/// Rates that motions deny: `against` is then of all clips, however little each of the others tells.
std::optional<Finding> RateOfAll(const std::vector<ItemResult>& clips, const SourceOptions& source) {
  RateDenials denials;
  std::string first;
  for (const ItemResult& clip : clips) {
    if (!clip.summary.contains("rate_hz")) continue;
    ++denials.clips;
    for (const Finding& finding : clip.outcome.findings) {
      if (finding.code != "rate_suspect") continue;
      denials.Add(clip.summary.value("rate_hz", 0.0), finding.value);
      if (first.empty()) first = finding.message;
    }
  }
  if (!denials.OfTheSet()) return std::nullopt;
  return Contradiction(
      source, "rate_suspect", FourDecimals(denials.Share()),
      "the motions of the whole source contradict its rate: " + denials.Words() + "; the first: " + first);
}

/// What is wrong with the set is wrong with each of its clips.
void AddSetFinding(const Finding& of_the_set, bool refuse, std::vector<ItemResult>& clips) {
  for (ItemResult& clip : clips) {
    if (!HasArtifact(clip.outcome.kind)) continue;
    Finding own = of_the_set;
    own.clip = clip.item;
    if (!refuse) {
      std::vector<Finding>& findings = clip.outcome.findings;
      bool of_itself = false;
      for (Finding& finding : findings) {
        if (finding.code != own.code) continue;
        finding.severity = Severity::kError;
        of_itself = true;
      }
      clip.outcome.kind = OutcomeKind::kSuspect;
      if (!of_itself) findings.push_back(std::move(own));
      continue;
    }
    own.action = FindingAction::kRefused;
    clip.summary.Set("threshold", own.code == "rate_suspect" ? kShareOfWrongRate : kAgreement);
    clip.outcome.kind = OutcomeKind::kRefused;
    clip.outcome.error = Error{ErrorCode::kInconsistent, own.message, clip.item,
                               "set ingest.source.on_contradiction: flag to keep such clips"};
    clip.outcome.findings.push_back(std::move(own));
    clip.artifact.clear();
    clip.sha256.clear();
  }
}

}  // namespace

std::vector<Finding> FindSetContradictions(const SourceOptions& source, std::vector<ItemResult>& clips) {
  const bool refuse = source.on_contradiction == OnContradiction::kRefuse;
  std::vector<Finding> findings;
  for (const auto& [code, votes] : CountVotes(clips)) {
    if (votes.decided < kFewestDenials || votes.weight_against < kAgreement * votes.weight) continue;
    findings.push_back(Together(code, votes, clips.size(), source));
  }
  if (std::optional<Finding> rate = RateOfAll(clips, source)) findings.push_back(std::move(*rate));
  for (const Finding& finding : findings) AddSetFinding(finding, refuse, clips);
  return findings;
}

}  // namespace mocurate
