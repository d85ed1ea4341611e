#include "ingest/sources/damaged_frames.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/motion/gaps.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "core/quality/tracked_points.h"
#include "ingest/formats/driver.h"

namespace mocurate {
namespace {

/// Findings count from the first frame that is kept; those of frames that were cut become findings of the clip.
void MoveFindings(const FrameRun& kept, std::vector<Finding>& findings) {
  for (Finding& finding : findings) {
    if (finding.frame_end <= finding.frame_begin) continue;
    finding.frame_begin = std::max(finding.frame_begin, kept.begin) - kept.begin;
    finding.frame_end = std::min(finding.frame_end, kept.end) - kept.begin;
    if (finding.frame_end <= finding.frame_begin) finding.frame_begin = finding.frame_end = 0;
  }
}

/// The frames between the first and the last observation.
Status CutUnobservedEnds(const std::vector<bool>& observed, const FrameRun& kept, IngestedClip& ingested) {
  const int frames = static_cast<int>(observed.size());
  if (kept.frames() == frames) return {};
  Expected<Clip> cut = Cut(ingested.clip, kept.begin, kept.end);
  if (!cut) return Forward(cut);
  ingested.clip = *std::move(cut);
  MoveFindings(kept, ingested.findings);
  ingested.findings.push_back(MakeFinding("unobserved_ends", Severity::kInfo, frames - kept.frames(),
                                          "nothing is observed in the first " + std::to_string(kept.begin) +
                                              " and the last " + std::to_string(frames - kept.end) + " of " +
                                              Counted(frames, "frame") + ": they are cut",
                                          FindingAction::kDropped));
  return {};
}

/// Frames [begin, end) of the motion become inferred, and findings that call them interpolated, missing.
void MarkInferred(const FrameRun& run, IngestedClip& ingested) {
  for (Finding& finding : ingested.findings) {
    const bool meets = finding.frame_begin < run.end && finding.frame_end > run.begin;
    if (meets && finding.action == FindingAction::kInterpolated) finding.action = FindingAction::kMissing;
  }
  if (!ingested.clip.motion) return;
  Motion& motion = *ingested.clip.motion;
  const auto joints = static_cast<std::ptrdiff_t>(motion.joint_count());
  std::fill(motion.state.begin() + run.begin * joints, motion.state.begin() + run.end * joints, JointState::kInferred);
}

/// Marks them: `motion.state` becomes kInterpolated, and findings of these frames get the action "interpolated".
void MarkBridged(const std::vector<DamagedFrame>& bridged, Motion& motion, std::vector<Finding>& findings) {
  if (bridged.empty()) return;
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  motion.state.assign(static_cast<std::size_t>(motion.frame_count()) * joints, JointState::kObserved);
  std::vector<bool> is_bridged(static_cast<std::size_t>(motion.frame_count()), false);
  for (const DamagedFrame& damaged : bridged) {
    is_bridged[static_cast<std::size_t>(damaged.frame)] = true;
    std::fill_n(motion.state.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(damaged.frame) * joints),
                joints, JointState::kInterpolated);
  }
  for (Finding& finding : findings) {
    const int end = finding.frame_end;
    bool all = finding.action == FindingAction::kDropped && finding.frame_begin < end && end <= motion.frame_count();
    for (int f = finding.frame_begin; all && f < end; ++f) all = is_bridged[static_cast<std::size_t>(f)];
    if (all) finding.action = FindingAction::kInterpolated;
  }
}

}  // namespace

Expected<std::vector<DamagedFrame>> BridgeFrames(const std::vector<int>& damaged, int frames, const std::string& name) {
  std::vector<DamagedFrame> bridged;
  if (frames > 0 && static_cast<int>(damaged.size()) >= frames) {
    return Fail(ErrorCode::kInconsistent, "none of " + Counted(frames, "frame") + " has valid values", name,
                "repair the file, or leave it out", Reason::kNoValidSamples);
  }
  for (std::size_t at = 0; at < damaged.size();) {
    std::size_t end = at + 1;
    while (end < damaged.size() && damaged[end] == damaged[end - 1] + 1) ++end;
    const int first = damaged[at], last = damaged[end - 1];
    const bool from = first > 0, to = last + 1 < frames;
    for (int f = first; f <= last; ++f) {
      const int before = from ? first - 1 : last + 1, after = to ? last + 1 : first - 1;
      const double share = before < after ? static_cast<double>(f - before) / (after - before) : 0.0;
      bridged.push_back({f, before, after, share});
    }
    at = end;
  }
  return bridged;
}

void Bridge(const std::vector<DamagedFrame>& bridged, int joints, std::vector<Vector3d>& root,
            std::vector<Quaterniond>& rotation) {
  const auto at = [](int frame) { return static_cast<std::size_t>(frame); };
  for (const DamagedFrame& damaged : bridged) {
    root[at(damaged.frame)] =
        (1.0 - damaged.share) * root[at(damaged.before)] + damaged.share * root[at(damaged.after)];
    for (int j = 0; j < joints; ++j) {
      const auto of = [&](int frame) {
        return at(frame) * static_cast<std::size_t>(joints) + static_cast<std::size_t>(j);
      };
      rotation[of(damaged.frame)] =
          rotation[of(damaged.before)].slerp(damaged.share, rotation[of(damaged.after)]).normalized();
    }
  }
}

Status AddMotion(const std::vector<int>& damaged, const SkeletonPtr& skeleton, const std::vector<double>& bone_length,
                 std::vector<Vector3d> root, std::vector<Quaterniond> rotation, const std::string& name,
                 IngestedClip& ingested) {
  const FrameRate rate = ingested.clip.rate;
  const auto bridged = BridgeFrames(damaged, static_cast<int>(root.size()), name);
  if (!bridged) return Forward(bridged);
  const auto joints = static_cast<std::size_t>(skeleton->joint_count());
  Bridge(*bridged, skeleton->joint_count(), root, rotation);
  for (std::size_t j = 0; j < joints; ++j) MakeSignContinuous(rotation.data() + j, root.size(), joints);
  ingested.clip.motion = MakeMotion(skeleton, rate, std::move(root), std::move(rotation), bone_length);
  MarkBridged(*bridged, *ingested.clip.motion, ingested.findings);
  return {};
}

std::optional<Finding> ApplyGapRule(const SourceOptions& source, IngestedClip& ingested) {
  if (DriverOf(source.format).stored || source.people.rule == TrackRule::kUestcReleased) return std::nullopt;
  std::vector<bool> observed = ObservedFrames(ingested.clip);
  const auto first = std::find(observed.begin(), observed.end(), true);
  if (first == observed.end()) return std::nullopt;  // a clip without frames, or refused for it by its reader
  const auto last = std::find(observed.rbegin(), observed.rend(), true);
  const FrameRun kept{static_cast<int>(first - observed.begin()), static_cast<int>(observed.rend() - last)};
  if (Status cut = CutUnobservedEnds(observed, kept, ingested); !cut) return std::nullopt;
  observed = {observed.begin() + kept.begin, observed.begin() + kept.end};

  const auto missing = static_cast<double>(std::count(observed.begin(), observed.end(), false));
  const double share = missing / static_cast<double>(observed.size());
  const double frame_s = ingested.clip.rate.FrameTime(1);
  if (source.max_gap_s != kMaxGap_s) ingested.clip.provenance[kDeclaredMaxGap] = FormatDouble(source.max_gap_s);
  const std::vector<double> times = FrameTimes(ingested.clip);
  const std::vector<JointState> states = GapStates(observed, times, frame_s, source.max_gap_s);
  std::vector<bool> inferred;
  for (const JointState state : states) inferred.push_back(state == JointState::kInferred);
  for (const FrameRun& run : RunsWhere(inferred, true)) {
    const double length_s =
        times[static_cast<std::size_t>(run.end)] - times[static_cast<std::size_t>(run.begin) - 1] - frame_s;
    Finding finding =
        FrameFinding("long_gap", run.begin, run.end, "", length_s,
                     "nothing is observed in " + Counted(run.frames(), "frame") + ", " + RoundedText(length_s, 3) +
                         " s (ingest.source.max_gap: " + FormatDouble(source.max_gap_s) + " s): they are inferred");
    finding.limit = source.max_gap_s;
    finding.action = FindingAction::kMissing;
    ingested.findings.push_back(std::move(finding));
    MarkInferred(run, ingested);
  }
  if (share <= source.max_missing) return std::nullopt;
  Finding finding = MakeFinding("mostly_missing", Severity::kError, share,
                                "nothing is observed in " + std::to_string(std::lround(missing)) + " of " +
                                    Counted(static_cast<long long>(observed.size()), "frame") +
                                    " (ingest.source.max_missing: " + FormatDouble(source.max_missing) + ")",
                                FindingAction::kExcluded);
  finding.limit = source.max_missing;
  return finding;
}

}  // namespace mocurate
