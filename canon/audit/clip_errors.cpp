#include "canon/audit/clip_errors.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/quality/handedness.h"
#include "core/quality/repeats.h"
#include "core/quality/swaps.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

/// A motion's joints as the detectors read points; what it refers to lives as long as this.
struct PointsOfMotion {
  std::vector<double> confidence, time_s;
  TrackedPoints points;

  explicit PointsOfMotion(const Motion& motion) : points{motion.joints, confidence, time_s} {
    for (int f = 0; f < motion.frame_count(); ++f) time_s.push_back(motion.rate.FrameTime(f));
    for (const Joint& joint : motion.skeleton->joints) {
      points.names.push_back(joint.name);
      points.parents.push_back(joint.parent);
      points.rest_lengths.push_back(joint.rest_offset.norm());
    }
    points.body = FindHandednessPoints([&](std::string_view name) { return motion.skeleton->FindJoint(name); });
  }
  PointsOfMotion(const PointsOfMotion&) = delete;
  PointsOfMotion& operator=(const PointsOfMotion&) = delete;
};

void AddFindings(const std::vector<Finding>& found, const char* code, const Clip& clip,
                 std::vector<AuditFinding>& findings) {
  for (const Finding& finding : found) {
    if (finding.code != code || finding.severity == Severity::kInfo) continue;
    findings.push_back({finding, ""});
    findings.back().finding.clip = clip.id();
  }
}

/// Knees alone are no proof: depth trackers bend straight legs backwards, and fits to them do so with constant bones
/// (KARD: 8 of 432 clips, all by knees alone).
bool ShownByFeetOrHands(const HandednessMeasure& measure) {
  return std::any_of(measure.cues.begin(), measure.cues.end(),
                     [](const HandednessCue& cue) { return cue.name != "knees" && cue.frames > 0 && cue.score > 0.0; });
}

/// Name of a split that has the two rows in different parts; empty: none has.
std::string SplitBetween(const Dataset& dataset, int first, int second) {
  for (const Split& split : dataset.splits) {
    const auto part = [&](int row) {
      const std::vector<int>* parts[] = {&split.train, &split.validation, &split.test};
      for (int p = 0; p < 3; ++p) {
        if (std::binary_search(parts[p]->begin(), parts[p]->end(), row)) return p;
      }
      return -1;
    };
    const int a = part(first), b = part(second);
    if (a >= 0 && b >= 0 && a != b) return split.name;
  }
  return {};
}

}  // namespace

std::vector<AuditFinding> FindClipErrors(const Dataset& dataset) {
  std::vector<AuditFinding> findings;
  for (const Clip& clip : dataset.clips) {
    if (!clip.motion) continue;
    const PointsOfMotion points(*clip.motion);
    AddFindings(FindSwaps(points.points), "swapped_sides", clip, findings);
    AddFindings(FindRepeats(points.points), "frozen_frames", clip, findings);
    const HandednessMeasure measure = MeasureHandedness(clip.motion->joints, points.points.body);
    if (measure.handedness != Handedness::kLeft || !ShownByFeetOrHands(measure)) continue;
    AuditFinding found;
    found.finding = FrameFinding("mirrored", 0, clip.motion->frame_count(), "", measure.confidence,
                                 "left and right are exchanged, or the frame is left-handed: " + measure.evidence);
    found.finding.clip = clip.id();
    findings.push_back(std::move(found));
  }
  return findings;
}

MotionSignature SignatureOfMotion(const Motion& motion) { return SignatureOf(PointsOfMotion(motion).points); }

std::vector<AuditFinding> FindRepeatedClips(const Dataset& dataset, const DuplicateLimits& limits) {
  std::vector<MotionSignature> signatures;
  for (const Clip& clip : dataset.clips) {
    signatures.push_back(clip.motion ? SignatureOfMotion(*clip.motion) : MotionSignature());
  }
  std::vector<AuditFinding> findings;
  for (const Duplicate& pair : FindDuplicates(signatures, limits)) {
    const Clip &first = dataset.clips[pair.first], &second = dataset.clips[pair.second];
    const std::string split = SplitBetween(dataset, static_cast<int>(pair.first), static_cast<int>(pair.second));
    AuditFinding found;
    const char* kind = pair.kind == Duplicate::Kind::kSame       ? "shows the same as "
                       : pair.kind == Duplicate::Kind::kMirrored ? "shows the mirror image of "
                                                                 : "shares frames with ";
    found.finding =
        FrameFinding(split.empty() ? "duplicate" : "leak", pair.frame_begin, pair.frame_end, "", pair.distance,
                     kind + second.id() + (split.empty() ? "" : ", which is in another part of split '" + split + "'"));
    if (!split.empty()) found.finding.severity = Severity::kError;
    found.finding.clip = first.id();
    found.suggested = second.id();
    findings.push_back(std::move(found));
  }
  return findings;
}

}  // namespace mocurate
