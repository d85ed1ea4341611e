#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/base/problem_list.h"
#include "core/motion/clip.h"
#include "core/quality/handedness.h"
#include "ingest/options.h"
#include "ingest/sources/pattern.h"

namespace mocurate {

/// A part of a clip's id, which holds no '/' and no '#': each becomes '.'.
std::string IdPart(std::string text);

/// Who and what a file name tells, by the source's declaration.
struct NamedFile {
  NameFields fields;      ///< of the pattern, plus "file"
  ClipIdentity identity;  ///< without the span of frames
  std::string label;
  std::string fine_label;
  std::string style;
  std::string performance;  ///< what all cameras saw at once, where the source declares a view; else empty
  std::string role;
  int bodies = 1;  ///< people in the file
  int body = 1;    ///< which of them this is, from 1

  /// Item of the stage: source/person/recording.
  std::string item() const;
};

/// Of the `body`-th person in the file. Error kConfig for a broken declaration, kInconsistent for a name that does not
/// match or a label that is not listed. A role is that of the person as named without {body}.
Expected<NamedFile> ReadName(const SourceOptions& source, const std::string& relative_name, int body = 1);

/// The label that a text stands for. Error kInconsistent where `labels` lists others only; `name` for messages.
Status CheckLabelRules(const SourceOptions& source);
Expected<std::string> LabelOf(const SourceOptions& source, const std::string& text, const std::string& name);
/// One thing of the declaration that a clip can speak of.
struct ShownFact {
  bool contradicts = false;
  double weight = 0.0;  ///< how much the clip tells, 0 to 1
};

/// One file turned into a clip. Findings carry no clip id yet.
struct IngestedClip {
  Clip clip;
  std::vector<Finding> findings;
  std::string content;  ///< what was read of a file that holds other clips too; empty: all of the file
  std::map<std::string, ShownFact> shown =
      {};  ///< by the code that a contradiction has; what the clip does not show lacks
};

/// Of its tracks, motion, depth views or keypoints.
int FrameCount(const Clip& clip);

/// The bytes of numbers, as they lie in memory.
std::string BytesOf(const std::vector<double>& values);

/// One of several cameras' files of a clip.
struct ViewFile {
  std::string view;  ///< by the source's declaration, "C002"
  std::string name;
  std::string bytes;
  NameFields fields;
};

/// What a reader of one format gets. `bytes` of the file, `name` for messages.
struct SourceFile {
  const SourceOptions& source;
  const NamedFile& named;
  const std::string& name;
  const std::string& bytes;
  std::vector<StageInput> depth_files;
  std::vector<StageInput> frame_files = {};   ///< of a gathered clip: openpose, panoptic
  std::vector<StageInput> calibrations = {};  ///< openpose, depth_views
  std::string skeleton_name = {};             ///< asf_amc: the .asf
  std::string skeleton_bytes = {};
  std::string annotation = {};           ///< amass: JSON of one BABEL sequence, or empty
  std::filesystem::path container = {};  ///< the file that holds this clip among others; `bytes` is empty then
  int entry = -1;                        ///< which of them
  int most_frames = 0;                   ///< of the clip; 0: all
  std::vector<ViewFile> views = {};      ///< ntu_skeleton with views.together: all of them, the first is the file too
};

/// Rows of numbers -> evidence tracks in metres and canonical axes. A left-handed source is flipped by its axes, never
/// otherwise.
Expected<IngestedClip> ReadJointTableClip(const SourceFile& file);

/// BVH -> given motion. Local frames are turned with the axes, OFFSETs become rest offsets and bone lengths. The joint
/// whose position moves carries the translation: it is moved into the root, whose own place is then that joint's place
/// minus the rest offsets between them (bandai22: joint_Root lies on Hips). Joints that slide along their bones by more
/// than max_slide are refused.
Expected<IngestedClip> ReadBvhClip(const SourceFile& file);

/// (frames, joints, 3) or (frames, joints * 3) -> joints-only motion.
Expected<IngestedClip> ReadNpyClip(const SourceFile& file);

/// JSON and depth images -> depth views by reference (file names below the source's folder), cameras in the canonical
/// world, annotated segments.
Expected<IngestedClip> ReadDepthSequenceClip(const SourceFile& file);

/// NTU .skeleton -> evidence tracks of one of its people in metres and canonical axes. People are told apart by the
/// sensor's ids: those there in at least half as many frames as the longest come before the others, by how much they
/// move; given in the order in which they appear. Ids beyond those asked for are a finding "bodies_left_out"; a person
/// asked for who is not there is refused.
Expected<IngestedClip> ReadNtuSkeletonClip(const SourceFile& file);

/// The .skeleton files of one performance, one per camera -> evidence tracks of one of its people, merged in the world
/// of one of the cameras, and depth views. The cameras' places and clocks, which nobody publishes, are found from the
/// joints that they follow (core/quality/view_alignment.h): provenance says each number and how sure it is. A
/// camera that saw nobody, whose joints fit no other or only mirrored is left out with a finding. Refused are a clip
/// that nobody saw and one of which no two cameras agree while two contradict each other.
Expected<IngestedClip> ReadNtuViewsClip(const SourceFile& file);

/// AMC and its ASF -> given motion. A joint stands where its bone starts; rest offsets and lengths are the ASF's. Bones
/// that stretch or shift are refused.
Expected<IngestedClip> ReadAsfAmcClip(const SourceFile& file);

/// AMASS -> given motion on SMPL's 24 joints: the body's rotations; hands, jaw and eyes of SMPL-H and SMPL-X are left
/// out. Without a body model rest offsets are the skeleton's, and the pelvis lies at `trans`: a finding says so. With
/// `annotations`, BABEL's labels are the segments.
Expected<IngestedClip> ReadAmassClip(const SourceFile& file);

/// Exponential maps -> given motion. The file names no joint: `joints` does, in its order. Rotations are those of rows:
/// a place is multiplied from the left, so that parent_from_joint is the rotation by the negative vector.
Expected<IngestedClip> ReadExpmapClip(const SourceFile& file);

/// PHSPD's pose.txt -> evidence tracks on SMPL's joints. Frames that nobody annotated are missing, in their place.
Expected<IngestedClip> ReadPhspdClip(const SourceFile& file);

/// One track of VIBE. On a skeleton with SMPL's joints its rotations, with the pelvis where the middle of the hips is;
/// on another the places of `joints`, without rotations.
Expected<IngestedClip> ReadVibeTrackClip(const SourceFile& file);

/// One video of UESTC's cache, as VIBE's tracks, moved by the camera's estimate: (tx, ty, 500 / (270 sx)) of ACTOR.
/// Side 2 is turned back by the view's angle.
Expected<IngestedClip> ReadUestcClip(const SourceFile& file);

/// One clip of humanact12poses.pkl: on a skeleton with SMPL's joints its rotations, the bones as long as between the
/// places recorded; on another the places alone.
Expected<IngestedClip> ReadHumanAct12Clip(const SourceFile& file);

/// One clip of a dataset or MotionSet, as it is, with its identity, segments and role: rotations where it has them,
/// else joints only. Of the declaration only the licence and `labels` have a say.
Expected<IngestedClip> ReadMotionsClip(const SourceFile& file);

/// JSON files of a detector, one per camera and frame, and the calibration of the cameras -> keypoint views in the
/// canonical world, everybody who is seen. Frames without a file, or with one that cannot be read, are frames in which
/// nobody is seen: findings "frames_missing", "unreadable_frames" per camera. "camera_not_calibrated",
/// "camera_without_files": files and calibration that do not belong together by name. The order of the points is
/// declared or measured; "keypoints_contradiction" where the bones speak against the declaration.
Expected<IngestedClip> ReadOpenPoseClip(const SourceFile& file);

/// Depth images of one camera each, with calibration and masks -> depth views by reference.
Expected<IngestedClip> ReadDepthViewsClip(const SourceFile& file);

/// CMU Panoptic body3DScene files, one per frame -> evidence tracks of one of the people, by how long they are there.
Expected<IngestedClip> ReadPanopticClip(const SourceFile& file);

/// The rate of a clip whose file says one: the declared rate if there is one. Where they differ that is a finding
/// (error) "rate_contradiction". `doubt`: what is wrong with the file's (sense/rate_sense.h); without a declared one
/// the clip is then refused.
FrameRate RateOfFile(const SourceOptions& source, double file_hz, IngestedClip& ingested,
                     std::optional<Finding> doubt = std::nullopt);

/// Compares what the body shows with the declaration, as `mocurate inspect` does: units, up, handedness and, where the
/// declaration lists the joints, their order. Appends findings (error) "units_contradiction", "up_contradiction",
/// "handedness_contradiction", "joint_order_contradiction", and says in `shown` what the clip speaks of. Reads tracks,
/// else the motion, of a tree without known names by what its names look like.
void CheckBody(const SourceOptions& source, IngestedClip& ingested);

/// Appends an image by its name below the source's folder and its hash. Errors of reading it.
Status AddDepthImage(const StageInput& image, double time_s, DepthView& view);

/// Appends a finding "no_joint_seen" for each run of frames in which the tracker saw nothing.
void NoteEmptyFrames(const JointTracks& tracks, std::vector<Finding>& findings);
void NoteEmptyFrames(const std::vector<double>& confidence, int frames, std::vector<Finding>& findings);

/// From the axes and units of a source to the canonical world.
struct SourceFrame {
  Matrix3d world_from_file;   ///< turns, and mirrors a left-handed source
  Matrix3d metres_from_file;  ///< the same, in metres
};

/// The frame that a source declares. Error kConfig.
Expected<SourceFrame> FrameOf(const SourceOptions& source);

/// The names that ingest.source.joints has twice or that the skeleton does not know.
void CheckJointNames(const SourceOptions& source, const Skeleton& skeleton, ProblemList& problems);

/// LoadSkeleton, and each of the source's joints looked up in it. Error kConfig names all unknown joints.
Expected<SkeletonPtr> SourceSkeleton(const SourceOptions& source);

}  // namespace mocurate
