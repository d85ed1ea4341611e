#include <algorithm>

#include "core/base/text.h"
#include "core/formats/ntu_skeleton.h"
#include "core/quality/tracked_points.h"
#include "ingest/people/choose_people.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

/// Names of skeleton ntu25 in the order of the file.
const char* const kJointNames[kNtuJoints] = {
    "spine_base",    "spine_mid",      "neck",           "head",        "left_shoulder", "left_elbow", "left_wrist",
    "left_hand",     "right_shoulder", "right_elbow",    "right_wrist", "right_hand",    "left_hip",   "left_knee",
    "left_ankle",    "left_foot",      "right_hip",      "right_knee",  "right_ankle",   "right_foot", "spine_shoulder",
    "left_hand_tip", "left_thumb",     "right_hand_tip", "right_thumb"};

double ConfidenceOf(const NtuJoint& joint, double inferred) {
  const bool nowhere = joint.x_m == 0.0 && joint.y_m == 0.0 && joint.z_m == 0.0;
  if (nowhere || joint.tracking == 0) return 0.0;
  return joint.tracking == 1 ? inferred : 1.0;
}

/// The ids of a file in metres and canonical axes, in the order in which they appear.
std::vector<PersonTrack> TracksOf(const NtuSkeleton& skeleton, const Matrix3d& canonical_from_source, double inferred) {
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
        const double confidence = ConfidenceOf(joint, inferred);
        const Vector3d raw(joint.x_m, joint.y_m, joint.z_m);
        const Vector3d place = confidence > 0.0 ? Vector3d(canonical_from_source * raw) : Vector3d(Vector3d::Zero());
        track->positions.xyz.insert(track->positions.xyz.end(), place.data(), place.data() + 3);
        track->confidence.push_back(confidence);
      }
    }
  }
  return tracks;
}

/// Who is who in the file.
Expected<People> PeopleOf(const NtuSkeleton& skeleton, const SourceOptions& source, std::size_t wanted) {
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<SkeletonPtr> tree = LoadSkeleton("ntu25");
  if (!tree) return Forward(tree);
  const PointBones bones =
      BonesBetween(std::vector<std::string>(std::begin(kJointNames), std::end(kJointNames)), **tree);
  const FrameRate rate = FrameRate::FromHz(*source.rate_hz);
  std::vector<double> time_s;
  for (std::size_t f = 0; f < skeleton.frames.size(); ++f) time_s.push_back(rate.FrameTime(static_cast<int>(f)));
  const PeopleOptions& options = source.people;
  const bool official = options.rule == TrackRule::kOfficial;
  std::vector<Finding> stitched;
  std::vector<PersonTrack> tracks = TracksOf(skeleton, axes->canonical_from_source, source.inferred_confidence);
  if (options.stitch && !official) {
    const StitchOptions limits{options.max_gap_s, options.max_speed, StitchOptions().slack, options.max_signature};
    tracks = StitchTracks(std::move(tracks), bones.parents, time_s, limits, stitched);
  }
  People people = ChoosePeople(std::move(tracks), wanted, options.rule, options.ghosts, GhostLimits(), bones.parents,
                               bones.rest_lengths, static_cast<int>(skeleton.frames.size()));
  people.findings.insert(people.findings.begin(), stitched.begin(), stitched.end());
  return people;
}

}  // namespace

Expected<IngestedClip> ReadNtuSkeletonClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  Expected<NtuSkeleton> skeleton = ParseNtuSkeleton(file.bytes, file.name, source.damaged_rows);
  if (!skeleton) return Forward(skeleton);
  const std::size_t wanted = static_cast<std::size_t>(std::max(1, file.named.bodies));
  const Expected<People> people = PeopleOf(*skeleton, source, wanted);
  if (!people) return Forward(people);
  const std::size_t own = static_cast<std::size_t>(std::max(1, file.named.body)) - 1;
  if (own >= people->chosen.size()) {
    return Fail(ErrorCode::kInconsistent,
                "body " + std::to_string(own + 1) + " of " + std::to_string(wanted) + " is not there: the file holds " +
                    Counted(static_cast<long long>(people->chosen.size()), "body id") + " in " +
                    Counted(static_cast<long long>(skeleton->frames.size()), "frame"),
                file.name, "the tracker lost the person: leave the file out, or mend ingest.source.bodies");
  }
  const PersonTrack& body = people->chosen[own];

  IngestedClip ingested;
  ingested.findings = std::move(skeleton->findings);
  ingested.findings.insert(ingested.findings.end(), people->findings.begin(), people->findings.end());
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  const int frames = static_cast<int>(skeleton->frames.size());
  JointTracks tracks;
  tracks.names.assign(std::begin(kJointNames), std::end(kJointNames));
  tracks.positions = JointPositions(frames, kNtuJoints);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * kNtuJoints, 0.0);
  for (int f = 0; f < frames; ++f) tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
  bool seen = false;
  for (std::size_t row = 0; row < body.frames.size(); ++row) {
    for (int j = 0; j < kNtuJoints; ++j) {
      if (!body.sees(row, j)) continue;
      seen = true;
      const int f = body.frames[row];
      const double confidence = body.confidence[row * kNtuJoints + static_cast<std::size_t>(j)];
      tracks.confidence[static_cast<std::size_t>(f) * kNtuJoints + static_cast<std::size_t>(j)] = confidence;
      tracks.positions.at(f, j) = body.positions.at(static_cast<int>(row), j);
    }
  }
  if (!seen) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(frames, "frame"), file.name,
                "the tracker lost the person: leave the file out");
  }
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.provenance["body_id"] = body.Name();
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
