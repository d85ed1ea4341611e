#include "fitting/evidence/motion_tracks.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/base/json_text.h"
#include "core/base/resources.h"
#include "core/motion/gaps.h"
#include "core/motion/operations.h"
#include "fitting/fit_result.h"

namespace mocurate {

JointTracks SelectedTracks(const JointTracks& tracks, const std::vector<std::optional<std::string>>& names) {
  const std::size_t points = names.size();
  std::vector<std::size_t> kept;
  JointTracks renamed;
  renamed.time_s = tracks.time_s;
  for (std::size_t k = 0; k < points; ++k) {
    if (!names[k]) continue;
    kept.push_back(k);
    renamed.names.push_back(*names[k]);
  }
  renamed.positions = JointPositions(tracks.positions.frames, static_cast<int>(kept.size()));
  for (int f = 0; f < tracks.positions.frames; ++f) {
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const std::size_t at = static_cast<std::size_t>(f) * points + kept[i];
      renamed.positions.at(f, static_cast<int>(i)) = tracks.positions.at(f, static_cast<int>(kept[i]));
      renamed.confidence.push_back(tracks.confidence[at]);
      if (tracks.rotation.empty()) continue;
      renamed.rotation.push_back(tracks.rotation[at]);
      renamed.rotation_confidence.push_back(tracks.rotation_confidence[at]);
    }
  }
  return renamed;
}

namespace {

/// Tracks of joints that the skeleton has, or of its landmarks; the names of the others.
JointTracks TracksOfSkeleton(const JointTracks& tracks, const Skeleton& skeleton, std::vector<std::string>& unknown) {
  std::vector<std::optional<std::string>> names;
  for (const std::string& name : tracks.names) {
    const bool known =
        skeleton.FindJoint(name) || std::any_of(skeleton.landmarks.begin(), skeleton.landmarks.end(),
                                                [&](const Landmark& landmark) { return landmark.name == name; });
    names.push_back(known ? std::optional(name) : std::nullopt);
    if (!known) unknown.push_back(name);
  }
  return SelectedTracks(tracks, names);
}

/// (F*J) Samples of the motion that are evidence: not interpolated ones, which the fit interpolates itself, nor frames
/// that are inferred throughout. Inferred joints of other frames are, where the motion states how uncertain they are.
std::vector<bool> EvidenceOf(const Motion& motion) {
  const auto joints = static_cast<std::size_t>(motion.joint_count());
  std::vector<bool> evidence(joints * static_cast<std::size_t>(motion.frame_count()), true);
  const std::vector<bool> inferred = InferredFrames(motion);
  const bool uncertain = !motion.rotation_sigma.empty() || !motion.position_cov.empty();
  for (std::size_t at = 0; at < motion.state.size(); ++at) {
    const bool is_inferred = inferred[at / joints] || (motion.state[at] == JointState::kInferred && !uncertain);
    evidence[at] = !is_inferred && motion.state[at] != JointState::kInterpolated;
  }
  return evidence;
}

/// World rotations of the motion's joints `common`; none for end joints, whose rotation in a motion is arbitrary.
void AddRotations(const Motion& motion, const std::vector<int>& common, const std::vector<bool>& evidence,
                  JointTracks& tracks) {
  const Skeleton& skeleton = *motion.skeleton;
  const std::vector<std::vector<int>> children = skeleton.Children();
  std::vector<Quaterniond> world(skeleton.joints.size());
  for (int f = 0; f < motion.frame_count(); ++f) {
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const int parent = skeleton.joints[j].parent;
      world[j] = parent < 0 ? motion.rotation_at(f, j) : (world[parent] * motion.rotation_at(f, j)).normalized();
    }
    for (const int joint : common) {
      tracks.rotation.push_back(world[joint]);
      const std::size_t at = static_cast<std::size_t>(f) * skeleton.joints.size() + static_cast<std::size_t>(joint);
      const bool none = children[joint].empty() || !evidence[at];
      tracks.rotation_confidence.push_back(none ? 0.0 : 1.0);
    }
  }
}

}  // namespace

Expected<JointTracks> TracksOfMotion(const Motion& motion, const Skeleton& skeleton) {
  const std::vector<int> match = MatchJoints(*motion.skeleton, skeleton);
  std::vector<int> common;
  JointTracks tracks;
  for (int joint = 0; joint < skeleton.joint_count(); ++joint) {
    if (match[joint] < 0) continue;
    common.push_back(match[joint]);
    tracks.names.push_back(skeleton.joints[joint].name);
  }
  if (common.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "the skeletons '" + motion.skeleton->name + "' and '" + skeleton.name + "' have no joint in common",
                "motion", "add synonyms to the skeleton, or choose another");
  }
  tracks.positions = JointPositions(motion.frame_count(), static_cast<int>(common.size()));
  tracks.confidence.assign(tracks.positions.xyz.size() / 3, 1.0);
  const std::vector<bool> evidence = EvidenceOf(motion);
  for (int f = 0; f < motion.frame_count(); ++f) {
    tracks.time_s.push_back(motion.rate.FrameTime(f));
    for (int k = 0; k < tracks.positions.joints; ++k) {
      tracks.positions.at(f, k) = motion.joints.at(f, common[k]);
      const std::size_t at = static_cast<std::size_t>(f) * motion.skeleton->joints.size();
      if (!evidence[at + static_cast<std::size_t>(common[k])])
        tracks.confidence[static_cast<std::size_t>(f) * common.size() + k] = 0.0;
    }
  }
  if (!motion.joints_only()) AddRotations(motion, common, evidence, tracks);
  return tracks;
}

namespace {

/// Confidences only compare samples of one clip. They are scaled so that the 90th percentile is 1, whatever scale a
/// tracker uses.
void RelateConfidences(SkeletonTracks& tracks) {
  std::vector<double> there;
  for (const double confidence : tracks.confidence) {
    if (confidence > 0.0) there.push_back(confidence);
  }
  if (there.empty()) return;
  const auto high = there.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(there.size() - 1));
  std::nth_element(there.begin(), high, there.end());
  const double usual = *high;
  for (double& confidence : tracks.confidence) confidence = std::min(1.0, confidence / usual);
}

}  // namespace

namespace {

/// Metres per axis: markers move with the skin by 5 to 20 mm (Leardini et al., Gait & Posture 21, 2005).
constexpr double kSkinSigma = 0.005;

}  // namespace

Expected<SkeletonTracks> TracksOfClip(const Clip& clip, const SkeletonPtr& skeleton, OtherJoints other,
                                      std::vector<std::string>* excluded) {
  Expected<JointTracks> given;
  const TrackerPoints points = TrackerPointsOf(clip, *skeleton);
  const JointTracks* tracks = clip.evidence.tracks ? &*clip.evidence.tracks : nullptr;
  std::vector<std::string> unknown;
  if (!points.unknown.empty()) {
    return Fail(ErrorCode::kInconsistent,
                "skeleton '" + skeleton->name + "' lacks the joints of the markers " + points.unknown, clip.id(),
                "correct ingest.source.markers, or fit the skeleton that they are of");
  }
  if (points.tracker) {
    given = OnBodyOf(points, *tracks, *skeleton);
    tracks = &*given;
  }
  if (tracks != nullptr && (other == OtherJoints::kLeaveOut || points.markers)) {
    given = JointTracks(TracksOfSkeleton(*tracks, *skeleton, unknown));
    tracks = &*given;
  }
  if (tracks == nullptr && clip.motion) {
    given = TracksOfMotion(*clip.motion, *skeleton);
    if (!given) return InClip(given.error(), clip);
    tracks = &*given;
  }
  if (tracks == nullptr) {
    return Fail(ErrorCode::kInconsistent, "the clip has no joint tracks", clip.id(),
                !clip.evidence.keypoint_views.empty() ? "set fitting.method to keypoints for 2-D keypoints"
                : !SurfaceTimes(clip.evidence).empty()
                    ? "set fitting.method to point_clouds for depth views and point clouds"
                    : "set fitting.method to what its source gives");
  }
  Expected<SkeletonTracks> mapped = MapTracks(*tracks, skeleton);
  if (!mapped) return InClip(mapped.error(), clip);
  RelateConfidences(*mapped);
  mapped->place_sigma = PlaceSigmas(points, *skeleton);
  if (points.markers) mapped->least_sigma = kSkinSigma;
  if (excluded != nullptr) *excluded = std::move(unknown);
  return mapped;
}

namespace {

constexpr char kPrefix[] = "tracked_";

bool IsTrackedPoint(const Joint& joint) { return joint.landmark && joint.name.rfind(kPrefix, 0) == 0; }

const PointPlace* PlaceOf(const TrackerPoints& points, const std::string& name) {
  const auto found = std::find_if(points.places.begin(), points.places.end(),
                                  [&](const PointPlace& place) { return place.point == name; });
  return found == points.places.end() ? nullptr : &*found;
}

}  // namespace

namespace {

/// "RKNE" of "LKNE", "Right_Knee" of "Left_Knee"; empty for a name that begins with neither side.
std::string PartnerOf(const std::string& name) {
  for (const auto& [left, right] : {std::pair("Left", "Right"), {"left", "right"}, {"L", "R"}}) {
    for (const auto& [from, to] : {std::pair(left, right), {right, left}}) {
      if (name.rfind(from, 0) == 0) return to + name.substr(std::string(from).size());
    }
  }
  return "";
}

/// The markers as a tracker's skeleton: all hang from the first.
TrackerPoints MarkersOf(const std::string& json, const Skeleton& body) {
  TrackerPoints points;
  points.markers = true;
  auto tracker = std::make_shared<Skeleton>();
  tracker->name = kMarkers;
  for (const nlohmann::json& marker : ParseJson(json, kMarkers).value_or(nlohmann::json::array())) {
    PointPlace place{marker.at("point"), marker.at("joint"), {}, marker.at("spread")};
    for (int k = 0; k < 3; ++k) place.offset[k] = marker.at("offset").at(static_cast<std::size_t>(k));
    if (!body.FindJoint(place.joint)) {
      points.unknown += (points.unknown.empty() ? "" : ", ") + place.point + " (" + place.joint + ")";
      continue;
    }
    Joint joint;
    joint.name = place.point;
    joint.parent = tracker->joints.empty() ? -1 : 0;
    joint.mirror = tracker->joint_count();
    for (int j = 0; j < tracker->joint_count(); ++j) {
      Joint& other = tracker->joints[static_cast<std::size_t>(j)];
      if (other.name != PartnerOf(place.point)) continue;
      other.mirror = joint.mirror;
      joint.mirror = j;
    }
    tracker->joints.push_back(std::move(joint));
    points.places.push_back(std::move(place));
  }
  if (!points.places.empty()) points.tracker = std::move(tracker);
  return points;
}

}  // namespace

TrackerPoints TrackerPointsOf(const Clip& clip, const Skeleton& body) {
  TrackerPoints points;
  if (const auto markers = clip.provenance.find(kMarkers); clip.evidence.tracks && markers != clip.provenance.end())
    return MarkersOf(markers->second, body);
  const auto source = clip.provenance.find(kSourceSkeleton);
  if (!clip.evidence.tracks || source == clip.provenance.end() || source->second == body.name) return points;
  if (!FindResource("skeletons/" + source->second + ".yaml")) return points;
  const auto of_body = LoadPointPlaces(body.name);
  if (of_body && !of_body->empty()) return points;
  auto places = LoadPointPlaces(source->second);
  auto tracker = LoadSkeleton(source->second);
  if (!places || !tracker) return points;
  for (PointPlace& place : *places) {
    if (body.FindJoint(place.joint)) points.places.push_back(std::move(place));
  }
  if (!points.places.empty()) points.tracker = *std::move(tracker);
  return points;
}

std::string TrackedName(const std::string& point) { return kPrefix + point; }

SkeletonPtr WithTrackerPoints(const SkeletonPtr& skeleton, const Clip& clip) {
  const TrackerPoints points = TrackerPointsOf(clip, *skeleton);
  if (!points.tracker) return skeleton;
  auto body = std::make_shared<Skeleton>(*skeleton);
  for (const PointPlace& place : points.places) {
    Joint point;
    point.name = TrackedName(place.point);
    point.parent = *skeleton->FindJoint(place.joint);
    point.rest_offset = place.offset;
    point.landmark = true;
    point.radius = 0.02;
    point.mirror = body->joint_count();
    const int own = *points.tracker->FindJoint(place.point);
    const std::string partner = TrackedName(points.tracker->joints[points.tracker->joints[own].mirror].name);
    for (int j = skeleton->joint_count(); j < body->joint_count(); ++j) {
      if (body->joints[j].name != partner) continue;
      body->joints[j].mirror = body->joint_count();
      point.mirror = j;
    }
    body->joints.push_back(std::move(point));
  }
  return body;
}

SkeletonPtr WithoutTrackerPoints(const SkeletonPtr& body) {
  if (!IsTrackedPoint(body->joints.back())) return body;
  auto skeleton = std::make_shared<Skeleton>(*body);
  while (IsTrackedPoint(skeleton->joints.back())) skeleton->joints.pop_back();
  return skeleton;
}

JointTracks OnBodyOf(const TrackerPoints& points, const JointTracks& tracks, const Skeleton& body) {
  if (!points.tracker) return tracks;
  std::vector<std::optional<std::string>> names;
  for (const std::string& name : tracks.names) {
    const auto own = points.tracker->FindJoint(name);
    const std::string meant = own ? points.tracker->joints[*own].name : name;
    if (PlaceOf(points, meant) != nullptr) {
      const bool has = body.FindJoint(TrackedName(meant)).has_value();
      names.push_back(has ? std::optional(TrackedName(meant)) : std::nullopt);
    } else {
      names.emplace_back(body.FindJoint(meant) ? meant : name);
    }
  }
  return SelectedTracks(tracks, names);
}

std::vector<double> PlaceSigmas(const TrackerPoints& points, const Skeleton& body) {
  std::vector<double> sigmas;
  for (const PointPlace& place : points.places) {
    const auto joint = body.FindJoint(TrackedName(place.point));
    if (!joint) continue;
    sigmas.resize(body.joints.size(), 0.0);
    sigmas[static_cast<std::size_t>(*joint)] = place.spread;
  }
  return sigmas;
}

}  // namespace mocurate
