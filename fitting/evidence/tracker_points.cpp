#include "fitting/evidence/tracker_points.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/base/resources.h"

namespace mocurate {
namespace {

constexpr char kPrefix[] = "tracked_";

bool IsTrackedPoint(const Joint& joint) { return joint.landmark && joint.name.rfind(kPrefix, 0) == 0; }

const PointPlace* PlaceOf(const TrackerPoints& points, const std::string& name) {
  const auto found = std::find_if(points.places.begin(), points.places.end(),
                                  [&](const PointPlace& place) { return place.point == name; });
  return found == points.places.end() ? nullptr : &*found;
}

/// The tracks renamed to `names`, in their order; tracks without a name are dropped.
JointTracks Renamed(const JointTracks& tracks, const std::vector<std::optional<std::string>>& names) {
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

}  // namespace

TrackerPoints TrackerPointsOf(const Clip& clip, const Skeleton& body) {
  TrackerPoints points;
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
  return Renamed(tracks, names);
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
