#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/geometry/camera.h"
#include "ingest/sources/source_file.h"

namespace mocurate {

/// The cameras of a recording, in metres and the canonical world.
struct Rig {
  std::vector<Camera> cameras;
  std::vector<Finding> findings;  ///< "calibration_contradiction", "up_contradiction"
  std::string content;            ///< bytes of the files
  std::string meaning;            ///< what R, t and the unit mean, and who says it

  /// By its name in the calibration, or in the names of files: as declared, else equal, else the only one with equal
  /// letters and digits ("cam01" is "cam_01"). Null when there is none.
  const Camera* Find(const SourceOptions& source, const std::string& camera) const;
};

/// Reads file.calibrations: one file of any dialect, OpenCV's intri and extri, or one of OpenCV per {camera}. What the
/// format does not say is declared (camera_pose, units), else measured; a contradiction between them is a finding.
/// Error kMalformed, kInconsistent, kConfig; what is neither declared nor told by the evidence is refused with it.
Expected<Rig> ReadRig(const SourceFile& file);

/// Files of a clip by camera and number of the frame, {camera} and {frame} of its pattern; without {frame} all are
/// frame 0, without {camera} all are of camera "". Error kConfig, kInconsistent for a {frame} that is no number.
using FilesOfCamera = std::map<long long, const StageInput*>;
Expected<std::map<std::string, FilesOfCamera>> SortByCamera(const std::string& pattern, const char* option,
                                                            const std::vector<StageInput>& files);

/// The frames that the numbers of all cameras span. Error kInconsistent where the numbers are so far apart that they
/// count no frames.
struct FrameSpan {
  long long first = 0;
  int frames = 0;
};
Expected<FrameSpan> SpanOf(const std::map<std::string, FilesOfCamera>& cameras, const std::string& name);

/// Names of cameras in the files, each with its calibration. Those without a partner are findings
/// "camera_not_calibrated" and "camera_without_files" (those of `others`, files of another kind, have files too);
/// without any partner error kInconsistent.
using Partners = std::vector<std::pair<std::string, const Camera*>>;
Expected<Partners> PartnersOf(const SourceFile& file, const Rig& rig,
                              const std::map<std::string, FilesOfCamera>& cameras, std::vector<Finding>& findings,
                              const std::map<std::string, FilesOfCamera>& others = {});

/// A finding about one camera that lacks files or images.
Finding CameraFinding(const std::string& code, double value, const std::string& message, FindingAction action);

}  // namespace mocurate
