#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/camera_files.h"
#include "core/formats/humanact12_pickle.h"
#include "core/formats/npy.h"
#include "core/formats/openpose.h"
#include "core/formats/panoptic_bodies.h"
#include "core/formats/vibe_pickle.h"
#include "ingest/checks/keypoint_checks.h"
#include "ingest/inspect/file_kind.h"
#include "ingest/inspect/inspection.h"
#include "ingest/inspect/raw_clip.h"
#include "ingest/sources/array_clips.h"

namespace mocurate {

struct FormatDriver;

/// Points in space that are no motion, in the file's unit.
struct RawCloud {
  std::string format;  ///< "ply", "pcd"
  std::vector<Vector3d> points;
  std::size_t triangles = 0;
};

/// A motion that an annotation file speaks of.
struct AnnotatedMotion {
  std::string file;    ///< of the annotation
  std::string key;     ///< of the sequence there
  std::string feat_p;  ///< where BABEL says that it lies
  double duration_s = 0.0;
};

/// Everything a file holds; remarks about the file as a whole.
struct RawFile {
  std::vector<RawClip> clips;
  std::vector<RawCloud> clouds;
  std::vector<Calibration> calibrations;
  std::vector<RawCompanion> companions;
  std::vector<AnnotatedMotion> annotated;
  std::vector<Finding> remarks;

  /// One that holds a companion and nothing else.
  static RawFile Of(RawCompanion companion) {
    RawFile file;
    file.companions.push_back(std::move(companion));
    return file;
  }
  static RawFile Of(RawClip clip) {
    RawFile file;
    file.clips.push_back(std::move(clip));
    return file;
  }
  static Expected<RawFile> Of(Expected<std::vector<RawClip>> clips) {
    if (!clips) return Forward(clips);
    RawFile file;
    file.clips = *std::move(clips);
    return file;
  }
};

/// Bytes of a file. `name` for messages, `path` for what lies beside it.
struct FileBytes {
  std::string_view bytes;
  std::string name;
  std::filesystem::path path;
  DamagedRows damaged_rows = DamagedRows::kReport;
};

/// Names of files of one frame each: the last number in a name is the frame's. Files whose names differ in another
/// place as well are of different sequences.
class FrameNames {
 public:
  struct Sequence {
    std::map<long long, std::string> files;                     ///< by number
    std::map<long long, std::pair<std::string, Error>> broken;  ///< that could not be read
    long long first() const;
    long long last() const;
  };

  /// A name without a number is skipped.
  void Add(const std::string& name);
  /// False where no sequence has such names.
  bool AddBroken(const std::string& name, const Error& error);
  const std::map<std::string, Sequence>& sequences() const { return sequences_; }

  /// "frames_missing" and "unreadable_frames", as a run tells them; "malformed" of files of one frame. Frames that are
  /// missing at the ends are those that at least two of `beside`, views of the same recording, both begin and end with.
  std::vector<Finding> MissingFrames(const std::vector<const FrameNames*>& beside) const;

 private:
  std::vector<std::pair<std::string, std::string>> twice_;  ///< and the file that has the frame already
  std::map<std::string, Sequence> sequences_;               ///< by the name with '#' for the number
};

/// Files that say something only together: images' keypoints, moments of a scene, views of a turntable. Given one by
/// one in order of their names.
class RawSequences {
 public:
  /// Errors of the formats.
  Status AddOpenPose(const FileBytes& file);
  Status AddPanoptic(const FileBytes& file);
  /// Whether a file that could not be read is a frame of a sequence, by its name: all but the frame's number is that
  /// of the frames of its folder, which are there already. Its frame is one that cannot be read, then.
  bool Claim(const std::string& name, const Error& error);
  Status AddOpenCv(const FileBytes& file);
  /// A storage that was not requested, which may hold what the others lack.
  void AddBeside(const FileBytes& file);
  void AddImage(const FileBytes& head, bool png);

  /// By folder ("" is the one asked for): clips with their folder in `id`; calibrations likewise. In a folder storages
  /// may be of anything; the one file that is asked for has to be known.
  std::map<std::string, RawFile> Finish(bool folder) const;

 private:
  struct Folder {
    std::vector<OpenPoseFrame> keypoints;
    std::vector<std::string> keypoint_files;  ///< (keypoints)
    PointsNotSeen unseen;                     ///< of the keypoints
    std::vector<PanopticBodies> scenes;
    FrameNames frames;
    std::vector<std::pair<std::string, std::string>> storages;  ///< name, bytes
    std::vector<std::pair<std::string, std::string>> beside;
    std::map<std::string, RawCompanion> images;  ///< by what is equal in them
  };
  /// "view_numbering" by folder, of cameras side by side, or in one folder.
  std::map<std::string, std::vector<Finding>> ApartFolders() const;
  std::vector<const FrameNames*> FramesBeside(const std::string& name) const;

  std::map<std::string, Folder> folders_;
};

/// One file of any kind but those of RawSequences; `format` as RecogniseFormat gives it. Errors of the formats;
/// kUnsupported for content that is no motion.
Expected<RawFile> ReadRawFile(const FileBytes& file, FileKind kind, const FormatDriver* format);

/// Joints of an array (frames, joints, 3), (frames, joints * 3), or a batch of them; kUnsupported for others.
Expected<std::vector<RawClip>> ReadRawArray(const NpyArray& array, const std::string& name);
Expected<RawFile> ReadRawTable(const FileBytes& file);
/// "decimal_comma": a table with decimal commas, which are read as points.
Finding DecimalCommas();
/// Frames per second by the clock of CMU Panoptic's files. Files may be missing: the usual step, their median, tells
/// how many moments lie between two of them. 0: unknown.
double RateByClock(const std::vector<PanopticBodies>& scenes);
/// The unit that a file states by a word ("mm ", "Meters"), as declarations have it; empty where it is none of them.
std::string UnitIn(std::string_view word);
/// Follows the skeleton of configs/skeletons with the fewest joints of which every named point is a joint of its own;
/// without one, the body is found by the names alone.
void FollowNames(RawClip& clip);
/// The joints of a file of `mocurate export`, as it names them.
Expected<RawClip> ReadRawExported(const ExportedMotion& exported, const std::string& name);
/// The table as exponential maps, where its numbers are such; nothing otherwise.
std::optional<RawClip> ReadRawExpmap(std::string_view bytes, const std::string& name);
/// HumanAct12, tracks and caches of VIBE, rigs of PHSPD, body models (which are only named).
Expected<RawFile> ReadRawPickle(const FileBytes& file);
/// What the joints of a track say; `format` is "vibe_tracks" or "vibe_cache".
RawClip ReadRawVibeTrack(const VibeTrack& track, const std::string& format);

/// The recorded joints of a clip of `humanact12poses.pkl`, without what is doubted of its rotations.
RawClip ReadRawHumanAct12Clip(const HumanAct12Clip& source);
/// Whether the file is one of the lists of info/ beside UESTC's cache: by its name, and names of videos in names.txt.
bool IsUestcInfo(const std::filesystem::path& path);
Expected<RawFile> ReadRawUestcInfo(const FileBytes& file);
Expected<RawFile> ReadRawBabel(const FileBytes& file);
Expected<RawFile> ReadRawCalibration(const FileBytes& file);
Expected<RawFile> ReadRawOpenSim(const FileBytes& file);

}  // namespace mocurate
