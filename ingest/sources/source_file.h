#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/finding.h"
#include "core/base/problem_list.h"
#include "core/motion/clip.h"
#include "core/pipeline/stage.h"
#include "core/quality/handedness.h"
#include "ingest/item_facts.h"
#include "ingest/options.h"
#include "ingest/sources/pattern.h"

namespace mocurate {

struct RawClip;

/// A part of a clip's id, which holds no '/' and no '#': each becomes '.'.
std::string IdPart(std::string text);

/// Identity and label of a clip by its file name and the source's declaration.
struct NamedFile {
  NameFields fields;      ///< of the pattern, plus "file"
  ClipIdentity identity;  ///< without the span of frames
  std::string label;
  std::string fine_label;
  std::string style;
  std::string performance;  ///< fields shared by all cameras, where the source declares a view; else empty
  std::string performer;    ///< the person as named without {body}, of whom the role is
  std::string role;
  int bodies = 1;  ///< people in the file
  int body = 1;    ///< index of this person, from 1

  /// Item of the stage: source/person/recording.
  std::string item() const;
};

/// For the `body`-th person in the file. Error kConfig for a broken declaration, kInconsistent for a name that does not
/// match or a label that is not listed. The role depends on the person as named without {body}.
Expected<NamedFile> ReadName(const SourceOptions& source, const std::string& relative_name, int body = 1);

/// Error kInconsistent for a name that fits the pattern of ingest.source.files in two ways, of which the declaration
/// makes different clips: another person, recording, label, session, view, style, camera, frame or companion. Where
/// `labels` lists the label of one way only and it is the one that ReadName takes, that is the one meant.
std::optional<Error> AmbiguousName(const SourceOptions& source, const NamePattern& pattern, const std::string& name);

/// The label of a text. Error kInconsistent where `labels` does not list it; `name` for messages.
Status CheckLabelRules(const SourceOptions& source);
Expected<std::string> LabelOf(const SourceOptions& source, const std::string& text, const std::string& name);
/// One property of the declaration that a clip can confirm or contradict.
struct InspectedFact {
  bool contradicts = false;
  double weight = 0.0;  ///< strength of the clip's evidence, 0 to 1
};

/// One file turned into a clip. Findings carry no clip id yet.
struct IngestedClip {
  Clip clip;
  std::vector<Finding> findings;
  std::string content;  ///< bytes read of a file with several clips; empty: the whole file
  std::map<std::string, InspectedFact> shown =
      {};  ///< by the code of a contradiction; properties that the clip does not show are missing
};

/// The bytes of numbers in memory order.
std::string BytesOf(const std::vector<double>& values);

/// One of several cameras' files of a clip.
struct ViewFile {
  std::string view;  ///< the camera by the source's declaration, "C002"
  std::string name;
  std::string bytes;
  NameFields fields;
};

/// The input of a format's reader. `bytes` of the file, `name` for messages.
struct SourceFile {
  const SourceOptions& source;
  const NamedFile& named;
  const std::string& name;
  const std::string& bytes;
  std::vector<StageInput> depth_files;
  std::vector<StageInput> frame_files = {};   ///< of a clip of many files: openpose, panoptic
  std::vector<StageInput> calibrations = {};  ///< openpose, depth_views
  std::string skeleton_name = {};             ///< asf_amc: the .asf
  std::string skeleton_bytes = {};
  std::filesystem::path container = {};  ///< the file that contains this clip among others; `bytes` is empty then
  ItemFacts facts = {};
  std::vector<ViewFile> views = {};  ///< ntu_skeleton with views.multi_view: all of them, the first is the file too
};

/// Action for a contradiction between a clip and its declaration: flagged, or refused where `on_contradiction` asks for
/// it.
FindingAction ContradictionAction(const SourceOptions& source);
/// An error finding about a contradiction.
Finding Contradiction(const SourceOptions& source, std::string code, double value, std::string message);

/// The rate of a clip whose file states one: the declared rate if there is one. A difference is a finding (error)
/// "rate_contradiction". `rate_finding`: a problem of the file's rate (CheckStatedRate); without a declared rate
/// the clip is then refused.
FrameRate RateOfFile(const SourceOptions& source, double file_hz, IngestedClip& ingested,
                     std::optional<Finding> rate_finding = std::nullopt);

/// Compares the body with the declaration, as `mocurate inspect` does: units, up, handedness and, where the declaration
/// lists the joints, their order. Appends findings (error) "units_contradiction", "up_contradiction",
/// "handedness_contradiction", "joint_order_contradiction", and sets `shown` to the properties that the clip shows.
/// Reads tracks, else the motion; a tree without known names is matched by the form of its names.
void CheckBody(const SourceOptions& source, IngestedClip& ingested);

/// A clip as inspection sees a file: in the units and axes of its source, with the declared names.
RawClip ReadRawClip(const SourceOptions& source, const Clip& clip);

/// CheckBody on points of the file that the clip does not keep, in the units and axes of the file. A contradiction that
/// the clip has already is not reported again.
void CheckPoints(const SourceOptions& source, const RawClip& observed, IngestedClip& ingested);

/// Width and height of a 16-bit grey PNG into the camera; the pixels are not decoded. Errors kMalformed for another
/// image, kUnreadable.
Status SetImageSize(const StageInput& input, Camera& camera);

/// Appends an image by its name below the source's folder and its hash. Errors of reading it.
Status AddDepthImage(const StageInput& image, double time_s, DepthView& view);

/// Appends a finding "no_joint_seen" for each run of frames without a tracked joint.
void NoteEmptyFrames(const JointTracks& tracks, std::vector<Finding>& findings);
void NoteEmptyFrames(const std::vector<double>& confidence, int frames, std::vector<Finding>& findings);

/// From the axes and units of a source to the canonical world.
struct SourceFrame {
  Matrix3d world_from_file;   ///< rotates, and mirrors a left-handed source
  Matrix3d metres_from_file;  ///< the same, in metres
};

/// The frame that a source declares. Error kConfig.
Expected<SourceFrame> FrameOf(const SourceOptions& source);

/// The rotation that a source's axes define. Error kConfig where they are left-handed: recorded rotations and cameras
/// need a right-handed frame.
Expected<Quaterniond> RotationOfAxes(const std::string& axes);

/// The names in ingest.source.joints that occur twice or that the skeleton does not know.
void CheckJointNames(const SourceOptions& source, const Skeleton& skeleton, ProblemList& problems);

/// LoadSkeleton, then looks up each of the source's joints in it. Error kConfig names all unknown joints.
Expected<SkeletonPtr> SourceSkeleton(const SourceOptions& source);

}  // namespace mocurate
