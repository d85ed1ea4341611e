#pragma once

#include <algorithm>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/inspect/file_kind.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

class DeclarationWriter;
struct FileBytes;
struct Proposal;
struct RawFile;

/// What the clips of a source contain when they are ingested.
enum class EvidenceKind { kNothing, kJointTracks, kDepthViews, kPointClouds, kKeypoints, kKeypointsAndDepth, kMotion };

/// What declares the unit of length of a file.
enum class UnitOf { kDeclaration, kMetres, kCentimetres, kCalibration };

/// One clip of a container, as the set's lists describe it.
struct ContainerEntry {
  std::string name;      ///< matched with ingest.source.files
  std::string label;     ///< where the set names it; empty otherwise
  int frames = 0;        ///< maximum number of frames of the clip; 0: all
  std::string excluded;  ///< reason why it is excluded; empty: it is a clip
};

/// One format of captures: `run` reads clips by it, `inspect` recognises its files, and a declaration is checked
/// against it. docs/adding_a_format.md.
struct FormatDriver {
  const char* name = "none";         ///< its name in a configuration
  const char* inspected = "";        ///< name of its clips in an inspection; empty: the same
  std::vector<FileKind> kinds = {};  ///< of its files, where their content identifies them; none: it does not
  const char* ending = "";           ///< of its files, where it is specific enough: ".bvh", "pose.txt"
  EvidenceKind gives = EvidenceKind::kNothing;
  bool rotations = false;  ///< motion comes with rotations; for `motions` each file states it
  UnitOf unit = UnitOf::kDeclaration;
  bool states_rate = false;      ///< the file states the rate
  bool needs_skeleton = false;   ///< the files do not name their joints
  bool lists_joints = false;     ///< the declaration lists the joints in the order of the file
  bool lengths_assumed = false;  ///< bone lengths are the skeleton's; only the root's path is the file's
  const char* tree = "";         ///< skeleton that the joints or rotations of all files are of, where they share one
  bool holds_clips = false;      ///< a file may contain several clips; to_clip opens it
  bool stored = false;  ///< clips of a store: they keep their identity, and the file states whether they have rotations
  bool has_truth = false;  ///< a file contains the true motion beside its evidence
  std::vector<std::string> grouped_by =
      {};                        ///< a clip consists of many files, whose names differ in these fields: camera, frame
  bool needs_container = false;  ///< one file holds all clips of a source (`container`)
  std::vector<std::string> options = {};  ///< options of `ingest.source` that only this format, or a few, have
  const char* zeros = "";                 ///< advice about joints at 0 0 0, appended to the finding's message
  /// Rules of a declaration beyond those of all formats. Error kConfig names the option. Null: no rules.
  Status (*check)(const SourceOptions& source) = nullptr;
  /// Whether an undeclared file is of this format though its kind is not: by its path, and what else its bytes hold.
  /// Null: `kinds` decide.
  bool (*sniff)(const FileBytes& file, FileKind kind) = nullptr;
  /// Everything that such a file contains, as it stands: damaged rows cost their frames, with findings, unless they
  /// are refused. Null: a clip needs several files, or a declaration.
  Expected<RawFile> (*open)(const FileBytes& file) = nullptr;
  /// The clip in metres and canonical axes, as a declaration has it. TracksAsOpened: the first of `open`.
  Expected<IngestedClip> (*to_clip)(const SourceFile& file) = nullptr;
  /// What `config init` writes of the names of clips and of options of this format; of clips of many files all else
  /// too. Null: `files` by what the names have in common.
  void (*propose)(const Proposal& proposal, DeclarationWriter& writer) = nullptr;
  /// Clips of `source.container` below `folder`, in its order. Errors of the format; kNotFound names a missing file.
  Expected<std::vector<ContainerEntry>> (*entries)(const SourceOptions& source,
                                                   const std::filesystem::path& folder) = nullptr;

  bool gathered() const { return !grouped_by.empty(); }
  const char* clip_format() const { return *inspected == '\0' ? name : inspected; }
  bool HasOption(std::string_view option) const;
  bool IsOf(FileKind kind) const { return std::count(kinds.begin(), kinds.end(), kind) > 0; }
};

/// All formats; the first is `none`.
const std::deque<FormatDriver>& FormatDrivers();

/// The driver `none` for an unknown name.
const FormatDriver& DriverOf(std::string_view name);

/// The format of a file of this kind. Formats that sniff are asked first, the last one added before the others; then
/// the first that has the kind is meant. Null: unknown.
const FormatDriver* RecogniseFormat(const FileBytes& file, FileKind kind);

/// Adds a format of an embedding program; configurations may name it from now on. Call it before any thread reads
/// clips. Throws std::logic_error for a name in use, a null to_clip, or options that ingest.source lacks.
void AddFormat(const FormatDriver& driver);

/// The joints of the first clip that the driver's `open` gives, as evidence tracks: those that are missing there have
/// confidence 0. Its facts are the clip's provenance. Errors of `open`; kMalformed for damaged rows that the
/// declaration refuses; kInconsistent where no joint is seen.
Expected<IngestedClip> TracksAsOpened(const SourceFile& file);

/// The rules of ingest.source.markers: a point, a joint and three numbers each; no point twice. Error kConfig.
Status CheckMarkers(const SourceOptions& source);

/// What the clips of a source contain: that of its format, plus depth views where they are declared beside keypoints.
EvidenceKind EvidenceKindOf(const SourceOptions& source);

/// "joint tracks", ...
const char* Name(EvidenceKind gives);

}  // namespace mocurate
