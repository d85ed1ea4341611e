#include "ingest/sources/ntu_people.h"

#include <algorithm>
#include <cmath>

#include "core/base/median.h"
#include "core/base/text.h"
#include "core/quality/checks.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

/// Names of skeleton ntu25 in the order of the file.
const char* const kJointNames[kNtuJoints] = {
    "spine_base",    "spine_mid",      "neck",           "head",        "left_shoulder", "left_elbow", "left_wrist",
    "left_hand",     "right_shoulder", "right_elbow",    "right_wrist", "right_hand",    "left_hip",   "left_knee",
    "left_ankle",    "left_foot",      "right_hip",      "right_knee",  "right_ankle",   "right_foot", "spine_shoulder",
    "left_hand_tip", "left_thumb",     "right_hand_tip", "right_thumb"};

double TrackingConfidence(const NtuJoint& joint, double inferred) {
  const bool nowhere = joint.x_m == 0.0 && joint.y_m == 0.0 && joint.z_m == 0.0;
  if (nowhere || joint.tracking == 0) return 0.0;
  return joint.tracking == 1 ? inferred : 1.0;
}

/// The ids of a file in metres and canonical axes, in the order in which they appear.
std::vector<PersonTrack> TracksOfIds(const NtuSkeleton& skeleton, const Matrix3d& canonical_from_source,
                                     double inferred) {
  std::vector<PersonTrack> tracks;
  for (std::size_t f = 0; f < skeleton.frames.size(); ++f) {
    for (const NtuBody& body : skeleton.frames[f]) {
      auto track =
          std::find_if(tracks.begin(), tracks.end(), [&](const PersonTrack& t) { return t.ids[0] == body.id; });
      if (track == tracks.end()) {
        track = tracks.insert(track, PersonTrack{{body.id}, {}, {}, {}});
        track->positions.joints = kNtuJoints;
      }
      track->frames.push_back(static_cast<int>(f));
      ++track->positions.frames;
      for (const NtuJoint& joint : body.joints) {
        const double confidence = TrackingConfidence(joint, inferred);
        const Vector3d raw(joint.x_m, joint.y_m, joint.z_m);
        const Vector3d place = confidence > 0.0 ? Vector3d(canonical_from_source * raw) : Vector3d(Vector3d::Zero());
        track->positions.xyz.insert(track->positions.xyz.end(), place.data(), place.data() + 3);
        track->confidence.push_back(confidence);
      }
    }
  }
  return tracks;
}

/// Line through (x, y): intercept and slope, without points farther off than `off`; nothing where x hardly varies.
struct DepthLine {
  double intercept = 0.0, slope = 0.0, off = 0.0;  ///< off: median distance in y
};

std::optional<DepthLine> LineThrough(const std::vector<Vector2d>& points) {
  constexpr std::size_t kFewest = 100;
  constexpr double kNarrow = 0.02;
  constexpr double kFar = 1.0;  // pixels
  DepthLine line;
  bool started = false;
  for (int pass = 0; pass < 3; ++pass) {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (const Vector2d& p : points) {
      if (started && std::abs(p.y() - line.intercept - line.slope * p.x()) > std::max(kFar, 4.0 * line.off)) continue;
      n += 1.0, x += p.x(), y += p.y(), xx += p.x() * p.x(), xy += p.x() * p.y();
    }
    if (n < static_cast<double>(kFewest)) return std::nullopt;
    const double variance = xx / n - (x / n) * (x / n);
    if (variance < kNarrow * kNarrow) return std::nullopt;
    line.slope = (xy / n - (x / n) * (y / n)) / variance;
    line.intercept = y / n - line.slope * x / n;
    std::vector<double> off;
    for (const Vector2d& p : points) off.push_back(std::abs(p.y() - line.intercept - line.slope * p.x()));
    line.off = Median(std::move(off));
    started = true;
  }
  return line;
}

}  // namespace

std::vector<std::string> NtuJointNames() { return {std::begin(kJointNames), std::end(kJointNames)}; }

std::optional<std::array<double, 4>> NtuIntrinsics(const NtuSkeleton& skeleton) {
  constexpr double kMaxMismatch = 0.5;  // pixels
  std::vector<Vector2d> across, down;
  for (const std::vector<NtuBody>& bodies : skeleton.frames) {
    for (const NtuBody& body : bodies) {
      for (const NtuJoint& joint : body.joints) {
        if (joint.tracking != 2 || joint.z_m <= 0.0) continue;
        across.emplace_back(joint.x_m / joint.z_m, joint.depth_u);
        down.emplace_back(-joint.y_m / joint.z_m, joint.depth_v);
      }
    }
  }
  const std::optional<DepthLine> u = LineThrough(across), v = LineThrough(down);
  if (!u || !v || u->off > kMaxMismatch || v->off > kMaxMismatch) return std::nullopt;
  return std::array<double, 4>{u->slope, v->slope, u->intercept, v->intercept};
}

Expected<People> NtuPeople(const NtuSkeleton& skeleton, const SourceOptions& source, std::size_t wanted) {
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<SkeletonPtr> tree = LoadSkeleton("ntu25");
  if (!tree) return Forward(tree);
  const PointBones bones = BonesBetween(NtuJointNames(), **tree);
  const FrameRate rate = FrameRate::FromHz(*source.rate_hz);
  std::vector<double> time_s;
  for (std::size_t f = 0; f < skeleton.frames.size(); ++f) time_s.push_back(rate.FrameTime(static_cast<int>(f)));
  const PeopleOptions& options = source.people;
  std::vector<Finding> stitched;
  std::vector<PersonTrack> tracks = TracksOfIds(skeleton, axes->canonical_from_source, source.inferred_confidence);
  tracks = JoinIds(std::move(tracks), options, bones.parents, time_s, stitched);
  People people = ChoosePeople(std::move(tracks), wanted, options.rule, options.false_tracks, bones.parents,
                               bones.rest_lengths, static_cast<int>(skeleton.frames.size()));
  people.findings.insert(people.findings.begin(), stitched.begin(), stitched.end());
  return people;
}

void NoteZeroJoints(const NtuSkeleton& skeleton, const PersonTrack& body, std::vector<Finding>& findings) {
  const int frames = static_cast<int>(skeleton.frames.size());
  JointPositions positions(frames, kNtuJoints);
  std::vector<double> followed(static_cast<std::size_t>(frames) * kNtuJoints, 0.0), time_s;
  for (int f = 0; f < frames; ++f) {
    time_s.push_back(f);
    for (const NtuBody& person : skeleton.frames[static_cast<std::size_t>(f)]) {
      if (std::find(body.ids.begin(), body.ids.end(), person.id) == body.ids.end()) continue;
      for (int j = 0; j < kNtuJoints; ++j) {
        const NtuJoint& joint = person.joints[static_cast<std::size_t>(j)];
        if (joint.tracking == 0) continue;
        positions.at(f, j) = Vector3d(joint.x_m, joint.y_m, joint.z_m);
        followed[static_cast<std::size_t>(f) * kNtuJoints + static_cast<std::size_t>(j)] = 1.0;
      }
    }
  }
  for (Finding& finding : FindBlanks({positions, followed, time_s, NtuJointNames()})) {
    if (finding.code != "zero_joint") continue;
    finding.action = FindingAction::kMissing;
    finding.message += "; set to missing";
    findings.push_back(std::move(finding));
  }
}

void NoteInferredJoints(const NtuSkeleton& skeleton, const PersonTrack& body, std::vector<Finding>& findings) {
  constexpr double kManyInferred = 0.3;
  int present = 0, inferred = 0;
  for (const std::vector<NtuBody>& frame : skeleton.frames) {
    for (const NtuBody& person : frame) {
      if (std::find(body.ids.begin(), body.ids.end(), person.id) == body.ids.end()) continue;
      ++present;
      for (const NtuJoint& joint : person.joints) inferred += joint.tracking == 1 ? 1 : 0;
    }
  }
  if (inferred == 0) return;
  const double share = static_cast<double>(inferred) / (present * kNtuJoints);
  findings.push_back(MakeFinding("inferred_joints", share > kManyInferred ? Severity::kWarning : Severity::kInfo, share,
                                 "the sensor inferred " + FormatDouble(std::round(1000.0 * share) / 10.0) +
                                     " % of the joints (tracking state 1) instead of observing them"));
}

}  // namespace mocurate
