#include "ingest/discover.h"

#include <algorithm>
#include <tuple>

#include "core/base/file.h"
#include "core/base/text.h"
#include "ingest/known_issues.h"
#include "ingest/sources/babel_segments.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

struct FolderFile {
  std::string name;  ///< below the folder, with '/', printable
  std::filesystem::path path;
};

/// Files down to `depth` folders below `folder`, sorted by name.
Expected<std::vector<FolderFile>> ListFiles(const std::filesystem::path& folder, int depth) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (folder.empty() || !fs::exists(folder, error)) {
    return Fail(ErrorCode::kNotFound, folder.empty() ? "no folder with captures is given" : "the folder does not exist",
                folder.empty() ? "ingest.path" : DisplayPath(folder), "set ingest.path (--set ingest.path=DIR)");
  }
  if (!fs::is_directory(folder, error)) {
    return Fail(ErrorCode::kUnreadable, "is no folder", DisplayPath(folder),
                "ingest.path names the folder of the files");
  }
  std::vector<FolderFile> files;
  fs::recursive_directory_iterator at(folder, error);
  if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(folder), "check its permissions");
  for (const fs::recursive_directory_iterator end; at != end;) {
    std::error_code unknown;
    if (at->is_directory(unknown) && at.depth() >= depth) at.disable_recursion_pending();
    if (at->is_regular_file(unknown)) {
      files.push_back({DisplayPath(at->path().lexically_relative(folder)), at->path()});
    }
    at.increment(error);
    if (error) return Fail(ErrorCode::kUnreadable, error.message(), DisplayPath(folder), "check its permissions");
  }
  std::sort(files.begin(), files.end(), [](const FolderFile& a, const FolderFile& b) {
    return a.name != b.name ? a.name < b.name : a.path.native() < b.path.native();
  });
  return files;
}

int DepthOf(const std::string& name) { return static_cast<int>(std::count(name.begin(), name.end(), '/')); }

/// Adds the depth images of one sequence: those whose fields agree with the fields of the sequence's own name.
void AddDepthFiles(const std::vector<FolderFile>& files, const NamePattern& pattern, const NamedFile& named,
                   ItemSpec& item) {
  for (const FolderFile& file : files) {
    const std::optional<NameFields> fields = pattern.Match(file.name);
    if (!fields) continue;
    const bool same = std::all_of(fields->begin(), fields->end(), [&](const auto& field) {
      const auto own = named.fields.find(field.first);
      return own == named.fields.end() || own->second == field.second;
    });
    if (same) item.inputs.push_back({"depth", file.name, file.path, ""});
  }
}

/// Every {field} that names a clip must be one of the pattern: a misspelt one would put all people under one name. The
/// texts that a declaration has without being told may go empty.
Status CheckFields(const SourceOptions& source, const NamePattern& pattern) {
  const SourceOptions untold;
  std::vector<std::string> known = pattern.FieldNames();
  known.insert(known.end(), {"file", "body"});
  const std::tuple<const char*, const std::string*, const std::string*> texts[] = {
      {"person", &source.person, &untold.person}, {"recording", &source.recording, &untold.recording},
      {"label", &source.label, &untold.label},    {"session", &source.session, &untold.session},
      {"view", &source.view, &untold.view},       {"style", &source.style, &untold.style}};
  for (const auto& [option, text, by_default] : texts) {
    if (*text == *by_default) continue;
    for (const std::string& field : FieldsOf(*text)) {
      if (std::find(known.begin(), known.end(), field) != known.end()) continue;
      const std::optional<std::string> near = Nearest(field, known);
      std::string list;
      for (const std::string& name : known) list += (list.empty() ? "{" : ", {") + name + "}";
      return Fail(ErrorCode::kConfig,
                  "'" + *text + "' names the field {" + field + "}, which '" + pattern.text() + "' does not have",
                  std::string("ingest.source.") + option,
                  near ? "did you mean {" + *near + "}?" : "its fields are " + list);
    }
  }
  return {};
}

/// `matches`: the name is as declared, but its label is not.
ItemResult LeftOut(const std::string& name, const SourceOptions& source, bool matches, const Error& why) {
  const bool failed =
      source.other_files == OtherFiles::kError || (matches && source.other_files != OtherFiles::kIgnore);
  Finding finding;
  finding.clip = name;
  finding.code = matches ? "label_unknown" : "name_mismatch";
  finding.severity = failed ? Severity::kError : Severity::kWarning;
  finding.message = why.what + (why.hint.empty() ? "" : " (" + why.hint + ")");
  finding.action = "left out";
  ItemResult file;
  file.item = name;
  file.outcome.kind = failed ? OutcomeKind::kRefused : OutcomeKind::kLeftOut;
  file.outcome.error = Error{ErrorCode::kInconsistent, why.what, name, why.hint};
  file.outcome.findings.push_back(std::move(finding));
  return file;
}

/// What the declaration excludes by the recording's name, or a list of known issues does.
ItemResult Excluded(const std::string& item, const std::string& file, const char* code, const std::string& why,
                    const std::string& hint) {
  Finding finding;
  finding.clip = item;
  finding.code = code;
  finding.severity = Severity::kInfo;
  finding.message = why;
  finding.action = "left out";
  ItemResult result;
  result.item = item;
  result.outcome.kind = OutcomeKind::kLeftOut;
  result.outcome.error = Error{ErrorCode::kInconsistent, why, file, hint};
  result.outcome.findings.push_back(std::move(finding));
  return result;
}

std::string TextOf(const KnownIssue& issue) { return issue.kind + ": " + issue.note + " (" + issue.source + ")"; }

/// The .asf of a motion.
Status AddSkeletonFile(const std::vector<FolderFile>& files, const std::string& name, ItemSpec& item) {
  for (const FolderFile& file : files) {
    if (file.name != name) continue;
    item.inputs.push_back({"skeleton_file", file.name, file.path, ""});
    return {};
  }
  return Fail(ErrorCode::kNotFound, "its skeleton file '" + name + "' is not in the folder", item.inputs[0].name,
              "put it there, or mend ingest.source.skeleton_files");
}

ItemResult Refused(const std::string& item, const Error& why) {
  Finding finding;
  finding.clip = item;
  finding.code = "skeleton_file_missing";
  finding.severity = Severity::kError;
  finding.message = why.what;
  finding.action = "left out";
  ItemResult result;
  result.item = item;
  result.outcome.kind = OutcomeKind::kRefused;
  result.outcome.error = why;
  result.outcome.findings.push_back(std::move(finding));
  return result;
}

/// Annotations that speak of motions that are not there: one line for all.
ItemResult WithoutMotion(const BabelIndex& babel, const std::vector<std::string>& files) {
  const std::vector<std::string> unused = babel.Unused();
  Finding finding;
  finding.clip = files.front();
  finding.code = "motion_missing";
  finding.value = static_cast<double>(unused.size());
  finding.message = std::to_string(unused.size()) + " of " + std::to_string(babel.size()) +
                    " annotated motions are not in the folder, e.g. '" + unused.front() + "'";
  finding.action = "left out";
  ItemResult result;
  result.item = files.front();
  result.outcome.kind = OutcomeKind::kLeftOut;
  result.outcome.error = Error{ErrorCode::kNotFound, finding.message, files.front(),
                               "AMASS comes in parts; names are looked for as ingest/sources/babel_segments.h says"};
  result.outcome.findings.push_back(std::move(finding));
  return result;
}

/// The item of one of several people in a file.
ItemSpec OfBody(ItemSpec item, const SourceOptions& source, const std::string& name, int body) {
  if (const Expected<NamedFile> named = ReadName(source, name, body)) item.item = named->item();
  item.options["body"] = body;
  return item;
}

}  // namespace

Expected<Discovery> Discover(const IngestOptions& options, const std::optional<std::set<std::string>>& only) {
  const SourceOptions& source = options.source;
  if (Status ok = CheckSource(source); !ok) return Forward(ok);
  const Expected<AxisConvention> axes = AxisConvention::Parse(source.axes);
  if (!axes) return Forward(axes);
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  if (!skeleton) return Forward(skeleton);
  const Expected<NamePattern> pattern = NamePattern::Parse(source.files, "ingest.source.files");
  if (!pattern) return Forward(pattern);
  if (Status fields = CheckFields(source, *pattern); !fields) return Forward(fields);
  const Expected<NamePattern> depth_pattern = NamePattern::Parse(source.depth_files, "ingest.source.depth_files");
  if (!depth_pattern) return Forward(depth_pattern);
  const Expected<NamePattern> skeleton_pattern =
      NamePattern::Parse(source.skeleton_files, "ingest.source.skeleton_files");
  if (!skeleton_pattern) return Forward(skeleton_pattern);
  const int depth = std::max({pattern->depth(), depth_pattern->depth(), skeleton_pattern->depth()});
  const Expected<std::vector<FolderFile>> files = ListFiles(options.path, depth);
  if (!files) return Forward(files);

  const Expected<KnownIssues> known_issues = KnownIssues::Load(source.known_issue_lists);
  if (!known_issues) return Forward(known_issues);
  Expected<BabelIndex> babel = BabelIndex::Read(options.path, source.annotations);
  if (!babel) return Forward(babel);

  Discovery discovery;
  const bool has_depth = source.format == SourceFormat::kDepthSequence;
  const nlohmann::json stage_options = OptionsToJson(source);
  for (const FolderFile& file : *files) {
    if (only && only->count(file.name) == 0) continue;
    if (has_depth && depth_pattern->Match(file.name)) continue;
    if (!source.skeleton_files.empty() && skeleton_pattern->Match(file.name)) continue;
    const bool matches = pattern->Match(file.name).has_value();
    if (!matches && (source.other_files == OtherFiles::kIgnore || DepthOf(file.name) != pattern->depth())) continue;
    const Expected<NamedFile> named = ReadName(source, file.name);
    if (!named && named.error().code == ErrorCode::kConfig) return Forward(named);
    if (!named) {
      discovery.left_out.push_back(LeftOut(file.name, source, matches, named.error()));
      continue;
    }
    const auto excluded = source.exclude.find(named->identity.recording);
    if (excluded != source.exclude.end()) {
      discovery.left_out.push_back(
          Excluded(named->item(), file.name, "excluded", excluded->second, "ingest.source.exclude names it"));
      continue;
    }
    const std::optional<KnownIssue> issue = known_issues->Find(named->identity.recording);
    if (issue && source.known_issues == KnownIssueAction::kDrop) {
      discovery.left_out.push_back(Excluded(named->item(), file.name, "known_issue", TextOf(*issue),
                                            "ingest.source.known_issues: report keeps such clips"));
      continue;
    }
    ItemSpec item{named->item(), stage_options, {{"source", file.name, file.path, ""}}};
    if (!source.skeleton_files.empty()) {
      if (Status added = AddSkeletonFile(*files, FillFields(source.skeleton_files, named->fields), item); !added) {
        discovery.left_out.push_back(Refused(item.item, added.error()));
        continue;
      }
    }
    if (issue && source.known_issues == KnownIssueAction::kReport) item.options["known_issue"] = TextOf(*issue);
    if (const BabelSequence* sequence = babel->Find(file.name)) item.options["annotation"] = EncodeBabel({*sequence});
    if (has_depth) {
      discovery.truth.push_back(item);
      AddDepthFiles(*files, *depth_pattern, *named, item);
    }
    for (int body = 1; body <= named->bodies; ++body) {
      discovery.items.push_back(body == 1 && named->bodies == 1 ? item : OfBody(item, source, file.name, body));
    }
  }
  if (discovery.items.empty()) {
    return Fail(ErrorCode::kNotFound, "no file matches the pattern '" + source.files + "'", DisplayPath(options.path),
                discovery.left_out.empty() ? "is it the right folder?"
                                           : "e.g. '" + discovery.left_out.front().item +
                                                 "' does not match; mend ingest.source.files or ingest.path");
  }
  if (!babel->Unused().empty()) discovery.left_out.push_back(WithoutMotion(*babel, source.annotations));
  const auto by_item = [](const ItemSpec& a, const ItemSpec& b) { return a.item < b.item; };
  std::sort(discovery.items.begin(), discovery.items.end(), by_item);
  std::sort(discovery.truth.begin(), discovery.truth.end(), by_item);
  for (std::size_t i = 1; i < discovery.items.size(); ++i) {
    if (discovery.items[i].item != discovery.items[i - 1].item) continue;
    return Fail(ErrorCode::kConfig,
                "'" + discovery.items[i - 1].inputs[0].name + "' and '" + discovery.items[i].inputs[0].name +
                    "' are both '" + discovery.items[i].item + "'",
                "ingest.source.recording", "take more fields of the name into `recording`");
  }
  return discovery;
}

}  // namespace mocurate
