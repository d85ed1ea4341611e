#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "canon/audit/audit.h"
#include "canon/splits/groups.h"
#include "canon/splits/leaks.h"
#include "canon/splits/splits.h"
#include "core/base/text.h"
#include "core/quality/checks.h"
#include "core/quality/duplicates.h"
#include "core/quality/handedness.h"
#include "core/quality/tracked_points.h"

namespace mocurate {
namespace {

constexpr double kIdentical_m = 1e-5;  ///< error of joint positions through storage

/// A motion's joints as input of the detectors; it refers to the motion, which must outlive it.
struct PointsOfMotion {
  std::vector<double> confidence, time_s;
  TrackedPoints points;

  explicit PointsOfMotion(const Motion& motion) : points{motion.joints, confidence, time_s} {
    for (int f = 0; f < motion.frame_count(); ++f) time_s.push_back(motion.rate.FrameTime(f));
    for (const Joint& joint : motion.skeleton->joints) {
      points.names.push_back(joint.name);
      points.parents.push_back(joint.parent);
      points.rest_lengths.push_back(joint.rest_offset.norm());
    }
    points.body = FindHandednessPoints([&](std::string_view name) { return motion.skeleton->FindJoint(name); });
  }
  PointsOfMotion(const PointsOfMotion&) = delete;
  PointsOfMotion& operator=(const PointsOfMotion&) = delete;
};

void AddFindings(const std::vector<Finding>& found, const char* code, const Clip& clip,
                 std::vector<AuditFinding>& findings) {
  for (const Finding& finding : found) {
    if (finding.code != code || finding.severity == Severity::kInfo) continue;
    findings.push_back({finding, "", "", {}});
    findings.back().finding.clip = clip.id();
  }
}

/// Knees alone are insufficient: depth trackers bend straight legs backwards, and fits with constant bones follow them
/// (KARD: 8 of 432 clips, all by knees alone).
bool ShownByFeetOrHands(const HandednessMeasure& measure) {
  return std::any_of(measure.cues.begin(), measure.cues.end(),
                     [](const HandednessCue& cue) { return cue.name != "knees" && cue.frames > 0 && cue.score > 0.0; });
}

/// PartsOf each split.
std::vector<std::vector<int>> PartsOfSplits(const Dataset& dataset) {
  std::vector<std::vector<int>> parts;
  for (const Split& split : dataset.splits) parts.push_back(PartsOf(split, dataset.clips.size()));
  return parts;
}

/// Two clips with the same motion, or known by their source data to be the same.
struct Repeat {
  Duplicate pair;
  bool same_source = false;
};

using Repeats = std::map<std::pair<std::size_t, std::size_t>, Repeat>;

/// Whether one of two clips is redundant: same person, labels, segments, joints and rotations.
bool HaveSameText(const Clip& a, const Clip& b) {
  const auto same_segment = [](const Segment& x, const Segment& y) {
    return x.label == y.label && std::abs(x.begin_s - y.begin_s) < 1e-6 && std::abs(x.end_s - y.end_s) < 1e-6;
  };
  const Motion &x = *a.motion, &y = *b.motion;
  const bool same_words =
      a.label == b.label && a.fine_label == b.fine_label && a.identity.person == b.identity.person &&
      std::equal(a.segments.begin(), a.segments.end(), b.segments.begin(), b.segments.end(), same_segment);
  if (!same_words || x.joints.xyz.size() != y.joints.xyz.size() || x.rotation.size() != y.rotation.size()) return false;
  for (std::size_t i = 0; i < x.joints.xyz.size(); ++i) {
    if (std::abs(x.joints.xyz[i] - y.joints.xyz[i]) > kIdentical_m) return false;
  }
  for (std::size_t i = 0; i < x.rotation.size(); ++i) {
    if (std::abs(x.rotation[i].dot(y.rotation[i])) < 1.0 - kIdentical_m) return false;
  }
  return true;
}

/// Adds the pairs of equal content that are not there yet.
void AddEqualContents(const Dataset& dataset, const std::vector<std::vector<int>>& parts, Repeats& repeats) {
  const std::vector<std::string> contents = ContentsOf(dataset.clips);
  std::map<std::string, std::vector<std::size_t>> groups;
  for (std::size_t row = 0; row < contents.size(); ++row) {
    if (!contents[row].empty()) groups[contents[row]].push_back(row);
  }
  const auto frames = [&](std::size_t row) {
    return dataset.clips[row].motion ? dataset.clips[row].motion->frame_count() : 0;
  };
  const auto add = [&](std::size_t a, std::size_t b) {
    if (a == b) return;
    const auto [first, second] = std::minmax(a, b);
    Repeat repeat;
    repeat.pair.first = first;
    repeat.pair.second = second;
    repeat.pair.whole = true;
    repeat.pair.frame_end = frames(first);
    repeat.pair.second_end = frames(second);
    repeat.same_source = !SourceContentOf(dataset.clips[first]).empty();
    repeats.emplace(std::make_pair(first, second), repeat);
  };
  for (const auto& [content, rows] : groups) {
    for (const std::size_t row : rows) add(rows.front(), row);
    for (const std::vector<int>& part : parts) {
      std::map<int, std::size_t> first_of;
      for (const std::size_t row : rows) first_of.emplace(part[row], row);
      first_of.erase(-1);
      for (const std::size_t row : rows) {
        for (const auto& [other, first] : first_of) {
          if (part[row] >= 0 && part[row] != other) add(first, row);
        }
      }
    }
  }
}

AuditFinding OfSet(const char* code, const std::string& message) {
  return {MakeFinding(code, Severity::kWarning, 0.0, message), "", "", {}};
}

/// A name without blanks and case.
std::string Plain(const std::string& name) {
  std::string plain;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isspace(byte) == 0) plain += static_cast<char>(std::tolower(byte));
  }
  return plain;
}

std::set<std::string> LabelsOf(const Dataset& dataset, const std::vector<int>& rows) {
  std::set<std::string> labels;
  for (const int row : rows) labels.insert(dataset.clips[static_cast<std::size_t>(row)].label);
  return labels;
}

/// "3 clips in train (ID), 1 clip in test (ID)".
std::string PartsText(const Dataset& dataset, const RowsByPart& rows) {
  std::string text;
  for (const auto& [part, of_part] : rows) {
    text += (text.empty() ? "" : ", ") + Counted(static_cast<long long>(of_part.size()), "clip") + " in " +
            NameOfPart(part) + " (" + dataset.clips[of_part.front()].id() + ")";
  }
  return text;
}

/// About a group that is in two parts of a split, with a clip of either.
AuditFinding SharedGroup(const Dataset& dataset, const Split& split, const RowsByPart& rows,
                         const std::string& message) {
  const auto &first = *rows.begin(), &second = *std::next(rows.begin());
  AuditFinding found = OfSet("split_leak", message + PartsText(dataset, rows));
  found.finding.clip = dataset.clips[first.second.front()].id();
  found.suggested = dataset.clips[second.second.front()].id();
  found.parts = {{split.name, NameOfPart(first.first), NameOfPart(second.first)}};
  return found;
}

/// Persons, styles or performances in two parts of a split.
void AddSharedGroups(const Dataset& dataset, const Split& split, std::vector<AuditFinding>& findings) {
  const std::optional<SplitBy> apart = KeptApart(split);
  const SplitBy by = apart.value_or(SplitBy::kPerson);
  std::vector<std::string> groups;
  for (const Clip& clip : dataset.clips) {
    const std::string group = GroupOf(by, clip, false);
    groups.push_back(by == SplitBy::kPerson && !group.empty() ? clip.identity.source + "/" + group : group);
  }
  const std::set<std::string> all(groups.begin(), groups.end());
  const auto shared = InTwoParts(PartsOf(split, dataset.clips.size()), groups);
  if (shared.empty()) return;
  if (!apart) {
    findings.push_back(SharedGroup(dataset, split, shared.begin()->second,
                                   "split '" + split.name + "' has " + std::to_string(shared.size()) + " of " +
                                       Counted(static_cast<long long>(all.size()), "person") +
                                       " in two parts, and its rule '" + split.rule +
                                       "' does not say whether it may; " + shared.begin()->first + ": "));
    findings.back().finding.value = static_cast<double>(shared.size());
    return;
  }
  const std::string kind = by == SplitBy::kPerson || by == SplitBy::kStyle ? NameOf(by) : "performance";
  for (const auto& [group, rows] : shared) {
    findings.push_back(
        SharedGroup(dataset, split, rows, kind + " '" + group + "' is in two parts of split '" + split.name + "': "));
    findings.back().finding.severity = Severity::kError;
    findings.back().finding.value = static_cast<double>(rows.size());
  }
}

}  // namespace

std::vector<AuditFinding> FindClipErrors(const Dataset& dataset) {
  std::vector<AuditFinding> findings;
  for (const Clip& clip : dataset.clips) {
    if (!clip.motion) continue;
    const PointsOfMotion points(*clip.motion);
    AddFindings(FindSwaps(points.points), "swapped_sides", clip, findings);
    AddFindings(FindRepeats(points.points), "frozen_frames", clip, findings);
    const HandednessMeasure measure = MeasureHandedness(clip.motion->joints, points.points.body);
    if (measure.handedness != Handedness::kLeft || !ShownByFeetOrHands(measure)) continue;
    findings.push_back({FrameFinding("mirrored", 0, clip.motion->frame_count(), "", measure.confidence,
                                     "left and right are exchanged, or the frame is left-handed: " + measure.evidence),
                        "",
                        "",
                        {}});
    findings.back().finding.clip = clip.id();
  }
  return findings;
}

std::vector<AuditFinding> FindRepeatedClips(const Dataset& dataset, double distance) {
  const std::vector<std::vector<int>> parts = PartsOfSplits(dataset);
  const auto motion_at = [&](std::size_t i) { return dataset.clips[i].motion ? &*dataset.clips[i].motion : nullptr; };
  Repeats repeats;
  for (const Duplicate& pair : FindDuplicates(dataset.clips.size(), motion_at, distance))
    repeats[{pair.first, pair.second}].pair = pair;
  AddEqualContents(dataset, parts, repeats);
  std::vector<AuditFinding> findings;
  for (const auto& [rows, repeat] : repeats) {
    const Duplicate& pair = repeat.pair;
    const Clip &first = dataset.clips[pair.first], &second = dataset.clips[pair.second];
    AuditFinding found;
    std::string where;
    for (std::size_t s = 0; s < parts.size(); ++s) {
      const int a = parts[s][pair.first], b = parts[s][pair.second];
      if (a < 0 || b < 0 || a == b) continue;
      found.parts.push_back({dataset.splits[s].name, NameOfPart(a), NameOfPart(b)});
      where += (where.empty() ? "; " : ", ") + std::string("split '") + dataset.splits[s].name + "' has this clip in " +
               NameOfPart(a) + ", the other in " + NameOfPart(b);
    }
    const bool leaks = !found.parts.empty();
    const std::string what =
        std::string(repeat.same_source ? "is of the same source data as "
                    : pair.whole       ? "has the same motion as "
                                       : "shares a part with ") +
        (pair.mirrored ? "the mirror image of " : "") + second.id() +
        (pair.whole ? "" : ", frames " + std::to_string(pair.second_begin) + " to " + std::to_string(pair.second_end));
    found.finding =
        FrameFinding(leaks ? "leak" : "duplicate", pair.frame_begin, pair.frame_end, "", pair.distance, what + where);
    if (leaks) found.finding.severity = Severity::kError;
    found.finding.clip = first.id();
    found.suggested = second.id();
    const bool one_part = std::all_of(parts.begin(), parts.end(), [&](const std::vector<int>& part) {
      return part[pair.first] == part[pair.second];
    });
    const bool compared = first.motion && second.motion;
    const bool alike = compared && one_part && pair.whole && !pair.mirrored && HaveSameText(first, second);
    if (alike) found.safe_to_drop = second.id();
    findings.push_back(std::move(found));
  }
  return findings;
}

std::vector<AuditFinding> FindSetErrors(const Dataset& dataset) {
  std::vector<AuditFinding> findings;
  for (const Split& split : dataset.splits) {
    AddSharedGroups(dataset, split, findings);
    const std::set<std::string> trained = LabelsOf(dataset, split.train);
    for (const auto& [part, rows] : {std::pair("validates", &split.validation), std::pair("tests", &split.test)}) {
      for (const std::string& label : LabelsOf(dataset, *rows)) {
        if (trained.count(label) > 0) continue;
        findings.push_back(
            OfSet("class_not_trained", "split '" + split.name + "' " + part + " class '" + label +
                                           "', which has no training clip: change the split, or remove it "
                                           "from assemble.classes"));
      }
    }
  }
  std::map<std::string, std::set<std::string>> persons;
  for (const Clip& clip : dataset.clips)
    persons[clip.identity.source + '\n' + Plain(clip.identity.person)].insert(clip.identity.person);
  for (const auto& [plain, names] : persons) {
    if (names.size() < 2) continue;
    std::string all;
    for (const std::string& name : names) all += (all.empty() ? "'" : ", '") + name + "'";
    findings.push_back(
        OfSet("names_alike", "persons " + all +
                                 " differ in case or blanks only: if they are the same, a split by person separates "
                                 "them; unify the names in the source"));
  }
  return findings;
}

}  // namespace mocurate
