#include "ingest/checks/clip_checks.h"

#include <algorithm>

#include "core/base/text.h"
#include "core/quality/checks.h"
#include "core/quality/tracked_points.h"
#include "ingest/formats/driver.h"
#include "ingest/inspect/inspection.h"
#include "ingest/inspect/raw_clip.h"

namespace mocurate {
namespace {

constexpr int kMinMotionlessFrames = 5;  // of a clip that may be motionless

CheckLimits LimitsOf(const CheckOptions& options) {
  CheckLimits limits;
  limits.repeats = {static_cast<int>(options.Limit("frozen_frames", "frames")),
                    static_cast<int>(options.Limit("repeated_value", "frames"))};
  limits.position_jumps.speed = options.Limit("unrecovered_jump", "speed");
  limits.position_jumps.slack = options.Limit("position_jump", "distance");
  limits.position_jumps.reach = options.Limit("joint_far", "distance");
  limits.swaps.ratio = options.Limit("swapped_sides", "ratio");
  limits.swaps.step = options.Limit("swapped_sides", "step");
  limits.rigidity = {options.Limit("not_joint_positions", "spread"),
                     options.Limit("not_joint_positions", "proportion")};
  return limits;
}

/// Zero, collapsed and frozen frames together.
void CheckMotionless(const CheckOptions& options, int frames, std::vector<Finding>& findings) {
  std::vector<Finding> dead;
  for (const Finding& finding : findings) {
    if (finding.code != "zero_frames" && finding.code != "collapsed_frames" && finding.code != "frozen_frames")
      continue;
    dead.push_back(finding);
    dead.back().code = "motionless_clip";
  }
  const double share = CoveredShare(dead, "motionless_clip", frames);
  if (frames < kMinMotionlessFrames || share < options.Limit("motionless_clip", "share")) return;
  std::string what = "there is no motion or no person";
  for (const auto& [code, words] : {std::pair{"zero_frames", "all joints are at 0 0 0"},
                                    {"collapsed_frames", "all joints lie in one point"},
                                    {"frozen_frames", "there is no motion"}}) {
    if (CoveredShare(findings, code, frames) >= share) what = words;
  }
  // One cause is one finding: spans of the same frames become remarks.
  for (Finding& span : findings) {
    if (CoveredShare({span}, span.code, frames) > 0.0 &&
        (span.code == "zero_frames" || span.code == "collapsed_frames" || span.code == "frozen_frames"))
      span.severity = Severity::kInfo;
  }
  findings.push_back(
      MakeFinding("motionless_clip", Severity::kError, share,
                  what + " in " + Digits(100.0 * share) + " % of " + std::to_string(frames) + " frames"));
}

/// By `frames_in_name`, both ends included; may be less than 1.
std::optional<long long> DeclaredFrames(const SourceOptions& source, const NamedFile& named) {
  if (source.frames_in_name.empty()) return std::nullopt;
  const std::string text = FillFields(source.frames_in_name, named.fields);
  const std::size_t dash = text.find('-');
  const auto first = ParseInteger(text.substr(0, dash));
  const auto last = dash == std::string::npos ? std::nullopt : ParseInteger(text.substr(dash + 1));
  if (!first || !last) return std::nullopt;  // CheckName refuses such declarations; a name may still hold letters there
  return *last - *first + 1;
}

std::string SpanText(int begin, int end) { return std::to_string(begin) + "-" + std::to_string(end); }

}  // namespace

std::vector<Finding> FindDefects(const CheckOptions& options, const TrackedPoints& points,
                                 std::optional<double> rate_hz, bool metres, int lost_frames) {
  CheckLimits limits = LimitsOf(options);
  limits.position_jumps.lost_frames = lost_frames;
  limits.metres = metres;
  std::vector<Finding> findings = CheckPoints(points, rate_hz.value_or(0.0), limits);
  CheckMotionless(options, points.frames(), findings);
  if (points.frames() == 1) {
    findings.push_back(MakeFinding("single_frame", Severity::kInfo, 1.0, "the clip holds 1 frame: a pose, no motion"));
  }
  return findings;
}

void ExplainZeros(std::string_view format, std::vector<Finding>& findings) {
  const std::string zeros = DriverOf(format).zeros;
  for (Finding& finding : findings) {
    if (finding.code.rfind("zero_", 0) != 0) continue;
    finding.message += !zeros.empty() ? zeros
                                      : "; ingest.source.checks: {" + finding.code +
                                            ": {action: missing}} sets tracks there to missing";
  }
}

std::vector<Finding> FindNeverObserved(const TrackedPoints& points, const std::vector<Finding>& reported) {
  std::vector<char> seen(static_cast<std::size_t>(points.count()), 0);
  for (int f = 0; f < points.frames(); ++f) {
    for (int k = 0; k < points.count(); ++k) {
      if (points.sees(f, k)) seen[static_cast<std::size_t>(k)] = 1;
    }
  }
  if (std::count(seen.begin(), seen.end(), 1) == 0) return {};
  for (const Finding& finding : reported) {
    for (int k = 0; k < points.count(); ++k) {
      if (finding.joint == points.name(k)) seen[static_cast<std::size_t>(k)] = 1;
    }
  }
  const auto never = std::count(seen.begin(), seen.end(), 0);
  if (never == 0) return {};
  std::string names;
  for (int k = 0; k < points.count(); ++k) {
    if (seen[static_cast<std::size_t>(k)] == 0) names += (names.empty() ? "'" : ", '") + points.name(k) + "'";
  }
  return {MakeFinding("joint_never_seen", Severity::kInfo, static_cast<double>(never),
                      Counted(never, "joint") + " seen in none of " + Counted(points.frames(), "frame") +
                          ", while others are: " + names)};
}

bool InvalidatesPoses(const std::vector<Finding>& findings) { return HasFinding(findings, "angle_unit_contradiction"); }

namespace {

/// Frames that the name declares, by `frames_in_name`, and the file does not hold.
int FramesLost(const SourceOptions& source, const NamedFile& named, int frames) {
  const long long said = DeclaredFrames(source, named).value_or(0);
  return static_cast<int>(std::clamp(said - frames, 0LL, 1'000'000LL));
}

/// A rate that the source declares and the motion denies is an error, as any contradiction of a declaration.
void EscalateRateFindings(std::vector<Finding>& findings) {
  for (Finding& finding : findings) {
    if (finding.code != "rate_suspect") continue;
    finding.severity = Severity::kError;
    finding.message += "; correct ingest.source.rate";
  }
}

/// "name_contradiction" by `frames_in_name`: "{first}-{last}", both ends included. Annotation may have gaps, so that
/// fewer frames are right.
void JudgeName(const SourceOptions& source, const NamedFile& named, int frames, std::vector<Finding>& findings) {
  const std::optional<long long> said = DeclaredFrames(source, named);
  if (!said || frames <= *said) return;
  findings.push_back(FrameFinding("name_contradiction", 0, 0, "", frames,
                                  "the name declares " + std::to_string(std::max(0LL, *said)) + " frames (" +
                                      FillFields(source.frames_in_name, named.fields) + "), the file holds " +
                                      std::to_string(frames)));
}

OnFinding ActionFor(const CheckOptions& options, const std::string& code, const Clip& clip) {
  const OnFinding action = options.ActionFor(code);
  if (action != OnFinding::kDropRecorded) return action;
  return clip.evidence.tracks ? OnFinding::kDrop : OnFinding::kReport;
}

/// Frames that were taken from their neighbours are equal to them because of that.
void ExcludeBridged(const Clip& clip, std::vector<Finding>& findings) {
  if (!clip.motion || clip.motion->state.empty()) return;
  const Motion& motion = *clip.motion;
  const auto observed = [&](int f) {
    const auto first = static_cast<std::size_t>(f) * static_cast<std::size_t>(motion.joint_count());
    return motion.state[first] == JointState::kObserved || motion.state[first] == JointState::kRepaired;
  };
  const auto bridged = [&](const Finding& finding) {
    int frames = 0;
    for (int f = finding.frame_begin; f < finding.frame_end; ++f) frames += observed(f) ? 1 : 0;
    return finding.code == "frozen_frames" && frames < 2;
  };
  findings.erase(std::remove_if(findings.begin(), findings.end(), bridged), findings.end());
}

void TakeAsMissing(const Finding& finding, JointTracks& tracks) {
  const int joints = tracks.positions.joints;
  const int begin = finding.frame_end > finding.frame_begin ? finding.frame_begin : 0;
  const int end = finding.frame_end > finding.frame_begin ? finding.frame_end : tracks.positions.frames;
  for (int k = 0; k < joints; ++k) {
    if (!finding.joint.empty() && tracks.names[static_cast<std::size_t>(k)] != finding.joint) continue;
    for (int f = begin; f < end; ++f) {
      tracks.confidence[static_cast<std::size_t>(f) * joints + static_cast<std::size_t>(k)] = 0.0;
      tracks.positions.at(f, k).setZero();
      if (!tracks.rotation_confidence.empty())
        tracks.rotation_confidence[static_cast<std::size_t>(f) * joints + static_cast<std::size_t>(k)] = 0.0;
    }
  }
}

}  // namespace

ClipPoints::ClipPoints(const Clip& clip, const SkeletonPtr& skeleton) {
  if (clip.evidence.tracks) {
    const JointTracks& tracks = *clip.evidence.tracks;
    positions = &tracks.positions;
    confidence = &tracks.confidence;
    time_s = &tracks.time_s;
    names = tracks.names;
    if (skeleton) bones = BonesBetween(names, *skeleton);
    body = PointsOfBody(names, skeleton.get());
  } else if (clip.motion) {
    const Motion& motion = *clip.motion;
    positions = &motion.joints;
    for (int f = 0; f < motion.frame_count(); ++f) own_time_s.push_back(motion.rate.FrameTime(f));
    confidence = &own_confidence;
    time_s = &own_time_s;
    for (const Joint& joint : motion.skeleton->joints) names.push_back(joint.name);
    bones = BonesBetween(names, *motion.skeleton);
    body = PointsOfBody(*motion.skeleton);
  }
}

std::optional<DroppedClip> CheckClip(const SourceOptions& source, const NamedFile& named, IngestedClip& ingested) {
  const CheckOptions& options = source.checks;
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  const ClipPoints points(ingested.clip, skeleton ? *skeleton : nullptr);
  if (points.empty()) return std::nullopt;
  bool metres = true, contradicted = false;
  for (const Finding& finding : ingested.findings) {
    for (const char* code : {"units_contradiction", "up_contradiction", "handedness_contradiction"})
      contradicted = contradicted || finding.code == code;
    if (finding.code == "units_contradiction" || finding.code == "up_contradiction") metres = false;
  }
  std::vector<Finding> findings = FindDefects(options, points.view(), ingested.clip.rate.hz(), metres,
                                              FramesLost(source, named, points.positions->frames));
  ExplainZeros(source.format, findings);
  for (Finding& finding : FindNeverObserved(points.view(), ingested.findings)) findings.push_back(std::move(finding));
  if (InvalidatesPoses(ingested.findings)) {
    const auto shown = [](const Finding& finding) { return finding.code != "frozen_frames"; };
    findings.erase(std::remove_if(findings.begin(), findings.end(), shown), findings.end());
  }
  ExcludeBridged(ingested.clip, findings);
  if (source.rate_hz) EscalateRateFindings(findings);
  JudgeName(source, named, points.positions->frames, findings);
  std::optional<DroppedClip> dropped;
  for (Finding& finding : findings) {
    OnFinding action = ActionFor(options, finding.code, ingested.clip);
    // A wrong unit makes any clip look motionless: correct the declaration then.
    if (contradicted && finding.code == "motionless_clip" && action == OnFinding::kDrop) action = OnFinding::kReport;
    if (action == OnFinding::kIgnore) continue;
    if (action == OnFinding::kMissing && ingested.clip.evidence.tracks) {
      TakeAsMissing(finding, *ingested.clip.evidence.tracks);
      finding.action = FindingAction::kMissing;
    }
    if (action == OnFinding::kDrop) {
      finding.action = FindingAction::kDropped;
      if (!dropped) {
        dropped = DroppedClip{finding, finding.limit > 0.0 ? finding.limit : options.Threshold(finding.code)};
      }
    }
    ingested.findings.push_back(finding);
  }
  return dropped;
}

DuplicateLimits DuplicateLimitsOf(const CheckOptions& options) {
  return {options.Limit("duplicate", "distance"), static_cast<int>(options.Limit("shared_frames", "frames"))};
}

Finding DuplicateFinding(const Duplicate& pair, const std::string& first_name, const MotionSignature& first,
                         const MotionSignature& second) {
  const int frames = static_cast<int>(second.poses.size());
  const bool equal = pair.shared > 0 && pair.shared == frames && first.poses.size() == second.poses.size();
  if (!pair.whole) {
    return FrameFinding("shared_frames", pair.second_begin, pair.second_end, "", pair.shared,
                        std::to_string(pair.shared) + " of " + std::to_string(frames) + " frames are those of '" +
                            first_name + "' (" + SpanText(pair.second_begin, pair.second_end) + " here, " +
                            SpanText(pair.frame_begin, pair.frame_end) + " there)");
  }
  if (pair.mirrored) {
    return FrameFinding("mirrored_duplicate", 0, 0, "", pair.distance,
                        "the mirror image of '" + first_name + "' (" + Digits(pair.distance) + " m apart)");
  }
  if (equal) {
    return FrameFinding("duplicate", 0, 0, "", 0.0, "the same, frame for frame, as '" + first_name + "' (0 m apart)");
  }
  return FrameFinding("near_duplicate", 0, 0, "", pair.distance,
                      "the same motion as '" + first_name + "' (" + Digits(pair.distance) + " m apart)");
}

std::string FaultCode(const Error& error, std::string_view format) {
  if (error.reason == Reason::kCount) return "count_contradiction";
  if (error.code == ErrorCode::kNotFound || error.code == ErrorCode::kUnreadable) return "unreadable";
  if (error.reason == Reason::kUnsafePickle) return "unsafe_pickle";
  if (error.code == ErrorCode::kUnsupported) return "no_motion";
  if (error.code != ErrorCode::kMalformed && error.code != ErrorCode::kInconsistent) {
    return std::string(Name(error.code));
  }
  if (error.reason == Reason::kEmptyFile) return "empty_file";
  if (error.reason == Reason::kNoValidSamples) return "no_joint_seen";
  if (error.reason == Reason::kPersonMissing) return "people_missing";
  if (error.reason == Reason::kOtherTree) return "joints_contradiction";
  if (error.reason == Reason::kOtherLayout) return "layout_contradiction";
  if (error.reason == Reason::kOtherRate) return "rate_contradiction";
  if (error.reason == Reason::kViewNumbering) return "view_numbering";
  return error.code == ErrorCode::kInconsistent && DriverOf(format).lists_joints ? "layout_contradiction" : "malformed";
}

}  // namespace mocurate
