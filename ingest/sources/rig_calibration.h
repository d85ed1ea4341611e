#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/camera.h"
#include "core/pipeline/stage.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// The cameras of a recording, in metres and the canonical world.
struct Rig {
  std::vector<Camera> cameras;
  std::vector<Finding> findings;  ///< "calibration_contradiction", "up_contradiction"
  std::string content;            ///< bytes of the files
  std::string meaning;            ///< meaning of R, t and the unit, and where it comes from

  /// Finds a camera by its name in the calibration or in file names: as declared, else equal, else the only one with
  /// equal letters and digits ("cam01" is "cam_01"). Null when there is none.
  const Camera* Find(const SourceOptions& source, const std::string& camera) const;
};

/// Reads file.calibrations: one file of any dialect, OpenCV's intri and extri, or one of OpenCV per {camera}. What the
/// format does not state is declared (camera_pose, units), else estimated; a contradiction between them is a finding.
/// Error kMalformed, kInconsistent, kConfig; where the estimate is ambiguous, kInconsistent with its evidence.
Expected<Rig> ReadRig(const SourceFile& file);

/// Files of a clip by camera and number of the frame, {camera} and {frame} of its pattern; without {frame} all are
/// frame 0, without {camera} all are of camera "". Error kConfig, kInconsistent for a {frame} that is no number.
using FilesOfCamera = std::map<long long, const StageInput*>;
Expected<std::map<std::string, FilesOfCamera>> SortByCamera(const std::string& pattern, const char* option,
                                                            const std::vector<StageInput>& files);

/// The range of frame numbers over all cameras. Error kInconsistent where the numbers are too far apart for frames.
struct FrameSpan {
  long long first = 0;
  int frames = 0;
};
Expected<FrameSpan> SpanOf(const std::map<std::string, FilesOfCamera>& cameras, const std::string& name);

/// Names of cameras in the files, each with its calibration. Those without a partner are findings
/// "camera_not_calibrated" and "camera_without_files" (a camera of `others`, files of another type, counts as having
/// files); without any partner error kInconsistent.
using Partners = std::vector<std::pair<std::string, const Camera*>>;
Expected<Partners> PartnersOf(const SourceFile& file, const Rig& rig,
                              const std::map<std::string, FilesOfCamera>& cameras, std::vector<Finding>& findings,
                              const std::map<std::string, FilesOfCamera>& others = {});

/// Takes the files of other cameras out.
void KeepPartners(const Partners& partners, std::map<std::string, FilesOfCamera>& cameras);

/// A finding about a camera with missing files or images.
Finding CameraFinding(const std::string& code, double value, const std::string& message, FindingAction action);

}  // namespace mocurate
