#include "fitting/evidence/skeleton_tracks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/base/text.h"

namespace mocurate {
namespace {

bool IsLandmark(const Skeleton& skeleton, const std::string& name) {
  return std::any_of(skeleton.landmarks.begin(), skeleton.landmarks.end(),
                     [&](const Landmark& landmark) { return landmark.name == name; });
}

/// Joint of each track; -1 for a landmark.
Expected<std::vector<int>> JointsOfTracks(const JointTracks& tracks, const Skeleton& skeleton) {
  std::vector<int> joint_of_track;
  std::vector<std::string> track_of_joint(skeleton.joints.size());
  std::string unknown;
  for (const std::string& name : tracks.names) {
    const std::optional<int> joint = skeleton.FindJoint(name);
    if (!joint) {
      if (!IsLandmark(skeleton, name)) unknown += (unknown.empty() ? "" : ", ") + name;
      joint_of_track.push_back(-1);
      continue;
    }
    if (!track_of_joint[*joint].empty()) {
      return Fail(ErrorCode::kInconsistent,
                  "tracks '" + track_of_joint[*joint] + "' and '" + name + "' are both joint '" +
                      skeleton.joints[*joint].name + "' of skeleton '" + skeleton.name + "'",
                  "tracks", "rename one of them in the source declaration");
    }
    track_of_joint[*joint] = name;
    joint_of_track.push_back(*joint);
  }
  if (unknown.empty()) return joint_of_track;
  std::string known;
  for (const Joint& joint : skeleton.joints) known += (known.empty() ? "" : ", ") + joint.name;
  return Fail(ErrorCode::kInconsistent, "skeleton '" + skeleton.name + "' has no joint named " + unknown, "tracks",
              "add a synonym to the skeleton or choose another skeleton; its joints are " + known);
}

Status CheckShapes(const JointTracks& tracks) {
  const std::size_t frames = tracks.time_s.size();
  const std::size_t points = tracks.names.size();
  if (static_cast<std::size_t>(tracks.positions.frames) != frames ||
      static_cast<std::size_t>(tracks.positions.joints) != points ||
      tracks.positions.xyz.size() != 3 * frames * points || tracks.confidence.size() != frames * points) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(frames) + " times and " + std::to_string(points) + " names, but positions are " +
                    std::to_string(tracks.positions.frames) + " x " + std::to_string(tracks.positions.joints) +
                    " and " + std::to_string(tracks.confidence.size()) + " confidences",
                "tracks");
  }
  for (std::size_t f = 0; f < frames; ++f) {
    if (std::isfinite(tracks.time_s[f]) && (f == 0 || tracks.time_s[f] > tracks.time_s[f - 1])) continue;
    return Fail(ErrorCode::kInconsistent,
                "time " + FormatDouble(tracks.time_s[f]) + " s does not follow the time of the frame before",
                "tracks frame " + std::to_string(f), "times must increase");
  }
  return {};
}

Status MapRotations(const JointTracks& tracks, const std::vector<int>& joint_of_track, SkeletonTracks& mapped) {
  if (tracks.rotation.empty()) return {};
  const std::size_t points = tracks.names.size();
  if (tracks.rotation.size() != tracks.confidence.size() ||
      tracks.rotation_confidence.size() != tracks.confidence.size()) {
    return Fail(ErrorCode::kInconsistent,
                std::to_string(tracks.confidence.size()) + " positions, but " + std::to_string(tracks.rotation.size()) +
                    " rotations and " + std::to_string(tracks.rotation_confidence.size()) + " of their confidences",
                "tracks");
  }
  mapped.rotation.assign(mapped.confidence.size(), Quaterniond::Identity());
  mapped.rotation_confidence.assign(mapped.confidence.size(), 0.0);
  for (std::size_t at = 0; at < tracks.rotation.size(); ++at) {
    const int joint = joint_of_track[at % points];
    const double confidence = tracks.rotation_confidence[at];
    if (joint < 0 || confidence == 0.0) continue;
    const std::string where = "track '" + tracks.names[at % points] + "' frame " + std::to_string(at / points);
    if (!(confidence > 0.0 && confidence <= 1.0)) {
      return Fail(ErrorCode::kMalformed, "confidence " + FormatDouble(confidence) + " of a rotation is outside [0, 1]",
                  where);
    }
    if (!tracks.rotation[at].coeffs().allFinite() || std::abs(tracks.rotation[at].norm() - 1.0) > 1e-6) {
      return Fail(ErrorCode::kMalformed, "the rotation is not a unit quaternion, but its confidence is not 0", where,
                  "give missing rotations confidence 0");
    }
    const std::size_t to = at / points * static_cast<std::size_t>(mapped.joints()) + static_cast<std::size_t>(joint);
    mapped.rotation[to] = tracks.rotation[at];
    mapped.rotation_confidence[to] = confidence;
  }
  return {};
}

}  // namespace

std::vector<bool> SkeletonTracks::ObservedSamples() const {
  std::vector<bool> observed(confidence.size());
  std::vector<char> above(skeleton->joints.size()), here(above.size()), below(above.size());
  for (int f = 0; f < frames(); ++f) {
    const std::size_t row = static_cast<std::size_t>(f) * static_cast<std::size_t>(joints());
    for (std::size_t j = 0; j < here.size(); ++j) here[j] = below[j] = seen(f, static_cast<int>(j)) ? 1 : 0;
    for (std::size_t j = here.size(); j-- > 1 && least_sigma > 0.0;) {
      const auto parent = static_cast<std::size_t>(skeleton->joints[j].parent);
      if (skeleton->joints[j].landmark && here[j] != 0) here[parent] = 1;
      if (here[j] != 0 || below[j] != 0) below[parent] = 1;
    }
    for (std::size_t j = 0; j < here.size(); ++j) {
      const int parent = skeleton->joints[j].parent;
      const auto over = static_cast<std::size_t>(std::max(0, parent));
      above[j] = parent >= 0 && (above[over] != 0 || here[over] != 0) ? 1 : 0;
      observed[row + j] = here[j] != 0 || (least_sigma > 0.0 && above[j] != 0 && below[j] != 0);
    }
  }
  return observed;
}

std::vector<bool> SkeletonTracks::JointObservations() const {
  std::vector<bool> any(joints(), false);
  for (int f = 0; f < frames(); ++f) {
    for (int j = 0; j < joints(); ++j) any[j] = any[j] || seen(f, j);
  }
  return any;
}

std::vector<bool> SkeletonTracks::ObservedFrames() const {
  std::vector<bool> any(frames(), false);
  for (int f = 0; f < frames(); ++f) {
    for (int j = 0; j < joints(); ++j) any[f] = any[f] || seen(f, j);
  }
  return any;
}

Expected<SkeletonTracks> MapTracks(const JointTracks& tracks, const SkeletonPtr& skeleton) {
  if (Status shapes = CheckShapes(tracks); !shapes) return tl::unexpected<Error>(shapes.error());
  const Expected<std::vector<int>> joint_of_track = JointsOfTracks(tracks, *skeleton);
  if (!joint_of_track) return Forward(joint_of_track);

  SkeletonTracks mapped;
  mapped.skeleton = skeleton;
  mapped.time_s = tracks.time_s;
  mapped.positions = JointPositions(tracks.positions.frames, skeleton->joint_count());
  mapped.confidence.assign(mapped.positions.xyz.size() / 3, 0.0);
  if (Status rotations = MapRotations(tracks, *joint_of_track, mapped); !rotations) return Forward(rotations);
  bool anything = false;
  for (int f = 0; f < mapped.frames(); ++f) {
    for (std::size_t k = 0; k < tracks.names.size(); ++k) {
      const double confidence = tracks.confidence[f * tracks.names.size() + k];
      const int joint = (*joint_of_track)[k];
      if (confidence == 0.0 || joint < 0) continue;
      const std::string where = "track '" + tracks.names[k] + "' frame " + std::to_string(f);
      if (!(confidence > 0.0 && confidence <= 1.0)) {
        return Fail(ErrorCode::kMalformed, "confidence " + FormatDouble(confidence) + " is outside [0, 1]", where);
      }
      const Vector3d position = tracks.positions.at(f, static_cast<int>(k));
      if (!position.allFinite()) {
        return Fail(ErrorCode::kMalformed, "the position is not finite, but its confidence is not 0", where,
                    "give missing observations confidence 0");
      }
      mapped.positions.at(f, joint) = position;
      mapped.confidence[static_cast<std::size_t>(f) * mapped.joints() + joint] = confidence;
      anything = true;
    }
  }
  if (!anything) {
    return Fail(ErrorCode::kInconsistent, "no joint is seen at all in " + Counted(mapped.frames(), "frame"), "tracks",
                "a clip without evidence cannot be fitted; drop it");
  }
  return mapped;
}

SkeletonTracks OnBody(SkeletonTracks tracks, const SkeletonPtr& body) {
  tracks.skeleton = body;
  return tracks;
}

SkeletonTracks CutTracks(const SkeletonTracks& tracks, int begin, int end) {
  SkeletonTracks cut;
  cut.skeleton = tracks.skeleton;
  cut.place_sigma = tracks.place_sigma;
  cut.least_sigma = tracks.least_sigma;
  cut.time_s.assign(tracks.time_s.begin() + begin, tracks.time_s.begin() + end);
  cut.positions = JointPositions(end - begin, tracks.joints());
  const auto first = static_cast<std::ptrdiff_t>(begin) * tracks.joints();
  const auto last = static_cast<std::ptrdiff_t>(end) * tracks.joints();
  cut.positions.xyz.assign(tracks.positions.xyz.begin() + 3 * first, tracks.positions.xyz.begin() + 3 * last);
  cut.confidence.assign(tracks.confidence.begin() + first, tracks.confidence.begin() + last);
  if (!tracks.precision.empty())
    cut.precision.assign(tracks.precision.begin() + first, tracks.precision.begin() + last);
  if (!tracks.rotation.empty()) {
    cut.rotation.assign(tracks.rotation.begin() + first, tracks.rotation.begin() + last);
    cut.rotation_confidence.assign(tracks.rotation_confidence.begin() + first,
                                   tracks.rotation_confidence.begin() + last);
  }
  return cut;
}

}  // namespace mocurate
