#include "canon/values/merge.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "canon/splits/leaks.h"
#include "canon/values/subset.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/base/version.h"

namespace mocurate {
namespace {

/// Row of each clip in the merged dataset: by part, then by row there.
using MergedRows = std::vector<std::vector<int>>;

/// Properties that a split may separate. People of two sources with one name are two.
constexpr std::pair<SplitBy, const char*> kGroupKinds[] = {
    {SplitBy::kPerson, "person"}, {SplitBy::kStyle, "style"}, {SplitBy::kFraction, "performance"}};

std::vector<std::string> GroupsOf(SplitBy by, const std::vector<Clip>& clips) {
  std::vector<std::string> groups;
  for (const Clip& clip : clips) {
    groups.push_back((by == SplitBy::kPerson ? clip.identity.source + "/" : "") + GroupOf(by, clip, false));
  }
  return groups;
}

/// A part, and its own split.
using SplitOfPart = std::pair<std::size_t, const Split*>;

std::string RuleOf(const std::vector<MergePart>& parts, const std::vector<SplitOfPart>& splits) {
  std::set<std::string> rules;
  std::string all;
  for (const auto& [p, split] : splits) {
    rules.insert(split->rule);
    all += (all.empty() ? "" : "; ") + parts[p].name + ": " + split->rule;
  }
  return rules.size() == 1 ? *rules.begin() : all;
}

/// The clips' source data, or their motions where that is unknown or several people's.
Expected<std::vector<std::string>> ContentsOf(const std::vector<MergePart>& parts, const MergedDataset& merged) {
  std::vector<std::string> motions(merged.origins.size());
  std::vector<std::size_t> sets;
  const std::vector<bool> needed = DistinguishedByMotion(merged.dataset.clips);
  for (std::size_t row = 0; row < merged.origins.size(); ++row) {
    const auto [p, row_there] = merged.origins[row];
    sets.push_back(p);
    if (!needed[row]) continue;
    auto hash = parts[p].motion_hash(row_there);
    if (!hash) return Forward(hash);
    motions[row] = std::move(*hash);
  }
  return ContentsOf(merged.dataset.clips, motions, sets);
}

/// Checks the united split again, for all properties that each of the splits separates; leaks reported by a split stay.
std::string CheckUnited(const std::vector<MergePart>& parts, const std::vector<SplitOfPart>& splits,
                        const std::vector<int>& part_of_row, const std::vector<Clip>& clips,
                        const std::vector<std::string>& contents) {
  std::vector<std::string> shared;
  std::string apart;
  for (const auto& [by, name] : kGroupKinds) {
    const bool kept_apart = std::all_of(splits.begin(), splits.end(), [&, by = by](const SplitOfPart& one) {
      const std::vector<Clip>& own = parts[one.first].dataset.clips;
      return InTwoParts(PartsOf(*one.second, own.size()), GroupsOf(by, own)).empty();
    });
    const std::vector<std::string> groups = GroupsOf(by, clips);
    const bool known = std::any_of(groups.begin(), groups.end(), [](const std::string& g) { return !g.empty(); });
    if (!kept_apart || !known) continue;
    apart += (apart.empty() ? "" : ", ") + std::string(name);
    for (const auto& [group, rows] : InTwoParts(part_of_row, groups)) shared.push_back(group);
  }
  std::string text = LeakText(apart, shared, InTwoParts(part_of_row, contents).size());
  for (const auto& [p, split] : splits) {
    if (split->leak_check.rfind("ok", 0) == 0) continue;
    text = (text.rfind("ok", 0) == 0 ? "leaks:" : text + ";") + " in " + parts[p].name + ": " + split->leak_check;
  }
  return text;
}

/// Number of clips, of parts that lack a split, that are in no part of it.
void ReportAbsent(const std::vector<MergePart>& parts, const std::vector<SplitOfPart>& splits, const std::string& name,
                  std::vector<Finding>& findings) {
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const bool has = std::any_of(splits.begin(), splits.end(), [&](const SplitOfPart& one) { return one.first == p; });
    const std::size_t clips = parts[p].dataset.clips.size();
    if (has || clips == 0) continue;
    findings.push_back(MakeFinding("split_incomplete", Severity::kWarning, static_cast<double>(clips),
                                   "split '" + name + "' is missing in " + parts[p].name + ", whose " +
                                       Counted(static_cast<long long>(clips), "clip") + " are in no part of it"));
  }
}

/// The splits of all parts, united by name. `merged` has its clips and their origins.
Expected<std::vector<Split>> MergeSplits(const std::vector<MergePart>& parts, const MergedRows& new_rows,
                                         const MergedDataset& merged, std::vector<Finding>& findings) {
  std::map<std::string, std::vector<SplitOfPart>> by_name;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (const Split& split : parts[p].dataset.splits) by_name[split.name].emplace_back(p, &split);
  }
  std::vector<Split> united;
  if (by_name.empty()) return united;
  const std::vector<Clip>& clips = merged.dataset.clips;
  const auto contents = ContentsOf(parts, merged);
  if (!contents) return Forward(contents);
  for (const auto& [name, splits] : by_name) {
    ReportAbsent(parts, splits, name, findings);
    std::vector<int> part_of_row(clips.size(), -1);
    std::vector<std::size_t> decided_by(clips.size());
    for (const auto& [p, split] : splits) {
      const std::vector<int> own = PartsOf(*split, new_rows[p].size());
      for (std::size_t row = 0; row < own.size(); ++row) {
        if (own[row] < 0) continue;
        const auto at = static_cast<std::size_t>(new_rows[p][row]);
        if (part_of_row[at] < 0) {
          part_of_row[at] = own[row];
          decided_by[at] = p;
        } else if (part_of_row[at] != own[row]) {
          findings.push_back(MakeFinding("split_part_differs", Severity::kWarning, 2.0,
                                         "split '" + name + "': " + NameOfPart(part_of_row[at]) + " in " +
                                             parts[decided_by[at]].name + ", " + NameOfPart(own[row]) + " in " +
                                             parts[p].name + "; kept in the first",
                                         FindingAction::kKept, clips[at].id()));
        }
      }
    }
    Split split;
    split.name = name;
    split.rule = RuleOf(parts, splits);
    for (std::size_t row = 0; row < clips.size(); ++row) {
      std::vector<int>* const of_part[] = {&split.train, &split.validation, &split.test};
      if (part_of_row[row] >= 0) of_part[part_of_row[row]]->push_back(static_cast<int>(row));
    }
    split.leak_check = CheckUnited(parts, splits, part_of_row, clips, *contents);
    if (split.leak_check.rfind("ok", 0) != 0) {
      findings.push_back(MakeFinding("split_leak", Severity::kError, 0.0, "split '" + name + "': " + split.leak_check));
    }
    united.push_back(std::move(split));
  }
  return united;
}

/// Clips of one id in the order of the parts.
using ClipsById = std::map<std::string, std::vector<std::pair<std::size_t, std::size_t>>>;

Status CheckMotionContent(const std::vector<MergePart>& parts) {
  const Dataset& first = parts[0].dataset;
  for (const MergePart& part : parts) {
    if (part.dataset.joints_only != first.joints_only) {
      const MergePart& joints = first.joints_only ? parts[0] : part;
      const MergePart& rotations = first.joints_only ? part : parts[0];
      return Fail(ErrorCode::kInconsistent, "has joints only, " + rotations.name + " has rotations", joints.name,
                  "fit rotations to its joints: mocurate fit");
    }
    if (!(part.dataset.axes == first.axes)) {
      return Fail(ErrorCode::kInconsistent,
                  "has the axes " + part.dataset.axes.Text() + ", " + parts[0].name + " has " + first.axes.Text(),
                  part.name, "bring both to canonical axes: mocurate fit writes such a dataset");
    }
  }
  return {};
}

/// The difference of two clips with one id; empty: none that matters.
Expected<std::string> DifferenceOf(const MergePart& part_a, std::size_t row_a, const MergePart& part_b,
                                   std::size_t row_b) {
  const Clip& a = part_a.dataset.clips[row_a];
  const Clip& b = part_b.dataset.clips[row_b];
  if (a.label != b.label) return "label '" + a.label + "' and '" + b.label + "'";
  if (a.fine_label != b.fine_label) return "fine label '" + a.fine_label + "' and '" + b.fine_label + "'";
  if (a.identity.licence != b.identity.licence) {
    return "licence '" + a.identity.licence + "' and '" + b.identity.licence + "'";
  }
  if (!(a.rate == b.rate)) return "rate " + a.rate.Text() + " and " + b.rate.Text() + " Hz";
  const int frames_a = a.motion->frame_count(), frames_b = b.motion->frame_count();
  if (frames_a != frames_b) return std::to_string(frames_a) + " and " + std::to_string(frames_b) + " frames";
  const bool segments = std::equal(a.segments.begin(), a.segments.end(), b.segments.begin(), b.segments.end(),
                                   [](const Segment& x, const Segment& y) {
                                     return x.begin_s == y.begin_s && x.end_s == y.end_s && x.label == y.label &&
                                            x.category == y.category;
                                   });
  if (!segments) return std::string("segments");
  const auto hash_a = part_a.motion_hash(row_a);
  if (!hash_a) return Forward(hash_a);
  const auto hash_b = part_b.motion_hash(row_b);
  if (!hash_b) return Forward(hash_b);
  return *hash_a == *hash_b ? std::string() : std::string("motion");
}

/// Clips with one id that differ: the first of them, and the number of such ids.
struct Conflict {
  std::string id, difference, first, other;  ///< names of the files
  std::size_t count = 0;
};

tl::unexpected<Error> FailBy(const Conflict& conflict) {
  const auto more = static_cast<long long>(conflict.count) - 1;
  return Fail(ErrorCode::kInconsistent,
              "clip '" + conflict.id + "' differs from that of " + conflict.first + ": " + conflict.difference +
                  (more > 0 ? "; " + Counted(more, "other clip") + (more > 1 ? " differ too" : " differs too") : ""),
              conflict.other,
              more > 0 ? "give two sources two names (ingest.source.name), or remove the clips of one: mocurate "
                         "dataset subset"
                       : "remove it from one: mocurate dataset subset --where \"id != '" + conflict.id + "'\"");
}

/// One clip of each id, and findings about those in several parts.
Status UniteClips(const std::vector<MergePart>& parts, MergedDataset& merged, MergedRows& new_rows) {
  ClipsById by_id;
  for (std::size_t p = 0; p < parts.size(); ++p) {
    new_rows.emplace_back(parts[p].dataset.clips.size(), -1);
    for (std::size_t row = 0; row < parts[p].dataset.clips.size(); ++row) {
      by_id[parts[p].dataset.clips[row].id()].emplace_back(p, row);
    }
  }
  Conflict conflict;
  for (const auto& [id, places] : by_id) {
    const auto [first, first_row] = places.front();
    std::string others;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto [p, row] = places[i];
      new_rows[p][row] = static_cast<int>(merged.origins.size());
      if (i == 0) continue;
      const auto difference = DifferenceOf(parts[first], first_row, parts[p], row);
      if (!difference) return Forward(difference);
      if (!difference->empty() && conflict.count++ == 0) {
        conflict = {id, *difference, parts[first].name, parts[p].name, 1};
      }
      merged.repeats.emplace_back(merged.origins.size(), places[i]);
      others += (others.empty() ? "" : ", ") + parts[p].name;
    }
    if (places.size() > 1) {
      merged.findings.push_back(MakeFinding("repeated_clip", Severity::kInfo, static_cast<double>(places.size()),
                                            "the same in " + parts[first].name + " and " + others,
                                            FindingAction::kDropped, id));
    }
    merged.origins.emplace_back(first, first_row);
    merged.dataset.clips.push_back(parts[first].dataset.clips[first_row]);
  }
  return conflict.count > 0 ? Status(FailBy(conflict)) : Status();
}

/// An incompatible clip is an error here, because its whole file is incompatible.
Status UniteTrees(const std::vector<MergePart>& parts, MergedDataset& merged) {
  const std::size_t count = merged.dataset.clips.size();
  std::vector<std::string> ids;
  for (const Clip& clip : merged.dataset.clips) ids.push_back(clip.id());
  std::vector<Finding> findings;
  UniteSkeletons(merged.dataset, findings);
  if (merged.dataset.clips.size() == count) return {};
  const Finding& finding = findings.front();
  const auto at = std::find(ids.begin(), ids.end(), finding.clip) - ids.begin();
  const std::string& file = parts[merged.origins[static_cast<std::size_t>(at)].first].name;
  const bool pose = finding.value > 0.0;
  const auto degrees = [](double radians) { return RoundedText(radians * 180.0 / kPi, 3) + " degrees"; };
  return Fail(ErrorCode::kInconsistent,
              pose ? "its rotations refer to another rest pose: a bone direction differs by " + degrees(finding.value) +
                         ", allowed are " + degrees(kSameRestPose)
                   : "its joints are not those of skeleton '" + merged.dataset.skeleton->name + "'",
              file + ": " + finding.clip,
              pose ? "fit one skeleton to the joints of all: mocurate fit"
                   : "fit it to that skeleton first: mocurate fit --skeleton " + merged.dataset.skeleton->name);
}

Status UniteLabels(const std::vector<MergePart>& parts, Dataset& dataset) {
  for (const MergePart& part : parts) {
    for (const std::string& label : part.dataset.labels) {
      if (dataset.LabelIndex(label) < 0) dataset.labels.push_back(label);
    }
    for (const FineLabel& fine : part.dataset.fine_labels) {
      const std::string& parent = part.dataset.labels[static_cast<std::size_t>(fine.parent)];
      const int known = dataset.FineLabelIndex(fine.name);
      if (known < 0) {
        dataset.fine_labels.push_back({fine.name, dataset.LabelIndex(parent)});
        continue;
      }
      const FineLabel& there = dataset.fine_labels[static_cast<std::size_t>(known)];
      const std::string& other = dataset.labels[static_cast<std::size_t>(there.parent)];
      if (other == parent) continue;
      return Fail(
          ErrorCode::kInconsistent,
          "fine label '" + fine.name + "' is of class '" + parent + "', in the datasets before of '" + other + "'",
          part.name, "rename one of the classes: mocurate dataset relabel");
    }
  }
  return {};
}

std::string RecipeOf(const std::vector<MergePart>& parts) {
  std::string recipe = "merged from " + Counted(static_cast<long long>(parts.size()), "dataset") + ":\n";
  for (const MergePart& part : parts) {
    recipe += "- " + part.name + ": " + Counted(static_cast<long long>(part.dataset.clips.size()), "clip") +
              (part.content_sha256.empty() ? "" : ", content_sha256 " + part.content_sha256) + "\n";
  }
  for (const MergePart& part : parts) {
    if (part.dataset.recipe.empty()) continue;
    recipe += "recipe of " + part.name + ":\n" + part.dataset.recipe + (part.dataset.recipe.back() == '\n' ? "" : "\n");
  }
  return recipe;
}

}  // namespace

Expected<MergedDataset> MergeDatasets(const std::vector<MergePart>& parts) {
  if (parts.empty()) return Fail(ErrorCode::kUsage, "no dataset to merge is given");
  if (Status alike = CheckMotionContent(parts); !alike) return Forward(alike);
  MergedDataset merged;
  merged.dataset.joints_only = parts[0].dataset.joints_only;
  merged.dataset.axes = parts[0].dataset.axes;
  MergedRows new_rows;
  if (Status united = UniteClips(parts, merged, new_rows); !united) return Forward(united);
  if (merged.dataset.clips.empty())
    return Fail(ErrorCode::kInconsistent, "none of the datasets has a clip", parts[0].name);
  if (Status united = UniteTrees(parts, merged); !united) return Forward(united);
  if (Status united = UniteLabels(parts, merged.dataset); !united) return Forward(united);
  FindMixedRates(merged.dataset, merged.findings);
  auto splits = MergeSplits(parts, new_rows, merged, merged.findings);
  if (!splits) return Forward(splits);
  merged.dataset.splits = std::move(*splits);
  for (const MergePart& part : parts) {
    std::vector<Finding> findings = part.dataset.findings;  // its splits are no longer these
    const auto of_splits = [](const Finding& finding) { return finding.code == "empty_part"; };
    findings.erase(std::remove_if(findings.begin(), findings.end(), of_splits), findings.end());
    AddFindings(findings, merged.dataset.findings);
  }
  merged.dataset.findings.insert(merged.dataset.findings.end(), merged.findings.begin(), merged.findings.end());
  merged.dataset.recipe = RecipeOf(parts);
  merged.dataset.created_by = CreatedBy();
  return merged;
}

}  // namespace mocurate
