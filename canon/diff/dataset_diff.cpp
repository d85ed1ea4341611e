#include "canon/diff/dataset_diff.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "canon/splits/leaks.h"
#include "core/base/pi.h"
#include "core/base/text.h"
#include "core/geometry/rotation.h"
#include "core/store/dataset_clips.h"

namespace mocurate {
namespace {

std::map<std::string, std::size_t> RowsById(const DatasetClips& clips) {
  std::map<std::string, std::size_t> rows;
  for (std::size_t row = 0; row < clips.size(); ++row) rows[clips.Id(row)] = row;
  return rows;
}

/// Part of each clip in each split: split -> clip -> "train".
std::map<std::string, std::map<std::string, std::string>> PartsBySplit(const DatasetClips& clips) {
  std::map<std::string, std::map<std::string, std::string>> parts;
  for (const Split& split : clips.splits()) {
    auto& own = parts[split.name];
    const std::vector<int> of_rows = PartsOf(split, clips.size());
    for (std::size_t row = 0; row < of_rows.size(); ++row) {
      if (of_rows[row] >= 0) own[clips.Id(row)] = NameOfPart(of_rows[row]);
    }
  }
  return parts;
}

nlohmann::json JointNames(const SkeletonPtr& skeleton) {
  nlohmann::json names = nlohmann::json::array();
  if (skeleton == nullptr) return names;
  for (const Joint& joint : skeleton->joints) names.push_back(joint.name);
  return names;
}

/// Paths of the fields that the format does not name.
nlohmann::json OtherPaths(const DatasetClips& clips) {
  const OtherFields others = clips.ReadOtherFields();
  std::set<std::string> paths;
  for (const ExtraFields* fields : {&others.of_clips, &others.of_frames, &others.of_set}) {
    for (const auto& [path, field] : *fields) paths.insert(path);
  }
  for (const auto& [path, reason] : others.unreadable) paths.insert(path);
  return paths;
}

/// "0-1.5 wave, ..." of a clip's segments.
std::string SegmentsText(const Clip& clip) {
  std::string text;
  for (const Segment& segment : clip.segments) {
    text += (text.empty() ? "" : ", ") + FormatDouble(segment.begin_s) + "-" + FormatDouble(segment.end_s) + " " +
            segment.label;
  }
  return text;
}

/// Null where both motions are equal to storage precision. Joints and rotations of two trees are not compared.
nlohmann::json MotionDifference(const std::optional<Motion>& before, const std::optional<Motion>& after,
                                bool same_tree) {
  constexpr double kStored = 1e-6;  // metres and radians: float32
  const int frames_before = before ? before->frame_count() : 0, frames_after = after ? after->frame_count() : 0;
  nlohmann::json difference = {{"frames_before", frames_before},
                               {"frames_after", frames_after},
                               {"joint_mm", nullptr},
                               {"rotation_deg", nullptr}};
  if (!before || !after || frames_before != frames_after || !same_tree) {
    return before || after ? difference : nlohmann::json();
  }
  double distance = 0.0, worst = 0.0, angle = 0.0;
  const int J = before->joint_count();
  for (int f = 0; f < frames_before; ++f) {
    for (int j = 0; j < J; ++j) {
      const double apart = (before->joints.at(f, j) - after->joints.at(f, j)).norm();
      distance += apart;
      worst = std::max(worst, apart);
    }
  }
  const double samples = std::max(1.0, static_cast<double>(frames_before) * J);
  difference["joint_mm"] = 1000.0 * distance / samples;
  bool turned = before->joints_only() != after->joints_only();
  if (!before->joints_only() && !after->joints_only()) {
    for (std::size_t i = 0; i < before->rotation.size(); ++i) {
      const double by = AngleBetween(before->rotation[i], after->rotation[i]);
      angle += by;
      turned = turned || by > kStored;
    }
    difference["rotation_deg"] = angle / samples * 180.0 / kPi;
  }
  return worst > kStored || turned ? difference : nlohmann::json();
}

}  // namespace

Expected<nlohmann::json> DiffDatasets(const std::filesystem::path& before, const std::filesystem::path& after) {
  const auto a = DatasetClips::Open(before, DatasetClips::Check::kHashes);
  if (!a) return Forward(a);
  const auto b = DatasetClips::Open(after, DatasetClips::Check::kHashes);
  if (!b) return Forward(b);
  nlohmann::json diff = {{"equal", 0}};
  for (const char* key : {"dataset", "changed", "added", "removed", "relabelled", "refitted", "moved", "splits_added",
                          "splits_removed"}) {
    diff[key] = nlohmann::json::array();
  }
  const auto rows_a = RowsById(*a), rows_b = RowsById(*b);
  const auto parts_a = PartsBySplit(*a), parts_b = PartsBySplit(*b);
  for (const auto& [name, parts] : parts_b) {
    if (parts_a.count(name) == 0) diff["splits_added"].push_back(name);
  }
  for (const auto& [name, parts] : parts_a) {
    if (parts_b.count(name) == 0) diff["splits_removed"].push_back(name);
  }
  for (const auto& [id, row] : rows_b) {
    if (rows_a.count(id) == 0) diff["added"].push_back(id);
  }
  const bool same_tree = !a->skeleton() || !b->skeleton() || SameTree(*a->skeleton(), *b->skeleton());
  const std::pair<const char*, std::pair<nlohmann::json, nlohmann::json>> of_set[] = {
      {"skeleton", {JointNames(a->skeleton()), JointNames(b->skeleton())}},
      {"axes", {a->axes().Text(), b->axes().Text()}},
      {"labels", {a->labels(), b->labels()}},
      {"other_fields", {OtherPaths(*a), OtherPaths(*b)}},
      {"recipe", {a->recipe(), b->recipe()}}};
  for (const auto& [field, values] : of_set) {
    if (values.first == values.second) continue;
    diff["dataset"].push_back({{"field", field}, {"before", values.first}, {"after", values.second}});
  }
  int equal = 0;
  for (const auto& [id, row_a] : rows_a) {
    const auto found = rows_b.find(id);
    if (found == rows_b.end()) {
      diff["removed"].push_back(id);
      continue;
    }
    bool differs = false;
    const std::string &label_a = a->Label(row_a), &label_b = b->Label(found->second);
    if (label_a != label_b) {
      diff["relabelled"].push_back({{"clip", id}, {"before", label_a}, {"after", label_b}});
      differs = true;
    }
    for (const auto& [split, of_a] : parts_a) {
      const auto of_b = parts_b.find(split);
      if (of_b == parts_b.end()) continue;
      const auto part = [&clip = id](const std::map<std::string, std::string>& parts) {
        const auto one = parts.find(clip);
        return one == parts.end() ? std::string("none") : one->second;
      };
      if (part(of_a) == part(of_b->second)) continue;
      diff["moved"].push_back({{"clip", id}, {"split", split}, {"before", part(of_a)}, {"after", part(of_b->second)}});
      differs = true;
    }
    const auto clip_a = a->Read(row_a);
    if (!clip_a) return Forward(clip_a);
    const auto clip_b = b->Read(found->second);
    if (!clip_b) return Forward(clip_b);
    const std::pair<const char*, std::pair<std::string, std::string>> texts[] = {
        {"rate", {clip_a->rate.Text(), clip_b->rate.Text()}},
        {"fine_label", {clip_a->fine_label, clip_b->fine_label}},
        {"licence", {clip_a->identity.licence, clip_b->identity.licence}},
        {"segments", {SegmentsText(*clip_a), SegmentsText(*clip_b)}}};
    for (const auto& [field, values] : texts) {
      if (values.first == values.second) continue;
      diff["changed"].push_back({{"clip", id}, {"field", field}, {"before", values.first}, {"after", values.second}});
      differs = true;
    }
    nlohmann::json motion = MotionDifference(clip_a->motion, clip_b->motion, same_tree);
    if (!motion.is_null()) {
      motion["clip"] = id;
      diff["refitted"].push_back(std::move(motion));
      differs = true;
    }
    equal += differs ? 0 : 1;
  }
  diff["equal"] = equal;
  return diff;
}

}  // namespace mocurate
