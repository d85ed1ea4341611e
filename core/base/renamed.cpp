#include "core/base/renamed.h"

#include <mutex>
#include <set>

#include "core/base/log.h"

namespace mocurate {
namespace {

struct Renamed {
  std::string_view former;
  std::string_view now;
};

/// Names of the last version. An entry is removed with the version after the one that first has its new name.
constexpr Renamed kRenamed[] = {
    // Finding codes, which `checks` of a source take too.
    {"bodies_left_out", "bodies_skipped"},
    {"body_jump", "unrecovered_jump"},
    {"camera_saw_nobody", "no_person_in_view"},
    {"depth_left_out", "depth_excluded"},
    {"facing_in_doubt", "facing_ambiguous"},
    {"ghost_body", "false_track"},
    {"held_joint", "repeated_value"},
    {"joint_torn_off", "bone_length_violation"},
    {"joints_left_out", "joints_excluded"},
    {"kinds_apart", "modalities_apart"},
    {"kinds_clock_off", "modalities_clock_off"},
    {"kinds_disagree", "modalities_disagree"},
    {"kinds_of_other_sizes", "modalities_differ_in_size"},
    {"label_left_out", "label_excluded"},
    {"lifeless_clip", "motionless_clip"},
    {"limbs_in_one_place", "coincident_limbs"},
    {"little_of_person_seen", "low_coverage"},
    {"mostly_guessed", "mostly_unobserved"},
    {"poorly_explained", "high_residual"},
    {"rate_doubtful", "rate_suspect"},
    {"size_doubtful", "size_suspect"},
    {"teleport", "position_jump"},
    {"unsure_points", "uncertain_points"},
    {"view_left_out", "view_excluded"},
    // Options of ingest and of the studio.
    {"ghost", "false_track"},
    {"ghosts", "false_tracks"},
    {"together", "multi_view"},
    {"tolerated_doubtful", "tolerated_suspect"},
    // Options of fitting.
    {"bone_spread", "bone_sigma"},
    {"contact_walk", "contact_process_noise"},
    {"held", "repeated_values"},
    {"held_frames", "repeated_frames"},
    {"hinge_spread", "hinge_sigma"},
    {"limit_spread", "limit_sigma"},
    {"longest_held", "longest_repeat"},
    {"longest_teleport", "longest_jump"},
    {"merged", "coincident_limbs"},
    {"refit_walks", "refit_process_noise"},
    {"rest_spread", "rest_sigma"},
    {"rotation_walk", "rotation_process_noise"},
    {"teleports", "position_jumps"},
    {"torn", "bone_violations"},
    {"velocity_walk", "velocity_process_noise"},
    // Fields of the proportions that a run keeps.
    {"flesh", "body_shape"},
    // Choices, and the outcomes that journals hold.
    {"doubtful", "suspect"},
    {"leave_out", "exclude"},
    {"left out", "excluded"},
    {"left_out", "excluded"},
    {"tell", "report"},
};

}  // namespace

const char* const kFalseTrackStream = "studio.ghost";

std::string_view NewNameOf(std::string_view name) {
  for (const Renamed& entry : kRenamed) {
    if (entry.former == name) return entry.now;
  }
  return {};
}

std::vector<std::string_view> FormerNamesOf(std::string_view name) {
  std::vector<std::string_view> former;
  for (const Renamed& entry : kRenamed) {
    if (entry.now == name) former.push_back(entry.former);
  }
  return former;
}

std::string RenamedText(std::string_view former, std::string_view now) {
  return "'" + std::string(former) + "' is called '" + std::string(now) + "' now";
}

std::string PresentCode(const std::string& code) {
  const std::string now(NewNameOf(code));
  if (now.empty()) return code;
  static std::mutex mutex;
  static std::set<std::string> reported;
  const std::lock_guard<std::mutex> lock(mutex);
  if (reported.insert(code).second) LogWarning("finding " + RenamedText(code, now));
  return now;
}

}  // namespace mocurate
