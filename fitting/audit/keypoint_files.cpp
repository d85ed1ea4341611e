#include "fitting/audit/keypoint_files.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/base/text.h"
#include "core/motion/clip.h"
#include "fitting/audit/rig_fault.h"

namespace mocurate {
namespace {

/// Of an entry's extent: two detectors' errors on one image of a person 400 px tall.
constexpr double kOneDirection = 0.03;

Vector2d DirectionOf(const Camera& camera, const double* seen) {
  return {(seen[0] - camera.cx) / camera.fx, (seen[1] - camera.cy) / camera.fy};
}

/// Diagonal of an entry's bounding box, in the units of DirectionOf.
double ExtentOfEntry(const KeypointView& view, int frame, int person) {
  Eigen::AlignedBox2d box;
  for (int k = 0; k < view.points(); ++k) {
    const double* seen = view.at(frame, person, k);
    if (seen[2] > 0.0) box.extend(DirectionOf(view.camera, seen));
  }
  return box.isEmpty() ? 0.0 : box.diagonal().norm();
}

struct SharedKeypoints {
  double seen = 0.0;
  double alike = 0.0;
};

/// Compares an entry with the most similar entry of another view.
SharedKeypoints MostSimilar(const KeypointView& a, int frame, int person, const KeypointView& b, int other_frame) {
  const double near = kOneDirection * ExtentOfEntry(a, frame, person);
  SharedKeypoints best;
  for (int other = 0; other < b.people; ++other) {
    SharedKeypoints shared;
    for (int k = 0; k < std::min(a.points(), b.points()); ++k) {
      const double* one = a.at(frame, person, k);
      const double* two = b.at(other_frame, other, k);
      if (one[2] <= 0.0 || two[2] <= 0.0) continue;
      shared.seen += 1.0;
      shared.alike += (DirectionOf(a.camera, one) - DirectionOf(b.camera, two)).norm() <= near ? 1.0 : 0.0;
    }
    if (shared.alike * std::max(best.seen, 1.0) >= best.alike * std::max(shared.seen, 1.0) && shared.seen > 0.0) {
      best = shared;
    }
  }
  return best;
}

/// Share [0, 1] of keypoints with equal directions in two views of one place, to within 3 % of the entry's extent.
/// Compares the nearest entries at the same moments, by keypoints that both list. Negative without such keypoints.
double KeypointSimilarity(const KeypointView& a, const KeypointView& b) {
  SharedKeypoints all;
  for (int f = 0; f < a.frames() && b.frames() > 0; ++f) {
    const auto later = std::lower_bound(b.time_s.begin(), b.time_s.end(), a.time_s[static_cast<std::size_t>(f)]);
    const int other = std::min(static_cast<int>(later - b.time_s.begin()), b.frames() - 1);
    for (int p = 0; p < a.people; ++p) {
      const SharedKeypoints shared = MostSimilar(a, f, p, b, other);
      all.seen += shared.seen;
      all.alike += shared.alike;
    }
  }
  return all.seen > 0.0 ? all.alike / all.seen : -1.0;
}

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
