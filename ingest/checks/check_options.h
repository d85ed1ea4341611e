#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/options.h"

namespace mocurate {

/// What is done about something that the checks found.
enum class OnFinding {
  kIgnore,   ///< not reported
  kReport,   ///< a finding
  kMissing,  ///< a finding, and the samples are taken as missing (tracks only)
  kDrop,     ///< the clip is left out
};

/// Limits of core/quality's checks on every clip, and what becomes of what they find.
struct CheckOptions {
  std::int64_t frozen_frames = 2;
  std::int64_t held_frames = 3;
  double top_speed = 12.0;
  double tracker_slack = 0.3;
  double reach = 2.5;
  double swap_ratio = 0.35;
  double swap_step = 0.1;
  double bone_spread = 0.35;
  double bone_proportion = 0.33;
  double lifeless_share = 0.95;
  double duplicate_distance = 0.005;
  std::int64_t shared_frames = 4;
  std::map<std::string, std::string> actions;  ///< code -> ignore, report, missing, drop

  void Declare(OptionVisitor& v);

  /// As `actions` says; else what is no clip at all (not_joint_positions, lifeless_clip) is dropped and everything else
  /// reported. Of a lifeless clip that holds a given motion CheckClip reports too.
  OnFinding ActionFor(const std::string& code) const;
  /// Whether every check is ignored: then none is made, and the body is not compared with the declaration.
  bool IgnoresAll() const;
  /// The limit that a finding of this code crossed, in the unit of its value; 0 where there is none.
  double Threshold(const std::string& code) const;
};

/// Codes that `actions` may name.
const std::vector<std::string>& CheckCodes();

/// Every code and every action is known. Error kConfig naming it.
Status CheckActions(const CheckOptions& options);

}  // namespace mocurate
