#include "fitting/audit/keypoint_files.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "fitting/audit/cameras_in_one_place.h"
#include "fitting/audit/keypoint_similarity.h"

namespace mocurate {
namespace {

constexpr int kMaxHypotheses = 3;         ///< corrections in sequence, at most (numerical)
constexpr double kLikelyExchanged = 0.9;  ///< confidence from which exchanged files are reported

std::string PercentText(double share) { return std::to_string(std::lround(100.0 * share)); }

std::string CodeOf(const RigHypothesis& hypothesis) {
  if (hypothesis.ExchangesFiles()) return "cameras_exchanged";
  if (hypothesis.mirrored) return "view_mirrored";
  return hypothesis.sides ? "view_swaps_sides" : "keypoint_scale";
}

bool IsOfFiles(const RigFault& fault) { return fault.code == "cameras_exchanged" || fault.code == "view_mirrored"; }

/// AuditRig tests a single view again, with all its frames.
bool AreOfOneView(const std::vector<RigHypothesis>& hypotheses) {
  return std::all_of(hypotheses.begin(), hypotheses.end(), [&](const RigHypothesis& hypothesis) {
    return hypothesis.views.size() == 1 && hypothesis.views == hypotheses[0].views;
  });
}

/// Evidence for a hypothesis: the shares when they differ as text, else the costs.
std::string Better(const RigHypotheses& found) {
  const std::string read = PercentText(found.read), given = PercentText(found.agreement);
  if (read != given) return read + " % of the entries agree with others, as given " + given + " %";
  return "the mean cost of an entry is " + RoundedText(found.read_cost, 2) + ", as given " +
         RoundedText(found.given_cost, 2) + " (0: on a body, 1: on no body)";
}

RigFault FaultOf(const RigHypotheses& found, const std::vector<KeypointView>& views) {
  const RigHypothesis& first = found.alike[0];
  RigFault fault;
  fault.code = CodeOf(first);
  fault.value = first.factor != 1.0 ? first.factor : found.read;
  fault.confidence = found.confidence / static_cast<double>(found.alike.size());
  for (const RigHypothesis& hypothesis : found.alike) {
    if (&hypothesis == &first) fault.camera = CamerasOf(hypothesis, views);
    fault.message += (fault.message.empty() ? "" : "; or ") + WordsOf(hypothesis, views);
  }
  if (found.alike.size() > 1) fault.message += "; ambiguous, because the rig is symmetric";
  fault.message += "; so " + Better(found);
  return fault;
}

/// Corrects the views by the best hypothesis. Returns true when another round may find more.
Expected<bool> CorrectOnce(Evidence& evidence, const std::vector<KnownLength>& lengths,
                           const KeypointFitOptions& options, std::vector<RigFault>& faults, FileFindings& all) {
  const KeypointAuditOptions& audit = options.audit;
  RigHypotheses found = FindRigHypotheses(evidence.keypoint_views, evidence.keypoint_names, lengths,
                                          options.triangulation.min_confidence, audit.sure);
  if (found.alike.empty() || (found.alike.size() > 1 && AreOfOneView(found.alike))) return false;
  const RigHypothesis hypothesis = found.alike[0];
  const bool sure = found.confidence >= audit.sure;
  if (!sure && (!hypothesis.ExchangesFiles() || found.confidence < kLikelyExchanged)) return false;
  RigFault fault = FaultOf(found, evidence.keypoint_views);
  const bool of_sides = fault.code == "view_swaps_sides";
  const AuditAction action = of_sides ? audit.sides : audit.exchanged;
  if (action == AuditAction::kOff) return false;
  if (found.alike.size() > 1 && sure && action == AuditAction::kCorrect) {
    return Fail(ErrorCode::kInconsistent,
                fault.message + "; that it is one of them is " +
                    ConfidenceText(found.confidence, ConfidenceOf::kSpansOfOneTake),
                "keypoints",
                "look at an image of each camera and correct the files, or set fitting.keypoints.audit." +
                    std::string(of_sides ? "sides" : "exchanged") + " to report: the person may then be mirrored");
  }
  fault.guessed = !sure;
  fault.corrected = sure && found.alike.size() == 1 && action == AuditAction::kCorrect;
  if (fault.corrected)
    evidence.keypoint_views = WithHypothesis(evidence.keypoint_views, evidence.keypoint_names, hypothesis);
  (fault.corrected ? all.applied : all.reported).push_back(std::move(found));
  faults.push_back(std::move(fault));
  return faults.back().corrected;
}

}  // namespace

Status CorrectFileAssignment(Evidence& evidence, const std::vector<KnownLength>& lengths,
                             const KeypointFitOptions& options, std::vector<RigFault>& faults, FileFindings& found) {
  if (options.audit.exchanged == AuditAction::kOff) return {};
  const std::vector<KeypointView>& views = evidence.keypoint_views;
  std::vector<Camera> cameras;
  for (const KeypointView& view : views) cameras.push_back(view.camera);
  const auto alike = [&](std::size_t a, std::size_t b) -> Expected<double> {
    return KeypointSimilarity(views[a], views[b]);
  };
  const bool places = options.audit.rules.on(FittingRule::kSharedPlaces);
  auto in_one_place = FaultsOfSharedPlaces(cameras, alike, places ? options.audit.exchanged : AuditAction::kOff,
                                           {"keypoints", "fitting.keypoints.audit.exchanged"});
  if (!in_one_place) return Forward(in_one_place);
  faults.insert(faults.end(), in_one_place->begin(), in_one_place->end());
  for (int i = 0; i < kMaxHypotheses; ++i) {
    const Expected<bool> corrected = CorrectOnce(evidence, lengths, options, faults, found);
    if (!corrected) return Forward(corrected);
    if (!*corrected) break;
  }
  return {};
}

bool FilesAreExchanged(const std::vector<RigFault>& faults) {
  return std::any_of(faults.begin(), faults.end(),
                     [](const RigFault& fault) { return IsOfFiles(fault) && !fault.corrected && !fault.guessed; });
}

bool FilesAreCorrected(const std::vector<RigFault>& faults) {
  return std::any_of(faults.begin(), faults.end(),
                     [](const RigFault& fault) { return IsOfFiles(fault) && fault.corrected; });
}

}  // namespace mocurate
