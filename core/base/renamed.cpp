#include "core/base/renamed.h"

#include <algorithm>
#include <mutex>
#include <set>

#include "core/base/log.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

struct Renamed {
  NameKind kind;
  std::string_view former;
  std::string_view now;
  std::string_view options = {};  ///< of a choice: the options that had it, separated by blanks; empty: all
};

/// Names of the last version. An entry is removed with the version after the one that first has its new name.
constexpr Renamed kRenamed[] = {
    // Finding codes, which `checks` of a source take as names of groups too.
    {NameKind::kCode, "bodies_left_out", "bodies_skipped"},
    {NameKind::kCode, "body_jump", "unrecovered_jump"},
    {NameKind::kCode, "bystanders_left_out", "bystanders_skipped"},
    {NameKind::kCode, "camera_saw_nobody", "no_person_in_view"},
    {NameKind::kCode, "depth_left_out", "depth_excluded"},
    {NameKind::kCode, "facing_in_doubt", "facing_ambiguous"},
    {NameKind::kCode, "ghost_body", "false_track"},
    {NameKind::kCode, "held_joint", "repeated_value"},
    {NameKind::kCode, "joint_torn_off", "bone_length_violation"},
    {NameKind::kCode, "joints_left_out", "joints_excluded"},
    {NameKind::kCode, "kinds_apart", "modalities_apart"},
    {NameKind::kCode, "kinds_clock_off", "modalities_clock_off"},
    {NameKind::kCode, "kinds_disagree", "modalities_disagree"},
    {NameKind::kCode, "kinds_of_other_sizes", "modalities_differ_in_size"},
    {NameKind::kCode, "label_left_out", "label_excluded"},
    {NameKind::kCode, "lifeless_clip", "motionless_clip"},
    {NameKind::kCode, "limbs_in_one_place", "coincident_limbs"},
    {NameKind::kCode, "little_of_person_seen", "low_coverage"},
    {NameKind::kCode, "mostly_guessed", "mostly_unobserved"},
    {NameKind::kCode, "poorly_explained", "high_residual"},
    {NameKind::kCode, "rate_doubtful", "rate_suspect"},
    {NameKind::kCode, "size_doubtful", "size_suspect"},
    {NameKind::kCode, "teleport", "position_jump"},
    {NameKind::kCode, "unsure_points", "uncertain_points"},
    {NameKind::kCode, "view_left_out", "view_excluded"},
    // Options of ingest and of the studio.
    {NameKind::kOption, "ghost", "false_track"},
    {NameKind::kOption, "ghosts", "false_tracks"},
    {NameKind::kOption, "together", "multi_view"},
    {NameKind::kOption, "tolerated_doubtful", "tolerated_suspect"},
    // Options of fitting.
    {NameKind::kOption, "bone_spread", "bone_sigma"},
    {NameKind::kOption, "contact_walk", "contact_process_noise"},
    {NameKind::kOption, "held", "repeated_values"},
    {NameKind::kOption, "held_frames", "repeated_frames"},
    {NameKind::kOption, "hinge_spread", "hinge_sigma"},
    {NameKind::kOption, "limit_spread", "limit_sigma"},
    {NameKind::kOption, "longest_held", "longest_repeat"},
    {NameKind::kOption, "longest_teleport", "longest_jump"},
    {NameKind::kOption, "merged", "coincident_limbs"},
    {NameKind::kOption, "refit_walks", "refit_process_noise"},
    {NameKind::kOption, "rest_spread", "rest_sigma"},
    {NameKind::kOption, "rotation_walk", "rotation_process_noise"},
    {NameKind::kOption, "teleports", "position_jumps"},
    {NameKind::kOption, "torn", "bone_violations"},
    {NameKind::kOption, "velocity_walk", "velocity_process_noise"},
    // Fields of the proportions that a run keeps.
    {NameKind::kField, "flesh", "body_shape"},
    // Choices.
    {NameKind::kChoice, "leave_out", "exclude"},
    {NameKind::kChoice, "tell", "report", "clocks moved exchanged unit order sides"},
    // Outcomes and actions that journals, logs and datasets hold.
    {NameKind::kOutcome, "doubtful", "suspect"},
    {NameKind::kOutcome, "left_out", "excluded"},
    {NameKind::kAction, "left out", "excluded"},
};

bool HasOption(std::string_view options, std::string_view option) {
  const std::vector<std::string_view> all = SplitText(options, ' ');
  return std::find(all.begin(), all.end(), option) != all.end();
}

/// The present name of a `thing`, with a warning once a process for each former name.
std::string PresentName(NameKind kind, const char* thing, const std::string& name) {
  const std::string now(NewNameOf(kind, name));
  if (now.empty()) return name;
  static std::mutex mutex;
  static std::set<std::string> reported;
  const std::lock_guard<std::mutex> lock(mutex);
  const std::string text = std::string(thing) + " " + RenamedText(name, now);
  if (reported.insert(text).second) LogWarning(text);
  return now;
}

}  // namespace

const char* const kFalseTrackStream = "studio.ghost";

std::string_view NewNameOf(NameKind kind, std::string_view name, std::string_view option) {
  for (const Renamed& entry : kRenamed) {
    if (entry.kind != kind || entry.former != name) continue;
    if (entry.options.empty() || HasOption(entry.options, option)) return entry.now;
  }
  return {};
}

std::vector<std::string_view> FormerNames(NameKind kind) {
  std::vector<std::string_view> names;
  for (const Renamed& entry : kRenamed) {
    if (entry.kind == kind) names.push_back(entry.former);
  }
  return names;
}

std::vector<std::string_view> FormerNamesOf(NameKind kind, std::string_view name) {
  std::vector<std::string_view> former;
  for (const Renamed& entry : kRenamed) {
    if (entry.kind == kind && entry.now == name) former.push_back(entry.former);
  }
  return former;
}

std::vector<std::string_view> OtherNamesOfOption(std::string_view name) {
  std::vector<std::string_view> names;
  for (const NameKind kind : {NameKind::kOption, NameKind::kCode}) {
    if (const std::string_view now = NewNameOf(kind, name); !now.empty()) names.push_back(now);
    for (const std::string_view former : FormerNamesOf(kind, name)) names.push_back(former);
  }
  return names;
}

std::string RenamedText(std::string_view former, std::string_view now) {
  return "'" + std::string(former) + "' is called '" + std::string(now) + "' now";
}

std::string PresentCode(const std::string& code) { return PresentName(NameKind::kCode, "finding", code); }

std::string PresentOutcome(const std::string& outcome) { return PresentName(NameKind::kOutcome, "outcome", outcome); }

}  // namespace mocurate
