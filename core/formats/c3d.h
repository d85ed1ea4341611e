#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/file_rules.h"

namespace mocurate {

/// The number that byte 4 of the parameter section has for the computer whose numbers the file holds.
enum class C3dProcessor { kIntel = 84, kDec = 85, kSgi = 86 };

/// A column of POINT. Models write angles, forces, moments and powers into it as if they were points.
struct C3dPoint {
  std::string label;        ///< of POINT:LABELS and its continuations; empty: the file has none
  std::string description;  ///< of POINT:DESCRIPTIONS
  std::string quantity;     ///< empty: a position; else of POINT:TYPE_GROUPS, "ANGLES", "MOMENTS", ...
};

/// The points of a C3D file; analogue samples are passed over. Source: the C3D user guide (c3d.org).
struct C3dFile {
  C3dProcessor processor = C3dProcessor::kIntel;
  bool floats = true;   ///< samples are floats, else 16-bit integers of `scale` units
  double scale = 1.0;   ///< file units per step of integers and of residuals
  int first_frame = 1;  ///< its number in the recording
  int frames = 0;
  double rate_hz = 0.0;  ///< 0: the file states none
  std::vector<C3dPoint> points;
  std::string units;  ///< of POINT:UNITS; empty where the file has none
  /// Of POINT:X_SCREEN and Y_SCREEN: the axes that point to the right and up in a view of the room, "+X", "-Z".
  std::string x_screen, y_screen;
  std::vector<std::string> subjects;   ///< of SUBJECTS:NAMES
  std::vector<std::string> rotations;  ///< labels of the group ROTATION (segments' 4 x 4 matrices), which is not read
  std::vector<double> values;          ///< (frames, points, 3), file units
  std::vector<float> residual;         ///< (frames, points), file units; negative: the point was not seen
  std::vector<Finding> findings;       ///< "rate_contradiction", "count_contradiction", "cut_off", "not_a_number"

  bool seen(int frame, int point) const {
    return residual[static_cast<std::size_t>(frame) * points.size() + static_cast<std::size_t>(point)] >= 0.0F;
  }
  const double* at(int frame, int point) const {
    return &values[3 * (static_cast<std::size_t>(frame) * points.size() + static_cast<std::size_t>(point))];
  }
};

/// What wins where header and parameters state the same: docs/formats.md. A sample with a negative fourth word, or that
/// is no number, is not seen and its place is 0. Errors kMalformed "name: header", "name: POINT:USED": no C3D, a
/// section that is cut off or overflows, a coordinate beyond 1e12; kInconsistent: counts, scales or places that
/// contradict each other, or data that is cut off (with DamagedRows::kReport whole frames are kept and reported);
/// kUnsupported: no points (a file of rotations alone says so), another processor.
Expected<C3dFile> ParseC3d(std::string_view bytes, const std::string& name,
                           DamagedRows damaged_rows = DamagedRows::kRefuse);

/// The file as bytes, with its processor, numbers and scale; integers get the finest scale that holds all samples. More
/// than 255 labels go on in LABELS2, more than 65535 frames in TRIAL:ACTUAL_END_FIELD. Error kUnsupported for more than
/// 65535 points, or labels that do not fit the parameter section.
Expected<std::string> WriteC3d(const C3dFile& c3d, const std::string& name);

}  // namespace mocurate
