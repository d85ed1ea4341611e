#include "ingest/checks/check_options.h"

#include <algorithm>

#include <vector>

#include "core/base/text.h"
#include "ingest/checks/finding_table.h"

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

const std::vector<std::string>& CheckCodes() {
  static const std::vector<std::string> codes = [] {
    std::vector<std::string> checks;
    for (const FindingKind& kind : FindingKinds()) {
      if (kind.check) checks.emplace_back(kind.code);
    }
    return checks;
  }();
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
  const FindingKind* kind = FindFindingKind(code);
  return kind == nullptr ? OnFinding::kReport : kind->by_default;
}

bool CheckOptions::IgnoresAll() const {
  const auto& codes = CheckCodes();
  return std::all_of(codes.begin(), codes.end(),
                     [&](const std::string& code) { return ActionFor(code) == OnFinding::kIgnore; });
}

double CheckOptions::Threshold(const std::string& code) const {
  const FindingKind* kind = FindFindingKind(code);
  if (kind == nullptr || *kind->limit == '\0') return 0.0;
  return OptionsToJson(*this).at(kind->limit).get<double>();
}

Status CheckActions(const CheckOptions& options) {
  const std::vector<std::string>& codes = CheckCodes();
  std::vector<std::string> actions;
  for (const auto& [name, action] : ActionNames()) actions.push_back(name);
  for (const auto& [code, action] : options.actions) {
    if (std::count(codes.begin(), codes.end(), code) == 0) {
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
