#pragma once

#include <filesystem>
#include <string>

#include "core/motion/clip.h"

namespace mocurate {

/// Pictures of fits as PNG, drawn with OpenCV. Bodies are drawn with the shape fitted to point clouds, else as capsules
/// with the skeleton's radii, scaled by the person's bone lengths. Errors: kInconsistent when `fitted` has no motion or
/// a frame or view does not exist, kNotFound and kMalformed for depth images, kCannotWrite.

/// Stills of the fitted body with the tracked points (dark) in front, time below.
Status WriteClipPicture(const Clip& fitted, const Evidence& evidence, const std::filesystem::path& png);

/// The image of a view (depth in false colours, keypoints as dots; depth views come first), cut to the person, with the
/// outline and bones of the fitted body over it.
Status WriteBodyOverlay(const Clip& fitted, const Evidence& evidence, int view, int frame,
                        const std::filesystem::path& png);
/// The same, as bytes of a PNG.
Expected<std::string> BodyOverlayPng(const Clip& fitted, const Evidence& evidence, int view, int frame);

/// The fitted body inside the point cloud of all depth views of a frame: front and side.
Status WriteCloudPicture(const Clip& fitted, const Evidence& evidence, int frame, const std::filesystem::path& png);

std::string Base64(const std::string& bytes);

}  // namespace mocurate
