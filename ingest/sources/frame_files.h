#pragma once

#include <functional>
#include <string>

#include "ingest/sources/rig_calibration.h"

namespace mocurate {

/// What a clip of many files lacks: frames (from 0) of its span, and the names of files with what is wrong with them.
struct LackingFrames {
  std::vector<int> missing;                             ///< rising
  std::vector<int> broken;                              ///< rising
  std::vector<std::pair<std::string, Error>> problems;  ///< (broken)
};
/// Appends "frames_missing" and "unreadable_frames"; `camera` empty: of all files together.
void NoteLackingFrames(const std::string& camera, const FrameSpan& span, const LackingFrames& lacking,
                       std::vector<Finding>& findings);

/// Reads the files of a clip's frames, of `camera` or, where it is empty, of all cameras together; `take` parses the
/// bytes of a frame (from 0) of the span. A frame without a file, or with one that cannot be read or taken, is one in
/// which nobody is seen: findings "frames_missing" and "unreadable_frames". Names and hashes are appended to the clip's
/// content.
using TakeFrame = std::function<Status(int frame, const std::string& bytes, const std::string& name)>;
void ReadFrameFiles(const std::string& camera, const FilesOfCamera& files, const FrameSpan& span, const TakeFrame& take,
                    IngestedClip& ingested);

}  // namespace mocurate
