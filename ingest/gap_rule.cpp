#include "ingest/gap_rule.h"

#include <algorithm>
#include <cmath>

#include "core/base/text.h"
#include "core/motion/gaps.h"
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

}  // namespace

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
