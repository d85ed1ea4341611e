#include "ingest/inspect/declaration_writer.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "core/base/file.h"
#include "core/base/text.h"
#include "ingest/folder_listing.h"
#include "ingest/inspect/file_names.h"
#include "ingest/inspect/inspect.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

/// Of NTU RGB+D, 1 to 120.
bool IsNtuActionOfTwo(long long action) { return (action >= 50 && action <= 60) || (action >= 106 && action <= 120); }

/// NTU's names say everything; how many people a file holds is declared per action.
void WriteNtuNames(const ClipConsensus& source, DeclarationWriter& writer) {
  writer.Value("files", "\"S{setup:3}C{camera:3}P{person:3}R{repetition:3}A{action:3}.skeleton\"",
               "declared by the format");
  writer.Value("person", "\"P{person}{body}\"", "declared by the format; {body} numbers the people of a file");
  writer.Value("label", "\"A{action}\"", "declared by the format");
  std::set<std::string> of_two, of_one;
  for (const InspectedClip* clip : source.clips()) {
    const std::string file = clip->file;
    const std::size_t at = file.rfind('A');
    if (at == std::string::npos) continue;
    const std::string action = file.substr(at, 4);
    if (IsNtuActionOfTwo(ParseInteger(action.substr(1)).value_or(0)))
      of_two.insert(action);
    else if (clip->people.value.value_or(0) > 1)
      of_one.insert(action);
  }
  std::string bodies;
  for (const std::string& action : of_two) bodies += (bodies.empty() ? "" : ", ") + action + ": 2";
  if (!bodies.empty()) writer.Value("bodies", "{" + bodies + "}", "known of the set: actions of two people");
  if (of_one.empty()) return;
  writer.Comment("Files of " + JoinTexts({of_one.begin(), of_one.end()}) +
                 " hold several bodies, but the actions have one person: the others are false tracks or bystanders, "
                 "which `people` excludes. `bodies: {" +
                 *of_one.begin() + ": 2}` reads two people.");
}

void Rename(NamePatternEstimate& guessed, std::string& text, const std::string& from, const std::string& to) {
  for (std::string* pattern : {&guessed.pattern, &text}) {
    const std::size_t at = pattern->find("{" + from + "}");
    if (at != std::string::npos) pattern->replace(at + 1, from.size(), to);
  }
  std::replace(guessed.fields.begin(), guessed.fields.end(), from, to);
}

/// A skeleton file is a person's: the field that names it is {person}, and words after it are the action.
void NamePerson(NamePatternEstimate& guessed, std::string& skeletons) {
  const std::vector<std::string> fields = FieldsOf(skeletons);
  if (fields.size() != 1 || guessed.Has("person")) return;
  const bool was_action = fields[0] == "action";
  Rename(guessed, skeletons, fields[0], "person");
  if (was_action && guessed.Has("style")) Rename(guessed, skeletons, "style", "action");
}

/// A file of another kind that would be taken for a clip of the pattern; empty: none.
std::string OtherTaken(const NamePatternEstimate& guessed, const std::vector<std::string>& names,
                       const std::vector<std::string>& others, const std::filesystem::path& folder) {
  const Expected<NamePattern> pattern = NamePattern::Parse(guessed.pattern, "files");
  for (const std::string& name : others) {
    if (pattern && pattern->Match(name) && std::find(names.begin(), names.end(), name) == names.end()) return name;
  }
  const std::filesystem::path beside = (folder / names.front()).parent_path();
  for (const std::filesystem::path& entry : EntriesOf(beside)) {
    const std::string name = DisplayPath(entry.lexically_relative(folder));
    if (pattern && pattern->Match(name) && std::find(names.begin(), names.end(), name) == names.end()) return name;
  }
  return "";
}

namespace fs = std::filesystem;

constexpr std::uintmax_t kLargestCalibration = 1 << 20;

/// The skeleton's name below the root: beside the motion, else in the nearest folder above; nothing where it is higher.
std::optional<std::string> SkeletonBelow(const fs::path& root, const std::string& motion, const std::string& skeleton) {
  for (std::string folder = FolderOf(motion);; folder = FolderOf(folder)) {
    std::error_code unknown;
    if (fs::is_regular_file(root / folder / skeleton, unknown)) {
      return folder.empty() ? skeleton : folder + "/" + skeleton;
    }
    if (folder.empty()) return std::nullopt;
  }
}

SourceRoot Above(const fs::path& folder) {
  std::error_code unknown;
  const fs::path whole = fs::absolute(folder, unknown).lexically_normal();
  const fs::path plain = whole.filename().empty() ? whole.parent_path() : whole;
  return {plain.parent_path(), DisplayPath(plain.filename()) + "/"};
}

/// ingest.source.skeleton_files, from where the skeletons lie below `root`: fields of `guessed` (whose names have no
/// prefix) if they give each, else the one file that all share. Nothing where neither does.
std::optional<std::string> EstimateSkeletonFiles(const ClipConsensus& source, const SourceRoot& root,
                                                 const NamePatternEstimate& guessed) {
  const std::vector<std::string> skeletons = source.Facts("skeleton_file");
  std::vector<std::string> motions, below;
  std::set<std::string> places;
  bool beside = true, top = true;
  for (std::size_t i = 0; i < skeletons.size(); ++i) {
    const std::string motion = source.clips()[i]->file;
    motions.push_back(motion);
    const auto place = skeletons[i].empty() ? std::optional<std::string>()
                                            : SkeletonBelow(root.folder, root.prefix + motion, skeletons[i]);
    if (!place) continue;
    places.insert(*place);
    beside = beside && FolderOf(*place) == FolderOf(root.prefix + motion);
    top = top && FolderOf(*place).empty();
  }
  if (places.empty()) return std::nullopt;
  const std::optional<std::string> by_fields = EstimateCompanionPattern(guessed, motions, skeletons);
  if (by_fields && top) return by_fields;
  const std::string folder = FolderOf(root.prefix + guessed.pattern);
  if (by_fields && beside) return folder + "/" + *by_fields;
  if (places.size() == 1) return *places.begin();
  return std::nullopt;
}

}  // namespace

void WriteNames(const ClipConsensus& source, const std::string& format, const std::filesystem::path& asked,
                const SourceRoot& root, DeclarationWriter& writer) {
  std::vector<std::string> names;
  for (const InspectedClip* clip : source.clips()) {
    const std::string file = clip->file;
    if (std::find(names.begin(), names.end(), file) == names.end()) names.push_back(file);
  }
  if (format == "humanact12_pickle" || format == "uestc") {
    const bool uestc = format == "uestc";
    writer.Value("container", YamlQuoted(names.front()), "declared by the file: all clips are in it");
    writer.Value("files",
                 YamlQuoted(uestc ? "a{action}_d{view}_p{person:3}_c{side}_color.avi" : "c{clip:4}_y{action:2}"),
                 "declared by the format");
    writer.Value("person", YamlQuoted(uestc ? "p{person}" : "unknown"),
                 uestc ? "" : "unknown: the file does not declare it");
    writer.Value("label", YamlQuoted(uestc ? "" : "{action}"), "declared by the format");
    return;
  }
  if (format == "ntu_skeleton") return WriteNtuNames(source, writer);
  NamePatternEstimate guessed = EstimateNamePattern(names);
  std::error_code unknown;
  const bool folder = std::filesystem::is_directory(asked, unknown);
  const std::filesystem::path below = folder ? asked : asked.parent_path();
  const std::string taken = folder ? OtherTaken(guessed, names, source.other_files(), below) : std::string();
  const bool narrow = names.size() == 1 && !taken.empty();
  std::optional<std::string> skeletons;
  if (format == "asf_amc") {
    skeletons = EstimateSkeletonFiles(source, root, guessed);
    if (skeletons) NamePerson(guessed, *skeletons);
  }
  if (narrow && skeletons) {
    const Expected<NamePattern> pattern = NamePattern::Parse(guessed.pattern, "files");
    const std::optional<NameFields> fields = pattern ? pattern->Match(names.front()) : std::nullopt;
    if (fields) skeletons = FillFields(*skeletons, *fields);
  }
  if (narrow) guessed = NamePatternEstimate{names.front(), {}, false};
  if (!narrow && !taken.empty())
    writer.Comment("`files` also matches files of another source, e.g. " + taken +
                   ": narrow the pattern, or move those files away.");
  writer.Value("files", YamlQuoted(root.prefix + guessed.pattern),
               narrow ? "the name of one file: a pattern would also match files of another source, e.g. " + taken
               : guessed.common ? "guessed from " + std::to_string(names.size()) + " names: check the fields"
                                : "the names have no common pattern");
  if (skeletons) {
    writer.Value("skeleton_files", YamlQuoted(*skeletons), "found beside the motions");
  } else if (format == "asf_amc") {
    writer.Unknown("skeleton_files", "no .asf beside the motions begins like the name of a motion");
  }
  const bool person = guessed.Has("person");
  writer.Value("person", YamlQuoted(person ? "{person}" : "unknown"),
               !person     ? "unknown: use the field that names the performer, where the file names have one"
               : skeletons ? "guessed: the person of the skeleton file"
                           : "guessed from the names");
  const bool action = guessed.Has("action");
  writer.Value(
      "label", YamlQuoted(action ? "{action}" : ""),
      action ? "guessed from the names; `labels: {a01: wave}` renames" : "unknown: the names do not declare it");
  if (format != "depth_sequence") return;
  const Expected<std::string> depth_files = EstimateDepthFiles(below, names, guessed.pattern);
  if (!depth_files)
    writer.Unknown("depth_files", depth_files.error().what);
  else
    writer.Value("depth_files", YamlQuoted(root.prefix + *depth_files), "guessed from the names of the images");
}

SourceRoot RootOfSkeletons(const ClipConsensus& source, const fs::path& folder) {
  const std::vector<std::string> skeletons = source.Facts("skeleton_file");
  const SourceRoot above = Above(folder);
  bool higher = false;
  for (std::size_t i = 0; i < skeletons.size(); ++i) {
    const std::string motion = source.clips()[i]->file;
    if (skeletons[i].empty() || SkeletonBelow(folder, motion, skeletons[i])) continue;
    higher = higher || SkeletonBelow(above.folder, above.prefix + motion, skeletons[i]).has_value();
  }
  return higher ? above : SourceRoot{folder, ""};
}

SourceRoot RootOfCameras(const fs::path& folder, Inspection& inspection) {
  if (!inspection.cameras.empty()) return {folder, ""};
  const SourceRoot above = Above(folder);
  const std::set<std::string> endings = {".toml", ".json", ".xml", ".yml", ".yaml", ".txt"};
  std::set<std::pair<std::string, std::string>> known_cameras;
  for (const fs::path& file : EntriesOf(above.folder)) {
    std::error_code unknown;
    const bool small = fs::is_regular_file(file, unknown) && fs::file_size(file, unknown) <= kLargestCalibration;
    if (!small || endings.count(file.extension().string()) == 0) continue;
    const Inspection found = InspectPath(file, std::nullopt);
    // A file of a rig shows the cameras of the file beside it too.
    for (const InspectedCamera& camera : found.cameras) {
      if (known_cameras.emplace(camera.format, camera.id).second) inspection.cameras.push_back(camera);
    }
  }
  return inspection.cameras.empty() ? SourceRoot{folder, ""} : above;
}

}  // namespace mocurate
