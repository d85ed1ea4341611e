#include "canon/splits/splits.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/base/random.h"
#include "core/base/sha256.h"

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

std::string RuleText(const SplitOptions& options) {
  std::string text = std::string("by ") + NameOf(options.by);
  if (options.by == SplitBy::kPerson || options.by == SplitBy::kStyle) {
    text += "; test: " + JoinNames(options.test);
    if (!options.validation.empty()) text += "; validation: " + JoinNames(options.validation);
  }
  return text;
}

std::string ContentHash(const Clip& clip) {
  const JointPositions& joints = clip.motion->joints;
  return Sha256().Add(joints.xyz.data(), joints.xyz.size() * sizeof(double)).Hex();
}

/// What stands in two parts: groups (persons, styles, recordings) and clips of equal content.
std::string LeakCheck(SplitBy by, const Dataset& dataset, const std::vector<Part>& parts) {
  std::map<std::string, std::set<Part>> groups;
  std::map<std::string, std::set<Part>> contents;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Clip& clip = dataset.clips[i];
    const std::string group = by == SplitBy::kRole ? clip.identity.recording : GroupOf(by, clip);
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
  if (repeated > 0) text += " " + std::to_string(repeated) + " clips of equal content in two parts";
  return text;
}

}  // namespace

Expected<Split> MakeSplit(const SplitOptions& options, const Dataset& dataset) {
  std::set<std::string> seen;
  for (const Clip& clip : dataset.clips) seen.insert(GroupOf(options.by, clip));
  if (options.by == SplitBy::kPerson || options.by == SplitBy::kStyle) {
    for (const auto* names : {&options.test, &options.validation}) {
      for (const std::string& name : *names) {
        if (seen.count(name) != 0) continue;
        return Fail(ErrorCode::kConfig, std::string("no clip has the ") + NameOf(options.by) + " '" + name + "'",
                    "assemble.splits." + options.name,
                    "the set has: " + JoinNames(std::vector<std::string>(seen.begin(), seen.end())));
      }
    }
  }
  Split split;
  split.name = options.name;
  split.rule = RuleText(options);
  std::vector<Part> parts;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Clip& clip = dataset.clips[i];
    const Part part = PartOf(options, GroupOf(options.by, clip), clip);
    parts.push_back(part);
    const int row = static_cast<int>(i);
    (part == Part::kTrain ? split.train : part == Part::kTest ? split.test : split.validation).push_back(row);
  }
  split.leak_check = LeakCheck(options.by, dataset, parts);
  return split;
}

}  // namespace mocurate
