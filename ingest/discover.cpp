#include "ingest/discover.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "core/base/file.h"
#include "core/base/text.h"
#include "ingest/capture_views.h"
#include "ingest/folder_listing.h"
#include "ingest/known_issues.h"
#include "ingest/sources/babel_segments.h"
#include "ingest/sources/container.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

int DepthOf(const std::string& name) { return static_cast<int>(std::count(name.begin(), name.end(), '/')); }

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
  const bool by_rule = matches && source.other_labels == OtherLabels::kLeaveOut;
  const bool failed =
      !by_rule && (source.other_files == OtherFiles::kError || (matches && source.other_files != OtherFiles::kIgnore));
  Finding finding;
  finding.clip = name;
  finding.code = by_rule ? "label_left_out" : matches ? "label_unknown" : "name_mismatch";
  finding.severity = failed ? Severity::kError : by_rule ? Severity::kInfo : Severity::kWarning;
  finding.message = why.what + (why.hint.empty() || by_rule ? "" : " (" + why.hint + ")");
  finding.action = "left out";
  ItemResult file;
  file.item = name;
  file.outcome.kind = failed ? OutcomeKind::kRefused : OutcomeKind::kLeftOut;
  const std::string hint = by_rule ? "as ingest.source.other_labels asks" : why.hint;
  file.outcome.error = Error{ErrorCode::kInconsistent, why.what, name, hint};
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

ItemResult Refused(const std::string& item, const char* code, const Error& why) {
  Finding finding;
  finding.clip = item;
  finding.code = code;
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

/// Files of a folder that lie where the pattern does not look: one line for all.
ItemResult NotLookedAt(const std::string& folder, std::size_t files, const SourceOptions& source) {
  const bool failed = source.other_files == OtherFiles::kError;
  const std::string count =
      files > kMostCounted ? "more than " + std::to_string(kMostCounted) + " files" : Counted(files, "file");
  Finding finding;
  finding.clip = folder;
  finding.code = kFolderNotRead;
  finding.severity = failed ? Severity::kError : Severity::kWarning;
  finding.value = static_cast<double>(files);
  finding.message = "not looked at: " + count + "; the pattern '" + source.files + "' names files in another place";
  finding.action = "left out";
  ItemResult result;
  result.item = folder;
  result.outcome.kind = failed ? OutcomeKind::kRefused : OutcomeKind::kLeftOut;
  result.outcome.error = Error{ErrorCode::kInconsistent, finding.message, folder,
                               "links to folders are not followed; mend ingest.source.files, or set other_files"};
  result.outcome.findings.push_back(std::move(finding));
  return result;
}

/// Why there is nothing to ingest.
Error NothingFound(const IngestOptions& options, const Discovery& discovery) {
  const std::string where = DisplayPath(options.path);
  const std::string none = "no file matches the pattern '" + options.source.files + "'";
  const auto failed = std::find_if(discovery.left_out.begin(), discovery.left_out.end(), [](const ItemResult& file) {
    return file.outcome.kind == OutcomeKind::kRefused && file.outcome.error.code != ErrorCode::kInconsistent;
  });
  if (failed != discovery.left_out.end()) {
    return {ErrorCode::kNotFound, "no file can be read; the first: " + failed->outcome.error.Message(), where, ""};
  }
  if (discovery.left_out.empty()) return {ErrorCode::kNotFound, none, where, "is it the right folder?"};
  return {ErrorCode::kNotFound, none, where,
          "e.g. '" + discovery.left_out.front().item + "' does not match; mend ingest.source.files or ingest.path"};
}

/// ingest.source.label_table: motion -> label text. Error kMalformed "name:line".
Expected<std::map<std::string, std::string>> ReadLabelTable(const IngestOptions& options) {
  std::map<std::string, std::string> table;
  const std::string& name = options.source.label_table;
  if (name.empty()) return table;
  const Expected<std::string> bytes = ReadFile(options.path / name);
  if (!bytes) {
    return Fail(bytes.error().code, "the table of labels cannot be read: " + bytes.error().what, name,
                "put it there, or mend ingest.source.label_table");
  }
  const std::vector<std::string_view> lines = SplitText(*bytes, '\n');
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string_view> cells = SplitText(Trim(lines[i]), ',');
    if (cells.size() == 1 && cells[0].empty()) continue;
    const std::string where = name + ":" + std::to_string(i + 1);
    if (cells.size() != 2) {
      return Fail(ErrorCode::kMalformed, "a line has " + std::to_string(cells.size()) + " cells", where,
                  "each is 'motion,label'");
    }
    if (!table.emplace(Trim(cells[0]), Trim(cells[1])).second) {
      return Fail(ErrorCode::kMalformed, "the motion '" + std::string(cells[0]) + "' stands twice", where,
                  "a motion has one label");
    }
  }
  return table;
}

/// The file's name without folders and ending.
std::string StemOf(const std::string& name) { return std::filesystem::path(name).stem().string(); }

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

/// Items that several files or entries would give under one name. Error kConfig.
Status SortItems(Discovery& discovery) {
  const auto by_item = [](const ItemSpec& a, const ItemSpec& b) { return a.item < b.item; };
  std::sort(discovery.items.begin(), discovery.items.end(), by_item);
  std::sort(discovery.truth.begin(), discovery.truth.end(), by_item);
  for (std::size_t i = 1; i < discovery.items.size(); ++i) {
    const ItemSpec& a = discovery.items[i - 1];
    const ItemSpec& b = discovery.items[i];
    if (b.item != a.item) continue;
    const auto name = [](const ItemSpec& item) { return item.options.value("entry_name", item.inputs[0].name); };
    return Fail(ErrorCode::kConfig, "'" + name(a) + "' and '" + name(b) + "' are both '" + b.item + "'",
                "ingest.source.recording", "take more fields of the name into `recording`");
  }
  return {};
}

/// The clips of a file that holds them all: one item each, which says its place in the file.
Expected<Discovery> DiscoverContainer(const IngestOptions& options) {
  const SourceOptions& source = options.source;
  const std::filesystem::path path = options.path / source.container;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    return Fail(ErrorCode::kNotFound, "the file that holds all clips is not there", DisplayPath(path),
                "set ingest.path (--set ingest.path=DIR), or mend ingest.source.container");
  }
  const Expected<std::vector<ContainerEntry>> entries = EntriesOf(source, options.path);
  if (!entries) return Forward(entries);
  Discovery discovery;
  const nlohmann::json stage_options = OptionsToJson(source);
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const ContainerEntry& entry = (*entries)[i];
    const Expected<NamedFile> named = ReadName(source, entry.name);
    if (!named && named.error().code == ErrorCode::kConfig) return Forward(named);
    if (!named) {
      discovery.left_out.push_back(LeftOut(entry.name, source, true, named.error()));
      continue;
    }
    if (!entry.left_out.empty()) {
      discovery.left_out.push_back(
          Excluded(named->item(), entry.name, "excluded", entry.left_out, "as the set's papers do"));
      continue;
    }
    ItemSpec item{named->item(), stage_options, {{"source", source.container, path, ""}}};
    item.options["entry"] = i;
    item.options["entry_name"] = entry.name;
    if (entry.frames > 0) item.options["most_frames"] = entry.frames;
    if (!entry.label.empty()) {
      const Expected<std::string> label = LabelOf(source, entry.label, entry.name);
      if (!label) {
        discovery.left_out.push_back(LeftOut(entry.name, source, true, label.error()));
        continue;
      }
      item.options["told_label"] = *label;
    }
    discovery.items.push_back(std::move(item));
  }
  if (discovery.items.empty()) {
    return Fail(ErrorCode::kNotFound, "no clip of the file matches the pattern '" + source.files + "'",
                DisplayPath(path), "mend ingest.source.files");
  }
  if (Status sorted = SortItems(discovery); !sorted) return Forward(sorted);
  return discovery;
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
  if (!source.container.empty()) return DiscoverContainer(options);
  const Expected<std::map<std::string, std::string>> table = ReadLabelTable(options);
  if (!table) return Forward(table);
  const Expected<NamePattern> depth_pattern = NamePattern::Parse(source.depth_files, "ingest.source.depth_files");
  if (!depth_pattern) return Forward(depth_pattern);
  const Expected<NamePattern> skeleton_pattern =
      NamePattern::Parse(source.skeleton_files, "ingest.source.skeleton_files");
  if (!skeleton_pattern) return Forward(skeleton_pattern);
  const int depth = std::max({pattern->depth(), depth_pattern->depth(), skeleton_pattern->depth()});
  const Expected<Listing> listing = ListFiles(options.path, depth);
  if (!listing) return Forward(listing);
  const std::vector<FolderFile>& files = listing->files;
  std::map<std::string, std::size_t> elsewhere = listing->folders_below;

  const Expected<KnownIssues> known_issues = KnownIssues::Load(source.known_issue_lists);
  if (!known_issues) return Forward(known_issues);
  Expected<BabelIndex> babel = BabelIndex::Read(options.path, source.annotations);
  if (!babel) return Forward(babel);

  Discovery discovery;
  const bool has_truth = source.format == SourceFormat::kDepthSequence;
  const bool has_depth = has_truth || (source.views.together && !source.depth_files.empty());
  std::optional<DepthFiles> depth_files;
  if (has_depth) depth_files.emplace(files, *depth_pattern, *pattern);
  const nlohmann::json stage_options = OptionsToJson(source);
  for (const FolderFile& file : files) {
    if (only && only->count(file.name) == 0) continue;
    if (has_depth && depth_pattern->Match(file.name)) continue;
    if (!source.skeleton_files.empty() && skeleton_pattern->Match(file.name)) continue;
    if (std::count(source.annotations.begin(), source.annotations.end(), file.name) > 0) continue;
    if (file.name == source.label_table) continue;
    const bool matches = pattern->Match(file.name).has_value();
    if (!matches && source.other_files == OtherFiles::kIgnore) continue;
    if (!matches && DepthOf(file.name) != pattern->depth()) {
      ++elsewhere[DepthOf(file.name) == 0 ? "." : file.name.substr(0, file.name.rfind('/'))];
      continue;
    }
    const Expected<NamedFile> named = ReadName(source, file.name);
    if (!named && named.error().code == ErrorCode::kConfig) return Forward(named);
    if (!named) {
      discovery.left_out.push_back(LeftOut(file.name, source, matches, named.error()));
      continue;
    }
    const std::string recording = source.views.together ? StemOf(file.name) : named->identity.recording;
    const auto excluded = source.exclude.find(recording);
    if (excluded != source.exclude.end()) {
      discovery.left_out.push_back(
          Excluded(named->item(), file.name, "excluded", excluded->second, "ingest.source.exclude names it"));
      continue;
    }
    const std::optional<KnownIssue> issue = known_issues->Find(recording);
    if (issue && source.known_issues == KnownIssueAction::kDrop) {
      discovery.left_out.push_back(Excluded(named->item(), file.name, "known_issue", TextOf(*issue),
                                            "ingest.source.known_issues: report keeps such clips"));
      continue;
    }
    if (!file.problem.empty()) {
      const Error why{ErrorCode::kUnreadable, file.problem, file.name, "mend or remove it"};
      discovery.left_out.push_back(Refused(named->item(), "unreadable_file", why));
      continue;
    }
    ItemSpec item{named->item(), stage_options, {{"source", file.name, file.path, ""}}};
    if (!source.label_table.empty()) {
      const auto row = table->find(StemOf(file.name));
      const Expected<std::string> label =
          row != table->end() ? LabelOf(source, row->second, file.name)
                              : Fail(ErrorCode::kInconsistent, "'" + source.label_table + "' does not name it",
                                     file.name, "add a line, or take the file out");
      if (!label) {
        discovery.left_out.push_back(LeftOut(file.name, source, true, label.error()));
        continue;
      }
      item.options["told_label"] = *label;
    }
    if (!source.skeleton_files.empty()) {
      if (Status added = AddSkeletonFile(files, FillFields(source.skeleton_files, named->fields), item); !added) {
        discovery.left_out.push_back(Refused(item.item, "skeleton_file_missing", added.error()));
        continue;
      }
    }
    if (issue && source.known_issues == KnownIssueAction::kReport) item.options["known_issue"] = TextOf(*issue);
    if (const BabelSequence* sequence = babel->Find(file.name)) item.options["annotation"] = EncodeBabel({*sequence});
    if (has_truth) discovery.truth.push_back(item);
    if (depth_files) depth_files->AddTo(named->fields, item);
    for (int body = 1; body <= named->bodies; ++body) {
      const Expected<NamedFile> own = ReadName(source, file.name, body);
      discovery.persons.insert(own ? own->identity.person : named->identity.person);
      if (!named->style.empty()) discovery.styles.insert(named->style);
      discovery.items.push_back(body == 1 && named->bodies == 1 ? item : OfBody(item, source, file.name, body));
    }
  }
  if (!only && source.other_files != OtherFiles::kIgnore) {
    for (const auto& [folder, count] : elsewhere) {
      if (count > 0) discovery.left_out.push_back(NotLookedAt(folder, count, source));
    }
  }
  if (discovery.items.empty()) return tl::unexpected<Error>(NothingFound(options, discovery));
  if (!babel->Unused().empty()) discovery.left_out.push_back(WithoutMotion(*babel, source.annotations));
  if (source.views.together) {
    if (Status together = BringTogether(source, discovery.items); !together) return Forward(together);
  }
  if (Status sorted = SortItems(discovery); !sorted) return Forward(sorted);
  return discovery;
}

}  // namespace mocurate
