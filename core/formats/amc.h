#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/error.h"
#include "core/base/finding.h"
#include "core/formats/asf.h"
#include "core/formats/file_rules.h"

namespace mocurate {

struct AmcBone {
  std::string name;  ///< "root" for the root
  int channels = 0;
  int first_channel = 0;  ///< of the frame's values
};

/// Acclaim motion. Lengths in the unit of its skeleton file, angles in its own.
struct Amc {
  std::optional<bool> degrees;  ///< :DEGREES or :RADIANS; nothing: as the skeleton's
  std::optional<double> hz;     ///< :SAMPLES-PER-SECOND, which hardly any file has
  std::vector<AmcBone> bones;   ///< root first where it has one
  int channel_count = 0;
  int frames = 0;
  std::vector<int> frame_numbers;     ///< (frames) as written: not always 1, 2, 3; of a frame that is skipped too
  std::vector<double> values;         ///< (frames, channel_count); 0 where the bone is missing in that frame
  std::vector<std::uint8_t> present;  ///< (frames, bones)
  std::vector<int> damaged;           ///< rising: frames without a pose, skipped or, with kReport, damaged
  std::vector<Finding> findings;      ///< "frame_number", "time_gap", "bone_missing"; with kReport "row_length",
                                      ///< "cut_off", "number_too_large", "bone_unknown", "bone_twice"

  double value(int frame, int channel) const {
    return values[static_cast<std::size_t>(frame) * static_cast<std::size_t>(channel_count) +
                  static_cast<std::size_t>(channel)];
  }
  bool has(int frame, int bone) const {
    return present[static_cast<std::size_t>(frame) * bones.size() + static_cast<std::size_t>(bone)] != 0;
  }
  int Find(std::string_view bone) const;  ///< -1: none
};

struct AmcOptions {
  const Asf* skeleton = nullptr;  ///< bones are then its root and its bones with dof, in its order
  DamagedRows damaged_rows = DamagedRows::kRefuse;
};

/// Comments in any encoding, LF or CRLF or both in one file, keywords in any letter case. Without a skeleton the first
/// frame declares the bones. With one, a name in the first frame that nearly matches a bone is damage; any other
/// unknown name is an error. Error kMalformed "name:line" names frame and bone. Faults: an unknown keyword or bone; a
/// bone twice in a frame; a row whose length is not the dof; a number that is not finite; a frame number that is not
/// whole; a frame without a bone that most frames have; a last frame without the last bone of the frame before it (cut
/// off). Numbers that are skipped leave damaged frames (LeaveAmcGaps). With kReport a damaged frame keeps its place, is
/// listed in `damaged` and reported. A last frame that is cut off is dropped, with one finding. A bone that is missing
/// in most frames is reported once.
Expected<Amc> ParseAmc(std::string_view bytes, const AmcOptions& options, const std::string& name);

// Steps of ParseAmc, in amc_missing.cpp.

inline constexpr std::size_t kMostAmcFindings = 200;  ///< of one file

/// Where a bone that most frames have is missing, the frame is added to `damaged`. A bone that is missing in most
/// frames is not animated. Both are reported as "bone_missing". `frame_lines` (frames): where each begins. Error
/// kMalformed "name:line" for the first damaged frame where damage is not to be reported.
Status CheckMissingBones(const std::vector<int>& frame_lines, bool reports, const std::string& name, Amc& amc);

/// Inserts a damaged frame for each number that is skipped, so that later frames keep their time: "time_gap" replaces
/// "frame_number" there. Numbers that step by more than one throughout, or fall, are left as they are. Error
/// kInconsistent at "name" where more than 10000 are skipped; that of `fits` for the count of frames with these.
Status LeaveAmcGaps(const std::string& name, const std::function<Status(std::size_t frames)>& fits, Amc& amc);

/// parent_from_bone: C L C^-1, C the bone's axis, L its dof; a missing bone or dof has angle 0. `amc` must have been
/// read with `asf`.
Matrix3d AcclaimLocalRotation(const Asf& asf, const Amc& amc, int frame, int bone);

/// World ends of the bones (bones), file units and axes; `root`, if not null, receives the root's place; `global`
/// (bones), if not null, world_from_bone. A bone starts where its parent ends. Translation dof of a bone move its end
/// along its own axes and kLength stretches it [Acclaim's description; no recorded file at hand has them].
void AcclaimForward(const Asf& asf, const Amc& amc, int frame, std::vector<Vector3d>& ends, Vector3d* root = nullptr,
                    std::vector<Matrix3d>* global = nullptr);

}  // namespace mocurate
