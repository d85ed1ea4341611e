#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ingest/sense/file_kind.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// What the clips of a source hold when they are ingested.
enum class Gives { kNothing, kJointTracks, kDepthViews, kPointClouds, kKeypoints, kKeypointsAndDepth, kMotion };

/// Who says the unit of length of a file.
enum class UnitOf { kDeclaration, kMetres, kCentimetres, kCalibration };

/// Whether one file holds all clips of a source (`container`).
enum class Container { kNone, kMay, kMust };

/// One format of captures: everything that mocurate knows of it. `run` reads clips by it, `inspect` with a source
/// reports what that gives, and a declaration is checked by it. docs/adding_a_format.md.
struct FormatDriver {
  SourceFormat format = SourceFormat::kNone;
  const char* name = "none";           ///< as a configuration says it
  const char* inspected = "unknown";   ///< what an inspection calls its clips
  FileKind kind = FileKind::kUnknown;  ///< of its files, where the first bytes tell
  const char* ending = "";             ///< of its files, where others hardly have it: ".bvh", "pose.txt"
  Gives gives = Gives::kNothing;
  bool rotations = false;  ///< motion comes with rotations; of `motions` the file says it
  UnitOf unit = UnitOf::kDeclaration;
  bool says_rate = false;        ///< the file says the rate
  bool needs_skeleton = false;   ///< no file names its joints
  bool lists_joints = false;     ///< the declaration lists the joints in the order of the file
  bool lengths_assumed = false;  ///< bones are the skeleton's: only the path of the root is the file's
  bool gathered = false;         ///< a clip is many files: one per camera, per moment, or both
  Container container = Container::kNone;
  std::vector<std::string> options = {};  ///< of `ingest.source` that are of this format, or of a few
  const char* zeros = "";                 ///< what to do about joints at 0 0 0, behind the finding's message
  /// Rules of a declaration beyond those of all formats. Error kConfig naming the option. Null: none.
  Status (*check)(const SourceOptions& source) = nullptr;
  Expected<IngestedClip> (*to_clip)(const SourceFile& file) = nullptr;
};

/// All formats; the first is none.
const std::vector<const FormatDriver*>& FormatDrivers();

const FormatDriver& DriverOf(SourceFormat format);
/// The same by its name; of `none` for a name that no format has.
const FormatDriver& DriverOf(std::string_view name);

/// What the clips of a source hold: that of its format, and depth views where it declares them beside keypoints.
Gives GivesOf(const SourceOptions& source);

/// "joint tracks", ...
const char* Name(Gives gives);

// One a format, each in the file of its name.
const FormatDriver& JointTableFormat();
const FormatDriver& BvhFormat();
const FormatDriver& NpyFormat();
const FormatDriver& DepthSequenceFormat();
const FormatDriver& NtuSkeletonFormat();
const FormatDriver& AsfAmcFormat();
const FormatDriver& AmassFormat();
const FormatDriver& ExpmapFormat();
const FormatDriver& PhspdFormat();
const FormatDriver& VibeTracksFormat();
const FormatDriver& UestcFormat();
const FormatDriver& HumanAct12PickleFormat();
const FormatDriver& MotionsFormat();
const FormatDriver& OpenPoseFormat();
const FormatDriver& DepthViewsFormat();
const FormatDriver& PanopticFormat();
const FormatDriver& CloudsFormat();

}  // namespace mocurate
