#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "core/motion/gaps.h"
#include "core/motion/kinematics.h"
#include "core/motion/operations.h"
#include "tests/canon/studio_recordings.h"
#include "tests/ingest/sources.h"

namespace mocurate {

/// The clips of a declared source (configs/sources) as joints, by person: joints of `skeleton` where the set provides
/// tracks. Clips shorter than `least_s` seconds are skipped.
inline std::map<std::string, std::vector<Clip>> ClipsByPerson(const std::string& source, const std::string& skeleton,
                                                              double least_s,
                                                              const std::vector<std::string>& assignments = {}) {
  std::map<std::string, std::vector<Clip>> people;
  const auto tree = LoadSkeleton(skeleton);
  const auto discovery = Discover(Declared(source, assignments));
  if (!tree || !discovery) return people;
  for (const ItemSpec& item : discovery->items) {
    Ingested ingested = RunIngest(item, "joined");
    if (!ingested.outcome) continue;
    Clip clip = std::move(ingested.clip);
    if (!clip.motion && clip.evidence.tracks) {
      auto motion = MotionFromTracks(*clip.evidence.tracks, *tree, clip.rate, kMaxGap_s);
      if (motion) clip.motion = std::move(*motion);
    }
    clip.evidence = Evidence();
    if (clip.motion && clip.motion->duration() >= least_s) people[clip.identity.person].push_back(std::move(clip));
  }
  return people;
}

/// Positions of one frame's joints.
using JointPlaces = std::vector<Vector3d>;

inline JointPlaces PlacesOf(const Motion& motion, int frame) {
  JointPlaces places;
  for (int j = 0; j < motion.joint_count(); ++j) places.emplace_back(motion.joints.at(frame, j));
  return places;
}

/// World rotation about +y from canonical facing to that of the hips; 0 without hips.
inline double HipYaw(const Skeleton& skeleton, const JointPlaces& places) {
  const auto hips = skeleton.Hips();
  if (!hips) return 0.0;
  const Vector3d left = places[static_cast<std::size_t>((*hips)[0])] - places[static_cast<std::size_t>((*hips)[1])];
  return std::atan2(-left.z(), left.x());
}

/// Concatenates clips in one skeleton and rate. Each is rotated and moved over the floor so that its first frame
/// matches the pose at the seam; over `seam_s` seconds both are blended. Boundaries are the middles of the seams.
inline LongRecording JoinClips(const std::vector<const Clip*>& clips, double seam_s) {
  LongRecording joined;
  const Motion& first = *clips.front()->motion;
  const Skeleton& skeleton = *first.skeleton;
  std::vector<JointPlaces> frames;
  for (const Clip* clip : clips) {
    const Motion& motion = *clip->motion;
    const int seam = std::max(2, static_cast<int>(std::lround(seam_s * first.rate.hz())));
    const int blended = std::min({seam, motion.frame_count() - 1, std::max(0, static_cast<int>(frames.size()) - 1)});
    const std::size_t meet = frames.size() - static_cast<std::size_t>(blended);
    Matrix3d turn = Matrix3d::Identity();
    Vector3d shift = Vector3d::Zero();
    const double middle_s = (static_cast<double>(frames.size()) - 0.5 * blended) / first.rate.hz();
    if (blended > 0) {
      const double yaw = HipYaw(skeleton, frames[meet]) - HipYaw(skeleton, PlacesOf(motion, 0));
      turn = Eigen::AngleAxisd(yaw, Vector3d::UnitY()).toRotationMatrix();
      shift = frames[meet][0] - turn * Vector3d(motion.joints.at(0, 0));
      shift.y() = 0.0;
      joined.truth_s.push_back(middle_s);
      joined.segments.back().end_s = middle_s;
    }
    for (int f = 0; f < motion.frame_count(); ++f) {
      JointPlaces places = PlacesOf(motion, f);
      for (Vector3d& place : places) place = turn * place + shift;
      if (f >= blended) {
        frames.push_back(std::move(places));
        continue;
      }
      const double part = (f + 1.0) / (blended + 1.0), weight = part * part * (3.0 - 2.0 * part);
      JointPlaces& before = frames[meet + static_cast<std::size_t>(f)];
      for (std::size_t j = 0; j < before.size(); ++j) before[j] += weight * (places[j] - before[j]);
    }
    joined.segments.push_back({middle_s, static_cast<double>(frames.size()) / first.rate.hz(), clip->label, "", ""});
  }
  JointPositions joints(static_cast<int>(frames.size()), first.joint_count());
  for (int f = 0; f < joints.frames; ++f) {
    for (int j = 0; j < joints.joints; ++j)
      joints.at(f, j) = frames[static_cast<std::size_t>(f)][static_cast<std::size_t>(j)];
  }
  joined.motion = MakeJointsOnly(first.skeleton, first.rate, joints);
  return joined;
}

/// `count` recordings of four to eight clips of one person, neighbours of different labels.
inline std::vector<LongRecording> JoinedRecordings(const std::map<std::string, std::vector<Clip>>& people, int count,
                                                   std::int64_t seed) {
  std::vector<LongRecording> recordings;
  for (int k = 0; k < count && !people.empty(); ++k) {
    const auto& [person, clips] = *std::next(people.begin(), k % static_cast<int>(people.size()));
    Random random(static_cast<std::uint64_t>(seed), "joined clips", person + "/" + std::to_string(k));
    const std::size_t wanted = 4 + random.Below(5);
    std::vector<const Clip*> chosen;
    for (int tries = 0; chosen.size() < wanted && tries < 1000; ++tries) {
      const Clip* clip = &clips[random.Below(clips.size())];
      if (chosen.empty() || chosen.back()->label != clip->label) chosen.push_back(clip);
    }
    if (chosen.size() < 2) continue;
    recordings.push_back(JoinClips(chosen, 0.3));
    recordings.back().name = person + "/" + std::to_string(k);
  }
  return recordings;
}

}  // namespace mocurate
