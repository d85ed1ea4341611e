#include "ingest/inspect/check_report.h"

#include <algorithm>

#include "ingest/checks/clip_checks.h"
#include "ingest/inspect/inspection.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr double kUsualRate = 30.0;

/// Metres, y up, from units of the file; the heading is whatever it becomes.
Matrix3d MetresYUp(double metres, const std::string& up) {
  Matrix3d turn = Matrix3d::Identity();
  if (up.size() == 2 && up[1] >= 'x' && up[1] <= 'z') {
    Vector3d axis = Vector3d::Zero();
    axis[up[1] - 'x'] = up[0] == '-' ? -1.0 : 1.0;
    turn = SwingBetween(axis, Vector3d::UnitY()).toRotationMatrix();
  }
  return metres * turn;
}

/// What the file declares is zero stands there for the checks, as it does for whoever ingests it.
std::vector<double> CheckedConfidence(const RawClip& clip) {
  std::vector<double> confidence = clip.confidence;
  for (std::size_t i = 0; i < clip.zeros.size(); ++i) {
    if (clip.zeros[i] != 0) confidence[i] = 1.0;
  }
  return confidence;
}

/// A root that stays where it is while a joint that hangs on it carries the body through the world is no part of the
/// body.
void ExcludeIdleRoot(const RawClip& clip, std::vector<double>& confidence) {
  const int frames = clip.positions.frames, joints = clip.positions.joints;
  if (clip.parents.empty() || frames < 2) return;
  const auto moves = [&](int j) {
    const Vector3d first = clip.positions.at(0, j);
    for (int f = 1; f < frames; ++f) {
      if (clip.positions.at(f, j) != first) return true;
    }
    return false;
  };
  for (int root = 0; root < joints; ++root) {
    if (clip.parents[static_cast<std::size_t>(root)] >= 0 || moves(root)) continue;
    bool carried = false;
    for (int j = 0; j < joints && !carried; ++j)
      carried = clip.parents[static_cast<std::size_t>(j)] == root && moves(j);
    if (!carried) continue;
    if (confidence.empty()) confidence.assign(static_cast<std::size_t>(frames) * static_cast<std::size_t>(joints), 1.0);
    for (int f = 0; f < frames; ++f)
      confidence[static_cast<std::size_t>(f) * static_cast<std::size_t>(joints) + static_cast<std::size_t>(root)] = 0.0;
  }
}

/// A clip in metres with y up.
struct ClipInMetres {
  ClipInMetres(const RawClip& clip, const std::string& units, const std::string& up, double rate_hz);
  TrackedPoints view(const RawClip& clip) const {
    return {positions, confidence, time_s, clip.names, bones.parents, bones.rest_lengths, clip.points};
  }

  bool known = false;  ///< unit and up are
  JointPositions positions;
  std::vector<double> confidence;
  std::vector<double> time_s;
  PointBones bones;
};

ClipInMetres::ClipInMetres(const RawClip& clip, const std::string& units, const std::string& up, double rate_hz)
    : positions(clip.positions.frames, clip.positions.joints), confidence(clip.confidence) {
  const auto metres = MetresPerUnit(units);
  known = metres.has_value() && !up.empty();
  const Matrix3d map = MetresYUp(metres ? *metres : 1.0, up);
  for (int f = 0; f < positions.frames; ++f) {
    const bool counted = static_cast<int>(clip.frame_numbers.size()) == positions.frames;
    time_s.push_back((counted ? clip.frame_numbers[static_cast<std::size_t>(f)] - clip.frame_numbers[0] : f) / rate_hz);
    for (int j = 0; j < positions.joints; ++j) positions.at(f, j) = map * clip.positions.at(f, j);
  }
  // An order that was guessed by its bones says nothing new of them.
  if (clip.skeleton.from != Provenance::kDeclared || static_cast<int>(clip.names.size()) != clip.joints) return;
  if (const auto skeleton = KnownSkeleton(clip.skeleton.value.value_or("")))
    bones = BonesBetween(clip.names, **skeleton);
}

/// A body that goes where its markers do not: its path stands in the file beside theirs.
void CheckPath(const RawClip& clip, const CheckOptions& options, const ClipInMetres& markers, const std::string& up,
               std::vector<Finding>& found) {
  if (clip.posed.empty() || !markers.known) return;
  RawClip body;
  body.positions = clip.posed;
  const ClipInMetres metres(body, "m", up, kUsualRate);
  const TrackedPoints points{metres.positions, metres.confidence, markers.time_s};
  for (const Finding& finding : FindDefects(options, points, std::nullopt, true)) {
    const auto same = [&](const Finding& other) {
      return other.code == finding.code && other.frame_begin < finding.frame_end &&
             finding.frame_begin < other.frame_end;
    };
    if (finding.code == "position_jump" && std::none_of(found.begin(), found.end(), same)) found.push_back(finding);
  }
}

}  // namespace

std::string PlaceOf(const Finding& finding, const std::string& where) {
  std::string place = where;
  if (finding.frame_end > finding.frame_begin) {
    place += " frames " + std::to_string(finding.frame_begin) + "-" + std::to_string(finding.frame_end);
  }
  if (!finding.joint.empty()) place += " joint " + finding.joint;
  return place;
}

MotionSignature SignatureShown(const RawClip& clip, const std::string& units, const std::string& up) {
  if (clip.positions.empty()) return {};
  const ClipInMetres metres(clip, units, up, kUsualRate);
  return metres.known ? SignatureOf(metres.view(clip)) : MotionSignature();
}

RateLimits RateShown(const RawClip& clip, const std::string& units, const std::string& up) {
  if (clip.positions.empty()) return {};
  const ClipInMetres metres(clip, units, up, kUsualRate);
  return metres.known ? MeasureRate(metres.view(clip)) : RateLimits();
}

void ReportChecks(const RawClip& clip, const std::string& units, const std::string& up, const std::string& where,
                  std::vector<Finding>& findings) {
  if (clip.positions.empty() || units == "px") return;
  const std::optional<double> rate = clip.rate_finding ? std::nullopt : clip.rate_hz;
  ClipInMetres metres(clip, units, up, rate.value_or(kUsualRate));
  metres.confidence = CheckedConfidence(clip);
  std::vector<Finding> unseen = FindNeverObserved(metres.view(clip));
  ExcludeIdleRoot(clip, metres.confidence);
  const CheckOptions options;
  std::vector<Finding> found = FindDefects(options, metres.view(clip), rate, metres.known, rate ? 0 : kLostWithoutRate);
  ExplainZeros(clip.format, found);
  found.insert(found.end(), std::make_move_iterator(unseen.begin()), std::make_move_iterator(unseen.end()));
  CheckPath(clip, options, metres, up, found);
  if (!HasFinding(clip.remarks, "no_joint_seen")) {
    std::vector<Finding> remarks = clip.remarks;
    const auto before = static_cast<std::ptrdiff_t>(remarks.size());
    NoteEmptyFrames(metres.confidence, metres.positions.frames, remarks);
    found.insert(found.end(), remarks.begin() + before, remarks.end());
  }
  for (const Finding& finding : found) {
    if (options.ActionFor(finding.code) == OnFinding::kIgnore || HasFinding(clip.remarks, finding.code)) continue;
    // A tree's joint may lie at its origin, and a root whose path is not there does.
    if (finding.code == "zero_joint" && (!clip.parents.empty() || HasFinding(clip.remarks, "path_missing"))) continue;
    findings.push_back(FindingAt(PlaceOf(finding, where), Rounded(finding)));
  }
}

}  // namespace mocurate
