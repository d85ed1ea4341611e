#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "ingest/sense/file_kind.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

struct FileBytes;
struct ObservedFile;

/// What the clips of a source hold when they are ingested.
enum class Gives { kNothing, kJointTracks, kDepthViews, kPointClouds, kKeypoints, kKeypointsAndDepth, kMotion };

/// Who says the unit of length of a file.
enum class UnitOf { kDeclaration, kMetres, kCentimetres, kCalibration };

/// Whether one file holds all clips of a source (`container`).
enum class Container { kNone, kMay, kMust };

/// One clip of a file that holds them all, by what the set says of it without its numbers.
struct ContainerEntry {
  std::string name;      ///< what ingest.source.files is matched with
  std::string label;     ///< where the set names it; empty otherwise
  int frames = 0;        ///< at most so many are of the clip; 0: all
  std::string left_out;  ///< why it is no clip
};

/// One format of captures. `run` reads clips by it, `inspect` with a source
/// reports what that gives, and a declaration is checked by it. docs/adding_a_format.md.
struct FormatDriver {
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
  const char* tree = "";         ///< skeleton that the files have, where they all have one
  bool holds_clips = false;      ///< a file may hold several clips, and is opened by to_clip
  bool stored = false;     ///< clips of a store: they keep their identity, the file says whether they have rotations
  bool has_truth = false;  ///< a file tells the true motion beside its evidence
  std::vector<std::string> gathered_by =
      {};  ///< a clip is many files, whose names differ in these fields: camera, frame
  Container container = Container::kNone;
  std::vector<std::string> options = {};  ///< of `ingest.source` that are of this format, or of a few
  const char* zeros = "";                 ///< what to do about joints at 0 0 0, behind the finding's message
  /// Rules of a declaration beyond those of all formats. Error kConfig naming the option. Null: none.
  Status (*check)(const SourceOptions& source) = nullptr;
  Expected<IngestedClip> (*to_clip)(const SourceFile& file) = nullptr;
  /// Whether a file that is not declared is of this format, by its path and at least its first kKindHead bytes. Null:
  /// where its `kind` is the format's.
  bool (*sniff)(const FileBytes& file, FileKind kind) = nullptr;
  /// All that such a file says of itself. Null: a clip is found by several files together, or by a declaration alone.
  Expected<ObservedFile> (*observe)(const FileBytes& file) = nullptr;
  /// Clips of `source.container` below `folder`, in its order. Errors of the format; kNotFound names a missing file.
  Expected<std::vector<ContainerEntry>> (*entries)(const SourceOptions& source,
                                                   const std::filesystem::path& folder) = nullptr;

  bool gathered() const { return !gathered_by.empty(); }
  bool HasOption(std::string_view option) const;
};

/// All formats; the first is none.
const std::vector<const FormatDriver*>& FormatDrivers();

/// Of `none` for a name that no format has.
const FormatDriver& DriverOf(std::string_view name);

/// The format of a file by its path and at least its first kKindHead bytes: of those that sniff, the last that was
/// added first, else by its kind. Null: none.
const FormatDriver* RecogniseFormat(const FileBytes& file);

/// A format of a program of one's own: configurations may name it from now on. Called before any thread reads clips.
/// Throws std::logic_error for a name that there is, without to_clip, and for options that ingest.source has not.
void AddFormat(const FormatDriver& driver);

/// What the clips of a source hold: that of its format, and depth views where it declares them beside keypoints.
Gives GivesOf(const SourceOptions& source);

/// "joint tracks", ...
const char* Name(Gives gives);

}  // namespace mocurate
