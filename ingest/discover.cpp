#include "ingest/discover.h"

#include <algorithm>
#include <tuple>

#include "core/base/file.h"
#include "core/base/text.h"
#include "ingest/folder_listing.h"
#include "ingest/formats/driver.h"
#include "ingest/grouped_files.h"
#include "ingest/known_issues.h"
#include "ingest/skipped_files.h"
#include "ingest/sources/array_clips.h"
#include "ingest/sources/babel_segments.h"
#include "ingest/sources/source_file.h"

namespace mocurate {
namespace {

/// The clips of a file that holds them all: one item each, which says its place in the file; in the order of the file.
/// Error kNotFound, and of the container.
Expected<Discovery> DiscoverContainer(const IngestOptions& options) {
  const SourceOptions& source = options.source;
  const FormatDriver& driver = DriverOf(source.format);
  const std::filesystem::path path = options.path / source.container;
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(path, unknown)) {
    return Fail(ErrorCode::kNotFound, "the file with all clips does not exist", DisplayPath(path),
                "set ingest.path (--set ingest.path=DIR), or correct ingest.source.container");
  }
  const Expected<std::vector<ContainerEntry>> entries = driver.entries(source, options.path);
  if (!entries) return Forward(entries);
  const Expected<NamePattern> pattern = NamePattern::Parse(source.files, "ingest.source.files");
  if (!pattern) return Forward(pattern);
  Discovery discovery;
  std::set<std::string> recordings;
  const ItemOptions stage_options = OptionsToJson(source);
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const ContainerEntry& entry = (*entries)[i];
    const Expected<NamedFile> named = ReadName(source, entry.name);
    if (!named && named.error().code == ErrorCode::kConfig) return Forward(named);
    const std::optional<Error> ambiguous = AmbiguousName(source, *pattern, entry.name);
    if (!named || ambiguous) {
      discovery.excluded.push_back(ambiguous ? RefusedFile(entry.name, kNameAmbiguous, *ambiguous)
                                             : SkippedFile(entry.name, source, true, named.error()));
      continue;
    }
    recordings.insert(named->identity.recording);
    if (!entry.excluded.empty()) {
      discovery.excluded.push_back(
          ExcludedFile(named->item(), entry.name, "excluded", entry.excluded, "as the set's papers do"));
      continue;
    }
    if (const auto excluded = source.exclude.find(named->identity.recording); excluded != source.exclude.end()) {
      discovery.excluded.push_back(
          ExcludedFile(named->item(), entry.name, "excluded", excluded->second, "ingest.source.exclude names it"));
      continue;
    }
    // Clips of a dataset keep their ids: several may be spans of one recording.
    const std::string name = driver.stored ? entry.name : named->item();
    ItemSpec item{name, stage_options, {{"source", source.container, path, ""}}};
    item.options.Set("entry", i);
    item.options.Set("entry_name", entry.name);
    if (entry.frames > 0) item.options.Set("most_frames", entry.frames);
    if (!entry.label.empty()) {
      const Expected<std::string> label = LabelOf(source, entry.label, entry.name);
      if (!label) {
        discovery.excluded.push_back(SkippedFile(entry.name, source, true, label.error()));
        continue;
      }
      item.options.Set("label_override", *label);
    }
    discovery.persons.insert(named->identity.person);
    discovery.performers.insert(named->performer);
    if (!driver.stored) discovery.styles.insert(named->style);  // a stored clip has its own
    discovery.items.push_back(std::move(item));
  }
  if (discovery.items.empty()) {
    return Fail(ErrorCode::kNotFound, "no clip of the file matches the pattern '" + source.files + "'",
                DisplayPath(path), "correct ingest.source.files");
  }
  NoteUnmatched(source, recordings, discovery.findings);
  return discovery;
}

/// Every {field} that names a clip must be one of the pattern: a misspelt one would put all people under one name. The
/// default texts of a declaration may become empty.
Status CheckFields(const SourceOptions& source, const NamePattern& pattern) {
  const SourceOptions defaults;
  std::vector<std::string> known = pattern.FieldNames();
  known.insert(known.end(), {"file", "body"});
  const std::tuple<const char*, const std::string*, const std::string*> texts[] = {
      {"person", &source.person, &defaults.person},    {"recording", &source.recording, &defaults.recording},
      {"label", &source.label, &defaults.label},       {"fine_label", &source.fine_label, &defaults.fine_label},
      {"session", &source.session, &defaults.session}, {"view", &source.view, &defaults.view},
      {"style", &source.style, &defaults.style}};
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

std::string TextOf(const KnownIssue& issue) { return issue.kind + ": " + issue.note + " (" + issue.source + ")"; }

/// The .asf of a motion.
Status AddSkeletonFile(const std::vector<FolderFile>& files, const std::string& name, ItemSpec& item) {
  for (const FolderFile& file : files) {
    if (file.name != name) continue;
    item.inputs.push_back({"skeleton_file", file.name, file.path, ""});
    return {};
  }
  return Fail(ErrorCode::kNotFound, "its skeleton file '" + name + "' is not in the folder", item.inputs[0].name,
              "put it there, or correct ingest.source.skeleton_files");
}

/// ingest.source.label_table: motion -> label text. A header and lines "motion,label", or, as in CMU's index of its
/// motions, rows "motion<tab>text", where lines without a tab are headings. Error kMalformed "name:line".
Expected<std::map<std::string, std::string>> ReadLabelTable(const IngestOptions& options) {
  std::map<std::string, std::string> table;
  const std::string& name = options.source.label_table;
  if (name.empty()) return table;
  const Expected<std::string> bytes = ReadFile(options.path / name);
  if (!bytes) {
    return Fail(bytes.error().code, "the table of labels cannot be read: " + bytes.error().what, name,
                "put it there, or correct ingest.source.label_table");
  }
  const bool headed = bytes->substr(0, bytes->find('\n')).find(',') != std::string::npos;
  const bool tabbed = !headed && bytes->find('\t') != std::string::npos;
  const std::vector<std::string_view> lines = SplitText(*bytes, '\n');
  for (std::size_t i = tabbed ? 0 : 1; i < lines.size(); ++i) {
    std::vector<std::string_view> cells;
    for (const std::string_view cell : SplitText(Trim(lines[i]), tabbed ? '\t' : ',')) {
      if (!tabbed || !Trim(cell).empty()) cells.push_back(Trim(cell));
    }
    if (tabbed ? cells.size() < 2 : cells.size() == 1 && cells[0].empty()) continue;
    const std::string where = name + ":" + std::to_string(i + 1);
    if (!tabbed && cells.size() != 2) {
      return Fail(ErrorCode::kMalformed, "a line has " + std::to_string(cells.size()) + " cells", where,
                  "each is 'motion,label'");
    }
    if (!table.emplace(cells[0], cells[1]).second) {
      return Fail(ErrorCode::kMalformed, "the motion '" + std::string(cells[0]) + "' occurs twice", where,
                  "a motion has one label");
    }
  }
  return table;
}

/// The file's name without folders and ending.
std::string StemOf(const std::string& name) { return std::filesystem::path(name).stem().string(); }

/// The item of one of several people in a file.
ItemSpec OfBody(ItemSpec item, const SourceOptions& source, const std::string& name, int body) {
  if (const Expected<NamedFile> named = ReadName(source, name, body)) item.item = named->item();
  item.options.Set("body", body);
  return item;
}

std::optional<Error> FirstAmbiguous(const SourceOptions& source, const NamePattern& pattern,
                                    const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (auto ambiguous = AmbiguousName(source, pattern, name)) return ambiguous;
  }
  return std::nullopt;
}

/// Whether a folder lies in one that is named like the recording of a clip: what is there are parts of it.
bool BelongsToClip(const std::string& folder, const std::vector<ItemSpec>& items) {
  std::set<std::string> recordings;
  for (const ItemSpec& item : items) recordings.insert(item.item.substr(item.item.rfind('/') + 1));
  const std::vector<std::string_view> parts = SplitText(folder, '/');
  return std::any_of(parts.begin(), parts.end(),
                     [&](std::string_view part) { return recordings.count(std::string(part)) != 0; });
}

/// The clips of a file of arrays, an item each; the item itself where the file is the clip, or no such file.
std::vector<ItemSpec> OfArrays(const ItemSpec& item, const SourceOptions& source, const FolderFile& file,
                               std::vector<ItemResult>& excluded) {
  if (!DriverOf(source.format).holds_clips) return {item};
  const std::vector<ArrayClip> clips = ArrayClipsOf(file.path, file.name);
  if (clips.empty() || (clips.size() == 1 && clips[0].id.empty())) return {item};
  const Expected<SkeletonPtr> skeleton = SourceSkeleton(source);
  const std::size_t own = skeleton && *skeleton ? (*skeleton)->joints.size() : 0;
  const std::size_t wanted = source.joints.empty() ? own : source.joints.size();
  std::vector<ItemSpec> items;
  for (const ArrayClip& clip : clips) {
    ItemSpec one = item;
    one.item += RecordingSuffix(clip.id);
    one.options.Set("array", clip.id);
    if (!clip.label.empty() && !one.options.contains("label_override")) {
      const Expected<std::string> label = LabelOf(source, clip.label, file.name + clip.id);
      if (!label) {
        excluded.push_back(SkippedFile(file.name + clip.id, source, true, label.error()));
        continue;
      }
      one.options.Set("label_override", *label);
    }
    if (clip.joints == wanted) {
      items.push_back(std::move(one));
      continue;
    }
    excluded.push_back(ExcludedFile(
        one.item, file.name + clip.id, kOtherJoints,
        "it has " + std::to_string(clip.joints) + " joints, those of the source have " + std::to_string(wanted),
        "declare it as a source of its own"));
  }
  return items;
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
                "ingest.source.recording", "use more fields of the name in `recording`");
  }
  return {};
}

/// A path that is one file stands for its folder and that file alone. Nothing for a folder.
std::optional<IngestOptions> FolderOfFile(const IngestOptions& options, int depth, std::set<std::string>& only) {
  std::error_code unknown;
  if (!std::filesystem::is_regular_file(options.path, unknown)) return std::nullopt;
  const std::filesystem::path file = std::filesystem::absolute(options.path, unknown).lexically_normal();
  IngestOptions whole = options;
  whole.path = file.parent_path();
  whole.source = DeclaredOfItems(options);
  if (!options.source.container.empty()) return whole;
  for (int i = 0; i < depth; ++i) whole.path = whole.path.parent_path();
  only = {DisplayPath(file.lexically_relative(whole.path))};
  return whole;
}

}  // namespace

SourceOptions DeclaredOfItems(const IngestOptions& options) {
  SourceOptions source = options.source;
  std::error_code unknown;
  if (!source.container.empty() && std::filesystem::is_regular_file(options.path, unknown))
    source.container = options.path.filename().string();
  return source;
}

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
  std::set<std::string> alone;
  if (const auto whole = FolderOfFile(options, pattern->least_depth(), alone)) {
    return Discover(*whole, alone.empty() ? only : alone);
  }
  if (!source.container.empty()) {
    Expected<Discovery> contained = DiscoverContainer(options);
    if (!contained) return contained;
    if (Status sorted = SortItems(*contained); !sorted) return Forward(sorted);
    return contained;
  }
  const Expected<std::map<std::string, std::string>> table = ReadLabelTable(options);
  if (!table) return Forward(table);
  const Expected<NamePattern> depth_pattern = NamePattern::Parse(source.depth_files, "ingest.source.depth_files");
  if (!depth_pattern) return Forward(depth_pattern);
  const Expected<NamePattern> skeleton_pattern =
      NamePattern::Parse(source.skeleton_files, "ingest.source.skeleton_files");
  if (!skeleton_pattern) return Forward(skeleton_pattern);
  const int depth =
      std::max({pattern->depth(), depth_pattern->depth(), skeleton_pattern->depth(), GroupedFiles::Depth(source)});
  const Expected<FolderListing> listing = ListFiles(options.path, depth);
  if (!listing) return Forward(listing);
  const std::vector<FolderFile>& files = listing->files;
  std::map<std::string, std::size_t> elsewhere = listing->folders_below;

  const Expected<KnownIssues> known_issues = KnownIssues::Load(source.known_issue_lists);
  if (!known_issues) return Forward(known_issues);
  if (Status rules = CheckLabelRules(source); !rules) return Forward(rules);
  Expected<BabelIndex> babel = BabelIndex::Read(options.path, source.annotations);
  if (!babel) return Forward(babel);

  const Expected<GroupedFiles> gathered = GroupedFiles::Of(source, *pattern, files);
  if (!gathered) return Forward(gathered);

  Discovery discovery;
  std::set<std::string> recordings;
  std::vector<std::string> names, passed_over;
  const bool has_truth = DriverOf(source.format).has_truth;
  const bool has_depth = has_truth || (source.views.multi_view && !source.depth_files.empty());
  std::optional<DepthFiles> depth_files;
  if (has_depth) depth_files.emplace(files, *depth_pattern, *pattern);
  const ItemOptions stage_options = OptionsToJson(source);
  for (const FolderFile& file : files) {
    if (only && only->count(file.name) == 0) continue;
    names.push_back(file.name);
    if (has_depth && depth_pattern->Match(file.name)) continue;
    if (gathered->BelongsToOtherClip(file.name)) continue;
    if (!source.skeleton_files.empty() && skeleton_pattern->Match(file.name)) continue;
    if (std::count(source.annotations.begin(), source.annotations.end(), file.name) > 0) continue;
    if (file.name == source.label_table) continue;
    const auto exclude = [&](ItemResult result) {
      if (IsFailure(result.outcome.kind)) AddSourceHash(file.path, result);
      discovery.excluded.push_back(std::move(result));
    };
    const bool matches = pattern->Match(file.name).has_value();
    if (!matches && source.other_files == OtherFiles::kIgnore) {
      if (EndsAsMotion(source, file.name)) passed_over.push_back(file.name);
      continue;
    }
    const int file_depth = DepthOf(file.name);
    if (!matches && (file_depth < pattern->least_depth() || file_depth > pattern->depth())) {
      ++elsewhere[file_depth == 0 ? "." : file.name.substr(0, file.name.rfind('/'))];
      continue;
    }
    const Expected<NamedFile> named = ReadName(source, file.name);
    if (!named && named.error().code == ErrorCode::kConfig) return Forward(named);
    const std::optional<Error> ambiguous = FirstAmbiguous(source, *pattern, gathered->NamesOf(file.name));
    if (!named) {
      recordings.insert(StemOf(file.name));  // excluded anyway
      exclude(ambiguous ? RefusedFile(file.name, kNameAmbiguous, *ambiguous)
                        : SkippedFile(file.name, source, matches, named.error()));
      continue;
    }
    const std::string recording = source.views.multi_view ? StemOf(file.name) : named->identity.recording;
    recordings.insert(recording);
    const auto excluded = source.exclude.find(recording);
    if (excluded != source.exclude.end()) {
      exclude(ExcludedFile(named->item(), file.name, "excluded", excluded->second, "ingest.source.exclude names it"));
      continue;
    }
    const std::optional<KnownIssue> issue = known_issues->Find(recording);
    if (issue && source.known_issues == KnownIssueAction::kDrop) {
      exclude(ExcludedFile(named->item(), file.name, "known_issue", TextOf(*issue),
                           "ingest.source.known_issues: report keeps such clips"));
      continue;
    }
    if (ambiguous) {
      exclude(RefusedFile(file.name, kNameAmbiguous, *ambiguous));
      continue;
    }
    if (!file.problem.empty() && gathered->empty()) {
      const Error why{ErrorCode::kUnreadable, file.problem, file.name, "correct or remove it"};
      exclude(RefusedFile(named->item(), "unreadable_file", why));
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
        exclude(SkippedFile(file.name, source, true, label.error()));
        continue;
      }
      item.options.Set("label_override", *label);
      if (*label != row->second) item.options.Set("label_text", row->second);
    }
    if (Status added = gathered->AddInputs(file.name, named->fields, item); !added) {
      const bool missing = added.error().code == ErrorCode::kNotFound;
      const char* code = missing ? "calibration_missing" : "unreadable_file";
      exclude(RefusedFile(item.item, code, added.error()));
      continue;
    }
    if (!source.skeleton_files.empty()) {
      if (Status added = AddSkeletonFile(files, FillFields(source.skeleton_files, named->fields), item); !added) {
        exclude(RefusedFile(item.item, "skeleton_file_missing", added.error()));
        continue;
      }
    }
    if (issue && source.known_issues == KnownIssueAction::kReport) item.options.Set("known_issue", TextOf(*issue));
    if (const IndexedSequence* annotated = babel->Find(file.name)) {
      item.options.Set("annotation", EncodeBabel({annotated->sequence}));
      const auto role = source.annotation_roles.find(annotated->file);
      if (role != source.annotation_roles.end()) item.options.Set("annotation_role", role->second);
    }
    if (has_truth) discovery.truth.push_back(item);
    if (depth_files) depth_files->AddTo(named->fields, item);
    discovery.performers.insert(named->performer);
    for (int body = 1; body <= named->bodies; ++body) {
      const Expected<NamedFile> own = ReadName(source, file.name, body);
      discovery.persons.insert(own ? own->identity.person : named->identity.person);
      discovery.styles.insert(named->style);
      const ItemSpec whole = body == 1 && named->bodies == 1 ? item : OfBody(item, source, file.name, body);
      for (ItemSpec& clip : OfArrays(whole, source, file, discovery.excluded)) {
        discovery.items.push_back(std::move(clip));
      }
    }
  }
  if (!only) {
    for (const auto& [folder, count] : elsewhere) {
      const bool named_so = pattern->Match(folder).has_value();
      const bool defaults = source.other_files == OtherFiles::kIgnore || count == 0;
      if (!named_so && (defaults || BelongsToClip(folder, discovery.items))) continue;
      discovery.excluded.push_back(SkippedFolder(folder, count, named_so, source));
    }
  }
  if (discovery.items.empty()) return tl::unexpected<Error>(NothingFound(options, discovery, names));
  NoteUnmatched(source, recordings, discovery.findings);
  NotePassedOver(source, passed_over, discovery.findings);
  if (!babel->Unused().empty()) discovery.excluded.push_back(WithoutMotion(*babel, source.annotations));
  if (source.views.multi_view) {
    if (Status together = GroupViews(source, discovery.items); !together) return Forward(together);
  }
  if (Status sorted = SortItems(discovery); !sorted) return Forward(sorted);
  if (Status own = CheckOwnImages(source, discovery.items); !own) return Forward(own);
  if (Status format = CheckFormat(source, discovery.items); !format) return Forward(format);
  return discovery;
}

}  // namespace mocurate
