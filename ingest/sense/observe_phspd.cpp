// PHSPD's annotated poses: pose.txt and shape_smpl.txt in the folder of a recording.

#include "core/base/file.h"
#include "core/formats/phspd_text.h"
#include "ingest/sense/observe.h"
#include "ingest/sources/phspd_tracks.h"

namespace mocurate {

namespace {

constexpr const char* kPoses = "pose.txt";
constexpr const char* kShapes = "shape_smpl.txt";

Expected<ObservedFile> ShapesIn(const FileBytes& file) {
  const Expected<PhspdShape> shape = ParsePhspdShape(file.bytes, file.name);
  if (!shape) return Forward(shape);
  ObservedFile observed;
  observed.companions.push_back({file.name, "phspd_shape", {}, {{"frames", static_cast<double>(shape->frame.size())}}});
  return observed;
}

Expected<ObservedClip> PosesIn(const FileBytes& file) {
  Expected<PhspdTracks> tracks = ReadPhspdTracks(file.bytes, file.name, DamagedRows::kReport);
  if (!tracks) return Forward(tracks);
  ObservedClip clip;
  clip.format = "phspd_pose";
  clip.frames = tracks->positions.frames;
  clip.joints = kPhspdJoints;
  clip.layout_evidence = "rows of 73 numbers, the frame and 24 joints of x, y, z: frames " +
                         std::to_string(tracks->first_frame) + " to " +
                         std::to_string(tracks->first_frame + clip.frames - 1);
  clip.units = "m";
  clip.positions = std::move(tracks->positions);
  clip.confidence = std::move(tracks->confidence);
  for (const JointOrder& order : KnownJointOrders()) {
    if (order.name == "smpl") FollowFormat(order.skeleton, order.joints, "24 joints of SMPL", clip);
  }
  clip.AddRemarks(tracks->findings);
  return clip;
}

}  // namespace

bool IsOfPhspd(const std::filesystem::path& path) {
  const std::filesystem::path file = path.filename();
  return (file == kPoses || file == kShapes) &&
         ParsePhspdRecording(DisplayPath(path.parent_path().filename())).has_value();
}

Expected<ObservedFile> ObservePhspd(const FileBytes& file) {
  if (file.path.filename() == kShapes) return ShapesIn(file);
  Expected<ObservedClip> clip = PosesIn(file);
  if (!clip) return Forward(clip);
  ObservedFile observed;
  observed.clips.push_back(*std::move(clip));
  return observed;
}

}  // namespace mocurate
