#include <algorithm>
#include <map>

#include "core/base/text.h"
#include "core/formats/ntu_skeleton.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

constexpr double kPresent = 0.5;  // share of the frames of the body that is there longest

/// Names of skeleton ntu25 in the order of the file.
const char* const kJointNames[kNtuJoints] = {
    "spine_base",    "spine_mid",      "neck",           "head",        "left_shoulder", "left_elbow", "left_wrist",
    "left_hand",     "right_shoulder", "right_elbow",    "right_wrist", "right_hand",    "left_hip",   "left_knee",
    "left_ankle",    "left_foot",      "right_hip",      "right_knee",  "right_ankle",   "right_foot", "spine_shoulder",
    "left_hand_tip", "left_thumb",     "right_hand_tip", "right_thumb"};

/// One id of the file.
struct Track {
  std::uint64_t id = 0;
  std::map<int, const NtuBody*> frames;
  double energy = 0.0;  ///< summed variance of its joints, m2
};

double Energy(const Track& track) {
  double energy = 0.0;
  for (int j = 0; j < kNtuJoints; ++j) {
    Vector3d sum = Vector3d::Zero();
    double squares = 0.0, count = 0.0;
    for (const auto& [frame, body] : track.frames) {
      const NtuJoint& joint = body->joints[static_cast<std::size_t>(j)];
      if (joint.tracking == 0) continue;
      const Vector3d place(joint.x_m, joint.y_m, joint.z_m);
      sum += place;
      squares += place.squaredNorm();
      count += 1.0;
    }
    if (count > 0.0) energy += squares / count - (sum / count).squaredNorm();
  }
  return energy;
}

/// In the order in which they appear.
std::vector<Track> TracksOf(const NtuSkeleton& skeleton) {
  std::vector<Track> tracks;
  for (std::size_t f = 0; f < skeleton.frames.size(); ++f) {
    for (const NtuBody& body : skeleton.frames[f]) {
      auto track = std::find_if(tracks.begin(), tracks.end(), [&](const Track& t) { return t.id == body.id; });
      if (track == tracks.end()) track = tracks.insert(track, Track{body.id, {}, 0.0});
      track->frames[static_cast<int>(f)] = &body;
    }
  }
  for (Track& track : tracks) track.energy = Energy(track);
  return tracks;
}

/// Indices of the `count` people: those there for half as long as the longest before the others, by what they move;
/// the others by how long they are there. Given in the order in which they appear.
std::vector<std::size_t> Choose(const std::vector<Track>& tracks, std::size_t count) {
  std::size_t longest = 0;
  for (const Track& track : tracks) longest = std::max(longest, track.frames.size());
  const auto present = [&](std::size_t i) {
    return static_cast<double>(tracks[i].frames.size()) >= kPresent * static_cast<double>(longest);
  };
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < tracks.size(); ++i) order.push_back(i);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (present(a) != present(b)) return present(a);
    return present(a) ? tracks[a].energy > tracks[b].energy : tracks[a].frames.size() > tracks[b].frames.size();
  });
  order.resize(std::min(count, order.size()));
  std::sort(order.begin(), order.end());
  return order;
}

double ConfidenceOf(const NtuJoint& joint, double inferred) {
  const bool nowhere = joint.x_m == 0.0 && joint.y_m == 0.0 && joint.z_m == 0.0;
  if (nowhere || joint.tracking == 0) return 0.0;
  return joint.tracking == 1 ? inferred : 1.0;
}

Finding BodiesLeftOut(const std::vector<Track>& tracks, const std::vector<std::size_t>& chosen) {
  std::string which;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    if (std::find(chosen.begin(), chosen.end(), i) != chosen.end()) continue;
    which += (which.empty() ? "" : ", ") + std::to_string(tracks[i].id) + " in " +
             Counted(static_cast<long long>(tracks[i].frames.size()), "frame");
  }
  Finding finding;
  finding.code = "bodies_left_out";
  finding.value = static_cast<double>(tracks.size() - chosen.size());
  finding.message = "the file holds " + std::to_string(tracks.size()) + " body ids, ingest.source.bodies asks for " +
                    std::to_string(chosen.size()) + "; not taken: " + which;
  finding.action = "left out";
  return finding;
}

}  // namespace

Expected<IngestedClip> ReadNtuSkeletonClip(const SourceFile& file) {
  const SourceOptions& source = file.source;
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  Expected<NtuSkeleton> skeleton = ParseNtuSkeleton(file.bytes, file.name, source.damaged_rows);
  if (!skeleton) return Forward(skeleton);
  const std::vector<Track> bodies = TracksOf(*skeleton);
  const std::size_t wanted = static_cast<std::size_t>(std::max(1, file.named.bodies));
  const std::vector<std::size_t> chosen = Choose(bodies, wanted);
  const std::size_t own = static_cast<std::size_t>(std::max(1, file.named.body)) - 1;
  if (own >= chosen.size()) {
    return Fail(ErrorCode::kInconsistent,
                "body " + std::to_string(own + 1) + " of " + std::to_string(wanted) + " is not there: the file holds " +
                    Counted(static_cast<long long>(bodies.size()), "body id") + " in " +
                    Counted(static_cast<long long>(skeleton->frames.size()), "frame"),
                file.name, "the tracker lost the person: leave the file out, or mend ingest.source.bodies");
  }
  const Track& body = bodies[chosen[own]];

  IngestedClip ingested;
  ingested.findings = std::move(skeleton->findings);
  if (bodies.size() > chosen.size()) ingested.findings.push_back(BodiesLeftOut(bodies, chosen));
  ingested.clip.rate = FrameRate::FromHz(*source.rate_hz);
  const int frames = static_cast<int>(skeleton->frames.size());
  JointTracks tracks;
  tracks.names.assign(std::begin(kJointNames), std::end(kJointNames));
  tracks.positions = JointPositions(frames, kNtuJoints);
  tracks.confidence.assign(static_cast<std::size_t>(frames) * kNtuJoints, 0.0);
  for (int f = 0; f < frames; ++f) tracks.time_s.push_back(ingested.clip.rate.FrameTime(f));
  bool seen = false;
  for (const auto& [f, observed] : body.frames) {
    for (int j = 0; j < kNtuJoints; ++j) {
      const NtuJoint& joint = observed->joints[static_cast<std::size_t>(j)];
      const double confidence = ConfidenceOf(joint, source.inferred_confidence);
      if (confidence <= 0.0) continue;
      seen = true;
      tracks.confidence[static_cast<std::size_t>(f) * kNtuJoints + static_cast<std::size_t>(j)] = confidence;
      tracks.positions.at(f, j) = axes->canonical_from_source * Vector3d(joint.x_m, joint.y_m, joint.z_m);
    }
  }
  if (!seen) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(frames, "frame"), file.name,
                "the tracker lost the person: leave the file out");
  }
  NoteEmptyFrames(tracks, ingested.findings);
  ingested.clip.provenance["body_id"] = std::to_string(body.id);
  ingested.clip.evidence.tracks = std::move(tracks);
  return ingested;
}

}  // namespace mocurate
