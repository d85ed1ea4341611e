#include <algorithm>
#include <cmath>

#include "core/formats/bvh.h"
#include "ingest/sense/angle_sense.h"
#include "ingest/sense/observe.h"
#include "ingest/sense/path_sense.h"
#include "ingest/sense/rate_sense.h"
#include "ingest/sources/bvh_skeleton.h"

namespace mocurate {
namespace {

constexpr double kCarriesFrom =
    0.01;  // of the sum of all bones; the root's children slide less where they carry nothing

/// Places of all joints, of the root where the joint lies that carries the translation: of Bandai's files the hips.
JointPositions WithCarriedRoot(const Bvh& bvh, JointPositions places) {
  double bones = 0.0;
  for (const BvhJoint& joint : bvh.joints) bones += joint.offset.norm();
  const int carrier = MeasureOffsets(bvh, Matrix3d::Identity(), kCarriesFrom * bones, nullptr).carrier;
  for (int f = 0; f < places.frames && carrier > 0; ++f) places.at(f, 0) = Vector3d(places.at(f, carrier));
  return places;
}

}  // namespace

Expected<std::vector<ObservedClip>> ObserveBvh(std::string_view bytes, const std::string& name) {
  const Expected<Bvh> bvh = ParseBvh(bytes, name, DamagedRows::kReport);
  if (!bvh) return Forward(bvh);
  if (Status bones = CheckBones(*bvh, name); !bones) return Forward(bones);
  ObservedClip clip;
  clip.format = "bvh";
  clip.frames = bvh->frames;
  clip.joints = static_cast<int>(bvh->joints.size());
  clip.rate_evidence = "Frame Time of the file";
  clip.rate_hz = std::round(bvh->hz() * 1000.0) / 1000.0;
  clip.rate_doubt = DoubtRate(bvh->hz(), RateWord::kSecondsPerFrame, name + ":" + std::to_string(bvh->frame_time_line));
  for (const BvhJoint& joint : bvh->joints) clip.names.push_back(joint.name);
  clip.positions = JointPositions(bvh->frames, clip.joints);
  std::vector<Vector3d> positions;
  for (int f = 0; f < bvh->frames; ++f) {
    BvhForward(*bvh, f, positions);
    for (int j = 0; j < clip.joints; ++j) clip.positions.at(f, j) = positions[static_cast<std::size_t>(j)];
  }
  if (!bvh->damaged.empty()) clip.confidence.assign(clip.positions.xyz.size() / 3, 1.0);
  for (const int f : bvh->damaged) {
    std::fill_n(clip.confidence.begin() + static_cast<std::ptrdiff_t>(f) * clip.joints, clip.joints, 0.0);
  }
  std::vector<int> parents;
  for (const BvhJoint& joint : bvh->joints) parents.push_back(joint.parent);
  FollowTree(parents, "HIERARCHY with ROOT " + clip.names[0], clip);
  clip.layout_evidence = "header of the file";
  if (const auto angles = DoubtAngles(*bvh)) {
    clip.remarks.push_back(*angles);
    clip.positions = JointPositions();
    clip.confidence.clear();
    clip.silence = kSpoiledPoses;
  }
  if (clip.positions.frames > 0) {
    const JointPositions carried = WithCarriedRoot(*bvh, clip.positions);
    if (const auto path = DoubtPath(carried, clip.points)) clip.remarks.push_back(*path);
  }
  for (const Finding& finding : bvh->findings) {
    clip.remarks.push_back(finding);
  }
  return std::vector<ObservedClip>{std::move(clip)};
}

}  // namespace mocurate
