#pragma once

#include <map>
#include <string>

#include "ingest/sources/rig_calibration.h"

namespace mocurate {

/// The frames that keypoints and depth images span together: both are numbered by one count. Error kInconsistent where
/// the two share no frame, with the numbers of each.
Expected<FrameSpan> SpanOfBoth(const std::map<std::string, FilesOfCamera>& keypoints,
                               const std::map<std::string, FilesOfCamera>& depth, const std::string& name);

/// Adds depth views to a clip of keypoints, one image per frame of the span; a frame that a camera has no image of has
/// an empty name, and is counted in a finding "depth_images_missing". Without any depth image that is a finding too.
/// Errors of PartnersOf, SetImageSize and AddDepthImage.
Status AddDepthBeside(const SourceFile& file, const Rig& rig, const std::map<std::string, FilesOfCamera>& depth,
                      const std::map<std::string, FilesOfCamera>& keypoints, const FrameSpan& span,
                      IngestedClip& ingested);

}  // namespace mocurate
