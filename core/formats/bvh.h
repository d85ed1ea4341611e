#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/file_rules.h"
#include "core/geometry/rotation.h"

namespace mocurate {

enum class BvhChannel { kXPosition, kYPosition, kZPosition, kXRotation, kYRotation, kZRotation };

inline bool IsPosition(BvhChannel channel) { return channel <= BvhChannel::kZPosition; }

struct BvhJoint {
  std::string name;
  int parent = -1;                     ///< index below its own; -1 for the ROOT
  Vector3d offset = Vector3d::Zero();  ///< OFFSET, in the file's unit of length
  std::vector<BvhChannel> channels;    ///< in the joint's own order
  int first_channel = 0;               ///< of the frame's values
  bool has_end_site = false;
  Vector3d end_site = Vector3d::Zero();

  bool HasPosition() const;
};

/// Biovision hierarchy: lengths in the file's own unit, angles in degrees, as written.
struct Bvh {
  std::vector<BvhJoint> joints;  ///< parents precede children, in the order of the file
  int channel_count = 0;
  int frames = 0;
  double frame_time_s = 0.0;
  int frame_time_line = 0;        ///< of the file, from 1; 0: was not read from one
  std::vector<double> values;     ///< (frames, channel_count)
  std::vector<int> damaged;       ///< frames whose row is damaged, rising: their values are those of a neighbouring row
  std::vector<Finding> findings;  ///< with DamagedRows::kReport: "count_contradiction", "cut_off", "row_length",
                                  ///< "not_a_number", "number_too_large", "joint_twice"

  double hz() const { return 1.0 / frame_time_s; }
  double value(int frame, int channel) const {
    return values[static_cast<std::size_t>(frame) * channel_count + channel];
  }
};

/// Any order of channels per joint, positions on any joint, joints without End Site, LF or CRLF, one ROOT. Error
/// kMalformed "name:line": empty or cut-off file, unknown channel, a channel twice, a frame with another count of
/// numbers, NaN, frame time that is not from 1e-6 to 1e6 s; kInconsistent: `Frames:` is not the count of rows. No
/// memory is allocated by declared counts alone. With DamagedRows::kReport a frame count that differs from the count
/// of complete rows is reported, and the rows are used. A last row that is cut off is reported and dropped. Another
/// damaged row keeps its place, as one line is one frame, and is listed in `damaged`. Damage stays an error where it
/// may have split or joined rows (more rows than declared, or a row with too many numbers in a file with fewer), or
/// where most rows are damaged.
Expected<Bvh> ParseBvh(std::string_view bytes, const std::string& name,
                       DamagedRows damaged_rows = DamagedRows::kRefuse);

std::string WriteBvh(const Bvh& bvh);

/// Position of a joint in its parent's frame, file units: each position channel *replaces* that component of OFFSET.
Vector3d BvhLocalPosition(const Bvh& bvh, int frame, int joint);
/// parent_from_joint: rotations multiplied in the order of the channels (intrinsic).
Matrix3d BvhLocalRotation(const Bvh& bvh, int frame, int joint);

/// World positions (J), file units and axes; `global` (J), if not null, receives world_from_joint.
void BvhForward(const Bvh& bvh, int frame, std::vector<Vector3d>& positions, std::vector<Matrix3d>* global = nullptr);

}  // namespace mocurate
