#include "canon/exports/written_set.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "canon/exports/clip_names.h"
#include "canon/splits/leaks.h"
#include "core/base/table_text.h"
#include "core/base/text.h"

namespace mocurate {
namespace {

std::string CsvLine(const std::vector<std::string>& cells) {
  std::string line;
  for (const std::string& cell : cells) line += (line.empty() ? "" : ",") + CsvCell(cell);
  return line + "\n";
}

/// Whether the name is a built-in skeleton's with the same joints.
bool IsBuiltIn(const Skeleton& skeleton) {
  if (skeleton.name.empty() || skeleton.name.find_first_of("/.") != std::string::npos) return false;
  const auto known = LoadSkeleton(skeleton.name);
  return known && SameTree(**known, skeleton);
}

std::string YamlNumbers(const Vector3d& v) {
  return "[" + FormatDouble(v.x()) + ", " + FormatDouble(v.y()) + ", " + FormatDouble(v.z()) + "]";
}

/// In the form of configs/skeletons: names, tree, rest pose, mirror partners, synonyms, limits.
std::string SkeletonText(const Skeleton& skeleton) {
  std::string text = "name: " + YamlQuoted(skeleton.name) + "\njoints:\n";
  for (std::size_t j = 0; j < skeleton.joints.size(); ++j) {
    const Joint& joint = skeleton.joints[j];
    text += "  - {name: " + YamlQuoted(joint.name);
    if (joint.parent >= 0) text += ", parent: " + YamlQuoted(skeleton.joints[joint.parent].name);
    text += ", rest_offset: " + YamlNumbers(joint.rest_offset);
    if (joint.mirror >= 0 && joint.mirror != static_cast<int>(j)) {
      text += ", mirror: " + YamlQuoted(skeleton.joints[joint.mirror].name);
    }
    text += ", radius: " + FormatDouble(joint.radius);
    if (joint.landmark) text += ", landmark: true";
    if (joint.limits) {
      text += ", limits_min: " + YamlNumbers(joint.limits->min) + ", limits_max: " + YamlNumbers(joint.limits->max);
    }
    if (!joint.synonyms.empty()) text += ", synonyms: " + YamlList(joint.synonyms);
    text += "}\n";
  }
  return text;
}

/// Persons of each part, where no person is in two and every clip is in one.
std::optional<std::map<std::string, std::set<std::string>>> PersonsOfParts(const std::vector<int>& parts,
                                                                           const std::vector<WrittenClip>& clips) {
  std::map<std::string, std::set<std::string>> persons;
  std::map<std::string, std::string> part_of;
  for (const WrittenClip& clip : clips) {
    const std::string part = NameOfPart(parts[clip.position]);
    if (part.empty() || part_of.emplace(clip.person, part).first->second != part) return std::nullopt;
    persons[part].insert(clip.person);
  }
  return persons;
}

std::string SplitsText(const ExportSet& set, const std::vector<WrittenClip>& clips, const std::string& role_split,
                       std::vector<std::string>& notes) {
  std::string text;
  for (const Split& split : set.splits) {
    if (split.name == role_split) {
      text += "    - {name: " + YamlQuoted(split.name) + ", by: role}\n";
      continue;
    }
    const auto persons = PersonsOfParts(PartsOf(split, set.ids.size()), clips);
    if (!persons) {
      notes.push_back("split '" + split.name + "' is not by person: source.yaml cannot declare it");
      continue;
    }
    text += "    - {name: " + YamlQuoted(split.name) + ", by: person, absent: refuse";
    for (const char* part : {"test", "validation"}) {
      const auto of_part = persons->find(part);
      if (of_part == persons->end()) continue;
      text += std::string(", ") + part + ": " + YamlList({of_part->second.begin(), of_part->second.end()});
    }
    text += "}\n";
  }
  return text.empty() ? "" : "  splits:\n" + text;
}

/// Classes in their order. With unlabelled clips only the order is written, because a list of classes would exclude
/// them.
std::string ClassesText(const ExportSet& set, const std::vector<WrittenClip>& clips) {
  if (set.labels.empty()) return "";
  const bool labelled = std::all_of(clips.begin(), clips.end(), [&](const WrittenClip& clip) {
    return std::find(set.labels.begin(), set.labels.end(), clip.label) != set.labels.end();
  });
  if (!labelled) return "  label_order: " + YamlList(set.labels) + "\n";
  std::string text = "  classes:\n";
  for (const std::string& label : set.labels) text += "    - {name: " + YamlQuoted(label) + "}\n";
  return text;
}

/// The value common to all clips; empty where they differ.
template <class Value>
std::string InCommon(const std::vector<WrittenClip>& clips, Value value) {
  for (const WrittenClip& clip : clips) {
    if (value(clip) != value(clips.front())) return "";
  }
  return clips.empty() ? "" : value(clips.front());
}

/// person -> role of persons whose clips all have it.
std::map<std::string, std::string> RolesOf(const std::vector<WrittenClip>& clips) {
  std::map<std::string, std::set<std::string>> roles;
  for (const WrittenClip& clip : clips) roles[clip.person].insert(clip.role);
  std::map<std::string, std::string> common;
  for (const auto& [person, of_person] : roles) {
    if (of_person.size() == 1 && !of_person.begin()->empty()) common[person] = *of_person.begin();
  }
  return common;
}

}  // namespace

WrittenClip WrittenClipOf(std::size_t position, const Clip& clip, std::string file) {
  WrittenClip written;
  written.position = position;
  written.file = std::move(file);
  written.person = clip.identity.person;
  written.label = clip.label;
  written.fine_label = clip.fine_label;
  written.licence = clip.identity.licence;
  written.role = clip.role;
  written.frames = clip.motion->frame_count();
  written.rate = clip.motion->rate;
  return written;
}

ExportedFile ClipTable(const ExportSet& set, const std::vector<WrittenClip>& clips) {
  std::vector<std::string> header = {"file",  "clip",       "person", "recording", "label",
                                     "class", "fine_label", "frames", "rate_hz"};
  const bool states_origin = std::any_of(clips.begin(), clips.end(), [](const auto& c) { return !c.origin.empty(); });
  if (states_origin) header.insert(header.end(), {"origin", "raised_m"});
  std::vector<std::vector<int>> parts;
  for (const Split& split : set.splits) {
    header.push_back("split_" + WithoutControls(split.name));
    parts.push_back(PartsOf(split, set.ids.size()));
  }
  std::string text = CsvLine(header);
  for (const WrittenClip& clip : clips) {
    const auto label = std::find(set.labels.begin(), set.labels.end(), clip.label);
    const ClipIdParts id = PartsOfClipId(set.ids[clip.position]);
    std::vector<std::string> cells = {clip.file,
                                      WithoutControls(set.ids[clip.position]),
                                      WithoutControls(id.person),
                                      WithoutControls(id.recording),
                                      WithoutControls(clip.label),
                                      label == set.labels.end() ? "" : std::to_string(label - set.labels.begin()),
                                      WithoutControls(clip.fine_label),
                                      std::to_string(clip.frames),
                                      FormatDouble(clip.rate.hz())};
    if (states_origin) cells.insert(cells.end(), {clip.origin, RoundedText(clip.raised_m, 6)});
    for (const std::vector<int>& of_split : parts) cells.emplace_back(NameOfPart(of_split[clip.position]));
    text += CsvLine(cells);
  }
  return {kClipTable, std::move(text)};
}

Status OneRate::Check(const Clip& clip) {
  const FrameRate& rate = clip.motion->rate;
  if (!rate_) rate_ = rate;
  if (rate == *rate_) return {};
  return Fail(ErrorCode::kUnsupported,
              FormatDouble(rate.hz()) + " frames per second, the clips before have " + FormatDouble(rate_->hz()) +
                  ": files of this layout have no rate",
              clip.id(),
              "export clips of one rate: mocurate dataset subset --where 'rate == " + FormatDouble(rate_->hz()) +
                  "', or make the set with canon.rate");
}

std::string YamlList(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + YamlQuoted(text);
  return "[" + list + "]";
}

std::string YamlMap(const std::map<std::string, std::string>& texts) {
  std::string map;
  for (const auto& [key, text] : texts) map += (map.empty() ? "" : ", ") + YamlQuoted(key) + ": " + YamlQuoted(text);
  return "{" + map + "}";
}

void AddDeclaration(const ExportSet& set, const std::vector<WrittenClip>& clips, const FileDeclaration& declaration,
                    std::vector<std::string>& notes, std::vector<ExportedFile>& files) {
  const bool built_in = IsBuiltIn(*set.skeleton);
  std::string skeleton = built_in ? set.skeleton->name : "";
  if (!built_in && !declaration.has_tree) {
    skeleton = (set.folder / kSkeletonFile).string();
    files.push_back({kSkeletonFile, SkeletonText(*set.skeleton)});
    notes.push_back("skeleton '" + set.skeleton->name +
                    "' is not built in: source.yaml has the path of skeleton.yaml, change it when the "
                    "folder moves");
  }
  const bool joints = declaration.layout == "npz" || declaration.layout == "humanact12" || declaration.layout == "csv";
  if (declaration.layout == "npz" && !set.joints_only && set.rotations != RotationArrays::kNone) {
    notes.emplace_back(
        "mocurate reads the joints of .npz files, not their rotations; use layout bvh to keep rotations");
  }
  std::string text = "# Written by `mocurate export --layout " + declaration.layout +
                     "`: how mocurate reads these files again,\n#   mocurate export . --source source.yaml -o arrays" +
                     (joints ? " --as joints\n" : "\n");
  text += declaration.joint_table ? "# `mocurate run source.yaml --to assemble` fits rotations to the joints.\n"
                                  : "#   mocurate run source.yaml --to assemble\n";
  text += "name: " + YamlQuoted(declaration.source + "_" + declaration.layout) + "\n";
  text += "skeleton: " + YamlQuoted(skeleton) + "\n";
  text += "ingest:\n  path: .\n  source:\n    name: " + YamlQuoted(declaration.source) + "\n";
  for (const auto& [option, value] : declaration.options) text += "    " + option + ": " + value + "\n";
  text += "    skeleton: " + YamlQuoted(skeleton) + "\n";
  const std::string licence = InCommon(clips, [](const WrittenClip& clip) { return clip.licence; });
  if (!licence.empty()) text += "    licence: " + YamlQuoted(licence) + "\n";
  if (const auto roles = RolesOf(clips); !roles.empty() && declaration.role_split.empty())
    text += "    roles: " + YamlMap(roles) + "\n";
  if (!set.checks.empty()) text += "    checks:\n";
  for (const auto& [code, rule] : set.checks) text += "      " + code + ": " + rule + "\n";
  if (!declaration.joint_table) text += "fitting:\n  method: none\n";
  text += "canon:\n  trim: {min_length: 0 s}\n  facing: {rule: none}\n";
  text += "assemble:\n  recipe: " + YamlQuoted("read from an export, layout " + declaration.layout) + "\n" +
          ClassesText(set, clips) + SplitsText(set, clips, declaration.role_split, notes);
  files.push_back({declaration.name, std::move(text)});
}

}  // namespace mocurate
