#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/file_rules.h"

namespace mocurate {

constexpr int kNtuJoints = 25;

/// One line of 12 numbers. Axes of the depth camera: x to the sensor's left, y up, z away from it.
struct NtuJoint {
  double x_m = 0, y_m = 0, z_m = 0;
  double depth_u = 0, depth_v = 0;        ///< pixels of the depth image, 512 x 424
  double colour_u = 0, colour_v = 0;      ///< pixels of the colour image, 1920 x 1080
  double qw = 0, qx = 0, qy = 0, qz = 0;  ///< orientation as written; 0 0 0 0 at the leaves: none
  int tracking = 0;                       ///< 0 not tracked, 1 inferred, 2 tracked
};

/// One person in one frame, without the flags of the Kinect v2 body (hands, lean, edges).
struct NtuBody {
  std::uint64_t id = 0;  ///< lasts as long as the sensor follows the person; does not fit a double
  std::array<NtuJoint, kNtuJoints> joints;
};

/// An NTU RGB+D `.skeleton` file: bodies of each frame, none to many, in the file's order.
struct NtuSkeleton {
  std::vector<std::vector<NtuBody>> frames;
  std::vector<Finding> findings;  ///< with DamagedRows::kReport: "not_a_number", "row_length", "count_contradiction"
};

/// Text: count of frames; per frame the count of bodies; per body a line of 10 numbers, a line "25", 25 lines of 12.
/// A file of 0 frames is valid. Error kMalformed "name:line" names frame, body, joint and field. Faults: a line with
/// another count of numbers, a number that is not finite, a tracking state out of range, an id twice
/// in a frame. kInconsistent: the counts of frames, bodies or joints contradict the data. No memory is allocated by
/// declared counts alone. With DamagedRows::kReport a damaged line of a joint or of a body's flags is reported: a word,
/// NaN (known in files of the set) or another count of numbers. It sets that joint to tracking state 0 and zeros. A
/// wrong frame count is reported too, and a last frame that is cut off is dropped. A missing or extra
/// line elsewhere stays an error. Layout: Shahroudy et al. 2016, the released reader of the data set.
Expected<NtuSkeleton> ParseNtuSkeleton(std::string_view bytes, const std::string& name,
                                       DamagedRows damaged_rows = DamagedRows::kRefuse);

/// The same as text, LF, fewest digits that read back as the same doubles.
std::string WriteNtuSkeleton(const NtuSkeleton& skeleton);

/// SsssCcccPpppRrrrAaaa.
struct NtuName {
  int setup = 0;
  int camera = 0;
  int performer = 0;
  int replication = 0;
  int action = 0;

  std::string Text() const;
};

/// The last ones of NTU RGB+D 60; setups and actions above are those that NTU RGB+D 120 added.
inline constexpr int kLastNtu60Setup = 17, kLastNtu60Action = 60;

/// The first setup in which an action was recorded.
int FirstSetupOf(int action);

}  // namespace mocurate
