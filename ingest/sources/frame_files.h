#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "ingest/sources/rig_calibration.h"

namespace mocurate {

/// Cameras of a recording by name, with the numbers of their frames.
using ViewNumbers = std::map<std::string, std::set<long long>>;

/// A camera whose numbers are not those of the others.
struct ApartView {
  std::string camera, other;  ///< `other`: one of most cameras
  long long first = 0, last = 0, other_first = 0, other_last = 0;
  std::size_t shared = 0, shorter = 0;  ///< frames of both; of the one with fewer

  long long offset() const { return first - other_first; }
  std::string Words() const;
};

/// Two cameras belong together where they share at least half of the frames of the shorter one; where either is
/// `declared`, already where their numbers meet. Returns those that belong to the largest group of cameras neither
/// directly nor through others.
std::vector<ApartView> FindApartViews(const ViewNumbers& views, const std::set<std::string>& declared = {});

/// The frames that the cameras of a clip span together, after `first_frame` of the source: number N of a camera there
/// becomes the first number of the cameras that are not there (all are there: the lowest N). `depth`: images beside
/// keypoints, numbered alike; `masks`: of the cameras' images, which the span does not depend on; null: none. Error
/// kInconsistent: cameras apart (Reason::kViewNumbering), numbers that are a clock's (kOtherLayout), those of SpanOf.
using CameraFiles = std::map<std::string, FilesOfCamera>;
Expected<FrameSpan> MatchViews(const SourceFile& file, CameraFiles& cameras, CameraFiles* depth = nullptr,
                               CameraFiles* masks = nullptr);

/// ingest.source.first_frame: camera -> whole number. Error kConfig.
Status CheckFirstFrames(const SourceOptions& source);
/// Its cameras are among those of the files. Error kConfig.
Status CheckFirstFrames(const SourceOptions& source, const std::set<std::string>& cameras);
/// The number of a camera there; nothing for others.
std::optional<long long> FirstFrameOf(const SourceOptions& source, const std::string& camera);

/// Missing frames (from 0) of a clip's span, and unreadable files with their errors.
struct MissingFrameList {
  std::vector<int> missing;                             ///< rising
  std::vector<int> broken;                              ///< rising
  std::vector<std::pair<std::string, Error>> problems;  ///< (broken)
};
/// Appends "frames_missing" and "unreadable_frames"; `camera` empty: for all files together.
void NoteMissingFrames(const std::string& camera, const FrameSpan& span, const MissingFrameList& lacking,
                       std::vector<Finding>& findings);

/// Reads the files of a clip's frames, of `camera` or, where it is empty, of all cameras; `take` parses the bytes of a
/// frame (from 0) of the span. A missing or unreadable file makes a frame without a person: findings "frames_missing"
/// and "unreadable_frames". Names and hashes are appended to the clip's content.
using TakeFrame = std::function<Status(int frame, const std::string& bytes, const std::string& name)>;
void ReadFrameFiles(const std::string& camera, const FilesOfCamera& files, const FrameSpan& span, const TakeFrame& take,
                    IngestedClip& ingested);

}  // namespace mocurate
