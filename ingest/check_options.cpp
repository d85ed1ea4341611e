#include "ingest/check_options.h"

#include <algorithm>

#include <vector>

#include "core/base/text.h"

namespace mocurate {
namespace {

const std::map<std::string, OnFinding>& ActionNames() {
  static const std::map<std::string, OnFinding> names = {{"ignore", OnFinding::kIgnore},
                                                         {"report", OnFinding::kReport},
                                                         {"missing", OnFinding::kMissing},
                                                         {"drop", OnFinding::kDrop}};
  return names;
}

}  // namespace

const std::map<std::string, std::string>& CheckCodes() {
  static const std::map<std::string, std::string> codes = {
      {"zero_frames", "frames whose joints are all at 0 0 0"},
      {"zero_joint", "a joint at 0 0 0 among others that are not"},
      {"joint_never_seen", "a joint that is missing in every frame"},
      {"collapsed_frames", "frames whose joints lie in one point"},
      {"frozen_frames", "frames equal to the last digit"},
      {"repeated_frames", "each frame several times"},
      {"repeated_stretch", "a section of the clip that stands in it twice"},
      {"held_joint", "a joint that stands still to the last digit while others move"},
      {"units_change", "frames in another unit than the others"},
      {"frozen_view", "a camera that repeats itself while others see somebody move"},
      {"axes_change", "frames with other axes than the others"},
      {"teleport", "frames in which the person is elsewhere"},
      {"body_jump", "a step of the whole body that nobody takes and that it does not take back"},
      {"joint_far", "a joint far from its body"},
      {"swapped_sides", "left and right exchanged"},
      {"rate_doubtful", "bodies in the air that do not fall as bodies do"},
      {"not_joint_positions", "numbers that are no body"},
      {"flat_body", "points of a plane"},
      {"single_frame", "a clip of one frame"},
      {"lifeless_clip", "nobody moves or is there in nearly all frames"},
      {"name_contradiction", "the name says something else than the content"},
      {"duplicate", "the content of another clip, frame for frame"},
      {"near_duplicate", "another clip's motion"},
      {"mirrored_duplicate", "another clip's mirror image"},
      {"shared_frames", "frames of another clip"}};
  return codes;
}

void CheckOptions::Declare(OptionVisitor& v) {
  v.Integer("frozen_frames", frozen_frames, {2.0, 1e6}, "equal frames on end that are a finding");
  v.Integer("held_frames", held_frames, {2.0, 1e6}, "frames on end in which one joint stands exactly still");
  v.Number("top_speed", top_speed, Unit::kMetrePerSecond, {0.1, 1e4}, "speed of the body that nobody reaches");
  v.Number("tracker_slack", tracker_slack, Unit::kMetre, {0.0, 1e3}, "that a body may jump on top of it");
  v.Number("reach", reach, Unit::kMetre, {0.5, 1e3}, "distance of a joint from the middle of its body");
  v.Number("swap_ratio", swap_ratio, Unit::kNone, {0.0, 1.0},
           "squared steps with exchanged sides over those without, below which sides are exchanged");
  v.Number("swap_step", swap_step, Unit::kMetre, {0.0, 10.0}, "smallest step of limbs that says anything about that");
  v.Number("bone_spread", bone_spread, Unit::kNone, {0.0, 10.0}, "relative spread of bone lengths of what is no body");
  v.Number("bone_proportion", bone_proportion, Unit::kNone, {0.0, 10.0},
           "mean distance of log bone lengths from the skeleton's of what is no body");
  v.Number("lifeless_share", lifeless_share, Unit::kNone, {0.0, 1.0},
           "share of frames that are zero, collapsed or frozen of a clip that is none");
  v.Number("duplicate_distance", duplicate_distance, Unit::kMetre, {0.0, 1.0},
           "root mean square distance of two motions that are one");
  v.Integer("shared_frames", shared_frames, {1.0, 1e6}, "equal poses that two recordings do not share by chance");
  v.TextMap(
      "actions", actions,
      "code of a finding -> ignore, report, missing (taken as not seen) or drop (the clip is left out); by default "
      "not_joint_positions and, of tracks, lifeless_clip are dropped, all others reported");
}

OnFinding CheckOptions::ActionFor(const std::string& code) const {
  const auto said = actions.find(code);
  if (said != actions.end()) {
    const auto action = ActionNames().find(said->second);
    if (action != ActionNames().end()) return action->second;
  }
  return code == "not_joint_positions" || code == "lifeless_clip" ? OnFinding::kDrop : OnFinding::kReport;
}

bool CheckOptions::IgnoresAll() const {
  const auto& codes = CheckCodes();
  return std::all_of(codes.begin(), codes.end(),
                     [&](const auto& code) { return ActionFor(code.first) == OnFinding::kIgnore; });
}

double CheckOptions::Threshold(const std::string& code) const {
  const std::map<std::string, double> thresholds = {{"zero_frames", 1.0},
                                                    {"zero_joint", 1.0},
                                                    {"collapsed_frames", 1.0},
                                                    {"frozen_frames", static_cast<double>(frozen_frames)},
                                                    {"held_joint", static_cast<double>(held_frames)},
                                                    {"teleport", tracker_slack},
                                                    {"joint_far", reach},
                                                    {"swapped_sides", swap_ratio},
                                                    {"not_joint_positions", bone_proportion},
                                                    {"lifeless_clip", lifeless_share},
                                                    {"duplicate", duplicate_distance},
                                                    {"near_duplicate", duplicate_distance},
                                                    {"mirrored_duplicate", duplicate_distance},
                                                    {"shared_frames", static_cast<double>(shared_frames)}};
  const auto found = thresholds.find(code);
  return found == thresholds.end() ? 0.0 : found->second;
}

Status CheckActions(const CheckOptions& options) {
  std::vector<std::string> codes, actions;
  for (const auto& [code, help] : CheckCodes()) codes.push_back(code);
  for (const auto& [name, action] : ActionNames()) actions.push_back(name);
  for (const auto& [code, action] : options.actions) {
    if (CheckCodes().count(code) == 0) {
      const auto near = Nearest(code, codes);
      return Fail(ErrorCode::kConfig, "'" + code + "' is no code of a check", "ingest.source.checks.actions",
                  near ? "did you mean '" + *near + "'?" : "docs/inspect.md lists them");
    }
    if (ActionNames().count(action) == 0) {
      const auto near = Nearest(action, actions);
      return Fail(ErrorCode::kConfig, "'" + action + "' is nothing to do about '" + code + "'",
                  "ingest.source.checks.actions",
                  near ? "did you mean '" + *near + "'?" : "write ignore, report, missing or drop");
    }
  }
  return {};
}

}  // namespace mocurate
