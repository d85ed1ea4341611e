#include <algorithm>
#include <cmath>
#include <map>

#include "core/base/file.h"
#include "core/base/text.h"
#include "core/formats/ntu_skeleton.h"
#include "ingest/sense/observe.h"
#include "ingest/sources/ntu_people.h"

namespace mocurate {
namespace {

const std::vector<std::string>& KinectJoints() {
  for (const JointOrder& order : KnownJointOrders()) {
    if (order.name == "kinect2") return order.joints;
  }
  static const std::vector<std::string> none;
  return none;
}

/// The frames of one body: missing where the sensor does not follow the joint, or the body is not there.
ObservedClip BodyClip(const NtuSkeleton& skeleton, std::uint64_t id) {
  ObservedClip clip;
  clip.format = "ntu_skeleton";
  clip.frames = static_cast<int>(skeleton.frames.size());
  clip.joints = kNtuJoints;
  clip.positions = JointPositions(clip.frames, clip.joints);
  clip.confidence.assign(static_cast<std::size_t>(clip.frames) * kNtuJoints, 0.0);
  int present = 0;
  for (int f = 0; f < clip.frames; ++f) {
    for (const NtuBody& body : skeleton.frames[static_cast<std::size_t>(f)]) {
      if (body.id != id) continue;
      ++present;
      for (int j = 0; j < kNtuJoints; ++j) {
        const NtuJoint& joint = body.joints[static_cast<std::size_t>(j)];
        if (joint.tracking == 0) continue;
        clip.positions.at(f, j) = Vector3d(joint.x_m, joint.y_m, joint.z_m);
        clip.confidence[static_cast<std::size_t>(f) * kNtuJoints + static_cast<std::size_t>(j)] =
            joint.tracking == 1 ? 0.5 : 1.0;
      }
    }
  }
  clip.facts.emplace_back("body", std::to_string(id));
  clip.layout_evidence = "counts of the file; the body is in " + Counted(present, "frame");
  return clip;
}

}  // namespace

Expected<std::vector<ObservedClip>> ObserveNtu(const FileBytes& file) {
  const std::string& name = file.name;
  Expected<NtuSkeleton> skeleton = ParseNtuSkeleton(file.bytes, name, DamagedRows::kReport);
  if (!skeleton) {
    Error error = skeleton.error();
    error.code = ErrorCode::kMalformed;  // kInconsistent is said of takes without a person
    return tl::unexpected<Error>(std::move(error));
  }
  std::vector<std::uint64_t> ids;
  std::size_t most = 0, fewest = skeleton->frames.empty() ? 0 : skeleton->frames[0].size();
  for (const std::vector<NtuBody>& frame : skeleton->frames) {
    most = std::max(most, frame.size());
    fewest = std::min(fewest, frame.size());
    for (const NtuBody& body : frame) {
      if (std::find(ids.begin(), ids.end(), body.id) == ids.end()) ids.push_back(body.id);
    }
  }
  if (skeleton->frames.empty()) {
    return Fail(ErrorCode::kInconsistent, "the file holds 0 frames", name, "leave the file out");
  }
  if (ids.empty()) {
    return Fail(ErrorCode::kInconsistent, "there is no body in any frame: the set's files with missing skeletons", name,
                "leave the file out");
  }
  std::vector<ObservedClip> clips;
  for (const std::uint64_t id : ids) {
    ObservedClip clip = BodyClip(*skeleton, id);
    NoteInferredJoints(*skeleton, PersonTrack{{id}, {}, {}, {}}, clip.remarks);
    clip.id = ids.size() > 1 ? "[" + std::to_string(clips.size()) + "]" : "";
    clip.people = static_cast<int>(most);
    clip.fewest_people = static_cast<int>(fewest);
    clip.people_evidence = "bodies of the file's frames; " + std::to_string(ids.size()) + " in all";
    clip.rate_evidence = "the file does not say it";
    clip.set_rate_hz = 30.0;
    clip.set_says = "the format is of the Kinect v2, which follows people at 30 Hz (Shahroudy et al. 2016)";
    clip.units = "m";
    clip.up = "+y";
    clip.handedness = "right";
    FollowFormat("ntu25", KinectJoints(), "25 joints of the Kinect v2", clip);
    clips.push_back(std::move(clip));
  }
  for (const Finding& finding : skeleton->findings) {
    clips[0].remarks.push_back(finding);
  }
  return clips;
}

}  // namespace mocurate
