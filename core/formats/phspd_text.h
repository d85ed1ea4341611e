#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/file_rules.h"

namespace mocurate {

constexpr int kPhspdJoints = 24;  ///< SMPL's, in its order
constexpr int kPhspdBetas = 10;

/// `pose.txt` of a PHSPD recording: joints in the frame of the polarisation camera (y down). Frames have gaps.
struct PhspdPose {
  std::vector<int> frame;          ///< index in the recording, growing
  std::vector<double> position_m;  ///< (frames, 24, 3); with DamagedRows::kReport NaN where the file has no number
  std::vector<Finding> findings;   ///< with DamagedRows::kReport: those of a joint table, at frames of the recording
};

/// `shape_smpl.txt`: SMPL's parameters of the same frames.
struct PhspdShape {
  std::vector<int> frame;
  std::vector<double> translation_m;  ///< (frames, 3)
  std::vector<double> betas;          ///< (frames, 10)
  std::vector<double> pose_rad;       ///< (frames, 24, 3) rotation vectors, root first
};

/// Lines "frame x0 y0 z0 ... x23 y23 z23", 73 numbers. Error kMalformed "name:line" that names the column: a line of
/// another length, a number that is not finite, a frame that is not whole or not after the one before it. With
/// DamagedRows::kReport a row of another length, or with a word, is dropped and reported, and its frame is missing; a
/// number that is not finite or too large is NaN.
Expected<PhspdPose> ParsePhspdPose(std::string_view bytes, const std::string& name,
                                   DamagedRows damaged = DamagedRows::kRefuse);
/// Lines of frame and 85 numbers: translation 0-2, betas 3-12, pose 13-84. Errors as above.
Expected<PhspdShape> ParsePhspdShape(std::string_view bytes, const std::string& name);

/// One blank between numbers, none at the end: the released scripts split at single blanks.
std::string WritePhspdPose(const PhspdPose& pose);
std::string WritePhspdShape(const PhspdShape& shape);

/// The folder of a recording, "subject03_group2_time4".
struct PhspdRecording {
  int subject = 0;
  int group = 0;
  int time = 0;

  std::string Name() const;
};

/// Empty where the text is not such a name.
std::optional<PhspdRecording> ParsePhspdRecording(std::string_view folder);

}  // namespace mocurate
