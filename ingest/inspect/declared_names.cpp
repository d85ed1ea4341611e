#include "ingest/inspect/declaration_writer.h"

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

/// A file of another kind that would be taken for a clip of the pattern; empty: none.
std::string OtherTaken(const NamePatternEstimate& estimate, const std::vector<std::string>& names,
                       std::vector<std::string> others, const std::filesystem::path& folder) {
  const Expected<NamePattern> pattern = NamePattern::Parse(estimate.pattern, "files");
  for (const std::filesystem::path& entry : EntriesOf((folder / names.front()).parent_path()))
    others.push_back(DisplayPath(entry.lexically_relative(folder)));
  const std::set<std::string> own(names.begin(), names.end());
  const auto taken = std::find_if(others.begin(), others.end(), [&](const std::string& name) {
    return pattern && own.count(name) == 0 && pattern->Match(name);
  });
  return taken == others.end() ? "" : *taken;
}

/// The values of each field of the names: one that has as many as there are clips would make each clip a class.
void WriteValues(const NamePatternEstimate& estimate, const std::vector<std::string>& names,
                 DeclarationWriter& writer) {
  constexpr std::size_t kMostValues = 8;
  const Expected<NamePattern> pattern = NamePattern::Parse(estimate.pattern, "files");
  for (const std::string& field : estimate.fields) {
    std::set<std::string> values;
    for (const std::string& name : names) {
      const std::optional<NameFields> fields = pattern ? pattern->Match(name) : std::nullopt;
      if (fields && fields->count(field) != 0) values.insert(fields->at(field));
    }
    if (values.empty()) continue;
    std::string list;
    std::size_t listed = 0;
    for (const std::string& value : values) {
      if (++listed > kMostValues) break;
      list += (listed > 1 ? ", " : "") + value;
    }
    const bool each = names.size() > 1 && values.size() == names.size();
    const char* note = each ? "; one for each clip: as `label` each clip would be a class" : "";
    writer.Comment("{" + field + "}: " + Counted(values.size(), "value") + ": " + list +
                   (values.size() > kMostValues ? ", ..." : "") + note);
  }
}

}  // namespace

void WritePersonAndLabel(bool several, DeclarationWriter& writer) {
  const std::string fields = "fields of `files`";
  writer.Name("person", several ? "p{body}" : kUnknownPerson,
              fields + " that name the performer, or a fixed name, by which all clips are one person's" +
                  std::string(several ? "; {body} tells several people of a recording apart, as in 'p{body}'" : ""));
  writer.Name("label", "", fields + " that name the action, or \"\" for none; `labels: {a01: wave}` renames");
}

/// A pattern of files that lie at different depths, whose names have no folders in common.
NamePatternEstimate AtAnyDepth(const std::vector<std::string>& names) {
  std::vector<std::string> own;
  int deepest = 0;
  for (const std::string& name : names) {
    own.push_back(name.substr(FolderOf(name).empty() ? 0 : FolderOf(name).size() + 1));
    deepest = std::max(deepest, DepthOf(name));
  }
  NamePatternEstimate estimate = EstimateNamePattern(own);
  for (int level = deepest; level > 0; --level)
    estimate.pattern = "{folder" + std::to_string(level) + "?/}" + estimate.pattern;
  return estimate;
}

NamePatternEstimate WriteFiles(const Proposal& proposal, DeclarationWriter& writer) {
  const std::vector<std::string> names = proposal.source.files();
  NamePatternEstimate estimate = EstimateNamePattern(names);
  if (std::any_of(names.begin(), names.end(),
                  [&](const std::string& name) { return DepthOf(name) != DepthOf(names[0]); }))
    estimate = AtAnyDepth(names);
  const bool folder = proposal.asked == proposal.folder;
  const std::string taken =
      folder ? OtherTaken(estimate, names, proposal.source.other_files(), proposal.folder) : std::string();
  const bool narrow = names.size() == 1 && !taken.empty();
  if (narrow) estimate = NamePatternEstimate{names.front(), {}, false};
  if (!narrow && !taken.empty())
    writer.Comment("`files` also matches files of another source, e.g. " + taken +
                   ": narrow the pattern, or move those files away.");
  const Expected<NamePattern> pattern = NamePattern::Parse(estimate.pattern, "files");
  const auto left = std::find_if(names.begin(), names.end(),
                                 [&](const std::string& name) { return !pattern || !pattern->Match(name); });
  if (left != names.end()) {
    writer.Unknown("files", "the names have no pattern in common, as '" + names.front() + "' and '" + *left +
                                "': write one for a part of them, e.g. '" + estimate.pattern +
                                "', or put them into folders of one depth");
    return estimate;
  }
  writer.Value("files", YamlQuoted(estimate.pattern),
               narrow ? "the name of one file: a pattern would also match files of another source, e.g. " + taken
               : names.size() == 1 ? "the name of the one file"
               : estimate.common   ? "what " + std::to_string(names.size()) + " names have in common"
                                   : "the names have no common pattern");
  WriteValues(estimate, names, writer);
  return estimate;
}

void WriteContainer(const Proposal& proposal, const char* files, DeclarationWriter& writer) {
  writer.Value("container", YamlQuoted(proposal.source.files().front()), "declared by the file: all clips are in it");
  writer.Value("files", YamlQuoted(files), "declared by the format");
}

}  // namespace mocurate
