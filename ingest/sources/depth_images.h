#pragma once

#include <map>
#include <string>

#include "core/geometry/camera.h"
#include "core/pipeline/stage.h"
#include "ingest/sources/rig_calibration.h"

namespace mocurate {

/// Width and height of a 16-bit grey PNG into the camera; the pixels are not decoded. Errors kMalformed for another
/// image, kUnreadable.
Status SetImageSize(const StageInput& input, Camera& camera);

/// Adds depth views to a clip of keypoints, one image per frame of the span. A frame without an image of a camera has
/// an empty name and counts in a finding "depth_images_missing", as does a clip without any image. Errors of
/// PartnersOf, SetImageSize and AddDepthImage.
Status AddDepthBeside(const SourceFile& file, const Rig& rig, const std::map<std::string, FilesOfCamera>& depth,
                      const std::map<std::string, FilesOfCamera>& keypoints, const FrameSpan& span,
                      IngestedClip& ingested);

}  // namespace mocurate
