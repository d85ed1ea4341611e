#include "canon/splits/splits.h"

#include <algorithm>
#include <map>
#include <set>

#include "canon/splits/groups.h"
#include "core/base/random.h"
#include "core/base/sha256.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

enum class Part { kTrain, kValidation, kTest };

/// What was performed at once: cameras and spans of it are of one group. With `sessions_together`, a person's session.
std::string PerformanceOf(const SplitOptions& options, const Clip& clip) {
  const ClipIdentity& identity = clip.identity;
  if (options.sessions_together && !identity.session.empty()) {
    return identity.source + "/" + identity.person + "/session " + identity.session;
  }
  const auto performance = clip.provenance.find("performance");
  if (performance != clip.provenance.end()) return identity.source + "/" + performance->second;
  return identity.source + "/" + identity.person + "/" + identity.recording;
}

/// The property of a clip that two parts must not share.
std::string GroupOf(const SplitOptions& options, const Clip& clip) {
  switch (options.by) {
    case SplitBy::kPerson:
      return clip.identity.person;
    case SplitBy::kStyle: {
      const auto style = clip.provenance.find("style");
      return style == clip.provenance.end() ? std::string() : style->second;
    }
    case SplitBy::kFraction:
    case SplitBy::kRole:
      return PerformanceOf(options, clip);
  }
  return {};
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
  const auto names = [&](const std::vector<std::string>& part) {
    return std::find(part.begin(), part.end(), group) != part.end();
  };
  return names(options.test) ? Part::kTest : names(options.validation) ? Part::kValidation : Part::kTrain;
}

std::string RuleText(const SplitOptions& options, bool drawn) {
  std::string text = std::string("by ") + NameOf(options.by);
  if (drawn) text += ", drawn where the set has none of those that are named";
  if (NamesGroups(options.by)) {
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
std::string LeakCheck(const SplitOptions& options, const Dataset& dataset, const std::vector<Part>& parts) {
  std::map<std::string, std::set<Part>> groups;
  std::map<std::string, std::set<Part>> contents;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Clip& clip = dataset.clips[i];
    groups[GroupOf(options, clip)].insert(parts[i]);
    contents[ContentHash(clip)].insert(parts[i]);
  }
  std::string leaks;
  for (const auto& [group, in] : groups) {
    if (in.size() > 1) leaks += (leaks.empty() ? "" : ", ") + group;
  }
  std::size_t repeated = 0;
  for (const auto& [hash, in] : contents) repeated += in.size() > 1 ? 1 : 0;
  const std::string what = options.by == SplitBy::kRole ? "performance" : NameOf(options.by);
  if (leaks.empty() && repeated == 0) return "ok: no " + what + " and no equal clip in two parts";
  std::string text = "leaks:";
  if (!leaks.empty()) text += " in two parts: " + leaks + ";";
  if (repeated > 0) text += " " + Counted(static_cast<long long>(repeated), "clip") + " of equal content in two parts";
  return text;
}

}  // namespace

Expected<Split> MakeSplit(const SplitOptions& options, const Dataset& dataset, std::vector<Finding>& findings) {
  SplitOptions met = options;
  bool drawn = false;
  if (NamesGroups(options.by)) {
    std::set<std::string> groups;
    for (const Clip& clip : dataset.clips) groups.insert(GroupOf(options, clip));
    auto possible = MeetGroups(options, groups, findings);
    if (!possible) return Forward(possible);
    met = std::move(possible->options);
    drawn = possible->drawn;
  }
  Split split;
  split.name = options.name;
  split.rule = RuleText(met, drawn);
  std::vector<Part> parts;
  long long too_short = 0;
  for (std::size_t i = 0; i < dataset.clips.size(); ++i) {
    const Clip& clip = dataset.clips[i];
    const Part part = PartOf(met, GroupOf(met, clip), clip);
    parts.push_back(part);
    const int row = static_cast<int>(i);
    if (part == Part::kTrain && clip.motion->frame_count() < options.min_train_frames) {
      ++too_short;
      continue;
    }
    (part == Part::kTrain ? split.train : part == Part::kTest ? split.test : split.validation).push_back(row);
  }
  if (too_short > 0) {
    split.rule += "; " + Counted(too_short, "training clip") + " shorter than " +
                  Counted(options.min_train_frames, "frame") + " left aside";
  }
  split.leak_check = LeakCheck(met, dataset, parts);
  return split;
}

}  // namespace mocurate
