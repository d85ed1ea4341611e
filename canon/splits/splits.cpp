#include "canon/splits/splits.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/base/random.h"
#include "core/base/sha256.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

enum class Part { kTrain, kValidation, kTest };

/// The property of a clip that two parts must not share.
std::string GroupOf(SplitBy by, const Clip& clip) {
  switch (by) {
    case SplitBy::kPerson:
      return clip.identity.person;
    case SplitBy::kStyle: {
      const auto style = clip.provenance.find("style");
      return style == clip.provenance.end() ? std::string() : style->second;
    }
    case SplitBy::kFraction:
      return clip.identity.source + "/" + clip.identity.person + "/" + clip.identity.recording;
    case SplitBy::kRole:
      return clip.id();
  }
  return {};
}

bool Contains(const std::vector<std::string>& list, const std::string& value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

Part PartOf(const SplitOptions& options, const std::string& group, const Clip& clip) {
  if (options.by == SplitBy::kRole) {
    if (clip.role == "test") return Part::kTest;
    return clip.role == "validation" ? Part::kValidation : Part::kTrain;
  }
  if (options.by == SplitBy::kFraction) {
    const double draw = Random(static_cast<std::uint64_t>(options.seed), "split", group).Uniform();
    if (draw < options.test_share) return Part::kTest;
    return draw < options.test_share + options.validation_share ? Part::kValidation : Part::kTrain;
  }
  if (Contains(options.test, group)) return Part::kTest;
  return Contains(options.validation, group) ? Part::kValidation : Part::kTrain;
}

const char* NameOf(SplitBy by) {
  switch (by) {
    case SplitBy::kPerson:
      return "person";
    case SplitBy::kStyle:
      return "style";
    case SplitBy::kFraction:
      return "recording";
    case SplitBy::kRole:
      return "role of the source";
  }
  return "";
}

std::string JoinNames(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

std::string RuleText(const SplitOptions& options, bool drawn) {
  std::string text = std::string("by ") + NameOf(options.by);
  if (drawn) text += ", drawn because the set has no other to test or to train";
  if (options.by == SplitBy::kPerson || options.by == SplitBy::kStyle) {
    text += options.test.empty() ? "; nobody tests" : "; test: " + JoinNames(options.test);
    if (!options.validation.empty()) text += "; validation: " + JoinNames(options.validation);
  }
  return text;
}

/// Of what the clip was made from, else of its joints: the same file under two persons' names is fitted with the bones
/// of each, and differs afterwards.
std::string ContentHash(const Clip& clip) {
  if (!clip.evidence_sha256.empty()) {
    return clip.evidence_sha256 + "#" + std::to_string(clip.identity.begin_frame) + "-" +
           std::to_string(clip.identity.end_frame);
  }
  const JointPositions& joints = clip.motion->joints;
  return Sha256().Add(joints.xyz.data(), joints.xyz.size() * sizeof(double)).Hex();
}

/// What stands in two parts: groups (persons, styles, recordings) and clips of equal content.
std::string LeakCheck(SplitBy by, const Dataset& dataset, const std::vector<Part>& parts) {
  std::map<std::string, std::set<Part>> groups;
  std::map<std::string, std::set<Part>> contents;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Clip& clip = dataset.clips[i];
    const std::string group = GroupOf(by == SplitBy::kRole ? SplitBy::kFraction : by, clip);
    groups[group].insert(parts[i]);
    contents[ContentHash(clip)].insert(parts[i]);
  }
  std::string leaks;
  for (const auto& [group, in] : groups) {
    if (in.size() > 1) leaks += (leaks.empty() ? "" : ", ") + group;
  }
  std::size_t repeated = 0;
  for (const auto& [hash, in] : contents) repeated += in.size() > 1 ? 1 : 0;
  const std::string what = by == SplitBy::kRole ? "recording" : NameOf(by);
  if (leaks.empty() && repeated == 0) return "ok: no " + what + " and no equal clip in two parts";
  std::string text = "leaks:";
  if (!leaks.empty()) text += " in two parts: " + leaks + ";";
  if (repeated > 0) text += " " + Counted(static_cast<long long>(repeated), "clip") + " of equal content in two parts";
  return text;
}

bool NamesGroups(SplitBy by) { return by == SplitBy::kPerson || by == SplitBy::kStyle; }

Finding SplitFinding(const SplitOptions& options, const char* code, std::string message, const char* action) {
  Finding finding;
  finding.code = code;
  finding.message = "split '" + options.name + "': " + std::move(message);
  finding.action = action;
  return finding;
}

/// Names that test and select instead: shares of the groups, at least one each while two are left to train, in the
/// order of a draw keyed by the group, so that other groups do not move it.
SplitOptions DrawGroups(SplitOptions options, const std::set<std::string>& groups) {
  std::vector<std::pair<double, std::string>> order;
  for (const std::string& group : groups) {
    order.emplace_back(Random(static_cast<std::uint64_t>(options.seed), "split", group).Uniform(), group);
  }
  std::sort(order.begin(), order.end());
  const bool selects = !options.validation.empty();
  options.test.clear();
  options.validation.clear();
  const auto count = [&](double share) {
    return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(share * order.size())));
  };
  std::size_t next = 0;
  for (; next + 1 < order.size() && options.test.size() < count(options.test_share); ++next) {
    options.test.push_back(order[next].second);
  }
  for (; selects && next + 2 < order.size() && options.validation.size() < count(options.validation_share); ++next) {
    options.validation.push_back(order[next].second);
  }
  std::sort(options.test.begin(), options.test.end());
  std::sort(options.validation.begin(), options.validation.end());
  return options;
}

/// The options as this set can meet them; `drawn` when groups stand in for those named.
Expected<SplitOptions> MeetGroups(const SplitOptions& options, const std::set<std::string>& groups, bool& drawn,
                                  std::vector<Finding>& findings) {
  SplitOptions met = options;
  std::vector<std::string> absent;
  for (auto* names : {&met.test, &met.validation}) {
    const auto gone = std::stable_partition(names->begin(), names->end(),
                                            [&](const std::string& name) { return groups.count(name) != 0; });
    absent.insert(absent.end(), gone, names->end());
    names->erase(gone, names->end());
  }
  if (!absent.empty()) {
    const std::vector<std::string> known_names(groups.begin(), groups.end());
    const auto near = Nearest(absent.front(), known_names);
    const std::string known = (near ? "did you mean '" + *near + "'? " : "") + "the set has: " + JoinNames(known_names);
    const std::string what = std::string("no clip has the ") + NameOf(options.by) + " '" + JoinNames(absent) + "'";
    if (options.absent == AbsentGroups::kRefuse) {
      return Fail(ErrorCode::kConfig, what, "assemble.splits." + options.name, known);
    }
    findings.push_back(SplitFinding(options, "split_name_absent", what + " (" + known + ")", "flagged"));
  }
  const bool nobody_tests = met.test.empty() && !options.test.empty();
  const bool nobody_trains = met.test.size() + met.validation.size() >= groups.size();
  drawn = nobody_tests || nobody_trains;
  if (!drawn) return met;
  met = DrawGroups(options, groups);
  findings.push_back(SplitFinding(options, "split_drawn",
                                  met.test.empty()
                                      ? "only one " + std::string(NameOf(options.by)) + ": it trains and nothing tests"
                                      : "drawn instead: " + JoinNames(met.test) + " tests",
                                  "replaced"));
  return met;
}

}  // namespace

Expected<Split> MakeSplit(const SplitOptions& options, const Dataset& dataset, std::vector<Finding>& findings) {
  SplitOptions met = options;
  bool drawn = false;
  if (NamesGroups(options.by)) {
    std::set<std::string> groups;
    for (const Clip& clip : dataset.clips) groups.insert(GroupOf(options.by, clip));
    auto possible = MeetGroups(options, groups, drawn, findings);
    if (!possible) return Forward(possible);
    met = std::move(*possible);
  }
  Split split;
  split.name = options.name;
  split.rule = RuleText(met, drawn);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Clip& clip = dataset.clips[i];
    const Part part = PartOf(met, GroupOf(options.by, clip), clip);
    parts.push_back(part);
    const int row = static_cast<int>(i);
    (part == Part::kTrain ? split.train : part == Part::kTest ? split.test : split.validation).push_back(row);
  }
  split.leak_check = LeakCheck(options.by, dataset, parts);
  return split;
}

}  // namespace mocurate
