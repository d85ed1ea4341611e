#include "ingest/inspect/declared_names.h"

#include <algorithm>
#include <optional>
#include <set>

#include "core/base/file.h"
#include "core/base/text.h"
#include "ingest/folder_listing.h"
#include "ingest/inspect/file_names.h"
#include "ingest/sources/pattern.h"

namespace mocurate {
namespace {

/// Of NTU RGB+D, 1 to 120.
bool IsNtuActionOfTwo(long long action) { return (action >= 50 && action <= 60) || (action >= 106 && action <= 120); }

std::string Joined(const std::set<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

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
  writer.Comment("Files of " + Joined(of_one) +
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

}  // namespace mocurate
