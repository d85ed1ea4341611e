#include "canon/audit/clip_errors.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/quality/handedness.h"
#include "core/quality/repeats.h"
#include "core/quality/swaps.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr double kIdentical_m = 1e-5;  ///< what the storing of a motion may move its joints by

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
    findings.push_back({finding, "", ""});
    findings.back().finding.clip = clip.id();
  }
}

/// Knees alone are no proof: depth trackers bend straight legs backwards, and fits to them do so with constant bones
/// (KARD: 8 of 432 clips, all by knees alone).
bool ShownByFeetOrHands(const HandednessMeasure& measure) {
  return std::any_of(measure.cues.begin(), measure.cues.end(),
                     [](const HandednessCue& cue) { return cue.name != "knees" && cue.frames > 0 && cue.score > 0.0; });
}

/// Part of every clip in each split: 0 train, 1 validation, 2 test, -1 none. Rows may stand in any order.
std::vector<std::vector<int>> PartsOfSplits(const Dataset& dataset) {
  std::vector<std::vector<int>> parts;
  for (const Split& split : dataset.splits) {
    std::vector<int>& own = parts.emplace_back(dataset.clips.size(), -1);
    const std::vector<int>* rows[] = {&split.train, &split.validation, &split.test};
    for (int part = 0; part < 3; ++part) {
      for (const int row : *rows[part]) own.at(static_cast<std::size_t>(row)) = part;
    }
  }
  return parts;
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
  const std::vector<std::vector<int>> parts = PartsOfSplits(dataset);
  std::vector<AuditFinding> findings;
  for (const Duplicate& pair : FindDuplicates(signatures, limits)) {
    const Clip &first = dataset.clips[pair.first], &second = dataset.clips[pair.second];
    std::string splits;
    for (std::size_t s = 0; s < parts.size(); ++s) {
      const int a = parts[s][pair.first], b = parts[s][pair.second];
      if (a >= 0 && b >= 0 && a != b) splits += (splits.empty() ? "'" : ", '") + dataset.splits[s].name + "'";
    }
    const bool overlap = pair.kind == Duplicate::Kind::kOverlap;
    const std::string other = second.id() + (overlap ? ", frames " + std::to_string(pair.second_begin) + " to " +
                                                           std::to_string(pair.second_end)
                                                     : std::string());
    const std::string what = pair.kind == Duplicate::Kind::kSame ? "shows the same as "
                             : overlap                           ? "shares " + Counted(pair.shared, "frame") + " with "
                                                                 : "shows the mirror image of ";
    AuditFinding found;
    found.finding =
        FrameFinding(splits.empty() ? "duplicate" : "leak", pair.frame_begin, pair.frame_end, "",
                     overlap ? static_cast<double>(pair.shared) : pair.distance,
                     what + other + (splits.empty() ? "" : "; the two are in different parts of split " + splits));
    if (!splits.empty()) found.finding.severity = Severity::kError;
    found.finding.clip = first.id();
    found.suggested = second.id();
    const bool alike = pair.kind == Duplicate::Kind::kSame && pair.distance <= kIdentical_m && splits.empty() &&
                       first.label == second.label && first.fine_label == second.fine_label &&
                       first.motion->frame_count() == second.motion->frame_count();
    if (alike) found.safe_to_drop = second.id();
    findings.push_back(std::move(found));
  }
  return findings;
}

}  // namespace mocurate
