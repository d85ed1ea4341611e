#pragma once

#include <functional>
#include <string>

#include "ingest/sources/rig_calibration.h"

namespace mocurate {

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
